//! The Metropolis driver: points of the hypercube are the states of Markov chains.
//!
//! With M mutations in all, chain weights c and large-step weights l of every sample (see
//! [`crate::markov::chain`]), and b_0 the estimate of b from the bootstrap, the image is
//!
//!   (1/M) sum F(u) (c b/b_0 + l) / (I(u)/b_0 + p).
//!
//! For b = b_0 this is Kelemen's estimator (Kelemen et al. 2002, section 4). For any fixed b_0 > 0 it
//! is unbiased if b is: E[c-part] = (1/b) int F I / (I/b_0 + p), E[l-part] = p int F / (I/b_0 + p),
//! and with the factor b/b_0 on the first the two add up to int F. So b may be refined by all large
//! steps until the last moment; the sums with c and with l are kept in two films.

use std::sync::Mutex;
use std::time::Instant;

use rayon::prelude::*;

use super::clock::Clock;
use super::error::{ErrorEstimate, GroupWork, Groups, Target};
use super::seat::{LightTarget, Seat, log};
use super::warnings;
use super::{
    Budget, MetropolisStatistics, NonFinite, Observer, Origin, Rendering, Settings, Statistics,
};
use crate::film::{Image, SplatFilm, SplatLog};
use crate::integrators::Splats;
use crate::markov::{Bootstrap, BootstrapLimits, Chain, Weighing};
use crate::math::color::to_pixel;
use crate::sampling::seeds;
use crate::scene::{RayCounts, Scene};
use crate::statistics::Moments;

/// Mutations that a chain makes before the next one has its turn.
const TURN: u64 = 256;

/// Mutations between two looks at the clock.
const BLOCK: u64 = 1 << 16;

/// Chains that take their turns at once, if there are so many.
const FEWEST_SEATS: u64 = 64;

/// The bootstrap goes on until b has this relative standard error, if it may.
const BOOTSTRAP_ERROR: f64 = 0.01;

/// Bounds on the size of a bootstrap that the user left to us.
const BOOTSTRAP_SAMPLES: [u64; 2] = [1 << 17, 1 << 22];

/// Renders by Metropolis.
pub(super) fn render(scene: &Scene, settings: &Settings, observer: &dyn Observer) -> Rendering {
    let start = Instant::now();
    let mut driver = Driver::new(scene, settings);
    observer.phase("bootstrap");
    let bootstrap = driver.bootstrap(start, observer);
    observer.phase("mutating");
    driver.start_chains(&bootstrap);
    let mut clock = Clock::new(start, settings.budget, driver.pixels, observer);
    driver.mutate(&mut clock, &bootstrap);
    driver.finish(&bootstrap, &clock, observer)
}

struct Driver<'a> {
    scene: &'a Scene,
    settings: &'a Settings,
    pixels: u64,
    /// Bootstrap samples that the chains start from.
    starts: Vec<usize>,
    chains: Vec<Chain<Splats>>,
    chain_film: SplatFilm,
    large_film: SplatFilm,
    /// There if the error is wanted.
    groups: Option<Groups>,
    seats: Vec<Seat<'a>>,
    bootstrap_rays: RayCounts,
    done: u64,
}

impl<'a> Driver<'a> {
    fn new(scene: &'a Scene, settings: &'a Settings) -> Self {
        let [width, height] = [scene.film.width, scene.film.height];
        let film = SplatFilm::new(width, height, scene.film.filter);
        Self {
            scene,
            settings,
            pixels: u64::from(width) * u64::from(height),
            starts: Vec::new(),
            chains: Vec::new(),
            chain_film: film.clone(),
            large_film: film,
            groups: None,
            seats: Vec::new(),
            bootstrap_rays: RayCounts::default(),
            done: 0,
        }
    }

