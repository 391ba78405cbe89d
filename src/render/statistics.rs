//! What a render took, as data to be written out.

use serde::Serialize;

use super::redistribution::Redistribution;
use super::{Integrator, NonFinite, Origin, Settings, warnings};
use crate::markov::ChainCounters;
use crate::scene::{RayCounts, Scene};
use crate::statistics::Moments;

/// Figures of one render.
#[derive(Clone, Debug, Serialize)]
pub struct Statistics {
    /// Which method.
    pub integrator: Integrator,
    /// As given.
    pub seed: u64,
    /// Pixels in a row and in a column.
    pub size: [u32; 2],
    /// Threads used.
    pub threads: usize,
    /// Seconds of rendering, bootstrap included.
    pub render_seconds: f64,
    /// Path samples, or mutations, that the image is made of.
    pub samples: u64,
    /// The same, per second of rendering; of Metropolis, per second after the bootstrap.
    pub samples_per_second: f64,
    /// Closest-hit queries.
    pub closest_hit_rays: u64,
    /// Occlusion queries.
    pub shadow_rays: u64,
    /// Both, per second of rendering.
    pub rays_per_second: f64,
    /// Contributions (of Metropolis: proposals) that were NaN, infinite or negative and left out.
    pub non_finite: u64,
    /// Where the first of them came from: what `metrolight replay` takes.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub non_finite_origins: Vec<Origin>,
    /// For Metropolis integrators.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub metropolis: Option<MetropolisStatistics>,
    /// For the multiplexed integrator.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub multiplexed: Option<MultiplexedStatistics>,
}

/// Figures of the Markov chains.
#[derive(Clone, Debug, Serialize)]
pub struct MetropolisStatistics {
    /// Normalisation: mean luminance of the image, from the bootstrap and all large steps.
    pub b: f64,
    /// Its standard error; `None` if there were too few samples to tell.
    pub b_standard_error: Option<f64>,
    /// Number of chains.
    pub chains: u64,
    /// Samples of the bootstrap.
    pub bootstrap_samples: u64,
    /// Seconds that it took, part of `render_seconds`.
    pub bootstrap_seconds: f64,
    /// p_large.
    pub large_step_probability: f32,
    /// Large steps.
    pub large_steps: StepStatistics,
    /// Small steps.
    pub small_steps: StepStatistics,
    /// Longest run of rejections of any chain.
    pub longest_rejection_run: u64,
    /// Chains that have been in one state for more than half of their mutations.
    pub stuck_chains: u64,
}

/// Figures of the chains beside plain sampling.
#[derive(Clone, Debug, Serialize)]
pub struct MultiplexedStatistics {
    /// How bright a path is, in units of the importance map, beyond which chains carry the excess.
    pub threshold: f32,
    /// Energy of a mutation, in units of the importance map and of one plain sample per pixel.
    pub energy_per_mutation: f64,
    /// Chains that were started.
    pub chains: u64,
    /// Their mutations.
    pub mutations: StepStatistics,
    /// Longest run of rejections of any chain.
    pub longest_rejection_run: u64,
}

impl MultiplexedStatistics {
    pub(super) fn new(chains: &Redistribution) -> Self {
        let (division, work) = (chains.division(), &chains.work);
        Self {
            threshold: division.threshold,
            energy_per_mutation: division.energy,
            chains: work.chains,
            mutations: StepStatistics::new(work.counters.small),
            longest_rejection_run: work.counters.longest_rejection_run,
        }
    }
}

/// Figures of one kind of step.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct StepStatistics {
    /// Proposals.
    pub proposed: u64,
    /// Of these accepted.
    pub accepted: u64,
    /// Their ratio; 0 if none was proposed.
    pub acceptance_rate: f64,
}

impl StepStatistics {
    fn new([proposed, accepted]: [u64; 2]) -> Self {
        let acceptance_rate = if proposed == 0 {
            0.0
        } else {
            accepted as f64 / proposed as f64
        };
        Self {
            proposed,
            accepted,
            acceptance_rate,
        }
    }
}

impl Statistics {
    pub(super) fn new(
        scene: &Scene,
        settings: &Settings,
        [render_seconds, sampling_seconds]: [f64; 2],
        samples: u64,
        rays: RayCounts,
        non_finite: NonFinite,
    ) -> Self {
        let per_second = |n: u64, seconds: f64| n as f64 / seconds.max(1e-9);
        Self {
            integrator: settings.integrator,
            seed: settings.seed,
            size: [scene.film.width, scene.film.height],
            threads: rayon::current_num_threads(),
            render_seconds,
            samples,
            samples_per_second: per_second(samples, sampling_seconds),
            closest_hit_rays: rays.closest_hit,
            shadow_rays: rays.shadow,
            rays_per_second: per_second(rays.total(), render_seconds),
            non_finite: non_finite.count,
            non_finite_origins: non_finite.origins,
            metropolis: None,
            multiplexed: None,
        }
    }
}

impl MetropolisStatistics {
    /// From the moments of I over all uniform samples and all chains' counters.
    pub(super) fn new<'a>(
        settings: &Settings,
        (bootstrap_samples, bootstrap_seconds): (u64, f64),
        uniform: &Moments,
        chains: impl Iterator<Item = &'a ChainCounters>,
    ) -> Self {
        let mut counters = ChainCounters::default();
        let (mut count, mut stuck_chains) = (0, 0);
        for chain in chains {
            counters.merge(chain);
            count += 1;
            stuck_chains += u64::from(warnings::is_stuck(chain));
        }
        let error = uniform.standard_error();
        Self {
            b: uniform.mean,
            b_standard_error: error.is_finite().then_some(error),
            chains: count,
            bootstrap_samples,
            bootstrap_seconds,
            large_step_probability: settings.large_step_probability,
            large_steps: StepStatistics::new(counters.large),
            small_steps: StepStatistics::new(counters.small),
            longest_rejection_run: counters.longest_rejection_run,
            stuck_chains,
        }
    }
}
