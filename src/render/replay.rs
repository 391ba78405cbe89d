//! One sample of a render, made again and taken apart.

use super::pixel_sampler::PixelSamples;
use super::{Integrator, MAX_CHAINS, Method, SampleId, Settings};
use crate::integrators::{
    BidirectionalPathTracer, LightTracer, PathSampler, PathTracer, SplatList, Workspace,
};
use crate::markov::{Chain, Mutations, Target, bootstrap};
use crate::sampling::{Sampler, seeds};
use crate::scene::Scene;
use crate::technique::PathContribution;

/// A sample with all that it is made of.
pub struct Replay<'a> {
    scene: &'a Scene,
    method: Method,
    /// The subpaths.
    pub workspace: Workspace,
    /// The contribution of every technique.
    pub contributions: Vec<PathContribution>,
}

/// Why a sample cannot be made again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ReplayError {
    /// Independent samples of pixels are made by all integrators but `pssmlt`, whose samples are those of
    /// a bootstrap and of chains.
    #[error("the integrator {0} makes no such sample")]
    WrongIntegrator(&'static str),
    /// The image is smaller.
    #[error("the image has {0} pixels only: is its size that of the render?")]
    NoSuchPixel(u64),
    /// No render has so many chains.
    #[error("a render has at most {MAX_CHAINS} chains")]
    NoSuchChain,
    /// A chain starts at a sample with light.
    #[error("bootstrap sample {0} has no light, so that no chain started from it")]
    DarkStart(u64),
}

impl<'a> Replay<'a> {
    /// Makes the sample again that a render of `scene` with these settings made under the name `sample`.
    /// The integrator, the seed and, for a chain, its mutations matter.
    ///
    /// # Errors
    /// If the integrator makes no such samples, the image has no such pixel, or the chain could not
    /// have started there.
    pub fn run(
        scene: &'a Scene,
        settings: &Settings,
        sample: SampleId,
    ) -> Result<Self, ReplayError> {
        let method = settings.method();
        let mut replay = Self {
            scene,
            method,
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
        match self.method {
            Method::Path => self.sample_paths(PathTracer, sampler),
            Method::Light => self.sample_paths(LightTracer, sampler),
            Method::Bdpt | Method::Pssmlt | Method::Mmlt => {
                self.sample_paths(BidirectionalPathTracer, sampler);
            }
        }
    }

    fn sample_paths<S: Sampler>(&mut self, path_sampler: impl PathSampler, sampler: &mut S) {
        let Self {
            scene,
            workspace,
            contributions,
            ..
        } = self;
        contributions.clear();
        path_sampler.sample_paths(scene, sampler, workspace, |path| contributions.push(path));
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
