//! Disney's model of thin surfaces: Mitsuba 3's `principledthin` (Burley 2015, "Extending the Disney BRDF to a BSDF
//! with integrated subsurface scattering", section 6). It is the same on both sides.

use glam::{Vec2, Vec3A};

use super::context::MaterialContext;
use super::disney::{self, Base};
use super::fresnel;
use super::microfacet::Microfacets;
use super::model::{Bsdf, BsdfEvaluation, BsdfSample, TransportMode};
use crate::math::Rgb;
use crate::sampling::warp::{cosine_hemisphere_pdf, square_to_cosine_hemisphere};

/// Parameters of `Material::PrincipledThin`: indices of textures whose values are from 0 to 1, and the index of
/// refraction.
#[derive(Clone, Debug)]
pub struct PrincipledThin {
    /// Colour of the base and of specular transmission.
    pub base_color: u32,
    /// Square root of alpha.
    pub roughness: u32,
    /// Elongation of highlights along dp/du.
    pub anisotropic: u32,
    /// Blends from the base to specular reflection and transmission.
    pub spec_trans: u32,
    /// Blends specular reflection to the hue of the base.
    pub spec_tint: u32,
    /// Strength of sheen.
    pub sheen: u32,
    /// Blends sheen to the hue of the base.
    pub sheen_tint: u32,
    /// Blends the base to an approximation of subsurface scattering.
    pub flatness: u32,
    /// Half of Mitsuba's `diff_trans`: blends the base from reflection to transmission.
    pub diff_trans: u32,
    /// Index of refraction inside over outside.
    pub eta: f32,
}

/// `Material::PrincipledThin` at a point.
pub(super) struct PrincipledThinBsdf {
    base: Base,
    spec_trans: f32,
    spec_tint: f32,
    diff_trans: f32,
    eta: f32,
    /// Of specular reflection.
    reflecting: Microfacets,
    /// Of specular transmission: its roughness depends on the index of refraction.
    transmitting: Microfacets,
}

impl PrincipledThinBsdf {
    #[inline]
    pub fn new(material: &PrincipledThin, context: &MaterialContext) -> Self {
        let scalar = |texture: u32| context.texture(texture).luminance();
        let roughness = scalar(material.roughness);
        let anisotropic = scalar(material.anisotropic);
        let microfacets =
            |roughness| disney::microfacets(disney::alphas(roughness, anisotropic), context);
        Self {
            base: Base {
                color: context.texture(material.base_color).color(),
                roughness,
                flatness: scalar(material.flatness),
                sheen: scalar(material.sheen),
                sheen_tint: scalar(material.sheen_tint),
            },
            spec_trans: scalar(material.spec_trans),
            spec_tint: scalar(material.spec_tint),
            diff_trans: scalar(material.diff_trans),
            eta: material.eta,
            reflecting: microfacets(roughness),
            // Figure 15
            transmitting: microfacets((0.65 * material.eta - 0.35) * roughness),
        }
    }

    /// Reflectance of a microfacet under the cosine `cos`.
    #[inline]
    fn specular_reflectance(&self, cos: f32) -> Rgb {
        let dielectric = Rgb::splat(fresnel::dielectric(cos, self.eta).reflectance);
        if self.spec_tint == 0.0 {
            return dielectric;
        }
        let r0 = disney::hue(self.base.color) * disney::normal_reflectance(self.eta);
        dielectric.lerp(disney::schlick(r0, cos, self.eta), self.spec_tint)
    }

    /// Reflection; both directions are in front.
    #[inline]
    fn evaluate_reflection(&self, to_light: Vec3A, to_camera: Vec3A) -> BsdfEvaluation {
        let probability = (1.0 - self.spec_trans) * (1.0 - self.diff_trans);
        let base = self.base.diffuse(to_light, to_camera) + self.base.sheen(to_light, to_camera);
        let base = BsdfEvaluation {
            f: base * probability,
            pdf_to_light: probability * cosine_hemisphere_pdf(to_light.z),
            pdf_to_camera: probability * cosine_hemisphere_pdf(to_camera.z),
        };
        if self.spec_trans == 0.0 {
            return base;
        }
        let m = (to_light + to_camera).normalize();
        let cos = to_camera.dot(m).clamp(0.0, 1.0);
        let specular = specular_lobe(self.reflecting, m, to_light, to_camera);
        let probability = 0.5 * self.spec_trans;
        base + BsdfEvaluation {
            f: specular.f * self.spec_trans * self.specular_reflectance(cos),
            pdf_to_light: specular.pdf_to_light * probability,
            pdf_to_camera: specular.pdf_to_camera * probability,
        }
    }

