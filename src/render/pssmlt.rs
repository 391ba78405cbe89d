//! Primary sample space Metropolis light transport (Kelemen et al. 2002): points of the hypercube are the
//! states of Markov chains.
//!
//! With M mutations in all, chain weights c and large-step weights l of every sample (see
//! [`crate::markov::chain`]), and b_0 the estimate of b from the bootstrap, the image is
//!
//!   (1/M) sum F(u) (c b/b_0 + l) / (I(u)/b_0 + p).
//!
//! For b = b_0 this is Kelemen's estimator (Kelemen et al. 2002, section 4). For any fixed b_0 > 0 it
//! is unbiased if b is: E[c-part] = (1/b) int F I / (I/b_0 + p), E[l-part] = p int F / (I/b_0 + p),
//! and with the factor b/b_0 on the first the two sum to int F. So b is refined by all large steps until
//! the end; the sums with c and with l are kept in two films.

use std::time::Instant;

use rayon::prelude::*;

use super::bootstrap::bootstrap;
use super::clock::Clock;
use super::driver::{Driver, drive};
use super::error::{ErrorEstimate, GroupWork, Groups};
use super::target::SplatTarget;
use super::{
    NonFinite, Observer, PssmltSettings, PssmltStatistics, Rendering, SampleId, Settings,
    Statistics, pixel_count, warnings,
};
use crate::film::{Image, Splat, SplatFilm, SplatLog};
use crate::integrators::{PathSampler, SplatList};
use crate::markov::{Bootstrap, Chain, KelemenWeights, Mutations, Sample, Weights};
use crate::math::color::{saturated, to_pixel};
use crate::sampling::seeds;
use crate::scene::{RayCounts, Scene};
use crate::statistics::Moments;

/// Maximum number of mutations of a chain in one batch.
const BATCH: u64 = 256;

/// Mutations between two checks of the clock.
const BLOCK: u64 = 1 << 16;

/// Minimum number of batches run in parallel, if there are as many chains.
const MIN_WORKERS: u64 = 64;

/// Renders the paths of `path_sampler` by Markov chains.
pub(super) fn render<P: PathSampler + Copy + Send>(
    scene: &Scene,
    path_sampler: P,
    settings: &Settings,
    method_settings: &PssmltSettings,
    observer: &dyn Observer,
) -> Rendering {
    let start = Instant::now();
    let pixels = pixel_count(scene);

    // Estimate b from independent samples.
    observer.phase("bootstrap");
    let target = || SplatTarget::new(scene, path_sampler);
    let (bootstrap, bootstrap_rays) =
        bootstrap(target, pixels, settings, method_settings, start, observer);

    // Start every chain at one of the samples, chosen in proportion to its density.
    observer.phase("mutating");
    let starts = bootstrap.starts(method_settings.chains as usize);
    let mutations = Mutations::kelemen(
        method_settings.large_step_probability,
        method_settings.small_step,
    );
    let generators = seeds::chain_generators(settings.seed, starts.len());
    let chains: Vec<Chain<SplatList>> = starts
        .par_iter()
        .zip(generators)
        .map(|(&start, rng)| {
            let start = bootstrap.sample(start);
            Chain::start(&mut target(), start, rng, mutations.clone())
        })
        .collect();

    // Mutate until the budget is spent or the error is small enough.
    let film = SplatFilm::new(scene.film.width, scene.film.height, scene.film.filter);
    let groups = || Groups::new(chains.len(), &film);
    let mut driver = Pssmlt {
        scene,
        path_sampler,
        groups: settings.wants_error().then(groups),
        large_step_probability: method_settings.large_step_probability,
        weights: KelemenWeights {
            b: bootstrap.moments.mean,
            large_step_probability: mutations.large_step_probability(),
        },
        bootstrap,
        bootstrap_rays,
        starts,
        chains,
        next_chain: 0,
        chain_film: film.clone(),
        large_film: film,
        workers: Vec::new(),
        done: 0,
    };
    let mut clock = Clock::new(start, settings.budget, pixels, observer);
    drive(&mut driver, settings, &mut clock, pixels)
}

/// The state of a render: the chains and their films.
struct Pssmlt<'a, P> {
    scene: &'a Scene,
    path_sampler: P,
    bootstrap: Bootstrap,
    bootstrap_rays: RayCounts,
    /// p_large, as in the settings.
    large_step_probability: f32,
    /// Kelemen's weights with b_0.
    weights: KelemenWeights,
    /// Bootstrap samples at which the chains started.
    starts: Vec<usize>,
    chains: Vec<Chain<SplatList>>,
    /// First chain of the next block.
    next_chain: usize,
    /// Splats with chain weights.
    chain_film: SplatFilm,
    /// Splats with large-step weights.
    large_film: SplatFilm,
    /// Present if the error is requested.
    groups: Option<Groups>,
    workers: Vec<Worker<'a, P>>,
    /// Mutations made by all chains.
    done: u64,
}

