//! Random walks from the lens and from the lights.

use glam::{Vec2, Vec3A};

use super::dimensions;
use super::environment::EnvironmentVertex;
use super::mis::PartialMis;
use super::specular::specular_over_subpath;
use super::vertex::Vertex;
use crate::math::Rgb;
use crate::sampling::Sampler;
use crate::scene::specular::Candidate;
use crate::scene::{ChainEnd, EmissionSample, Ray, RayCounts, Scene, TransportMode};

/// Upper bound on the survival probability at the i-th vertex once Russian roulette is active. With it
/// every subpath ends, even if no light is absorbed.
///
/// The probability that a subpath reaches n vertices falls as n^-3. So the mean of n^2 is finite, and with
/// it the cost of connecting two subpaths. The mean of n is about 75. The weight of a surviving subpath
/// grows as n^3. A constant bound, as is common (0.95, say), makes the weight grow as 0.95^-n. If a
/// scattering event loses less than 1 - sqrt(0.95) = 2.5% of the light, the variance is then infinite, and
/// most images are too dark. Here it is finite if every scattering event loses any light.
#[inline]
fn max_survival(i: usize) -> f32 {
    1.0 - 3.0 / (150.0 + i as f32)
}

/// Initial capacity of a subpath, in vertices.
const CAPACITY: usize = 64;

/// The vertices of a subpath; element i is z_{i+1} or y_{i+1}.
#[derive(Debug)]
pub struct Subpath {
    /// z_0, a point on the lens, or y_0, a point on a light.
    pub start: Vec3A,
    /// Surface vertices in the order of the walk.
    pub vertices: Vec<Vertex>,
    /// Set if a camera subpath left the scene after the last vertex.
    pub environment: Option<EnvironmentVertex>,
    /// Memory for specular chains.
    candidates: Vec<Candidate>,
}

impl Default for Subpath {
    fn default() -> Self {
        Self {
            start: Vec3A::ZERO,
            vertices: Vec::with_capacity(CAPACITY),
            environment: None,
            candidates: Vec::with_capacity(CAPACITY),
        }
    }
}

impl Subpath {
    /// Removes all vertices.
    #[inline]
    pub fn clear(&mut self) {
        self.vertices.clear();
        self.environment = None;
    }

    /// Position of the predecessor of element `i`.
    #[inline]
    pub fn position_before(&self, i: usize) -> Vec3A {
        match i {
            0 => self.start,
            _ => self.vertices[i - 1].position(),
        }
    }
}

/// The step from one vertex to the next.
struct Step {
    ray: Ray,
    /// Position of the vertex at which the step starts. The ray's origin is offset from its surface.
    from: Vec3A,
    /// Throughput on arrival.
    throughput: Rgb,
    /// Density of the direction, per steradian (per unit area of the disk for light from infinity).
    pdf: f64,
    kind: StepKind,
}

/// The vertex at which a step starts, as far as MIS weights depend on it.
enum StepKind {
    Lens,
    Light {
        sample: EmissionSample,
    },
    Surface {
        /// r_i of [`super::mis`].
        reverse: f64,
        delta: bool,
        cos: f64,
    },
}

/// Traces a camera subpath through film position `film` and stores at most `max_vertices` surface
/// vertices in `subpath`.
#[inline]
pub fn trace_camera_subpath<S: Sampler>(
    scene: &Scene,
    film: Vec2,
    max_vertices: usize,
    sampler: &mut S,
    counts: &mut RayCounts,
    subpath: &mut Subpath,
) {
    let lens = if scene.camera.has_lens() {
        Vec2::from(sampler.get::<2>(dimensions::LENS))
    } else {
        Vec2::ZERO
    };
    let (ray, from) = scene.camera.ray(film, lens);
    let first = Step {
        ray,
        from,
        throughput: Rgb::ONE,
        pdf: f64::from(scene.camera.direction_pdf(ray.direction)),
        kind: StepKind::Lens,
    };
    let mut walk = Walk {
        scene,
        mode: TransportMode::Radiance,
        chain_end: None,
        counts,
        subpath,
    };
    walk.run(first, max_vertices, sampler);
}

