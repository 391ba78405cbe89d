//! Where light comes from, and the three ways to meet it: sampled for a point that it lights
//! (technique s = 1), sampled as the start of a light subpath (s >= 2), and met by a camera subpath
//! (s = 0).
//!
//! A point y_0 on an emitter has a density in the *native measure* of its kind: area for surfaces,
//! solid angle for emitters at infinity, and a probability for point and directional lights. All
//! densities include the probability of choosing the emitter.

mod environment;
mod infinite;
mod surface;

#[cfg(test)]
mod tests;

use std::f32::consts::{FRAC_1_PI, PI};

use glam::{Vec2, Vec3A};

use super::{SceneError, SurfacePoint};
use crate::math::{Rgb, luminance};
use crate::sampling::Distribution1D;
use crate::sampling::warp::square_to_sphere;

pub(super) use environment::EnvironmentMap;
pub(super) use infinite::{DirectionalEmitter, Environment};
pub(super) use surface::AreaEmitter;
use surface::MIN_DISTANCE_SQUARED;

/// Light that leaves an emitter toward a given point, with the densities of all ways to sample it.
#[derive(Clone, Copy, Debug)]
pub struct EmissionToward {
    /// Radiance toward the point, W/(m^2 sr); for point lights intensity, for directional ones
    /// irradiance.
    pub radiance: Rgb,
    /// Native density of y_0 when sampled for that point (s = 1).
    pub pdf_direct: f32,
    /// Native density of y_0 when sampled as the start of a light subpath (s >= 2).
    pub pdf_position: f32,
    /// Density of the direction toward the point given y_0 (s >= 2): per steradian for emitters at
    /// a finite place; per unit area of the disk that emits for those at infinity,
    /// directional lights among them.
    pub pdf_direction: f32,
}

/// A point y_0 on an emitter, sampled for a point that it may light.
#[derive(Clone, Copy, Debug)]
pub struct DirectSample {
    /// Unit, from the point to y_0.
    pub direction: Vec3A,
    /// Where the segment ends that must be free, already moved off the emitter's surface; for an
    /// emitter at infinity a point outside the scene.
    pub target: Vec3A,
    /// Radiance and densities of y_0 toward the point.
    pub emission: EmissionToward,
    /// What turns a density per steradian at the point into the native one of y_0:
    /// |cos(y_0)|/d^2 for surfaces, 1/d^2 for points, 1 at infinity. Also the emitter's part of G.
    pub geometry: f32,
    /// What, times the cosine at the point, turns `pdf_direction` into an area density at the
    /// point: 1/d^2, or 1 for emitters at infinity.
    pub spread: f32,
    /// True if no camera subpath can ever hit this emitter (point and directional lights): then
    /// technique s = 0 does not exist for it.
    pub delta: bool,
}

/// The start of a light subpath: y_0 and the direction to y_1.
#[derive(Clone, Copy, Debug)]
pub struct EmissionSample {
    /// Index of the emitter.
    pub emitter: u32,
    /// Start of the ray, off the emitter's surface.
    pub origin: Vec3A,
    /// Point y_0 on a surface or of a point light (for emitters at infinity the same as `origin`).
    pub position: Vec3A,
    /// Unit normal at y_0 on the emitting side; any unit vector for point lights; the direction of
    /// travel for emitters at infinity.
    pub normal: Vec3A,
    /// Unit, in which the light travels.
    pub direction: Vec3A,
    /// Le |cos| / (pdf_position pdf_direction): the throughput alpha of the subpath.
    pub weight: Rgb,
    /// Native density of y_0.
    pub pdf_position: f32,
    /// As [`EmissionToward::pdf_direction`].
    pub pdf_direction: f32,
    /// y_0 is at infinity: `spread` to y_1 is 1, not 1/d^2.
    pub infinite: bool,
    /// As [`DirectSample::delta`].
    pub delta: bool,
}

/// The kinds of emitter, by their names in scene files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum EmitterKind {
    /// A surface that shines.
    Area,
    /// A point that shines in all directions.
    Point,
    /// Parallel light.
    Directional,
    /// The same radiance from everywhere.
    Constant,
    /// Radiance from an image around the scene.
    Envmap,
}

impl EmitterKind {
    /// Its name in scene files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Area => "area",
            Self::Point => "point",
            Self::Directional => "directional",
            Self::Constant => "constant",
            Self::Envmap => "envmap",
        }
    }
}