    fn target(&self) -> LightTarget<'a> {
        LightTarget::new(self.scene, self.settings.integrator.sampler())
    }

    fn bootstrap_limits(&self) -> BootstrapLimits {
        let [least, most] = BOOTSTRAP_SAMPLES;
        match (self.settings.bootstrap, self.settings.budget) {
            (Some(n), _) => BootstrapLimits {
                at_least: n,
                at_most: n,
                relative_error: 0.0,
            },
            (None, Budget::Seconds(_) | Budget::Unlimited) => BootstrapLimits {
                at_least: least,
                at_most: most,
                relative_error: BOOTSTRAP_ERROR,
            },
            (None, Budget::SamplesPerPixel(n)) => {
                // An eighth of the mutations, which refine b as well, but enough to start from.
                let most = (n.saturating_mul(self.pixels) / 8).clamp(least, most);
                BootstrapLimits {
                    at_least: least,
                    at_most: most,
                    relative_error: BOOTSTRAP_ERROR,
                }
            }
        }
    }

    fn bootstrap(&mut self, start: Instant, observer: &dyn Observer) -> Bootstrap {
        let limits = self.bootstrap_limits();
        // Of a budget of time the bootstrap may take a tenth, or half if its size was asked for.
        let deadline = match (self.settings.budget, self.settings.bootstrap) {
            (Budget::Seconds(seconds), None) => 0.1 * seconds,
            (Budget::Seconds(seconds), Some(_)) => 0.5 * seconds,
            (Budget::SamplesPerPixel(_) | Budget::Unlimited, _) => f64::INFINITY,
        };
        let rays = Mutex::new(RayCounts::default());
        let bootstrap = Bootstrap::run(
            self.settings.seed,
            limits,
            || self.target(),
            |target| {
                if let Ok(mut rays) = rays.lock() {
                    *rays += target.rays();
                }
            },
            |done| {
                observer.progress(done as f64 / limits.at_most as f64, None);
                done > 0 && start.elapsed().as_secs_f64() > deadline || observer.interrupted()
            },
        );
        self.bootstrap_rays += rays.into_inner().unwrap_or_default();
        bootstrap
    }

    /// Starts every chain from a bootstrap sample; none, if no sample found light.
    fn start_chains(&mut self, bootstrap: &Bootstrap) {
        self.starts = bootstrap.starts(self.settings.chains as usize);
        let generators = seeds::chain_generators(self.settings.seed, self.starts.len());
        self.chains = self
            .starts
            .par_iter()
            .zip(generators)
            .map(|(&start, generator)| {
                Chain::start(
                    &mut self.target(),
                    bootstrap.generator(start),
                    generator,
                    self.settings.large_step_probability,
                    self.settings.small_step,
                )
            })
            .collect();
    }

    /// Lets chains take turns until the budget is spent or the error is small enough, then credits
    /// every state with the weight that it has gathered.
    fn mutate(&mut self, clock: &mut Clock, bootstrap: &Bootstrap) {
        let weighing = Weighing {
            b: bootstrap.moments.mean,
            large_step_probability: f64::from(self.settings.large_step_probability),
        };
        if self.settings.wants_error() {
            self.groups = Some(Groups::new(self.chains.len(), &self.chain_film));
        }
        let mut target = Target::new(self.settings, self.pixels);
        let mut next_chain = 0;
        while !self.chains.is_empty() && !clock.is_over(self.done) {
            let block = clock.block(self.done, BLOCK);
            // Rather short turns than few chains, so that no thread waits.
            let seated = (block / TURN).max(FEWEST_SEATS);
            let turn = (block / seated).clamp(1, TURN);
            let chains = next_chain..(next_chain + seated as usize).min(self.chains.len());
            next_chain = if chains.end == self.chains.len() {
                0
            } else {
                chains.end
            };
            let total = clock.total_samples();
            self.in_seats(chains, |i, chain, chains, seat| {
                let made = chain.counters.steps();
                let steps = total.map_or(turn, |total| turn.min(quota(total, chains, i) - made));
                for _ in 0..steps {
                    let retired = chain.step(&mut seat.target);
                    log(&weighing, retired, seat);
                }
                steps
            });
            if target.is_due(self.done) {
                self.credit(&weighing);
                let image = self.develop(self.uniform(bootstrap).mean, weighing.b);
                if let Some(estimate) = self.error(&image, bootstrap) {
                    clock.note(target.look(self.done, &estimate));
                }
            }
            clock.show(self.done, self.rays().total(), || {
                self.credit(&weighing);
                self.develop(self.uniform(bootstrap).mean, weighing.b)
            });
        }
        self.credit(&weighing);
    }

    fn rays(&self) -> RayCounts {
        let seats = self.seats.iter().map(|seat| seat.target.rays());
        std::iter::once(self.bootstrap_rays).chain(seats).sum()
    }

    /// Credits every chain's state with the weight that it has gathered.
    fn credit(&mut self, weighing: &Weighing) {
        let block = TURN as usize;
        for first in (0..self.chains.len()).step_by(block) {
            let chains = first..(first + block).min(self.chains.len());
            self.in_seats(chains, |_, chain, _, seat| {
                log(weighing, chain.current(), seat);
                chain.take_weights();
                0
            });
        }
    }

    /// Gives each of `chains` a seat in which to `act`, in parallel, and adds what they log to the
    /// films, in the order of the chains. `act` is told the chain's index and the number of chains,
    /// and returns the number of mutations it made.
    fn in_seats(
        &mut self,
        chains: std::ops::Range<usize>,
        act: impl Fn(u64, &mut Chain<Splats>, u64, &mut Seat<'a>) -> u64 + Sync,
    ) {
        while self.seats.len() < chains.len() {
            self.seats.push(Seat::new(self.target()));
        }
        let seats = &mut self.seats[..chains.len()];
        let count = self.chains.len() as u64;
        let first = chains.start;
        self.done += self.chains[chains.clone()]
            .par_iter_mut()
            .zip(seats.par_iter_mut())
            .enumerate()
            .map(|(i, (chain, seat))| {
                seat.chain_log.clear();
                seat.large_log.clear();
                act((first + i) as u64, chain, count, seat)
            })
            .sum::<u64>();
        let logs: Vec<&SplatLog> = seats.iter().map(|seat| &seat.chain_log).collect();
        self.chain_film.apply(&logs);
        let logs: Vec<&SplatLog> = seats.iter().map(|seat| &seat.large_log).collect();
        self.large_film.apply(&logs);
        if let Some(groups) = &mut self.groups {
            groups.apply(self.chains.len(), chains, seats);
        }
    }

    /// Densities of all uniform samples: their mean is b.
    fn uniform(&self, bootstrap: &Bootstrap) -> Moments {
        let chains = self.chains.iter();
        chains.fold(bootstrap.moments, |moments, chain| {
            moments.merge(&chain.counters.large_densities)
        })
    }

    /// The error of `image`, if it is wanted and known.
    fn error(&self, image: &Image, bootstrap: &Bootstrap) -> Option<ErrorEstimate> {
        let groups = self.groups.as_ref()?;
        let group_work = |g| {
            let chains = &self.chains[groups.chains_of(g, self.chains.len())];
            let uniform = bootstrap.part(g, groups.len());
            GroupWork {
                mutations: chains.iter().map(|chain| chain.counters.steps()).sum(),
                uniform: chains.iter().fold(uniform, |uniform, chain| {
                    uniform.merge(&chain.counters.large_densities)
                }),
            }
        };
        let work: Vec<GroupWork> = (0..groups.len()).map(group_work).collect();
        let per_mutation = 1.0 / self.done.max(1) as f64;
        groups.estimate(image, &work, bootstrap.moments.mean, |pixel| {
            self.chain_film.sum(pixel).map(|sum| sum * per_mutation)
        })
    }

    fn finish(self, bootstrap: &Bootstrap, clock: &Clock, observer: &dyn Observer) -> Rendering {
        let uniform = self.uniform(bootstrap);
        let image = self.develop(uniform.mean, bootstrap.moments.mean);
        let error = self.error(&image, bootstrap);
        let non_finite = self.non_finite(bootstrap);
        let bootstrap_seconds = clock.began();
        let seconds = [clock.elapsed(), clock.elapsed() - bootstrap_seconds];
        let metropolis = MetropolisStatistics::new(
            self.settings,
            (bootstrap.moments.count, bootstrap_seconds),
            &uniform,
            self.chains.iter().map(|chain| &chain.counters),
        );
        let unfinished = clock.total_samples().is_none_or(|n| self.done < n);
        let interrupted = observer.interrupted() && unfinished;
        let warnings = match (interrupted, self.done) {
            (true, 0) => Vec::new(),
            _ => warnings::non_finite(&non_finite)
                .into_iter()
                .chain(warnings::normalisation(&uniform, bootstrap))
                .chain(warnings::no_mutation(self.done, self.chains.len()))
                .chain(warnings::stuck(metropolis.stuck_chains, metropolis.chains))
                .chain(warnings::error(self.settings, error.as_ref()))
                .chain(warnings::single(error.as_ref()))
                .collect(),
        };
        let mut statistics = Statistics::new(
            self.scene,
            self.settings,
            seconds,
            self.done,
            self.rays(),
            non_finite,
        );
        statistics.metropolis = Some(metropolis);
        Rendering {
            image,
            error,
            statistics,
            interrupted,
            warnings,
        }
    }

    /// What the target gave that was not finite, and where.
    fn non_finite(&self, bootstrap: &Bootstrap) -> NonFinite {
        let mut non_finite = NonFinite::default();
        for &sample in &bootstrap.non_finite {
            non_finite.add(1, Origin::Bootstrap { sample });
        }
        for (i, (chain, &start)) in (0..).zip(self.chains.iter().zip(&self.starts)) {
            let origin = |&step: &u64| Origin::Mutation {
                chain: i,
                start: start as u64,
                step,
            };
            let counters = &chain.counters;
            let origins = counters.non_finite_steps.iter().map(origin);
            non_finite.extend(counters.non_finite, origins);
        }
        non_finite
    }

    /// The image, with `b` known now and `b_0` used in the weights.
    fn develop(&self, b: f64, b_0: f64) -> Image {
        let per_mutation = 1.0 / self.done.max(1) as f64;
        let refinement = if b_0 > 0.0 { b / b_0 } else { 0.0 };
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
}

/// Mutations that chain `i` of `chains` makes of `total`: as even as whole numbers allow.
fn quota(total: u64, chains: u64, i: u64) -> u64 {
    total / chains + u64::from(i < total % chains)
}
