//! Tests of materials, and what they share: the materials, and integration over the sphere.

mod mitsuba;
mod physics;
mod sampling;
mod surfaces;

use std::f64::consts::PI;

use glam::{Vec2, Vec3A};

use super::{Material, MicrofacetDistribution, metals};
use crate::math::Rgb;
use crate::scene::Texture;

/// Indices into [`textures`].
const WHITE: u32 = 0;
const COLOR: u32 = 1;
const TINT: u32 = 2;

fn textures() -> [Texture; 3] {
    [
        Texture::Constant(Rgb::ONE),
        Texture::Constant(Rgb::new(0.2, 0.5, 0.8)),
        Texture::Constant(Rgb::new(0.9, 0.8, 0.7)),
    ]
}

fn unit(x: f32, y: f32, z: f32) -> Vec3A {
    Vec3A::new(x, y, z).normalize()
}

/// The direction at `degrees` from the normal +z.
fn tilted(degrees: f32, azimuth: f32) -> Vec3A {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let (sin_phi, cos_phi) = azimuth.sin_cos();
    unit(sin * cos_phi, sin * sin_phi, cos)
}

fn conductor(name: &str, specular_reflectance: u32) -> Material {
    let (eta, k) = metals::metal(name).expect("a known metal");
    Material::Conductor {
        eta,
        k,
        specular_reflectance,
    }
}

fn rough_conductor(
    distribution: MicrofacetDistribution,
    alpha: f32,
    name: &str,
    specular_reflectance: u32,
) -> Material {
    let (eta, k) = metals::metal(name).expect("a known metal");
    Material::RoughConductor {
        distribution,
        alpha,
        eta,
        k,
        specular_reflectance,
    }
}

fn dielectric(eta: f32, reflectance: u32, transmittance: u32) -> Material {
    Material::Dielectric {
        eta,
        specular_reflectance: reflectance,
        specular_transmittance: transmittance,
    }
}

fn rough_dielectric(
    distribution: MicrofacetDistribution,
    alpha: f32,
    eta: f32,
    reflectance: u32,
    transmittance: u32,
) -> Material {
    Material::RoughDielectric {
        distribution,
        alpha,
        eta,
        specular_reflectance: reflectance,
        specular_transmittance: transmittance,
    }
}

/// Materials with a lobe that is not a delta function.
fn connectible() -> Vec<(&'static str, Material)> {
    use MicrofacetDistribution::{Beckmann, Ggx};
    let textures = textures();
    let rough_plastic = |distribution, alpha, eta, nonlinear| {
        Material::rough_plastic(distribution, alpha, eta, nonlinear, COLOR, WHITE, &textures)
    };
    vec![
        ("diffuse", Material::Diffuse { reflectance: COLOR }),
        ("shiny GGX metal", rough_conductor(Ggx, 0.05, "Au", TINT)),
        ("rough GGX metal", rough_conductor(Ggx, 1.0, "Cr", WHITE)),
        (
            "shiny Beckmann metal",
            rough_conductor(Beckmann, 0.05, "Cu", WHITE),
        ),
        (
            "rough Beckmann metal",
            rough_conductor(Beckmann, 0.8, "none", WHITE),
        ),
        (
            "shiny GGX glass",
            rough_dielectric(Ggx, 0.06, 1.5, WHITE, WHITE),
        ),
        (
            "rough GGX glass",
            rough_dielectric(Ggx, 0.7, 1.5, TINT, COLOR),
        ),
        (
            "rough Beckmann bubble",
            rough_dielectric(Beckmann, 0.4, 0.75, WHITE, TINT),
        ),
        (
            "rough Beckmann diamond",
            rough_dielectric(Beckmann, 0.2, 2.419, WHITE, WHITE),
        ),
        (
            "plastic",
            Material::plastic(1.49, false, COLOR, WHITE, &textures),
        ),
        (
            "nonlinear plastic",
            Material::plastic(1.9, true, COLOR, TINT, &textures),
        ),
        ("shiny plastic", rough_plastic(Beckmann, 0.08, 1.49, false)),
        ("rough plastic", rough_plastic(Ggx, 0.5, 1.7, true)),
        (
            "metal and paint",
            Material::TwoSided {
                front: Box::new(rough_conductor(Ggx, 0.3, "Al", WHITE)),
                back: Box::new(Material::plastic(1.49, false, COLOR, WHITE, &textures)),
            },
        ),
    ]
}

