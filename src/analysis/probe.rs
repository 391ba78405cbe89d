//! Random rays that look at how light goes through a scene, without any estimate of it.

use glam::{Vec2, Vec3A};
use rand::RngExt;
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::scene::{BsdfSample, EmissionSample, Ray, Scene, SurfacePoint, TransportMode};

/// Two random numbers.
pub(super) fn pair(rng: &mut Xoshiro256PlusPlus) -> Vec2 {
    Vec2::from(rng.random::<[f32; 2]>())
}

/// A ray from an emitter.
pub(super) fn emitted(
    scene: &Scene,
    rng: &mut Xoshiro256PlusPlus,
) -> Option<(EmissionSample, Ray)> {
    let [choose, part] = rng.random::<[f32; 2]>();
    let (place, way) = (pair(rng), pair(rng));
    let sample = scene.emitters.sample_emission(choose, part, place, way)?;
    let ray = Ray {
        origin: sample.origin,
        direction: sample.direction,
        t_max: f32::INFINITY,
    };
    Some((sample, ray))
}

/// A ray scattered at `surface`, `from` (unit) being where the last one came from.
pub(super) fn scattered(
    scene: &Scene,
    surface: &SurfacePoint,
    from: Vec3A,
    mode: TransportMode,
    rng: &mut Xoshiro256PlusPlus,
) -> Option<(BsdfSample, Ray)> {
    let material = &scene.materials[scene.geometry.material(surface.shape) as usize];
    let from = surface.shading.to_local(from);
    let (lobe, u) = (rng.random(), pair(rng));
    let sample = material.sample(&scene.textures, surface.uv, from, mode, lobe, u)?;
    let direction = surface.shading.to_world(sample.direction);
    let ray = Ray {
        origin: surface.ray_origin(direction),
        direction,
        t_max: f32::INFINITY,
    };
    Some((sample, ray))
}
