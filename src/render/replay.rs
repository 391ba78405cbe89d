//! Replay of a single sample of a render, with its subpaths and the contributions of its techniques.

use super::pixel_sampler::PixelSamples;
use super::{Integrator, MAX_CHAINS, SampleId, Settings};
use crate::integrators::{PathSampler, SplatList, Workspace};
use crate::markov::{Chain, Mutations, Target, bootstrap};
use crate::sampling::{Sampler, seeds};
use crate::scene::Scene;
use crate::technique::{PathContribution, TechniqueSet};

/// A replayed sample.
pub struct Replay<'a> {
    scene: &'a Scene,
    techniques: TechniqueSet,
    /// The subpaths.
    pub workspace: Workspace,
    /// The contributions of all techniques that found light.
    pub contributions: Vec<PathContribution>,
}

/// Why a sample cannot be replayed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ReplayError {
    /// Only `pssmlt` has samples of a bootstrap and of chains; all other integrators have samples of pixels.
    #[error("the integrator {0} has no samples of this kind")]
    WrongIntegrator(&'static str),
    /// The image has too few pixels.
    #[error("the image has only {0} pixels: set the image size of the render")]
    NoSuchPixel(u64),
    /// No render has so many chains.
    #[error("a render has at most {MAX_CHAINS} chains")]
    NoSuchChain,
    /// Chains start only at samples with light.
    #[error("bootstrap sample {0} has no light, so no chain starts from it")]
    DarkStart(u64),
}

impl<'a> Replay<'a> {
    /// Replays the sample `sample` of a render of `scene` with these settings. Only the integrator, the seed
    /// and, for a chain, its mutations are used.
    ///
    /// # Errors
    /// If the integrator has no such samples, the image has no such pixel, or the chain cannot start at its
    /// bootstrap sample.
    pub fn run(
        scene: &'a Scene,
        settings: &Settings,
        sample: SampleId,
    ) -> Result<Self, ReplayError> {
        let method = settings.method();
        let mut replay = Self {
            scene,
            techniques: method.techniques(),
            workspace: Workspace::default(),
            contributions: Vec::new(),
        };
        let seed = settings.seed;
        match (sample, &settings.integrator) {
            (SampleId::Pixel { .. }, Integrator::Pssmlt(_)) => {
                return Err(ReplayError::WrongIntegrator(method.name()));
            }
            (SampleId::Pixel { pass, pixel }, _) => {
                let samples = PixelSamples::new(scene, seed);
                if pixel >= samples.pixels() {
                    return Err(ReplayError::NoSuchPixel(samples.pixels()));
                }
                replay.sample(&mut samples.sample(pass, pixel));
            }
            (SampleId::Bootstrap { sample }, Integrator::Pssmlt(_)) => {
                replay.sample(&mut bootstrap::sample(seed, sample));
            }
            (SampleId::Mutation { chain, .. }, _) if chain >= MAX_CHAINS => {
                return Err(ReplayError::NoSuchChain);
            }
            (SampleId::Mutation { chain, start, step }, Integrator::Pssmlt(own)) => {
                let mutations = Mutations::kelemen(own.large_step_probability, own.small_step);
                let rng = seeds::chain_generator(seed, chain);
                let sample = bootstrap::sample(seed, start);
                let mut chain = Chain::start(&mut replay, sample, rng, mutations);
                let density = chain.current().density;
                if density.is_nan() || density <= 0.0 {
                    return Err(ReplayError::DarkStart(start));
                }
                for _ in 0..step {
                    chain.step(&mut replay);
                }
            }
            _ => return Err(ReplayError::WrongIntegrator(method.name())),
        }
        Ok(replay)
    }

    fn sample<S: Sampler>(&mut self, sampler: &mut S) {
        let Self {
            scene,
            techniques,
            workspace,
            contributions,
        } = self;
        contributions.clear();
        techniques.sample_paths(scene, sampler, workspace, |path| contributions.push(path));
    }
}

impl Target for Replay<'_> {
    type Contribution = SplatList;

    fn evaluate<S: Sampler>(&mut self, sampler: &mut S, out: &mut SplatList) -> f64 {
        self.sample(sampler);
        out.clear();
        for path in &self.contributions {
            out.add(path.technique, path.splat());
        }
        out.luminance()
    }
}
