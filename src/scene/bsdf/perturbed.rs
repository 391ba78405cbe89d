//! A model whose shading normal a texture perturbs: Mitsuba 3's `normalmap` and `bumpmap`.
//!
//! With the perturbed normal n' in place of the shading normal n, the light that a model f scatters is
//! f |w_i.n'|, where w_i points to the light. As the BSDF of a surface with normal n this is
//!
//!   f |w_i.n'| / |w_i.n|                                                                     (1)
//!
//! which is not reciprocal: light subpaths sample it in the opposite direction (Veach 1997, section 5.3). It is
//! zero where w_i is in front of one normal and behind the other.

use glam::{Vec2, Vec3A};

use super::mask::ALMOST_ONE;
use super::model::{Bsdf, BsdfEvaluation, BsdfSample, TransportMode};
use crate::fault::{Fault, planted};
use crate::math::{Frame, Rgb};

/// How a perturbed normal is used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NormalPerturbation {
    /// Whether a normal that faces away from the camera is reflected in the shading normal.
    pub flip_invalid_normals: bool,
    /// Whether light is darkened smoothly where it grazes the surface.
    pub use_shadowing_function: bool,
}

impl Default for NormalPerturbation {
    /// As in Mitsuba 3.
    fn default() -> Self {
        Self {
            flip_invalid_normals: true,
            use_shadowing_function: true,
        }
    }
}

/// `Material::NormalMap` and `Material::BumpMap` at a point.
pub(super) struct PerturbedBsdf<B> {
    pub perturbation: NormalPerturbation,
    /// n', unit, local.
    pub normal: Vec3A,
    /// Unit vector along dp/du in the tangent plane, local: it stays the tangent of the model.
    pub tangent: Vec2,
    pub model: B,
}

/// n' of a normal map of `color`: its components are 2 color - 1 along the tangent, across it, and along the
/// shading normal.
#[inline]
pub(super) fn mapped_normal(color: Rgb, tangent: Vec2) -> Vec3A {
    let n = 2.0 * color - Vec3A::ONE;
    let horizontal = tangent.rotate(Vec2::new(n.x, n.y));
    Vec3A::new(horizontal.x, horizontal.y, n.z)
        .try_normalize()
        .unwrap_or(Vec3A::Z)
}

/// n' of a surface that is displaced along its shading normal, where `slope` is the derivative of the displacement
/// with respect to the texture coordinates (Blinn 1978, "Simulation of wrinkled surfaces"). All vectors are
/// local; `geometric` is the geometric normal.
#[inline]
pub(super) fn displaced_normal(slope: Vec2, [dp_du, dp_dv]: [Vec3A; 2], geometric: Vec3A) -> Vec3A {
    let along_u = Vec3A::new(dp_du.x, dp_du.y, slope.x);
    let along_v = Vec3A::new(dp_dv.x, dp_dv.y, slope.y);
    let Some(n) = along_u.cross(along_v).try_normalize() else {
        return Vec3A::Z;
    };
    if n.dot(geometric) < 0.0 { -n } else { n }
}

impl<B: Bsdf> Bsdf for PerturbedBsdf<B> {
    #[inline]
    fn evaluate(&self, to_light: Vec3A, to_camera: Vec3A) -> BsdfEvaluation {
        let normal = self.normal_toward(to_camera);
        let frame = self.frame(normal);
        let (light, camera) = (frame.to_local(to_light), frame.to_local(to_camera));
        if light.z * to_light.z <= 0.0 {
            return BsdfEvaluation::ZERO;
        }
        let evaluation = self.model.evaluate(light, camera);
        BsdfEvaluation {
            f: evaluation.f * self.cosine_ratio(normal, light, to_light),
            pdf_to_light: evaluation.pdf_to_light,
            pdf_to_camera: if planted(Fault::NormalProbabilityLeftOut) {
                evaluation.pdf_to_camera
            } else {
                evaluation.pdf_to_camera * self.probability(normal, to_light)
            },
        }
    }

    #[inline]
    fn sample(&self, from: Vec3A, mode: TransportMode, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        let (normal, u_lobe) = match mode {
            TransportMode::Radiance => (self.normal_toward(from), u_lobe),
            TransportMode::Importance => self.sample_normal(from, u_lobe),
        };
        let frame = self.frame(normal);
        let local = frame.to_local(from);
        let sample = self.model.sample(local, mode, u_lobe, u)?;
        let direction = frame.to_world(sample.direction).normalize();
        let (light, to_light, to_camera) = match mode {
            TransportMode::Radiance => (sample.direction, direction, from),
            TransportMode::Importance => (local, from, direction),
        };
        if light.z * to_light.z <= 0.0 || self.normal_toward(to_camera) != normal {
            return None;
        }
        if !sample.delta {
            return self.density_sample(from, direction, mode, sample.eta);
        }
        // `weight` has the cosine of the sampled direction with n'.
        let cosines = (direction.z / sample.direction.z).abs();
        let ratio = self.cosine_ratio(normal, light, to_light) * cosines;
        let probability = self.probability(normal, to_light);
        let (forward, reverse) = match mode {
            TransportMode::Radiance => (1.0, probability),
            TransportMode::Importance => (probability, 1.0),
        };
        Some(BsdfSample {
            direction,
            weight: sample.weight * (ratio / forward),
            pdf: sample.pdf * forward,
            reverse_pdf: sample.reverse_pdf * reverse,
            ..sample
        })
    }
}

