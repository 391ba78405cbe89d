//! Tests of image means against exact values.
//!
//! Null hypothesis, for each comparison: the mean over independent seeds is the truth. The standard error
//! has few degrees of freedom, so the test is Welch's against a sample without variance, which is
//! Student's. Nothing is rescaled.

use metrolight::render::{Budget, Method, Rendering, Settings};
use metrolight::scene::Scene;
use metrolight::statistics::{Moments, holm, welch};

use super::figures::{Accuracy, record};
use super::renders::{mean, renderings, with_pssmlt};

/// Probability with which a correct program fails one set of [`Truths`] for a new choice of seeds, by
/// Holm's correction over the set.
const ALPHA: f64 = 1e-4;

/// Relative error of estimators without variance: rounding alone.
const ROUNDING: f64 = 1e-4;

/// A larger relative standard error fails the test, which would otherwise show too little.
const GREATEST_ERROR: f64 = 0.02;

/// Independent images per comparison, enough for thin tails of Student's distribution.
const SEEDS: u64 = 32;

/// Comparisons that are tested together.
#[derive(Default)]
pub struct Truths {
    rows: Vec<Row>,
}

struct Row {
    name: String,
    found: Moments,
    truth: f64,
    /// Relative error allowed for the truth.
    slack: f64,
}

impl Row {
    fn deviation(&self) -> f64 {
        self.found.mean / self.truth - 1.0
    }

    fn relative_error(&self) -> f64 {
        self.found.standard_error() / self.truth
    }

    fn p_value(&self) -> f64 {
        p_value(&self.found, self.truth, self.slack)
    }
}

/// p of the nearest mean whose relative difference from `truth` is at most `slack`.
pub fn p_value(found: &Moments, truth: f64, slack: f64) -> f64 {
    let off = (found.mean / truth - 1.0).clamp(-slack, slack);
    let exact = Moments::from_summary(found.count, truth * (1.0 + off), 0.0);
    welch(found, &exact)
}

/// Rejects at `alpha` that the mean over seeds is `truth`. Estimators without variance may differ from
/// the truth by `rounding`, relative.
pub fn assert_mean(name: &str, moments: &Moments, truth: f64, rounding: f64, alpha: f64) {
    if (moments.mean - truth).abs() <= rounding * truth.abs() {
        return;
    }
    let p = p_value(moments, truth, 0.0);
    assert!(
        p > alpha,
        "{name}: {} +- {}, should be {truth}: p = {p:e}",
        moments.mean,
        moments.standard_error()
    );
}

impl Truths {
    /// Compares the mean of `scene`'s image with `truth`, for each of `integrators`.
    pub fn render(
        &mut self,
        name: &str,
        scene: &Scene,
        integrators: &[Method],
        spp: u64,
        truth: f64,
    ) {
        self.render_within(ROUNDING, name, scene, integrators, spp, truth);
    }

    /// As [`Self::render`], allowing the renderer's model a relative error of `slack`.
    pub fn render_within(
        &mut self,
        slack: f64,
        name: &str,
        scene: &Scene,
        integrators: &[Method],
        spp: u64,
        truth: f64,
    ) {
        for &integrator in integrators {
            let found = images(scene, integrator, spp).map(|image| mean(&image));
            let name = format!("{name}, {}", integrator.name());
            self.compare(slack, name, found.collect(), truth);
        }
    }

    /// Compares a mean with `truth`, which has a relative error of at most `slack`.
    pub fn compare(&mut self, slack: f64, name: String, found: Moments, truth: f64) {
        let slack = slack.max(ROUNDING);
        self.rows.push(Row {
            name,
            found,
            truth,
            slack,
        });
    }

    /// Asserts that all comparisons hold, and records the row `case` of the table of accuracy.
    pub fn settle(self, oracle: &str, case: &str) {
        let p_values: Vec<f64> = self.rows.iter().map(Row::p_value).collect();
        for (p, row) in holm(&p_values).iter().zip(&self.rows) {
            let Row {
                name, found, truth, ..
            } = row;
            assert!(
                *p > ALPHA,
                "{name}: {} +- {}, truth {truth}, p = {p:e}",
                found.mean,
                found.standard_error()
            );
            assert!(
                row.relative_error() < GREATEST_ERROR,
                "{name}: {} +- {} is too uncertain",
                found.mean,
                found.standard_error()
            );
        }
        let greatest = |f: fn(&Row) -> f64| self.rows.iter().map(f).fold(0.0, f64::max);
        record(
            "accuracy",
            &Accuracy {
                oracle,
                case,
                found: format!(
                    "{} means, farthest {:.2}% off; standard errors up to {:.2}%",
                    self.rows.len(),
                    100.0 * greatest(|row| row.deviation().abs()),
                    100.0 * greatest(Row::relative_error),
                ),
                demanded: format!("no mean differs: t-tests, p > {ALPHA:e} after Holm"),
            },
        );
    }
}

/// Renderings of `scene` with different seeds.
pub fn images(scene: &Scene, integrator: Method, spp: u64) -> impl Iterator<Item = Rendering> {
    let settings = with_pssmlt(
        Settings {
            budget: Budget::SamplesPerPixel(spp),
            ..Settings::new(integrator)
        },
        |own| {
            own.chains = 16;
            own.bootstrap = Some(1_000);
        },
    );
    renderings(scene, &settings, 0..SEEDS)
}
