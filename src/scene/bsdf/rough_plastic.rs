//! A diffuse substrate under a rough dielectric coat, seen from the front: Mitsuba 3's `roughplastic`.

use std::f32::consts::FRAC_1_PI;
use std::f64::consts::PI;

use glam::{Vec2, Vec3A};

use super::fresnel::{self, Interface};
use super::microfacet::Microfacets;
use super::model::{Bsdf, BsdfEvaluation, BsdfSample, TransportMode};
use super::rough_reflection;
use super::substrate::Substrate;
use crate::sampling::warp::{cosine_hemisphere_pdf, square_to_cosine_hemisphere};
use crate::scene::texture::TextureAt;

/// Entries of the tables over the cosine, equally spaced from 0 to 1.
const TABLE_SIZE: usize = 64;

/// Smallest cosine that is tabulated: at 0 no microfacet is visible.
const MIN_COS: f32 = 1e-6;

/// Parameters of [`super::Material::RoughPlastic`], with derived constants.
#[derive(Clone, Debug)]
pub struct RoughPlastic {
    pub(super) substrate: Substrate,
    microfacets: Microfacets,
    /// Fraction of diffuse light inside that the coat reflects back.
    internal_reflectance: f32,
    /// Fraction of light from outside that the coat transmits, by cosine.
    transmittance: Box<[f32; TABLE_SIZE]>,
}

impl RoughPlastic {
    pub(super) fn new(microfacets: Microfacets, substrate: Substrate) -> Self {
        let eta = substrate.eta;
        let cos = |i: usize| (i as f32 / (TABLE_SIZE - 1) as f32).max(MIN_COS);
        let (coarse, fine) = (gauss_legendre(32), gauss_legendre(96));
        // 1/pi times the integral of R cos over the hemisphere, by Mitsuba's quadrature over the table.
        let internal: f32 = (0..TABLE_SIZE)
            .map(|i| reflected_fraction(microfacets, eta.recip(), cos(i), &fine) * cos(i))
            .sum();
        Self {
            substrate,
            microfacets,
            internal_reflectance: 2.0 * internal / TABLE_SIZE as f32,
            transmittance: Box::new(std::array::from_fn(|i| {
                transmitted_fraction(microfacets, eta, cos(i), &coarse)
            })),
        }
    }

    #[inline]
    fn transmittance(&self, cos: f32) -> f32 {
        let x = cos.clamp(0.0, 1.0) * (TABLE_SIZE - 1) as f32;
        let i = (x as usize).min(TABLE_SIZE - 2);
        let w = x - i as f32;
        self.transmittance[i] * (1.0 - w) + self.transmittance[i + 1] * w
    }
}

/// `Material::RoughPlastic` at a point, with its two reflectances.
pub(super) struct RoughPlasticBsdf<'a> {
    pub plastic: &'a RoughPlastic,
    pub diffuse: TextureAt<'a>,
    pub specular: TextureAt<'a>,
}

impl Bsdf for RoughPlasticBsdf<'_> {
    #[inline]
    fn evaluate(&self, to_light: Vec3A, to_camera: Vec3A) -> BsdfEvaluation {
        let (diffuse, specular) = (self.diffuse.color(), self.specular.color());
        let microfacets = self.plastic.microfacets;
        let Some(coat) = rough_reflection::evaluate(microfacets, to_light, to_camera) else {
            return BsdfEvaluation::ZERO;
        };
        let light = self.plastic.transmittance(to_light.z);
        let camera = self.plastic.transmittance(to_camera.z);
        let substrate = &self.plastic.substrate;
        let fresnel = fresnel::dielectric(coat.cos, substrate.eta).reflectance;
        let pdf = |transmittance: f32, coat_pdf: f32, direction: Vec3A| {
            let p = substrate.specular_probability(1.0 - transmittance);
            p * coat_pdf + (1.0 - p) * cosine_hemisphere_pdf(direction.z)
        };
        BsdfEvaluation {
            f: specular * (fresnel * coat.f)
                + substrate.albedo(diffuse, self.plastic.internal_reflectance)
                    * (light * camera * FRAC_1_PI),
            pdf_to_light: pdf(camera, coat.pdf_to_light, to_light),
            pdf_to_camera: pdf(light, coat.pdf_to_camera, to_camera),
        }
    }

    #[inline]
    fn sample(&self, from: Vec3A, mode: TransportMode, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        if from.z <= 0.0 {
            return None;
        }
        let reflectance = 1.0 - self.plastic.transmittance(from.z);
        let direction = if u_lobe < self.plastic.substrate.specular_probability(reflectance) {
            rough_reflection::sample(self.plastic.microfacets, from, u)?
        } else {
            square_to_cosine_hemisphere(u)
        };
        self.density_sample(from, direction, mode, 1.0)
    }
}

