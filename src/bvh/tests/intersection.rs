use glam::{Quat, Vec3A};

use super::compare_with_brute_force;
use crate::bvh::test_primitives::{Numbers, blob, grid, mesh, scaled_to_radius, sphere, triangle};
use crate::bvh::triangle::{Packet, RayTransform};
use crate::bvh::{Bvh, RADIUS, Ray};

/// Triangles of all sizes, spheres, and if `large` a closed mesh of more than two chunks.
fn crowd(seed: u64, large: bool) -> Bvh {
    let mut numbers = Numbers::new(seed);
    let mut primitives = Vec::new();
    for _ in 0..900 {
        let center = numbers.cube();
        let size = 10.0_f32.powf(-3.0 * numbers.unit());
        let corner = |_| (center + numbers.cube() * size).to_array();
        primitives.push(triangle(std::array::from_fn(corner)));
    }
    for _ in 0..60 {
        let radius = 0.3 * numbers.unit().powi(4) + 1e-4;
        primitives.push(sphere(numbers.cube(), radius));
    }
    if large {
        let rotation = Quat::from_rotation_x(1.0);
        let offset = Vec3A::new(0.1, 0.2, -0.3);
        primitives.extend(mesh(&blob(200), |p| rotation * (p * 0.7) + offset));
    }
    Bvh::new(scaled_to_radius(primitives))
}

#[test]
fn hierarchies_agree_with_brute_force() {
    let hits = compare_with_brute_force(&crowd(1, false), 20_000, 2);
    assert!(hits > 5_000, "{hits}");
}

#[test]
fn hierarchies_of_several_chunks_agree_with_brute_force() {
    let bvh = crowd(3, true);
    assert!(bvh.triangle_count() > 2 * (1 << 15));
    let hits = compare_with_brute_force(&bvh, 1_500, 4);
    assert!(hits > 500, "{hits}");
}

/// Small enough for Miri (`tests/sanitize.sh`).
#[test]
fn small_hierarchies_agree_with_brute_force() {
    let mut primitives = mesh(&blob(5), |p| p);
    primitives.push(sphere(Vec3A::new(1.2, 0.1, 0.3), 0.4));
    let bvh = Bvh::new(scaled_to_radius(primitives));
    let hits = compare_with_brute_force(&bvh, 60, 6);
    assert!(hits > 10, "{hits}");
}

/// A plate of many triangles has no holes even for rays from so far away that rounding at the distance
/// of their origin exceeds the padding of flat boxes.
#[test]
fn plates_seen_from_far_have_no_holes() {
    let bvh = Bvh::new(scaled_to_radius(mesh(&grid(80), |p| p)));
    let mut numbers = Numbers::new(7);
    for distance in [2.0, 100.0, 1e4] {
        for _ in 0..20_000 {
            let origin = Vec3A::new(0.3, 0.2, 1.0).normalize() * (distance * RADIUS);
            let target = numbers.cube() * Vec3A::new(650.0, 650.0, 0.0);
            let ray = Ray {
                origin,
                direction: (target - origin).normalize(),
                t_max: f32::INFINITY,
            };
            assert!(bvh.intersect(&ray).is_some(), "{distance}: {target}");
        }
    }
}

/// An edge so close to the ray that f32 cannot resolve the side: of the triangles on its two sides just
/// one is hit, the one that exact arithmetic gives.
#[test]
fn edges_beyond_the_precision_of_f32_are_resolved() {
    // 8193 * 8191 = 8192^2 - 1 rounds to 8192^2.
    let (p, q) = ([8193.0, 8192.0, 1.0], [-8192.0, -8191.0, 1.0]);
    let transform = RayTransform::new(Vec3A::ZERO, Vec3A::Z);
    let left = [p, q, [-1000.0, 1000.0, 1.0]];
    let right = [p, q, [1000.0, -1000.0, 1.0]];
    let behind = left.map(|[x, y, z]| [x, y, -z]);
    let packet = |first| Packet::new([first, behind, behind, behind]);
    assert!(transform.intersect(&packet(left), f32::INFINITY).is_none());
    assert!(transform.intersect(&packet(right), f32::INFINITY).is_some());
}
