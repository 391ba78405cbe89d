//! A point of the hypercube that a chain moves, updated only where it is read.
//!
//! The chain that is simulated moves *every* coordinate in every step. A coordinate that nobody reads
//! may catch up later: with n steps' worth of small steps if it is read again after n accepted steps,
//! or with a fresh number if a large step was among them (Kelemen et al. 2002, section 3.2). The law
//! of what is read is the same.

use rand::RngExt;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::{SmallStep, Steps};
use crate::fault::{Fault, planted};
use crate::sampling::{Coordinates, Stream};

/// Room for this many coordinates a stream is made at once; it grows to what the longest path needs.
const CAPACITY: usize = 32;

#[derive(Clone, Copy, Debug)]
struct Coordinate {
    value: f32,
    /// The step up to which `value` is known.
    time: u64,
}

/// A coordinate as it was in the current state, to be restored on rejection.
#[derive(Clone, Copy, Debug)]
struct Undo {
    stream: Stream,
    index: u32,
    value: f32,
}

/// The state of a chain, and the proposal while one is open.
#[derive(Clone, Debug)]
pub struct LazyPoint {
    streams: [Vec<Coordinate>; Stream::COUNT],
    undo: Vec<Undo>,
    rng: Xoshiro256PlusPlus,
    steps: Steps,
    /// Number of accepted steps, plus 1 while a proposal is open.
    now: u64,
    /// The last accepted large step.
    last_large: u64,
    /// The open proposal is a large step.
    large: bool,
}

impl LazyPoint {
    /// A point whose coordinates are all still to be drawn from `rng`.
    pub fn new(rng: Xoshiro256PlusPlus, steps: impl Into<Steps>) -> Self {
        Self {
            streams: std::array::from_fn(|_| Vec::with_capacity(CAPACITY)),
            undo: Vec::with_capacity(CAPACITY),
            rng,
            steps: steps.into(),
            now: 0,
            last_large: 0,
            large: true,
        }
    }

    /// The generator that also decides on acceptance.
    pub fn rng(&mut self) -> &mut Xoshiro256PlusPlus {
        &mut self.rng
    }

    /// Opens a proposal.
    #[inline]
    pub fn propose(&mut self, large: bool) {
        self.now += 1;
        self.large = large;
    }

    /// Makes the proposal the state.
    #[inline]
    pub fn accept(&mut self) {
        if self.large {
            self.last_large = self.now;
        }
        self.undo.clear();
    }

    /// Goes back to the state before the proposal: every coordinate and its time.
    #[inline]
    pub fn reject(&mut self) {
        self.now -= 1;
        if planted(Fault::NotRestored) {
            self.undo.clear();
        }
        for undo in self.undo.drain(..) {
            self.streams[undo.stream as usize][undo.index as usize] = Coordinate {
                value: undo.value,
                time: self.now,
            };
        }
    }

    /// Sets coordinates of the current state, as if they had been drawn: how a chain starts from a
    /// point found by the bootstrap.
    pub(crate) fn set(&mut self, stream: Stream, first: usize, values: &[f32]) {
        self.grow(stream, first + values.len());
        for (coordinate, &value) in self.streams[stream as usize][first..]
            .iter_mut()
            .zip(values)
        {
            *coordinate = Coordinate {
                value,
                time: self.now,
            };
        }
    }

    /// Makes coordinates below `len` exist. One that was never read is uniform in every state, so a
    /// fresh number stands for its value in the current one.
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

    #[inline]
    fn get(&mut self, stream: Stream, index: usize) -> f32 {
        let coordinate = self.streams[stream as usize][index];
        if coordinate.time == self.now {
            return coordinate.value;
        }
        let step = self.steps.of(stream, index);
        let current = self.caught_up(coordinate, step);
        self.undo.push(Undo {
            stream,
            index: index as u32,
            value: current,
        });
        let value = if self.large {
            self.rng.random()
        } else {
            step.apply(current, &mut self.rng)
        };
        self.streams[stream as usize][index] = Coordinate {
            value,
            time: self.now,
        };
        value
    }

