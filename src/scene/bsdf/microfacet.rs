//! Microfacets: the distribution of their normals m, Smith's masking, and sampling of the normals that
//! are visible from a direction.
//!
//! Every rough material is the product of three factors, with cos theta_v = |v.n|:
//!
//!   D(m)                                   per steradian of m,
//!   gamma(v) = G1(v) / cos theta_v         Smith's masking over the cosine, finite at grazing,
//!   D_v(m) = D(m) gamma(v) |v.m|           density of the normals visible from v,
//!
//! so that no formula divides by a cosine (Walter et al. 2007, "Microfacet models for
//! refraction through rough surfaces"; D_v is equation 3 of Heitz 2018, "Sampling the GGX
//! distribution of visible normals"). As in Mitsuba 3, masking and shadowing are independent: G = G1 G1.

use std::f32::consts::{FRAC_1_PI, FRAC_2_SQRT_PI, PI};

use glam::{Mat2, Vec2, Vec2Swizzles, Vec3A};
use libm::erff;

use crate::sampling::warp::square_to_disk;

/// The distribution of microfacet normals of a rough surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MicrofacetDistribution {
    /// Beckmann and Spizzichino 1963.
    Beckmann,
    /// Trowbridge and Reitz 1975, as GGX in Walter et al. 2007.
    Ggx,
}

/// Minimum roughness, to which Mitsuba 3 clamps.
const MIN_ALPHA: f32 = 1e-4;

/// The microfacets of a surface. They are those of a surface of roughness 1, stretched along the surface by
/// the linear map A = diag(1 / alpha_u, 1 / alpha_v) R, where R rotates the tangent of alpha_u to the axis x
/// (Heitz 2014, "Understanding the masking-shadowing function in microfacet-based BRDFs", section 5.3):
/// horizontal components of normals are multiplied by A, those of directions by its inverse transpose.
#[derive(Clone, Copy, Debug)]
pub(super) struct Microfacets {
    distribution: MicrofacetDistribution,
    /// A.
    to_unit_normal: Mat2,
    /// The inverse transpose of A, diag(alpha_u, alpha_v) R.
    to_unit_direction: Mat2,
    /// alpha_u alpha_v.
    alpha2: f32,
}

impl Microfacets {
    /// Of the same roughness in all directions.
    #[inline]
    pub fn isotropic(distribution: MicrofacetDistribution, alpha: f32) -> Self {
        let alpha = alpha.max(MIN_ALPHA);
        Self {
            distribution,
            to_unit_normal: Mat2::from_diagonal(Vec2::splat(alpha.recip())),
            to_unit_direction: Mat2::from_diagonal(Vec2::splat(alpha)),
            alpha2: alpha * alpha,
        }
    }

    /// Of roughness `alpha.x` along the unit vector `tangent` and `alpha.y` across it.
    #[inline]
    pub fn anisotropic(distribution: MicrofacetDistribution, alpha: Vec2, tangent: Vec2) -> Self {
        let alpha = alpha.max(Vec2::splat(MIN_ALPHA));
        let rotation = Mat2::from_cols(
            Vec2::new(tangent.x, -tangent.y),
            Vec2::new(tangent.y, tangent.x),
        );
        Self {
            distribution,
            to_unit_normal: Mat2::from_diagonal(alpha.recip()) * rotation,
            to_unit_direction: Mat2::from_diagonal(alpha) * rotation,
            alpha2: alpha.x * alpha.y,
        }
    }

    /// D(m) of a unit normal `m` with m.z >= 0 (Walter et al. 2007, equations 25 and 33).
    #[inline]
    pub fn density(&self, m: Vec3A) -> f32 {
        let cos2 = m.z * m.z;
        let slope2_cos2 = (self.to_unit_normal * horizontal(m)).length_squared();
        match self.distribution {
            MicrofacetDistribution::Beckmann => {
                // The exponential underflows to 0 before the square of the cosine does.
                if cos2 < 1e-8 {
                    return 0.0;
                }
                (-slope2_cos2 / cos2).exp() / (PI * self.alpha2 * cos2 * cos2)
            }
            MicrofacetDistribution::Ggx => {
                let root = slope2_cos2 + cos2;
                FRAC_1_PI / (self.alpha2 * root * root)
            }
        }
    }

    /// gamma(v) = G1(v) / |v.z| of a unit direction on either side (Walter et al. 2007, equations 26
    /// and 34). Beckmann's G1 is exact here. Mitsuba 3 has the rational fit of equation 27, which is off
    /// by 0.3%, so that the density of sampled normals does not integrate to 1.
    #[inline]
    pub fn masking_over_cosine(&self, v: Vec3A) -> f32 {
        let cos = v.z.abs();
        let alpha_sin = (self.to_unit_direction * horizontal(v)).length();
        match self.distribution {
            MicrofacetDistribution::Beckmann => {
                let a = cos / alpha_sin;
                let exponential = 0.5 * FRAC_2_SQRT_PI * alpha_sin * (-a * a).exp();
                2.0 / (cos * (1.0 + erff(a)) + exponential)
            }
            MicrofacetDistribution::Ggx => 2.0 / (cos + (cos * cos + alpha_sin * alpha_sin).sqrt()),
        }
    }

