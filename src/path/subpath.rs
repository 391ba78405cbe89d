//! Random walks from the lens and from the emitters.

use glam::{Vec2, Vec3A};

use super::dimensions;
use super::endpoint::Escape;
use super::mis::{Carried, Heuristic};
use super::vertex::Vertex;
use crate::fault::{Fault, planted};
use crate::math::Rgb;
use crate::sampling::{Coordinates, Stream};
use crate::scene::{EmissionSample, Ray, RayCounts, Scene, TransportMode};

/// Russian roulette, once it plays, lets no subpath survive its i-th vertex with a greater probability
/// than this, so that every subpath ends, even where no light is ever absorbed.
///
/// There it has n vertices with a probability that falls as n^-3, so that the mean of n^2 is finite,
/// and with it the work of joining two subpaths: some 75 vertices on average. Its weight grows as
/// n^3. With the same bound at every vertex, as is common (0.95, say), the weight grows as 0.95^-n:
/// where a bounce loses less than 1 - sqrt(0.95) = 2.5% of the light, the variance is then infinite
/// and most images are too dark. Here it is finite wherever a bounce loses anything at all.
#[inline]
fn greatest_survival(i: usize) -> f32 {
    1.0 - 3.0 / (150.0 + i as f32)
}

/// Room for this many vertices is made at once; longer subpaths grow it.
const CAPACITY: usize = 64;

/// The surface vertices of a subpath; element i is z_{i+1} or y_{i+1}.
#[derive(Debug)]
pub struct Subpath {
    /// Where it begins: a point on the lens, or y_0.
    pub start: Vec3A,
    /// In the order of the walk.
    pub vertices: Vec<Vertex>,
    /// Set if a camera subpath left the scene after the last vertex.
    pub escape: Option<Escape>,
}

impl Default for Subpath {
    fn default() -> Self {
        Self {
            start: Vec3A::ZERO,
            vertices: Vec::with_capacity(CAPACITY),
            escape: None,
        }
    }
}

/// The step from one vertex to the next.
struct Step {
    ray: Ray,
    /// Point that the ray really starts from, before it is moved off its surface.
    from: Vec3A,
    /// Throughput on arrival.
    throughput: Rgb,
    /// Density of the direction, per steradian (per unit area of the disk for light from infinity).
    pdf: f64,
    kind: StepKind,
}

/// What the step leaves, as far as weights care.
enum StepKind {
    Lens,
    Emitter { sample: EmissionSample },
    Surface { reverse: f64, delta: bool, cos: f64 },
}

/// Walks from the lens through film position `film` and appends at most `max_vertices` surface
/// vertices to `subpath`, which is emptied first.
#[inline]
pub fn walk_camera<C: Coordinates>(
    scene: &Scene,
    heuristic: Heuristic,
    film: Vec2,
    max_vertices: usize,
    point: &mut C,
    counts: &mut RayCounts,
    subpath: &mut Subpath,
) {
    let lens = if scene.camera.is_pinhole() {
        Vec2::ZERO
    } else {
        Vec2::from(point.read::<2>(Stream::Camera, dimensions::LENS))
    };
    let (ray, from) = scene.camera.ray(film, lens);
    let pdf = f64::from(scene.camera.direction_pdf(ray.direction));
    let first = Step {
        ray,
        from,
        throughput: Rgb::ONE,
        pdf,
        kind: StepKind::Lens,
    };
    let mut walk = Walk {
        scene,
        heuristic,
        mode: TransportMode::Radiance,
        counts,
        subpath,
    };
    walk.run(first, max_vertices, point);
}

/// Walks from an emitter and appends at most `max_vertices` surface vertices to `subpath`, which is
/// emptied first.
#[inline]
pub fn walk_light<C: Coordinates>(
    scene: &Scene,
    heuristic: Heuristic,
    max_vertices: usize,
    point: &mut C,
    counts: &mut RayCounts,
    subpath: &mut Subpath,
) {
    subpath.vertices.clear();
    subpath.escape = None;
    if max_vertices == 0 {
        return;
    }
    let [choose, part, x, y, a, b] = point.read::<6>(Stream::Light, dimensions::EMISSION);
    let sample = scene
        .emitters
        .sample_emission(choose, part, Vec2::new(x, y), Vec2::new(a, b));
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
        kind: StepKind::Emitter { sample },
    };
    let mut walk = Walk {
        scene,
        heuristic,
        mode: TransportMode::Importance,
        counts,
        subpath,
    };
    walk.run(first, max_vertices, point);
}

struct Walk<'a> {
    scene: &'a Scene,
    heuristic: Heuristic,
    mode: TransportMode,
    counts: &'a mut RayCounts,
    subpath: &'a mut Subpath,
}

