//! Tests of the hierarchy.

mod construction;
mod intersection;
mod watertight;

use glam::Vec3A;

use super::test_primitives::Numbers;
use super::triangle::RayTransform;
use super::{Bvh, Hit, HitTarget, RADIUS, Ray, Triangle};

/// The position of a hit.
fn position(hit: &Hit) -> Vec3A {
    match hit.target {
        HitTarget::Triangle {
            triangle: Triangle { corners, .. },
            b1,
            b2,
        } => {
            let [a, b, c] = corners.map(Vec3A::from_array);
            a * (1.0 - b1 - b2) + b * b1 + c * b2
        }
        HitTarget::Sphere { point, .. } => point.as_vec3a(),
    }
}

/// Distance to the nearest hit, found by testing every primitive.
fn brute_force(bvh: &Bvh, ray: &Ray) -> f32 {
    let transform = RayTransform::new(ray.origin, ray.direction);
    let primitives = &bvh.primitives;
    let nearest = primitives
        .packets
        .iter()
        .fold(ray.t_max, |nearest, packet| {
            transform
                .intersect(packet, nearest)
                .map_or(nearest, |hit| hit.t)
        });
    (0..primitives.spheres.len() as u32).fold(nearest, |nearest, sphere| {
        bvh.intersect_sphere(sphere, ray, nearest)
            .unwrap_or(nearest)
    })
}

/// Checks that random rays find the same distance up to rounding, and the same occlusion, as a test of
/// every primitive does. Returns the number of hits.
fn compare_with_brute_force(bvh: &Bvh, rays: usize, seed: u64) -> usize {
    let mut numbers = Numbers::new(seed);
    let mut hits = 0;
    for i in 0..rays {
        let origin = numbers.cube() * RADIUS * if i % 4 == 0 { 1.1 } else { 0.6 };
        let mut direction = numbers.direction();
        if i % 5 == 0 {
            // Along an axis, where slab tests divide by 0.
            direction = Vec3A::AXES[i % 3];
        }
        let t_max = if i % 3 == 0 {
            f32::INFINITY
        } else {
            2000.0 * numbers.unit()
        };
        let ray = Ray {
            origin,
            direction,
            t_max,
        };
        let Some(advanced) = ray.advanced_to_primitives() else {
            continue;
        };
        let expected = brute_force(bvh, &advanced);
        let is_hit = expected < advanced.t_max;
        hits += usize::from(is_hit);
        let hit = bvh.intersect(&ray);
        assert_eq!(hit.is_some(), is_hit, "{ray:?}: expected t = {expected}");
        assert_eq!(bvh.occluded(&ray), is_hit, "{ray:?}");
        if let Some(hit) = hit {
            let position = position(&hit);
            let t = (position - advanced.origin).length();
            assert!((t - expected).abs() < 2e-3, "{ray:?}: {t} {expected}");
            let distance = (position - origin).length();
            let to = |t_max| Ray { t_max, ..ray };
            assert!(bvh.occluded(&to(distance + 1.0)), "{ray:?}");
            assert!(!bvh.occluded(&to(distance - 0.01)), "{ray:?}");
        }
    }
    hits
}
