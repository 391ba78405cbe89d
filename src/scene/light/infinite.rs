//! Emitters at infinity. Their light enters the scene through disks that face it and cover the
//! scene's bounding sphere; y_0 is a direction, and its native measure solid angle.

use std::f32::consts::PI;

use glam::{Mat3A, Vec2, Vec3A};

use super::{DirectSample, EmissionSample, EmissionToward, environment::EnvironmentMap};
use crate::math::{Frame, Rgb};
use crate::sampling::warp::{square_to_disk, square_to_sphere};
use crate::scene::SCENE_RADIUS;

/// Radius of the disks: that of the scene, and some room for rounding.
const DISK_RADIUS: f32 = 1.0001 * SCENE_RADIUS;

const DISK_AREA: f32 = PI * DISK_RADIUS * DISK_RADIUS;

/// Parallel light.
#[derive(Debug)]
pub struct DirectionalEmitter {
    /// Unit, in which the light travels.
    pub direction: Vec3A,
    /// W/m^2 on a plane that faces the light.
    pub irradiance: Rgb,
}

impl DirectionalEmitter {
    /// Flux into the scene.
    pub fn power(&self) -> Rgb {
        self.irradiance * DISK_AREA
    }

    /// As [`super::Emitters::sample_direct`]; `choice_pdf` is the probability of this emitter.
    #[inline]
    pub fn sample_direct(&self, point: Vec3A, choice_pdf: f32) -> DirectSample {
        let emission = EmissionToward {
            radiance: self.irradiance,
            pdf_direct: choice_pdf,
            pdf_position: choice_pdf,
            pdf_direction: 1.0 / DISK_AREA,
        };
        from_infinity(point, -self.direction, emission, true)
    }

    /// As [`super::Emitters::sample_emission`].
    #[inline]
    pub fn sample_emission(&self, emitter: u32, place: Vec2, choice_pdf: f32) -> EmissionSample {
        let weight = self.power() / choice_pdf;
        into_scene(emitter, self.direction, place, (choice_pdf, weight), true)
    }
}

/// Radiance from all around.
#[derive(Debug)]
pub enum Environment {
    /// The same from every direction.
    Constant(Rgb),
    /// By direction.
    Map {
        /// In its own coordinates.
        map: EnvironmentMap,
        /// Orthogonal, its coordinates to the scene's.
        to_scene: Mat3A,
    },
}

impl Environment {
    /// Flux into the scene.
    pub fn power(&self) -> Rgb {
        let integral = match self {
            Self::Constant(radiance) => *radiance * (4.0 * PI),
            Self::Map { map, .. } => map.integral(),
        };
        integral * DISK_AREA
    }

    /// Radiance that arrives from `direction` and the density per steradian of sampling it.
    #[inline]
    fn evaluate(&self, direction: Vec3A) -> (Rgb, f32) {
        match self {
            Self::Constant(radiance) => (*radiance, 0.25 / PI),
            Self::Map { map, to_scene } => map.evaluate(to_scene.transpose() * direction),
        }
    }

    /// A direction from which radiance arrives.
    #[inline]
    fn sample(&self, u: Vec2) -> Vec3A {
        match self {
            Self::Constant(_) => square_to_sphere(u),
            Self::Map { map, to_scene } => *to_scene * map.sample(u),
        }
    }

    /// As [`super::Emitters::escape`]; `choice_pdf` is the probability of this emitter.
    #[inline]
    pub fn escape(&self, direction: Vec3A, choice_pdf: f32) -> EmissionToward {
        let (radiance, pdf) = self.evaluate(direction);
        EmissionToward {
            radiance,
            pdf_direct: choice_pdf * pdf,
            pdf_position: choice_pdf * pdf,
            pdf_direction: 1.0 / DISK_AREA,
        }
    }

    /// As [`super::Emitters::sample_direct`].
    #[inline]
    pub fn sample_direct(&self, point: Vec3A, u: Vec2, choice_pdf: f32) -> Option<DirectSample> {
        let direction = self.sample(u);
        let emission = self.escape(direction, choice_pdf);
        (emission.pdf_direct > 0.0).then(|| from_infinity(point, direction, emission, false))
    }

    /// As [`super::Emitters::sample_emission`].
    #[inline]
    pub fn sample_emission(
        &self,
        emitter: u32,
        place: Vec2,
        way: Vec2,
        choice_pdf: f32,
    ) -> Option<EmissionSample> {
        let toward = self.sample(way);
        let (radiance, pdf) = self.evaluate(toward);
        let pdf_position = choice_pdf * pdf;
        (pdf_position > 0.0).then(|| {
            let weight = radiance * (DISK_AREA / pdf_position);
            into_scene(emitter, -toward, place, (pdf_position, weight), false)
        })
    }
}

/// Light that `point` receives from infinity, from `direction`.
#[inline]
fn from_infinity(
    point: Vec3A,
    direction: Vec3A,
    emission: EmissionToward,
    delta: bool,
) -> DirectSample {
    // Outside the scene wherever `point` is.
    let distance = point.length() + 2.0 * SCENE_RADIUS;
    DirectSample {
        direction,
        target: point + direction * distance,
        emission,
        geometry: 1.0,
        spread: 1.0,
        delta,
    }
}

/// A ray along `direction` from a point of the disk that `place` maps to.
#[inline]
fn into_scene(
    emitter: u32,
    direction: Vec3A,
    place: Vec2,
    (pdf_position, weight): (f32, Rgb),
    delta: bool,
) -> EmissionSample {
    let disk = square_to_disk(place) * DISK_RADIUS;
    let frame = Frame::from_normal(direction);
    let origin = frame.s * disk.x + frame.t * disk.y - direction * DISK_RADIUS;
    EmissionSample {
        emitter,
        origin,
        position: origin,
        normal: direction,
        direction,
        weight,
        pdf_position,
        pdf_direction: 1.0 / DISK_AREA,
        infinite: true,
        delta,
    }
}