impl Walk<'_> {
    #[inline]
    fn run<C: Coordinates>(&mut self, first: Step, max_vertices: usize, point: &mut C) {
        self.subpath.start = first.from;
        self.subpath.vertices.clear();
        self.subpath.escape = None;
        let mut step = first;
        // Product of the scattering weights, without what the emitter gave: for Russian roulette.
        let mut survival = Rgb::ONE;
        for i in 1..=max_vertices {
            let Some(vertex) = self.arrive(&step) else {
                return;
            };
            self.subpath.vertices.push(vertex);
            if i == max_vertices {
                return;
            }
            let Some(next) = self.scatter(&vertex, i, &mut survival, point) else {
                return;
            };
            step = next;
        }
    }

    /// The vertex at the end of `step`; `None` if there is none.
    #[inline]
    fn arrive(&mut self, step: &Step) -> Option<Vertex> {
        let Some(surface) = self.scene.geometry.intersect(&step.ray, self.counts) else {
            if self.mode == TransportMode::Radiance {
                self.subpath.escape = Some(self.escape(step));
            }
            return None;
        };
        let direction = step.ray.direction;
        let distance_squared = f64::from((surface.position - step.from).length_squared());
        let cos = f64::from(surface.geometric_normal.dot(direction).abs());
        let carried = match &step.kind {
            StepKind::Lens => Carried::after_lens(step.pdf * cos / distance_squared),
            StepKind::Emitter { sample } => {
                let spread = if sample.infinite {
                    1.0
                } else {
                    distance_squared.recip()
                };
                // g_1: how a density per steradian at y_1 becomes the native one at y_0.
                let emitter_cos = f64::from(sample.normal.dot(direction).abs());
                let geometry = if sample.infinite {
                    1.0
                } else {
                    emitter_cos * spread
                };
                Carried::after_emitter(
                    self.heuristic,
                    step.pdf * cos * spread,
                    f64::from(sample.pdf_position),
                    f64::from(self.scene.emitters.direct_pdf(sample, surface.position)),
                    geometry,
                    !sample.delta,
                )
            }
            StepKind::Surface {
                reverse,
                delta,
                cos: previous_cos,
            } => self.subpath.vertices.last()?.carried.extend(
                self.heuristic,
                *reverse,
                *delta,
                previous_cos / distance_squared,
                step.pdf * cos / distance_squared,
            ),
        };
        Some(Vertex {
            material: self.scene.geometry.material(surface.shape),
            surface,
            to_previous: -direction,
            throughput: step.throughput,
            carried,
        })
    }

    /// Where the subpath goes from `vertex`, the i-th; `None` if it ends.
    #[inline]
    fn scatter<C: Coordinates>(
        &self,
        vertex: &Vertex,
        i: usize,
        survival: &mut Rgb,
        point: &mut C,
    ) -> Option<Step> {
        let (stream, block) = match self.mode {
            TransportMode::Radiance => (Stream::Camera, dimensions::camera_vertex(i)),
            TransportMode::Importance => (Stream::Light, dimensions::light_vertex(i)),
        };
        let [lobe, u, v, roulette] = point.read::<{ dimensions::PER_VERTEX }>(stream, block);
        let surface = &vertex.surface;
        let from = surface.shading.to_local(vertex.to_previous);
        let material = &self.scene.materials[vertex.material as usize];
        let uv = Vec2::new(u, v);
        let sample =
            material.sample(&self.scene.textures, surface.uv, from, self.mode, lobe, uv)?;
        let direction = surface.shading.to_world(sample.direction);
        let cos = surface.geometric_normal.dot(direction).abs();
        let mut weight = sample.weight;
        if self.mode == TransportMode::Importance && !planted(Fault::AdjointLeftOut) {
            // Adjoint for shading normals (Veach 1997, eq. 5.19).
            let sampled = if sample.direction.z == 0.0 {
                0.0
            } else {
                cos / sample.direction.z
            };
            weight *= vertex.shading_over_geometric_cos(from.z) * sampled.abs();
        }
        // The throughput of a camera subpath shrinks on entering a denser medium and grows back on
        // leaving it; the roulette must not mistake that for absorption.
        *survival *= match self.mode {
            TransportMode::Radiance => weight * (sample.eta * sample.eta),
            TransportMode::Importance => weight,
        };
        if i >= self.scene.depth.rr_depth as usize {
            let q = survival.max_element().min(greatest_survival(i));
            if roulette >= q {
                return None;
            }
            weight /= q;
            *survival /= q;
        }
        let throughput = vertex.throughput * weight;
        if throughput == Rgb::ZERO {
            return None;
        }
        let kind = StepKind::Surface {
            reverse: f64::from(sample.reverse_pdf),
            delta: sample.delta,
            cos: f64::from(cos),
        };
        let origin = surface.ray_origin(direction);
        let ray = Ray {
            origin,
            direction,
            t_max: f32::INFINITY,
        };
        let pdf = f64::from(sample.pdf);
        Some(Step {
            ray,
            from: surface.position,
            throughput,
            pdf,
            kind,
        })
    }

    /// The vertex at infinity at the end of `step`: densities there are per steradian.
    #[inline]
    fn escape(&self, step: &Step) -> Escape {
        let carried = match (&step.kind, self.subpath.vertices.last()) {
            (
                StepKind::Surface {
                    reverse,
                    delta,
                    cos,
                },
                Some(last),
            ) => last
                .carried
                .extend(self.heuristic, *reverse, *delta, *cos, step.pdf),
            _ => Carried::after_lens(step.pdf),
        };
        Escape {
            direction: step.ray.direction,
            throughput: step.throughput,
            carried,
        }
    }
}