/// One emitter in scene units.
#[derive(Debug)]
pub(super) enum Emitter {
    Area {
        light: AreaEmitter,
        shape: u32,
    },
    Point {
        position: Vec3A,
        /// Power per steradian, in square scene units: it falls off with their distance.
        intensity: Rgb,
    },
    Directional(DirectionalEmitter),
    Environment(Environment),
}

/// Least share of the mean power for which an emitter is chosen: even one that seems to give next to
/// nothing may be all that lights some corner.
const LEAST_SHARE: f64 = 1e-3;

/// No emitter, in a table of their indices.
const NONE: u32 = u32::MAX;

/// All emitters of a scene.
#[derive(Debug)]
pub struct Emitters {
    emitters: Vec<Emitter>,
    /// In proportion to power.
    choice: Distribution1D,
    /// By shape, [`NONE`] for those that do not emit.
    of_shape: Vec<u32>,
    environment: Option<u32>,
}

impl Emitters {
    /// The emitters of a scene with `shape_count` shapes.
    ///
    /// # Errors
    /// If there are none, or more than one that surrounds the scene.
    pub(super) fn new(emitters: Vec<Emitter>, shape_count: usize) -> Result<Self, SceneError> {
        let mut of_shape = vec![NONE; shape_count];
        let mut environment = None;
        for (i, emitter) in (0..).zip(&emitters) {
            match emitter {
                Emitter::Area { shape, .. } => of_shape[*shape as usize] = i,
                Emitter::Environment(_) if environment.is_some() => {
                    return Err(SceneError::SecondEnvironment);
                }
                Emitter::Environment(_) => environment = Some(i),
                Emitter::Point { .. } | Emitter::Directional(_) => {}
            }
        }
        let powers: Vec<f64> = emitters
            .iter()
            .map(|emitter| f64::from(luminance(emitter.power())))
            .collect();
        let least = LEAST_SHARE * powers.iter().sum::<f64>() / powers.len() as f64;
        let choice = Distribution1D::new(powers.iter().map(|power| power.max(least)))
            // Emitters without any light: the image is black, but that is no error.
            .or_else(|| Distribution1D::new(powers.iter().map(|_| 1.0)))
            .ok_or(SceneError::NoEmitter)?;
        Ok(Self {
            emitters,
            choice,
            of_shape,
            environment,
        })
    }

    /// Number of emitters.
    pub fn len(&self) -> usize {
        self.emitters.len()
    }

    /// Never true: a scene has an emitter.
    pub fn is_empty(&self) -> bool {
        self.emitters.is_empty()
    }

    /// What kind an emitter is.
    pub fn kind(&self, emitter: u32) -> EmitterKind {
        match &self.emitters[emitter as usize] {
            Emitter::Area { .. } => EmitterKind::Area,
            Emitter::Point { .. } => EmitterKind::Point,
            Emitter::Directional(_) => EmitterKind::Directional,
            Emitter::Environment(Environment::Constant(_)) => EmitterKind::Constant,
            Emitter::Environment(Environment::Map { .. }) => EmitterKind::Envmap,
        }
    }

    /// The shape that is this emitter, if it is a surface.
    pub fn shape(&self, emitter: u32) -> Option<u32> {
        match &self.emitters[emitter as usize] {
            Emitter::Area { shape, .. } => Some(*shape),
            Emitter::Point { .. } | Emitter::Directional(_) | Emitter::Environment(_) => None,
        }
    }

    /// The emitter that a shape is, if it emits.
    #[inline]
    pub fn of_shape(&self, shape: u32) -> Option<u32> {
        let emitter = self.of_shape[shape as usize];
        (emitter != NONE).then_some(emitter)
    }

    /// Probability of choosing an emitter, the same for direct light and for light subpaths.
    #[inline]
    pub fn probability(&self, emitter: u32) -> f32 {
        self.choice.probability(emitter as usize)
    }

    /// Samples a point for technique s = 1. `choose` picks the emitter, `part` the triangle, `u`
    /// the place. `None` if the emitter turns its dark side to the point.
    #[inline]
    pub fn sample_direct(
        &self,
        point: Vec3A,
        choose: f32,
        part: f32,
        u: Vec2,
    ) -> Option<DirectSample> {
        let (emitter, _) = self.choice.sample(choose);
        let choice_pdf = self.choice.probability(emitter);
        match &self.emitters[emitter] {
            Emitter::Area { light, .. } => light.sample_direct(point, part, u, choice_pdf),
            Emitter::Point {
                position,
                intensity,
            } => point_direct(*position, *intensity, point, choice_pdf),
            Emitter::Directional(light) => Some(light.sample_direct(point, choice_pdf)),
            Emitter::Environment(light) => light.sample_direct(point, u, choice_pdf),
        }
    }

