//! The state of a chain: a point of the hypercube whose coordinates are updated only when they are read.
//!
//! Every step of the simulated chain moves *all* coordinates. A coordinate that is not read is brought up
//! to date when it is next read: by one perturbation for each small step accepted since, or by a new
//! number if a large step was among them (Kelemen et al. 2002, section 3.2). The distribution of the
//! coordinates that are read is the same.

use rand::RngExt;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::Mutations;
use crate::fault::{Fault, planted};
use crate::sampling::{Dimension, Sampler, Stream};

/// Initial capacity of a stream, in coordinates.
const CAPACITY: usize = 64;

/// Up to this number of accepted steps are always simulated, even if they make a coordinate uniform.
const MIN_SKIPPED_STEPS: u64 = 16;

/// A coordinate with lazy update.
#[derive(Clone, Copy, Debug)]
struct Coordinate {
    value: f32,
    /// Number of accepted steps up to which `value` is current.
    time: u64,
}

/// The value of a coordinate in the current state, to be restored on rejection.
#[derive(Clone, Copy, Debug)]
struct Undo {
    dimension: Dimension,
    value: f32,
}

/// Consecutive accepted steps of one kind.
#[derive(Clone, Copy, Debug)]
struct Run {
    /// Index of the kind.
    kind: usize,
    /// Number of the last of these steps.
    end: u64,
}

/// The state of a chain in primary sample space, and the proposal while one is open.
#[derive(Clone, Debug)]
pub struct PrimarySample {
    /// Coordinates by stream, as far as they have been read.
    streams: [Vec<Coordinate>; Stream::COUNT],
    /// Coordinates that the open proposal has changed.
    undo: Vec<Undo>,
    rng: Xoshiro256PlusPlus,
    mutations: Mutations,
    /// Number of accepted steps, plus 1 while a proposal is open.
    now: u64,
    /// Runs of the steps accepted since the last large step.
    accepted: Vec<Run>,
    /// Number of the last accepted large step.
    last_large: u64,
    /// The kind of the open proposal.
    kind: usize,
    /// Log ratio of the proposal densities of the coordinates read so far.
    log_density_ratio: f64,
}

impl PrimarySample {
    /// A uniform point, whose coordinates are drawn from `rng` when they are first read.
    pub fn new(rng: Xoshiro256PlusPlus, mutations: Mutations) -> Self {
        Self {
            streams: std::array::from_fn(|_| Vec::with_capacity(CAPACITY)),
            undo: Vec::with_capacity(CAPACITY),
            rng,
            mutations,
            now: 0,
            accepted: Vec::new(),
            last_large: 0,
            kind: 0,
            log_density_ratio: 0.0,
        }
    }

    /// The generator that also decides on acceptance.
    pub fn rng(&mut self) -> &mut Xoshiro256PlusPlus {
        &mut self.rng
    }

    /// The kinds of mutations.
    pub fn mutations(&self) -> &Mutations {
        &self.mutations
    }

