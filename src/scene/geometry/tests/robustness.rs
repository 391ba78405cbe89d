use glam::{DMat4, DVec3, Vec3A};

use crate::scene::test_scenes::{Numbers, blob, mesh, scene, sphere};
use crate::scene::{Geometry, Ray, RayCounts, SCENE_RADIUS, SurfacePoint, TriangleMesh};

fn cast(geometry: &Geometry, origin: Vec3A, direction: Vec3A) -> Option<SurfacePoint> {
    let ray = Ray {
        origin,
        direction,
        t_max: f32::INFINITY,
    };
    geometry.intersect(&ray, &mut RayCounts::default())
}

/// Rays from inside a closed mesh toward its very edges and corners: none may get out.
#[test]
fn closed_meshes_do_not_leak() {
    let shape = blob(40);
    let scene = scene(vec![mesh(shape.clone(), DMat4::IDENTITY)], vec![]);
    let unit = scene.unit;
    let place = |v: u32| {
        let p = DVec3::from_array(shape.positions[v as usize].map(f64::from));
        ((p - scene.center) / unit).as_vec3a()
    };
    let mut numbers = Numbers::new(11);
    let mut leaks = 0;
    for i in 0..1_000_000 {
        let triangle = shape.triangles[numbers.index(shape.triangles.len())];
        let [a, b, c] = triangle.map(place);
        let target = match i % 4 {
            0 => a,
            1 => a + (b - a) * numbers.unit(),
            2 => a + (c - a) * 0.5,
            _ => a + (b - a) * (numbers.unit() * 1e-6),
        };
        // The surface is star-shaped around the origin of its own coordinates; stay near it.
        let center = (-scene.center / unit).as_vec3a();
        let origin = center + numbers.cube() * (0.05 * SCENE_RADIUS);
        let direction = (target - origin).normalize();
        leaks += usize::from(cast(&scene.geometry, origin, direction).is_none());
    }
    assert_eq!(leaks, 0);
}

/// Axis-parallel rays onto the shared diagonals and edges of axis-parallel faces, where boxes are
/// flat and slab tests multiply by huge inverses.
#[test]
fn flat_boxes_are_not_lost() {
    let scene = scene(vec![mesh(TriangleMesh::cube(), DMat4::IDENTITY)], vec![]);
    let side = SCENE_RADIUS / 3.0_f32.sqrt();
    let mut numbers = Numbers::new(12);
    for i in 0..300_000 {
        let axis = Vec3A::AXES[i % 3];
        let s = side * (2.0 * numbers.unit() - 1.0);
        let [u, v] = [Vec3A::AXES[(i + 1) % 3], Vec3A::AXES[(i + 2) % 3]];
        let origin = match i % 5 {
            0 => (u + v) * s,
            1 => (u - v) * s,
            // Within some roundings of the rim.
            2 => u * (side * (1.0 - 1e-6)) + v * s,
            _ => u * s + v * (0.1 * s),
        };
        let mut direction = axis;
        if i % 2 == 0 {
            direction += u * (1e-9 * (numbers.unit() - 0.5)) - v * (1e-8 * numbers.unit());
        }
        let hit = cast(&scene.geometry, origin, direction.normalize());
        assert!(hit.is_some(), "{origin} {direction}");
    }
}

/// A point on a surface that a ray found, left at every angle to either side: the surface that is left
/// must not be hit again. Convex surfaces and flat ones, so that no other hit is right.
fn check_no_self_hit(geometry: &Geometry, inside_too: bool, seed: u64) -> usize {
    let mut numbers = Numbers::new(seed);
    let mut left = 0;
    for i in 0..150_000 {
        let origin = numbers.direction() * (SCENE_RADIUS * 1.1);
        let toward = (numbers.cube() * (0.9 * SCENE_RADIUS) - origin).normalize();
        let Some(hit) = cast(geometry, origin, toward) else {
            continue;
        };
        let n = hit.geometric_normal;
        let front = if n.dot(toward) < 0.0 { n } else { -n };
        let tangent = front.cross(numbers.direction()).normalize();
        let grazing = 10.0_f32.powi(-(i % 7));
        let direction = (tangent + front * grazing).normalize();
        let start = hit.ray_origin(direction);
        let again = cast(geometry, start, direction);
        assert!(
            again.is_none(),
            "left {:?} along {direction}, slope {grazing}, and hit {:?}",
            hit.position,
            again.map(|h| h.position)
        );
        if inside_too {
            // Through the surface: the next hit is beyond, not the same point again.
            let inward = (tangent - front * 0.3).normalize();
            let next = cast(geometry, hit.ray_origin(inward), inward);
            assert!(next.is_none_or(|next| (next.position - hit.position).length() > 0.01));
        }
        left += 1;
    }
    left
}

