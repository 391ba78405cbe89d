//! How surfaces scatter light. All directions are unit vectors in the local shading frame (+z is
//! the shading normal) that point away from the surface.

mod conductor;
mod dielectric;
mod diffuse;
mod fresnel;
pub mod ior;
pub mod metals;
mod microfacet;
mod plastic;
mod rough_dielectric;
mod rough_plastic;
mod scattering;
#[cfg(test)]
mod tests;

use glam::{Vec2, Vec3A};

use self::conductor::sample_rough_reflection;
use self::microfacet::Microfacets;
pub use self::plastic::Plastic;
use self::rough_dielectric::{RoughInterface, is_index_matched};
pub use self::rough_plastic::RoughPlastic;
pub use self::scattering::{BsdfSample, Scattering, TransportMode};
use self::scattering::{Draw, turned};
use super::Texture;
use crate::math::Rgb;

/// The form of the normal distribution of a rough surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Distribution {
    /// Beckmann and Spizzichino 1963.
    Beckmann,
    /// Trowbridge and Reitz 1975, as GGX in Walter et al. 2007.
    Ggx,
}

/// A closed set of surface materials, named and parameterised as in Mitsuba 3. Reflectances are
/// indices of textures; eta is the index of refraction inside over outside.
#[derive(Clone, Debug)]
pub enum Material {
    /// Lambertian reflection.
    Diffuse {
        /// Albedo.
        reflectance: u32,
    },
    /// Smooth metal.
    Conductor {
        /// Real part of the index of refraction over that of the outside.
        eta: Rgb,
        /// Imaginary part.
        k: Rgb,
        /// Factor on reflection.
        specular_reflectance: u32,
    },
    /// Rough metal.
    RoughConductor {
        /// Normal distribution.
        distribution: Distribution,
        /// Roughness.
        alpha: f32,
        /// As for `Conductor`.
        eta: Rgb,
        /// As for `Conductor`.
        k: Rgb,
        /// Factor on reflection.
        specular_reflectance: u32,
    },
    /// Smooth interface between two transparent media.
    Dielectric {
        /// Inside over outside.
        eta: f32,
        /// Factor on reflection.
        specular_reflectance: u32,
        /// Factor on transmission.
        specular_transmittance: u32,
    },
    /// Rough interface between two transparent media.
    RoughDielectric {
        /// Normal distribution.
        distribution: Distribution,
        /// Roughness.
        alpha: f32,
        /// Inside over outside.
        eta: f32,
        /// Factor on reflection.
        specular_reflectance: u32,
        /// Factor on transmission.
        specular_transmittance: u32,
    },
    /// Diffuse body under a smooth dielectric coat; made by [`Material::plastic`].
    Plastic(Plastic),
    /// Diffuse body under a rough dielectric coat; made by [`Material::rough_plastic`].
    RoughPlastic(RoughPlastic),
    /// One material on the front, one on the back; neither may transmit.
    TwoSided {
        /// Seen from the side of the normal.
        front: Box<Material>,
        /// Seen from behind.
        back: Box<Material>,
    },
}