    /// Transmission; `to_camera` is in front and `to_light` is behind.
    #[inline]
    fn evaluate_transmission(&self, to_light: Vec3A, to_camera: Vec3A) -> BsdfEvaluation {
        let reflected = in_front(to_light);
        let weight = (1.0 - self.spec_trans) * self.diff_trans;
        let base = BsdfEvaluation {
            f: self.base.color * (weight * std::f32::consts::FRAC_1_PI),
            pdf_to_light: weight * cosine_hemisphere_pdf(reflected.z),
            pdf_to_camera: weight * cosine_hemisphere_pdf(to_camera.z),
        };
        let m = (reflected + to_camera).normalize();
        // As in Mitsuba 3, the light must also be behind the microfacet.
        if self.spec_trans == 0.0 || to_light.dot(m) >= 0.0 {
            return base;
        }
        let cos = to_camera.dot(m).clamp(0.0, 1.0);
        let transmittance = 1.0 - fresnel::dielectric(cos, self.eta).reflectance;
        let specular = specular_lobe(self.transmitting, m, reflected, to_camera);
        let probability = 0.5 * self.spec_trans;
        base + BsdfEvaluation {
            f: specular.f * self.spec_trans * transmittance * self.base.color,
            pdf_to_light: specular.pdf_to_light * probability,
            pdf_to_camera: specular.pdf_to_camera * probability,
        }
    }
}

/// Reflection by microfacets of the normal `m` that reflect all light, D G / (4 cos cos), with the densities
/// D_v(m) / (4 |v.m|) (Walter et al. 2007, equations 14 and 20). Both directions are in front.
#[inline]
fn specular_lobe(
    microfacets: Microfacets,
    m: Vec3A,
    to_light: Vec3A,
    to_camera: Vec3A,
) -> BsdfEvaluation {
    let quarter_d = 0.25 * microfacets.density(m);
    let light = microfacets.masking_over_cosine(to_light);
    let camera = microfacets.masking_over_cosine(to_camera);
    BsdfEvaluation {
        f: Rgb::splat(quarter_d * light * camera),
        pdf_to_light: quarter_d * camera,
        pdf_to_camera: quarter_d * light,
    }
}

/// `v` reflected to the front.
#[inline]
fn in_front(v: Vec3A) -> Vec3A {
    Vec3A::new(v.x, v.y, v.z.abs())
}

/// `v` reflected from the front to the back.
#[inline]
fn behind(v: Vec3A) -> Vec3A {
    Vec3A::new(v.x, v.y, -v.z)
}

impl Bsdf for PrincipledThinBsdf {
    fn evaluate(&self, to_light: Vec3A, to_camera: Vec3A) -> BsdfEvaluation {
        if to_light.z == 0.0 || to_camera.z == 0.0 {
            return BsdfEvaluation::ZERO;
        }
        // The surface is turned so that the camera is in front.
        let side = 1.0_f32.copysign(to_camera.z);
        let (to_light, to_camera) = (to_light * side, to_camera * side);
        if to_light.z > 0.0 {
            self.evaluate_reflection(to_light, to_camera)
        } else {
            self.evaluate_transmission(to_light, to_camera)
        }
    }

    fn sample(&self, from: Vec3A, mode: TransportMode, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        if from.z == 0.0 {
            return None;
        }
        let side = 1.0_f32.copysign(from.z);
        let v = from * side;
        let (is_specular, transmits) = if u_lobe < self.spec_trans {
            (true, u_lobe < 0.5 * self.spec_trans)
        } else {
            let u_base = (u_lobe - self.spec_trans) / (1.0 - self.spec_trans);
            (false, u_base < self.diff_trans)
        };
        let reflected = if is_specular {
            let microfacets = if transmits {
                self.transmitting
            } else {
                self.reflecting
            };
            let m = microfacets.sample_visible(v, u);
            let reflected = 2.0 * v.dot(m) * m - v;
            let light = match mode {
                TransportMode::Radiance => reflected,
                TransportMode::Importance => v,
            };
            if transmits && behind(light).dot(m) >= 0.0 {
                return None;
            }
            reflected
        } else {
            square_to_cosine_hemisphere(u)
        };
        if reflected.z <= 0.0 {
            return None;
        }
        let direction = if transmits {
            behind(reflected)
        } else {
            reflected
        };
        self.density_sample(from, side * direction.normalize(), mode, 1.0)
    }
}