/// Materials of which all lobes are delta functions.
fn perfectly_smooth() -> Vec<(&'static str, Material)> {
    use MicrofacetDistribution::Ggx;
    vec![
        ("mirror", conductor("none", WHITE)),
        ("gold", conductor("Au", TINT)),
        ("glass", dielectric(1.5, WHITE, WHITE)),
        ("tinted bubble", dielectric(0.75, TINT, COLOR)),
        ("nothing", dielectric(1.0, WHITE, WHITE)),
        (
            "rough nothing",
            rough_dielectric(Ggx, 0.3, 1.0, WHITE, WHITE),
        ),
    ]
}

/// The point of the sphere at polar angle `theta` and azimuth `phi`.
fn spherical(theta: f64, phi: f64) -> Vec3A {
    let (sin, cos) = theta.sin_cos();
    Vec3A::new(
        (sin * phi.cos()) as f32,
        (sin * phi.sin()) as f32,
        cos as f32,
    )
}

/// Integral of `f` (per steradian) over a rectangle of polar angle and azimuth, by adaptive
/// Gauss-Legendre quadrature with 3 x 3 points: a part is divided in four until that changes it by less
/// than 1e-7 twice in a row (once can happen by chance near a discontinuity of `f`).
fn integrate(f: &impl Fn(Vec3A) -> f64, theta: [f64; 2], phi: [f64; 2]) -> f64 {
    refine(f, [theta, phi], gauss(f, theta, phi), false, 0)
}

fn refine(
    f: &impl Fn(Vec3A) -> f64,
    [theta, phi]: [[f64; 2]; 2],
    coarse: f64,
    agreed: bool,
    depth: u32,
) -> f64 {
    let halves = |[a, b]: [f64; 2]| [[a, 0.5 * (a + b)], [0.5 * (a + b), b]];
    let mut parts = Vec::with_capacity(4);
    for t in halves(theta) {
        for p in halves(phi) {
            parts.push(([t, p], gauss(f, t, p)));
        }
    }
    let fine: f64 = parts.iter().map(|part| part.1).sum();
    let agrees = depth >= 1 && (fine - coarse).abs() < 1e-7;
    if agrees && agreed || depth > 8 {
        return fine;
    }
    parts
        .into_iter()
        .map(|(rectangle, value)| refine(f, rectangle, value, agrees, depth + 1))
        .sum()
}

fn gauss(f: &impl Fn(Vec3A) -> f64, theta: [f64; 2], phi: [f64; 2]) -> f64 {
    let offset = 0.6_f64.sqrt();
    let nodes = [
        (-offset, 5.0 / 18.0),
        (0.0, 8.0 / 18.0),
        (offset, 5.0 / 18.0),
    ];
    let at = |[a, b]: [f64; 2], x: f64| 0.5 * (a + b) + 0.5 * (b - a) * x;
    let mut sum = 0.0;
    for (x, wx) in nodes {
        let t = at(theta, x);
        for (y, wy) in nodes {
            sum += wx * wy * t.sin() * f(spherical(t, at(phi, y)));
        }
    }
    sum * (theta[1] - theta[0]) * (phi[1] - phi[0])
}

/// As [`integrate`], by the midpoint rule with 256 x 256 points.
fn integrate_evenly(f: &impl Fn(Vec3A) -> f64, theta: [f64; 2], phi: [f64; 2]) -> f64 {
    const N: u32 = 256;
    let width = |[a, b]: [f64; 2]| (b - a) / f64::from(N);
    let mut sum = 0.0;
    for i in 0..N {
        let t = theta[0] + (f64::from(i) + 0.5) * width(theta);
        for j in 0..N {
            let p = phi[0] + (f64::from(j) + 0.5) * width(phi);
            sum += t.sin() * f(spherical(t, p));
        }
    }
    sum * width(theta) * width(phi)
}

/// Integral of `f` over the upper hemisphere.
fn integrate_hemisphere(f: &impl Fn(Vec3A) -> f64) -> f64 {
    let step = PI / 16.0;
    let mut sum = 0.0;
    for i in 0..8 {
        for j in 0..32 {
            let at = |i: u32| f64::from(i) * step;
            sum += integrate(f, [at(i), at(i + 1)], [at(j), at(j + 1)]);
        }
    }
    sum
}

/// Texture coordinates for constant textures.
const UV: Vec2 = Vec2::new(0.3, 0.7);
