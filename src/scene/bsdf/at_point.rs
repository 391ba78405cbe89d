//! Materials at a point, as models.

use glam::{Vec2, Vec3A};

use super::ashikhmin_shirley::AshikhminShirleyBsdf;
use super::blend::BlendBsdf;
use super::conductor::ConductorBsdf;
use super::context::MaterialContext;
use super::dielectric::DielectricBsdf;
use super::diffuse::DiffuseBsdf;
use super::disney_sum::DisneySumBsdf;
use super::layered::LayeredBsdf;
use super::mask::MaskBsdf;
use super::material::Material;
use super::model::{Bsdf, BsdfEvaluation, BsdfSample, DeltaLobe, TransportMode};
use super::perturbed::{PerturbedBsdf, displaced_normal, mapped_normal};
use super::phong::PhongBsdf;
use super::plastic::PlasticBsdf;
use super::principled::PrincipledBsdf;
use super::principled_thin::PrincipledThinBsdf;
use super::rough_conductor::RoughConductorBsdf;
use super::rough_dielectric::{RoughDielectricBsdf, is_index_matched};
use super::rough_plastic::RoughPlasticBsdf;
use super::thin_dielectric::ThinDielectricBsdf;
use super::two_sided::TwoSidedBsdf;

/// A material at a point.
#[derive(Clone, Copy)]
struct MaterialAt<'a> {
    material: &'a Material,
    context: &'a MaterialContext<'a>,
}

impl<'a> MaterialAt<'a> {
    /// Another material at the same point.
    #[inline]
    fn of(self, material: &'a Material) -> Self {
        Self { material, ..self }
    }
}

/// Evaluates an expression with `$bsdf` bound to the model of `$at`, a [`MaterialAt`]. A macro, so that each
/// model is inlined into its arm.
macro_rules! at_point {
    ($at:expr, |$bsdf:ident| $result:expr) => {{
        let MaterialAt { material, context } = $at;
        let texture = |index: &u32| context.texture(*index);
        match material {
            Material::Diffuse { reflectance } => {
                let $bsdf = DiffuseBsdf {
                    reflectance: texture(reflectance),
                };
                $result
            }
            Material::Conductor {
                eta,
                k,
                specular_reflectance,
            } => {
                let $bsdf = ConductorBsdf {
                    eta: *eta,
                    k: *k,
                    specular_reflectance: texture(specular_reflectance),
                };
                $result
            }
            Material::RoughConductor {
                distribution,
                roughness,
                eta,
                k,
                specular_reflectance,
            } => {
                let $bsdf = RoughConductorBsdf {
                    microfacets: roughness.microfacets(*distribution, context),
                    eta: *eta,
                    k: *k,
                    specular_reflectance: texture(specular_reflectance),
                };
                $result
            }
            Material::AshikhminShirley {
                alpha,
                eta,
                k,
                specular_reflectance,
            } => {
                let $bsdf = AshikhminShirleyBsdf {
                    alpha: *alpha,
                    eta: *eta,
                    k: *k,
                    specular_reflectance: texture(specular_reflectance),
                };
                $result
            }
            Material::RoughDielectric {
                distribution,
                roughness,
                eta,
                specular_reflectance,
                specular_transmittance,
            } if !is_index_matched(*eta) => {
                let $bsdf = RoughDielectricBsdf {
                    microfacets: roughness.microfacets(*distribution, context),
                    eta: *eta,
                    specular_reflectance: texture(specular_reflectance),
                    specular_transmittance: texture(specular_transmittance),
                };
                $result
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
                    specular_reflectance: texture(specular_reflectance),
                    specular_transmittance: texture(specular_transmittance),
                };
                $result
            }
            Material::Plastic(plastic) => {
                let $bsdf = PlasticBsdf {
                    plastic,
                    diffuse: texture(&plastic.substrate.diffuse_reflectance),
                    specular: texture(&plastic.substrate.specular_reflectance),
                };
                $result
            }
            Material::RoughPlastic(plastic) => {
                let $bsdf = RoughPlasticBsdf {
                    plastic,
                    diffuse: texture(&plastic.substrate.diffuse_reflectance),
                    specular: texture(&plastic.substrate.specular_reflectance),
                };
                $result
            }
            Material::ThinDielectric {
                eta,
                specular_reflectance,
                specular_transmittance,
            } => {
                let $bsdf = ThinDielectricBsdf {
                    eta: *eta,
                    specular_reflectance: texture(specular_reflectance),
                    specular_transmittance: texture(specular_transmittance),
                };
                $result
            }
            Material::Phong {
                exponent,
                diffuse_reflectance,
                specular_reflectance,
            } => {
                let $bsdf = PhongBsdf {
                    exponent: *exponent,
                    diffuse: texture(diffuse_reflectance),
                    specular: texture(specular_reflectance),
                };
                $result
            }
            Material::Principled(principled) => {
                let $bsdf = LayeredBsdf(PrincipledBsdf::new(principled, context));
                $result
            }
            Material::PrincipledThin(principled) => {
                let $bsdf = PrincipledThinBsdf::new(principled, context);
                $result
            }
            Material::DisneySum(disney) => {
                let $bsdf = LayeredBsdf(DisneySumBsdf::new(disney, context));
                $result
            }
            Material::Mask { opacity, covered } => {
                let $bsdf = MaskBsdf {
                    opacity: texture(opacity).luminance().clamp(0.0, 1.0),
                    covered: $at.of(covered),
                };
                $result
            }
            Material::Blend {
                weight,
                first,
                second,
            } => {
                let $bsdf = BlendBsdf {
                    weight: texture(weight).luminance().clamp(0.0, 1.0),
                    first: $at.of(first),
                    second: $at.of(second),
                };
                $result
            }
            Material::NormalMap {
                normals,
                perturbation,
                base,
            } => {
                let tangent = context.tangent();
                let $bsdf = PerturbedBsdf {
                    perturbation: *perturbation,
                    normal: mapped_normal(texture(normals).color(), tangent),
                    tangent,
                    model: $at.of(base),
                };
                $result
            }
            Material::BumpMap {
                displacement,
                scale,
                perturbation,
                base,
            } => {
                let derivatives = context.partial_derivatives();
                let slope = *scale * texture(displacement).gradient();
                let $bsdf = PerturbedBsdf {
                    perturbation: *perturbation,
                    normal: displaced_normal(slope, derivatives, context.geometric_normal()),
                    tangent: context.tangent(),
                    model: $at.of(base),
                };
                $result
            }
            Material::TwoSided { front, back } => {
                let $bsdf = TwoSidedBsdf {
                    front: $at.of(front),
                    back: $at.of(back),
                };
                $result
            }
        }
    }};
}