    /// A microfacet normal visible from `v` (unit, v.z > 0), with density D_v(m) per steradian. It is
    /// a continuous map of `u`: u.x moves the normal in the plane of `v`, u.y across it, and the halves
    /// of the square on either side of u.y = 1/2 are mirror images.
    #[inline]
    pub fn sample_visible(&self, v: Vec3A, u: Vec2) -> Vec3A {
        let stretched = with_horizontal(v, self.to_unit_direction * horizontal(v)).normalize();
        let unit_normal = match self.distribution {
            MicrofacetDistribution::Beckmann => {
                let slope = beckmann_visible_slope(stretched.z, u);
                let tangent = horizontal(stretched).normalize_or(Vec2::X);
                with_horizontal(Vec3A::Z, -tangent.rotate(slope))
            }
            MicrofacetDistribution::Ggx => ggx_visible_normal(stretched, u),
        };
        let transposed = self.to_unit_direction.transpose();
        with_horizontal(unit_normal, transposed * horizontal(unit_normal)).normalize()
    }
}

/// The components of `v` along the surface.
#[inline]
fn horizontal(v: Vec3A) -> Vec2 {
    Vec2::new(v.x, v.y)
}

/// `v` with these components along the surface.
#[inline]
fn with_horizontal(v: Vec3A, horizontal: Vec2) -> Vec3A {
    Vec3A::new(horizontal.x, horizontal.y, v.z)
}

/// A visible normal of GGX with alpha = 1, whose microfacets form a hemisphere: the point of the
/// hemisphere seen from `v` at a uniform point of its projection (Heitz 2018, appendix A).
#[inline]
fn ggx_visible_normal(v: Vec3A, u: Vec2) -> Vec3A {
    let t1 = Vec2::new(-v.y, v.x).normalize_or(Vec2::X);
    let t1 = Vec3A::new(t1.x, t1.y, 0.0);
    let t2 = v.cross(t1);
    // The projection is half a disk and half an ellipse: the lower half of the disk is compressed.
    let p = square_to_disk(u.yx());
    let half_chord = (1.0 - p.x * p.x).max(0.0).sqrt();
    let s = 0.5 * (1.0 + v.z);
    let y = (1.0 - s) * half_chord + s * p.y;
    let z = (1.0 - p.x * p.x - y * y).max(0.0).sqrt();
    let m = p.x * t1 + y * t2 + z * v;
    Vec3A::new(m.x, m.y, m.z.max(0.0))
}

/// Slope, along and across the view, of a microfacet of Beckmann's distribution with alpha = 1 that is
/// visible at an angle of cosine `cos` > 0 (Heitz and d'Eon 2014, "Importance sampling microfacet-based BSDFs using the
/// distribution of visible normals").
///
/// With x = erf(s) and t = tan theta, the distribution function of the slope s along the view is
///
///   (1 + x + t exp(-s^2) / sqrt(pi)) / C,   x from -1 to erf(1/t),
///
/// which is increasing and concave in x, so that Newton's iteration converges from any start (Jakob
/// 2014, "An improved visible normal sampling routine for the Beckmann distribution", which also gives
/// the initial guess used here).
#[inline]
fn beckmann_visible_slope(cos: f32, u: Vec2) -> Vec2 {
    // At the ends of [0, 1] the slope is infinite: u stays half its resolution away from them.
    const EDGE: f64 = 0.5 * (f32::EPSILON as f64 / 2.0);
    // `erf_inv` is not defined beyond; slopes there have probability 1e-8.
    const OPEN: f64 = 1.0 - 1e-8;
    const MAX_STEPS: u32 = 16;
    let [u1, u2] = [u.x, u.y].map(|u| f64::from(u).clamp(EDGE, 1.0 - EDGE));
    let cos = f64::from(cos);
    let tan = (1.0 - cos * cos).max(0.0).sqrt() / cos;
    let t_over_root_pi = 0.5 * std::f64::consts::FRAC_2_SQRT_PI * tan;
    let x_max = f64::from(erff(tan.recip() as f32));
    let target = u1 * (1.0 + x_max + t_over_root_pi * (-tan.powi(-2)).exp());
    let mut x = x_max - (1.0 + x_max) * f64::from(erff((-u1.ln()).sqrt() as f32));
    for _ in 0..MAX_STEPS {
        x = x.clamp(-OPEN, x_max.min(OPEN));
        let s = erf_inv(x);
        let value = 1.0 + x + t_over_root_pi * (-s * s).exp() - target;
        let step = value / (1.0 - s * tan);
        x -= step;
        // Convergence is quadratic: the remaining error is far smaller than the step.
        if step.abs() < 1e-4 * (1.0 + x) {
            break;
        }
    }
    let x = x.clamp(-OPEN, OPEN);
    Vec2::new(erf_inv(x) as f32, erf_inv(2.0 * u2 - 1.0) as f32)
}

/// Inverse of the error function for |x| <= 1 - 1e-8, to 1e-5 relative (Giles 2012, "Approximating the
/// erfinv function", single precision).
#[inline]
pub(super) fn erf_inv(x: f64) -> f64 {
    const CENTRE: [f64; 9] = [
        2.810_226_36e-8,
        3.432_739_39e-7,
        -3.523_387_7e-6,
        -4.391_506_54e-6,
        0.000_218_580_87,
        -0.001_253_725_03,
        -0.004_177_681_64,
        0.246_640_727,
        1.501_409_41,
    ];
    const TAIL: [f64; 9] = [
        -0.000_200_214_257,
        0.000_100_950_558,
        0.001_349_343_22,
        -0.003_673_428_44,
        0.005_739_507_73,
        -0.007_622_461_3,
        0.009_438_870_47,
        1.001_674_06,
        2.832_976_82,
    ];
    let w = -((1.0 - x) * (1.0 + x)).ln();
    let (coefficients, w) = if w < 5.0 {
        (CENTRE, w - 2.5)
    } else {
        (TAIL, w.sqrt() - 3.0)
    };
    x * coefficients.iter().fold(0.0, |sum, c| sum * w + c)
}
