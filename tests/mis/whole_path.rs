//! Whole paths, and the density with which each technique (s, t) samples them.

use glam::{Vec2, Vec3A};
use metrolight::integrators::Workspace;
use metrolight::path::{EnvironmentVertex, Vertex, dimensions};
use metrolight::sampling::{IndependentSampler, Sampler};
use metrolight::scene::specular::Endpoint;
use metrolight::scene::{ChainEnd, LightEvaluation, Scene, SurfacePoint, TransportMode};
use metrolight::technique::Technique;

use super::chain::sampled_chain;

/// The end of a path on an emitter.
pub struct Emitter {
    /// `None` for infinite emitters, which have only `direction`.
    position: Option<Vec3A>,
    /// Unit, from x_1 to x_0.
    pub direction: Vec3A,
    /// |cos| at x_0.
    cos: f64,
    densities: LightEvaluation,
    /// A camera subpath can hit it.
    can_be_hit: bool,
    /// As the end of a chain of technique 1*; `None` if no chain ends there.
    pub chain_end: Option<ChainEnd>,
}

/// A whole path from the emitter to the lens.
pub struct WholePath<'a> {
    pub scene: &'a Scene,
    pub emitter: Emitter,
    /// x_1 ... x_{k-1}, each with the index of its material.
    pub surfaces: Vec<(SurfacePoint, u32)>,
    lens: Vec3A,
}

impl WholePath<'_> {
    pub fn edges(&self) -> usize {
        self.surfaces.len() + 1
    }

    pub fn position(&self, i: usize) -> Vec3A {
        if i > self.surfaces.len() {
            self.lens
        } else {
            self.surfaces[i - 1].0.position
        }
    }

    /// Unit, from x_i toward its neighbour on the light's side.
    pub fn to_light(&self, i: usize) -> Vec3A {
        if i == 1 {
            self.emitter.direction
        } else {
            (self.position(i - 1) - self.position(i)).normalize()
        }
    }

    pub fn to_camera(&self, i: usize) -> Vec3A {
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
    pub fn step(&self, i: usize) -> (f64, f64, bool) {
        let (surface, material) = &self.surfaces[i - 1];
        let material = &self.scene.materials[*material as usize];
        let to_light = surface.shading.to_local(self.to_light(i));
        let to_camera = surface.shading.to_local(self.to_camera(i));
        // A delta lobe is recognised by sampling it.
        for k in 0..64 {
            let lobe = (k as f32 + 0.5) / 64.0;
            let u = Vec2::splat(0.5);
            let mode = TransportMode::Radiance;
            let context = self.scene.material_context(surface);
            let sample = material.sample(&context, to_camera, mode, lobe, u);
            if let Some(sample) = sample.filter(|s| s.delta)
                && (sample.direction - to_light).length() < 2e-3
            {
                return (f64::from(sample.pdf), f64::from(sample.reverse_pdf), true);
            }
        }
        let s = material.evaluate(&self.scene.material_context(surface), to_light, to_camera);
        (f64::from(s.pdf_to_light), f64::from(s.pdf_to_camera), false)
    }

    /// Density of technique `s`, in the product of native measures; `None` if it cannot sample the
    /// path.
    pub fn density(&self, s: usize) -> Option<f64> {
        let k = self.edges();
        let t = k + 1 - s;
        // Directly visible emitters are left to s = 0, and no path hits the lens.
        if t == 0 || (k == 1 && s > 0) || (s == 0 && !self.emitter.can_be_hit) {
            return None;
        }
        if s > 0 && !self.connects(s) {
            return None;
        }
        Some(self.light_density(s) * self.camera_density(t))
    }

    /// Neither end of the edge that connects `s` light vertices to the others may scatter by a delta lobe.
    pub fn connects(&self, s: usize) -> bool {
        let joins = |i: usize| i == 0 || i == self.edges() || !self.step(i).2;
        joins(s - 1) && joins(s)
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

    pub fn camera_density(&self, t: usize) -> f64 {
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
            density *= pdf * self.area_per_angle(i);
        }
        density
    }

    /// |cos| at x_i over the squared distance from x_{i+1}: per unit area from per steradian.
    pub fn area_per_angle(&self, i: usize) -> f64 {
        if i > 0 {
            self.cos(i, self.to_camera(i)) / self.distance_squared(i, i + 1)
        } else {
            self.emitter.position.map_or(1.0, |p| {
                self.emitter.cos / f64::from((p - self.position(1)).length_squared())
            })
        }
    }

    /// Of a technique among all of them: the power heuristic with beta = 2. `None` if the density of technique 1*
    /// is not known.
    pub fn weight(&self, technique: Technique) -> Option<f64> {
        let power = |p: Option<f64>| p.map_or(0.0, |p| p * p);
        let specular = power(self.specular_density().ok()?);
        let others: f64 = (0..=self.edges()).map(|s| power(self.density(s))).sum();
        let own = match technique {
            Technique::Specular { .. } => specular,
            _ => power(self.density(technique.s())),
        };
        Some(own / (specular + others))
    }
}

/// Rebuilds the path of a connection from the subpaths and the sample that generated it. Of the paths of
/// technique 1* with the same numbers of vertices it is number `number`.
pub fn whole_path<'a>(
    scene: &'a Scene,
    technique: Technique,
    number: usize,
    workspace: &Workspace,
    sampler: &mut IndependentSampler,
) -> WholePath<'a> {
    let (s, t) = (technique.s(), technique.t());
    let camera = &workspace.camera.vertices[..];
    let environment = workspace.camera.environment.as_ref();
    let end = camera.len().min(t - 1);
    let mut surfaces: Vec<(SurfacePoint, u32)> = Vec::new();
    let pair = |v: &Vertex| (v.surface, v.material);
    if let Technique::Specular { n, .. } = technique {
        let (end, chain) = sampled_chain(scene, &camera[t - 2], (t - 1, n, number), sampler);
        surfaces.extend(chain);
        surfaces.extend(camera[..t - 1].iter().rev().map(pair));
        let first = surfaces[0].0.position;
        return WholePath {
            scene,
            emitter: Emitter::at_chain_end(&end, first),
            surfaces,
            lens: scene.camera.position(),
        };
    }
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

impl Emitter {
    /// The end of a chain whose first vertex next to it is at `first`.
    fn at_chain_end(end: &ChainEnd, first: Vec3A) -> Self {
        let (direction, _) = end.end.from(first.as_dvec3());
        let direction = direction.as_vec3a();
        let (position, normal) = match end.end {
            Endpoint::Point { position, normal } => (Some(position.as_vec3a()), normal),
            Endpoint::Direction(_) => (None, None),
        };
        let cos = normal.map_or(1.0, |n| f64::from(n.as_vec3a().dot(direction).abs()));
        let densities = LightEvaluation {
            radiance: end.radiance,
            // The vertex next to the emitter scatters by a delta lobe: s = 1 does not sample the path.
            pdf_direct: f32::NAN,
            pdf_position: end.pdf_position as f32,
            pdf_direction: end.pdf_direction(direction) as f32,
        };
        Self {
            position,
            direction,
            cos,
            densities,
            can_be_hit: !end.delta,
            chain_end: Some(*end),
        }
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
            chain_end: scene.emitters.chain_end_at(direction),
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
        chain_end: scene.emitters.chain_end_on(&surface),
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
        // The vertex next to the emitter has a density, so that there is no chain.
        chain_end: None,
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
        chain_end: scene.emitters.chain_end_of(&sample),
    }
}
