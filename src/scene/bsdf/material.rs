//! The materials of a scene.

use super::disney_sum::{DisneyLobes, DisneySum};
use super::microfacet::{MicrofacetDistribution, Microfacets};
use super::perturbed::NormalPerturbation;
use super::plastic::Plastic;
use super::principled::Principled;
use super::principled_thin::PrincipledThin;
use super::rough_dielectric::is_index_matched;
use super::rough_plastic::RoughPlastic;
use super::roughness::Roughness;
use super::substrate::Substrate;
use crate::math::Rgb;
use crate::scene::texture::Texture;

/// The material of a surface, named and parameterised as in Mitsuba 3. Reflectances are
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
        /// Microfacet distribution.
        distribution: MicrofacetDistribution,
        /// Roughness.
        roughness: Roughness,
        /// As for `Conductor`.
        eta: Rgb,
        /// As for `Conductor`.
        k: Rgb,
        /// Factor on reflection.
        specular_reflectance: u32,
    },
    /// Rough metal whose microfacet normals follow a power of the cosine.
    AshikhminShirley {
        /// Roughness of the Beckmann distribution of the same width, from 1e-4 to 1.
        alpha: f32,
        /// As for `Conductor`.
        eta: Rgb,
        /// As for `Conductor`.
        k: Rgb,
        /// As for `Conductor`.
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
        /// Microfacet distribution.
        distribution: MicrofacetDistribution,
        /// Roughness.
        roughness: Roughness,
        /// Inside over outside.
        eta: f32,
        /// Factor on reflection.
        specular_reflectance: u32,
        /// Factor on transmission.
        specular_transmittance: u32,
    },
    /// Diffuse substrate under a smooth dielectric coat; constructed by [`Material::plastic`].
    Plastic(Plastic),
    /// Diffuse substrate under a rough dielectric coat; constructed by [`Material::rough_plastic`].
    RoughPlastic(RoughPlastic),
    /// Thin pane of a transparent medium.
    ThinDielectric {
        /// Pane over its surroundings.
        eta: f32,
        /// Factor on reflection.
        specular_reflectance: u32,
        /// Factor on transmission.
        specular_transmittance: u32,
    },
    /// Modified Phong reflection.
    Phong {
        /// Exponent of the cosine.
        exponent: f32,
        /// Albedo of the diffuse lobe.
        diffuse_reflectance: u32,
        /// Albedo of the specular lobe at normal incidence.
        specular_reflectance: u32,
    },
    /// Disney's model of solid surfaces.
    Principled(Principled),
    /// Disney's model of thin surfaces.
    PrincipledThin(PrincipledThin),
    /// Disney's model as lajolla has it, or one of its lobes.
    DisneySum(DisneySum),
    /// A material that covers a fraction of the surface; light passes elsewhere.
    Mask {
        /// The fraction, the luminance of a texture.
        opacity: u32,
        /// What covers it.
        covered: Box<Material>,
    },
    /// A weighted sum of two materials.
    Blend {
        /// Weight of the second, the luminance of a texture from 0 to 1; that of the first is the rest.
        weight: u32,
        /// The first.
        first: Box<Material>,
        /// The second.
        second: Box<Material>,
    },
    /// A material whose normals a texture gives: 2 color - 1 is the normal along dp/du, across it, and along the
    /// shading normal.
    NormalMap {
        /// The texture.
        normals: u32,
        /// How the normals are used.
        perturbation: NormalPerturbation,
        /// Seen with these normals; without a normal or bump map of its own.
        base: Box<Material>,
    },
    /// A material on a surface displaced along its normal.
    BumpMap {
        /// The displacement is the luminance of this texture times `scale`.
        displacement: u32,
        /// In scene units.
        scale: f32,
        /// How the normals are used.
        perturbation: NormalPerturbation,
        /// Seen with the normals of the displaced surface; without a normal or bump map of its own.
        base: Box<Material>,
    },
    /// One material on the front and one on the back, neither of which transmits light.
    TwoSided {
        /// Seen from the side of the normal.
        front: Box<Material>,
        /// Seen from the other side.
        back: Box<Material>,
    },
}

