//! What the acceleration structure holds.

use glam::Vec3A;
use obvhs::{Boundable, aabb::Aabb};

use super::triangle::Corners;
use crate::scene::SCENE_RADIUS;

/// A triangle or a sphere, in scene units.
#[derive(Clone, Copy, Debug)]
pub enum Primitive {
    /// One triangle of a mesh.
    Triangle {
        /// In the order of the mesh.
        corners: Corners,
        /// Index of the shape.
        shape: u32,
        /// Indices into the attributes of the mesh: here, since a hit has this line of memory at hand.
        vertices: [u32; 3],
    },
    /// A whole sphere.
    Sphere {
        /// Centre.
        center: [f32; 3],
        /// Positive.
        radius: f32,
        /// Index of the shape.
        shape: u32,
    },
}

/// By how much boxes are larger than what they hold, in scene units.
///
/// For rays that start within 1.7 [`SCENE_RADIUS`] of the centre, the slab test of a box at a
/// distance of up to 2.7 radii errs by at most 4 roundings of 2^-24, 6.4e-4 in all; a direction
/// component that the ray replaces by 2^-23, since it is smaller, moves the ray by 3.2e-4; and the
/// quantisation of child boxes errs by 2 roundings of a node of 2 radii, 2.4e-4. The sum is 1.2e-3.
/// It also exceeds the 1e-4 that the node test takes for the start of every ray.
pub const PADDING: f32 = 2e-6 * SCENE_RADIUS;

impl Boundable for Primitive {
    #[inline]
    fn aabb(&self) -> Aabb {
        let (min, max) = match *self {
            Self::Triangle { corners, .. } => {
                let [a, b, c] = corners.map(Vec3A::from_array);
                (a.min(b).min(c), a.max(b).max(c))
            }
            Self::Sphere { center, radius, .. } => {
                let center = Vec3A::from_array(center);
                (center - radius, center + radius)
            }
        };
        Aabb::new(min - PADDING, max + PADDING)
    }
}
