//! All emitters of a scene, and the choice between them.

use glam::{Vec2, Vec3A};

use super::area::AreaEmitter;
use super::directional::DirectionalEmitter;
use super::environment::Environment;
use super::point::PointEmitter;
use super::profile::Profile;
use super::sample::{EmissionSample, LightEvaluation, LightSample, SurfaceSample};
use super::specular::ChainEnd;
use crate::math::{Rgb, luminance};
use crate::sampling::Distribution1D;
use crate::scene::description::SceneError;
use crate::scene::interaction::SurfacePoint;

/// The kinds of emitters, by their names in scene files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum EmitterKind {
    /// A surface that emits.
    Area,
    /// A point that emits in all directions.
    Point,
    /// A point that emits into a cone.
    Spot,
    /// A point that emits into a rectangle.
    Projector,
    /// Parallel light.
    Directional,
    /// The same radiance from all directions.
    Constant,
    /// Radiance from an environment map.
    Envmap,
}

impl EmitterKind {
    /// Its name in scene files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Area => "area",
            Self::Point => "point",
            Self::Spot => "spot",
            Self::Projector => "projector",
            Self::Directional => "directional",
            Self::Constant => "constant",
            Self::Envmap => "envmap",
        }
    }
}

/// One emitter in scene units.
#[derive(Debug)]
pub(in crate::scene) enum Emitter {
    Area { light: AreaEmitter, shape: u32 },
    Point(PointEmitter),
    Directional(DirectionalEmitter),
    Environment(Environment),
}

/// Emitters are chosen as if each had at least this fraction of the mean power: even one of little power
/// may be the only light in some part of the scene.
const MIN_POWER_FRACTION: f64 = 1e-3;

/// Stands for no emitter in a table of indices.
const NO_EMITTER: u32 = u32::MAX;

/// All emitters of a scene.
#[derive(Debug)]
pub struct Emitters {
    emitters: Vec<Emitter>,
    /// Proportional to power.
    choice: Distribution1D,
    /// Index of the emitter of each shape, [`NO_EMITTER`] for those that do not emit.
    of_shape: Vec<u32>,
    environment: Option<u32>,
    /// For the ends of specular chains: the choice between emitters, and a sphere around all casters; `None`
    /// if no chain can end on an emitter.
    chain_ends: Option<(Distribution1D, (Vec3A, f32))>,
}

impl Emitters {
    /// The emitters of a scene with `shape_count` shapes.
    ///
    /// # Errors
    /// If there are none, or more than one environment.
    ///
    /// `caster_bounds` is a sphere around all shapes that reflect or refract without roughness.
    pub(in crate::scene) fn new(
        emitters: Vec<Emitter>,
        shape_count: usize,
        caster_bounds: Option<(Vec3A, f32)>,
    ) -> Result<Self, SceneError> {
        let mut of_shape = vec![NO_EMITTER; shape_count];
        let mut environment = None;
        for (i, emitter) in (0..).zip(&emitters) {
            match emitter {
                Emitter::Area { shape, .. } => of_shape[*shape as usize] = i,
                Emitter::Environment(_) if environment.is_some() => {
                    return Err(SceneError::SecondEnvironment);
                }
                Emitter::Environment(_) => environment = Some(i),
                Emitter::Point(_) | Emitter::Directional(_) => {}
            }
        }
        let powers: Vec<f64> = emitters
            .iter()
            .map(|emitter| f64::from(luminance(emitter.power())))
            .collect();
        let min = MIN_POWER_FRACTION * powers.iter().sum::<f64>() / powers.len() as f64;
        let choice = Distribution1D::new(powers.iter().map(|power| power.max(min)))
            // If no emitter has any power, the image is black; that is not an error.
            .or_else(|| Distribution1D::new(powers.iter().map(|_| 1.0)))
            .ok_or(SceneError::NoEmitter)?;
        let chain_ends = caster_bounds.and_then(|bounds| {
            let ends_chains = emitters.iter().zip(&powers).map(|(emitter, power)| {
                if emitter.ends_chains() {
                    power.max(min)
                } else {
                    0.0
                }
            });
            Some((Distribution1D::new(ends_chains)?, bounds))
        });
        Ok(Self {
            emitters,
            choice,
            of_shape,
            environment,
            chain_ends,
        })
    }

    /// Flux of an emitter into the scene, with square scene units as the unit of area.
    pub fn power(&self, emitter: u32) -> Rgb {
        self.emitters[emitter as usize].power()
    }

    /// Number of emitters.
    pub fn len(&self) -> usize {
        self.emitters.len()
    }

    /// Never true: a scene has an emitter.
    pub fn is_empty(&self) -> bool {
        self.emitters.is_empty()
    }

