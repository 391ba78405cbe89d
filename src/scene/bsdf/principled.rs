//! Disney's model of solid surfaces: Mitsuba 3's `principled` (Burley 2015, "Extending the Disney BRDF to a BSDF
//! with integrated subsurface scattering").
//!
//! It is the sum of a diffuse base with sheen, a clearcoat, and rough reflection and transmission by the same
//! microfacets. Metals and dielectrics are blended by the weight of each.

use glam::Vec3A;

use super::context::MaterialContext;
use super::disney::{self, Base, ClearcoatMicrofacets};
use super::facet::Facet;
use super::layered::Layers;
use super::microfacet::Microfacets;
use super::model::BsdfEvaluation;
use crate::math::Rgb;
use crate::sampling::warp::cosine_hemisphere_pdf;

/// Parameters of `Material::Principled`: indices of textures whose values are from 0 to 1, and the index of
/// refraction.
#[derive(Clone, Debug)]
pub struct Principled {
    /// Colour of the base; reflectance of metals at normal incidence.
    pub base_color: u32,
    /// Square root of alpha.
    pub roughness: u32,
    /// Elongation of highlights along dp/du.
    pub anisotropic: u32,
    /// Blends from dielectric to metal.
    pub metallic: u32,
    /// Blends from the base to transmission.
    pub spec_trans: u32,
    /// Blends specular reflection of dielectrics to the hue of the base.
    pub spec_tint: u32,
    /// Strength of sheen.
    pub sheen: u32,
    /// Blends sheen to the hue of the base.
    pub sheen_tint: u32,
    /// Blends the base to an approximation of subsurface scattering.
    pub flatness: u32,
    /// Strength of the clearcoat.
    pub clearcoat: u32,
    /// Gloss of the clearcoat.
    pub clearcoat_gloss: u32,
    /// Index of refraction inside over outside, not 1 if there is transmission.
    pub eta: f32,
    /// Whether `spec_trans` is positive anywhere.
    pub transmits: bool,
}

/// `Material::Principled` at a point.
pub(super) struct PrincipledBsdf {
    base: Base,
    metallic: f32,
    spec_trans: f32,
    spec_tint: f32,
    clearcoat: f32,
    clearcoat_microfacets: ClearcoatMicrofacets,
    microfacets: Microfacets,
    eta: f32,
}

impl PrincipledBsdf {
    #[inline]
    pub fn new(material: &Principled, context: &MaterialContext) -> Self {
        let scalar = |texture: u32| context.texture(texture).luminance();
        let roughness = scalar(material.roughness);
        let anisotropic = scalar(material.anisotropic);
        let alphas = disney::alphas(roughness, anisotropic);
        Self {
            base: Base {
                color: context.texture(material.base_color).color(),
                roughness,
                flatness: scalar(material.flatness),
                sheen: scalar(material.sheen),
                sheen_tint: scalar(material.sheen_tint),
            },
            metallic: scalar(material.metallic),
            spec_trans: scalar(material.spec_trans),
            spec_tint: scalar(material.spec_tint),
            clearcoat: scalar(material.clearcoat),
            clearcoat_microfacets: ClearcoatMicrofacets::new(scalar(material.clearcoat_gloss)),
            microfacets: disney::microfacets(alphas, context),
            eta: material.eta,
        }
    }

    /// Weight of the diffuse base.
    #[inline]
    fn base_weight(&self) -> f32 {
        (1.0 - self.metallic) * (1.0 - self.spec_trans)
    }

    /// Weight of transmission.
    #[inline]
    fn transmission_weight(&self) -> f32 {
        (1.0 - self.metallic) * self.spec_trans
    }