#[test]
fn surfaces_that_are_left_are_not_hit_again() {
    // Around the origin, and away from it; triangles of the scene's size and small ones; in one plane
    // so that grazing rays see nothing else.
    let tilt = DMat4::from_rotation_x(0.7) * DMat4::from_rotation_z(0.3);
    let off = DMat4::from_translation(DVec3::new(0.3, 0.2, 0.1));
    let mut grid = TriangleMesh::default();
    for j in 0..=60 {
        for i in 0..=60 {
            grid.positions
                .push([i as f32 / 30.0 - 1.0, j as f32 / 30.0 - 1.0, 0.0]);
        }
    }
    for j in 0..60 {
        for i in 0..60 {
            let v = j * 61 + i;
            grid.triangles.push([v, v + 1, v + 62]);
            grid.triangles.push([v, v + 62, v + 61]);
        }
    }
    let mut sliver = TriangleMesh::rectangle();
    sliver.positions[1] = [1.0, -0.9999, 0.0];
    for (name, shapes) in [
        ("rectangle", vec![mesh(TriangleMesh::rectangle(), tilt)]),
        (
            "rectangle off centre",
            vec![
                mesh(TriangleMesh::rectangle(), off * tilt),
                sphere(DVec3::new(0.0, 0.0, -9.0), 0.1),
            ],
        ),
        ("sliver", vec![mesh(sliver, tilt)]),
        ("one sphere", vec![sphere(DVec3::new(1.0, 2.0, 3.0), 5.0)]),
    ] {
        let scene = scene(shapes, vec![]);
        let left = check_no_self_hit(&scene.geometry, false, 21);
        assert!(left > 1_000, "{name}: {left}");
    }
    // A tilted grid of small triangles is not quite flat after rounding: slopes of 1e-6 meet its
    // neighbours rightly. In the plane z = 0 it is.
    let scene = scene(vec![mesh(grid, DMat4::IDENTITY)], vec![]);
    assert!(check_no_self_hit(&scene.geometry, false, 22) > 1_000);
}

#[test]
fn spheres_and_boxes_can_be_passed_through() {
    let small = (0..40)
        .map(|i| {
            let angle = f64::from(i) * 0.7;
            sphere(
                DVec3::new(angle.cos(), angle.sin(), 0.05 * f64::from(i) - 1.0),
                0.05,
            )
        })
        .collect();
    for shapes in [
        small,
        vec![sphere(DVec3::splat(3.0), 2.0)],
        vec![mesh(TriangleMesh::cube(), DMat4::from_rotation_y(0.4))],
    ] {
        let scene = scene(shapes, vec![]);
        let mut numbers = Numbers::new(31);
        for _ in 0..100_000 {
            let origin = numbers.direction() * (SCENE_RADIUS * 1.1);
            let toward = (numbers.cube() * (0.6 * SCENE_RADIUS) - origin).normalize();
            let Some(first) = cast(&scene.geometry, origin, toward) else {
                continue;
            };
            let inside = first.ray_origin(toward);
            let second = cast(&scene.geometry, inside, toward).expect("the far side");
            assert!(
                second.geometric_normal.dot(toward) > 0.0,
                "{first:?} {second:?}"
            );
        }
    }
}

/// Inside a convex room every wall point sees every other, also at grazing angles near the corners
/// and edges; from outside the room none is seen.
#[test]
fn walls_of_a_convex_room_see_each_other() {
    let turn = DMat4::from_rotation_x(0.3) * DMat4::from_rotation_y(0.5);
    for (name, shape) in [
        ("box", mesh(TriangleMesh::cube(), turn)),
        ("sphere", sphere(DVec3::new(4.0, -2.0, 1.0), 3.0)),
    ] {
        let scene = scene(vec![shape], vec![]);
        let mut numbers = Numbers::new(32);
        let mut counts = RayCounts::default();
        for i in 0..200_000 {
            let origin = numbers.cube() * (0.3 * SCENE_RADIUS);
            let mut wall = || cast(&scene.geometry, origin, numbers.direction()).expect("a wall");
            let (a, mut b) = (wall(), wall());
            if i % 2 == 0 {
                // Close together, around an edge or along the curve.
                let near = (a.position - origin).normalize() + 1e-3 * (b.position / SCENE_RADIUS);
                b = cast(&scene.geometry, origin, near.normalize()).expect("a wall");
            }
            let between = b.position - a.position;
            if a.geometric_normal.dot(between).abs() < 0.05 {
                continue;
            }
            let (from, to) = (a.ray_origin(between), b.ray_origin(-between));
            assert!(
                scene.geometry.visible(from, to, &mut counts),
                "{name}: {a:?} {b:?}"
            );
            let outside = a.ray_origin(-between);
            assert!(
                !scene.geometry.visible(outside, to, &mut counts),
                "{name}: {a:?} {b:?}"
            );
        }
    }
}