/// Fraction of the light from an angle of cosine `cos` that microfacets reflect, E[F G1] over the visible
/// normals; `eta` is the index of the far side over that of the near side. Total internal reflection is
/// discontinuous at the critical angle: with 96 points per dimension the error is 2e-4.
fn reflected_fraction(microfacets: Microfacets, eta: f32, cos: f32, rule: &[Node]) -> f32 {
    mean_over_visible(microfacets, cos, rule, |v, m| {
        let v_m = v.dot(m).clamp(0.0, 1.0);
        let reflected = 2.0 * v_m * m - v;
        let g1 = microfacets.masking_over_cosine(reflected) * reflected.z.max(0.0);
        fresnel::dielectric(v_m, eta).reflectance * g1
    })
}

/// Fraction that they transmit, E[(1 - F) G1], as [`reflected_fraction`].
fn transmitted_fraction(microfacets: Microfacets, eta: f32, cos: f32, rule: &[Node]) -> f32 {
    mean_over_visible(microfacets, cos, rule, |v, m| {
        let v_m = v.dot(m).clamp(0.0, 1.0);
        let Interface { reflectance, cos_t } = fresnel::dielectric(v_m, eta);
        let refracted = (v_m / eta - cos_t) * m - v / eta;
        let g1 = microfacets.masking_over_cosine(refracted) * (-refracted.z).max(0.0);
        (1.0 - reflectance) * g1
    })
}

/// Mean of `f`(v, m) over the normals m that are visible from a direction v of cosine `cos`: `rule` is
/// applied to both random numbers that sample m. `f` must be the same for m and its mirror image in the
/// plane of v, so that half of the points across that plane suffice.
fn mean_over_visible(
    microfacets: Microfacets,
    cos: f32,
    rule: &[Node],
    f: impl Fn(Vec3A, Vec3A) -> f32,
) -> f32 {
    let v = Vec3A::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos);
    let mut sum = 0.0;
    for a in rule {
        for b in &rule[..rule.len() / 2] {
            let m = microfacets.sample_visible(v, Vec2::new(a.x as f32, b.x as f32));
            sum += 2.0 * a.weight * b.weight * f64::from(f(v, m));
        }
    }
    sum as f32
}

/// A point of a quadrature rule on [0, 1], with its weight.
struct Node {
    x: f64,
    weight: f64,
}

/// The Gauss-Legendre rule of `n` points: the roots of Legendre's polynomial P_n, found by Newton's
/// iteration from Tricomi's estimate (Abramowitz and Stegun 1964, 25.4.29 and 22.16.6).
fn gauss_legendre(n: u32) -> Vec<Node> {
    let node = |i: u32| {
        let mut x = (PI * (f64::from(i) + 0.75) / (f64::from(n) + 0.5)).cos();
        let mut derivative = 1.0;
        for _ in 0..6 {
            let (mut p, mut previous) = (1.0, 0.0);
            for k in 0..n {
                let k = f64::from(k);
                (p, previous) = (((2.0 * k + 1.0) * x * p - k * previous) / (k + 1.0), p);
            }
            derivative = f64::from(n) * (x * p - previous) / (x * x - 1.0);
            x -= p / derivative;
        }
        Node {
            x: 0.5 * (1.0 - x),
            weight: ((1.0 - x * x) * derivative * derivative).recip(),
        }
    };
    (0..n).map(node).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// n points integrate polynomials of degree 2 n - 1 exactly.
    #[test]
    fn gauss_legendre_is_exact_for_polynomials() {
        for n in [1, 2, 5, 96] {
            let rule = gauss_legendre(n);
            for degree in [0, 1, 2 * n - 1] {
                let term = |node: &Node| node.weight * node.x.powi(degree as i32);
                let integral: f64 = rule.iter().map(term).sum();
                let error = integral - 1.0 / f64::from(degree + 1);
                assert!(error.abs() < 1e-12, "{n} {degree}: {error:e}");
            }
        }
    }
}
