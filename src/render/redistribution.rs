//! Multiplexed Metropolis beside plain sampling: chains carry on what plain samples have found of
//! their share (after Cline et al. 2005, "Energy redistribution path tracing", with the multiplexed
//! chains of Hachisuka et al. 2014).
//!
//! N plain samples find the densities T_1, T_2, ... with sum W, so that W/N estimates b = sum b_k
//! without bias. They are resampled in proportion to T: each of n chains starts from one and makes m
//! mutations. Over all that the samples might have been, the chains are in equilibrium from their first
//! state on, so that
//!
//!   (W/N) (1/(n m)) sum over all visits of F/I
//!
//! estimates the integral of F without bias, for any n and m, and even if no chain ever leaves the
//! neighbourhood of its start: there is no start-up bias, and no b that could be off (Veach and Guibas
//! 1997, section 5.1, weight their chains in the same way).
//!
//! This is done for every block of samples anew. Every sample of the render refines b_k, like the
//! large steps of other chains, and is a place from which a chain may start: so the chains need no
//! large steps of their own.
//!
//! Resampling is systematic, over the samples in the order of their path lengths: every length has
//! mutations in proportion to its b_k, but for the rounding of one chain.

use rand::RngExt;
use rayon::prelude::*;

use super::division::Division;
use super::multiplexed::MultiplexedTarget;
use super::sweep::AtPixel;
use super::{NonFinite, Settings};
use crate::film::{FilmSampler, Splat, SplatFilm, SplatLog};
use crate::integrators::{Sampler, Splats, Technique, Workspace};
use crate::markov::{
    Chain, ChainCounters, LazyPoint, Recording, Sample, SmallStep, Steps, systematic_resample,
};
use crate::math::color::{is_light, saturated};
use crate::sampling::Stream;
use crate::sampling::seeds::{self, Purpose};
use crate::scene::{RayCounts, Scene};
use crate::technique::Connection;

/// Mutations of a chain: fewest where the block has found little, and most.
const MUTATIONS: [f64; 2] = [64.0, 8192.0];

/// Mutations per plain sample at most: beyond that each carries more energy.
const MOST_PER_SAMPLE: f64 = 8.0;

/// Probability with which a step draws the choice of technique anew, else it stays: neighbouring values
/// have nothing in common but where they mean the same technique.
const TECHNIQUE: f32 = 0.02;

/// What a plain sample has found of the chains' share.
#[derive(Clone, Debug)]
pub struct Excess {
    /// The sample.
    point: AtPixel,
    /// The technique that found it.
    technique: Technique,
    /// T, over the density with which plain sampling places samples on the film.
    density: f64,
}

/// What the chains have done.
#[derive(Clone, Debug, Default)]
pub struct ChainWork {
    /// Chains started.
    pub chains: u64,
    /// What happened to them.
    pub counters: ChainCounters,
}

/// The chains' side of a render.
pub struct Redistribution<'a> {
    scene: &'a Scene,
    division: Division,
    seed: u64,
    steps: Steps,
    sampler: FilmSampler,
    /// What the block has found, and the number of its samples.
    found: Vec<Excess>,
    samples: u64,
    /// What the chains have splatted: for all whole passes, and for the one that is going on.
    whole: SplatFilm,
    open: SplatFilm,
    /// Plain samples of the passes of either.
    whole_samples: u64,
    open_samples: u64,
    /// Blocks redistributed.
    blocks: u64,
    logs: Vec<SplatLog>,
    rays: RayCounts,
    /// What the chains have done so far.
    pub work: ChainWork,
}

impl<'a> Redistribution<'a> {
    /// For the chains' share of `scene` under `division`.
    pub fn new(scene: &'a Scene, division: Division, settings: &Settings) -> Self {
        let film = &scene.film;
        let technique = SmallStep::Redraw {
            probability: TECHNIQUE,
        };
        Self {
            scene,
            division,
            seed: settings.seed,
            steps: Steps::from(settings.small_step).with(Stream::Technique, 0..1, technique),
            sampler: FilmSampler::new(film.width, film.height, film.filter),
            found: Vec::new(),
            samples: 0,
            whole: SplatFilm::new(film.width, film.height, film.filter),
            open: SplatFilm::new(film.width, film.height, film.filter),
            whole_samples: 0,
            open_samples: 0,
            blocks: 0,
            logs: Vec::new(),
            rays: RayCounts::default(),
            work: ChainWork::default(),
        }
    }

    /// How the light is divided.
    pub fn division(&self) -> &Division {
        &self.division
    }

