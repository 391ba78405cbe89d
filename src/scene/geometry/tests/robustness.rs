use glam::{DMat4, DVec3, Vec3A};

use crate::scene::test_scenes::{Numbers, grid, mesh, scene, sphere};
use crate::scene::{Geometry, Ray, RayCounts, SCENE_RADIUS, SurfacePoint, TriangleMesh};

fn cast(geometry: &Geometry, origin: Vec3A, direction: Vec3A) -> Option<SurfacePoint> {
    let ray = Ray {
        origin,
        direction,
        t_max: f32::INFINITY,
    };
    geometry.intersect(&ray, &mut RayCounts::default())
}

/// Checks that rays that start at a point on a surface, at every angle on either side, do not hit that
/// surface again. The surfaces are convex or flat, so that there is no other hit. Returns the number of
/// points.
fn check_no_self_hit(geometry: &Geometry, inside_too: bool, seed: u64) -> usize {
    let mut numbers = Numbers::new(seed);
    let mut points = 0;
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
        points += 1;
    }
    points
}

#[test]
fn rays_do_not_hit_the_surface_that_they_leave() {
    // At the origin and away from it; triangles of the scene's size and small ones; in one plane so that
    // grazing rays have nothing else to hit.
    let tilt = DMat4::from_rotation_x(0.7) * DMat4::from_rotation_z(0.3);
    let off = DMat4::from_translation(DVec3::new(0.3, 0.2, 0.1));
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
        let count = check_no_self_hit(&scene.geometry, false, 21);
        assert!(count > 1_000, "{name}: {count}");
    }
    // In the plane z = 0 only: rounding makes a tilted grid of small triangles uneven, and rays of slope
    // 1e-6 rightly hit its other triangles.
    let scene = scene(vec![mesh(grid(60), DMat4::IDENTITY)], vec![]);
    assert!(check_no_self_hit(&scene.geometry, false, 22) > 1_000);
}

#[test]
fn rays_through_spheres_and_boxes_hit_the_far_side() {
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

/// Two planes and two spheres, one closely behind the other, at 1e-6 of the scene: a ray that passes the first
/// hits the second.
#[test]
fn surfaces_that_nearly_touch_are_not_passed_over() {
    const GAP: f64 = 1e-6;
    let plane = |z| {
        let place = DMat4::from_translation(DVec3::new(0.0, 0.0, z)) * DMat4::from_rotation_z(0.3);
        mesh(TriangleMesh::rectangle(), place)
    };
    let marker = || sphere(DVec3::new(3.0, 0.0, 1.0), 0.1);
    let radius = {
        let scene = scene(vec![plane(-1.0), marker()], vec![]);
        scene.unit * f64::from(SCENE_RADIUS)
    };
    for (name, shapes, gap) in [
        (
            "planes",
            vec![plane(-1.0), plane(-1.0 - GAP * radius), marker()],
            GAP,
        ),
        (
            "spheres",
            vec![sphere(DVec3::ZERO, 1.0), sphere(DVec3::ZERO, 1.0 - GAP)],
            GAP,
        ),
    ] {
        let scene = scene(shapes, vec![]);
        let mut numbers = Numbers::new(41);
        let (mut passed, mut points) = (0, 0);
        for _ in 0..50_000 {
            let origin = Vec3A::Z * (1.5 * SCENE_RADIUS) + numbers.cube() * (0.2 * SCENE_RADIUS);
            let toward = (numbers.cube() * (0.2 * SCENE_RADIUS) - origin).normalize();
            let first = cast(&scene.geometry, origin, toward);
            let Some(first) = first.filter(|hit| hit.geometric_normal.dot(toward).abs() > 0.5)
            else {
                continue;
            };
            points += 1;
            let second = cast(&scene.geometry, first.ray_origin(toward), toward);
            let is_near = second.is_some_and(|second| {
                let distance = (second.position - first.position).length();
                f64::from(distance) < 10.0 * gap * f64::from(SCENE_RADIUS)
            });
            passed += u32::from(!is_near);
        }
        assert!(
            points > 5_000 && passed == 0,
            "{name}: {passed} of {points}"
        );
    }
}

/// Inside a convex shape every point is visible from every other, also at grazing angles near corners and
/// edges; from outside none is.
#[test]
fn points_inside_a_convex_shape_are_mutually_visible() {
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
