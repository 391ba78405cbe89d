//! The watertight ray-triangle test of Woop, Benthin and Wald (2013, "Watertight ray/triangle
//! intersection", JCGT 2(1)), for four triangles at once. A ray through an edge or corner of a closed mesh
//! always hits one of the triangles there, because adjacent triangles compute the same edge function with
//! opposite signs.

use bytemuck::{Pod, Zeroable};
use glam::Vec3A;
use wide::f32x4;

/// The corners of a triangle.
pub type Corners = [[f32; 3]; 3];

/// Triangles in a packet.
pub const LANES: usize = 4;

/// Up to four triangles. The corners of unused lanes are NaN, so that no ray hits them.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Packet {
    /// For each axis, that coordinate of the first, second and third corners.
    axes: [[f32x4; 3]; 3],
}

/// A hit on a triangle of a packet.
#[derive(Clone, Copy, Debug)]
pub struct TriangleHit {
    /// Which triangle of the packet.
    pub lane: usize,
    /// Distance along the ray.
    pub t: f32,
    /// Barycentric coordinate of the second corner.
    pub b1: f32,
    /// Barycentric coordinate of the third corner.
    pub b2: f32,
}

impl Packet {
    /// Packs four triangles.
    pub fn new(triangles: [Corners; LANES]) -> Self {
        let coordinates =
            |axis: usize, k: usize| f32x4::new(triangles.map(|corners| corners[k][axis]));
        Self {
            axes: [0, 1, 2].map(|axis| [0, 1, 2].map(|k| coordinates(axis, k))),
        }
    }

    /// The corners of one triangle; `None` for an unused lane.
    #[inline]
    pub fn corners(&self, lane: usize) -> Option<Corners> {
        let corner = |k: usize| self.axes.map(|corners| corners[k].to_array()[lane % LANES]);
        let corners = [corner(0), corner(1), corner(2)];
        (!corners[0][0].is_nan()).then_some(corners)
    }
}

/// The transform that moves the origin of a ray to 0 and shears its direction to z, the axis of its
/// largest component (section 3.1 of the paper). The swap of x and y that preserves the winding is
/// omitted, since both sides of a triangle can be hit.
#[derive(Clone, Copy, Debug)]
pub struct RayTransform {
    /// The axes of space that become x, y and z.
    axes: [usize; 3],
    origin: [f32x4; 3],
    x: f32x4,
    y: f32x4,
    z: f32x4,
}

/// Edge functions: twice the signed areas, in projection, of the triangles that the ray forms with
/// each edge.
type Edges = [f32x4; 3];

impl RayTransform {
    /// For the ray from `origin` along `direction`, which is not 0.
    #[inline(always)]
    pub fn new(origin: Vec3A, direction: Vec3A) -> Self {
        let z = longest_axis(direction);
        let axes = [(z + 1) % 3, (z + 2) % 3, z];
        let d = axes.map(|axis| direction[axis]);
        Self {
            axes,
            origin: axes.map(|axis| f32x4::splat(origin[axis])),
            x: f32x4::splat(d[0] / d[2]),
            y: f32x4::splat(d[1] / d[2]),
            z: f32x4::splat(1.0 / d[2]),
        }
    }

    /// The nearest hit in (0, `t_max`), if any.
    #[inline(always)]
    pub fn intersect(&self, packet: &Packet, t_max: f32) -> Option<TriangleHit> {
        let (mut hits, t, [_, v, w], inverse) = self.test(packet, t_max)?;
        let t = t.to_array();
        let mut lane = hits.trailing_zeros() as usize % LANES;
        hits &= hits - 1;
        while hits != 0 {
            let other = hits.trailing_zeros() as usize % LANES;
            hits &= hits - 1;
            if t[other] < t[lane] {
                lane = other;
            }
        }
        Some(TriangleHit {
            lane,
            t: t[lane],
            b1: (v * inverse).to_array()[lane],
            b2: (w * inverse).to_array()[lane],
        })
    }

    /// True if any triangle is hit in (0, `t_max`).
    #[inline(always)]
    pub fn occluded(&self, packet: &Packet, t_max: f32) -> bool {
        self.test(packet, t_max).is_some()
    }

    /// A mask of the triangles that are hit in (0, `t_max`), and the distances, edge functions and
    /// inverse determinants of all; `None` if there is no hit.
    #[inline(always)]
    fn test(&self, packet: &Packet, t_max: f32) -> Option<(u32, f32x4, Edges, f32x4)> {
        let [xs, ys, zs] = self.axes.map(|axis| &packet.axes[axis]);
        let z = zs.map(|z| z - self.origin[2]);
        let x: [f32x4; 3] = std::array::from_fn(|k| xs[k] - self.origin[0] - self.x * z[k]);
        let y: [f32x4; 3] = std::array::from_fn(|k| ys[k] - self.origin[1] - self.y * z[k]);
        let mut edges = [(2, 1), (0, 2), (1, 0)].map(|(p, q)| x[p] * y[q] - y[p] * x[q]);
        let [u, v, w] = edges;
        // Exactly on an edge in f32: the side follows in f64, where the products are exact.
        let zero = f32x4::ZERO;
        if (u.simd_eq(zero) | v.simd_eq(zero) | w.simd_eq(zero)).to_bitmask() != 0 {
            edges = edges_f64(&x, &y);
        }
        let [u, v, w] = edges;
        let inside =
            u.fast_min(v).fast_min(w).simd_ge(zero) | u.fast_max(v).fast_max(w).simd_le(zero);
        if inside.to_bitmask() == 0 {
            return None;
        }
        let inverse = f32x4::ONE / (u + v + w);
        let t = (u * z[0] + v * z[1] + w * z[2]) * self.z * inverse;
        let hits = inside & t.simd_gt(zero) & t.simd_lt(f32x4::splat(t_max));
        let hits = hits.to_bitmask();
        (hits != 0).then_some((hits, t, edges, inverse))
    }
}

#[inline(always)]
fn longest_axis(direction: Vec3A) -> usize {
    let d = direction.abs();
    if d.x >= d.y && d.x >= d.z {
        0
    } else if d.y >= d.z {
        1
    } else {
        2
    }
}

/// The edge functions in double precision (section 3.3 of the paper: the rare case).
#[cold]
fn edges_f64(x: &[f32x4; 3], y: &[f32x4; 3]) -> Edges {
    let [x, y] = [x, y].map(|v| v.map(|v| v.to_array().map(f64::from)));
    [(2, 1), (0, 2), (1, 0)].map(|(p, q)| {
        f32x4::new(std::array::from_fn(|lane| {
            (x[p][lane] * y[q][lane] - y[p][lane] * x[q][lane]) as f32
        }))
    })
}