impl Bsdf for MaterialAt<'_> {
    #[inline]
    fn evaluate(&self, to_light: Vec3A, to_camera: Vec3A) -> BsdfEvaluation {
        at_point!(*self, |bsdf| bsdf.evaluate(to_light, to_camera))
    }

    #[inline]
    fn sample(&self, from: Vec3A, mode: TransportMode, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        at_point!(*self, |bsdf| bsdf.sample(from, mode, u_lobe, u))
    }

    #[inline]
    fn sample_delta(
        &self,
        from: Vec3A,
        mode: TransportMode,
        lobe: DeltaLobe,
    ) -> Option<BsdfSample> {
        at_point!(*self, |bsdf| bsdf.sample_delta(from, mode, lobe))
    }
}

impl Material {
    /// The scattering function and both densities; zero where the two directions cannot scatter
    /// into each other.
    #[inline]
    pub fn evaluate(
        &self,
        context: &MaterialContext,
        to_light: Vec3A,
        to_camera: Vec3A,
    ) -> BsdfEvaluation {
        self.at(context).evaluate(to_light, to_camera)
    }

    /// Samples the direction in which a subpath that came from `from` continues; `None` where it
    /// ends. `u_lobe` chooses the lobe, `u` the direction.
    #[inline]
    pub fn sample(
        &self,
        context: &MaterialContext,
        from: Vec3A,
        mode: TransportMode,
        u_lobe: f32,
        u: Vec2,
    ) -> Option<BsdfSample> {
        self.at(context).sample(from, mode, u_lobe, u)
    }

    /// The sample of a delta lobe; `None` if the material has no such lobe or its probability is 0, or if
    /// it is not a caster ([`Self::is_caster`]).
    #[inline]
    pub fn sample_delta(
        &self,
        context: &MaterialContext,
        from: Vec3A,
        mode: TransportMode,
        lobe: DeltaLobe,
    ) -> Option<BsdfSample> {
        self.at(context).sample_delta(from, mode, lobe)
    }

    #[inline]
    fn at<'a>(&'a self, context: &'a MaterialContext<'a>) -> MaterialAt<'a> {
        MaterialAt {
            material: self,
            context,
        }
    }
}
