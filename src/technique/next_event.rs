//! s = 1: next event estimation.

use glam::Vec2;

use super::Connection;
use crate::math::Rgb;
use crate::path::mis::{h, weight};
use crate::path::{Scatter, Vertex, dimensions};
use crate::sampling::Sampler;
use crate::scene::{LightSample, RayCounts, Scene, TransportMode};

/// A path whose last point is sampled on a light and visible from the camera vertex, before MIS weighting.
pub struct NextEvent<'a> {
    /// The camera vertex.
    vertex: &'a Vertex,
    /// Path contribution over density.
    value: Rgb,
    /// The point on the light.
    light: LightSample,
    /// The BSDF at the camera vertex toward the point.
    scatter: Scatter,
}

impl<'a> NextEvent<'a> {
    /// Samples a point on a light for camera vertex z_i. `None` if the path carries no light.
    #[inline]
    pub fn sample<S: Sampler>(
        scene: &Scene,
        vertex: &'a Vertex,
        i: usize,
        sampler: &mut S,
        counts: &mut RayCounts,
    ) -> Option<Self> {
        if !vertex.is_connectible(scene) {
            return None;
        }
        let [u_light, u_primitive, x, y] = sampler.get::<4>(dimensions::next_event(i));
        let position = vertex.position();
        let light =
            scene
                .emitters
                .sample_direct(position, u_light, u_primitive, Vec2::new(x, y))?;
        let emission = &light.emission;
        let scatter = vertex.scatter(scene, light.direction, TransportMode::Radiance);
        let value = vertex.throughput
            * scatter.value
            * emission.radiance
            * (light.jacobian_direction / emission.pdf_direct);
        if value == Rgb::ZERO {
            return None;
        }
        let origin = vertex.ray_origin(light.direction);
        let visible = scene.geometry.visible(origin, light.target, counts);
        visible.then_some(Self {
            vertex,
            value,
            light,
            scatter,
        })
    }

    /// The path with this MIS weight.
    #[inline]
    pub fn weighted(&self, weight: f32) -> Connection {
        Connection {
            value: self.value,
            weight,
        }
    }

    /// The term of technique s = 0 in the MIS weight: h of the density with which the camera subpath
    /// samples the point, over the density of next event estimation.
    #[inline]
    pub fn hit_term(&self) -> f64 {
        if self.light.delta {
            return 0.0;
        }
        let hit = f64::from(self.scatter.pdf_forward) * f64::from(self.light.jacobian_direction);
        h(hit / f64::from(self.light.emission.pdf_direct))
    }

    /// The path, weighted among all bidirectional techniques.
    #[inline]
    pub fn connection(&self) -> Connection {
        let (light, scatter) = (&self.light, &self.scatter);
        let emission = &light.emission;
        let from_light = f64::from(emission.pdf_position)
            * f64::from(emission.pdf_direction)
            * f64::from(light.jacobian_area)
            * f64::from(scatter.cos)
            / f64::from(emission.pdf_direct);
        let camera = self
            .vertex
            .mis
            .sum(from_light, f64::from(scatter.pdf_reverse));
        self.weighted(weight(self.hit_term(), camera))
    }
}
