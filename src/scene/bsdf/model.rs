//! What every scattering model provides: evaluation with densities, and sampling.

use std::ops::Add;

use glam::{Vec2, Vec3A};

use crate::math::Rgb;

/// The quantity that a subpath transports (Veach 1997, section 5.1). It decides the scale of
/// refraction, (eta_i/eta_t)^2 for radiance and 1 for importance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TransportMode {
    /// Camera subpaths: sampled against the direction of light.
    Radiance,
    /// Light subpaths: sampled in the direction of light.
    Importance,
}

/// A delta lobe of a smooth interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum DeltaLobe {
    /// Mirror reflection.
    Reflection,
    /// Refraction.
    Transmission,
}

/// A scattering model at a point.
pub(super) trait Bsdf {
    /// The scattering function and both densities; zero where the two directions cannot scatter
    /// into each other.
    fn evaluate(&self, to_light: Vec3A, to_camera: Vec3A) -> BsdfEvaluation;

    /// Samples the direction in which a subpath that came from `from` continues; `None` where it
    /// ends. `u_lobe` chooses the lobe, `u` the direction.
    fn sample(&self, from: Vec3A, mode: TransportMode, u_lobe: f32, u: Vec2) -> Option<BsdfSample>;

    /// The sample of a delta lobe; `None` if the model has no such lobe or its probability is 0.
    #[inline]
    fn sample_delta(&self, _: Vec3A, _: TransportMode, _: DeltaLobe) -> Option<BsdfSample> {
        None
    }

    /// The sample of `direction` from a lobe with a density; `None` where that density is 0. `eta` is
    /// [`BsdfSample::eta`].
    #[inline]
    fn density_sample(
        &self,
        from: Vec3A,
        direction: Vec3A,
        mode: TransportMode,
        eta: f32,
    ) -> Option<BsdfSample> {
        let (to_light, to_camera) = match mode {
            TransportMode::Radiance => (direction, from),
            TransportMode::Importance => (from, direction),
        };
        let evaluation = self.evaluate(to_light, to_camera);
        let (pdf, reverse_pdf) = match mode {
            TransportMode::Radiance => (evaluation.pdf_to_light, evaluation.pdf_to_camera),
            TransportMode::Importance => (evaluation.pdf_to_camera, evaluation.pdf_to_light),
        };
        (pdf > 0.0 && pdf.is_finite()).then(|| BsdfSample {
            direction,
            weight: evaluation.f * (direction.z.abs() / pdf),
            pdf,
            reverse_pdf,
            delta: false,
            eta,
        })
    }
}

/// The scattering function for a pair of directions, with the densities of sampling either from the
/// other. Delta lobes contribute to none of the three.
#[derive(Clone, Copy, Debug)]
pub struct BsdfEvaluation {
    /// f(to_light -> to_camera): the BSDF for radiance in 1/sr, without a cosine (Veach's f_s). It
    /// is not symmetric where light refracts: f(i->o)/eta_o^2 = f(o->i)/eta_i^2.
    pub f: Rgb,
    /// Density of sampling `to_light` given `to_camera`, per steradian, including the probability of
    /// the lobe.
    pub pdf_to_light: f32,
    /// Density of sampling `to_camera` given `to_light`, likewise.
    pub pdf_to_camera: f32,
}

impl BsdfEvaluation {
    /// No scattering, and densities of 0.
    pub const ZERO: Self = Self {
        f: Rgb::ZERO,
        pdf_to_light: 0.0,
        pdf_to_camera: 0.0,
    };

    /// All three times `factor`.
    #[inline]
    pub(super) fn scaled(self, factor: f32) -> Self {
        Self {
            f: self.f * factor,
            pdf_to_light: self.pdf_to_light * factor,
            pdf_to_camera: self.pdf_to_camera * factor,
        }
    }
}

impl Add for BsdfEvaluation {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self {
            f: self.f + other.f,
            pdf_to_light: self.pdf_to_light + other.pdf_to_light,
            pdf_to_camera: self.pdf_to_camera + other.pdf_to_camera,
        }
    }
}

/// A sampled direction.
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample {
    /// In which the subpath continues, local and of unit length.
    pub direction: Vec3A,
    /// f |cos| / pdf for the transport mode: |cos| is that of `direction`, and f is the radiance BSDF
    /// from the light side to the camera side, whichever of the two was sampled.
    pub weight: Rgb,
    /// Per steradian, including the probability of the lobe; for a delta lobe its probability alone.
    pub pdf: f32,
    /// As `pdf`, for sampling the given direction from `direction`. For a delta refraction the
    /// ratio of the two includes the Jacobian dw_o/dw_i, so that products of densities agree from
    /// both ends of a path: with probabilities P, pdf = P and
    /// reverse_pdf = P_reverse (eta_i^2 |cos_i|) / (eta_o^2 |cos_o|), where o is the sampled side.
    pub reverse_pdf: f32,
    /// Whether the direction was sampled from a delta lobe.
    pub delta: bool,
    /// Relative index of refraction: that of the sampled side over that of the given side; 1 for
    /// reflection.
    pub eta: f32,
}

impl BsdfSample {
    /// Transmission of `from` without a change of direction, chosen with `probability` from either side, where
    /// `transmittance` is the fraction of light that is transmitted.
    #[inline]
    pub(super) fn straight(from: Vec3A, transmittance: Rgb, probability: f32) -> Self {
        Self {
            direction: -from,
            weight: transmittance / probability,
            pdf: probability,
            reverse_pdf: probability,
            delta: true,
            eta: 1.0,
        }
    }

    /// The same sample, where its model is chosen with `probability` among others, in which case alone it
    /// scatters.
    #[inline]
    pub(super) fn chosen_with(self, probability: f32) -> Self {
        Self {
            pdf: self.pdf * probability,
            reverse_pdf: self.reverse_pdf * probability,
            ..self
        }
    }

    /// Mirror reflection of `from`, chosen with `probability` from either side, where `reflectance`
    /// is the fraction of light that is reflected.
    #[inline]
    pub(super) fn delta_reflection(from: Vec3A, reflectance: Rgb, probability: f32) -> Self {
        Self {
            direction: Vec3A::new(-from.x, -from.y, from.z),
            weight: reflectance / probability,
            pdf: probability,
            reverse_pdf: probability,
            delta: true,
            eta: 1.0,
        }
    }
}
