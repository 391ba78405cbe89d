//! Ray differentials (Igehy 1999, "Tracing ray differentials"): derivatives of a ray with respect to its
//! direction at its start, carried through transfers, reflections and refractions.
//!
//! With the unit direction w, the distance d to the next surface, its geometric normal N_g, and the unit
//! shading normal n against the ray, c = -w.n:
//!
//!   transfer   dP += d dw;   dP -= w (N_g.dP) / (N_g.w)
//!   reflect    w' = w + 2 c n,               dw' = dw + 2 c dn + 2 n dc
//!   refract    w' = mu w + (mu c - c_t) n,   dw' = mu dw + (mu c - c_t) dn + (mu - mu^2 c / c_t) n dc
//!
//! with dc = -(dw.n + w.dn), mu the index of the near side over that of the far side, and
//! c_t^2 = 1 - mu^2 (1 - c^2).

use glam::DVec3;

use crate::scene::geometry::NormalDerivative;

/// Derivatives with respect to two orthonormal changes of the direction at the start.
#[derive(Clone, Copy, Debug)]
pub struct RayDifferential {
    /// dP, in scene units.
    pub position: [DVec3; 2],
    /// dw.
    pub direction: [DVec3; 2],
}

impl RayDifferential {
    /// Of rays from one point around the unit vector `direction`.
    #[inline]
    pub fn at_point(direction: DVec3) -> Self {
        let (s, t) = direction.any_orthonormal_pair();
        Self {
            position: [DVec3::ZERO; 2],
            direction: [s, t],
        }
    }

    /// Of parallel rays along the unit vector `direction`: derivatives with respect to the position across it.
    #[inline]
    pub fn parallel(direction: DVec3) -> Self {
        let (s, t) = direction.any_orthonormal_pair();
        Self {
            position: [s, t],
            direction: [DVec3::ZERO; 2],
        }
    }

    /// Follows the ray over `distance` to a surface with the geometric normal `normal`.
    #[inline]
    pub fn transfer(&mut self, direction: DVec3, distance: f64, normal: DVec3) {
        let cos = normal.dot(direction);
        for (dp, dw) in self.position.iter_mut().zip(&self.direction) {
            *dp += *dw * distance;
            *dp -= direction * (normal.dot(*dp) / cos);
        }
    }

    /// Reflects the ray at the shading normal `normal`.
    #[inline]
    pub fn reflect(&mut self, direction: DVec3, normal: DVec3, derivative: &NormalDerivative) {
        let cos = -direction.dot(normal);
        for (dp, dw) in self.position.iter().zip(&mut self.direction) {
            let dn = derivative.apply(normal, *dp);
            let dc = -(dw.dot(normal) + direction.dot(dn));
            *dw += 2.0 * (cos * dn + dc * normal);
        }
    }

    /// Refracts the ray at the shading normal `normal`; `mu` is the index of the near side over that of the
    /// far side. There must be no total internal reflection.
    #[inline]
    pub fn refract(
        &mut self,
        direction: DVec3,
        normal: DVec3,
        derivative: &NormalDerivative,
        mu: f64,
    ) {
        let side = -direction.dot(normal).signum();
        let (normal, sign) = (normal * side, side);
        let cos = -direction.dot(normal);
        let cos_t = (1.0 - mu * mu * (1.0 - cos * cos)).max(0.0).sqrt();
        for (dp, dw) in self.position.iter().zip(&mut self.direction) {
            let dn = derivative.apply(normal * sign, *dp) * sign;
            let dc = -(dw.dot(normal) + direction.dot(dn));
            *dw = mu * *dw + (mu * cos - cos_t) * dn + (mu - mu * mu * cos / cos_t) * dc * normal;
        }
    }

    /// |dP_1 x dP_2|: area per solid angle (or area across the ray) at the start.
    #[inline]
    pub fn area(&self) -> f64 {
        self.position[0].cross(self.position[1]).length()
    }

    /// |dw_1 x dw_2|: solid angle per solid angle at the start.
    #[inline]
    pub fn solid_angle(&self) -> f64 {
        self.direction[0].cross(self.direction[1]).length()
    }
}
