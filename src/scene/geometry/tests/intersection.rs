use glam::{DMat4, DVec3, Vec3A};

use crate::scene::geometry::hierarchy::{Quality, build_with, depth};
use crate::scene::geometry::primitive::{Primitive, Primitives};
use crate::scene::geometry::traversal::MAX_DEPTH;
use crate::scene::geometry::triangle::{Packet, Shear};
use crate::scene::test_scenes::{Numbers, blob, mesh, scene, sphere};
use crate::scene::{Geometry, Ray, RayCounts, SCENE_RADIUS, Scene, TriangleMesh};

/// Triangles of all sizes, spheres, and a closed mesh large enough for several chunks.
fn crowd(seed: u64, large: bool) -> Scene {
    let mut numbers = Numbers::new(seed);
    let mut soup = TriangleMesh::default();
    for i in 0..900 {
        let center = numbers.cube();
        let size = 10.0_f32.powf(-3.0 * numbers.unit());
        let corners: [Vec3A; 3] = std::array::from_fn(|_| center + numbers.cube() * size);
        soup.positions.extend(corners.map(|c| c.to_array()));
        soup.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    let mut shapes = vec![mesh(soup, DMat4::IDENTITY)];
    for _ in 0..60 {
        let radius = f64::from(0.3 * numbers.unit().powi(4) + 1e-4);
        shapes.push(sphere(numbers.cube().as_dvec3(), radius));
    }
    if large {
        let place = DMat4::from_scale_rotation_translation(
            DVec3::splat(0.7),
            glam::DQuat::from_rotation_x(1.0),
            DVec3::new(0.1, 0.2, -0.3),
        );
        shapes.push(mesh(blob(200), place));
    }
    scene(shapes, vec![])
}

/// Distance to the first hit, looking at every primitive.
fn brute_force(geometry: &Geometry, ray: &Ray) -> f32 {
    let shear = Shear::new(ray.origin, ray.direction);
    let primitives = &geometry.primitives;
    let nearest = primitives
        .packets
        .iter()
        .fold(ray.t_max, |nearest, packet| {
            shear
                .intersect(packet, nearest)
                .map_or(nearest, |hit| hit.t)
        });
    (0..primitives.spheres.len() as u32).fold(nearest, |nearest, sphere| {
        geometry
            .meet_sphere(sphere, ray, nearest)
            .unwrap_or(nearest)
    })
}

/// The same distance to the bit up to a rounding, and the same answer of shadow rays.
fn compare_with_brute_force(scene: &Scene, rays: usize, seed: u64) -> usize {
    let mut numbers = Numbers::new(seed);
    let mut counts = RayCounts::default();
    let mut hits = 0;
    for i in 0..rays {
        let origin = numbers.cube() * SCENE_RADIUS * if i % 4 == 0 { 1.1 } else { 0.6 };
        let mut direction = numbers.direction();
        if i % 5 == 0 {
            // Along an axis: the case in which slab tests divide by 0.
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
        let Some(entered) = super::super::enter_scene(&ray) else {
            continue;
        };
        let expected = brute_force(&scene.geometry, &entered);
        let is_hit = expected < entered.t_max;
        hits += usize::from(is_hit);
        let hit = scene.geometry.intersect(&ray, &mut counts);
        assert_eq!(hit.is_some(), is_hit, "{ray:?}: expected t = {expected}");
        if let Some(hit) = hit {
            let t = (hit.position - entered.origin).length();
            assert!((t - expected).abs() < 2e-3, "{ray:?}: {t} {expected}");
            let beyond = ray.origin + direction * ((hit.position - ray.origin).length() + 1.0);
            assert!(!scene.geometry.visible(ray.origin, beyond, &mut counts));
            let before = ray.origin + direction * ((hit.position - ray.origin).length() - 0.01);
            assert!(
                scene.geometry.visible(ray.origin, before, &mut counts),
                "{ray:?}"
            );
        }
    }
    hits
}

#[test]
fn the_hierarchy_finds_what_looking_at_every_primitive_finds() {
    let hits = compare_with_brute_force(&crowd(1, false), 20_000, 2);
    assert!(hits > 5_000, "{hits}");
}

#[test]
fn so_it_does_over_several_chunks() {
    let scene = crowd(3, true);
    assert!(scene.geometry.triangle_count() > 2 * (1 << 15));
    let hits = compare_with_brute_force(&scene, 1_500, 4);
    assert!(hits > 500, "{hits}");
}

/// Small enough for Miri (`tests/sanitize.sh`).
#[test]
fn small_hierarchies_do_as_well() {
    let ball = sphere(DVec3::new(1.2, 0.1, 0.3), 0.4);
    let scene = scene(vec![mesh(blob(5), DMat4::IDENTITY), ball], vec![]);
    let hits = compare_with_brute_force(&scene, 60, 6);
    assert!(hits > 10, "{hits}");
}

#[test]
fn rays_from_far_outside_meet_the_scene() {
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
            shadow: 8
        }
    );
}

