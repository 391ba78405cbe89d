//! A hypothesis test and its result.

use serde::Serialize;

use crate::statistics::holm;

/// The property that a test checks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Family {
    /// Steps leave the target distribution invariant.
    Invariance,
    /// Steps in both directions between two regions are equally frequent.
    Reversibility,
    /// The rank of the start among the states before and after it is uniform.
    Ranks,
    /// Chains are independent of each other.
    Independence,
    /// b and the weights of the samples are correct.
    Normalisation,
}

/// A hypothesis test.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Check {
    /// The property that it checks.
    pub family: Family,
    /// The test, the observed quantity, and the number of steps.
    pub name: String,
    /// Probability of data at least as extreme under the null hypothesis.
    pub p_value: f64,
    /// The p-value, corrected for the number of tests.
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
