//! The bootstrap of a render: how many independent samples estimate b.

use std::sync::Mutex;
use std::time::Instant;

use super::target::SplatTarget;
use super::{Budget, Observer, PssmltSettings, Settings};
use crate::integrators::PathSampler;
use crate::markov::{Bootstrap, BootstrapLimits};
use crate::scene::RayCounts;

/// The bootstrap continues until b has this relative standard error, within its limits.
const BOOTSTRAP_ERROR: f64 = 0.01;

/// Bounds on the number of bootstrap samples, unless the settings give the number.
const BOOTSTRAP_SAMPLES: [u64; 2] = [1 << 17, 1 << 22];

/// Takes bootstrap samples, and counts their rays.
pub(super) fn bootstrap<'a, P: PathSampler>(
    target: impl Fn() -> SplatTarget<'a, P> + Sync,
    pixels: u64,
    settings: &Settings,
    method_settings: &PssmltSettings,
    start: Instant,
    observer: &dyn Observer,
) -> (Bootstrap, RayCounts) {
    let limits = bootstrap_limits(method_settings.bootstrap, settings.budget, pixels);
    // The bootstrap may take a tenth of a time budget, or half of it if the settings give its size.
    let deadline = match (settings.budget, method_settings.bootstrap) {
        (Budget::Seconds(seconds), None) => 0.1 * seconds,
        (Budget::Seconds(seconds), Some(_)) => 0.5 * seconds,
        (Budget::SamplesPerPixel(_) | Budget::Samples(_) | Budget::Unlimited, _) => f64::INFINITY,
    };
    let rays = Mutex::new(RayCounts::default());
    let bootstrap = Bootstrap::run(
        settings.seed,
        limits,
        target,
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
    (bootstrap, rays.into_inner().unwrap_or_default())
}

fn bootstrap_limits(samples: Option<u64>, budget: Budget, pixels: u64) -> BootstrapLimits {
    let [min, max] = BOOTSTRAP_SAMPLES;
    // At most an eighth of the number of mutations, because large steps refine b as well, but enough samples
    // to start from.
    let within = |mutations: u64| (min, (mutations / 8).clamp(min, max), BOOTSTRAP_ERROR);
    let (at_least, at_most, relative_error) = match (samples, budget) {
        (Some(n), _) => (n, n, 0.0),
        (None, Budget::Seconds(_) | Budget::Unlimited) => (min, max, BOOTSTRAP_ERROR),
        (None, Budget::SamplesPerPixel(n)) => within(n.saturating_mul(pixels)),
        (None, Budget::Samples(n)) => within(n),
    };
    BootstrapLimits {
        at_least,
        at_most,
        relative_error,
    }
}
