//! The O(1) MIS weights against a slow reference that multiplies out the density of every technique.
//!
//! The reference evaluates whole paths and shares only the densities of single steps with the recursion.
//! Its weights sum to 1 by construction, and so do the fast ones if they are equal.

mod common;
#[path = "mis/random.rs"]
mod random;

use std::collections::BTreeMap;

use glam::{Vec2, Vec3A};
use metrolight::integrators::{BidirectionalPathTracer, PathSampler, Workspace};
use metrolight::path::{EnvironmentVertex, Vertex, dimensions};
use metrolight::sampling::{IndependentSampler, Sampler};
use metrolight::scene::{Casters, LightEvaluation, Scene, SurfacePoint, TransportMode};
use metrolight::technique::Technique;
use proptest::prelude::*;
use random::random_scene;

/// The end of a path on an emitter.
struct Emitter {
    /// `None` for infinite emitters, which have only `direction`.
    position: Option<Vec3A>,
    /// Unit, from x_1 to x_0.
    direction: Vec3A,
    /// |cos| at x_0.
    cos: f64,
    densities: LightEvaluation,
    /// A camera subpath can hit it.
    can_be_hit: bool,
}

/// A whole path from the emitter to the lens.
struct WholePath<'a> {
    scene: &'a Scene,
    emitter: Emitter,
    /// x_1 ... x_{k-1}.
    surfaces: Vec<(SurfacePoint, u32)>,
    lens: Vec3A,
}

impl WholePath<'_> {
    fn edges(&self) -> usize {
        self.surfaces.len() + 1
    }

    fn position(&self, i: usize) -> Vec3A {
        if i > self.surfaces.len() {
            self.lens
        } else {
            self.surfaces[i - 1].0.position
        }
    }

    /// Unit, from x_i toward its neighbour on the light's side.
    fn to_light(&self, i: usize) -> Vec3A {
        if i == 1 {
            self.emitter.direction
        } else {
            (self.position(i - 1) - self.position(i)).normalize()
        }
    }

    fn to_camera(&self, i: usize) -> Vec3A {
        (self.position(i + 1) - self.position(i)).normalize()
    }

    fn cos(&self, i: usize, direction: Vec3A) -> f64 {
        f64::from(self.surfaces[i - 1].0.geometric_normal.dot(direction).abs())
    }

    fn distance_squared(&self, i: usize, j: usize) -> f64 {
        f64::from((self.position(i) - self.position(j)).length_squared())
    }

    /// Densities at x_i, per steradian, of sampling the direction to the light and to the camera, and
    /// whether the path takes a delta lobe there.
    fn step(&self, i: usize) -> (f64, f64, bool) {
        let (surface, material) = &self.surfaces[i - 1];
        let material = &self.scene.materials[*material as usize];
        let to_light = surface.shading.to_local(self.to_light(i));
        let to_camera = surface.shading.to_local(self.to_camera(i));
        // A delta lobe is recognised by sampling it.
        for k in 0..64 {
            let lobe = (k as f32 + 0.5) / 64.0;
            let u = Vec2::splat(0.5);
            let mode = TransportMode::Radiance;
            let textures = &self.scene.textures;
            let sample = material.sample(textures, surface.uv, to_camera, mode, lobe, u);
            if let Some(sample) = sample.filter(|s| s.delta)
                && (sample.direction - to_light).length() < 2e-3
            {
                return (f64::from(sample.pdf), f64::from(sample.reverse_pdf), true);
            }
        }
        let s = material.evaluate(&self.scene.textures, surface.uv, to_light, to_camera);
        (f64::from(s.pdf_to_light), f64::from(s.pdf_to_camera), false)
    }

    /// Density of technique `s`, in the product of native measures; `None` if it cannot sample the
    /// path.
    fn density(&self, s: usize) -> Option<f64> {
        let k = self.edges();
        let t = k + 1 - s;
        // Directly visible emitters are left to s = 0, and no path hits the lens.
        if t == 0 || (k == 1 && s > 0) || (s == 0 && !self.emitter.can_be_hit) {
            return None;
        }
        // Neither end of the connecting edge may scatter by a delta lobe.
        let joins = |i: usize| i == 0 || i == k || !self.step(i).2;
        if s > 0 && !(joins(s - 1) && joins(s)) {
            return None;
        }
        Some(self.light_density(s) * self.camera_density(t))
    }

    fn light_density(&self, s: usize) -> f64 {
        let densities = &self.emitter.densities;
        match s {
            0 => return 1.0,
            1 => return f64::from(densities.pdf_direct),
            _ => (),
        }
        let spread = self.emitter.position.map_or(1.0, |p| {
            1.0 / f64::from((p - self.position(1)).length_squared())
        });
        let mut density = f64::from(densities.pdf_position)
            * f64::from(densities.pdf_direction)
            * spread
            * self.cos(1, self.emitter.direction);
        for i in 1..s - 1 {
            let (_, to_camera, _) = self.step(i);
            density *=
                to_camera * self.cos(i + 1, self.to_light(i + 1)) / self.distance_squared(i, i + 1);
        }
        density
    }

    fn camera_density(&self, t: usize) -> f64 {
        let k = self.edges();
        let mut density = 1.0;
        for n in 1..t {
            // Vertex x_i is reached from x_{i+1}.
            let i = k - n;
            let pdf = if i + 1 == k {
                let from = if i == 0 {
                    self.emitter.direction
                } else {
                    -self.to_camera(i)
                };
                f64::from(self.scene.camera.direction_pdf(from))
            } else {
                self.step(i + 1).0
            };
            density *= pdf
                * if i > 0 {
                    self.cos(i, self.to_camera(i)) / self.distance_squared(i, i + 1)
                } else {
                    self.emitter.position.map_or(1.0, |p| {
                        self.emitter.cos / f64::from((p - self.position(1)).length_squared())
                    })
                };
        }
        density
    }

    /// Of the power heuristic with beta = 2.
    fn weight(&self, s: usize) -> f64 {
        let power = |s| self.density(s).map_or(0.0, |p| p * p);
        let total: f64 = (0..=self.edges()).map(power).sum();
        power(s) / total
    }
}

