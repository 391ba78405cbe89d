//! s = 0: the camera subpath hits a light.

use glam::Vec3A;

use super::Connection;
use crate::math::Rgb;
use crate::path::mis::weight;
use crate::path::{EnvironmentVertex, PartialMis, Vertex};
use crate::scene::{LightEvaluation, Scene};

/// A light that a camera subpath has hit, not yet weighted.
pub struct Hit<'a> {
    /// Radiance toward the camera subpath, and the densities of all ways to sample the point.
    pub emission: LightEvaluation,
    /// Throughput of the camera subpath.
    pub throughput: Rgb,
    /// Partial MIS sums at the point.
    pub mis: &'a PartialMis,
    /// Number of edges of the path.
    pub edges: usize,
}

/// Camera vertex z_i lies on a light, i being the number of edges; `previous` is the position of
/// z_{i-1}. `None` if it emits nothing that way.
#[inline]
pub fn hit_light<'a>(
    scene: &Scene,
    vertex: &'a Vertex,
    edges: usize,
    previous: Vec3A,
) -> Option<Hit<'a>> {
    Some(Hit {
        emission: scene.emitters.evaluate_surface(&vertex.surface, previous)?,
        throughput: vertex.throughput,
        mis: &vertex.mis,
        edges,
    })
}

/// The camera subpath has left the scene; `None` if no light at infinity can be hit.
#[inline]
pub fn hit_environment<'a>(
    scene: &Scene,
    vertex: &'a EnvironmentVertex,
    edges: usize,
) -> Option<Hit<'a>> {
    Some(Hit {
        emission: scene.emitters.evaluate_environment(vertex.direction)?,
        throughput: vertex.throughput,
        mis: &vertex.mis,
        edges,
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
        // No other technique makes paths of one edge: a directly visible light.
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
        self.weighted(weight(0.0, camera))
    }
}
