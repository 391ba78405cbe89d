//! Orthonormal frames.

use glam::Vec3A;

/// A right-handed orthonormal basis. In local coordinates the normal is +z.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// Local +x in world coordinates, unit length.
    pub s: Vec3A,
    /// Local +y in world coordinates, unit length.
    pub t: Vec3A,
    /// Local +z in world coordinates, unit length.
    pub n: Vec3A,
}

impl Frame {
    /// A frame around the unit vector `n` (Duff et al. 2017, "Building an orthonormal basis,
    /// revisited", listing 3): continuous except at n.z = 0, and accurate to a few ulps everywhere.
    #[inline]
    pub fn from_normal(n: Vec3A) -> Self {
        let sign = 1.0_f32.copysign(n.z);
        let a = -1.0 / (sign + n.z);
        let b = n.x * n.y * a;
        Self {
            s: Vec3A::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
            t: Vec3A::new(b, sign + n.y * n.y * a, -n.y),
            n,
        }
    }

    /// Converts from world to local coordinates.
    #[inline]
    pub fn to_local(&self, v: Vec3A) -> Vec3A {
        Vec3A::new(v.dot(self.s), v.dot(self.t), v.dot(self.n))
    }

    /// Converts from local to world coordinates.
    #[inline]
    pub fn to_world(&self, v: Vec3A) -> Vec3A {
        self.s * v.x + self.t * v.y + self.n * v.z
    }
}
