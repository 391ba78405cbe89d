//! What the user should know about an image.

use super::{ErrorEstimate, NonFinite, Settings};
use crate::markov::{Bootstrap, ChainCounters};
use crate::statistics::Moments;

/// The image is as uncertain in overall brightness as b: beyond this the user is told.
const WORTH_A_WARNING: f64 = 0.02;

/// A chain is stuck if it has rejected so many proposals in a row, and more than half of its steps.
const STUCK: u64 = 1000;

/// Tells of contributions that were left out.
pub(super) fn non_finite(non_finite: &NonFinite) -> Option<String> {
    (non_finite.count > 0).then(|| {
        format!(
            "{} contributions were NaN, infinite or negative and have been left out",
            non_finite.count
        )
    })
}

/// Tells that pixels are missing.
pub(super) fn unsampled(done: u64, pixels: u64) -> Option<String> {
    (done < pixels).then(|| {
        format!(
            "only {done} of {pixels} pixels have been sampled: the rest is dark. Render for longer"
        )
    })
}

/// Tells that an error was asked for and cannot be given, or has not been reached.
pub(super) fn error(settings: &Settings, estimate: Option<&ErrorEstimate>) -> Option<String> {
    match (estimate, settings.target_error) {
        (None, _) if settings.wants_error() => Some(
            "the error of the image is not known: that takes two samples per pixel at least, or \
             two chains"
                .into(),
        ),
        (Some(estimate), Some(target)) if estimate.relative_mse > target => Some(format!(
            "the relMSE is about {:.2e}, and not yet {target:.2e}: render for longer",
            estimate.relative_mse
        )),
        _ => None,
    }
}

/// Tells that standard errors are probably too small.
pub(super) fn single(estimate: Option<&ErrorEstimate>) -> Option<String> {
    let single = estimate.map_or(0.0, |estimate| estimate.single);
    (single > ErrorEstimate::MAX_SINGLE).then(|| {
        format!(
            "errors are probably larger than estimated: in {:.0}% of the pixels nearly all variance \
             comes from one part of the samples, so that rare light is still to be found. Render \
             for longer",
            100.0 * single
        )
    })
}

/// Tells of a Metropolis image without mutations.
pub(super) fn no_mutation(done: u64, chains: usize) -> Option<String> {
    (done == 0 && chains > 0).then(|| "no mutation was made: the image is black".into())
}

/// True if the chain has spent most of its time in one state.
pub(super) fn is_stuck(counters: &ChainCounters) -> bool {
    let run = counters.longest_rejection_run;
    run >= STUCK && 2 * run > counters.steps()
}

/// Tells of chains that hardly moved.
pub(super) fn stuck(stuck: u64, chains: u64) -> Option<String> {
    (stuck > 0).then(|| {
        format!(
            "{stuck} of {chains} chains have been in one state for more than half of their \
             mutations: what they show are single paths, perhaps as bright spots"
        )
    })
}

/// Tells how little is known of b.
pub(super) fn normalisation(uniform: &Moments, bootstrap: &Bootstrap) -> Option<String> {
    let relative_error = uniform.standard_error() / uniform.mean;
    if bootstrap.moments.mean <= 0.0 {
        Some(format!(
            "none of {} bootstrap samples found light: the image is black. If the scene is not \
             meant to be black, give more samples with --bootstrap",
            bootstrap.moments.count
        ))
    } else if !relative_error.is_finite() {
        Some(
            "b is not known, and neither is the brightness of the image: give more samples with \
             --bootstrap"
                .into(),
        )
    } else if relative_error > WORTH_A_WARNING {
        Some(format!(
            "b is known to {:.1}% only (one standard error), and so is the brightness of the \
             image: render for longer, or give more samples with --bootstrap",
            100.0 * relative_error
        ))
    } else {
        None
    }
}
