//! Spheres as the surfaces of emitters, and the cones that they subtend.

use glam::{Mat3A, Vec2, Vec3A};

use super::sample::SurfaceSample;
use crate::math::Frame;
use crate::scene::geometry::spherical_uv;

/// The surface of a sphere.
#[derive(Debug)]
pub struct SphereSurface {
    pub center: Vec3A,
    pub radius: f32,
    /// Whether the front side is inside.
    pub inward: bool,
    /// From scene axes to its own, for texture coordinates.
    pub to_local: Mat3A,
}

impl SphereSurface {
    /// In scene units squared.
    pub fn area(&self) -> f64 {
        4.0 * std::f64::consts::PI * f64::from(self.radius) * f64::from(self.radius)
    }

    /// The point in the unit direction `outward` from the centre, and the normal there on the front side.
    #[inline]
    pub fn at(&self, outward: Vec3A) -> (Vec3A, Vec3A) {
        let normal = if self.inward { -outward } else { outward };
        (self.center + outward * self.radius, normal)
    }

    /// The point in the unit direction `outward` from the centre, sampled with the density `pdf` per area.
    #[inline]
    pub fn sample(&self, outward: Vec3A, pdf: f32) -> SurfaceSample {
        let (position, normal) = self.at(outward);
        SurfaceSample {
            position,
            normal,
            uv: spherical_uv(self.to_local * outward),
            pdf,
        }
    }

    /// The cone that the sphere subtends at `point`; `None` from inside.
    #[inline]
    pub fn cone(&self, point: Vec3A) -> Option<Cone> {
        let to_point = point.as_dvec3() - self.center.as_dvec3();
        let distance_squared = to_point.length_squared();
        let radius_squared = f64::from(self.radius) * f64::from(self.radius);
        if distance_squared <= radius_squared {
            return None;
        }
        let sin_squared = radius_squared / distance_squared;
        let cos = ((distance_squared - radius_squared) / distance_squared).sqrt();
        Some(Cone {
            axis: (to_point / distance_squared.sqrt()).as_vec3a(),
            sin_squared,
            // 1 - cos without cancellation for a small or distant sphere.
            height: sin_squared / (1.0 + cos),
        })
    }
}

/// The cone of directions to a sphere, in f64 since its solid angle spans many orders of magnitude.
pub struct Cone {
    /// Unit, from the centre of the sphere to the apex.
    axis: Vec3A,
    /// Square of the sine of the half-angle.
    sin_squared: f64,
    /// 1 - cos of the half-angle.
    height: f64,
}

impl Cone {
    /// Density per steradian of a direction uniform in the cone.
    #[inline]
    pub fn pdf(&self) -> f32 {
        (0.5 * std::f64::consts::FRAC_1_PI / self.height) as f32
    }

    /// Samples a direction uniformly in the cone; returns the outward normal of the sphere where it hits
    /// (pbrt, 4th ed., section 6.2.4).
    #[inline]
    pub fn sample_normal(&self, u: Vec2) -> Vec3A {
        let below = self.height * f64::from(u.x);
        let sin2_theta = below * (2.0 - below);
        let cos_theta = 1.0 - below;
        // The sine rule gives the angle beta = alpha + theta at the surface, where alpha is the angle at
        // the centre, and sin alpha = sin(beta - theta).
        let sin2_beta = (sin2_theta / self.sin_squared).min(1.0);
        let cos_beta = (1.0 - sin2_beta).sqrt();
        let sin_theta = sin2_theta.sqrt();
        let sin_alpha = sin2_beta.sqrt() * cos_theta - cos_beta * sin_theta;
        let cos_alpha = cos_beta * cos_theta + sin2_beta.sqrt() * sin_theta;
        let (sin_phi, cos_phi) = (std::f32::consts::TAU * u.y).sin_cos();
        let local = Vec3A::new(
            sin_alpha as f32 * cos_phi,
            sin_alpha as f32 * sin_phi,
            cos_alpha as f32,
        );
        Frame::from_normal(self.axis).to_world(local)
    }
}
