//! Terms of Disney's models (Burley 2012, "Physically based shading at Disney", section 5; Burley 2015,
//! "Extending the Disney BRDF to a BSDF with integrated subsurface scattering"), as `principled`, `principledthin`
//! and the renderer lajolla have them.

use std::f32::consts::{FRAC_1_PI, PI, TAU};

use glam::{Vec2, Vec3A};

use super::context::MaterialContext;
use super::microfacet::{MicrofacetDistribution, Microfacets};
use crate::math::{Rgb, luminance};

/// Minimum of the roughness alpha.
const MIN_ALPHA: f32 = 1e-3;

/// Square root of the ratio of the roughness across the tangent to that along it (Burley 2012, section 5.4).
#[inline]
pub(super) fn aspect(anisotropic: f32) -> f32 {
    (1.0 - 0.9 * anisotropic).sqrt()
}

/// Roughness alpha along the tangent and across it (Burley 2012, section 5.4).
#[inline]
pub(super) fn alphas(roughness: f32, anisotropic: f32) -> Vec2 {
    let aspect = aspect(anisotropic);
    let alpha = roughness * roughness;
    Vec2::new(alpha / aspect, alpha * aspect).max(Vec2::splat(MIN_ALPHA))
}

/// GGX microfacets of the roughness alpha along the tangent and across it.
#[inline]
pub(super) fn microfacets(alphas: Vec2, context: &MaterialContext) -> Microfacets {
    let ggx = MicrofacetDistribution::Ggx;
    if alphas.x == alphas.y {
        Microfacets::isotropic(ggx, alphas.x)
    } else {
        Microfacets::anisotropic(ggx, alphas, context.tangent())
    }
}

/// (1 - cos)^5 (Schlick 1994, "An inexpensive BRDF model for physically-based rendering").
#[inline]
pub(super) fn schlick_weight(cos: f32) -> f32 {
    let m = (1.0 - cos).clamp(0.0, 1.0);
    (m * m) * (m * m) * m
}

/// Schlick's reflectance for `r0` at normal incidence, at `cos` >= 0 outside a medium of relative index `eta`. Inside
/// the denser medium the cosine of the refracted ray takes the place of `cos`.
#[inline]
pub(super) fn schlick(r0: Rgb, cos: f32, eta: f32) -> Rgb {
    let cos = if eta > 1.0 {
        cos
    } else {
        let cos2_t = 1.0 - (1.0 - cos * cos) / (eta * eta);
        cos2_t.max(0.0).sqrt()
    };
    r0 + (Rgb::ONE - r0) * schlick_weight(cos)
}

/// Reflectance at normal incidence for the relative index `eta`.
#[inline]
pub(super) fn normal_reflectance(eta: f32) -> f32 {
    let root = (eta - 1.0) / (eta + 1.0);
    root * root
}

/// The hue of `color`: the color at luminance 1.
#[inline]
pub(super) fn hue(color: Rgb) -> Rgb {
    let luminance = luminance(color);
    if luminance > 0.0 {
        color / luminance
    } else {
        Rgb::ONE
    }
}

/// The parameters of reflection by the base, from 0 to 1.
pub(super) struct Base {
    pub color: Rgb,
    pub roughness: f32,
    /// Blends to an approximation of subsurface scattering.
    pub flatness: f32,
    pub sheen: f32,
    /// Blends the sheen from white to the hue of the base.
    pub sheen_tint: f32,
}

impl Base {
    /// Diffuse reflection with retroreflection, blended with the approximation of subsurface scattering, in 1/sr
    /// (Burley 2015, equations 4 and 6 of section 5.3; Burley 2012, section 5.3). Both directions are in front.
    #[inline]
    pub fn diffuse(&self, to_light: Vec3A, to_camera: Vec3A) -> Rgb {
        let cos_d = half_vector_cos(to_light, to_camera);
        let (light, camera) = (schlick_weight(to_light.z), schlick_weight(to_camera.z));
        let diffuse = (1.0 - 0.5 * light) * (1.0 - 0.5 * camera);
        let rr = 2.0 * self.roughness * cos_d * cos_d;
        let retro = rr * (light + camera + light * camera * (rr - 1.0));
        let lambert = diffuse + retro;
        // Hanrahan and Krueger's model, flattened at grazing angles
        let fss90 = 0.5 * rr;
        let fss = (1.0 + (fss90 - 1.0) * light) * (1.0 + (fss90 - 1.0) * camera);
        let sum = to_light.z + to_camera.z;
        let subsurface = 1.25 * (fss * (sum.recip() - 0.5) + 0.5);
        let blend = lambert + (subsurface - lambert) * self.flatness;
        self.color * (FRAC_1_PI * blend)
    }

