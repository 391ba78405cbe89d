//! The chains of multiplexed Metropolis in a scene, and their starts.
//!
//! A chain of `mmlt` stays at one path length. To test the chains of all lengths together, the length is
//! one more coordinate of the state, which no mutation changes. Length k is chosen with a probability q_k
//! proportional to an estimate of b_k from independent samples, and the density is I_k / q_k.
//!
//! Three tests are specific to this method. The clamped part and the residual of every path must sum to the
//! path. The chains that redistribute the residuals of independent samples, as in a render, must estimate
//! the same light as these residuals. And the independent estimate that all other tests use is the residual
//! found by bidirectional path tracing, not by single techniques.

use rayon::prelude::*;

use super::DiagnoseError;
use super::check::{Check, Family};
use super::normalisation::MIN_EFFECTIVE;
use super::observation::{ChainTarget, IndependentEstimate, Observation, TILES};
use super::paths::{Brightest, ObservedSampler, light_of_tiles, set_film, tile};
use crate::film::Splat;
use crate::integrators::{BidirectionalPathTracer, PathSampler, SplatList, Workspace};
use crate::markov::{Mutations, Perturbation, SmallStep, Target, bootstrap};
use crate::math::luminance;
use crate::render::MmltSettings;
use crate::render::Plan;
use crate::render::mmlt;
use crate::render::mmlt::target::MultiplexedTarget;
use crate::sampling::{Dimension, Sampler, Stream};
use crate::scene::Scene;
use crate::statistics::{Moments, holm, welch};

/// The coordinate that chooses the length.
const LENGTH: Dimension = Dimension::new(Stream::Technique, 1);

/// Independent samples of one task.
const TASK: u64 = 1 << 12;

/// Maximum relative error of the sum of clamped part and residual: a few rounding errors.
const ROUNDING: f32 = 1e-5;

/// Number of quadrants of the image.
const QUADRANTS: usize = 4;

/// The quadrant of a tile.
fn quadrant(tile: usize) -> usize {
    let half = |i: usize| usize::from(i >= TILES / 2);
    2 * half(tile / TILES) + half(tile % TILES)
}

/// Numbers of samples of the tests that are specific to `mmlt`.
#[derive(Clone, Copy, Debug)]
pub struct MmltSamples {
    /// Independent samples for the estimates of b_k, and as many for the independent estimate.
    pub independent: u64,
    /// Number of independent renders of the residual.
    pub renders: u64,
    /// Passes of each render.
    pub passes: u64,
}

impl Default for MmltSamples {
    fn default() -> Self {
        Self {
            independent: 1 << 21,
            renders: 64,
            passes: 4,
        }
    }
}

/// The chains of `mmlt`.
pub struct MmltChains<'a> {
    scene: &'a Scene,
    settings: MmltSettings,
    plan: Plan,
    samples: MmltSamples,
    /// All path lengths with a residual.
    lengths: Vec<Length>,
}

/// A path length k that chains may have.
#[derive(Clone, Copy, Debug)]
struct Length {
    /// k.
    edges: usize,
    /// q_k.
    probability: f64,
    /// Upper end of its interval within [0, 1]: the sum of q_j for j <= k.
    end: f64,
}

impl<'a> MmltChains<'a> {
    /// The chains of a render of `scene`, whose film is replaced by a small one with a box filter.
    ///
    /// # Errors
    /// If no path is bright enough for chains.
    pub fn new(
        scene: &'a mut Scene,
        settings: MmltSettings,
        seed: u64,
        samples: MmltSamples,
    ) -> Result<Self, DiagnoseError> {
        set_film(scene);
        let plan = Plan::new(scene, seed, &settings, || false);
        // Whole tasks, and two at least, whose spread is the error.
        let samples = MmltSamples {
            independent: samples.independent.next_multiple_of(TASK).max(2 * TASK),
            ..samples
        };
        let mut chains = Self {
            scene,
            settings,
            plan,
            samples,
            lengths: Vec::new(),
        };
        chains.lengths = chains.lengths(seed);
        if chains.lengths.is_empty() {
            return Err(DiagnoseError::NoResidual(samples.independent));
        }
        Ok(chains)
    }