    /// A sampler that reads from `source` and stores the values in the current state, so that a chain
    /// starts at that sample. Coordinates that the target does not read remain uniform.
    pub fn starting_at<S: Sampler>(&mut self, source: S) -> Start<'_, S> {
        Start {
            source,
            state: self,
        }
    }

    /// Opens a proposal of a kind chosen at random, and returns the index of the kind.
    #[inline]
    pub fn propose(&mut self) -> usize {
        let kind = self.mutations.choose(self.rng.random());
        self.propose_kind(kind);
        kind
    }

    /// Opens a proposal of the kind with index `kind`.
    #[inline]
    pub fn propose_kind(&mut self, kind: usize) {
        self.now += 1;
        self.kind = kind;
        self.log_density_ratio = 0.0;
    }

    /// log q(v -> u) - log q(u -> v) of the open proposal v, over the coordinates that have been read.
    #[inline]
    pub fn log_density_ratio(&self) -> f64 {
        self.log_density_ratio
    }

    /// Makes the proposal the state.
    #[inline]
    pub fn accept(&mut self) {
        if self.mutations.kind(self.kind).is_large_step() {
            self.last_large = self.now;
            self.accepted.clear();
        } else {
            match self.accepted.last_mut() {
                Some(run) if run.kind == self.kind => run.end = self.now,
                _ => self.accepted.push(Run {
                    kind: self.kind,
                    end: self.now,
                }),
            }
        }
        self.undo.clear();
    }

    /// Rejects the proposal: restores every coordinate and its time.
    #[inline]
    pub fn reject(&mut self) {
        self.now -= 1;
        if planted(Fault::NotRestored) {
            self.undo.clear();
        }
        for Undo { dimension, value } in self.undo.drain(..) {
            self.streams[dimension.stream as usize][dimension.index] = Coordinate {
                value,
                time: self.now,
            };
        }
    }

    /// Sets coordinates of the current state.
    fn set(&mut self, first: Dimension, values: &[f32]) {
        self.grow(first.stream, first.index + values.len());
        let coordinates = &mut self.streams[first.stream as usize][first.index..];
        for (coordinate, &value) in coordinates.iter_mut().zip(values) {
            *coordinate = Coordinate {
                value,
                time: self.now,
            };
        }
    }

    /// Extends `stream` to `len` coordinates. A coordinate that was never read is uniform in every state,
    /// so its value in the current state is a new random number.
    fn grow(&mut self, stream: Stream, len: usize) {
        let time = self.now.saturating_sub(1);
        let coordinates = &mut self.streams[stream as usize];
        while coordinates.len() < len {
            coordinates.push(Coordinate {
                value: self.rng.random(),
                time,
            });
        }
    }

    /// The value of a coordinate in the open proposal.
    #[inline]
    fn value(&mut self, dimension: Dimension) -> f32 {
        let coordinate = self.streams[dimension.stream as usize][dimension.index];
        if coordinate.time == self.now {
            return coordinate.value;
        }
        let current = self.up_to_date(coordinate, dimension);
        self.undo.push(Undo {
            dimension,
            value: current,
        });
        let kind = self.mutations.kind(self.kind);
        let value = kind.propose(current, dimension, &mut self.rng);
        self.log_density_ratio += kind.log_density_ratio(current, value, dimension);
        self.streams[dimension.stream as usize][dimension.index] = Coordinate {
            value,
            time: self.now,
        };
        value
    }

    /// The coordinate's value in the current state, before the open proposal.
    #[inline]
    fn up_to_date(&mut self, coordinate: Coordinate, dimension: Dimension) -> f32 {
        let mut time = coordinate.time;
        if time < self.last_large {
            return self.rng.random();
        }
        if planted(Fault::LazyStepTooFew) {
            time = (time + 1).min(self.now - 1);
        }
        if time == self.now - 1 {
            return coordinate.value;
        }
        let mut value = coordinate.value;
        let first = self.accepted.partition_point(|run| run.end <= time);
        for run in &self.accepted[first..] {
            let steps = run.end - time;
            let kind = self.mutations.kind(run.kind);
            // Most coordinates are read in every step, so `steps_to_uniform` is evaluated only for long
            // runs.
            if steps > MIN_SKIPPED_STEPS && steps > kind.steps_to_uniform(dimension) {
                value = self.rng.random();
            } else {
                for _ in 0..steps {
                    value = kind.propose(value, dimension, &mut self.rng);
                }
            }
            time = run.end;
        }
        value
    }
}

impl Sampler for PrimarySample {
    #[inline]
    fn get<const N: usize>(&mut self, first: Dimension) -> [f32; N] {
        let Dimension { stream, index } = first;
        if self.streams[stream as usize].len() < index + N {
            self.grow(stream, index + N);
        }
        std::array::from_fn(|i| self.value(Dimension::new(stream, index + i)))
    }
}

/// A sample whose values become the state of a chain as they are read.
pub struct Start<'a, S> {
    source: S,
    state: &'a mut PrimarySample,
}

