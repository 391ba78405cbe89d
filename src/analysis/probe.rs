//! Random rays that show which way light takes through a scene. They estimate nothing.

use glam::{Vec2, Vec3A};
use rand::RngExt;
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::scene::{BsdfSample, EmissionSample, Ray, Scene, SurfacePoint, TransportMode};

/// Two uniform random numbers in [0, 1).
pub(super) fn pair(rng: &mut Xoshiro256PlusPlus) -> Vec2 {
    Vec2::from(rng.random::<[f32; 2]>())
}

/// A random ray from an emitter.
pub(super) fn emitted(
    scene: &Scene,
    rng: &mut Xoshiro256PlusPlus,
) -> Option<(EmissionSample, Ray)> {
    let [u_emitter, u_primitive] = rng.random::<[f32; 2]>();
    let (u_position, u_direction) = (pair(rng), pair(rng));
    let sample = scene
        .emitters
        .sample_emission(u_emitter, u_primitive, u_position, u_direction)?;
    let ray = Ray {
        origin: sample.origin,
        direction: sample.direction,
        t_max: f32::INFINITY,
    };
    Some((sample, ray))
}

/// A ray scattered at `surface`; `from` is the unit direction towards the origin of the arriving ray.
pub(super) fn scattered(
    scene: &Scene,
    surface: &SurfacePoint,
    from: Vec3A,
    mode: TransportMode,
    rng: &mut Xoshiro256PlusPlus,
) -> Option<(BsdfSample, Ray)> {
    let material = &scene.materials[scene.geometry.material(surface.shape) as usize];
    let from = surface.shading.to_local(from);
    let (u_lobe, u) = (rng.random(), pair(rng));
    let sample = material.sample(&scene.material_context(surface), from, mode, u_lobe, u)?;
    let direction = surface.shading.to_world(sample.direction);
    let ray = Ray {
        origin: surface.ray_origin(direction),
        direction,
        t_max: f32::INFINITY,
    };
    Some((sample, ray))
}
