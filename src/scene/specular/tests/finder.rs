//! The finders against chains that random rays take, and against brute force.

use glam::{DMat4, DVec3, Vec3A};

use super::{
    FOCUS, MIRROR, RADIUS, blob, find, free_point, glass, graph, prism, random_direction, scale,
    scene_of, shape, waves,
};
use crate::scene::bsdf::{DeltaLobe, TransportMode};
use crate::scene::specular::{Candidate, Endpoint, Lobes};
use crate::scene::test_scenes::{self, Numbers};
use crate::scene::{Ray, RayCounts, Scene, TriangleMesh};

/// The lobes that a random ray takes, and its last segment: origin, direction and free distance.
struct Shot {
    lobes: Vec<DeltaLobe>,
    from: Vec3A,
    direction: Vec3A,
    free: f32,
    /// Smallest cosine at a vertex.
    grazing: f32,
}

fn shoot(
    scene: &Scene,
    start: DVec3,
    mut direction: Vec3A,
    length: usize,
    numbers: &mut Numbers,
) -> Option<Shot> {
    let mut counts = RayCounts::default();
    let mut origin = start.as_vec3a();
    let (mut lobes, mut from, mut grazing) = (Vec::new(), origin, 1.0_f32);
    for _ in 0..length {
        let ray = Ray {
            origin,
            direction,
            t_max: f32::INFINITY,
        };
        let point = scene.geometry.intersect(&ray, &mut counts)?;
        let material = &scene.materials[0];
        let local = point.shading.to_local(-direction);
        let lobe = if numbers.unit() < 0.5 {
            DeltaLobe::Reflection
        } else {
            DeltaLobe::Transmission
        };
        let sample = material.sample_delta(
            &scene.material_context(&point),
            local,
            TransportMode::Radiance,
            lobe,
        )?;
        direction = point.shading.to_world(sample.direction);
        grazing = grazing.min(local.z.abs()).min(sample.direction.z.abs());
        // Shading normals may send rays to the wrong side of a triangle; no chain of a smooth surface does.
        let [before, after] = [ray.direction, direction].map(|d| point.geometric_normal.dot(d));
        if (before * after > 0.0) != (lobe == DeltaLobe::Transmission) {
            return None;
        }
        (origin, from) = (point.ray_origin(direction), point.position);
        lobes.push(lobe);
    }
    let ray = Ray {
        origin,
        direction,
        t_max: f32::INFINITY,
    };
    let free = scene
        .geometry
        .intersect(&ray, &mut counts)
        .map_or(f32::INFINITY, |hit| hit.position.distance(from));
    Some(Shot {
        lobes,
        from,
        direction,
        free,
        grazing,
    })
}

/// Shoots random rays from points at up to twice the scene's radius, takes a random point on each last segment,
/// and asks the finder for the chain: at most the share `allowed` may be missed. Returns how many chains of each
/// length it was asked for.
fn few_shots_are_missed(name: &str, scene: &Scene, shots: usize, allowed: f64) -> [usize; 4] {
    let mut numbers = Numbers::new(7);
    let mut asked = [0; 4];
    let mut counts = RayCounts::default();
    let mut missed = Vec::new();
    for shot in 0..shots {
        let reach = 2.0 * RADIUS * f64::from(numbers.unit());
        let start = random_direction(&mut numbers) * reach;
        let aim = random_direction(&mut numbers) * 0.9 * RADIUS * f64::from(numbers.unit());
        let toward = (aim - start).normalize().as_vec3a();
        let length = 1 + shot % 3;
        let Some(shot) = shoot(scene, start, toward, length, &mut numbers) else {
            continue;
        };
        let convertible = shot.lobes.len() <= scene.casters.max_length();
        if !convertible || shot.grazing < 0.02 {
            continue;
        }
        let infinite = shot.free.is_infinite() && numbers.unit() < 0.3;
        let end = if infinite {
            Endpoint::Direction(shot.direction.as_dvec3().normalize())
        } else {
            let distance = shot.free.min(2.0 * RADIUS as f32) * numbers.unit().max(0.05);
            Endpoint::Point {
                position: (shot.from + shot.direction * distance).as_dvec3(),
                normal: None,
            }
        };
        let lobes = Lobes::new(&shot.lobes);
        let taken = Candidate {
            direction: toward.as_dvec3(),
            lobes,
            shape: 0,
        };
        let followed = taken.follow(scene, &free_point(start), &end, &mut counts);
        // Near a caustic, the rounding of the end may remove the chain.
        if followed.is_none_or(|chain| chain.jacobian * scale(&end) > FOCUS) {
            continue;
        }
        asked[shot.lobes.len()] += 1;
        let found = find(scene, start, &end);
        let is_it = |candidate: &&Candidate| {
            candidate.lobes == lobes && (candidate.direction.as_vec3a() - toward).length() < 2e-3
        };
        if !found.iter().any(|candidate| is_it(&candidate)) {
            // Rounding in the scene may lose a chain at an edge: brute force then does not find it either.
            let exists = scene.casters.chains_by_brute_force(start, &end);
            if exists.is_empty() || exists.iter().any(|candidate| is_it(&candidate)) {
                missed.push((start, toward, shot.lobes, end));
            }
        }
    }
    let all: usize = asked.iter().sum();
    let share = missed.len() as f64 / all as f64;
    assert!(
        share <= allowed,
        "{name}: missed {} of {asked:?}, the first: {:?}",
        missed.len(),
        missed[0]
    );
    asked
}

