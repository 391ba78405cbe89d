//! A plate of every material under an even sky: it shows its albedo, for the direction it is seen
//! from, times the radiance of the sky.

use glam::DVec3;
use metrolight::math::Rgb;
use metrolight::render::Integrator::{Bdpt, Path, Pssmlt};
use metrolight::scene::{
    Distribution, EmitterDescription, Material, Scene, ShapeDescription, metals,
};

use super::published::{
    Facets, albedo, conductor_fresnel, dielectric_fresnel, internal_diffuse_reflectance,
};
use crate::common::truths::Truths;
use crate::common::words::{Words, floor, grey, look_at};

const SKY: f64 = 0.8;

/// Textures of [`plate`], and their values.
const GREY: u32 = 0;
const WHITE: u32 = 1;
const RHO: f64 = 0.6;

/// A plate of `material` seen at `degrees` from its normal, from below beyond 90.
fn plate(material: Material, degrees: f64) -> Scene {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let eye = DVec3::new(4.0 * sin, 4.0 * cos, 0.0);
    Words {
        materials: vec![material],
        textures: vec![grey(RHO), grey(1.0)],
        shapes: vec![ShapeDescription {
            name: "plate".into(),
            ..floor(1.0)
        }],
        emitters: vec![EmitterDescription::Constant {
            radiance: Rgb::splat(SKY as f32),
        }],
        // So narrow that the angle is the same all over the film.
        fov_x: 0.05,
        camera: look_at(eye, DVec3::ZERO, DVec3::Z),
        ..Words::default()
    }
    .build()
}

fn textures() -> [metrolight::scene::Texture; 2] {
    [grey(RHO), grey(1.0)]
}

/// The direction of [`plate`]'s camera in the plate's frame.
fn tilted(degrees: f64) -> DVec3 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    DVec3::new(sin, 0.0, cos)
}

/// Smooth glass: what it reflects, and radiance from beyond by the square of the relative index.
fn smooth_glass(eta: f64, from: DVec3) -> f64 {
    let across = if from.z > 0.0 { eta } else { 1.0 / eta };
    let reflected = dielectric_fresnel(from.z.abs(), across);
    reflected + (1.0 - reflected) / (across * across)
}

/// Mitsuba's plastic: F + (1 - F) int (1 - F_i) rho / (pi eta^2 (1 - again)) cos, where what the coat
/// reflects back inside takes on the colour of the body each time, or does not.
fn plastic(eta: f64, nonlinear: bool, from: DVec3) -> f64 {
    let fresnel = |cos: f64| dielectric_fresnel(cos, eta);
    let again = internal_diffuse_reflectance(eta) * if nonlinear { RHO } else { 1.0 };
    let body = RHO / (eta * eta * (1.0 - again));
    let entering = albedo(from, |to, _| {
        if to.z > 0.0 {
            (1.0 - fresnel(to.z)) / std::f64::consts::PI
        } else {
            0.0
        }
    });
    fresnel(from.z) + (1.0 - fresnel(from.z)) * body * entering
}
