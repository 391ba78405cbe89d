//! The materials of a scene.

use glam::{Vec2, Vec3A};

use super::conductor::ConductorBsdf;
use super::dielectric::DielectricBsdf;
use super::diffuse::DiffuseBsdf;
use super::microfacet::{MicrofacetDistribution, Microfacets};
use super::model::{Bsdf, BsdfEvaluation, BsdfSample, DeltaLobe, Flags, TransportMode};
use super::plastic::{Plastic, PlasticBsdf};
use super::rough_conductor::RoughConductorBsdf;
use super::rough_dielectric::{RoughDielectricBsdf, is_index_matched};
use super::rough_plastic::{RoughPlastic, RoughPlasticBsdf};
use super::substrate::Substrate;
use crate::math::Rgb;
use crate::scene::texture::{Texture, TextureAt};

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
        /// Microfacet distribution.
        distribution: MicrofacetDistribution,
        /// Roughness.
        alpha: f32,
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
    /// One material on the front and one on the back, neither of which transmits light.
    TwoSided {
        /// Seen from the side of the normal.
        front: Box<Material>,
        /// Seen from the other side.
        back: Box<Material>,
    },
}

/// Evaluates the first expression with `$bsdf` bound to the model of a material at a point, where `$at`
/// binds textures to the point; of a two-sided material, the second one with `$front` and `$back` bound to its
/// sides. A macro, so that each model is inlined into its arm.
macro_rules! at_point {
    ($material:expr, $at:ident, |$bsdf:ident| $one:expr, |$front:ident, $back:ident| $two:expr) => {
        match $material {
            Material::Diffuse { reflectance } => {
                let $bsdf = DiffuseBsdf {
                    reflectance: $at(reflectance),
                };
                $one
            }
            Material::Conductor {
                eta,
                k,
                specular_reflectance,
            } => {
                let $bsdf = ConductorBsdf {
                    eta: *eta,
                    k: *k,
                    specular_reflectance: $at(specular_reflectance),
                };
                $one
            }
            Material::RoughConductor {
                distribution,
                alpha,
                eta,
                k,
                specular_reflectance,
            } => {
                let $bsdf = RoughConductorBsdf {
                    microfacets: Microfacets::new(*distribution, *alpha),
                    eta: *eta,
                    k: *k,
                    specular_reflectance: $at(specular_reflectance),
                };
                $one
            }
            Material::RoughDielectric {
                distribution,
                alpha,
                eta,
                specular_reflectance,
                specular_transmittance,
            } if !is_index_matched(*eta) => {
                let $bsdf = RoughDielectricBsdf {
                    microfacets: Microfacets::new(*distribution, *alpha),
                    eta: *eta,
                    specular_reflectance: $at(specular_reflectance),
                    specular_transmittance: $at(specular_transmittance),
                };
                $one
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
                let $bsdf = DielectricBsdf {
                    eta: *eta,
                    specular_reflectance: $at(specular_reflectance),
                    specular_transmittance: $at(specular_transmittance),
                };
                $one
            }
            Material::Plastic(plastic) => {
                let $bsdf = PlasticBsdf {
                    plastic,
                    diffuse: $at(&plastic.substrate.diffuse_reflectance),
                    specular: $at(&plastic.substrate.specular_reflectance),
                };
                $one
            }
            Material::RoughPlastic(plastic) => {
                let $bsdf = RoughPlasticBsdf {
                    plastic,
                    diffuse: $at(&plastic.substrate.diffuse_reflectance),
                    specular: $at(&plastic.substrate.specular_reflectance),
                };
                $one
            }
            Material::TwoSided {
                front: $front,
                back: $back,
            } => $two,
        }
    };
}

