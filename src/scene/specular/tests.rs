//! The finders against chains that random rays take, and the Jacobian against finite differences.

use glam::{DMat4, DVec3, Vec3A};

use super::{Candidate, Chain, Endpoint, Lobes};
use crate::math::{Frame, Rgb};
use crate::scene::bsdf::{DeltaLobe, Material, TransportMode};
use crate::scene::test_scenes::{self, Numbers};
use crate::scene::{
    EmitterDescription, Ray, RayCounts, Scene, ShapeDescription, SurfacePoint, TriangleMesh,
};

/// Of the scene.
const RADIUS: f64 = crate::scene::SCENE_RADIUS as f64;

/// T beyond which a point is too close to a caustic for a comparison, in units of [`scale`].
const FOCUS: f64 = 100.0;

/// Makes T a number without a unit.
fn scale(end: &Endpoint) -> f64 {
    match end {
        Endpoint::Point { .. } => RADIUS * RADIUS,
        Endpoint::Direction(_) => 1.0,
    }
}

fn glass(eta: f32) -> Material {
    Material::Dielectric {
        eta,
        specular_reflectance: 0,
        specular_transmittance: 0,
    }
}

const MIRROR: Material = Material::Conductor {
    eta: Rgb::splat(0.2),
    k: Rgb::splat(4.0),
    specular_reflectance: 0,
};

/// A scene of one shape of this material.
fn scene_of(shape: ShapeDescription, material: Material) -> Scene {
    let constant = EmitterDescription::Constant { radiance: Rgb::ONE };
    let mut description = test_scenes::description(vec![shape], vec![constant]);
    description.materials = vec![material];
    description.build().expect("a scene")
}

/// A point in free space, as a vertex that no ray is offset from in an unexpected direction.
fn free_point(position: DVec3) -> SurfacePoint {
    SurfacePoint {
        position: position.as_vec3a(),
        geometric_normal: Vec3A::ZERO,
        shading: Frame::from_normal(Vec3A::Z),
        uv: glam::Vec2::ZERO,
        shape: 0,
        primitive: 0,
    }
}

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
            &scene.textures,
            point.uv,
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

fn find(scene: &Scene, start: DVec3, end: &Endpoint) -> Vec<Candidate> {
    let mut found = Vec::new();
    scene.casters.chains(start, end, &mut found);
    found
}

fn random_direction(numbers: &mut Numbers) -> DVec3 {
    numbers.direction().as_dvec3()
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

/// A graph z = f(x, y) over [-1, 1]^2 with its normals.
fn graph(n: u32, f: impl Fn(f64, f64) -> f64) -> TriangleMesh {
    let mut mesh = test_scenes::grid(n);
    let slope = |x: f64, y: f64| {
        let step = 1e-5;
        let dx = (f(x + step, y) - f(x - step, y)) / (2.0 * step);
        let dy = (f(x, y + step) - f(x, y - step)) / (2.0 * step);
        DVec3::new(-dx, -dy, 1.0).normalize()
    };
    mesh.normals = mesh
        .positions
        .iter()
        .map(|p| slope(p[0].into(), p[1].into()).as_vec3().to_array())
        .collect();
    for p in &mut mesh.positions {
        p[2] = f(p[0].into(), p[1].into()) as f32;
    }
    mesh
}

fn shape(mesh: TriangleMesh) -> ShapeDescription {
    test_scenes::mesh(mesh, DMat4::IDENTITY)
}

fn waves(x: f64, y: f64) -> f64 {
    0.05 * (5.0 * x + 1.0).sin() * (4.0 * y).cos() + 0.03 * (9.0 * x - 7.0 * y).sin()
}

fn blob(n: u32, flat: bool) -> ShapeDescription {
    let mut mesh = test_scenes::blob(n);
    if !flat {
        mesh.compute_vertex_normals(&DMat4::IDENTITY);
    }
    shape(mesh)
}

/// A prism with a triangular base.
fn prism() -> ShapeDescription {
    let corner = |angle: f32, z: f32| [angle.cos(), angle.sin(), z];
    let angles = [0.3, 2.2, 4.1];
    let mut positions: Vec<[f32; 3]> = angles.map(|a| corner(a, -0.8)).to_vec();
    positions.extend(angles.map(|a| corner(a, 0.8)));
    let mut triangles = vec![[0, 2, 1], [3, 4, 5]];
    for i in 0..3u32 {
        let j = (i + 1) % 3;
        triangles.extend([[i, j, j + 3], [i, j + 3, i + 3]]);
    }
    shape(TriangleMesh {
        positions,
        triangles,
        ..TriangleMesh::default()
    })
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
        let asked = few_shots_are_missed(name, &scene_of(shape, material), 30_000, 2e-3);
        assert!(asked[1] > 500, "{name}: {asked:?}");
    }
}

