//! The watertight ray-triangle test of Woop, Benthin and Wald (2013, "Watertight ray/triangle
//! intersection", JCGT 2(1)): a ray that passes a closed mesh at an edge or corner always meets one
//! of the triangles there, because neighbours compute the same edge function with opposite signs.

use glam::Vec3A;

/// Three corners.
pub type Corners = [[f32; 3]; 3];

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug)]
pub struct TriangleHit {
    /// Distance along the ray.
    pub t: f32,
    /// Barycentric coordinate of the second corner.
    pub b1: f32,
    /// Barycentric coordinate of the third corner.
    pub b2: f32,
}

/// The transform that moves a ray to the origin and shears its direction to the axis `Z`, the one
/// along which it is longest (section 3.1 of the paper). The swap of x and y that keeps the winding
/// is left out: both sides of a triangle count.
#[derive(Clone, Copy, Debug)]
pub struct Shear<const Z: usize> {
    origin: [f32; 3],
    x: f32,
    y: f32,
    z: f32,
}

impl<const Z: usize> Shear<Z> {
    const X: usize = (Z + 1) % 3;
    const Y: usize = (Z + 2) % 3;

    /// For the ray from `origin` along `direction`, whose component `Z` is not 0.
    #[inline]
    pub fn new(origin: Vec3A, direction: Vec3A) -> Self {
        let d = direction.to_array();
        Self {
            origin: origin.to_array(),
            x: d[Self::X] / d[Z],
            y: d[Self::Y] / d[Z],
            z: 1.0 / d[Z],
        }
    }

    /// The hit in (0, `t_max`), if any.
    #[inline]
    pub fn intersect(&self, corners: &Corners, t_max: f32) -> Option<TriangleHit> {
        let [a, b, c] = [
            self.shear(&corners[0]),
            self.shear(&corners[1]),
            self.shear(&corners[2]),
        ];
        let mut u = edge(c, b);
        let mut v = edge(a, c);
        let mut w = edge(b, a);
        // Exactly on an edge in f32: only f64, where the products are exact, knows the side.
        if u == 0.0 || v == 0.0 || w == 0.0 {
            u = edge_f64(c, b);
            v = edge_f64(a, c);
            w = edge_f64(b, a);
        }
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let det = u + v + w;
        if det == 0.0 {
            return None;
        }
        let inverse = 1.0 / det;
        let t = (u * a[2] + v * b[2] + w * c[2]) * inverse;
        (t > 0.0 && t < t_max).then_some(TriangleHit {
            t,
            b1: v * inverse,
            b2: w * inverse,
        })
    }

    /// A corner in the space where the ray starts at 0 and goes along +z at unit speed.
    #[inline]
    fn shear(&self, corner: &[f32; 3]) -> [f32; 3] {
        let z = corner[Z] - self.origin[Z];
        [
            corner[Self::X] - self.origin[Self::X] - self.x * z,
            corner[Self::Y] - self.origin[Self::Y] - self.y * z,
            self.z * z,
        ]
    }
}

/// Twice the signed area of the triangle of `p`, `q` and the ray, in projection.
#[inline]
fn edge(p: [f32; 3], q: [f32; 3]) -> f32 {
    p[0] * q[1] - p[1] * q[0]
}

#[cold]
fn edge_f64(p: [f32; 3], q: [f32; 3]) -> f32 {
    let [px, py, qx, qy] = [p[0], p[1], q[0], q[1]].map(f64::from);
    (px * qy - py * qx) as f32
}
