//! Meshes as the surfaces of emitters.

use glam::{Vec2, Vec3A};

use super::sample::SurfaceSample;
use crate::sampling::Distribution1D;
use crate::sampling::warp::square_to_triangle;
use crate::scene::geometry::SurfaceTriangle;

/// Fraction of the area of an emitter below which a triangle is never sampled, only hit: the light of all
/// such triangles together is too little to be visible, and densities stay in the range of f32.
const MIN_AREA_FRACTION: f64 = 1e-12;

/// The triangles of a mesh.
#[derive(Debug)]
pub struct MeshSurface {
    /// In the order of their primitives.
    triangles: Vec<SurfaceTriangle>,
    /// Proportional to their areas, up to rounding.
    choice: Distribution1D,
    /// Density per unit area of a point on each triangle, from the rounded probability.
    densities: Vec<f32>,
}

impl MeshSurface {
    /// The surface of triangles with the total area `area`; `None` if that is 0.
    pub fn new(triangles: Vec<SurfaceTriangle>, area: f64) -> Option<Self> {
        let sampled_area = |triangle: &SurfaceTriangle| {
            let own = triangle.area();
            if own < MIN_AREA_FRACTION * area {
                0.0
            } else {
                own
            }
        };
        let choice = Distribution1D::new(triangles.iter().map(sampled_area))?;
        let density = |(i, triangle): (usize, &SurfaceTriangle)| {
            (f64::from(choice.probability(i)) / triangle.area()) as f32
        };
        let densities = triangles.iter().enumerate().map(density).collect();
        Some(Self {
            triangles,
            choice,
            densities,
        })
    }

    /// Samples a point: `u_primitive` chooses the triangle, `u` the point on it.
    #[inline]
    pub fn sample(&self, u_primitive: f32, u: Vec2) -> SurfaceSample {
        let i = self.choice.sample(u_primitive).0;
        let triangle = &self.triangles[i];
        let b = square_to_triangle(u);
        let [p0, p1, p2] = triangle.corners.map(Vec3A::from_array);
        let [uv0, uv1, uv2] = triangle.uvs;
        SurfaceSample {
            position: p0 + (p1 - p0) * b.x + (p2 - p0) * b.y,
            normal: triangle.normal,
            uv: uv0 + (uv1 - uv0) * b.x + (uv2 - uv0) * b.y,
            pdf: self.densities[i],
        }
    }

    /// Density with which [`Self::sample`] samples a point of a primitive.
    #[inline]
    pub fn pdf(&self, primitive: u32) -> f32 {
        let found = self
            .triangles
            .binary_search_by_key(&primitive, |t| t.primitive);
        found.map_or(0.0, |i| self.densities[i])
    }
}