/// The target and the splats of one batch. Each batch has its own, so that batches run in parallel.
struct Worker<'a, P> {
    target: SplatTarget<'a, P>,
    chain_log: SplatLog,
    large_log: SplatLog,
}

impl<P> Worker<'_, P> {
    /// Logs a sample with its accumulated weight.
    #[inline]
    fn log(&mut self, weights: &KelemenWeights, sample: &Sample<SplatList>) {
        let [chain, large] = weights.factors(sample).map(|factor| factor as f32);
        if chain <= 0.0 && large <= 0.0 {
            return;
        }
        for Splat { position, value } in sample.contribution.iter() {
            for (factor, log) in [(chain, &mut self.chain_log), (large, &mut self.large_log)] {
                if factor > 0.0 {
                    let value = saturated(value * factor);
                    log.push(Splat { position, value });
                }
            }
        }
    }
}

impl<P: PathSampler + Copy + Send> Driver for Pssmlt<'_, P> {
    fn can_advance(&self) -> bool {
        !self.chains.is_empty()
    }

    fn advance(&mut self, clock: &Clock) {
        // Choose the chains of the block: many chains with short batches if need be, so that no thread is
        // idle.
        let block = clock.block(self.done, BLOCK);
        let workers = (block / BATCH).max(MIN_WORKERS);
        let batch = (block / workers).clamp(1, BATCH);
        let count = self.chains.len();
        let chains = self.next_chain..(self.next_chain + workers as usize).min(count);
        self.next_chain = chains.end % count;

        // Run a batch of mutations of each chain, in parallel.
        let total = clock.total_if_shared();
        self.in_workers(chains, |i, chain, weights, worker| {
            let made = chain.counters.steps();
            let quota = total.map_or(batch, |total| quota(total, count as u64, i) - made);
            let steps = batch.min(quota);
            for _ in 0..steps {
                let sample = chain.step(&mut worker.target).sample;
                worker.log(weights, sample);
            }
            steps
        });
    }

    fn samples(&self) -> u64 {
        self.done
    }

    fn rays(&self) -> RayCounts {
        let workers = self.workers.iter().map(|worker| worker.target.rays());
        std::iter::once(self.bootstrap_rays).chain(workers).sum()
    }

    fn image(&mut self) -> Image {
        self.flush();
        self.resolve()
    }

    /// Estimated from the spread of groups of chains.
    fn error(&self, image: &Image) -> Option<ErrorEstimate> {
        let groups = self.groups.as_ref()?;
        let group_work = |g| {
            let chains = &self.chains[groups.chains_of(g, self.chains.len())];
            let uniform = self.bootstrap.part(g, groups.len());
            GroupWork {
                mutations: chains.iter().map(|chain| chain.counters.steps()).sum(),
                uniform: chains.iter().fold(uniform, |uniform, chain| {
                    uniform.merge(&chain.counters.large_densities)
                }),
            }
        };
        let work: Vec<GroupWork> = (0..groups.len()).map(group_work).collect();
        let per_mutation = 1.0 / self.done.max(1) as f64;
        groups.estimate(image, &work, self.weights.b, |pixel| {
            self.chain_film.sum(pixel).map(|sum| sum * per_mutation)
        })
    }

    fn finish(&mut self, settings: &Settings, clock: &Clock) -> Rendering {
        let image = self.image();
        let uniform = self.uniform();
        let error = self.error(&image);
        let non_finite = self.non_finite();
        let seconds = [clock.elapsed(), clock.elapsed() - clock.began()];
        let chains = PssmltStatistics::new(
            self.large_step_probability,
            (self.bootstrap.moments.count, clock.began()),
            &uniform,
            self.chains.iter().map(|chain| &chain.counters),
        );
        let interrupted = clock.was_cancelled(self.done);
        let warnings = match (interrupted, self.done) {
            (true, 0) => Vec::new(),
            _ => warnings::non_finite(&non_finite)
                .into_iter()
                .chain(warnings::normalisation(&uniform, &self.bootstrap))
                .chain(warnings::no_mutation(self.done, self.chains.len()))
                .chain(warnings::stuck(chains.stuck_chains, chains.chains))
                .chain(warnings::error(settings, error.as_ref()))
                .chain(warnings::rare_contributions(error.as_ref()))
                .collect(),
        };
        let mut statistics = Statistics::new(
            self.scene,
            settings,
            seconds,
            self.done,
            self.rays(),
            non_finite,
        );
        statistics.pssmlt = Some(chains);
        Rendering {
            image,
            error,
            statistics,
            interrupted,
            warnings,
        }
    }

    /// Adding the weights that states have so far to the sums changes how these are rounded, so the sums are
    /// put back.
    fn result_so_far(&mut self, settings: &Settings, clock: &Clock) -> Rendering {
        let films = [self.chain_film.clone(), self.large_film.clone()];
        let groups = self.groups.clone();
        let weights: Vec<Weights> = self
            .chains
            .iter()
            .map(|chain| chain.current().weights)
            .collect();
        let result = self.finish(settings, clock);
        [self.chain_film, self.large_film] = films;
        self.groups = groups;
        for (chain, weights) in self.chains.iter_mut().zip(weights) {
            chain.put_weights(weights);
        }
        result
    }
}