    /// Samples the start of a light subpath. `choose` picks the emitter, `part` the triangle,
    /// `place` the point and `way` the direction.
    #[inline]
    pub fn sample_emission(
        &self,
        choose: f32,
        part: f32,
        place: Vec2,
        way: Vec2,
    ) -> Option<EmissionSample> {
        let (i, _) = self.choice.sample(choose);
        let emitter = i as u32;
        let choice_pdf = self.choice.probability(i);
        match &self.emitters[i] {
            Emitter::Area { light, .. } => {
                Some(light.sample_emission(emitter, part, place, way, choice_pdf))
            }
            Emitter::Point {
                position,
                intensity,
            } => {
                let direction = square_to_sphere(way);
                Some(EmissionSample {
                    emitter,
                    origin: *position,
                    position: *position,
                    normal: direction,
                    direction,
                    weight: *intensity * (4.0 * PI / choice_pdf),
                    pdf_position: choice_pdf,
                    pdf_direction: 0.25 * FRAC_1_PI,
                    infinite: false,
                    delta: true,
                })
            }
            Emitter::Directional(light) => Some(light.sample_emission(emitter, place, choice_pdf)),
            Emitter::Environment(light) => light.sample_emission(emitter, place, way, choice_pdf),
        }
    }

    /// The density with which `sample_direct` at `point` would have found the start of `sample`.
    #[inline]
    pub fn direct_pdf(&self, sample: &EmissionSample, point: Vec3A) -> f32 {
        match &self.emitters[sample.emitter as usize] {
            Emitter::Area { light, .. } => {
                light.emission_direct_pdf(sample, point, self.probability(sample.emitter))
            }
            // The same native density in both.
            Emitter::Point { .. } | Emitter::Directional(_) | Emitter::Environment(_) => {
                sample.pdf_position
            }
        }
    }

    /// Light from a surface that was hit toward `from`; `None` if its shape emits nothing that way.
    /// `from` is a point, in scene units.
    #[inline]
    pub fn hit(&self, surface: &SurfacePoint, from: Vec3A) -> Option<EmissionToward> {
        let emitter = self.of_shape(surface.shape)?;
        match &self.emitters[emitter as usize] {
            Emitter::Area { light, .. } => light.hit(surface, from, self.probability(emitter)),
            Emitter::Point { .. } | Emitter::Directional(_) | Emitter::Environment(_) => None,
        }
    }

    /// Light that arrives against `direction` (unit, the way the camera subpath went) from emitters
    /// at infinity; `None` if the scene has none that a ray can meet. It is the same wherever in the
    /// scene the ray started.
    #[inline]
    pub fn escape(&self, direction: Vec3A) -> Option<EmissionToward> {
        let emitter = self.environment?;
        match &self.emitters[emitter as usize] {
            Emitter::Environment(light) => Some(light.escape(direction, self.probability(emitter))),
            Emitter::Area { .. } | Emitter::Point { .. } | Emitter::Directional(_) => None,
        }
    }
}

impl Emitter {
    /// Flux into the scene, in square scene units.
    fn power(&self) -> Rgb {
        match self {
            Self::Area { light, .. } => light.power(),
            Self::Point { intensity, .. } => *intensity * (4.0 * PI),
            Self::Directional(light) => light.power(),
            Self::Environment(light) => light.power(),
        }
    }
}

/// [`Emitters::sample_direct`] of a point light.
#[inline]
fn point_direct(
    position: Vec3A,
    intensity: Rgb,
    point: Vec3A,
    choice_pdf: f32,
) -> Option<DirectSample> {
    let to = position - point;
    let distance_squared = to.length_squared();
    (distance_squared > MIN_DISTANCE_SQUARED).then(|| DirectSample {
        direction: to / distance_squared.sqrt(),
        target: position,
        emission: EmissionToward {
            radiance: intensity,
            pdf_direct: choice_pdf,
            pdf_position: choice_pdf,
            pdf_direction: 0.25 * FRAC_1_PI,
        },
        geometry: 1.0 / distance_squared,
        spread: 1.0 / distance_squared,
        delta: true,
    })
}