    /// Estimates b_k, and from it q_k.
    fn lengths(&self, seed: u64) -> Vec<Length> {
        let by_length = self.residuals(seed, |energies: &mut Vec<f64>, edges, _, density| {
            if energies.len() <= edges {
                energies.resize(edges + 1, 0.0);
            }
            energies[edges] += density;
        });
        let longest = by_length.iter().map(Vec::len).max().unwrap_or(0);
        let energy = |k: usize| by_length.iter().filter_map(|e| e.get(k)).sum::<f64>();
        let energies: Vec<f64> = (0..longest).map(energy).collect();
        let total: f64 = energies.iter().sum();
        let mut end = 0.0;
        let mut lengths = Vec::new();
        for (edges, energy) in energies.into_iter().enumerate() {
            if energy > 0.0 {
                let probability = energy / total;
                end += probability;
                lengths.push(Length {
                    edges,
                    probability,
                    end,
                });
            }
        }
        lengths
    }

    /// Calls `add` with the residual of every path of the independent samples, its number of edges and its
    /// density. Returns one sum for each task. Lengths without chains are left out, once they are known.
    fn residuals<T: Default + Send>(
        &self,
        seed: u64,
        add: impl Fn(&mut T, usize, Splat, f64) + Sync,
    ) -> Vec<T> {
        let clamp = &self.plan.clamp;
        let task = |task: u64| {
            let mut sum = T::default();
            let mut workspace = Workspace::default();
            for i in task * TASK..(task + 1) * TASK {
                let mut sampler = bootstrap::sample(seed, i);
                let workspace = &mut workspace;
                BidirectionalPathTracer.sample_paths(self.scene, &mut sampler, workspace, |path| {
                    let edges = path.technique.edges();
                    let [_, residual] = clamp.split(edges, path.splat());
                    let has_chains =
                        self.lengths.is_empty() || self.lengths.iter().any(|l| l.edges == edges);
                    if let Some(density) = clamp.residual_density(residual)
                        && has_chains
                    {
                        add(&mut sum, edges, residual, density);
                    }
                });
            }
            sum
        };
        let tasks = self.samples.independent / TASK;
        (0..tasks).into_par_iter().map(task).collect()
    }

    /// The clamped part and the residual of every path sum to the path.
    fn sum_of_parts(&self, seed: u64) -> Check {
        let mut worst = 0.0f32;
        let mut workspace = Workspace::default();
        for i in 0..TASK {
            let mut sampler = bootstrap::sample(seed, i);
            BidirectionalPathTracer.sample_paths(
                self.scene,
                &mut sampler,
                &mut workspace,
                |path| {
                    let splat = path.splat();
                    let [clamped, residual] = self.plan.clamp.split(path.technique.edges(), splat);
                    let whole = splat.value.max_element();
                    let off = (clamped.value + residual.value - splat.value).abs();
                    if whole > 0.0 && whole.is_finite() {
                        worst = worst.max(off.max_element() / whole);
                    }
                },
            );
        }
        // There is no random error, so the p-value is 1 or 0.
        let p_value = if worst <= ROUNDING { 1.0 } else { 0.0 };
        let name = "clamped part and residual sum to the path";
        Check::new(Family::Normalisation, name, p_value)
    }

    /// Null hypothesis: the chains of a render estimate the residual. Welch's test compares quadrants of the
    /// image between the chains of independent renders and independent samples, if both have enough samples.
    /// Quadrants are used because a render has few chains, whose light in small tiles is far from normally
    /// distributed. The p-value is the smallest of the quadrants, corrected by Holm's method.
    fn redistribution(&self, seed: u64) -> Option<Check> {
        let passes = self.samples.passes;
        let render = |i: u64| {
            let seed = crate::sampling::seeds::part(seed, i);
            let plan = self.plan.clone();
            let image = mmlt::residual_image(self.scene, &self.settings, plan, seed, passes);
            let mut quadrants = [0.0; QUADRANTS];
            for (tile, light) in light_of_tiles(&image.pixels).into_iter().enumerate() {
                quadrants[quadrant(tile)] += light;
            }
            quadrants
        };
        let chains: Vec<[f64; QUADRANTS]> = (0..self.samples.renders).map(render).collect();
        // Per task, sums of the light of independent paths and of its square, by quadrant.
        type Sums = [[f64; QUADRANTS]; 2];
        let batches: Vec<Sums> = self.residuals(seed, |[sums, squares]: &mut Sums, _, splat, _| {
            let i = quadrant(tile(splat.position));
            let light = f64::from(luminance(splat.value));
            sums[i] += light;
            squares[i] += light * light;
        });
        let p_value = |i: usize| {
            let sum: f64 = batches.iter().map(|[sums, _]| sums[i]).sum();
            let square: f64 = batches.iter().map(|[_, squares]| squares[i]).sum();
            // The starts of the chains come from this number of samples. Scale the effective number of
            // independent samples to it if it is smaller.
            let pixels = f64::from(super::paths::PIXELS).powi(2);
            let started = self.samples.renders as f64 * passes as f64 * pixels;
            let share = (started / self.samples.independent as f64).min(1.0);
            // In quadrants that few chains visit, their mean is far from normal.
            let all: f64 = chains.iter().map(|quadrants| quadrants[i]).sum();
            let squares: f64 = chains.iter().map(|quadrants| quadrants[i].powi(2)).sum();
            let is_testable = share * sum * sum > MIN_EFFECTIVE * square
                && 2.0 * all * all > chains.len() as f64 * squares;
            is_testable.then(|| {
                let means = batches.iter().map(|[sums, _]| sums[i] / TASK as f64);
                let independent: Moments = means.collect();
                let chains: Moments = chains.iter().map(|quadrants| quadrants[i]).collect();
                welch(&independent, &chains)
            })
        };
        let p_values: Vec<f64> = (0..QUADRANTS).filter_map(p_value).collect();
        let least = holm(&p_values).into_iter().fold(1.0, f64::min);
        let name = "redistributed residual and independent samples, by quadrants";
        (!p_values.is_empty()).then(|| Check::new(Family::Normalisation, name, least))
    }
}

