//! Surfaces that lie too close to be told apart: closer than the distance from a surface at which rays begin.
//! A ray that leaves one of them passes over the other.
//!
//! Only surfaces that light reaches matter: a box that stands on a floor is no mistake.

use std::collections::BTreeMap;

use rand_xoshiro::Xoshiro256PlusPlus;

use super::probe::{pair, scattered};
use crate::sampling::seeds::{self, Purpose};
use crate::scene::interaction::{RAY_OFFSET, offset};
use crate::scene::{Ray, RayCounts, Scene, SurfacePoint, TransportMode};

/// Number of random paths from the camera.
const PATHS: u32 = 1 << 12;

/// Most vertices of a path.
const MAX_VERTICES: usize = 8;

/// Smallest number of vertices at which two shapes are too close. A sphere on a floor touches it in a point, of
/// which a path may happen to hit the surroundings.
const MIN_VERTICES: u32 = 4;

/// Smallest cosine between the normals of surfaces that lie on each other; others meet at an edge.
const MIN_COSINE: f32 = 0.9;

/// Shapes whose surfaces lie too close to each other.
#[derive(Clone, Debug, PartialEq)]
pub struct NearSurfaces {
    /// Their names.
    pub pairs: Vec<[String; 2]>,
    /// Surfaces further apart than this are told apart; in units of the scene file.
    pub distance: f64,
}

/// Looks for surfaces that lie too close to each other at the vertices of random paths from the camera.
pub fn near_surfaces(scene: &Scene) -> Option<NearSurfaces> {
    let mut rng = seeds::generator(0, Purpose::Probes, 2);
    let mut vertices: BTreeMap<[u32; 2], u32> = BTreeMap::new();
    for _ in 0..PATHS {
        follow(scene, &mut rng, |point| {
            if let Some(other) = too_close(scene, point) {
                let pair = [point.shape.min(other), point.shape.max(other)];
                *vertices.entry(pair).or_default() += 1;
            }
        });
    }
    let often = vertices.into_iter().filter(|(_, n)| *n >= MIN_VERTICES);
    let name = |shape: u32| scene.geometry.shape_name(shape).to_owned();
    let pairs: Vec<_> = often.map(|(pair, _)| pair.map(name)).collect();
    (!pairs.is_empty()).then(|| NearSurfaces {
        pairs,
        distance: f64::from(RAY_OFFSET) * scene.unit,
    })
}

/// Calls `visit` for the vertices of a random path from the camera.
fn follow(scene: &Scene, rng: &mut Xoshiro256PlusPlus, mut visit: impl FnMut(&SurfacePoint)) {
    let mut counts = RayCounts::default();
    let (mut ray, _) = scene.camera.ray(pair(rng), pair(rng));
    let mut hit = scene.seen_from_camera(&ray, &mut counts);
    for _ in 0..MAX_VERTICES {
        let Some(point) = hit else { return };
        visit(&point);
        let from = -ray.direction;
        let Some((_, next)) = scattered(scene, &point, from, TransportMode::Radiance, rng) else {
            return;
        };
        ray = next;
        hit = scene.geometry.intersect(&ray, &mut counts);
    }
}

/// The shape of another surface between `point` and the origin of a ray that leaves it on either side. That of the
/// same shape is not looked for: it may be the next triangle.
fn too_close(scene: &Scene, point: &SurfacePoint) -> Option<u32> {
    let normal = point.geometric_normal;
    let mut counts = RayCounts::default();
    [normal, -normal].into_iter().find_map(|side| {
        let back = Ray {
            origin: offset(point.position, normal, side),
            direction: -side,
            t_max: RAY_OFFSET,
        };
        let other = scene.geometry.intersect(&back, &mut counts)?;
        let is_parallel = other.geometric_normal.dot(normal).abs() > MIN_COSINE;
        (other.shape != point.shape && is_parallel).then_some(other.shape)
    })
}
