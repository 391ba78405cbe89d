//! Where a chain takes its turn: the target that it asks, and what it logs.

use crate::film::{Splat, SplatLog};
use crate::integrators::{Sampler, Splats, Workspace};
use crate::markov::{Sample, Target, Weighing};
use crate::math::color::saturated;
use crate::sampling::Coordinates;
use crate::scene::{RayCounts, Scene};

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

    /// Rays traced so far.
    pub fn rays(&self) -> RayCounts {
        self.workspace.rays
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
pub(super) struct Seat<'a> {
    pub target: LightTarget<'a>,
    /// Splats with chain weights, and with large-step weights.
    pub chain_log: SplatLog,
    pub large_log: SplatLog,
}

impl<'a> Seat<'a> {
    /// A seat with nothing logged.
    pub fn new(target: LightTarget<'a>) -> Self {
        Self {
            target,
            chain_log: SplatLog::new(),
            large_log: SplatLog::new(),
        }
    }
}

/// Logs a sample with the weight that it has gathered.
#[inline]
pub(super) fn log(weighing: &Weighing, sample: &Sample<Splats>, seat: &mut Seat) {
    let [chain, large] = weighing.factors(sample).map(|factor| factor as f32);
    if chain <= 0.0 && large <= 0.0 {
        return;
    }
    for Splat { position, value } in sample.contribution.iter() {
        if chain > 0.0 {
            seat.chain_log.push(Splat {
                position,
                value: saturated(value * chain),
            });
        }
        if large > 0.0 {
            seat.large_log.push(Splat {
                position,
                value: saturated(value * large),
            });
        }
    }
}
