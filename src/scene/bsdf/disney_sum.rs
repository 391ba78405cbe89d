//! Disney's model as the renderer lajolla assembles it, and its lobes alone (Burley 2012, "Physically based shading at
//! Disney"; Burley 2015, "Extending the Disney BRDF to a BSDF with integrated subsurface scattering"; Li, "Disney
//! Principled BSDF", the first homework among lajolla's handouts, whose equations are meant below).
//!
//! With the parameters m (metallic), t (specular transmission), s (sheen) and c (clearcoat),
//!
//!   f = (1 - t)(1 - m) f_diffuse + (1 - m) s f_sheen + (1 - t (1 - m)) f_metal + c/4 f_clearcoat + (1 - m) t f_glass,
//!
//! where all but f_glass are 0 unless both directions are in front. Mitsuba 3's `principled` has other weights,
//! a clearcoat without the cosines in its denominator, and one Fresnel term for all microfacets.

use glam::{Vec2, Vec3A};

use super::context::MaterialContext;
use super::disney::{self, Base, ClearcoatMicrofacets};
use super::facet::Facet;
use super::layered::Layers;
use super::microfacet::Microfacets;
use super::model::BsdfEvaluation;
use crate::math::Rgb;
use crate::sampling::warp::cosine_hemisphere_pdf;

/// The lobes of a [`DisneySum`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DisneyLobes {
    /// All, with the weights above.
    All,
    /// f_diffuse alone.
    Diffuse,
    /// f_sheen alone.
    Sheen,
    /// f_clearcoat alone.
    Clearcoat,
}

/// Parameters of `Material::DisneySum`: indices of textures whose values are from 0 to 1, and the index of refraction.
#[derive(Clone, Debug)]
pub struct DisneySum {
    /// Which lobes it has.
    pub lobes: DisneyLobes,
    /// Colour of the base; reflectance of metals at normal incidence.
    pub base_color: u32,
    /// Square root of alpha.
    pub roughness: u32,
    /// Elongation of highlights along dp/du.
    pub anisotropic: u32,
    /// Blends from dielectric to metal.
    pub metallic: u32,
    /// Blends from the base to glass.
    pub specular_transmission: u32,
    /// Factor on reflection of the base at normal incidence.
    pub specular: u32,
    /// Blends this reflection to the hue of the base.
    pub specular_tint: u32,
    /// Blends the base to an approximation of subsurface scattering.
    pub subsurface: u32,
    /// Strength of sheen.
    pub sheen: u32,
    /// Blends sheen to the hue of the base.
    pub sheen_tint: u32,
    /// Strength of the clearcoat.
    pub clearcoat: u32,
    /// Gloss of the clearcoat.
    pub clearcoat_gloss: u32,
    /// Index of refraction inside over outside, above 1.
    pub eta: f32,
    /// Whether `specular_transmission` is positive anywhere.
    pub transmits: bool,
}

/// Weights of the lobes, or probabilities.
struct Weights {
    diffuse: f32,
    sheen: f32,
    metal: f32,
    clearcoat: f32,
    glass: f32,
}

impl Weights {
    const NONE: Self = Self {
        diffuse: 0.0,
        sheen: 0.0,
        metal: 0.0,
        clearcoat: 0.0,
        glass: 0.0,
    };

    #[inline]
    fn new(material: &DisneySum, scalar: impl Fn(u32) -> f32) -> Self {
        match material.lobes {
            DisneyLobes::All => {
                let dielectric = 1.0 - scalar(material.metallic);
                let transmission = scalar(material.specular_transmission);
                Self {
                    diffuse: dielectric * (1.0 - transmission),
                    sheen: dielectric * scalar(material.sheen),
                    metal: 1.0 - dielectric * transmission,
                    clearcoat: 0.25 * scalar(material.clearcoat),
                    glass: dielectric * transmission,
                }
            }
            DisneyLobes::Diffuse => Self {
                diffuse: 1.0,
                ..Self::NONE
            },
            DisneyLobes::Sheen => Self {
                sheen: 1.0,
                ..Self::NONE
            },
            DisneyLobes::Clearcoat => Self {
                clearcoat: 1.0,
                ..Self::NONE
            },
        }
    }

    /// Probabilities of sampling the lobes from the front, in proportion to their weights. Sheen is sampled as
    /// the diffuse lobe is.
    #[inline]
    fn probabilities(&self) -> Self {
        let base = self.diffuse + self.sheen;
        let total = base + self.metal + self.clearcoat + self.glass;
        Self {
            diffuse: base / total,
            sheen: 0.0,
            metal: self.metal / total,
            clearcoat: self.clearcoat / total,
            glass: self.glass / total,
        }
    }
}

