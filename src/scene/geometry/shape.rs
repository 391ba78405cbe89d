//! Surfaces as objects: what a hit on a triangle or sphere means.

use glam::{DVec3, Mat3A, Vec2, Vec3A};

use super::triangle::Corners;
use crate::math::Frame;
use crate::scene::SurfacePoint;

/// What all primitives of one surface share.
#[derive(Debug)]
pub struct Shape {
    /// How messages call it.
    pub name: String,
    /// Index of the material.
    pub material: u32,
    /// Turn normals around.
    pub flip: bool,
    /// What is interpolated over it.
    pub attributes: Attributes,
}

/// What is interpolated over a surface.
#[derive(Debug)]
pub enum Attributes {
    /// Of a mesh.
    Mesh(MeshAttributes),
    /// Of a sphere: rotates (and mirrors) scene axes to its own.
    Sphere(Mat3A),
}

/// Attributes of the vertices of a mesh.
#[derive(Debug, Default)]
pub struct MeshAttributes {
    /// Unit shading normals per vertex, or empty.
    pub normals: Vec<[f32; 3]>,
    /// Texture coordinates per vertex, or empty.
    pub uvs: Vec<[f32; 2]>,
}

impl MeshAttributes {
    #[inline]
    fn normals(&self, vertices: [u32; 3]) -> Option<[Vec3A; 3]> {
        if self.normals.is_empty() {
            return None;
        }
        Some(vertices.map(|v| Vec3A::from_array(self.normals[v as usize])))
    }

    #[inline]
    fn uv(&self, vertices: [u32; 3], [b0, b1, b2]: [f32; 3]) -> Vec2 {
        if self.uvs.is_empty() {
            return Vec2::new(b1, b2);
        }
        let [a, b, c] = vertices.map(|v| Vec2::from_array(self.uvs[v as usize]));
        a * b0 + b * b1 + c * b2
    }

    /// Bytes in memory.
    fn bytes(&self) -> usize {
        size_of_val(&self.normals[..]) + size_of_val(&self.uvs[..])
    }
}

impl Shape {
    /// Unit normal of a triangle on its front side: that of the vertex normals where there are any,
    /// since in Mitsuba the shading frame decides what is in front; else the side from which the
    /// corners go round counter-clockwise. They differ where a transform mirrors a mesh that has
    /// normals, and in files that contradict themselves.
    #[inline]
    pub fn triangle_normal(&self, corners: &Corners, vertices: [u32; 3]) -> Vec3A {
        let winding = cross(corners).normalize().as_vec3a();
        let behind = match &self.attributes {
            Attributes::Mesh(mesh) => mesh
                .normals(vertices)
                .is_some_and(|[a, b, c]| winding.dot(a + b + c) < 0.0),
            Attributes::Sphere(_) => false,
        };
        if behind != self.flip {
            -winding
        } else {
            winding
        }
    }

    /// The point with barycentric coordinates `b1` and `b2` on a triangle of this shape. `shape` and
    /// `primitive` are the indices of both.
    #[inline]
    pub fn on_triangle(
        &self,
        (shape, primitive): (u32, u32),
        corners: &Corners,
        vertices: [u32; 3],
        b1: f32,
        b2: f32,
    ) -> SurfacePoint {
        let b0 = 1.0 - b1 - b2;
        let [p0, p1, p2] = corners.map(Vec3A::from_array);
        let geometric_normal = self.triangle_normal(corners, vertices);
        let (normal, uv) = match &self.attributes {
            Attributes::Mesh(mesh) => {
                let normal = mesh.normals(vertices).and_then(|[n0, n1, n2]| {
                    let n = n0 * b0 + n1 * b1 + n2 * b2;
                    (if self.flip { -n } else { n }).try_normalize()
                });
                (normal, mesh.uv(vertices, [b0, b1, b2]))
            }
            Attributes::Sphere(_) => (None, Vec2::new(b1, b2)),
        };
        SurfacePoint {
            position: p0 * b0 + p1 * b1 + p2 * b2,
            geometric_normal,
            shading: Frame::from_normal(normal.unwrap_or(geometric_normal)),
            uv,
            shape,
            primitive,
        }
    }

    /// The point of a sphere of this shape nearest to `near`; as [`Self::on_triangle`].
    #[inline]
    pub fn on_sphere(
        &self,
        (shape, primitive): (u32, u32),
        center: [f32; 3],
        radius: f32,
        near: DVec3,
    ) -> SurfacePoint {
        let center = DVec3::from_array(center.map(f64::from));
        let outward = (near - center).normalize_or(DVec3::Z);
        let normal = outward.as_vec3a();
        let local = match &self.attributes {
            Attributes::Sphere(to_local) => *to_local * normal,
            Attributes::Mesh(_) => normal,
        };
        let front = if self.flip { -normal } else { normal };
        SurfacePoint {
            position: (center + outward * f64::from(radius)).as_vec3a(),
            geometric_normal: front,
            shading: Frame::from_normal(front),
            uv: spherical_uv(local),
            shape,
            primitive,
        }
    }

    /// Bytes in memory.
    pub fn bytes(&self) -> usize {
        size_of::<Self>()
            + self.name.len()
            + match &self.attributes {
                Attributes::Mesh(mesh) => mesh.bytes(),
                Attributes::Sphere(_) => 0,
            }
    }
}

/// Twice the area of a triangle along its normal by winding; in f64, since needles leave f32 no digit.
#[inline]
pub fn cross(corners: &Corners) -> DVec3 {
    let [a, b, c] = corners.map(|corner| DVec3::from_array(corner.map(f64::from)));
    (b - a).cross(c - a)
}

/// (phi / 2 pi, theta / pi) of a unit vector, as Mitsuba maps spheres: theta from +z, phi from +x.
#[inline]
fn spherical_uv(v: Vec3A) -> Vec2 {
    use std::f32::consts::{FRAC_1_PI, TAU};
    let phi = v.y.atan2(v.x);
    let theta = v.x.hypot(v.y).atan2(v.z);
    let phi = if phi < 0.0 { phi + TAU } else { phi };
    Vec2::new(phi / TAU, theta * FRAC_1_PI)
}
