//! The surfaces of a scene: its shapes, and what a ray finds on them.

mod builder;
mod derivative;
mod ray_counts;
mod shape;
mod surface;

#[cfg(test)]
mod tests;

pub use derivative::NormalDerivative;
pub use ray_counts::RayCounts;

pub(super) use builder::GeometryBuilder;
pub(super) use shape::spherical_uv;
pub(super) use surface::{ShapeSurface, SurfaceTriangle};

use glam::{DVec3, Vec3A};

use super::{SCENE_RADIUS, SurfacePoint};
use crate::bvh::{Bvh, HitTarget, Primitive, Ray, Triangle};
use shape::Shape;

/// Shadow rays are shortened by this factor and by this length in scene units. Their two ends are
/// offset from their surfaces by more than this; it covers the rounding error of the distance of a hit.
const SHADOW_EPSILON: (f32, f32) = (1.0 - 1e-6, 1e-7 * SCENE_RADIUS);

/// All surfaces of a scene.
pub struct Geometry {
    bvh: Bvh,
    shapes: Vec<Shape>,
    degenerate: usize,
}

impl Geometry {
    /// The nearest point where `ray` hits a surface.
    #[inline]
    pub fn intersect(&self, ray: &Ray, counts: &mut RayCounts) -> Option<SurfacePoint> {
        counts.closest_hit += 1;
        self.nearest_point(ray)
    }

    /// The nearest point where `ray` hits a surface of a shape that is not `passed`.
    pub fn intersect_past(
        &self,
        ray: &Ray,
        passed: impl Fn(u32) -> bool,
        counts: &mut RayCounts,
    ) -> Option<SurfacePoint> {
        let mut ray = *ray;
        loop {
            let point = self.intersect(&ray, counts)?;
            if !passed(point.shape) {
                return Some(point);
            }
            let origin = point.ray_origin(ray.direction);
            ray.t_max -= (origin - ray.origin).dot(ray.direction);
            ray.origin = origin;
            if ray.t_max <= 0.0 {
                return None;
            }
        }
    }

    /// As [`Self::visible`], where shapes that are `passed` hide nothing.
    pub fn visible_past(
        &self,
        from: Vec3A,
        to: Vec3A,
        passed: impl Fn(u32) -> bool,
        counts: &mut RayCounts,
    ) -> bool {
        let distance = (to - from).length();
        let ray = Ray {
            origin: from,
            direction: (to - from) / distance,
            t_max: distance * SHADOW_EPSILON.0 - SHADOW_EPSILON.1,
        };
        ray.t_max <= 0.0 || self.intersect_past(&ray, passed, counts).is_none()
    }

    fn nearest_point(&self, ray: &Ray) -> Option<SurfacePoint> {
        let hit = self.bvh.intersect(ray)?;
        Some(match hit.target {
            HitTarget::Triangle { triangle, b1, b2 } => {
                let shape = &self.shapes[triangle.shape as usize];
                shape.triangle_point(&triangle, hit.index, [b1, b2])
            }
            HitTarget::Sphere { sphere, point } => {
                let shape = &self.shapes[sphere.shape as usize];
                shape.sphere_point(&sphere, hit.index, point)
            }
        })
    }

    /// True if no surface lies between `from` and `to`, which must both be offset from their own
    /// surfaces ([`super::interaction::offset`]).
    #[inline]
    pub fn visible(&self, from: Vec3A, to: Vec3A, counts: &mut RayCounts) -> bool {
        counts.shadow += 1;
        let distance = (to - from).length();
        let t_max = distance * SHADOW_EPSILON.0 - SHADOW_EPSILON.1;
        t_max <= 0.0
            || !self.bvh.occluded(&Ray {
                origin: from,
                direction: (to - from) / distance,
                t_max,
            })
    }

