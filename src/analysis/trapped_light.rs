//! Light that is hardly absorbed and cannot leave the scene. Without a limit on path length the
//! radiance in such a scene is infinite or very large, and so is the variance of its estimate. Russian
//! roulette still ends every path.

use rand::RngExt;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::probe::{emitted, scattered};
use crate::sampling::seeds::{self, Purpose};
use crate::scene::{BsdfSample, Ray, RayCounts, Scene, TransportMode};

/// Number of particles of light that are traced.
const PROBES: u64 = 128;

/// A particle that survives this many non-specular bounces is trapped.
pub const BOUNCES: usize = 1000;

/// Maximum number of bounces, specular ones included. Light that circulates in glass by total internal
/// reflection for longer never reaches the camera.
const MAX_BOUNCES: usize = 2 * BOUNCES;

/// Smallest share of the particles that is reported.
const MIN_SHARE: f64 = 0.1;

/// Light that stays in the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrappedLight {
    /// Share of the emitted power that is left after [`BOUNCES`] bounces, in (0, 1].
    pub share: f64,
}

/// Light that `scene` neither absorbs nor lets escape, if the path length is unlimited and the share is
/// at least a tenth.
pub fn trapped_light(scene: &Scene) -> Option<TrappedLight> {
    if scene.depth.max_depth.is_some() {
        return None;
    }
    let mut rng = seeds::generator(0, Purpose::Probes, 1);
    let trapped = (0..PROBES).filter(|_| is_trapped(scene, &mut rng)).count();
    let share = trapped as f64 / PROBES as f64;
    (share >= MIN_SHARE).then_some(TrappedLight { share })
}

/// Traces one particle and returns true if it is trapped. It survives each bounce with a probability of
/// the largest component of the BSDF sample's weight.
fn is_trapped(scene: &Scene, rng: &mut Xoshiro256PlusPlus) -> bool {
    let Some((_, mut ray)) = emitted(scene, rng) else {
        return false;
    };
    let mut counts = RayCounts::default();
    let mut bounces = 0;
    for _ in 0..MAX_BOUNCES {
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