impl Material {
    /// Its name in scene files.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Diffuse { .. } => "diffuse",
            Self::Conductor { .. } => "conductor",
            Self::RoughConductor { .. } | Self::AshikhminShirley { .. } => "roughconductor",
            Self::Dielectric { .. } => "dielectric",
            Self::RoughDielectric { .. } => "roughdielectric",
            Self::Plastic(_) => "plastic",
            Self::RoughPlastic(_) => "roughplastic",
            Self::ThinDielectric { .. } => "thindielectric",
            Self::Phong { .. } => "phong",
            Self::Principled(_) => "principled",
            Self::PrincipledThin(_) => "principledthin",
            Self::DisneySum(disney) => match disney.lobes {
                DisneyLobes::All => "disneybsdf",
                DisneyLobes::Diffuse => "disneydiffuse",
                DisneyLobes::Sheen => "disneysheen",
                DisneyLobes::Clearcoat => "disneyclearcoat",
            },
            Self::Mask { .. } => "mask",
            Self::Blend { .. } => "blendbsdf",
            Self::NormalMap { .. } => "normalmap",
            Self::BumpMap { .. } => "bumpmap",
            Self::TwoSided { .. } => "twosided",
        }
    }

    /// Smooth plastic: `eta` is inside over outside; with `nonlinear`, light that the coat reflects back
    /// is coloured by the substrate again each time; the reflectances are indices into `textures`.
    pub fn plastic(
        eta: f32,
        nonlinear: bool,
        diffuse_reflectance: u32,
        specular_reflectance: u32,
        textures: &[Texture],
    ) -> Self {
        Material::Plastic(Plastic::new(Substrate::new(
            eta,
            nonlinear,
            diffuse_reflectance,
            specular_reflectance,
            textures,
        )))
    }

    /// Rough plastic, with roughness `alpha`; the rest as for [`Material::plastic`].
    pub fn rough_plastic(
        distribution: MicrofacetDistribution,
        alpha: f32,
        eta: f32,
        nonlinear: bool,
        diffuse_reflectance: u32,
        specular_reflectance: u32,
        textures: &[Texture],
    ) -> Self {
        let substrate = Substrate::new(
            eta,
            nonlinear,
            diffuse_reflectance,
            specular_reflectance,
            textures,
        );
        Material::RoughPlastic(RoughPlastic::new(
            Microfacets::isotropic(distribution, alpha),
            substrate,
        ))
    }

    /// Index of refraction of the inside over that of the outside, if the material refracts without roughness.
    pub fn smooth_refraction(&self) -> Option<f32> {
        match self {
            Material::RoughDielectric { eta, .. } if !is_index_matched(*eta) => None,
            Material::Dielectric { eta, .. } | Material::RoughDielectric { eta, .. } => Some(*eta),
            _ => None,
        }
    }

    /// True if some lobe is not a delta function, so that explicit connections can carry light.
    pub fn is_connectible(&self) -> bool {
        match self {
            Material::Diffuse { .. }
            | Material::RoughConductor { .. }
            | Material::AshikhminShirley { .. }
            | Material::Plastic(_)
            | Material::RoughPlastic(_)
            | Material::Phong { .. }
            | Material::Principled(_)
            | Material::PrincipledThin(_)
            | Material::DisneySum(_) => true,
            Material::RoughDielectric { eta, .. } => !is_index_matched(*eta),
            Material::Conductor { .. }
            | Material::Dielectric { .. }
            | Material::ThinDielectric { .. } => false,
            Material::Mask { covered: base, .. }
            | Material::NormalMap { base, .. }
            | Material::BumpMap { base, .. } => base.is_connectible(),
            Material::Blend { first, second, .. }
            | Material::TwoSided {
                front: first,
                back: second,
            } => first.is_connectible() || second.is_connectible(),
        }
    }

    /// True if chains of delta vertices on the surface may be sought: its delta lobes are reflection in the shading
    /// normal, and refraction of the index [`Self::smooth_refraction`]. [`Self::sample_delta`] has the
    /// lobes of such a material, and no others. Light that passes a mask or a thin pane, and lobes of
    /// perturbed normals and of blends, belong to no chain.
    pub fn is_caster(&self) -> bool {
        match self {
            Material::Conductor { .. } | Material::Dielectric { .. } | Material::Plastic(_) => true,
            Material::RoughDielectric { eta, .. } => is_index_matched(*eta),
            Material::TwoSided { front, back } => front.is_caster() || back.is_caster(),
            _ => false,
        }
    }

    /// True if light may pass to the other side.
    pub fn transmits(&self) -> bool {
        match self {
            Material::Dielectric { .. }
            | Material::RoughDielectric { .. }
            | Material::ThinDielectric { .. }
            | Material::PrincipledThin(_)
            | Material::Mask { .. } => true,
            Material::Principled(principled) => principled.transmits,
            Material::DisneySum(disney) => disney.transmits,
            Material::NormalMap { base, .. } | Material::BumpMap { base, .. } => base.transmits(),
            Material::Blend { first, second, .. } => first.transmits() || second.transmits(),
            Material::TwoSided { front, back } => front.transmits() || back.transmits(),
            Material::Diffuse { .. }
            | Material::Conductor { .. }
            | Material::RoughConductor { .. }
            | Material::AshikhminShirley { .. }
            | Material::Plastic(_)
            | Material::RoughPlastic(_)
            | Material::Phong { .. } => false,
        }
    }

    /// True if some light passes straight through the material, beside light that it scatters.
    pub fn has_openings(&self) -> bool {
        match self {
            Material::Mask { .. } => true,
            Material::NormalMap { base, .. } | Material::BumpMap { base, .. } => {
                base.has_openings()
            }
            Material::Blend { first, second, .. } => first.has_openings() || second.has_openings(),
            _ => false,
        }
    }

    /// True if a texture perturbs the normals of the material or of one that it contains.
    pub fn perturbs_normals(&self) -> bool {
        match self {
            Material::NormalMap { .. } | Material::BumpMap { .. } => true,
            Material::Mask { covered, .. } => covered.perturbs_normals(),
            Material::Blend { first, second, .. }
            | Material::TwoSided {
                front: first,
                back: second,
            } => first.perturbs_normals() || second.perturbs_normals(),
            _ => false,
        }
    }

    /// Multiplies the lengths that the material depends on by `factor`.
    pub(in crate::scene) fn scale_lengths(&mut self, factor: f32) {
        match self {
            Material::BumpMap { scale, .. } => *scale *= factor,
            Material::Mask { covered, .. } => covered.scale_lengths(factor),
            Material::Blend { first, second, .. }
            | Material::TwoSided {
                front: first,
                back: second,
            } => {
                first.scale_lengths(factor);
                second.scale_lengths(factor);
            }
            _ => {}
        }
    }
}