/// Rebuilds the path of a connection from the subpaths and the sample that generated it.
fn whole_path<'a>(
    scene: &'a Scene,
    technique: Technique,
    workspace: &Workspace,
    sampler: &mut IndependentSampler,
) -> WholePath<'a> {
    let (s, t) = (technique.s(), technique.t());
    let camera = &workspace.camera.vertices[..];
    let environment = workspace.camera.environment.as_ref();
    let end = camera.len().min(t - 1);
    let mut surfaces: Vec<(SurfacePoint, u32)> = Vec::new();
    let pair = |v: &Vertex| (v.surface, v.material);
    if s >= 2 {
        surfaces.extend(workspace.light.vertices[..s - 1].iter().map(pair));
    }
    surfaces.extend(camera[..end].iter().rev().map(pair));
    let emitter = match s {
        0 => hit_emitter(scene, &mut surfaces, camera, environment, t),
        1 => sampled_emitter(scene, &camera[t - 2], t - 1, sampler),
        _ => emitting(scene, surfaces[0].0.position, sampler),
    };
    WholePath {
        scene,
        emitter,
        surfaces,
        lens: scene.camera.position(),
    }
}

fn hit_emitter(
    scene: &Scene,
    surfaces: &mut Vec<(SurfacePoint, u32)>,
    camera: &[Vertex],
    environment: Option<&EnvironmentVertex>,
    t: usize,
) -> Emitter {
    if t - 1 > camera.len() {
        let vertex = environment.expect("a hit beyond the last vertex is one of the environment");
        let densities = scene
            .emitters
            .evaluate_environment(vertex.direction)
            .unwrap();
        let direction = vertex.direction;
        return Emitter {
            position: None,
            direction,
            cos: 1.0,
            densities,
            can_be_hit: true,
        };
    }
    let (surface, _) = surfaces.remove(0);
    let from = surfaces
        .first()
        .map_or(scene.camera.position(), |(s, _)| s.position);
    let direction = (surface.position - from).normalize();
    Emitter {
        position: Some(surface.position),
        direction,
        cos: f64::from(surface.geometric_normal.dot(direction).abs()),
        densities: scene.emitters.evaluate_surface(&surface, from).unwrap(),
        can_be_hit: true,
    }
}