/// Traces a light subpath and stores at most `max_vertices` surface vertices in `subpath`.
#[inline]
pub fn trace_light_subpath<S: Sampler>(
    scene: &Scene,
    max_vertices: usize,
    sampler: &mut S,
    counts: &mut RayCounts,
    subpath: &mut Subpath,
) {
    subpath.clear();
    if max_vertices == 0 {
        return;
    }
    let [u_light, u_primitive, x, y, a, b] = sampler.get::<6>(dimensions::EMISSION);
    let sample =
        scene
            .emitters
            .sample_emission(u_light, u_primitive, Vec2::new(x, y), Vec2::new(a, b));
    let Some(sample) = sample else { return };
    let ray = Ray {
        origin: sample.origin,
        direction: sample.direction,
        t_max: f32::INFINITY,
    };
    let first = Step {
        ray,
        from: sample.position,
        throughput: sample.weight,
        pdf: f64::from(sample.pdf_direction),
        kind: StepKind::Light { sample },
    };
    let chain_end = if scene.has_chains() && scene.casters.everywhere() {
        scene.emitters.chain_end_of(&sample)
    } else {
        None
    };
    let mut walk = Walk {
        scene,
        mode: TransportMode::Importance,
        chain_end,
        counts,
        subpath,
    };
    walk.run(first, max_vertices, sampler);
}

/// A random walk that stores its vertices in `subpath`.
struct Walk<'a> {
    scene: &'a Scene,
    mode: TransportMode,
    /// The start of a light subpath, while all its vertices are delta vertices and technique 1* may end a chain
    /// there.
    chain_end: Option<ChainEnd>,
    counts: &'a mut RayCounts,
    subpath: &'a mut Subpath,
}

