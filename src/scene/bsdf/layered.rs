//! Sampling of Disney's solid models: a base with a density of its own, a clearcoat, and microfacets that reflect and
//! refract.

use glam::{Vec2, Vec3A};

use super::disney::ClearcoatMicrofacets;
use super::facet::{Facet, VisibleFacet};
use super::microfacet::Microfacets;
use super::model::{Bsdf, BsdfEvaluation, BsdfSample, TransportMode};
use crate::math::Rgb;
use crate::sampling::warp::square_to_cosine_hemisphere;

/// What distinguishes one such model from another.
pub(super) trait Layers {
    /// The microfacets, and the index of refraction inside over outside.
    fn microfacets(&self) -> (&Microfacets, f32);

    fn clearcoat_microfacets(&self) -> &ClearcoatMicrofacets;

    /// The base and the clearcoat, with the densities of sampling them. Both directions are in front.
    fn evaluate_layers(&self, to_light: Vec3A, to_camera: Vec3A) -> BsdfEvaluation;

    /// Probabilities of sampling the base and the clearcoat from the front.
    fn layer_choices(&self) -> [f32; 2];

    /// Probabilities of reflection and of transmission by a microfacet of Fresnel reflectance `reflectance`, from the
    /// front.
    fn front_choices(&self, reflectance: f32) -> (f32, f32);

    /// Whether light is scattered inside: by the microfacets, and by nothing else.
    fn transmits(&self) -> bool;

    /// Reflectance or transmittance of a microfacet.
    fn facet_color(&self, facet: &Facet, in_front: bool) -> Rgb;
}

/// A model of layers as a scattering model.
pub(super) struct LayeredBsdf<L>(pub L);

impl<L: Layers> LayeredBsdf<L> {
    /// As [`Layers::front_choices`], for a direction in front or inside.
    #[inline]
    fn facet_choices(&self, reflectance: f32, in_front: bool) -> (f32, f32) {
        if in_front {
            self.0.front_choices(reflectance)
        } else if self.0.transmits() {
            (reflectance, 1.0 - reflectance)
        } else {
            (0.0, 0.0)
        }
    }
}

impl<L: Layers> Bsdf for LayeredBsdf<L> {
    fn evaluate(&self, to_light: Vec3A, to_camera: Vec3A) -> BsdfEvaluation {
        if to_light.z == 0.0 || to_camera.z == 0.0 {
            return BsdfEvaluation::ZERO;
        }
        let (light_in_front, in_front) = (to_light.z > 0.0, to_camera.z > 0.0);
        let layers = if light_in_front && in_front {
            self.0.evaluate_layers(to_light, to_camera)
        } else {
            BsdfEvaluation::ZERO
        };
        let (microfacets, eta) = self.0.microfacets();
        let Some(facet) = Facet::between(microfacets, eta, to_light, to_camera) else {
            return layers;
        };
        let probability = |from_front: bool| {
            let (reflection, transmission) = self.facet_choices(facet.reflectance, from_front);
            if facet.reflects {
                reflection
            } else {
                transmission
            }
        };
        layers
            + BsdfEvaluation {
                f: facet.lobe * self.0.facet_color(&facet, in_front),
                pdf_to_light: facet.pdf_to_light * probability(in_front),
                pdf_to_camera: facet.pdf_to_camera * probability(light_in_front),
            }
    }

    fn sample(&self, from: Vec3A, mode: TransportMode, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        if from.z == 0.0 {
            return None;
        }
        let in_front = from.z > 0.0;
        let mut u_lobe = u_lobe;
        if in_front {
            let [base, clearcoat] = self.0.layer_choices();
            if u_lobe < base {
                return self.density_sample(from, square_to_cosine_hemisphere(u), mode, 1.0);
            }
            if u_lobe < base + clearcoat {
                let direction = self.0.clearcoat_microfacets().sample_reflection(from, u)?;
                return self.density_sample(from, direction, mode, 1.0);
            }
            u_lobe -= base + clearcoat;
        }
        let (microfacets, eta) = self.0.microfacets();
        let facet = VisibleFacet::sample(microfacets, eta, from, u);
        let (reflection, transmission) = self.facet_choices(facet.reflectance(), in_front);
        // The sum is below 1 by the rounding of `u_lobe`: transmission comes first, as it may be impossible.
        let (direction, eta) = if u_lobe < transmission {
            (facet.refracted()?, facet.eta())
        } else if reflection > 0.0 {
            (facet.reflected()?, 1.0)
        } else {
            return None;
        };
        self.density_sample(from, direction, mode, eta)
    }
}
