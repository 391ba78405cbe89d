//! A diffuse substrate under a smooth dielectric coat, seen from the front: Mitsuba 3's `plastic`.

use std::f32::consts::FRAC_1_PI;

use glam::{Vec2, Vec3A};

use super::fresnel;
use super::model::{Bsdf, BsdfEvaluation, BsdfSample, Flags, TransportMode};
use crate::math::Rgb;
use crate::sampling::warp::{cosine_hemisphere_pdf, square_to_cosine_hemisphere};
use crate::scene::texture::Texture;

/// The substrate, and its interreflection with the coat.
#[derive(Clone, Debug)]
pub(super) struct Substrate {
    /// Its reflectance, the index of a texture.
    pub reflectance: u32,
    /// Whether light that the coat reflects back is coloured by the substrate again each time.
    pub nonlinear: bool,
    /// Fraction of diffuse light inside that the coat reflects back.
    pub internal_reflectance: f32,
    /// Squared index of refraction of the outside over that of the coat.
    pub inv_eta2: f32,
}

impl Substrate {
    /// Reflectance after all reflections between substrate and coat, a geometric series, without the
    /// transmittances of the coat in both directions.
    #[inline]
    pub fn albedo(&self, reflectance: Rgb) -> Rgb {
        let again = if self.nonlinear {
            reflectance * self.internal_reflectance
        } else {
            Rgb::splat(self.internal_reflectance)
        };
        reflectance * self.inv_eta2 / (Rgb::ONE - again)
    }
}

/// Weight of the specular lobe for choosing a lobe, from the means of both reflectances.
pub(super) fn specular_weight(textures: &[Texture], diffuse: u32, specular: u32) -> f32 {
    let mean = |texture: u32| textures[texture as usize].mean().element_sum();
    let (diffuse, specular) = (mean(diffuse), mean(specular));
    if diffuse + specular > 0.0 {
        specular / (diffuse + specular)
    } else {
        0.5
    }
}

/// Probability of choosing the specular lobe where the coat has reflectance `reflectance`.
#[inline]
pub(super) fn specular_probability(specular_weight: f32, reflectance: f32) -> f32 {
    let specular = reflectance * specular_weight;
    let diffuse = (1.0 - reflectance) * (1.0 - specular_weight);
    if specular > 0.0 {
        specular / (specular + diffuse)
    } else {
        0.0
    }
}

/// Parameters of [`super::Material::Plastic`], with derived constants.
#[derive(Clone, Debug)]
pub struct Plastic {
    pub(super) substrate: Substrate,
    /// Inside over outside.
    eta: f32,
    pub(super) specular_reflectance: u32,
    specular_weight: f32,
}

impl Plastic {
    pub(super) fn new(
        eta: f32,
        nonlinear: bool,
        diffuse_reflectance: u32,
        specular_reflectance: u32,
        textures: &[Texture],
    ) -> Self {
        Self {
            substrate: Substrate {
                reflectance: diffuse_reflectance,
                nonlinear,
                internal_reflectance: fresnel::internal_diffuse_reflectance(eta),
                inv_eta2: (eta * eta).recip(),
            },
            eta,
            specular_reflectance,
            specular_weight: specular_weight(textures, diffuse_reflectance, specular_reflectance),
        }
    }
}

/// `Material::Plastic` at a point, with its two reflectances.
pub(super) struct PlasticBsdf<'a> {
    pub plastic: &'a Plastic,
    pub diffuse: Rgb,
    pub specular: Rgb,
}

impl Bsdf for PlasticBsdf<'_> {
    const FLAGS: Flags = Flags::BOTH;

    /// The diffuse lobe; the specular lobe is a delta function.
    #[inline]
    fn evaluate(&self, to_light: Vec3A, to_camera: Vec3A) -> BsdfEvaluation {
        if !(to_light.z > 0.0 && to_camera.z > 0.0) {
            return BsdfEvaluation::ZERO;
        }
        let light = fresnel::dielectric(to_light.z.min(1.0), self.plastic.eta).reflectance;
        let camera = fresnel::dielectric(to_camera.z.min(1.0), self.plastic.eta).reflectance;
        let pdf = |reflectance: f32, direction: Vec3A| {
            (1.0 - specular_probability(self.plastic.specular_weight, reflectance))
                * cosine_hemisphere_pdf(direction.z)
        };
        BsdfEvaluation {
            f: self.plastic.substrate.albedo(self.diffuse)
                * ((1.0 - light) * (1.0 - camera) * FRAC_1_PI),
            pdf_to_light: pdf(camera, to_light),
            pdf_to_camera: pdf(light, to_camera),
        }
    }

    #[inline]
    fn sample(&self, from: Vec3A, mode: TransportMode, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        if from.z <= 0.0 {
            return None;
        }
        let fresnel = fresnel::dielectric(from.z.min(1.0), self.plastic.eta).reflectance;
        let probability = specular_probability(self.plastic.specular_weight, fresnel);
        if u_lobe < probability {
            let weight = self.specular * fresnel;
            Some(BsdfSample::delta_reflection(from, weight, probability))
        } else {
            self.density_sample(from, square_to_cosine_hemisphere(u), mode, 1.0)
        }
    }
}