impl<B> PerturbedBsdf<B> {
    /// n' reflected in the shading normal.
    #[inline]
    fn flipped_normal(&self) -> Vec3A {
        Vec3A::new(-self.normal.x, -self.normal.y, self.normal.z)
    }

    /// The normal that a camera in this direction sees.
    #[inline]
    fn normal_toward(&self, to_camera: Vec3A) -> Vec3A {
        let faces_away = to_camera.z * to_camera.dot(self.normal) <= 0.0;
        if self.perturbation.flip_invalid_normals && faces_away {
            self.flipped_normal()
        } else {
            self.normal
        }
    }

    /// Probability with which a light subpath from `to_light` uses the flipped normal. A light subpath does not know
    /// the camera that the normal depends on, so it chooses one of the normals that face the light, and ends if
    /// its direction sees the other. Cameras of a fraction q = (1 - n.n') / 2 of the projected solid
    /// angle see the flipped normal; the probability sqrt(q) / (1 + sqrt(q)) minimises the variance of diffuse
    /// reflection, q / p + 1 / (1 - p).
    #[inline]
    fn flip_probability(&self, to_light: Vec3A) -> f32 {
        if !self.perturbation.flip_invalid_normals {
            return 0.0;
        }
        let faces = |normal: Vec3A| to_light.z * to_light.dot(normal) > 0.0;
        match (faces(self.normal), faces(self.flipped_normal())) {
            (true, true) => {
                let root = (0.5 * (1.0 - self.normal.z)).max(0.0).sqrt();
                root / (1.0 + root)
            }
            (false, true) => 1.0,
            (_, false) => 0.0,
        }
    }

    /// Probability with which a light subpath from `to_light` uses `normal`.
    #[inline]
    fn probability(&self, normal: Vec3A, to_light: Vec3A) -> f32 {
        let flip = self.flip_probability(to_light);
        if normal == self.normal {
            1.0 - flip
        } else {
            flip
        }
    }

    /// Chooses the normal of a light subpath; also returns `u_lobe` as a new random number.
    #[inline]
    fn sample_normal(&self, to_light: Vec3A, u_lobe: f32) -> (Vec3A, f32) {
        let flip = self.flip_probability(to_light);
        let (normal, u_lobe) = if u_lobe < flip {
            (self.flipped_normal(), u_lobe / flip)
        } else {
            (self.normal, (u_lobe - flip) / (1.0 - flip))
        };
        (normal, u_lobe.min(ALMOST_ONE))
    }

    /// The frame around `normal` in which the tangent has the same coordinates as in the shading frame.
    #[inline]
    fn frame(&self, normal: Vec3A) -> Frame {
        let Vec2 { x: cos, y: sin } = self.tangent;
        let tangent = Vec3A::new(cos, sin, 0.0);
        let s = (tangent - normal * normal.dot(tangent))
            .try_normalize()
            .unwrap_or_else(|| Frame::from_normal(normal).s);
        let t = normal.cross(s);
        Frame {
            s: cos * s - sin * t,
            t: sin * s + cos * t,
            n: normal,
        }
    }

    /// The factor |w_i.n'| / |w_i.n| of (1), times the shadowing function 2 / (1 + sqrt(1 + a^2 tan^2)), with the
    /// tangent of the angle between w_i and n, and a^2 = min(1, tan^2(n, n') / 8) (Conty Estevez et al. 2019,
    /// "A microfacet-based shadowing function to solve the bump terminator problem", equations 3 and 4).
    /// `light` is `to_light` in the frame of `normal`.
    #[inline]
    fn cosine_ratio(&self, normal: Vec3A, light: Vec3A, to_light: Vec3A) -> f32 {
        if planted(Fault::PerturbedCosineLeftOut) {
            return 1.0;
        }
        let cos = to_light.z.abs();
        if !self.perturbation.use_shadowing_function {
            return (light.z.abs() / cos).min(MAX_COSINE_RATIO);
        }
        let normal_cos2 = normal.z * normal.z;
        let alpha2 = (0.125 * (1.0 - normal_cos2) / normal_cos2).clamp(0.0, 1.0);
        let cos2 = cos * cos;
        let root = (cos2 + alpha2 * (1.0 - cos2).max(0.0)).sqrt();
        (2.0 * light.z.abs() / (cos + root)).min(MAX_COSINE_RATIO)
    }
}

/// Maximum of the factor of (1), so that products with densities are finite. Directions that graze the surface
/// by less than its inverse, in radians, do not occur in f32.
const MAX_COSINE_RATIO: f32 = 1e10;