/// Seen from so far that rounding at the camera's distance exceeds the padding of flat boxes, a plate of
/// many triangles has no holes.
#[test]
fn plates_seen_from_far_have_no_holes() {
    let mut plate = TriangleMesh::default();
    for j in 0..=80 {
        for i in 0..=80 {
            plate
                .positions
                .push([i as f32 / 40.0 - 1.0, j as f32 / 40.0 - 1.0, 0.0]);
        }
    }
    for j in 0..80 {
        for i in 0..80 {
            let v = j * 81 + i;
            plate.triangles.push([v, v + 1, v + 82]);
            plate.triangles.push([v, v + 82, v + 81]);
        }
    }
    let scene = scene(vec![mesh(plate, DMat4::IDENTITY)], vec![]);
    let mut numbers = Numbers::new(7);
    for distance in [2.0, 100.0, 1e4] {
        for _ in 0..20_000 {
            let origin = Vec3A::new(0.3, 0.2, 1.0).normalize() * (distance * SCENE_RADIUS);
            let target = numbers.cube() * Vec3A::new(650.0, 650.0, 0.0);
            let ray = Ray {
                origin,
                direction: (target - origin).normalize(),
                t_max: f32::INFINITY,
            };
            let hit = scene.geometry.intersect(&ray, &mut RayCounts::default());
            assert!(hit.is_some(), "{distance}: {target}");
        }
    }
}

/// An edge that passes the ray so closely that f32 cannot tell the side: of the triangles to either
/// side of it just one is hit, the one that exact arithmetic names.
#[test]
fn edges_that_f32_cannot_resolve_are_resolved() {
    // 8193 * 8191 = 8192^2 - 1 rounds to 8192^2.
    let (p, q) = ([8193.0, 8192.0, 1.0], [-8192.0, -8191.0, 1.0]);
    let shear = Shear::new(Vec3A::ZERO, Vec3A::Z);
    let left = [p, q, [-1000.0, 1000.0, 1.0]];
    let right = [p, q, [1000.0, -1000.0, 1.0]];
    let behind = left.map(|[x, y, z]| [x, y, -z]);
    let packet = |first| Packet::new([first, behind, behind, behind]);
    assert!(shear.intersect(&packet(left), f32::INFINITY).is_none());
    assert!(shear.intersect(&packet(right), f32::INFINITY).is_some());
}

/// Many surfaces in one place, and ever smaller ones around one point: neither may make a tree too
/// deep to traverse, nor lose a surface.
#[test]
fn piles_and_nests_can_be_built() {
    let mut pile = TriangleMesh::default();
    for i in 0..20_000 {
        let size = 0.999_f32.powi(i);
        for (s, z) in [(1.0, 0.0), (size, 0.001 * size)] {
            let first = pile.positions.len() as u32;
            pile.positions
                .extend([[-s, -s, z], [s, -s, z], [0.0, s, z]]);
            pile.triangles.push([first, first + 1, first + 2]);
        }
    }
    let mut scene = scene(vec![mesh(pile, DMat4::IDENTITY)], vec![]);
    for quality in [Quality::Best, Quality::Shallow] {
        if quality == Quality::Shallow {
            // The tree that is made when the best is too deep.
            let mut all: Vec<Primitive> = scene.geometry.primitives.iter().map(|p| p.1).collect();
            let hierarchy = build_with(&mut all, quality);
            scene.geometry.primitives = Primitives::new(all, &hierarchy.leaves, 0);
            scene.geometry.nodes = hierarchy.nodes;
        }
        let depth = depth(&scene.geometry.nodes);
        assert!(depth > 3 && depth <= MAX_DEPTH, "{quality:?}: {depth}");
        compare_with_brute_force(&scene, 300, 5);
    }
}

/// What stays after construction is some 2 times the 36 bytes of a plain triangle. (While it is built,
/// a mesh of a million triangles took 3.3 times in all, its loaded form included.)
#[test]
fn memory_is_bounded() {
    let scene = scene(vec![mesh(blob(160), DMat4::IDENTITY)], vec![]);
    let plain = 36 * scene.geometry.triangle_count();
    let bytes = scene.geometry.memory_bytes();
    assert!(bytes > plain && bytes < 3 * plain, "{bytes} {plain}");
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