impl Material {
    /// Its name in scene files.
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
            Microfacets::new(distribution, alpha),
            substrate,
        ))
    }

    /// The scattering function and both densities; zero where the two directions cannot scatter
    /// into each other.
    #[inline]
    pub fn evaluate(
        &self,
        textures: &[Texture],
        uv: Vec2,
        to_light: Vec3A,
        to_camera: Vec3A,
    ) -> BsdfEvaluation {
        let at = |texture: &u32| TextureAt {
            texture: &textures[*texture as usize],
            uv,
        };
        at_point!(
            self,
            at,
            |bsdf| bsdf.evaluate(to_light, to_camera),
            |front, back| {
                if to_camera.z > 0.0 {
                    front.evaluate(textures, uv, to_light, to_camera)
                } else {
                    back.evaluate(textures, uv, flipped(to_light), flipped(to_camera))
                }
            }
        )
    }

    /// Samples the direction in which a subpath that came from `from` continues; `None` where it
    /// ends. `u_lobe` chooses the lobe, `u` the direction.
    #[inline]
    pub fn sample(
        &self,
        textures: &[Texture],
        uv: Vec2,
        from: Vec3A,
        mode: TransportMode,
        u_lobe: f32,
        u: Vec2,
    ) -> Option<BsdfSample> {
        let at = |texture: &u32| TextureAt {
            texture: &textures[*texture as usize],
            uv,
        };
        at_point!(
            self,
            at,
            |bsdf| bsdf.sample(from, mode, u_lobe, u),
            |front, back| {
                if from.z > 0.0 {
                    front.sample(textures, uv, from, mode, u_lobe, u)
                } else {
                    let sample = back.sample(textures, uv, flipped(from), mode, u_lobe, u)?;
                    Some(BsdfSample {
                        direction: flipped(sample.direction),
                        ..sample
                    })
                }
            }
        )
    }

    /// The sample of a delta lobe; `None` if the material has no such lobe or its probability is 0.
    #[inline]
    pub fn sample_delta(
        &self,
        textures: &[Texture],
        uv: Vec2,
        from: Vec3A,
        mode: TransportMode,
        lobe: DeltaLobe,
    ) -> Option<BsdfSample> {
        let at = |texture: &u32| TextureAt {
            texture: &textures[*texture as usize],
            uv,
        };
        at_point!(
            self,
            at,
            |bsdf| bsdf.sample_delta(from, mode, lobe),
            |front, back| {
                if from.z > 0.0 {
                    front.sample_delta(textures, uv, from, mode, lobe)
                } else {
                    let sample = back.sample_delta(textures, uv, flipped(from), mode, lobe)?;
                    Some(BsdfSample {
                        direction: flipped(sample.direction),
                        ..sample
                    })
                }
            }
        )
    }

    /// Index of refraction of the inside over that of the outside, if the material refracts without roughness.
    pub fn smooth_refraction(&self) -> Option<f32> {
        match self {
            Material::RoughDielectric { eta, .. } if !is_index_matched(*eta) => None,
            Material::Dielectric { eta, .. } | Material::RoughDielectric { eta, .. } => Some(*eta),
            Material::Diffuse { .. }
            | Material::Conductor { .. }
            | Material::RoughConductor { .. }
            | Material::Plastic(_)
            | Material::RoughPlastic(_)
            | Material::TwoSided { .. } => None,
        }
    }

    /// True if some lobe is not a delta function, so that explicit connections can carry light.
    pub fn is_connectible(&self) -> bool {
        self.flags().connectible
    }

    /// True if some lobe is a delta function.
    pub fn has_delta_lobe(&self) -> bool {
        self.flags().delta
    }

    fn flags(&self) -> Flags {
        match self {
            Material::Diffuse { .. } => DiffuseBsdf::FLAGS,
            Material::Conductor { .. } => ConductorBsdf::FLAGS,
            Material::RoughConductor { .. } => RoughConductorBsdf::FLAGS,
            Material::RoughDielectric { eta, .. } if !is_index_matched(*eta) => {
                RoughDielectricBsdf::FLAGS
            }
            Material::Dielectric { .. } | Material::RoughDielectric { .. } => DielectricBsdf::FLAGS,
            Material::Plastic(_) => PlasticBsdf::FLAGS,
            Material::RoughPlastic(_) => RoughPlasticBsdf::FLAGS,
            Material::TwoSided { front, back } => front.flags().union(back.flags()),
        }
    }
}

/// `v` seen with the surface flipped.
#[inline]
fn flipped(v: Vec3A) -> Vec3A {
    Vec3A::new(v.x, v.y, -v.z)
}