/// `Material::DisneySum` at a point.
pub(super) struct DisneySumBsdf {
    weights: Weights,
    base: Base,
    /// Reflectance of f_metal at normal incidence: C_0.
    metal_reflectance: Rgb,
    clearcoat_microfacets: ClearcoatMicrofacets,
    microfacets: Microfacets,
    eta: f32,
}

impl DisneySumBsdf {
    #[inline]
    pub fn new(material: &DisneySum, context: &MaterialContext) -> Self {
        let scalar = |texture: u32| context.texture(texture).luminance();
        let color = context.texture(material.base_color).color();
        let roughness = scalar(material.roughness);
        let anisotropic = scalar(material.anisotropic);
        let metallic = scalar(material.metallic);
        let tint = Rgb::ONE.lerp(disney::hue(color), scalar(material.specular_tint));
        let dielectric = scalar(material.specular) * disney::normal_reflectance(material.eta);
        let (alpha, aspect) = (roughness * roughness, disney::aspect(anisotropic));
        let alphas = Vec2::new(alpha / aspect, alpha * aspect);
        Self {
            weights: Weights::new(material, scalar),
            base: Base {
                color,
                roughness,
                flatness: scalar(material.subsurface),
                sheen: 1.0,
                sheen_tint: scalar(material.sheen_tint),
            },
            metal_reflectance: tint * (dielectric * (1.0 - metallic)) + color * metallic,
            clearcoat_microfacets: ClearcoatMicrofacets::new(scalar(material.clearcoat_gloss)),
            microfacets: disney::microfacets(alphas, context),
            eta: material.eta,
        }
    }
}

impl Layers for DisneySumBsdf {
    #[inline]
    fn microfacets(&self) -> (&Microfacets, f32) {
        (&self.microfacets, self.eta)
    }

    #[inline]
    fn clearcoat_microfacets(&self) -> &ClearcoatMicrofacets {
        &self.clearcoat_microfacets
    }

    /// The diffuse lobe, sheen and the clearcoat. Both directions are in front.
    #[inline]
    fn evaluate_layers(&self, to_light: Vec3A, to_camera: Vec3A) -> BsdfEvaluation {
        let (weights, chosen) = (&self.weights, self.weights.probabilities());
        let mut f = Rgb::ZERO;
        if weights.diffuse > 0.0 {
            f += weights.diffuse * self.base.diffuse(to_light, to_camera);
        }
        if weights.sheen > 0.0 {
            f += weights.sheen * self.base.sheen(to_light, to_camera);
        }
        let pdf = |direction: Vec3A| chosen.diffuse * cosine_hemisphere_pdf(direction.z);
        let layers = BsdfEvaluation {
            f,
            pdf_to_light: pdf(to_light),
            pdf_to_camera: pdf(to_camera),
        };
        if weights.clearcoat == 0.0 {
            return layers;
        }
        // f = F D G / (4 cos cos)
        let m = (to_light + to_camera).normalize();
        let cos = to_camera.dot(m).clamp(0.0, 1.0);
        let gamma = ClearcoatMicrofacets::masking_over_cosine;
        let lobe =
            0.25 * self.clearcoat_microfacets.density(m) * gamma(to_light) * gamma(to_camera);
        let fresnel = 0.04 + 0.96 * disney::schlick_weight(cos);
        let pdf = chosen.clearcoat * self.clearcoat_microfacets.reflection_pdf(m, cos);
        layers
            + BsdfEvaluation {
                f: Rgb::splat(weights.clearcoat * fresnel * lobe),
                pdf_to_light: pdf,
                pdf_to_camera: pdf,
            }
    }

    #[inline]
    fn layer_choices(&self) -> [f32; 2] {
        let chosen = self.weights.probabilities();
        [chosen.diffuse, chosen.clearcoat]
    }

    #[inline]
    fn front_choices(&self, reflectance: f32) -> (f32, f32) {
        let Weights { metal, glass, .. } = self.weights.probabilities();
        (metal + glass * reflectance, glass * (1.0 - reflectance))
    }

    #[inline]
    fn transmits(&self) -> bool {
        self.weights.glass > 0.0
    }

    /// Reflectance or transmittance of a microfacet: the weighted sum of those of f_metal and f_glass.
    #[inline]
    fn facet_color(&self, facet: &Facet, in_front: bool) -> Rgb {
        let Weights { metal, glass, .. } = self.weights;
        if !facet.reflects {
            return self.base.color.map(f32::sqrt) * (glass * (1.0 - facet.reflectance));
        }
        let reflected = self.base.color * (glass * facet.reflectance);
        if !in_front {
            return reflected;
        }
        let r0 = self.metal_reflectance;
        let schlick = r0 + (Rgb::ONE - r0) * disney::schlick_weight(facet.cos);
        reflected + metal * schlick
    }
}
