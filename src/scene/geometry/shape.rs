//! Shapes: from a hit on a triangle or sphere to a point on a surface.

use glam::{DVec3, Mat3A, Vec2, Vec3A};

use super::derivative::{NormalDerivative, dual_basis};
use crate::bvh::{Corners, Sphere, Triangle};
use crate::math::Frame;
use crate::scene::SurfacePoint;

/// What all primitives of a shape share.
#[derive(Debug)]
pub struct Shape {
    /// Its name in messages.
    pub name: String,
    /// Index of the material.
    pub material: u32,
    /// Whether normals are reversed.
    pub flip: bool,
    /// Attributes of its surface.
    pub attributes: Attributes,
}

/// Attributes of a surface.
#[derive(Debug)]
pub enum Attributes {
    /// Those of the vertices of a mesh.
    Mesh(MeshAttributes),
    /// For a sphere, the rotation (and reflection) from scene axes to its own.
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

    /// The derivatives of the position on a triangle with respect to its texture coordinates; `None` where they are
    /// degenerate.
    fn partial_derivatives(&self, triangle: &Triangle) -> Option<[Vec3A; 2]> {
        let [p0, p1, p2] = triangle.corners.map(Vec3A::from_array);
        let edges = [p1 - p0, p2 - p0];
        if self.uvs.is_empty() {
            return Some(edges);
        }
        let [a, b, c] = triangle
            .vertices
            .map(|v| Vec2::from_array(self.uvs[v as usize]));
        let [d1, d2] = [b - a, c - a];
        let determinant = d1.perp_dot(d2);
        let derivatives = [
            (edges[0] * d2.y - edges[1] * d1.y) / determinant,
            (edges[1] * d1.x - edges[0] * d2.x) / determinant,
        ];
        derivatives
            .iter()
            .all(|derivative| derivative.is_finite())
            .then_some(derivatives)
    }

    /// Bytes in memory.
    fn bytes(&self) -> usize {
        size_of_val(&self.normals[..]) + size_of_val(&self.uvs[..])
    }
}

impl Shape {
    /// Unit normal of a triangle on its front side. Vertex normals, if there are any, decide which side
    /// that is, since in Mitsuba the shading frame does; else it is the side from which the corners are
    /// in counter-clockwise order. The two differ where a transform mirrors a mesh that has normals,
    /// and in inconsistent files.
    #[inline]
    pub fn triangle_normal(&self, triangle: &Triangle) -> Vec3A {
        let winding = cross(&triangle.corners).normalize().as_vec3a();
        let behind = match &self.attributes {
            Attributes::Mesh(mesh) => mesh
                .normals(triangle.vertices)
                .is_some_and(|[a, b, c]| winding.dot(a + b + c) < 0.0),
            Attributes::Sphere(_) => false,
        };
        if behind != self.flip {
            -winding
        } else {
            winding
        }
    }

    /// Texture coordinates of the corners of a triangle.
    pub fn triangle_uvs(&self, triangle: &Triangle) -> [Vec2; 3] {
        let corners = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        corners.map(|corner| match &self.attributes {
            Attributes::Mesh(mesh) => mesh.uv(triangle.vertices, corner),
            Attributes::Sphere(_) => Vec2::ZERO,
        })
    }

    /// The rotation from scene axes to those of a sphere.
    pub fn sphere_axes(&self) -> Mat3A {
        match &self.attributes {
            Attributes::Sphere(to_local) => *to_local,
            Attributes::Mesh(_) => Mat3A::IDENTITY,
        }
    }