    /// The surfaces of all shapes for which `wanted` is true; empty ones for the others.
    pub(super) fn surfaces(&self, wanted: impl Fn(u32) -> bool) -> Vec<ShapeSurface> {
        let empty = || ShapeSurface::Triangles(Vec::new());
        let mut surfaces: Vec<ShapeSurface> = self.shapes.iter().map(|_| empty()).collect();
        for (index, primitive) in self.bvh.primitives() {
            match primitive {
                Primitive::Triangle(triangle) if wanted(triangle.shape) => {
                    let shape = triangle.shape as usize;
                    if let ShapeSurface::Triangles(list) = &mut surfaces[shape] {
                        list.push(SurfaceTriangle {
                            corners: triangle.corners,
                            normal: self.shapes[shape].triangle_normal(&triangle),
                            uvs: self.shapes[shape].triangle_uvs(&triangle),
                            primitive: index,
                        });
                    }
                }
                Primitive::Sphere(sphere) if wanted(sphere.shape) => {
                    surfaces[sphere.shape as usize] = ShapeSurface::Sphere {
                        center: sphere.center.into(),
                        radius: sphere.radius,
                        inward: self.shapes[sphere.shape as usize].flip,
                        to_local: self.shapes[sphere.shape as usize].sphere_axes(),
                    }
                }
                Primitive::Triangle(_) | Primitive::Sphere(_) => {}
            }
        }
        surfaces
    }

    /// How the shading normal changes around `point`.
    #[inline]
    pub fn normal_derivative(&self, point: &SurfacePoint) -> NormalDerivative {
        let shape = &self.shapes[point.shape as usize];
        match self.bvh.primitive(point.primitive) {
            Some(Primitive::Triangle(triangle)) => {
                shape.triangle_normal_derivative(&triangle, point.position)
            }
            Some(Primitive::Sphere(sphere)) => shape.sphere_normal_derivative(&sphere),
            None => NormalDerivative::Flat,
        }
    }

    /// The derivatives dp/du and dp/dv of the position with respect to the texture coordinates, in scene units.
    pub(super) fn partial_derivatives(&self, point: &SurfacePoint) -> [Vec3A; 2] {
        let shape = &self.shapes[point.shape as usize];
        match self.bvh.primitive(point.primitive) {
            Some(Primitive::Triangle(triangle)) => shape.triangle_partial_derivatives(&triangle),
            Some(Primitive::Sphere(sphere)) => {
                let outward = if shape.flip {
                    -point.geometric_normal
                } else {
                    point.geometric_normal
                };
                shape.sphere_partial_derivatives(&sphere, outward)
            }
            None => [Vec3A::ZERO; 2],
        }
    }

    /// The primitives of the shapes for which `wanted` is true, with their indices, and for triangles with
    /// vertex normals these normals, unit and on the front side.
    pub(super) fn primitives(
        &self,
        wanted: impl Fn(u32) -> bool,
    ) -> impl Iterator<Item = (u32, Primitive, Option<[DVec3; 3]>)> {
        self.bvh.primitives().filter_map(move |(index, primitive)| {
            let normals = match &primitive {
                Primitive::Triangle(triangle) if wanted(triangle.shape) => {
                    self.shapes[triangle.shape as usize].vertex_normals(triangle.vertices)
                }
                Primitive::Sphere(sphere) if wanted(sphere.shape) => None,
                Primitive::Triangle(_) | Primitive::Sphere(_) => return None,
            };
            Some((index, primitive, normals))
        })
    }

    /// Unit normal of a triangle on its front side.
    pub(super) fn triangle_normal(&self, triangle: &Triangle) -> Vec3A {
        self.shapes[triangle.shape as usize].triangle_normal(triangle)
    }

    /// Index of the material of a shape.
    #[inline]
    pub fn material(&self, shape: u32) -> u32 {
        self.shapes[shape as usize].material
    }

    /// True if the normals of a shape are reversed: those of a sphere point inward.
    pub(super) fn is_flipped(&self, shape: u32) -> bool {
        self.shapes[shape as usize].flip
    }

    /// The name of a shape in messages.
    pub fn shape_name(&self, shape: u32) -> &str {
        &self.shapes[shape as usize].name
    }

    /// Number of shapes.
    pub fn shape_count(&self) -> usize {
        self.shapes.len()
    }

    /// Number of triangles that have area.
    pub fn triangle_count(&self) -> usize {
        self.bvh.triangle_count()
    }

    /// Number of spheres.
    pub fn sphere_count(&self) -> usize {
        self.bvh.sphere_count()
    }

    /// Number of triangles and spheres left out because they have no area.
    pub fn degenerate_count(&self) -> usize {
        self.degenerate
    }

    /// Lower and upper corner of the box around all surfaces in scene units; `None` without surfaces.
    pub fn bounds(&self) -> Option<(Vec3A, Vec3A)> {
        self.bvh.bounds()
    }

    /// Bytes in memory: acceleration structure and attributes.
    pub fn memory_bytes(&self) -> usize {
        self.bvh.bytes() + self.shapes.iter().map(Shape::bytes).sum::<usize>()
    }
}
