use glam::{DMat4, DVec3, Vec3A};

use crate::scene::test_scenes::{mesh, scene, sphere};
use crate::scene::{Ray, RayCounts, SCENE_RADIUS, TriangleMesh};

#[test]
fn rays_from_far_outside_hit_the_scene() {
    let scene = scene(vec![mesh(TriangleMesh::cube(), DMat4::IDENTITY)], vec![]);
    let mut counts = RayCounts::default();
    let side = SCENE_RADIUS / 3.0_f32.sqrt();
    for distance in [1.5, 10.0, 1e3, 1e5] {
        let from = Vec3A::new(0.1, 0.2, distance) * SCENE_RADIUS;
        let to = Vec3A::new(0.3, -0.2, 1.0) * side;
        let ray = Ray {
            origin: from,
            direction: (to - from).normalize(),
            t_max: f32::INFINITY,
        };
        let hit = scene.geometry.intersect(&ray, &mut counts).expect("a hit");
        let error = (hit.position - to).length();
        assert!(
            error < 1e-6 * (to - from).length() + 1e-3,
            "{distance}: {error}"
        );
        let below = Vec3A::new(0.1, 0.2, 0.5) * side;
        assert!(!scene.geometry.visible(from, below, &mut counts));
        let above = Vec3A::new(0.1, 0.2, 1.2) * side;
        assert!(scene.geometry.visible(from, above, &mut counts));
        let short = Ray {
            t_max: (to - from).length() * 0.99,
            ..ray
        };
        assert!(scene.geometry.intersect(&short, &mut counts).is_none());
        let away = Ray {
            direction: -ray.direction,
            ..ray
        };
        assert!(scene.geometry.intersect(&away, &mut counts).is_none());
    }
    assert_eq!(
        counts,
        RayCounts {
            closest_hit: 12,
            shadow: 8,
            chain_searches: 0
        }
    );
}

#[test]
fn degenerate_triangles_are_left_out_and_counted() {
    let mut shapes = TriangleMesh::rectangle();
    shapes.triangles.push([0, 0, 1]);
    shapes.triangles.push([2, 2, 2]);
    let scene = scene(
        vec![mesh(shapes, DMat4::IDENTITY), sphere(DVec3::ZERO, 0.0)],
        vec![],
    );
    assert_eq!(scene.geometry.triangle_count(), 2);
    assert_eq!(scene.geometry.sphere_count(), 0);
    assert_eq!(scene.geometry.degenerate_count(), 3);
    assert_eq!(scene.geometry.shape_count(), 2);
}