impl ChainTarget for MmltChains<'_> {
    type Target<'t>
        = ObservedResidual<'t>
    where
        Self: 't;

    fn target(&self) -> ObservedResidual<'_> {
        let target =
            |length: &Length| MultiplexedTarget::new(self.scene, &self.plan.clamp, length.edges);
        ObservedResidual {
            lengths: &self.lengths,
            targets: self.lengths.iter().map(target).collect(),
            splats: SplatList::default(),
        }
    }

    fn mutations(&self) -> Mutations {
        let stay = Perturbation::Redraw { probability: 0.0 };
        let indices = LENGTH.index..LENGTH.index + 1;
        let small_step = SmallStep::from(self.settings.small_step);
        mmlt::mutations(small_step.with(LENGTH.stream, indices, stay))
    }

    fn independent(&self, seed: u64) -> IndependentEstimate {
        let sums = self.residuals(seed, |tiles: &mut Vec<f64>, _, splat, density| {
            tiles.resize(TILES * TILES, 0.0);
            tiles[tile(splat.position)] += density;
        });
        let mean = |tile: usize| {
            let sum: f64 = sums.iter().filter_map(|tiles| tiles.get(tile)).sum();
            sum / self.samples.independent as f64
        };
        IndependentEstimate {
            samples: self.samples.independent,
            tiles: (0..TILES * TILES).map(mean).collect(),
        }
    }

    fn starts_from_bootstrap(&self) -> bool {
        false
    }

    fn own_checks(&self, seed: u64) -> Vec<Check> {
        let sum = self.sum_of_parts(seed);
        std::iter::once(sum)
            .chain(self.redistribution(seed))
            .collect()
    }
}

/// The residuals of all path lengths as one target, with the observed quantities.
pub struct ObservedResidual<'a> {
    lengths: &'a [Length],
    targets: Vec<MultiplexedTarget<'a>>,
    splats: SplatList,
}

impl Target for ObservedResidual<'_> {
    type Contribution = Observation;

    fn evaluate<S: Sampler>(&mut self, sampler: &mut S, out: &mut Observation) -> f64 {
        // Choose the length.
        let [u] = sampler.get::<1>(LENGTH);
        let i = self.lengths.partition_point(|l| l.end <= f64::from(u));
        let i = i.min(self.lengths.len() - 1);
        let (length, target) = (self.lengths[i], &mut self.targets[i]);

        // Evaluate the target of the render.
        let mut observed = ObservedSampler::new(sampler);
        let density = target.evaluate(&mut observed, &mut self.splats) / length.probability;
        let technique = target.technique(&mut observed);
        let mut brightest = Brightest::new();
        self.splats
            .iter()
            .for_each(|splat| brightest.add(technique, splat));
        brightest.observe(&observed, out);
        if let Some(splat) = self.splats.iter().next() {
            out.add(tile(splat.position), density);
            // Paths of technique t = 1 do not read the film coordinates: observe the film position of the
            // splat instead.
            let [x, y] = splat.position.map(f64::from);
            out.features.coordinates[..2].copy_from_slice(&[x, y]);
        }
        density
    }
}