/// T = |dw / dA| by finite differences: the end moves, and the chain is solved again.
fn finite_difference(scene: &Scene, start: DVec3, end: &Endpoint, chain: &Chain) -> Option<f64> {
    // In scene units, or as an angle.
    let mean = match end {
        Endpoint::Point { .. } => 1e-5 * RADIUS,
        Endpoint::Direction(_) => 1e-5,
    };
    let solved = |end: &Endpoint| {
        let all = find(scene, start, end);
        let near = all.iter().min_by(|a, b| {
            let distance = |c: &Candidate| c.direction.distance(chain.direction.as_dvec3());
            distance(a).total_cmp(&distance(b))
        })?;
        Some(near.direction)
    };
    let (s, t) = chain.to_end.as_dvec3().normalize().any_orthonormal_pair();
    let derivative = |axis: DVec3| {
        let moved = |step: f64| match end {
            Endpoint::Point { position, normal } => Endpoint::Point {
                position: *position + axis * step,
                normal: *normal,
            },
            Endpoint::Direction(direction) => {
                Endpoint::Direction((*direction + axis * step).normalize())
            }
        };
        Some((solved(&moved(mean))? - solved(&moved(-mean))?) / (2.0 * mean))
    };
    Some(derivative(s)?.cross(derivative(t)?).length())
}

#[test]
fn jacobians_agree_with_finite_differences() {
    let cases = [
        ("waves", scene_of(shape(graph(24, waves)), glass(1.33))),
        (
            "bowl",
            scene_of(shape(graph(24, |x, y| 0.4 * (x * x + y * y))), MIRROR),
        ),
        (
            "ball",
            scene_of(test_scenes::sphere(DVec3::ZERO, 0.6), glass(1.5)),
        ),
        ("prism", scene_of(prism(), glass(1.4))),
    ];
    for (name, scene) in cases {
        let mut numbers = Numbers::new(11);
        let (mut compared, mut counts) = (0, RayCounts::default());
        while compared < 60 {
            let start = random_direction(&mut numbers) * 1.6 * RADIUS;
            let end = if numbers.unit() < 0.3 {
                Endpoint::Direction(random_direction(&mut numbers))
            } else {
                let position = random_direction(&mut numbers) * 1.6 * RADIUS;
                Endpoint::Point {
                    position,
                    normal: None,
                }
            };
            for candidate in find(&scene, start, &end) {
                let point = free_point(start);
                let Some(chain) = candidate.follow(&scene, &point, &end, &mut counts) else {
                    continue;
                };
                let Some(expected) = finite_difference(&scene, start, &end, &chain) else {
                    continue;
                };
                // Near a fold, differences are not small enough.
                if chain.jacobian * scale(&end) > FOCUS {
                    continue;
                }
                compared += 1;
                let error = (chain.jacobian / expected - 1.0).abs();
                assert!(
                    error < 5e-3,
                    "{name}: {} and {expected}, {start} {end:?}",
                    chain.jacobian
                );
            }
        }
    }
}
