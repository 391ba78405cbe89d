//! Light that no local path sampler can find (Veach 1997, section 8.3.4 and theorem 8.3).
//!
//! A sampler that extends and joins subpaths vertex by vertex finds a path only if two consecutive
//! events on it are not delta functions. A point or directional light brings such a pair only with a
//! first surface that is not smooth, and the lens (which nothing hits here) only with a last one. So
//! light that goes from such an emitter through smooth surfaces to a rough one, and is seen there
//! through smooth surfaces again, is lost: S D S at a point light. Path tracing joins only camera
//! vertices to emitters and loses all light that reached a rough surface through smooth ones; light
//! tracing loses all that is seen through them.

use std::collections::BTreeSet;
use std::fmt;

use glam::Vec2;
use rand::RngExt;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::Sampler;
use crate::math::seeds::{self, Purpose};
use crate::scene::{Ray, RayCounts, Scene, TransportMode};

/// Rays that look from each side.
const PROBES: u64 = 1 << 15;

/// Longest chains of smooth surfaces that are followed.
const LONGEST_CHAIN: usize = 16;

/// Light that a sampler cannot find, on one surface.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LostLight {
    /// Where it comes from.
    pub emitter: String,
    /// The surface that shows too little.
    pub surface: String,
    /// Who cannot find it.
    pub sampler: Sampler,
}

impl fmt::Display for LostLight {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            emitter,
            surface,
            sampler,
        } = self;
        match sampler {
            Sampler::Bidirectional => write!(
                f,
                "lost light: {surface} is lit by {emitter} through smooth glass or mirrors and seen \
                 through smooth glass or mirrors; no path sampler here can find that light, so the \
                 image is too dark there. A small area light or a little roughness makes it findable"
            ),
            Sampler::Path => write!(
                f,
                "lost light: {surface} is lit by {emitter} through smooth glass or mirrors, which \
                 path tracing cannot find; bdpt and pssmlt can where it is seen directly"
            ),
            Sampler::Light => write!(
                f,
                "lost light: {surface} is seen through smooth glass or mirrors, where light tracing \
                 finds nothing; use another integrator"
            ),
        }
    }
}

/// Light in `scene` that `sampler` cannot find, by looking along random rays from the emitters and
/// from the lens. What is so rare that some 30000 rays do not meet it is not reported.
pub fn lost_light(scene: &Scene, sampler: Sampler) -> Vec<LostLight> {
    let mut rng = seeds::generator(0, Purpose::Probes, 0);
    let seen: BTreeSet<u32> = (0..PROBES)
        .filter_map(|_| {
            let (ray, _) = scene.camera.ray(
                Vec2::from(rng.random::<[f32; 2]>()),
                rng.random::<[f32; 2]>().into(),
            );
            behind_smooth(scene, ray, TransportMode::Radiance, &mut rng)
        })
        .collect();
    let surface = |shape: u32| scene.geometry.shape_name(shape).to_owned();
    if sampler == Sampler::Light {
        let lost = |&shape| LostLight {
            emitter: String::new(),
            surface: surface(shape),
            sampler,
        };
        return seen.iter().map(lost).collect();
    }
    let mut lost = BTreeSet::new();
    for _ in 0..PROBES {
        let [choose, part] = rng.random::<[f32; 2]>();
        let (place, way) = (
            Vec2::from(rng.random::<[f32; 2]>()),
            Vec2::from(rng.random::<[f32; 2]>()),
        );
        let sample = scene.emitters.sample_emission(choose, part, place, way);
        let Some(sample) = sample.filter(|sample| sample.delta) else {
            continue;
        };
        let ray = Ray {
            origin: sample.origin,
            direction: sample.direction,
            t_max: f32::INFINITY,
        };
        if let Some(shape) = behind_smooth(scene, ray, TransportMode::Importance, &mut rng)
            && (sampler == Sampler::Path || seen.contains(&shape))
        {
            lost.insert((sample.emitter, shape));
        }
    }
    lost.into_iter()
        .map(|(emitter, shape)| LostLight {
            emitter: emitter_name(scene, emitter),
            surface: surface(shape),
            sampler,
        })
        .collect()
}

/// How messages call an emitter: by its kind and, where there are several, its place in the scene.
fn emitter_name(scene: &Scene, emitter: u32) -> String {
    let kind = scene.emitters.kind(emitter).name();
    match scene.emitters.len() {
        1 => format!("the {kind} emitter"),
        n => format!("the {kind} emitter ({} of {n})", emitter + 1),
    }
}

/// The first shape that is not smooth, if `ray` meets it after at least one that is.
fn behind_smooth(
    scene: &Scene,
    mut ray: Ray,
    mode: TransportMode,
    rng: &mut Xoshiro256PlusPlus,
) -> Option<u32> {
    let mut counts = RayCounts::default();
    for bounce in 0..LONGEST_CHAIN {
        let surface = scene.geometry.intersect(&ray, &mut counts)?;
        let material = &scene.materials[scene.geometry.material(surface.shape) as usize];
        if bounce > 0 && material.is_connectible() {
            return Some(surface.shape);
        }
        let from = surface.shading.to_local(-ray.direction);
        let (lobe, u) = (rng.random(), Vec2::from(rng.random::<[f32; 2]>()));
        let sample = material.sample(&scene.textures, surface.uv, from, mode, lobe, u)?;
        if !sample.delta {
            return None;
        }
        let direction = surface.shading.to_world(sample.direction);
        ray = Ray {
            origin: surface.ray_origin(direction),
            direction,
            t_max: f32::INFINITY,
        };
    }
    None
}
