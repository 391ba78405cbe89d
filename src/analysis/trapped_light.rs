//! Light that next to nothing absorbs and that finds no way out: without a limit on path length the
//! brightness of such a scene grows without bound, or nearly so, and so does the noise. Russian
//! roulette ends every path all the same.

use std::fmt;

use rand::RngExt;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::probe::{emitted, scattered};
use crate::sampling::seeds::{self, Purpose};
use crate::scene::{BsdfSample, Ray, RayCounts, Scene, TransportMode};

/// Particles of light that are followed.
const PROBES: u64 = 128;

/// Bounces on surfaces that are not smooth after which light that is still there is trapped.
const BOUNCES: usize = 1000;

/// Most bounces in all. What goes round in glass by total reflection for so long is never seen.
const MOST_BOUNCES: usize = 2 * BOUNCES;

/// Share of the particles from which on the user is told.
const WORTH_A_WARNING: f64 = 0.1;

/// Light that stays in the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrappedLight {
    /// Its share of all light, in (0, 1].
    pub share: f64,
}

impl fmt::Display for TrappedLight {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "trapped light: {:.0}% of the light is still there after {BOUNCES} bounces, for the scene \
             is closed and absorbs next to nothing; without a limit on path length its brightness has \
             no bound, or none that could be reached. Limit it with --max-depth, or give surfaces an \
             albedo below 1",
            100.0 * self.share
        )
    }
}

/// Light that `scene` neither absorbs nor lets go, if paths may have any length and it is a tenth of all
/// light or more.
pub fn trapped_light(scene: &Scene) -> Option<TrappedLight> {
    if scene.depth.max_depth.is_some() {
        return None;
    }
    let mut rng = seeds::generator(0, Purpose::Probes, 1);
    let trapped = (0..PROBES).filter(|_| stays(scene, &mut rng)).count();
    let share = trapped as f64 / PROBES as f64;
    (share >= WORTH_A_WARNING).then_some(TrappedLight { share })
}

/// Follows one particle, which survives every bounce with the share of light that does.
fn stays(scene: &Scene, rng: &mut Xoshiro256PlusPlus) -> bool {
    let Some((_, mut ray)) = emitted(scene, rng) else {
        return false;
    };
    let mut counts = RayCounts::default();
    let mut bounces = 0;
    for _ in 0..MOST_BOUNCES {
        let Some(surface) = scene.geometry.intersect(&ray, &mut counts) else {
            return false;
        };
        let from = -ray.direction;
        let next = scattered(scene, &surface, from, TransportMode::Importance, rng);
        let survives =
            |(sample, _): &(BsdfSample, Ray)| rng.random::<f32>() < sample.weight.max_element();
        let Some((sample, next)) = next.filter(survives) else {
            return false;
        };
        bounces += usize::from(!sample.delta);
        if bounces == BOUNCES {
            return true;
        }
        ray = next;
    }
    false
}
