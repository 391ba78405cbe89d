//! Hypothesis tests and diagnostics of Markov chains, independent of rendering.
//!
//! ```
//! use metrolight::statistics::{Moments, welch};
//!
//! let a: Moments = [1.0, 2.0, 3.0].into_iter().collect();
//! let b: Moments = [1.5, 2.5, 2.0].into_iter().collect();
//! assert!(welch(&a, &b) > 0.5);
//! ```

pub mod autocorrelation;
pub mod convergence;
pub mod hypothesis;
pub mod independence;
pub mod moments;
mod pooling;
pub mod power;
pub mod ranks;
pub mod stationarity;
pub mod symmetry;
pub mod two_sample;

#[cfg(test)]
mod testing;

pub use autocorrelation::{
    autocorrelation, autocovariance, integrated_autocorrelation_time,
    integrated_autocorrelation_time_of_chains,
};
pub use convergence::{bulk_ess, nested_r_hat, r_hat, tail_ess};
pub use hypothesis::{
    chi_square, distance_from_uniform, holm, normal_two_sided, smallest_detectable, welch,
    welch_score,
};
pub use independence::spearman;
pub use moments::Moments;
pub use power::clopper_pearson;
pub use ranks::{rank_among, rank_uniformity};
pub use stationarity::{
    HeidelbergerWelch, cramer_von_mises_survival, geweke, geweke_p_value, heidelberger_welch,
    spectral_density_at_zero, stationarity_p_value,
};
pub use symmetry::{SymmetryTest, bowker, stuart_maxwell};
pub use two_sample::{
    chi_square_two_sample, kolmogorov_smirnov, kolmogorov_smirnov_randomized, kolmogorov_survival,
    mmd_permutation,
};