    /// The kind of an emitter.
    pub fn kind(&self, emitter: u32) -> EmitterKind {
        match &self.emitters[emitter as usize] {
            Emitter::Area { .. } => EmitterKind::Area,
            Emitter::Point(light) => match light.profile {
                Profile::Uniform => EmitterKind::Point,
                Profile::Spot { .. } => EmitterKind::Spot,
                Profile::Projector { .. } => EmitterKind::Projector,
            },
            Emitter::Directional(_) => EmitterKind::Directional,
            Emitter::Environment(Environment::Constant(_)) => EmitterKind::Constant,
            Emitter::Environment(Environment::Map { .. }) => EmitterKind::Envmap,
        }
    }

    /// The shape of an emitter, if it is a surface.
    pub fn shape(&self, emitter: u32) -> Option<u32> {
        match &self.emitters[emitter as usize] {
            Emitter::Area { shape, .. } => Some(*shape),
            Emitter::Point(_) | Emitter::Directional(_) | Emitter::Environment(_) => None,
        }
    }

    /// The emitter of a shape, if it emits.
    #[inline]
    pub fn of_shape(&self, shape: u32) -> Option<u32> {
        let emitter = self.of_shape[shape as usize];
        (emitter != NO_EMITTER).then_some(emitter)
    }

    /// Probability of choosing an emitter, the same for direct light and for light subpaths.
    #[inline]
    pub fn probability(&self, emitter: u32) -> f32 {
        self.choice.probability(emitter as usize)
    }

    /// Samples a point y_0 for technique s = 1. `u_light` chooses the emitter, `u_primitive` the
    /// triangle, `u_position` the point. `None` if the emitter does not face the point.
    #[inline]
    pub fn sample_direct(
        &self,
        point: Vec3A,
        u_light: f32,
        u_primitive: f32,
        u_position: Vec2,
    ) -> Option<LightSample> {
        let (emitter, _) = self.choice.sample(u_light);
        let choice_pdf = self.choice.probability(emitter);
        match &self.emitters[emitter] {
            Emitter::Area { light, .. } => {
                light.sample_direct(point, u_primitive, u_position, choice_pdf)
            }
            Emitter::Point(light) => light.sample_direct(point, choice_pdf),
            Emitter::Directional(light) => Some(light.sample_direct(point, choice_pdf)),
            Emitter::Environment(light) => light.sample_direct(point, u_position, choice_pdf),
        }
    }

    /// Samples a point of an area emitter by area, its density including the choice of the emitter; and its
    /// radiance. `None` if the choice falls on another kind.
    pub fn sample_surface(
        &self,
        u_light: f32,
        u_primitive: f32,
        u_position: Vec2,
    ) -> Option<(SurfaceSample, Rgb)> {
        let (i, _) = self.choice.sample(u_light);
        let Emitter::Area { light, .. } = &self.emitters[i] else {
            return None;
        };
        let (mut sample, radiance) = light.sample_light(u_primitive, u_position);
        sample.pdf *= self.choice.probability(i);
        Some((sample, radiance))
    }

    /// Samples the start of a light subpath. `u_light` chooses the emitter, `u_primitive` the
    /// triangle, `u_position` the point and `u_direction` the direction.
    #[inline]
    pub fn sample_emission(
        &self,
        u_light: f32,
        u_primitive: f32,
        u_position: Vec2,
        u_direction: Vec2,
    ) -> Option<EmissionSample> {
        let (i, _) = self.choice.sample(u_light);
        let emitter = i as u32;
        let p = self.choice.probability(i);
        match &self.emitters[i] {
            Emitter::Area { light, .. } => {
                Some(light.sample_emission(emitter, u_primitive, u_position, u_direction, p))
            }
            Emitter::Point(light) => Some(light.sample_emission(emitter, u_direction, p)),
            Emitter::Directional(light) => Some(light.sample_emission(emitter, u_position, p)),
            Emitter::Environment(light) => {
                light.sample_emission(emitter, u_position, u_direction, p)
            }
        }
    }

    /// The density with which [`Self::sample_direct`] for `point` samples the y_0 of `sample`.
    #[inline]
    pub fn direct_pdf(&self, sample: &EmissionSample, point: Vec3A) -> f32 {
        match &self.emitters[sample.emitter as usize] {
            Emitter::Area { light, .. } => {
                light.emission_direct_pdf(sample, point, self.probability(sample.emitter))
            }
            // Both ways of sampling have the same density.
            Emitter::Point(_) | Emitter::Directional(_) | Emitter::Environment(_) => {
                sample.pdf_position
            }
        }
    }

    /// True if specular chains can end on some emitter.
    pub fn end_chains(&self) -> bool {
        self.chain_ends.is_some()
    }

    /// True if specular chains can end on an emitter.
    pub fn ends_chains(&self, emitter: u32) -> bool {
        self.end_chains() && self.emitters[emitter as usize].ends_chains()
    }

