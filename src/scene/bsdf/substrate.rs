//! A diffuse substrate under a dielectric coat: what smooth and rough plastic have in common.

use crate::math::Rgb;
use crate::scene::texture::Texture;

/// The parameters of the substrate and the coat.
#[derive(Clone, Debug)]
pub(super) struct Substrate {
    /// Index of refraction of the coat over that of the outside.
    pub eta: f32,
    /// 1 / eta^2.
    inv_eta2: f32,
    /// Whether light that the coat reflects back is coloured by the substrate again each time.
    nonlinear: bool,
    /// Reflectance of the substrate, the index of a texture.
    pub diffuse_reflectance: u32,
    /// Factor on reflection by the coat, the index of a texture.
    pub specular_reflectance: u32,
    /// Weight of the specular lobe for choosing a lobe, from the means of both reflectances.
    specular_weight: f32,
}

impl Substrate {
    pub fn new(
        eta: f32,
        nonlinear: bool,
        diffuse_reflectance: u32,
        specular_reflectance: u32,
        textures: &[Texture],
    ) -> Self {
        let mean = |texture: u32| textures[texture as usize].mean().element_sum();
        let (diffuse, specular) = (mean(diffuse_reflectance), mean(specular_reflectance));
        let specular_weight = if diffuse + specular > 0.0 {
            specular / (diffuse + specular)
        } else {
            0.5
        };
        Self {
            eta,
            inv_eta2: (eta * eta).recip(),
            nonlinear,
            diffuse_reflectance,
            specular_reflectance,
            specular_weight,
        }
    }

    /// Reflectance after all reflections between substrate and coat, a geometric series, without the
    /// transmittances of the coat in both directions. `diffuse` is the reflectance of the substrate,
    /// `internal_reflectance` the fraction of diffuse light inside that the coat reflects back.
    #[inline]
    pub fn albedo(&self, diffuse: Rgb, internal_reflectance: f32) -> Rgb {
        let again = if self.nonlinear {
            diffuse * internal_reflectance
        } else {
            Rgb::splat(internal_reflectance)
        };
        diffuse * self.inv_eta2 / (Rgb::ONE - again)
    }

    /// Probability of choosing the specular lobe where the coat has reflectance `reflectance`.
    #[inline]
    pub fn specular_probability(&self, reflectance: f32) -> f32 {
        let specular = reflectance * self.specular_weight;
        let diffuse = (1.0 - reflectance) * (1.0 - self.specular_weight);
        if specular > 0.0 {
            specular / (specular + diffuse)
        } else {
            0.0
        }
    }
}
