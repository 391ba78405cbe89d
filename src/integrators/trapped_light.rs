//! Light that next to nothing absorbs and that finds no way out: without a limit on path length the
//! brightness of such a scene grows without bound, or nearly so, and so does the noise. Russian
//! roulette ends every path all the same.

use std::fmt;

use glam::Vec2;
use rand::RngExt;
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::math::seeds::{self, Purpose};
use crate::scene::{Ray, RayCounts, Scene, TransportMode};

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
    let [choose, part] = rng.random::<[f32; 2]>();
    let (place, way) = (pair(rng), pair(rng));
    let Some(start) = scene.emitters.sample_emission(choose, part, place, way) else {
        return false;
    };
    let mut ray = Ray {
        origin: start.origin,
        direction: start.direction,
        t_max: f32::INFINITY,
    };
    let mut counts = RayCounts::default();
    let mut scattered = 0;
    for _ in 0..MOST_BOUNCES {
        let Some(surface) = scene.geometry.intersect(&ray, &mut counts) else {
            return false;
        };
        let material = &scene.materials[scene.geometry.material(surface.shape) as usize];
        let from = surface.shading.to_local(-ray.direction);
        let (lobe, u) = (rng.random(), pair(rng));
        let mode = TransportMode::Importance;
        let sample = material.sample(&scene.textures, surface.uv, from, mode, lobe, u);
        let Some(sample) = sample.filter(|s| rng.random::<f32>() < s.weight.max_element()) else {
            return false;
        };
        scattered += usize::from(!sample.delta);
        if scattered == BOUNCES {
            return true;
        }
        let direction = surface.shading.to_world(sample.direction);
        ray = Ray {
            origin: surface.ray_origin(direction),
            direction,
            t_max: f32::INFINITY,
        };
    }
    false
}

fn pair(rng: &mut Xoshiro256PlusPlus) -> Vec2 {
    Vec2::from(rng.random::<[f32; 2]>())
}