    /// The coordinate's value in the current state, before the open proposal.
    #[inline]
    fn caught_up(&mut self, coordinate: Coordinate, step: SmallStep) -> f32 {
        let mut steps = self.now - 1 - coordinate.time;
        if planted(Fault::LazyStepTooFew) {
            steps = steps.saturating_sub(1);
        }
        // Most coordinates are read in every step: only after more steps than most ask how many are
        // enough.
        let long_ago = steps > 16 && steps > step.steps_to_uniform();
        if coordinate.time < self.last_large || long_ago {
            return self.rng.random();
        }
        (0..steps).fold(coordinate.value, |v, _| step.apply(v, &mut self.rng))
    }
}

impl Coordinates for LazyPoint {
    #[inline]
    fn read<const N: usize>(&mut self, stream: Stream, first: usize) -> [f32; N] {
        if self.streams[stream as usize].len() < first + N {
            self.grow(stream, first + N);
        }
        std::array::from_fn(|i| self.get(stream, first + i))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::seeds;

    fn point(seed: u64) -> LazyPoint {
        let rng = seeds::generator(seed, seeds::Purpose::Chains, 0);
        LazyPoint::new(rng, SmallStep::default())
    }

    /// Shortest way around the circle.
    fn distance(a: f32, b: f32) -> f32 {
        let d = (a - b).abs();
        d.min(1.0 - d)
    }

    #[test]
    fn a_rejected_proposal_leaves_every_coordinate_as_it_was() {
        let mut point = point(1);
        point.propose(true);
        let before: [f32; 8] = point.read(Stream::Camera, 0);
        point.accept();
        for large in [false, true, false] {
            point.propose(large);
            let moved: [f32; 8] = point.read(Stream::Camera, 0);
            assert!(moved.iter().zip(before).all(|(a, b)| *a != b));
            point.reject();
        }
        // A step of length 0 would read the state itself: the nearest is one small step away.
        point.propose(false);
        let after: [f32; 8] = point.read(Stream::Camera, 0);
        for (a, b) in after.iter().zip(before) {
            assert!(distance(*a, b) <= 1.0 / 64.0 + 1e-6, "{a} {b}");
        }
    }

    /// A coordinate left alone for n accepted small steps moves by n + 1 steps when it is read again,
    /// the last of them the proposal's. Null hypothesis: the variance is (n + 1) times that of one
    /// step, (s2^2 - s1^2) / (2 ln(s2/s1)). The relative standard error of the sample variance over
    /// 20000 runs is about 1%; the threshold is 5 of them.
    #[test]
    fn a_coordinate_left_alone_catches_up() {
        for n in [0u32, 1, 5, 20] {
            let mut sum = 0.0;
            let runs = 20_000;
            for run in 0..runs {
                let mut point = point(run);
                point.set(Stream::Light, 0, &[0.5]);
                for _ in 0..n {
                    point.propose(false);
                    point.accept();
                }
                point.propose(false);
                let [value] = point.read(Stream::Light, 0);
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
    fn a_coordinate_left_alone_over_a_large_step_is_fresh() {
        let mut far = 0;
        for run in 0..1000 {
            let mut point = point(run);
            point.set(Stream::Light, 0, &[0.5]);
            point.propose(true);
            point.accept();
            point.propose(false);
            let [value] = point.read(Stream::Light, 0);
            far += u32::from(distance(value, 0.5) > 0.1);
        }
        // Uniform: 80% are far; standard deviation 1.3%.
        assert!(
            (740..860).contains(&far),
            "{far} of 1000 far from where they were"
        );
    }

    #[test]
    fn streams_and_vertices_do_not_shift_each_other() {
        let mut point = point(3);
        point.propose(true);
        let camera: [f32; 4] = point.read(Stream::Camera, 8);
        point.accept();
        // Another path reads more of the light stream and other vertices first.
        point.propose(false);
        let _: [f32; 40] = point.read(Stream::Light, 0);
        let _: [f32; 4] = point.read(Stream::Camera, 20);
        let again: [f32; 4] = point.read(Stream::Camera, 8);
        for (a, b) in again.iter().zip(camera) {
            assert!(distance(*a, b) <= 1.0 / 64.0 + 1e-6);
        }
    }
}