impl<S: Sampler> Sampler for Start<'_, S> {
    fn get<const N: usize>(&mut self, first: Dimension) -> [f32; N] {
        let values = self.source.get::<N>(first);
        self.state.set(first, &values);
        values
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::markov::{Mutation, Perturbation};
    use crate::sampling::seeds;

    const LARGE: usize = 0;
    const SMALL: usize = 1;

    fn state(seed: u64) -> PrimarySample {
        let rng = seeds::generator(seed, seeds::Purpose::Chains, 0);
        PrimarySample::new(rng, Mutations::kelemen(0.3, Perturbation::default()))
    }

    fn at(stream: Stream, index: usize) -> Dimension {
        Dimension::new(stream, index)
    }

    /// Distance on the circle.
    fn distance(a: f32, b: f32) -> f32 {
        let d = (a - b).abs();
        d.min(1.0 - d)
    }

    #[test]
    fn a_rejected_proposal_leaves_every_coordinate_as_it_was() {
        let mut state = state(1);
        state.propose_kind(LARGE);
        let before: [f32; 8] = state.get(at(Stream::Camera, 0));
        state.accept();
        for kind in [SMALL, LARGE, SMALL] {
            state.propose_kind(kind);
            let moved: [f32; 8] = state.get(at(Stream::Camera, 0));
            assert!(moved.iter().zip(before).all(|(a, b)| *a != b));
            state.reject();
        }
        // Small steps have positive length, so the restored state is known only to within one step.
        state.propose_kind(SMALL);
        let after: [f32; 8] = state.get(at(Stream::Camera, 0));
        for (a, b) in after.iter().zip(before) {
            assert!(distance(*a, b) <= 1.0 / 64.0 + 1e-6, "{a} {b}");
        }
    }

    /// A coordinate that is not read for n accepted small steps moves by n + 1 steps when it is read
    /// again, the last of them the proposal's. Null hypothesis: the variance is (n + 1) times that of one
    /// step, (s2^2 - s1^2) / (2 ln(s2/s1)). The relative standard error of the sample variance over
    /// 20000 runs is about 1%; the threshold is 5 of them.
    #[test]
    fn an_unread_coordinate_is_brought_up_to_date() {
        for n in [0u32, 1, 5, 20] {
            let mut sum = 0.0;
            let runs = 20_000;
            for run in 0..runs {
                let mut state = state(run);
                state.set(at(Stream::Light, 0), &[0.5]);
                for _ in 0..n {
                    state.propose_kind(SMALL);
                    state.accept();
                }
                state.propose_kind(SMALL);
                let [value] = state.get(at(Stream::Light, 0));
                sum += (f64::from(value) - 0.5).powi(2);
            }
            let (s1, s2) = (1.0f64 / 1024.0, 1.0f64 / 64.0);
            let step = (s2 * s2 - s1 * s1) / (2.0 * (s2 / s1).ln());
            let ratio = sum / runs as f64 / (step * f64::from(n + 1));
            assert!(
                (ratio - 1.0).abs() < 0.05,
                "n = {n}: variance ratio {ratio}"
            );
        }
    }

    #[test]
    fn an_unread_coordinate_is_new_after_a_large_step() {
        let mut far = 0;
        for run in 0..1000 {
            let mut state = state(run);
            state.set(at(Stream::Light, 0), &[0.5]);
            state.propose_kind(LARGE);
            state.accept();
            state.propose_kind(SMALL);
            let [value] = state.get(at(Stream::Light, 0));
            far += u32::from(distance(value, 0.5) > 0.1);
        }
        // If uniform 80% are far, with a standard deviation of 1.3%.
        assert!(
            (740..860).contains(&far),
            "{far} of 1000 far from their previous value"
        );
    }

    /// Two kinds of perturbations, accepted in turns: an unread coordinate is brought up to date by the steps
    /// of both. Null hypothesis: the variance is the sum of those of all steps, 3 of one kind and 2 of the
    /// other. The relative standard error over 20000 runs is about 1%; the threshold is 5 of them.
    #[test]
    fn an_unread_coordinate_is_brought_up_to_date_by_every_kind() {
        let deviations = [0.01f32, 0.002];
        let kind = |deviation| {
            let perturbation = Perturbation::Gaussian { deviation };
            (0.5, Mutation::SmallStep(perturbation.into()))
        };
        let (mut sum, runs) = (0.0, 20_000);
        for run in 0..runs {
            let rng = seeds::generator(run, seeds::Purpose::Chains, 0);
            let mut state = PrimarySample::new(rng, Mutations::new(deviations.map(kind)));
            state.set(at(Stream::Light, 0), &[0.5]);
            for kind in [0, 1, 1, 0] {
                state.propose_kind(kind);
                state.accept();
            }
            state.propose_kind(0);
            let [value] = state.get(at(Stream::Light, 0));
            sum += (f64::from(value) - 0.5).powi(2);
        }
        let [a, b] = deviations.map(|d| f64::from(d).powi(2));
        let ratio = sum / runs as f64 / (3.0 * a + 2.0 * b);
        assert!((ratio - 1.0).abs() < 0.05, "{ratio}");
    }

    #[test]
    fn streams_and_vertices_do_not_shift_each_other() {
        let mut state = state(3);
        state.propose_kind(LARGE);
        let camera: [f32; 4] = state.get(at(Stream::Camera, 8));
        state.accept();
        // Another path reads more of the light stream and other vertices first.
        state.propose_kind(SMALL);
        let _: [f32; 40] = state.get(at(Stream::Light, 0));
        let _: [f32; 4] = state.get(at(Stream::Camera, 20));
        let again: [f32; 4] = state.get(at(Stream::Camera, 8));
        for (a, b) in again.iter().zip(camera) {
            assert!(distance(*a, b) <= 1.0 / 64.0 + 1e-6);
        }
    }
}
