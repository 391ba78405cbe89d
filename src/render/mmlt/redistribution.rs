//! Energy redistribution (Cline et al. 2005, "Energy redistribution path tracing") by multiplexed chains
//! (Hachisuka et al. 2014): chains start at independent samples, in proportion to their residuals.
//!
//! N independent samples find residuals with densities T_1, T_2, ... of sum W, so that W/N is an unbiased
//! estimate of b = sum b_k. The residuals are resampled in proportion to T: each of a number of chains with
//! mean K starts at one of them and makes n mutations. On average over the independent samples, the chains
//! are in equilibrium from their first state on, so that
//!
//!   (W/N) (1/(K n)) sum over all visits of F/I
//!
//! estimates the integral of F without bias, for any K that depends on W and any n that does not, even if no
//! chain leaves the neighbourhood of its start: there is no start-up bias, and no separate estimate of b
//! (Veach and Guibas 1997, section 5.1, weight their chains in the same way). A length n that depended on W
//! would depend on the start, because W contains its T.
//!
//! This is repeated for every block of samples. Every sample of the render refines the estimates of b_k, as
//! large steps do in other methods, and is a possible start of a chain. So the chains need no large steps.
//!
//! Resampling is systematic, over the residuals in the order of path length: every length receives
//! mutations in proportion to its b_k, up to the rounding of one chain.

use rand::RngExt;
use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;

use super::target::{MultiplexedTarget, WithTechnique};
use crate::fault::{Fault, planted};
use crate::film::{Splat, SplatFilm, SplatLog};
use crate::integrators::SplatList;
use crate::markov::{
    Chain, ChainCounters, Mutation, Mutations, Perturbation, Sample, SmallStep, systematic_resample,
};
use crate::math::color::saturated;
use crate::path::dimensions;
use crate::render::NonFinite;
use crate::render::pixel_sampler::PixelSampler;
use crate::render::plan::Clamp;
use crate::sampling::seeds::{self, Purpose};
use crate::scene::{RayCounts, Scene};
use crate::technique::{Technique, Techniques};

/// Minimum and maximum number of mutations of a chain. The minimum applies to small blocks.
const MUTATIONS_PER_CHAIN: [u64; 2] = [64, 8192];

/// Maximum number of mutations per independent sample. If more are wanted, each carries more energy instead.
const MAX_MUTATIONS_PER_SAMPLE: f64 = 8.0;

/// Probability that a small step resamples the technique. Otherwise the technique is kept: neighbouring
/// values of this coordinate mean the same technique or unrelated paths.
const TECHNIQUE_REDRAW: f32 = 0.02;

/// The residual of a path of an independent sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Residual {
    /// The sample.
    pub sample: PixelSampler,
    /// The technique that sampled the path.
    pub technique: Technique,
    /// T: luminance of the residual in units of the importance map, over the density of the film position
    /// of `sample`.
    pub density: f64,
}

/// Mutations of the chains: small steps alone, which seldom change the technique.
pub fn mutations(small_step: impl Into<SmallStep>) -> Mutations {
    let redraw = Perturbation::Redraw {
        probability: TECHNIQUE_REDRAW,
    };
    let technique = dimensions::TECHNIQUE;
    let indices = technique.index..technique.index + 1;
    let small_step = small_step.into().with(technique.stream, indices, redraw);
    Mutations::new([(1.0, Mutation::SmallStep(small_step))])
}

/// n: mutations of each chain of a block of `samples` samples.
fn mutations_per_chain(samples: u64) -> u64 {
    let [min, max] = MUTATIONS_PER_CHAIN;
    (samples / 2).clamp(min, max)
}

/// K: mean number of chains of a block whose residuals have the sum `total`, over `samples` samples.
fn mean_chains(total: f64, samples: u64, energy: f64) -> f64 {
    let mutations = (total / energy).min(MAX_MUTATIONS_PER_SAMPLE * samples as f64);
    mutations / mutations_per_chain(samples) as f64
}

/// The chains of a render.
pub(super) struct Redistribution<'a> {
    scene: &'a Scene,
    seed: u64,
    mutations: Mutations,
    /// Splats of the chains in all complete passes.
    complete: SplatFilm,
    /// Splats of the chains in the current pass.
    current: SplatFilm,
    /// Independent samples of the complete passes.
    complete_samples: u64,
    /// Independent samples of the current pass.
    current_samples: u64,
    /// Blocks redistributed.
    blocks: u64,
    /// Memory for the splats of the chains of a block.
    logs: Vec<SplatLog>,
    /// Rays of the chains.
    pub rays: RayCounts,
    /// Chains started.
    pub chains: u64,
    /// Their counters.
    pub counters: ChainCounters,
}

impl<'a> Redistribution<'a> {
    /// Without chains so far.
    pub fn new(scene: &'a Scene, seed: u64, small_step: Perturbation) -> Self {
        let film = &scene.film;
        let film = SplatFilm::new(film.width, film.height, film.filter);
        Self {
            scene,
            seed,
            mutations: mutations(small_step),
            complete: film.clone(),
            current: film,
            complete_samples: 0,
            current_samples: 0,
            blocks: 0,
            logs: Vec::new(),
            rays: RayCounts::default(),
            chains: 0,
            counters: ChainCounters::default(),
        }
    }