    /// Reflectance of the microfacets: that of a dielectric, that of a metal, and that of a dielectric tinted by the
    /// base (Burley 2012, section 5.4; Burley 2015, section 5.1). From inside, that of the dielectric alone.
    #[inline]
    fn specular_reflectance(&self, facet: &Facet, in_front: bool) -> Rgb {
        if !in_front {
            return Rgb::splat(self.transmission_weight() * facet.reflectance);
        }
        let dielectric = (1.0 - self.metallic) * (1.0 - self.spec_tint) * facet.reflectance;
        let mut sum = Rgb::splat(dielectric);
        if self.metallic > 0.0 {
            sum += self.metallic * disney::schlick(self.base.color, facet.cos, self.eta);
        }
        if self.spec_tint > 0.0 {
            let r0 = disney::hue(self.base.color) * disney::normal_reflectance(self.eta);
            let tinted = disney::schlick(r0, facet.cos, self.eta);
            sum += (1.0 - self.metallic) * self.spec_tint * tinted;
        }
        sum
    }

    /// Probabilities of the lobes from the front, in proportion to their weights.
    #[inline]
    fn choices(&self) -> Choices {
        let total = 1.0 + 0.25 * self.clearcoat + self.base_weight();
        Choices {
            base: self.base_weight() / total,
            clearcoat: 0.25 * self.clearcoat / total,
            specular: total.recip(),
        }
    }
}

/// Probabilities of lobes.
struct Choices {
    base: f32,
    clearcoat: f32,
    specular: f32,
}

impl Layers for PrincipledBsdf {
    #[inline]
    fn microfacets(&self) -> (&Microfacets, f32) {
        (&self.microfacets, self.eta)
    }

    #[inline]
    fn clearcoat_microfacets(&self) -> &ClearcoatMicrofacets {
        &self.clearcoat_microfacets
    }

    /// The base, its sheen and the clearcoat, with the densities of sampling the first and the last. Both
    /// directions are in front.
    #[inline]
    fn evaluate_layers(&self, to_light: Vec3A, to_camera: Vec3A) -> BsdfEvaluation {
        let chosen = self.choices();
        let mut f = Rgb::ZERO;
        if self.base_weight() > 0.0 {
            f += self.base_weight() * self.base.diffuse(to_light, to_camera)
                + (1.0 - self.metallic) * self.base.sheen(to_light, to_camera);
        }
        let pdf = |direction: Vec3A| chosen.base * cosine_hemisphere_pdf(direction.z);
        let layers = BsdfEvaluation {
            f,
            pdf_to_light: pdf(to_light),
            pdf_to_camera: pdf(to_camera),
        };
        if self.clearcoat == 0.0 {
            return layers;
        }
        // f = c/4 F D G, sampled by D cos / (4 |v.m|) (Burley 2012, section 5.6)
        let m = (to_light + to_camera).normalize();
        let cos = to_camera.dot(m).clamp(0.0, 1.0);
        let d = self.clearcoat_microfacets.density(m);
        let masking = ClearcoatMicrofacets::masking;
        let fresnel = disney::schlick(Rgb::splat(0.04), cos, self.eta);
        let weight = 0.25 * self.clearcoat * d * masking(to_light) * masking(to_camera);
        let pdf = chosen.clearcoat * self.clearcoat_microfacets.reflection_pdf(m, cos);
        layers
            + BsdfEvaluation {
                f: weight * fresnel,
                pdf_to_light: pdf,
                pdf_to_camera: pdf,
            }
    }

    #[inline]
    fn layer_choices(&self) -> [f32; 2] {
        let Choices {
            base, clearcoat, ..
        } = self.choices();
        [base, clearcoat]
    }

    #[inline]
    fn front_choices(&self, reflectance: f32) -> (f32, f32) {
        let specular = self.choices().specular;
        let transmitted = self.transmission_weight() * (1.0 - reflectance);
        (specular * (1.0 - transmitted), specular * transmitted)
    }

    #[inline]
    fn transmits(&self) -> bool {
        self.transmission_weight() > 0.0
    }

    #[inline]
    fn facet_color(&self, facet: &Facet, in_front: bool) -> Rgb {
        if facet.reflects {
            self.specular_reflectance(facet, in_front)
        } else {
            let weight = self.transmission_weight() * (1.0 - facet.reflectance);
            weight * self.base.color.map(f32::sqrt)
        }
    }
}