    /// Takes the plain sample `point`: its share into `splats`, which are cleared first, and appends what
    /// is left to the chains to `excess`.
    #[inline]
    pub fn sample(
        &self,
        point: &mut AtPixel,
        workspace: &mut Workspace,
        splats: &mut Splats,
        excess: &mut Vec<Excess>,
    ) {
        splats.clear();
        let start = point.clone();
        let sampler = Sampler::Bidirectional;
        let film = sampler.film_position(point);
        splats.film = film;
        let visit = |technique: Technique, connection: Connection| {
            let value = connection.contribution();
            let position = connection.position(film).to_array();
            let edges = technique.edges();
            let plain = self.division.plain_share(edges, value, position);
            splats.add(connection.film, value * plain);
            if plain < 1.0 && is_light(value) {
                let excess_value = value * (1.0 - plain);
                let density = f64::from(self.division.brightness(excess_value, position));
                excess.push(Excess {
                    point: start.clone(),
                    technique,
                    density: density / self.sampler.density(film.to_array()),
                });
            }
        };
        sampler.connections(self.scene, film, point, workspace, visit);
    }

    /// Takes note of what `samples` samples of a block have left to the chains.
    pub fn collect(&mut self, excess: &[Excess], samples: u64) {
        self.found.extend_from_slice(excess);
        self.samples += samples;
    }

    /// Lets chains carry on what the block has found.
    pub fn run(&mut self, non_finite: &mut NonFinite) {
        self.found.sort_by_key(|excess| excess.technique.edges());
        let densities: Vec<f64> = self.found.iter().map(|excess| excess.density).collect();
        let total: f64 = densities.iter().sum();
        let [fewest, most] = MUTATIONS;
        let wanted = (total / self.division.energy).min(MOST_PER_SAMPLE * self.samples as f64);
        let mutations = wanted.clamp(fewest, most) as u64;
        let chains = (wanted / mutations as f64).ceil() as usize;
        let mut rng = self.generator(0);
        let starts = systematic_resample(&densities, chains, rng.random());
        let weight = total / (starts.len() as u64 * mutations) as f64;

        self.logs.truncate(starts.len());
        self.logs.resize_with(starts.len(), SplatLog::new);
        let mut logs = std::mem::take(&mut self.logs);
        let shared = &*self;
        let run = |(i, (&start, log)): (usize, (&usize, &mut SplatLog))| {
            log.clear();
            let rng = shared.generator(i as u64 + 1);
            let point = LazyPoint::new(rng, shared.steps.clone());
            shared.chain(&shared.found[start], point, mutations, weight, log)
        };
        let work = starts.par_iter().zip(logs.par_iter_mut()).enumerate();
        let done: Vec<(ChainCounters, RayCounts)> = work.map(run).collect();
        for (counters, rays) in &done {
            self.work.chains += 1;
            self.work.counters.merge(counters);
            self.rays += *rays;
            non_finite.extend(counters.non_finite, std::iter::empty());
        }
        self.open.apply(&logs.iter().collect::<Vec<_>>());
        self.logs = logs;
        self.found.clear();
        self.open_samples += std::mem::take(&mut self.samples);
        self.blocks += 1;
    }

    /// Every pixel has been sampled once more.
    pub fn end_pass(&mut self) {
        self.whole.take(&mut self.open);
        self.whole_samples += std::mem::take(&mut self.open_samples);
    }

    /// What the chains have brought to a pixel of the image. Chains of a pass that has not sampled all
    /// pixels start in a part of the image only: unless there is no other, such a pass does not count.
    pub fn value(&self, pixel: usize) -> [f64; 3] {
        let (film, samples) = if self.whole_samples > 0 {
            (&self.whole, self.whole_samples)
        } else {
            (&self.open, self.open_samples)
        };
        film.sum(pixel).map(|sum| sum / samples.max(1) as f64)
    }

    /// A generator of this block: 0 for the choice of starts, the others for its chains.
    fn generator(&self, index: u64) -> rand_xoshiro::Xoshiro256PlusPlus {
        let index = (self.blocks << 32) + index;
        seeds::generator(self.seed, Purpose::Redistribution, index)
    }

    /// A chain from `start` on, all of whose visits count `weight`.
    fn chain(
        &self,
        start: &Excess,
        mut point: LazyPoint,
        mutations: u64,
        weight: f64,
        log: &mut SplatLog,
    ) -> (ChainCounters, RayCounts) {
        let edges = start.technique.edges();
        let mut target = MultiplexedTarget::new(self.scene, &self.division, edges);
        let choice = target.choice(start.technique.s, point.rng().random());
        target.read_all(&mut Recording::new(start.point.clone(), &mut point));
        point.set(Stream::Technique, 0, &[choice]);
        let mut chain = Chain::start_at(&mut target, point, 0.0);
        for _ in 0..mutations {
            visit(log, chain.step(&mut target), weight);
        }
        visit(log, chain.current(), weight);
        (chain.counters, target.rays())
    }

    /// Rays that the chains have traced so far.
    pub fn rays(&self) -> RayCounts {
        self.rays
    }
}

/// Logs a sample with the weight that it has gathered.
#[inline]
fn visit(log: &mut SplatLog, sample: &Sample<Splats>, weight: f64) {
    let visits = sample.weights.chain;
    if visits > 0.0 && sample.density > 0.0 {
        let Splats { film, camera, .. } = sample.contribution;
        log.push(Splat {
            position: film.to_array(),
            value: saturated(camera * (weight * visits / sample.density) as f32),
        });
    }
}
