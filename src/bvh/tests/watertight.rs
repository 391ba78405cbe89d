use glam::Vec3A;

use crate::bvh::test_primitives::{Numbers, blob, cube, mesh, triangle};
use crate::bvh::{Bvh, RADIUS, Ray};

fn is_hit(bvh: &Bvh, origin: Vec3A, direction: Vec3A) -> bool {
    let ray = Ray {
        origin,
        direction: direction.normalize(),
        t_max: f32::INFINITY,
    };
    bvh.intersect(&ray).is_some()
}

/// Rays from inside a closed mesh toward points on its edges and its vertices: none leaves it.
#[test]
fn closed_meshes_do_not_leak() {
    let center = Vec3A::new(40.0, -30.0, 20.0);
    let shape = blob(40);
    let place = |p: Vec3A| p * 780.0 + center;
    let bvh = Bvh::new(mesh(&shape, place));
    let (positions, triangles) = shape;
    let mut numbers = Numbers::new(11);
    let mut leaks = 0;
    for i in 0..1_000_000 {
        let triangle = triangles[numbers.index(triangles.len())];
        let [a, b, c] = triangle.map(|v| place(Vec3A::from_array(positions[v as usize])));
        let target = match i % 4 {
            0 => a,
            1 => a + (b - a) * numbers.unit(),
            2 => a + (c - a) * 0.5,
            _ => a + (b - a) * (numbers.unit() * 1e-6),
        };
        // The mesh is star-shaped around `center`: origins stay near it.
        let origin = center + numbers.cube() * (0.05 * RADIUS);
        leaks += usize::from(!is_hit(&bvh, origin, target - origin));
    }
    assert_eq!(leaks, 0);
}

/// Axis-parallel rays onto the shared diagonals and edges of axis-parallel faces, where boxes are flat
/// and slab tests multiply by huge inverses.
#[test]
fn flat_boxes_are_hit() {
    let side = RADIUS / 3.0_f32.sqrt();
    let place = |corner: [f32; 3]| corner.map(|x| x * side);
    let faces = cube().into_iter().map(|face| triangle(face.map(place)));
    let bvh = Bvh::new(faces.collect());
    let mut numbers = Numbers::new(12);
    for i in 0..300_000 {
        let axis = Vec3A::AXES[i % 3];
        let s = side * (2.0 * numbers.unit() - 1.0);
        let [u, v] = [Vec3A::AXES[(i + 1) % 3], Vec3A::AXES[(i + 2) % 3]];
        let origin = match i % 5 {
            0 => (u + v) * s,
            1 => (u - v) * s,
            // Within a few roundings of the rim.
            2 => u * (side * (1.0 - 1e-6)) + v * s,
            _ => u * s + v * (0.1 * s),
        };
        let mut direction = axis;
        if i % 2 == 0 {
            direction += u * (1e-9 * (numbers.unit() - 0.5)) - v * (1e-8 * numbers.unit());
        }
        assert!(is_hit(&bvh, origin, direction), "{origin} {direction}");
    }
}
