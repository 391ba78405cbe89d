//! A test, and what came of it.

use serde::Serialize;

use crate::statistics::holm;

/// What a test is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Family {
    /// The target distribution stays as it is.
    Invariance,
    /// Steps go to and fro equally often.
    Reversibility,
    /// The start is nothing special among the states around it.
    Ranks,
    /// Chains have nothing to do with each other.
    Independence,
    /// b, and the weights of the samples.
    Normalisation,
}

/// A hypothesis test.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Check {
    /// What it is about.
    pub family: Family,
    /// Which test, of what, when.
    pub name: String,
    /// Probability of data at least as odd if nothing is wrong.
    pub p_value: f64,
    /// The same, corrected for the number of tests.
    pub adjusted: f64,
}

impl Check {
    /// A test that is not corrected yet.
    pub fn new(family: Family, name: impl Into<String>, p_value: f64) -> Self {
        Self {
            family,
            name: name.into(),
            p_value,
            adjusted: p_value,
        }
    }
}

/// Corrects all p-values together (Holm 1979).
pub fn correct(checks: &mut [Check]) {
    let p_values: Vec<f64> = checks.iter().map(|check| check.p_value).collect();
    for (check, adjusted) in checks.iter_mut().zip(holm(&p_values)) {
        check.adjusted = adjusted;
    }
}