    /// Samples the end of a specular chain. `None` if there is none.
    #[inline]
    pub fn sample_chain_end(
        &self,
        u_light: f32,
        u_primitive: f32,
        u_position: Vec2,
    ) -> Option<ChainEnd> {
        let (choice, bounds) = self.chain_ends.as_ref()?;
        let (i, _) = choice.sample(u_light);
        let pdfs = [choice.probability(i), self.choice.probability(i)];
        Some(match &self.emitters[i] {
            Emitter::Area { light, .. } => {
                light.sample_chain_end(*bounds, u_primitive, u_position, pdfs)
            }
            Emitter::Point(light) => light.chain_end(pdfs),
            Emitter::Directional(light) => light.chain_end(pdfs),
            Emitter::Environment(light) => light.sample_chain_end(u_position, pdfs),
        })
    }

    /// A point on an area emitter as the end of a chain, with the density of sampling it; `None` if chains never
    /// end there.
    #[inline]
    pub fn chain_end_on(&self, surface: &SurfacePoint) -> Option<ChainEnd> {
        let emitter = self.of_shape(surface.shape)?;
        let (pdfs, bounds) = self.chain_end_pdfs(emitter)?;
        match &self.emitters[emitter as usize] {
            Emitter::Area { light, .. } => {
                let pdf = light.surface_pdf(surface.primitive);
                let (position, normal) = (surface.position, surface.geometric_normal);
                Some(light.chain_end_on(bounds, position, normal, pdf, pdfs))
            }
            Emitter::Point(_) | Emitter::Directional(_) | Emitter::Environment(_) => None,
        }
    }

    /// The unit direction to the environment as the end of a chain, as [`Self::chain_end_on`].
    #[inline]
    pub fn chain_end_at(&self, direction: Vec3A) -> Option<ChainEnd> {
        let emitter = self.environment?;
        let (pdfs, _) = self.chain_end_pdfs(emitter)?;
        match &self.emitters[emitter as usize] {
            Emitter::Environment(light) => Some(light.chain_end(direction, pdfs)),
            Emitter::Area { .. } | Emitter::Point(_) | Emitter::Directional(_) => None,
        }
    }

    /// The start of a light subpath as the end of a chain, as [`Self::chain_end_on`].
    #[inline]
    pub fn chain_end_of(&self, sample: &EmissionSample) -> Option<ChainEnd> {
        let (pdfs, bounds) = self.chain_end_pdfs(sample.emitter)?;
        Some(match &self.emitters[sample.emitter as usize] {
            Emitter::Area { light, .. } => {
                let pdf = sample.pdf_position / pdfs[1];
                light.chain_end_on(bounds, sample.position, sample.normal, pdf, pdfs)
            }
            Emitter::Point(light) => light.chain_end(pdfs),
            Emitter::Directional(light) => light.chain_end(pdfs),
            Emitter::Environment(light) => light.chain_end(-sample.direction, pdfs),
        })
    }

    /// The probabilities of an emitter for chains and for light subpaths, and a sphere around all casters; `None`
    /// if chains never end on it.
    #[inline]
    fn chain_end_pdfs(&self, emitter: u32) -> Option<([f32; 2], (Vec3A, f32))> {
        let (choice, bounds) = self.chain_ends.as_ref()?;
        let p = choice.probability(emitter as usize);
        (p > 0.0).then(|| ([p, self.probability(emitter)], *bounds))
    }

    /// Light from a point on a surface toward the point `from`, in scene units; `None` if the surface
    /// does not emit in that direction.
    #[inline]
    pub fn evaluate_surface(&self, surface: &SurfacePoint, from: Vec3A) -> Option<LightEvaluation> {
        let emitter = self.of_shape(surface.shape)?;
        match &self.emitters[emitter as usize] {
            Emitter::Area { light, .. } => light.evaluate(surface, from, self.probability(emitter)),
            Emitter::Point(_) | Emitter::Directional(_) | Emitter::Environment(_) => None,
        }
    }

    /// Light from the environment for a ray that leaves the scene along the unit `direction`; `None` if
    /// the scene has no environment. It does not depend on the origin of the ray.
    #[inline]
    pub fn evaluate_environment(&self, direction: Vec3A) -> Option<LightEvaluation> {
        let emitter = self.environment?;
        match &self.emitters[emitter as usize] {
            Emitter::Environment(light) => {
                Some(light.evaluate(direction, self.probability(emitter)))
            }
            Emitter::Area { .. } | Emitter::Point(_) | Emitter::Directional(_) => None,
        }
    }
}

impl Emitter {
    /// True if next event estimation through specular chains samples it. Every direction of a constant
    /// environment emits: camera subpaths hit it anyway. Light that varies over an emitter, or with the
    /// direction in which a chain leaves it, is left to the other techniques.
    fn ends_chains(&self) -> bool {
        match self {
            Self::Area { light, .. } => light.ends_chains(),
            Self::Point(light) => light.ends_chains(),
            Self::Directional(_) => true,
            Self::Environment(Environment::Map { .. }) => true,
            Self::Environment(Environment::Constant(_)) => false,
        }
    }

    /// Flux into the scene, with square scene units as the unit of area.
    fn power(&self) -> Rgb {
        match self {
            Self::Area { light, .. } => light.power(),
            Self::Point(light) => light.power(),
            Self::Directional(light) => light.power(),
            Self::Environment(light) => light.power(),
        }
    }
}
