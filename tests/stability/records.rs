//! Rows of the table in `docs/stability.md`, and what all tests of this directory share.

use metrolight::render::Warning;
use metrolight::statistics::Moments;

use crate::common::figures::{Stability, record};
use crate::common::wording;

/// False alarm rate of one comparison.
pub const ALPHA: f64 = 1e-4;

/// Relative error allowed for estimators without variance: some roundings of f32.
pub const ROUNDING: f64 = 2e-5;

/// Records the result of a case, and the warning that the user got.
pub fn row(case: &str, method: &str, happens: impl Into<String>, told: impl Into<String>) {
    let (happens, told) = (happens.into(), told.into());
    record(
        "stability",
        &Stability {
            case,
            method,
            happens,
            told,
        },
    );
}

/// The warnings of a rendering, verbatim.
pub fn told(warnings: &[Warning]) -> String {
    if warnings.is_empty() {
        return "nothing".into();
    }
    let sentences: Vec<String> = warnings.iter().map(wording::warning).collect();
    sentences.join("; ")
}

/// "0.6000 +- 0.0003".
pub fn figure(moments: &Moments) -> String {
    format!("{:.4} +- {:.4}", moments.mean, moments.standard_error())
}
