//! A bounding volume hierarchy over triangles and spheres: the nearest hit of a ray, and whether a
//! segment is occluded.
//!
//! Primitives lie in the ball of radius [`RADIUS`] around the origin; the padding of the boxes
//! covers the rounding errors that occur there.
//!
//! ```
//! use glam::Vec3A;
//! use metrolight::bvh::{Bvh, Primitive, Ray, Sphere};
//!
//! let sphere = Sphere { radius: 2.0, ..Sphere::default() };
//! let bvh = Bvh::new(vec![Primitive::Sphere(sphere)]);
//! let ray = Ray {
//!     origin: Vec3A::new(0.0, 0.0, -10.0),
//!     direction: Vec3A::Z,
//!     t_max: f32::INFINITY,
//! };
//! assert!(bvh.intersect(&ray).is_some());
//! assert!(!bvh.occluded(&Ray { t_max: 7.0, ..ray }));
//! ```

mod binary;
mod build;
mod collapse;
mod huge_pages;
mod node;
mod primitive;
mod ray;
mod sphere;
mod traversal;
mod triangle;

#[cfg(test)]
pub(crate) mod test_primitives;
#[cfg(test)]
mod tests;

pub use primitive::{Primitive, RADIUS, Sphere, Triangle};
pub use ray::Ray;
pub use triangle::Corners;

use glam::{DVec3, Vec3A};
use obvhs::Boundable;
use obvhs::aabb::Aabb;

use build::Hierarchy;
use huge_pages::HugePages;
use node::{Kind, Node};
use primitive::{PADDING, PrimitiveStore};
use triangle::RayTransform;

/// Triangles and spheres, and the tree that finds them.
pub struct Bvh {
    /// The first node is the root.
    nodes: HugePages<Node>,
    primitives: PrimitiveStore,
    /// The box around all primitives, padded.
    bounds: Aabb,
    triangle_count: usize,
}

/// The nearest hit of a ray.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    /// Index of the primitive, as in [`Bvh::primitives`].
    pub index: u32,
    /// The primitive, and where it is hit.
    pub target: HitTarget,
}

/// A primitive that a ray hits.
#[derive(Clone, Copy, Debug)]
pub enum HitTarget {
    /// A triangle.
    Triangle {
        /// The primitive.
        triangle: Triangle,
        /// Barycentric coordinate of the second corner.
        b1: f32,
        /// Barycentric coordinate of the third corner.
        b2: f32,
    },
    /// A sphere.
    Sphere {
        /// The primitive.
        sphere: Sphere,
        /// The point on the ray, on the sphere up to the rounding of the distance to f32.
        point: DVec3,
    },
}

impl Bvh {
    /// The hierarchy over `primitives`.
    pub fn new(mut primitives: Vec<Primitive>) -> Self {
        primitives.shrink_to_fit();
        let hierarchy = build::build(&mut primitives);
        Self::from_hierarchy(hierarchy, primitives)
    }

    /// The hierarchy over `primitives`, which are in its order.
    fn from_hierarchy(hierarchy: Hierarchy, primitives: Vec<Primitive>) -> Self {
        let bounds = primitives
            .iter()
            .fold(Aabb::INVALID, |all, primitive| all.union(&primitive.aabb()));
        let count = primitives.len();
        let primitives = PrimitiveStore::new(primitives, &hierarchy.leaves);
        Self {
            nodes: hierarchy.nodes,
            bounds,
            triangle_count: count - primitives.spheres.len(),
            primitives,
        }
    }

    /// The nearest hit of `ray`, if any.
    // Inlined together with the traversal, so that the caller's use of a hit joins its computation.
    #[inline(always)]
    pub fn intersect(&self, ray: &Ray) -> Option<Hit> {
        self.nearest(&ray.advanced_to_primitives()?)
    }

    /// True if anything is hit before `ray.t_max`.
    #[inline]
    pub fn occluded(&self, ray: &Ray) -> bool {
        ray.advanced_to_primitives()
            .is_some_and(|ray| self.any(&ray))
    }

    #[inline(always)]
    fn nearest(&self, ray: &Ray) -> Option<Hit> {
        let transform = RayTransform::new(ray.origin, ray.direction);
        let mut barycentric = (0.0, 0.0);
        let mut index = u32::MAX;
        let mut distance = ray.t_max;
        traversal::visit(&self.nodes, ray, |leaf, t_max| {
            match leaf {
                Kind::Sphere(sphere) => {
                    if let Some(t) = self.intersect_sphere(sphere, ray, t_max) {
                        index = self.primitives.sphere_index(sphere);
                        distance = t;
                    }
                }
                Kind::Triangles(packet) | Kind::Node(packet) => {
                    let triangles = &self.primitives.packets[packet as usize];
                    if let Some(hit) = transform.intersect(triangles, t_max) {
                        index = PrimitiveStore::triangle_index(packet, hit.lane);
                        barycentric = (hit.b1, hit.b2);
                        distance = hit.t;
                    }
                }
            }
            distance
        });
        let target = match self.primitives.get(index)? {
            Primitive::Triangle(triangle) => HitTarget::Triangle {
                triangle,
                b1: barycentric.0,
                b2: barycentric.1,
            },
            Primitive::Sphere(sphere) => HitTarget::Sphere {
                sphere,
                point: ray.origin.as_dvec3() + ray.direction.as_dvec3() * f64::from(distance),
            },
        };
        Some(Hit { index, target })
    }

    fn any(&self, ray: &Ray) -> bool {
        let transform = RayTransform::new(ray.origin, ray.direction);
        traversal::any(&self.nodes, ray, |leaf| match leaf {
            Kind::Sphere(sphere) => self.intersect_sphere(sphere, ray, ray.t_max).is_some(),
            Kind::Triangles(packet) | Kind::Node(packet) => {
                transform.occluded(&self.primitives.packets[packet as usize], ray.t_max)
            }
        })
    }

    #[inline]
    fn intersect_sphere(&self, sphere: u32, ray: &Ray, t_max: f32) -> Option<f32> {
        let Sphere { center, radius, .. } = self.primitives.spheres[sphere as usize];
        sphere::intersect(center, radius, ray.origin, ray.direction, t_max)
    }

    /// All primitives with their indices, in increasing order of the index.
    pub fn primitives(&self) -> impl Iterator<Item = (u32, Primitive)> {
        self.primitives.iter()
    }

    /// The primitive with this index; `None` if there is none.
    pub fn primitive(&self, index: u32) -> Option<Primitive> {
        self.primitives.get(index)
    }

    /// Number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.triangle_count
    }

    /// Number of spheres.
    pub fn sphere_count(&self) -> usize {
        self.primitives.spheres.len()
    }

    /// Lower and upper corner of the box around all primitives; `None` if there are none.
    pub fn bounds(&self) -> Option<(Vec3A, Vec3A)> {
        let padded = self.bounds;
        (!self.nodes.is_empty()).then_some((padded.min + PADDING, padded.max - PADDING))
    }

    /// Bytes in memory.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + self.primitives.bytes()
    }
}
