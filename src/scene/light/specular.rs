//! Points on emitters as the ends of specular chains. They are sampled by area (by solid angle at infinity),
//! not for the point that is lit: a chain may need a point that a straight line does not.

use std::f32::consts::{FRAC_1_PI, TAU};

use glam::{Vec2, Vec3A};

use super::infinite::DISK_AREA;
use super::sphere::SphereSurface;
use crate::math::{Frame, Rgb};
use crate::scene::interaction::offset;
use crate::scene::specular::Endpoint;

/// A point on an emitter, or a direction to one.
#[derive(Clone, Copy, Debug)]
pub struct ChainEnd {
    /// Where the chain ends.
    pub end: Endpoint,
    /// Radiance (intensity of a point light, irradiance of a directional one) toward every chain that leaves
    /// the front side.
    pub radiance: Rgb,
    /// Density per unit area (per steradian at infinity; a probability for point and directional lights).
    pub pdf: f64,
    /// Density with which light subpaths sample the end, likewise.
    pub pdf_position: f64,
    /// A point or directional light, which no subpath hits.
    pub delta: bool,
}

impl ChainEnd {
    /// Radiance toward a chain that arrives at the end in the unit direction `direction`.
    #[inline]
    pub fn radiance_against(&self, direction: Vec3A) -> Rgb {
        match self.end {
            Endpoint::Point {
                normal: Some(normal),
                ..
            } if normal.as_vec3a().dot(direction) >= 0.0 => Rgb::ZERO,
            Endpoint::Point { .. } | Endpoint::Direction(_) => self.radiance,
        }
    }

    /// Density with which a light subpath samples the direction against the unit vector `direction`, in which a
    /// chain arrives: per steradian (per unit area across the ray at infinity).
    #[inline]
    pub fn pdf_direction(&self, direction: Vec3A) -> f64 {
        let pdf = match self.end {
            Endpoint::Point {
                normal: Some(normal),
                ..
            } => -normal.as_vec3a().dot(direction).min(0.0) * FRAC_1_PI,
            Endpoint::Point { .. } => 0.25 * FRAC_1_PI,
            Endpoint::Direction(_) => DISK_AREA.recip(),
        };
        f64::from(pdf)
    }

    /// The point up to which a chain that leaves `from` in the unit direction `direction` must be free.
    #[inline]
    pub fn target(&self, from: Vec3A, direction: Vec3A) -> Vec3A {
        match self.end {
            Endpoint::Point {
                position,
                normal: Some(normal),
            } => offset(position.as_vec3a(), normal.as_vec3a(), -direction),
            Endpoint::Point { position, .. } => position.as_vec3a(),
            Endpoint::Direction(_) => {
                from + direction * (from.length() + 2.0 * crate::scene::SCENE_RADIUS)
            }
        }
    }
}

/// The part of a sphere that faces a bounding sphere of all casters.
#[derive(Clone, Copy, Debug)]
pub struct Cap {
    /// Unit, from the centre of the emitter to the casters.
    axis: Vec3A,
    /// 1 - cos of the half-angle.
    height: f32,
}

impl Cap {
    /// The points of `sphere` that see some point of a bounding sphere; all points of one that emits inward.
    pub fn facing(sphere: &SphereSurface, (center, radius): (Vec3A, f32)) -> Self {
        let to_casters = center - sphere.center;
        let distance = to_casters.length();
        // A point with the outward normal n sees a point of the bounding sphere if n . to_casters + radius
        // exceeds the radius of the emitter.
        let cos = (sphere.radius - radius) / distance;
        let whole = sphere.inward || cos.is_nan();
        Self {
            axis: to_casters.normalize_or(Vec3A::Z),
            height: if whole {
                2.0
            } else {
                1.0 - cos.clamp(-1.0, 1.0)
            },
        }
    }

    /// Density per unit area on `sphere`, with the outward normal `outward`.
    #[inline]
    pub fn pdf(&self, sphere: &SphereSurface, outward: Vec3A) -> f64 {
        if 1.0 - self.axis.dot(outward) > self.height {
            return 0.0;
        }
        let radius = f64::from(sphere.radius);
        0.5 * f64::from(FRAC_1_PI) / (radius * radius * f64::from(self.height))
    }

    /// Samples an outward normal uniformly.
    #[inline]
    pub fn sample(&self, u: Vec2) -> Vec3A {
        let below = self.height * u.x;
        let sin = (below * (2.0 - below)).max(0.0).sqrt();
        let (sin_phi, cos_phi) = (TAU * u.y).sin_cos();
        let local = Vec3A::new(sin * cos_phi, sin * sin_phi, 1.0 - below);
        Frame::from_normal(self.axis).to_world(local)
    }
}

/// A point on a surface as an end.
pub(super) fn on_surface(position: Vec3A, normal: Vec3A) -> Endpoint {
    Endpoint::Point {
        position: position.as_dvec3(),
        normal: Some(normal.as_dvec3().normalize()),
    }
}

/// A direction as an end.
pub(super) fn at_infinity(direction: Vec3A) -> Endpoint {
    Endpoint::Direction(direction.as_dvec3().normalize())
}

/// A point without a surface as an end.
pub(super) fn point(position: Vec3A) -> Endpoint {
    Endpoint::Point {
        position: position.as_dvec3(),
        normal: None,
    }
}