    /// Redistributes the residuals that a block of `samples` samples has found.
    pub fn run(
        &mut self,
        clamp: &Clamp,
        mut residuals: Vec<Residual>,
        samples: u64,
        non_finite: &mut NonFinite,
    ) {
        // Resample starts in proportion to the densities, ordered by path length.
        residuals.sort_by_key(|residual| residual.technique.edges());
        if planted(Fault::LengthShares) {
            residuals.iter_mut().for_each(|residual| {
                residual.density *= residual.technique.edges() as f64 / 3.0;
            });
        }
        let densities: Vec<f64> = residuals.iter().map(|residual| residual.density).collect();
        let total: f64 = densities.iter().sum();
        let chains = mean_chains(total, samples, clamp.energy);
        let mutations = mutations_per_chain(samples);
        let mut rng = self.generator(0);
        let rounded = (chains + rng.random::<f64>()).floor() as usize;
        let mut starts = systematic_resample(&densities, rounded, rng.random());
        if planted(Fault::ResampledUniformly) {
            starts = (0..starts.len())
                .map(|i| i * residuals.len() / starts.len())
                .collect();
        }
        let mut weight = total / (chains * mutations as f64);
        if planted(Fault::ChainWeightOff) {
            weight *= 2.0;
        }

        // Run them in parallel.
        let mut logs = std::mem::take(&mut self.logs);
        logs.truncate(starts.len());
        logs.resize_with(starts.len(), SplatLog::new);
        let shared = &*self;
        let run = |(i, (&start, log)): (usize, (&usize, &mut SplatLog))| {
            log.clear();
            let rng = shared.generator(i as u64 + 1);
            shared.chain(clamp, residuals[start], rng, mutations, weight, log)
        };
        let work = starts.par_iter().zip(logs.par_iter_mut()).enumerate();
        let done: Vec<(ChainCounters, RayCounts)> = work.map(run).collect();

        // Add their splats to the film.
        for (counters, rays) in &done {
            self.chains += 1;
            self.counters.merge(counters);
            self.rays += *rays;
            non_finite.extend(counters.non_finite, std::iter::empty());
        }
        self.current.apply(&logs.iter().collect::<Vec<_>>());
        self.logs = logs;
        self.current_samples += samples;
        self.blocks += 1;
    }

    /// Completes a pass: every pixel has one more sample.
    pub fn end_pass(&mut self) {
        self.complete.take(&mut self.current);
        self.complete_samples += std::mem::take(&mut self.current_samples);
    }

    /// The estimate of the residual at a pixel, from all complete passes. The current pass is used only if
    /// there are none, because its chains start in a part of the image only.
    pub fn value(&self, pixel: usize) -> [f64; 3] {
        let (film, samples) = if self.complete_samples > 0 {
            (&self.complete, self.complete_samples)
        } else {
            (&self.current, self.current_samples)
        };
        film.sum(pixel).map(|sum| sum / samples.max(1) as f64)
    }

    /// A generator of this block: index 0 for the choice of starts, i + 1 for chain i.
    fn generator(&self, index: u64) -> Xoshiro256PlusPlus {
        let index = (self.blocks << 32) + index;
        seeds::generator(self.seed, Purpose::Redistribution, index)
    }

    /// Runs a chain from `start`. All its visits have the weight `weight`.
    fn chain(
        &self,
        clamp: &Clamp,
        start: Residual,
        mut rng: Xoshiro256PlusPlus,
        mutations: u64,
        weight: f64,
        log: &mut SplatLog,
    ) -> (ChainCounters, RayCounts) {
        let technique = start.technique;
        let mut target = MultiplexedTarget::new(self.scene, clamp, technique.edges());
        let start = WithTechnique::new(
            start.sample,
            Techniques::of(self.scene),
            technique,
            rng.random(),
        );
        let mut chain = Chain::start(&mut target, start, rng, self.mutations.clone());
        for _ in 0..mutations {
            log_sample(log, chain.step(&mut target).sample, weight);
        }
        log_sample(log, chain.current(), weight);
        (chain.counters, target.rays())
    }
}

/// Logs a sample with its accumulated weight.
#[inline]
fn log_sample(log: &mut SplatLog, sample: &Sample<SplatList>, weight: f64) {
    let visits = sample.weights.chain;
    if visits > 0.0 && sample.density > 0.0 {
        let factor = (weight * visits / sample.density) as f32;
        for Splat { position, value } in sample.contribution.iter() {
            log.push(Splat {
                position,
                value: saturated(value * factor),
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The length of a chain does not depend on what the block has found.
    #[test]
    fn mutations_have_the_wanted_energy_within_limits() {
        assert_eq!(
            [10, 4096, 1 << 16].map(mutations_per_chain),
            [64, 2048, 8192]
        );
        assert_eq!(mean_chains(0.0, 100, 1.0), 0.0);
        assert_eq!(mean_chains(16.0, 100, 1.0), 0.25);
        assert_eq!(mean_chains(1e6, 1 << 16, 1.0), 64.0);
        assert_eq!(mean_chains(81_920.0, 1 << 16, 1.0), 10.0);
    }
}
