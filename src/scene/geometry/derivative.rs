//! Derivatives of shading normals with respect to the position on a surface.

use glam::DVec3;

/// How the unit shading normal changes with the position on a primitive.
#[derive(Clone, Copy, Debug)]
pub enum NormalDerivative {
    /// Not at all.
    Flat,
    /// A sphere: dn = dP / r, where r is negative if the normal points inward.
    Sphere {
        /// 1 / r, per scene unit.
        curvature: f64,
    },
    /// A triangle with the interpolated normal N = N_0 + u M_1 + v M_2, n = N / |N|.
    Triangle {
        /// The vectors whose scalar products with dP are du and dv.
        dual: [DVec3; 2],
        /// M_1 / |N| and M_2 / |N|.
        slopes: [DVec3; 2],
    },
}

impl NormalDerivative {
    /// dn for the displacement `dp` along the surface, where `normal` is n (Igehy 1999, "Tracing ray
    /// differentials", section 3.3).
    #[inline]
    pub fn apply(&self, normal: DVec3, dp: DVec3) -> DVec3 {
        match self {
            Self::Flat => DVec3::ZERO,
            Self::Sphere { curvature } => dp * *curvature,
            Self::Triangle { dual, slopes } => {
                let change = slopes[0] * dual[0].dot(dp) + slopes[1] * dual[1].dot(dp);
                change - normal * normal.dot(change)
            }
        }
    }
}

/// The vectors dual to two edges: their scalar products with a vector in the plane of the edges are its
/// coordinates.
#[inline]
pub fn dual_basis([e1, e2]: [DVec3; 2]) -> [DVec3; 2] {
    let normal = e1.cross(e2);
    let scale = normal.length_squared().recip();
    [e2.cross(normal) * scale, normal.cross(e1) * scale]
}