impl Material {
    /// What scene files call it.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Diffuse { .. } => "diffuse",
            Self::Conductor { .. } => "conductor",
            Self::RoughConductor { .. } => "roughconductor",
            Self::Dielectric { .. } => "dielectric",
            Self::RoughDielectric { .. } => "roughdielectric",
            Self::Plastic(_) => "plastic",
            Self::RoughPlastic(_) => "roughplastic",
            Self::TwoSided { .. } => "twosided",
        }
    }

    /// Smooth plastic: `eta` inside over outside; `nonlinear` lets light that is reflected inside
    /// again take on colour each time; the reflectances are indices into `textures`.
    pub fn plastic(
        eta: f32,
        nonlinear: bool,
        diffuse_reflectance: u32,
        specular_reflectance: u32,
        textures: &[Texture],
    ) -> Self {
        Material::Plastic(Plastic::new(
            eta,
            nonlinear,
            diffuse_reflectance,
            specular_reflectance,
            textures,
        ))
    }

    /// Rough plastic, with roughness `alpha`; the rest as for [`Material::plastic`].
    pub fn rough_plastic(
        distribution: Distribution,
        alpha: f32,
        eta: f32,
        nonlinear: bool,
        diffuse_reflectance: u32,
        specular_reflectance: u32,
        textures: &[Texture],
    ) -> Self {
        Material::RoughPlastic(RoughPlastic::new(
            Microfacets::new(distribution, alpha),
            eta,
            nonlinear,
            diffuse_reflectance,
            specular_reflectance,
            textures,
        ))
    }

    /// The scattering function and both densities; zero where the two directions cannot scatter
    /// into each other.
    #[inline]
    pub fn scattering(
        &self,
        textures: &[Texture],
        uv: Vec2,
        to_light: Vec3A,
        to_camera: Vec3A,
    ) -> Scattering {
        let color = |texture: u32| textures[texture as usize].evaluate(uv);
        match self {
            Material::Diffuse { reflectance } => {
                diffuse::scattering(color(*reflectance), to_light, to_camera)
            }
            Material::Conductor { .. } | Material::Dielectric { .. } => Scattering::ZERO,
            Material::RoughConductor {
                distribution,
                alpha,
                eta,
                k,
                specular_reflectance,
            } => {
                let reflectance = color(*specular_reflectance);
                let microfacets = Microfacets::new(*distribution, *alpha);
                conductor::scattering(microfacets, *eta, *k, reflectance, to_light, to_camera)
            }
            Material::RoughDielectric { eta, .. } if is_index_matched(*eta) => Scattering::ZERO,
            Material::RoughDielectric {
                distribution,
                alpha,
                eta,
                specular_reflectance,
                specular_transmittance,
            } => {
                let surface = RoughInterface {
                    microfacets: Microfacets::new(*distribution, *alpha),
                    eta: *eta,
                    specular_reflectance: color(*specular_reflectance),
                    specular_transmittance: color(*specular_transmittance),
                };
                surface.scattering(to_light, to_camera)
            }
            Material::Plastic(plastic) => {
                let diffuse = color(plastic.substrate.reflectance);
                plastic.scattering(diffuse, to_light, to_camera)
            }
            Material::RoughPlastic(plastic) => {
                let diffuse = color(plastic.substrate.reflectance);
                let specular = color(plastic.specular_reflectance);
                plastic.scattering(diffuse, specular, to_light, to_camera)
            }
            Material::TwoSided { front, back } => {
                if to_camera.z > 0.0 {
                    front.scattering(textures, uv, to_light, to_camera)
                } else {
                    back.scattering(textures, uv, turned(to_light), turned(to_camera))
                }
            }
        }
    }

    /// Samples where a subpath that came from `from` goes on; `None` where it ends. `lobe` chooses
    /// the lobe, `u` the direction.
    #[inline]
    pub fn sample(
        &self,
        textures: &[Texture],
        uv: Vec2,
        from: Vec3A,
        mode: TransportMode,
        lobe: f32,
        u: Vec2,
    ) -> Option<BsdfSample> {
        match self.draw(textures, uv, from, mode, lobe, u)? {
            Draw::Delta(sample) => Some(sample),
            Draw::Density { direction, eta } => {
                let (to_light, to_camera) = match mode {
                    TransportMode::Radiance => (direction, from),
                    TransportMode::Importance => (from, direction),
                };
                self.scattering(textures, uv, to_light, to_camera)
                    .sampled(direction, mode, eta)
            }
        }
    }

    /// True if some lobe is not a delta function, so that explicit connections can carry light.
    pub fn is_connectible(&self) -> bool {
        match self {
            Material::Diffuse { .. }
            | Material::RoughConductor { .. }
            | Material::Plastic(_)
            | Material::RoughPlastic(_) => true,
            Material::Conductor { .. } | Material::Dielectric { .. } => false,
            Material::RoughDielectric { eta, .. } => !is_index_matched(*eta),
            Material::TwoSided { front, back } => front.is_connectible() || back.is_connectible(),
        }
    }

    /// True if some lobe is a delta function.
    pub fn has_delta_lobe(&self) -> bool {
        match self {
            Material::Conductor { .. } | Material::Dielectric { .. } | Material::Plastic(_) => true,
            Material::Diffuse { .. }
            | Material::RoughConductor { .. }
            | Material::RoughPlastic(_) => false,
            Material::RoughDielectric { eta, .. } => is_index_matched(*eta),
            Material::TwoSided { front, back } => front.has_delta_lobe() || back.has_delta_lobe(),
        }
    }

    /// Chooses a lobe and draws from it.
    #[inline]
    fn draw(
        &self,
        textures: &[Texture],
        uv: Vec2,
        from: Vec3A,
        mode: TransportMode,
        lobe: f32,
        u: Vec2,
    ) -> Option<Draw> {
        let color = |texture: u32| textures[texture as usize].evaluate(uv);
        match self {
            Material::Diffuse { .. } => diffuse::sample(from, u).map(Draw::reflection),
            Material::Conductor {
                eta,
                k,
                specular_reflectance,
            } => {
                let reflectance = color(*specular_reflectance);
                conductor::sample(*eta, *k, reflectance, from).map(Draw::Delta)
            }
            Material::RoughConductor {
                distribution,
                alpha,
                ..
            } => {
                let microfacets = Microfacets::new(*distribution, *alpha);
                sample_rough_reflection(microfacets, from, u).map(Draw::reflection)
            }
            Material::RoughDielectric {
                distribution,
                alpha,
                eta,
                ..
            } if !is_index_matched(*eta) => {
                let microfacets = Microfacets::new(*distribution, *alpha);
                rough_dielectric::sample(microfacets, *eta, from, lobe, u)
            }
            Material::Dielectric {
                eta,
                specular_reflectance,
                specular_transmittance,
            }
            | Material::RoughDielectric {
                eta,
                specular_reflectance,
                specular_transmittance,
                ..
            } => {
                let reflectance = color(*specular_reflectance);
                let transmittance = color(*specular_transmittance);
                dielectric::sample(*eta, reflectance, transmittance, from, mode, lobe)
                    .map(Draw::Delta)
            }
            Material::Plastic(plastic) => {
                plastic.sample(color(plastic.specular_reflectance), from, lobe, u)
            }
            Material::RoughPlastic(plastic) => plastic.sample(from, lobe, u).map(Draw::reflection),
            Material::TwoSided { front, back } => {
                if from.z > 0.0 {
                    front.draw(textures, uv, from, mode, lobe, u)
                } else {
                    back.draw(textures, uv, turned(from), mode, lobe, u)
                        .map(Draw::turned)
                }
            }
        }
    }
}
