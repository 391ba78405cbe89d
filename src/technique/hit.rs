//! s = 0: the camera subpath hits a light.

use glam::Vec3A;

use super::Connection;
use crate::math::Rgb;
use crate::path::mis::weight;
use crate::path::{EnvironmentVertex, PartialMis, Vertex};
use crate::scene::{LightEvaluation, Scene};

/// A path whose camera subpath hit a light, before MIS weighting.
pub struct Hit<'a> {
    /// Radiance toward the camera subpath, and the densities with which other techniques sample the point.
    pub emission: LightEvaluation,
    /// Throughput of the camera subpath.
    pub throughput: Rgb,
    /// Partial MIS sums at the point.
    pub mis: &'a PartialMis,
    /// Number of edges of the path.
    pub edges: usize,
    /// The term of technique 1* in the weight: [`super::specular::specular_term`].
    pub specular: f64,
}

/// The path of `edges` edges that ends at `vertex`, camera vertex z_i with i = `edges`. `previous` is the
/// position of z_{i-1}, and `specular` gives [`Hit::specular`]. `None` if the surface emits no light toward it.
#[inline]
pub fn hit_light<'a>(
    scene: &Scene,
    vertex: &'a Vertex,
    edges: usize,
    previous: Vec3A,
    specular: impl FnOnce() -> f64,
) -> Option<Hit<'a>> {
    Some(Hit {
        emission: vertex.emission(scene, previous)?,
        throughput: vertex.throughput,
        mis: &vertex.mis,
        edges,
        specular: specular(),
    })
}

/// The path of `edges` edges whose camera subpath leaves the scene. `None` if no infinite emitter can be
/// hit.
#[inline]
pub fn hit_environment<'a>(
    scene: &Scene,
    vertex: &'a EnvironmentVertex,
    edges: usize,
    specular: impl FnOnce() -> f64,
) -> Option<Hit<'a>> {
    Some(Hit {
        emission: scene.emitters.evaluate_environment(vertex.direction)?,
        throughput: vertex.throughput,
        mis: &vertex.mis,
        edges,
        specular: specular(),
    })
}

impl Hit<'_> {
    /// The path with this MIS weight.
    #[inline]
    pub fn weighted(&self, weight: f32) -> Connection {
        Connection {
            value: self.throughput * self.emission.radiance,
            weight,
        }
    }

    /// The path, weighted among all bidirectional techniques.
    #[inline]
    pub fn connection(&self) -> Connection {
        // No other technique samples paths of one edge (directly visible lights).
        let camera = if self.edges == 1 {
            0.0
        } else {
            let emission = &self.emission;
            self.mis.sum_on_light(
                f64::from(emission.pdf_direct),
                f64::from(emission.pdf_position),
                f64::from(emission.pdf_direction),
            )
        };
        self.weighted(weight(0.0, camera + self.specular))
    }
}
