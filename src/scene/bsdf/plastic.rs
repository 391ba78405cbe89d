//! A diffuse body under a smooth dielectric coat, seen from the front, as Mitsuba 3's `plastic`.

use std::f32::consts::FRAC_1_PI;

use glam::{Vec2, Vec3A};

use super::{BsdfSample, Draw, Scattering, Texture, fresnel};
use crate::math::Rgb;
use crate::sampling::warp::{cosine_hemisphere_pdf, square_to_cosine_hemisphere};

/// The body under the coat, and how the coat sends light back into it.
#[derive(Clone, Debug)]
pub(super) struct Substrate {
    /// Its reflectance: index of a texture.
    pub reflectance: u32,
    /// Light that is reflected inside again takes on the colour of the body each time.
    pub nonlinear: bool,
    /// Share of the diffuse light inside that the coat reflects back.
    pub internal_reflectance: f32,
    /// Squared index of refraction of the outside over that of the coat.
    pub inv_eta2: f32,
}

impl Substrate {
    /// Reflectance after all reflections between body and coat, as a geometric series; to be
    /// multiplied by the coat's transmittance of both directions.
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

/// Weight of the specular lobe in the choice between lobes, from the means of both reflectances.
pub(super) fn specular_weight(textures: &[Texture], diffuse: u32, specular: u32) -> f32 {
    let mean = |texture: u32| textures[texture as usize].mean().element_sum();
    let (diffuse, specular) = (mean(diffuse), mean(specular));
    if diffuse + specular > 0.0 {
        specular / (diffuse + specular)
    } else {
        0.5
    }
}

/// Probability of the specular lobe where the coat reflects `reflectance`.
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

/// Parameters of [`super::Material::Plastic`], with what follows from them.
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

    /// The diffuse lobe: the other is a delta function.
    #[inline]
    pub(super) fn scattering(&self, diffuse: Rgb, to_light: Vec3A, to_camera: Vec3A) -> Scattering {
        if !(to_light.z > 0.0 && to_camera.z > 0.0) {
            return Scattering::ZERO;
        }
        let light = fresnel::dielectric(to_light.z.min(1.0), self.eta).reflectance;
        let camera = fresnel::dielectric(to_camera.z.min(1.0), self.eta).reflectance;
        let pdf = |reflectance: f32, direction: Vec3A| {
            (1.0 - specular_probability(self.specular_weight, reflectance))
                * cosine_hemisphere_pdf(direction.z)
        };
        Scattering {
            f: self.substrate.albedo(diffuse) * ((1.0 - light) * (1.0 - camera) * FRAC_1_PI),
            pdf_to_light: pdf(camera, to_light),
            pdf_to_camera: pdf(light, to_camera),
        }
    }

    /// Of the mirror or of the diffuse lobe; `None` from behind.
    #[inline]
    pub(super) fn sample(&self, specular: Rgb, from: Vec3A, lobe: f32, u: Vec2) -> Option<Draw> {
        if from.z <= 0.0 {
            return None;
        }
        let reflectance = fresnel::dielectric(from.z.min(1.0), self.eta).reflectance;
        let probability = specular_probability(self.specular_weight, reflectance);
        Some(if lobe < probability {
            let weight = specular * reflectance;
            Draw::Delta(BsdfSample::delta_reflection(from, weight, probability))
        } else {
            Draw::reflection(square_to_cosine_hemisphere(u))
        })
    }
}