impl<P: PathSampler + Copy + Send> Pssmlt<'_, P> {
    /// Adds the accumulated weight of every chain's state to the films.
    fn flush(&mut self) {
        for first in (0..self.chains.len()).step_by(BATCH as usize) {
            let chains = first..(first + BATCH as usize).min(self.chains.len());
            self.in_workers(chains, |_, chain, weights, worker| {
                worker.log(weights, chain.current());
                chain.take_weights();
                0
            });
        }
    }

    /// Calls `work` for each of `chains` in parallel, with the index of the chain and a worker, and adds the
    /// logged splats to the films in the order of the chains. `work` returns its number of mutations.
    fn in_workers(
        &mut self,
        chains: std::ops::Range<usize>,
        work: impl Fn(u64, &mut Chain<SplatList>, &KelemenWeights, &mut Worker<P>) -> u64 + Sync,
    ) {
        while self.workers.len() < chains.len() {
            self.workers.push(Worker {
                target: SplatTarget::new(self.scene, self.path_sampler),
                chain_log: SplatLog::new(),
                large_log: SplatLog::new(),
            });
        }
        let workers = &mut self.workers[..chains.len()];
        let (first, weights) = (chains.start, self.weights);
        self.done += self.chains[chains.clone()]
            .par_iter_mut()
            .zip(workers.par_iter_mut())
            .enumerate()
            .map(|(i, (chain, worker))| {
                worker.chain_log.clear();
                worker.large_log.clear();
                work((first + i) as u64, chain, &weights, worker)
            })
            .sum::<u64>();
        let workers = workers.iter();
        let logs: Vec<[&SplatLog; 2]> = workers.map(|w| [&w.chain_log, &w.large_log]).collect();
        let chain_logs: Vec<&SplatLog> = logs.iter().map(|[chain, _]| *chain).collect();
        let large_logs: Vec<&SplatLog> = logs.iter().map(|[_, large]| *large).collect();
        self.chain_film.apply(&chain_logs);
        self.large_film.apply(&large_logs);
        if let Some(groups) = &mut self.groups {
            groups.apply(self.chains.len(), chains, &logs);
        }
    }

    /// Moments of the densities of all uniform samples, whose mean is b.
    fn uniform(&self) -> Moments {
        let chains = self.chains.iter();
        chains.fold(self.bootstrap.moments, |moments, chain| {
            moments.merge(&chain.counters.large_densities)
        })
    }

    /// The image, with the current estimate of b, and b_0 in the weights.
    fn resolve(&self) -> Image {
        let per_mutation = 1.0 / self.done.max(1) as f64;
        let b_0 = self.weights.b;
        let refinement = if b_0 > 0.0 {
            self.uniform().mean / b_0
        } else {
            0.0
        };
        let [width, height] = self.chain_film.size();
        let pixel = |i| {
            let (chain, large) = (self.chain_film.sum(i), self.large_film.sum(i));
            to_pixel(std::array::from_fn(|c| {
                (chain[c] * refinement + large[c]) * per_mutation
            }))
        };
        Image {
            width,
            height,
            pixels: (0..width * height).map(pixel).collect(),
        }
    }

    /// Densities that were not finite, and their samples.
    fn non_finite(&self) -> NonFinite {
        let mut non_finite = NonFinite::default();
        for &sample in &self.bootstrap.non_finite {
            non_finite.add(1, SampleId::Bootstrap { sample });
        }
        for (i, (chain, &start)) in (0..).zip(self.chains.iter().zip(&self.starts)) {
            let id = |&step: &u64| SampleId::Mutation {
                chain: i,
                start: start as u64,
                step,
            };
            let counters = &chain.counters;
            let samples = counters.non_finite_steps.iter().map(id);
            non_finite.extend(counters.non_finite, samples);
        }
        non_finite
    }
}

/// The number of mutations of chain `i` of `chains`, out of `total`. The numbers differ by at most 1.
fn quota(total: u64, chains: u64, i: u64) -> u64 {
    total / chains + u64::from(i < total % chains)
}
