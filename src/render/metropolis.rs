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
use super::{Budget, MetropolisStatistics, Observer, Rendering, Settings, Statistics};
use crate::film::{Film, Image, Splat, SplatLog};
use crate::integrators::{Sampler, Splats, Workspace};
use crate::markov::{Bootstrap, BootstrapLimits, Chain, ChainCounters, Sample, SmallStep, Target};
use crate::math::{Coordinates, seeds};
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

/// The image is as uncertain in overall brightness as b: beyond this the user is told.
const WORTH_A_WARNING: f64 = 0.02;

/// A path sampler as the target of Markov chains: I(u) is the luminance of all splats.
pub struct LightTarget<'a> {
    scene: &'a Scene,
    sampler: Sampler,
    workspace: Workspace,
}

impl<'a> LightTarget<'a> {
    /// The light of `scene` as `sampler` finds it.
    pub fn new(scene: &'a Scene, sampler: Sampler) -> Self {
        Self {
            scene,
            sampler,
            workspace: Workspace::default(),
        }
    }
}

impl Target for LightTarget<'_> {
    type Contribution = Splats;

    #[inline]
    fn evaluate<C: Coordinates>(&mut self, point: &mut C, out: &mut Splats) -> f64 {
        self.sampler
            .sample(self.scene, point, &mut self.workspace, out);
        out.luminance()
    }
}

/// What one chain does in one turn, kept apart so that turns can be taken in parallel.
struct Seat<'a> {
    target: LightTarget<'a>,
    /// Splats with chain weights, and with large-step weights.
    chain_log: SplatLog,
    large_log: SplatLog,
}

/// Renders by Metropolis.
pub(super) fn render(scene: &Scene, settings: &Settings, observer: &dyn Observer) -> Rendering {
    let start = Instant::now();
    let mut driver = Driver::new(scene, settings);
    observer.phase("bootstrap");
    let bootstrap = driver.bootstrap(start, observer);
    observer.phase("mutating");
    driver.start_chains(&bootstrap);
    let clock = Clock::new(start, settings.budget, driver.pixels, observer);
    driver.mutate(&clock, &bootstrap);
    driver.finish(&bootstrap, &clock, observer)
}

struct Driver<'a> {
    scene: &'a Scene,
    settings: &'a Settings,
    pixels: u64,
    chains: Vec<Chain<Splats>>,
    chain_film: Film,
    large_film: Film,
    rays: RayCounts,
    done: u64,
}

impl<'a> Driver<'a> {
    fn new(scene: &'a Scene, settings: &'a Settings) -> Self {
        let [width, height] = [scene.film.width, scene.film.height];
        let film = Film::new(width, height, scene.film.filter);
        Self {
            scene,
            settings,
            pixels: u64::from(width) * u64::from(height),
            chains: Vec::new(),
            chain_film: film.clone(),
            large_film: film,
            rays: RayCounts::default(),
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
            (None, Budget::Seconds(_)) => BootstrapLimits {
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
            (Budget::SamplesPerPixel(_), _) => f64::INFINITY,
        };
        let rays = Mutex::new(RayCounts::default());
        let bootstrap = Bootstrap::run(
            self.settings.seed,
            limits,
            || self.target(),
            |target| {
                if let Ok(mut rays) = rays.lock() {
                    *rays += target.workspace.rays;
                }
            },
            |done| {
                observer.progress(done as f64 / limits.at_most as f64, None);
                done > 0 && start.elapsed().as_secs_f64() > deadline || observer.interrupted()
            },
        );
        self.rays += rays.into_inner().unwrap_or_default();
        bootstrap
    }

    /// Starts every chain from a bootstrap sample; none, if no sample found light.
    fn start_chains(&mut self, bootstrap: &Bootstrap) {
        let starts = bootstrap.starts(self.settings.chains as usize);
        let generators = seeds::chain_generators(self.settings.seed, starts.len());
        self.chains = starts
            .into_par_iter()
            .zip(generators)
            .map(|(start, generator)| {
                Chain::start(
                    &mut self.target(),
                    bootstrap.generator(start),
                    generator,
                    self.settings.large_step_probability,
                    SmallStep::default(),
                )
            })
            .collect();
    }

    /// Lets chains take turns until the budget is spent, then credits every state with the weight
    /// that it has gathered.
    fn mutate(&mut self, clock: &Clock, bootstrap: &Bootstrap) {
        let weighing = Weighing {
            b: bootstrap.moments.mean,
            large_step_probability: f64::from(self.settings.large_step_probability),
        };
        let mut seats: Vec<Seat> = Vec::new();
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
            self.in_seats(chains, &mut seats, |i, chain, chains, seat| {
                let made = chain.counters.large[0] + chain.counters.small[0];
                let steps = total.map_or(turn, |total| turn.min(quota(total, chains, i) - made));
                for _ in 0..steps {
                    let retired = chain.step(&mut seat.target);
                    weighing.log(retired, seat);
                }
                steps
            });
        }
        let block = TURN as usize;
        for first in (0..self.chains.len()).step_by(block) {
            let chains = first..(first + block).min(self.chains.len());
            self.in_seats(chains, &mut seats, |_, chain, _, seat| {
                weighing.log(chain.current(), seat);
                chain.take_weights();
                0
            });
        }
        self.rays += seats
            .iter()
            .map(|seat| seat.target.workspace.rays)
            .sum::<RayCounts>();
    }

