//! Statistics of a render, as serialisable data.

use serde::Serialize;

use super::{Method, NonFinite, SampleId, Settings, warnings};
use crate::markov::{ChainCounters, MutationCounters};
use crate::scene::{RayCounts, Scene};
use crate::statistics::Moments;

/// Statistics of one render.
#[derive(Clone, Debug, Serialize)]
pub struct Statistics {
    /// The method.
    pub integrator: Method,
    /// The seed in the settings.
    pub seed: u64,
    /// Pixels in a row and in a column.
    pub size: [u32; 2],
    /// Threads used.
    pub threads: usize,
    /// Seconds of rendering, bootstrap included.
    pub render_seconds: f64,
    /// Path samples, or mutations, in the image.
    pub samples: u64,
    /// The same, per second of rendering; for `pssmlt`, per second after the bootstrap.
    pub samples_per_second: f64,
    /// Closest-hit queries.
    pub closest_hit_rays: u64,
    /// Occlusion queries.
    pub shadow_rays: u64,
    /// Searches for the specular chains between a vertex and a point on an emitter.
    pub chain_searches: u64,
    /// Rays of both kinds, per second of rendering.
    pub rays_per_second: f64,
    /// Contributions (for chains: proposals) that were NaN, infinite or negative and left out.
    pub non_finite: u64,
    /// The first of these, for replay. Proposals of chains of `mmlt` have no [`SampleId`].
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub non_finite_samples: Vec<SampleId>,
    /// Of the chains of `pssmlt`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pssmlt: Option<PssmltStatistics>,
    /// Of the chains of `mmlt`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mmlt: Option<MmltStatistics>,
}

/// Statistics of the Markov chains of `pssmlt`.
#[derive(Clone, Debug, Serialize)]
pub struct PssmltStatistics {
    /// Normalisation: mean luminance of the image, from the bootstrap and all large steps.
    pub b: f64,
    /// Its standard error; `None` if there were too few samples to estimate it.
    pub b_standard_error: Option<f64>,
    /// Number of chains.
    pub chains: u64,
    /// Samples of the bootstrap.
    pub bootstrap_samples: u64,
    /// Seconds of the bootstrap, included in `render_seconds`.
    pub bootstrap_seconds: f64,
    /// p_large.
    pub large_step_probability: f32,
    /// By kind of mutation.
    pub mutations: Vec<MutationStatistics>,
    /// Longest run of rejections of any chain.
    pub longest_rejection_run: u64,
    /// Chains that have been in one state for more than half of their mutations.
    pub stuck_chains: u64,
}

/// Statistics of the Markov chains of `mmlt`.
#[derive(Clone, Debug, Serialize)]
pub struct MmltStatistics {
    /// Samples of the pilot.
    pub pilot_samples: u64,
    /// Luminance of a path, in units of the importance map, beyond which chains carry the residual.
    pub threshold: f32,
    /// Energy of a mutation, in units of the importance map and of one independent sample per pixel.
    pub energy_per_mutation: f64,
    /// Chains that were started.
    pub chains: u64,
    /// By kind of mutation.
    pub mutations: Vec<MutationStatistics>,
    /// Longest run of rejections of any chain.
    pub longest_rejection_run: u64,
}

/// Statistics of one kind of mutation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MutationStatistics {
    /// The kind.
    pub name: &'static str,
    /// Proposals.
    pub proposed: u64,
    /// Accepted proposals.
    pub accepted: u64,
    /// `accepted` over `proposed`; 0 if none was proposed.
    pub acceptance_rate: f64,
}

impl From<&MutationCounters> for MutationStatistics {
    fn from(counters: &MutationCounters) -> Self {
        let &MutationCounters {
            name,
            proposed,
            accepted,
        } = counters;
        Self {
            name,
            proposed,
            accepted,
            acceptance_rate: accepted as f64 / proposed.max(1) as f64,
        }
    }
}

impl MutationStatistics {
    /// Statistics of all kinds of mutations of a chain.
    pub(super) fn all(counters: &ChainCounters) -> Vec<Self> {
        counters.mutations.iter().map(Self::from).collect()
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
            integrator: settings.method(),
            seed: settings.seed,
            size: [scene.film.width, scene.film.height],
            threads: rayon::current_num_threads(),
            render_seconds,
            samples,
            samples_per_second: per_second(samples, sampling_seconds),
            closest_hit_rays: rays.closest_hit,
            shadow_rays: rays.shadow,
            chain_searches: rays.chain_searches,
            rays_per_second: per_second(rays.total(), render_seconds),
            non_finite: non_finite.count,
            non_finite_samples: non_finite.samples,
            pssmlt: None,
            mmlt: None,
        }
    }
}

impl PssmltStatistics {
    /// From the moments of I over all uniform samples, and the counters of all chains.
    pub(super) fn new<'a>(
        large_step_probability: f32,
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
            large_step_probability,
            mutations: MutationStatistics::all(&counters),
            longest_rejection_run: counters.longest_rejection_run,
            stuck_chains,
        }
    }
}