#[test]
fn meshes_miss_few_chains_of_one_vertex() {
    let bowl = |x: f64, y: f64| 0.5 * (x * x + y * y);
    let cases = [
        ("waves", scene_of(shape(graph(48, waves)), glass(1.33))),
        (
            "steep waves",
            scene_of(shape(graph(48, |x, y| 3.0 * waves(x, y))), glass(1.5)),
        ),
        (
            "coarse waves",
            scene_of(shape(graph(6, waves)), glass(1.33)),
        ),
        ("mirror bowl", scene_of(shape(graph(24, bowl)), MIRROR)),
        ("bumpy sphere", scene_of(blob(24, false), glass(1.5))),
        ("facets", scene_of(blob(24, true), glass(1.5))),
        (
            "index near 1",
            scene_of(shape(graph(32, waves)), glass(1.001)),
        ),
        ("index 2.4", scene_of(blob(16, false), glass(2.4))),
    ];
    for (name, scene) in cases {
        let asked = few_shots_are_missed(name, &scene, 20_000, 2e-3);
        assert!(asked[1] > 500, "{name}: {asked:?}");
    }
}

#[test]
fn spheres_miss_no_chain() {
    for (name, material) in [
        ("glass", glass(1.5)),
        ("air in glass", glass(1.0 / 1.5)),
        ("mirror", MIRROR),
        ("diamond", glass(2.4)),
    ] {
        let sphere = test_scenes::sphere(DVec3::new(0.1, 0.2, -0.1), 0.7);
        let asked = few_shots_are_missed(name, &scene_of(sphere, material), 20_000, 2e-4);
        assert!(asked[1] > 500, "{name}: {asked:?}");
    }
    let mut inside_out = test_scenes::sphere(DVec3::ZERO, 1.0);
    inside_out.flip_normals = true;
    few_shots_are_missed(
        "inside out",
        &scene_of(inside_out, glass(1.5)),
        20_000,
        2e-4,
    );
}

#[test]
fn flat_faces_miss_few_chains() {
    let slab = || {
        let scale = DMat4::from_scale(DVec3::new(1.0, 0.7, 0.2));
        test_scenes::mesh(TriangleMesh::cube(), scale)
    };
    for (name, shape, material) in [
        ("slab", slab(), glass(1.5)),
        ("slab of low index", slab(), glass(1.2)),
        ("prism", prism(), glass(1.3)),
        ("mirrors", slab(), MIRROR),
        ("pane", shape(TriangleMesh::rectangle()), glass(1.5)),
    ] {
        let asked = few_shots_are_missed(name, &scene_of(shape, material), 30_000, 7e-4);
        assert!(asked[1] > 500, "{name}: {asked:?}");
    }
}

/// The finder returns every solution that Newton's method finds from ten starts in every triangle, for 80 pairs of
/// random ends each.
#[test]
fn meshes_miss_no_solution_of_brute_force() {
    let bowl = |x: f64, y: f64| 0.5 * (x * x + y * y);
    let lens = |x: f64, y: f64| 0.4 - 0.3 * (x * x + y * y);
    let cases = [
        ("waves", scene_of(shape(graph(24, waves)), glass(1.33))),
        ("lens", scene_of(shape(graph(24, lens)), glass(1.5))),
        ("mirror bowl", scene_of(shape(graph(24, bowl)), MIRROR)),
        ("bumpy sphere", scene_of(blob(16, false), glass(1.5))),
        ("facets", scene_of(blob(16, true), glass(1.5))),
    ];
    for (name, scene) in cases {
        let mut numbers = Numbers::new(3);
        let mut point = || random_direction(&mut numbers) * 1.5 * RADIUS;
        let mut compared = 0;
        for query in 0..80 {
            let (start, position) = (point() * 0.8, point());
            let end = if query % 4 == 0 {
                Endpoint::Direction(position.normalize())
            } else {
                Endpoint::Point {
                    position,
                    normal: None,
                }
            };
            let found = find(&scene, start, &end);
            for expected in scene.casters.chains_by_brute_force(start, &end) {
                compared += 1;
                let is_it = |candidate: &Candidate| {
                    candidate.lobes == expected.lobes
                        && candidate.direction.distance(expected.direction) < 1e-6
                };
                assert!(
                    found.iter().any(is_it),
                    "{name}, query {query}: {expected:?} is missed"
                );
            }
        }
        assert!(compared > 20, "{name}: {compared} solutions");
    }
}