    /// Gives each of `chains` a seat in which to `act`, in parallel, and adds what they log to the
    /// films, in the order of the chains. `act` is told the chain's index and the number of chains,
    /// and returns the number of mutations it made.
    fn in_seats(
        &mut self,
        chains: std::ops::Range<usize>,
        seats: &mut Vec<Seat<'a>>,
        act: impl Fn(u64, &mut Chain<Splats>, u64, &mut Seat<'a>) -> u64 + Sync,
    ) {
        while seats.len() < chains.len() {
            seats.push(Seat {
                target: self.target(),
                chain_log: SplatLog::new(),
                large_log: SplatLog::new(),
            });
        }
        let seats = &mut seats[..chains.len()];
        let count = self.chains.len() as u64;
        let first = chains.start;
        self.done += self.chains[chains]
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
    }

    fn finish(self, bootstrap: &Bootstrap, clock: &Clock, observer: &dyn Observer) -> Rendering {
        let mut counters = ChainCounters::default();
        self.chains
            .iter()
            .for_each(|chain| counters.merge(&chain.counters));
        let uniform = bootstrap.moments.merge(&counters.large_densities);
        let image = self.develop(uniform.mean, bootstrap.moments.mean);
        let bootstrap_seconds = clock.began();
        let seconds = [clock.elapsed(), clock.elapsed() - bootstrap_seconds];
        let non_finite = bootstrap.non_finite + counters.non_finite;
        let metropolis = MetropolisStatistics::new(
            self.settings,
            self.chains.len() as u64,
            (bootstrap.moments.count, bootstrap_seconds),
            &uniform,
            &counters,
        );
        let mut statistics = Statistics::new(
            self.scene,
            self.settings,
            seconds,
            self.done,
            self.rays,
            non_finite,
        );
        statistics.metropolis = Some(metropolis);
        let unfinished = clock.total_samples().is_none_or(|n| self.done < n);
        let interrupted = observer.interrupted() && unfinished;
        let warnings = match (interrupted, self.done) {
            (true, 0) => Vec::new(),
            _ => warnings(&uniform, bootstrap, non_finite),
        };
        Rendering {
            image,
            statistics,
            interrupted,
            warnings,
        }
    }

    /// The image, with `b` known now and `b_0` used in the weights.
    fn develop(&self, b: f64, b_0: f64) -> Image {
        let per_mutation = 1.0 / self.done.max(1) as f64;
        let refinement = if b_0 > 0.0 { b / b_0 } else { 0.0 };
        let mut image = self.chain_film.develop(per_mutation * refinement);
        let large = self.large_film.develop(per_mutation);
        for (pixel, more) in image.pixels.iter_mut().zip(&large.pixels) {
            *pixel = std::array::from_fn(|c| pixel[c] + more[c]);
        }
        image
    }
}

/// Mutations that chain `i` of `chains` makes of `total`: as even as whole numbers allow.
fn quota(total: u64, chains: u64, i: u64) -> u64 {
    total / chains + u64::from(i < total % chains)
}

/// The denominator of the weights.
#[derive(Clone, Copy)]
struct Weighing {
    /// b_0.
    b: f64,
    /// p.
    large_step_probability: f64,
}

impl Weighing {
    /// Logs a sample with the weight that it has gathered.
    #[inline]
    fn log(&self, sample: &Sample<Splats>, seat: &mut Seat) {
        if !sample.density.is_finite() || sample.density <= 0.0 {
            return;
        }
        let per_weight = 1.0 / (sample.density / self.b + self.large_step_probability);
        let chain = (sample.weights.chain * per_weight) as f32;
        let large = (sample.weights.large * per_weight) as f32;
        for Splat { position, value } in sample.contribution.iter() {
            if chain > 0.0 {
                seat.chain_log.push(Splat {
                    position,
                    value: value * chain,
                });
            }
            if large > 0.0 {
                seat.large_log.push(Splat {
                    position,
                    value: value * large,
                });
            }
        }
    }
}

/// What the user should know about the image.
fn warnings(uniform: &Moments, bootstrap: &Bootstrap, non_finite: u64) -> Vec<String> {
    let mut warnings: Vec<String> = super::non_finite_warning(non_finite).into_iter().collect();
    let relative_error = uniform.standard_error() / uniform.mean;
    if bootstrap.moments.mean <= 0.0 {
        warnings.push(format!(
            "none of {} bootstrap samples found light: the image is black. If the scene is not \
             meant to be black, give more samples with --bootstrap",
            bootstrap.moments.count
        ));
    } else if !relative_error.is_finite() {
        warnings.push(
            "b is not known, and neither is the brightness of the image: give more samples with \
             --bootstrap"
                .into(),
        );
    } else if relative_error > WORTH_A_WARNING {
        warnings.push(format!(
            "b is known to {:.1}% only (one standard error), and so is the brightness of the \
             image: render for longer, or give more samples with --bootstrap",
            100.0 * relative_error
        ));
    }
    warnings
}
