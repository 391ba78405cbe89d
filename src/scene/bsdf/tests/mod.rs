//! Tests of materials, and what they share: directions, and integration over the sphere.

mod both_ends;
mod disney;
mod faults;
mod materials;
mod mitsuba;
mod phong;
mod physics;
mod sampling;
mod surfaces;

use std::f64::consts::PI;

use glam::{Vec2, Vec3A};

use super::MaterialContext;
use crate::scene::Texture;

fn unit(x: f32, y: f32, z: f32) -> Vec3A {
    Vec3A::new(x, y, z).normalize()
}

/// The direction at `degrees` from the normal +z.
fn tilted(degrees: f32, azimuth: f32) -> Vec3A {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let (sin_phi, cos_phi) = azimuth.sin_cos();
    unit(sin * cos_phi, sin * sin_phi, cos)
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
pub(super) fn integrate_hemisphere(f: &impl Fn(Vec3A) -> f64) -> f64 {
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

/// A point on a plane.
fn context(textures: &[Texture]) -> MaterialContext<'_> {
    MaterialContext::on_plane(textures, Vec2::new(0.3, 0.7))
}