impl Walk<'_> {
    #[inline]
    fn run<S: Sampler>(&mut self, first: Step, max_vertices: usize, sampler: &mut S) {
        self.subpath.clear();
        self.subpath.start = first.from;
        let mut step = first;
        // Throughput without the emission and without radiance scaling by eta^2, for Russian roulette.
        let mut rr_throughput = Rgb::ONE;
        for i in 1..=max_vertices {
            let Some(vertex) = self.arrive(&step) else {
                return;
            };
            self.subpath.vertices.push(vertex);
            if i == max_vertices {
                return;
            }
            let Some(next) = self.scatter(&vertex, i, &mut rr_throughput, sampler) else {
                return;
            };
            step = next;
        }
    }

    /// The vertex at the end of `step`; `None` if the ray leaves the scene.
    #[inline]
    fn arrive(&mut self, step: &Step) -> Option<Vertex> {
        let is_from_lens = matches!(step.kind, StepKind::Lens);
        let surface = if is_from_lens {
            self.scene.seen_from_camera(&step.ray, self.counts)
        } else {
            self.scene.geometry.intersect(&step.ray, self.counts)
        };
        let Some(surface) = surface else {
            let is_hidden = is_from_lens && self.scene.hide_emitters;
            if self.mode == TransportMode::Radiance && !is_hidden {
                self.subpath.environment = Some(self.leave(step));
            }
            return None;
        };
        let mut vertex = Vertex {
            material: self.scene.geometry.material(surface.shape),
            surface,
            to_previous: -step.ray.direction,
            throughput: step.throughput,
            mis: PartialMis::default(),
        };
        vertex.mis = self.partial_mis(step, &vertex)?;
        self.weigh_chain(&mut vertex);
        Some(vertex)
    }

    /// Sets the term of technique 1* at `vertex`, if it is the first of a light subpath after a chain of delta
    /// vertices.
    #[inline]
    fn weigh_chain(&mut self, vertex: &mut Vertex) {
        let (Some(end), false) = (&self.chain_end, self.subpath.vertices.is_empty()) else {
            return;
        };
        if vertex.mis.connectible {
            // The vertex before scattered by a lobe with a density.
            self.chain_end = None;
        } else if vertex.is_connectible(self.scene) {
            let Subpath {
                vertices,
                candidates,
                ..
            } = &mut *self.subpath;
            vertex.mis.specular =
                specular_over_subpath(self.scene, vertex, vertices, end, candidates, self.counts);
        }
    }

    /// The partial MIS sums at `vertex`, the end of `step`.
    #[inline]
    fn partial_mis(&self, step: &Step, vertex: &Vertex) -> Option<PartialMis> {
        let direction = step.ray.direction;
        let distance_squared = f64::from((vertex.position() - step.from).length_squared());
        Some(match &step.kind {
            StepKind::Lens => {
                let camera = &self.scene.camera;
                let distance_squared = camera.squared_distance(step.from, vertex.position());
                let density = vertex.density(step.pdf, direction, distance_squared.into());
                PartialMis::after_lens(density)
            }
            StepKind::Light { sample } => {
                // For light from infinity the density is already per unit area.
                let (distance_squared, jacobian) = if sample.infinite {
                    (1.0, 1.0)
                } else {
                    let cos = f64::from(sample.normal.dot(direction).abs());
                    (distance_squared, cos / distance_squared)
                };
                let pdf_direct = self.scene.emitters.direct_pdf(sample, vertex.position());
                PartialMis::after_light(
                    vertex.density(step.pdf, direction, distance_squared),
                    f64::from(sample.pdf_position),
                    f64::from(pdf_direct),
                    jacobian,
                    !sample.delta,
                )
            }
            StepKind::Surface {
                reverse,
                delta,
                cos,
            } => self.subpath.vertices.last()?.mis.extend(
                *reverse,
                *delta,
                cos / distance_squared,
                vertex.density(step.pdf, direction, distance_squared),
            ),
        })
    }

    /// The step from `vertex`, the i-th, to the next; `None` if the subpath ends.
    #[inline]
    fn scatter<S: Sampler>(
        &self,
        vertex: &Vertex,
        i: usize,
        rr_throughput: &mut Rgb,
        sampler: &mut S,
    ) -> Option<Step> {
        let block = match self.mode {
            TransportMode::Radiance => dimensions::camera_vertex(i),
            TransportMode::Importance => dimensions::light_vertex(i),
        };
        let [lobe, u, v, roulette] = sampler.get::<{ dimensions::PER_VERTEX }>(block);
        let uv = Vec2::new(u, v);
        let sample = vertex.sample(self.scene, self.mode, lobe, uv)?;
        let mut weight = sample.weight;
        // The throughput of a camera subpath is scaled by 1/eta^2 where the path enters a denser medium,
        // and by eta^2 where it leaves it. Russian roulette must not treat this as absorption.
        *rr_throughput *= match self.mode {
            TransportMode::Radiance => weight * (sample.bsdf.eta * sample.bsdf.eta),
            TransportMode::Importance => weight,
        };
        if i >= self.scene.depth.rr_depth as usize {
            let q = rr_throughput.max_element().min(max_survival(i));
            if roulette >= q {
                return None;
            }
            weight /= q;
            *rr_throughput /= q;
        }
        let throughput = vertex.throughput * weight;
        if throughput == Rgb::ZERO {
            return None;
        }
        let kind = StepKind::Surface {
            reverse: f64::from(sample.bsdf.reverse_pdf),
            delta: sample.bsdf.delta,
            cos: f64::from(sample.cos),
        };
        let ray = Ray {
            origin: vertex.ray_origin(sample.direction),
            direction: sample.direction,
            t_max: f32::INFINITY,
        };
        Some(Step {
            ray,
            from: vertex.position(),
            throughput,
            pdf: f64::from(sample.bsdf.pdf),
            kind,
        })
    }

    /// The vertex at infinity at the end of `step`. Its density is per steradian.
    #[inline]
    fn leave(&self, step: &Step) -> EnvironmentVertex {
        let mis = match (&step.kind, self.subpath.vertices.last()) {
            (
                StepKind::Surface {
                    reverse,
                    delta,
                    cos,
                },
                Some(last),
            ) => last.mis.extend(*reverse, *delta, *cos, step.pdf),
            _ => PartialMis::after_lens(step.pdf),
        };
        EnvironmentVertex {
            direction: step.ray.direction,
            throughput: step.throughput,
            mis,
        }
    }
}
