//! What a material says of two directions, and of a direction it has sampled.

use glam::Vec3A;

use crate::math::Rgb;

/// Which quantity a subpath carries (Veach 1997, section 5.1): it decides the scale of refraction,
/// (eta_i/eta_t)^2 for radiance and 1 for importance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TransportMode {
    /// Camera subpaths: sampled against the light.
    Radiance,
    /// Light subpaths: sampled with the light.
    Importance,
}

/// The scattering function for a pair of directions, with the densities of both ways to sample it.
/// Delta lobes contribute to none of the three.
#[derive(Clone, Copy, Debug)]
pub struct Scattering {
    /// f(to_light -> to_camera): the BSDF for radiance in 1/sr, without a cosine (Veach's f_s). It
    /// is not symmetric where light refracts: f(i->o)/eta_o^2 = f(o->i)/eta_i^2.
    pub f: Rgb,
    /// Density of sampling `to_light` given `to_camera`, per steradian, with the probability of the lobe.
    pub pdf_to_light: f32,
    /// Density of sampling `to_camera` given `to_light`, likewise.
    pub pdf_to_camera: f32,
}

impl Scattering {
    /// No scattering, and no way to sample it.
    pub const ZERO: Self = Self {
        f: Rgb::ZERO,
        pdf_to_light: 0.0,
        pdf_to_camera: 0.0,
    };

    /// As a sample of `direction`, from a lobe with a density; `None` where that density is 0.
    #[inline]
    pub(super) fn sampled(
        self,
        direction: Vec3A,
        mode: TransportMode,
        eta: f32,
    ) -> Option<BsdfSample> {
        let (pdf, reverse_pdf) = match mode {
            TransportMode::Radiance => (self.pdf_to_light, self.pdf_to_camera),
            TransportMode::Importance => (self.pdf_to_camera, self.pdf_to_light),
        };
        (pdf > 0.0 && pdf.is_finite()).then(|| BsdfSample {
            direction,
            weight: self.f * (direction.z.abs() / pdf),
            pdf,
            reverse_pdf,
            delta: false,
            eta,
        })
    }
}

/// A sampled direction.
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample {
    /// Where the subpath goes on, local and unit length.
    pub direction: Vec3A,
    /// f |cos| / pdf, for the mode asked for: |cos| is that of `direction`, and f is the radiance
    /// BSDF from the light side to the camera side whichever of the two was sampled.
    pub weight: Rgb,
    /// Per steradian with the probability of the lobe; for a delta lobe its probability alone.
    pub pdf: f32,
    /// As `pdf`, for sampling the given direction from `direction`. For a delta refraction the
    /// ratio of the two carries the Jacobian dw_o/dw_i, so that products of densities agree from
    /// both ends of a path: with probabilities P, pdf = P and
    /// reverse_pdf = P_reverse (eta_i^2 |cos_i|) / (eta_o^2 |cos_o|), where o is the sampled side.
    pub reverse_pdf: f32,
    /// The direction came from a delta lobe.
    pub delta: bool,
    /// Relative index of refraction crossed, eta of the sampled side over eta of the given side; 1 for reflection.
    pub eta: f32,
}

impl BsdfSample {
    /// Mirror reflection of `from`, chosen with `probability` from either side, where `reflectance`
    /// is the share of light that it reflects.
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

/// What a lobe has made of its random numbers.
#[derive(Clone, Copy)]
pub(super) enum Draw {
    /// A direction of a lobe with a density: the rest follows from the scattering function.
    Density {
        /// Where the subpath goes on.
        direction: Vec3A,
        /// As [`BsdfSample::eta`].
        eta: f32,
    },
    /// A finished sample of a delta lobe.
    Delta(BsdfSample),
}

impl Draw {
    /// A direction on the side of the given one.
    #[inline]
    pub(super) fn reflection(direction: Vec3A) -> Self {
        Draw::Density {
            direction,
            eta: 1.0,
        }
    }

    /// The same seen with the surface turned around.
    #[inline]
    pub(super) fn turned(self) -> Self {
        match self {
            Draw::Density { direction, eta } => Draw::Density {
                direction: turned(direction),
                eta,
            },
            Draw::Delta(sample) => Draw::Delta(BsdfSample {
                direction: turned(sample.direction),
                ..sample
            }),
        }
    }
}

/// `v` seen with the surface turned around.
#[inline]
pub(super) fn turned(v: Vec3A) -> Vec3A {
    Vec3A::new(v.x, v.y, -v.z)
}