    /// The point with barycentric coordinates `b1` and `b2` on a triangle of this shape; `primitive` is
    /// the index of the triangle.
    #[inline]
    pub fn triangle_point(
        &self,
        triangle: &Triangle,
        primitive: u32,
        [b1, b2]: [f32; 2],
    ) -> SurfacePoint {
        let &Triangle {
            corners,
            shape,
            vertices,
        } = triangle;
        let b0 = 1.0 - b1 - b2;
        let [p0, p1, p2] = corners.map(Vec3A::from_array);
        let geometric_normal = self.triangle_normal(triangle);
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

    /// Vertex normals on the front side; `None` without them.
    pub fn vertex_normals(&self, vertices: [u32; 3]) -> Option<[DVec3; 3]> {
        let Attributes::Mesh(mesh) = &self.attributes else {
            return None;
        };
        let sign = if self.flip { -1.0 } else { 1.0 };
        let normals = mesh.normals(vertices)?;
        Some(normals.map(|normal| sign * normal.as_dvec3()))
    }

    /// How the shading normal of a triangle changes around `position`.
    pub fn triangle_normal_derivative(
        &self,
        triangle: &Triangle,
        position: Vec3A,
    ) -> NormalDerivative {
        let Some([n0, n1, n2]) = self.vertex_normals(triangle.vertices) else {
            return NormalDerivative::Flat;
        };
        let [p0, p1, p2] = triangle
            .corners
            .map(|p| DVec3::from_array(p.map(f64::from)));
        let dual = dual_basis([p1 - p0, p2 - p0]);
        let slopes = [n1 - n0, n2 - n0];
        let offset = position.as_dvec3() - p0;
        let normal = n0 + slopes[0] * dual[0].dot(offset) + slopes[1] * dual[1].dot(offset);
        let length = normal.length();
        if length == 0.0 || slopes == [DVec3::ZERO; 2] {
            return NormalDerivative::Flat;
        }
        NormalDerivative::Triangle {
            dual,
            slopes: slopes.map(|slope| slope / length),
        }
    }

    /// The derivatives of the position on a triangle with respect to the texture coordinates; where those are
    /// degenerate, two tangents of unit length, as in Mitsuba.
    pub fn triangle_partial_derivatives(&self, triangle: &Triangle) -> [Vec3A; 2] {
        let derivatives = match &self.attributes {
            Attributes::Mesh(mesh) => mesh.partial_derivatives(triangle),
            Attributes::Sphere(_) => None,
        };
        derivatives.unwrap_or_else(|| {
            let Frame { s, t, .. } = Frame::from_normal(self.triangle_normal(triangle));
            [s, t]
        })
    }

    /// The derivatives of the position on a sphere with respect to its texture coordinates (phi / 2 pi,
    /// theta / pi), at the outward unit normal `outward`.
    pub fn sphere_partial_derivatives(&self, sphere: &Sphere, outward: Vec3A) -> [Vec3A; 2] {
        use std::f32::consts::{PI, TAU};
        let to_local = match &self.attributes {
            Attributes::Sphere(to_local) => *to_local,
            Attributes::Mesh(_) => Mat3A::IDENTITY,
        };
        let v = to_local * outward;
        let sin = v.x.hypot(v.y);
        let [cos_phi, sin_phi] = if sin > 0.0 {
            [v.x / sin, v.y / sin]
        } else {
            [1.0, 0.0]
        };
        let by_phi = Vec3A::new(-sin_phi, cos_phi, 0.0) * sin;
        let by_theta = Vec3A::new(v.z * cos_phi, v.z * sin_phi, -sin);
        let to_scene = to_local.transpose() * sphere.radius;
        [to_scene * (TAU * by_phi), to_scene * (PI * by_theta)]
    }

    /// How the normal of a sphere changes.
    pub fn sphere_normal_derivative(&self, sphere: &Sphere) -> NormalDerivative {
        let curvature = f64::from(sphere.radius).recip();
        NormalDerivative::Sphere {
            curvature: if self.flip { -curvature } else { curvature },
        }
    }

    /// The point nearest to `near` on a sphere of this shape; `primitive` is the index of the sphere.
    #[inline]
    pub fn sphere_point(&self, sphere: &Sphere, primitive: u32, near: DVec3) -> SurfacePoint {
        let &Sphere {
            center,
            radius,
            shape,
        } = sphere;
        let center = DVec3::from_array(center.map(f64::from));
        let outward = (near - center).normalize_or(DVec3::Z);
        let normal = outward.as_vec3a();
        let local = self.sphere_axes() * normal;
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

/// The normal of a triangle by its winding, with twice its area as length. In f64, since f32 has no
/// correct digit for needles.
#[inline]
pub fn cross(corners: &Corners) -> DVec3 {
    let [a, b, c] = corners.map(|corner| DVec3::from_array(corner.map(f64::from)));
    (b - a).cross(c - a)
}

/// Mitsuba's texture coordinates of spheres, (phi / 2 pi, theta / pi) of a unit vector: theta is measured
/// from +z, phi from +x.
#[inline]
pub fn spherical_uv(v: Vec3A) -> Vec2 {
    use std::f32::consts::{FRAC_1_PI, TAU};
    let phi = v.y.atan2(v.x);
    let theta = v.x.hypot(v.y).atan2(v.z);
    let phi = if phi < 0.0 { phi + TAU } else { phi };
    Vec2::new(phi / TAU, theta * FRAC_1_PI)
}
