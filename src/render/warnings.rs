//! Warnings about an image, derived from the state of a finished render.

use super::{ErrorEstimate, NonFinite, Settings};
use crate::markov::{Bootstrap, ChainCounters};
use crate::statistics::Moments;

/// A reason to distrust an image, or to render for longer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Warning {
    /// Contributions that were NaN, infinite or negative were left out.
    NonFinite {
        /// Number of such contributions.
        count: u64,
    },
    /// Some pixels have no sample and are dark.
    Unsampled {
        /// Pixels with a sample.
        done: u64,
        /// Pixels of the image.
        pixels: u64,
    },
    /// The error was requested, but the samples do not have two independent parts.
    ErrorUnknown,
    /// The budget ended before the target error was reached.
    TargetNotReached {
        /// Estimated relMSE of the image.
        estimate: f64,
        /// Target relMSE.
        target: f64,
    },
    /// In many pixels nearly all variance comes from one part of the samples
    /// ([`ErrorEstimate::dominated_share`]): the error is probably larger than estimated.
    RareContributions {
        /// Share of such pixels, in (0, 1].
        share: f64,
    },
    /// Chains were started, but made no mutation: the image is black.
    NoMutations,
    /// Chains spent more than half of their mutations in one state.
    StuckChains {
        /// Number of such chains.
        stuck: u64,
        /// Number of all chains.
        chains: u64,
    },
    /// No bootstrap sample found light: b is 0 and the image is black.
    NoLightInBootstrap {
        /// Number of bootstrap samples.
        samples: u64,
    },
    /// There are too few samples to estimate the standard error of b.
    NormalisationUnknown,
    /// The standard error of b, and so of the brightness of the whole image, is large.
    NormalisationUncertain {
        /// Standard error of b over b.
        relative_error: f64,
    },
    /// All pixels are 0, and no other warning explains it.
    Black,
}

/// Largest relative standard error of b without a warning.
const MAX_NORMALISATION_ERROR: f64 = 0.02;

/// A chain is stuck if it has rejected this many proposals in a row, and more than half of its steps.
const MIN_STUCK_RUN: u64 = 1000;

/// Warns of contributions that were left out.
pub(super) fn non_finite(non_finite: &NonFinite) -> Option<Warning> {
    let count = non_finite.count;
    (count > 0).then_some(Warning::NonFinite { count })
}

/// Warns of pixels without samples.
pub(super) fn unsampled(done: u64, pixels: u64) -> Option<Warning> {
    (done < pixels).then_some(Warning::Unsampled { done, pixels })
}

/// Warns if the requested error is unknown or the target error has not been reached.
pub(super) fn error(settings: &Settings, estimate: Option<&ErrorEstimate>) -> Option<Warning> {
    match (estimate, settings.target_error) {
        (None, _) if settings.wants_error() => Some(Warning::ErrorUnknown),
        (Some(estimate), Some(target)) if estimate.relative_mse > target => {
            Some(Warning::TargetNotReached {
                estimate: estimate.relative_mse,
                target,
            })
        }
        _ => None,
    }
}

/// Warns of standard errors that are probably too small.
pub(super) fn rare_contributions(estimate: Option<&ErrorEstimate>) -> Option<Warning> {
    let share = estimate.map_or(0.0, |estimate| estimate.dominated_share);
    (share > ErrorEstimate::MAX_DOMINATED_SHARE).then_some(Warning::RareContributions { share })
}

/// Warns of a Metropolis image without mutations.
pub(super) fn no_mutation(done: u64, chains: usize) -> Option<Warning> {
    (done == 0 && chains > 0).then_some(Warning::NoMutations)
}

/// True if the chain has spent most of its time in one state.
pub(super) fn is_stuck(counters: &ChainCounters) -> bool {
    let run = counters.longest_rejection_run;
    run >= MIN_STUCK_RUN && 2 * run > counters.steps()
}

/// Warns of chains that hardly moved.
pub(super) fn stuck(stuck: u64, chains: u64) -> Option<Warning> {
    (stuck > 0).then_some(Warning::StuckChains { stuck, chains })
}

/// Warns if b is 0 or uncertain.
pub(super) fn normalisation(uniform: &Moments, bootstrap: &Bootstrap) -> Option<Warning> {
    let relative_error = uniform.standard_error() / uniform.mean;
    if bootstrap.moments.mean <= 0.0 {
        let samples = bootstrap.moments.count;
        Some(Warning::NoLightInBootstrap { samples })
    } else if !relative_error.is_finite() {
        Some(Warning::NormalisationUnknown)
    } else if relative_error > MAX_NORMALISATION_ERROR {
        Some(Warning::NormalisationUncertain { relative_error })
    } else {
        None
    }
}