fn sampled_emitter(
    scene: &Scene,
    z: &Vertex,
    i: usize,
    sampler: &mut IndependentSampler,
) -> Emitter {
    let [u_light, u_primitive, x, y] = sampler.get(dimensions::next_event(i));
    let from = z.surface.position;
    let direct = scene
        .emitters
        .sample_direct(from, u_light, u_primitive, Vec2::new(x, y))
        .unwrap();
    let distance_squared = 1.0 / f64::from(direct.jacobian_area);
    let infinite = direct.jacobian_area == 1.0;
    Emitter {
        position: (!infinite).then(|| from + direct.direction * (distance_squared.sqrt() as f32)),
        direction: direct.direction,
        cos: f64::from(direct.jacobian_direction) * distance_squared,
        densities: direct.emission,
        can_be_hit: !direct.delta,
    }
}

fn emitting(scene: &Scene, first: Vec3A, sampler: &mut IndependentSampler) -> Emitter {
    let [u_light, u_primitive, x, y, a, b] = sampler.get(dimensions::EMISSION);
    let sample = scene
        .emitters
        .sample_emission(u_light, u_primitive, Vec2::new(x, y), Vec2::new(a, b))
        .unwrap();
    let densities = LightEvaluation {
        radiance: sample.weight,
        pdf_direct: scene.emitters.direct_pdf(&sample, first),
        pdf_position: sample.pdf_position,
        pdf_direction: sample.pdf_direction,
    };
    Emitter {
        position: (!sample.infinite).then_some(sample.position),
        direction: -sample.direction,
        cos: f64::from(sample.normal.dot(sample.direction).abs()),
        densities,
        can_be_hit: !sample.delta,
    }
}

/// Compares all connections of `samples` pairs of subpaths; returns the number of each technique.
fn compare(scene: &Scene, samples: u64) -> BTreeMap<(usize, usize), u32> {
    assert!(!scene.has_chains(), "technique 1* has tests of its own");
    let mut workspace = Workspace::default();
    let mut seen = BTreeMap::new();
    for i in 0..samples {
        let mut made = Vec::new();
        let sampler = &mut common::sample(i);
        BidirectionalPathTracer.sample_paths(scene, sampler, &mut workspace, |p| made.push(p));
        for connection in made {
            let technique = connection.technique;
            let path = whole_path(scene, technique, &workspace, sampler);
            let reference = path.weight(technique.s());
            let weight = f64::from(connection.weight);
            assert!(
                (weight - reference).abs() < 2e-3 + 0.01 * reference,
                "sample {i}, {technique}: weight {weight}, reference {reference}"
            );
            *seen.entry((technique.s(), technique.t())).or_default() += 1;
        }
    }
    seen
}

/// A quarter of the usual number of cases; `tests/properties.rs` says how to try more.
fn scenes() -> ProptestConfig {
    let config = ProptestConfig::default();
    ProptestConfig {
        cases: config.cases.div_ceil(4),
        max_shrink_iters: 50,
        ..config
    }
}

proptest! {
    #![proptest_config(scenes())]

    /// As below, for random scenes. It follows that the weights of all techniques sum to 1 and are not
    /// negative, as those of the reference.
    #[test]
    fn weights_equal_the_reference_in_any_scene(
        u in prop::collection::vec(0.0f32..1.0, 40),
    ) {
        let mut scene = random_scene(&u);
        scene.casters = Casters::none();
        let seen = compare(&scene, 100);
        prop_assert!(!seen.is_empty());
    }
}

#[test]
fn weights_equal_the_reference_on_all_kinds_of_emitters_and_materials() {
    for (name, must_see) in [
        (
            "mis-area.xml",
            vec![
                (0, 2),
                (0, 3),
                (0, 5),
                (1, 2),
                (1, 4),
                (2, 1),
                (3, 1),
                (2, 2),
                (3, 3),
            ],
        ),
        (
            "mis-point.xml",
            vec![(1, 2), (1, 4), (2, 1), (3, 1), (2, 2), (3, 3)],
        ),
        (
            "mis-environment.xml",
            vec![(0, 2), (0, 4), (1, 2), (1, 4), (2, 1), (3, 1), (2, 2)],
        ),
    ] {
        let mut scene = common::load(&format!("tests/scenes/{name}"), &[]);
        scene.casters = Casters::none();
        let seen = compare(&scene, 8000);
        for technique in &must_see {
            let count = seen.get(technique).copied().unwrap_or(0);
            assert!(
                count >= 20,
                "{name}: technique {technique:?} was made {count} times"
            );
        }
    }
}
