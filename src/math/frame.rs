//! Orthonormal frames.

use glam::Vec3A;

/// A right-handed orthonormal basis; in its local coordinates the normal is +z.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// Image of local +x, unit length.
    pub s: Vec3A,
    /// Image of local +y, unit length.
    pub t: Vec3A,
    /// Image of local +z, unit length.
    pub n: Vec3A,
}

impl Frame {
    /// A frame around the unit vector `n` (Duff et al. 2017, "Building an orthonormal basis,
    /// revisited", listing 3): continuous but for n.z = 0, and exact to a few ulps everywhere.
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

    /// World to local coordinates.
    #[inline]
    pub fn to_local(&self, v: Vec3A) -> Vec3A {
        Vec3A::new(v.dot(self.s), v.dot(self.t), v.dot(self.n))
    }

    /// Local to world coordinates.
    #[inline]
    pub fn to_world(&self, v: Vec3A) -> Vec3A {
        self.s * v.x + self.t * v.y + self.n * v.z
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn frames_are_orthonormal_right_handed_and_invertible(
            x in -1.0f32..1.0, y in -1.0f32..1.0, z in -1.0f32..1.0,
            a in -1.0f32..1.0, b in -1.0f32..1.0, c in -1.0f32..1.0,
        ) {
            let n = Vec3A::new(x, y, z);
            prop_assume!(n.length() > 1e-3);
            let frame = Frame::from_normal(n.normalize());
            for (u, v, expected) in [
                (frame.s, frame.s, 1.0), (frame.t, frame.t, 1.0), (frame.n, frame.n, 1.0),
                (frame.s, frame.t, 0.0), (frame.t, frame.n, 0.0), (frame.n, frame.s, 0.0),
            ] {
                prop_assert!((u.dot(v) - expected).abs() < 2e-6);
            }
            prop_assert!(frame.s.cross(frame.t).dot(frame.n) > 0.999);
            let v = Vec3A::new(a, b, c);
            prop_assert!((frame.to_world(frame.to_local(v)) - v).length() < 5e-6);
        }
    }
}