    /// Sheen, in 1/sr (Burley 2012, section 5.5). Both directions are in front.
    #[inline]
    pub fn sheen(&self, to_light: Vec3A, to_camera: Vec3A) -> Rgb {
        if self.sheen == 0.0 {
            return Rgb::ZERO;
        }
        let tint = Rgb::ONE.lerp(hue(self.color), self.sheen_tint);
        tint * (self.sheen * schlick_weight(half_vector_cos(to_light, to_camera)))
    }
}

/// Cosine of the angle between either direction and their half vector.
#[inline]
fn half_vector_cos(a: Vec3A, b: Vec3A) -> f32 {
    a.dot((a + b).normalize_or_zero()).clamp(0.0, 1.0)
}

/// The isotropic microfacet distribution of the clearcoat, GTR with the exponent 1 (Burley 2012, appendix B.2).
#[derive(Clone, Copy)]
pub(super) struct ClearcoatMicrofacets {
    alpha2: f32,
}

impl ClearcoatMicrofacets {
    /// Roughness from 0.1 for `gloss` = 0 to 0.001 for `gloss` = 1.
    #[inline]
    pub fn new(gloss: f32) -> Self {
        let alpha = 0.1 + (0.001 - 0.1) * gloss;
        Self {
            alpha2: alpha * alpha,
        }
    }

    /// D(m) (equation 4).
    #[inline]
    pub fn density(&self, m: Vec3A) -> f32 {
        let a = self.alpha2 - 1.0;
        a / (PI * self.alpha2.ln() * (1.0 + a * m.z * m.z))
    }

    /// A direction into which a normal of the density D(m) cos (equation 5) reflects `from`; `None` from behind it,
    /// and where the direction points into the surface.
    #[inline]
    pub fn sample_reflection(&self, from: Vec3A, u: Vec2) -> Option<Vec3A> {
        let cos2 = (1.0 - self.alpha2.powf(1.0 - u.y)) / (1.0 - self.alpha2);
        let (cos, sin) = (
            cos2.clamp(0.0, 1.0).sqrt(),
            (1.0 - cos2).clamp(0.0, 1.0).sqrt(),
        );
        let (sin_phi, cos_phi) = (TAU * u.x).sin_cos();
        let m = Vec3A::new(sin * cos_phi, sin * sin_phi, cos);
        let direction = (2.0 * from.dot(m) * m - from).normalize();
        (from.dot(m) > 0.0 && direction.z > 0.0).then_some(direction)
    }

    /// Density of [`Self::sample_reflection`] per steradian, where `m` is the half vector and `cos` the cosine of
    /// either direction to it: D(m) cos / (4 |v.m|).
    #[inline]
    pub fn reflection_pdf(&self, m: Vec3A, cos: f32) -> f32 {
        self.density(m) * m.z / (4.0 * cos.max(1e-6))
    }

    /// Smith's masking of GGX of roughness 0.25, which the clearcoat has whatever its gloss (section 5.6).
    #[inline]
    pub fn masking(v: Vec3A) -> f32 {
        v.z.abs() * Self::masking_over_cosine(v)
    }

    /// The same over the cosine.
    #[inline]
    pub fn masking_over_cosine(v: Vec3A) -> f32 {
        let cos = v.z.abs();
        let sin2 = (1.0 - cos * cos).max(0.0);
        2.0 / (cos + (cos * cos + 0.0625 * sin2).sqrt())
    }
}
