//! Hypothesis tests and error metrics; nothing of rendering.

pub mod hypothesis;
pub mod moments;

pub use hypothesis::{chi_square, holm, normal_two_sided, welch};
pub use moments::Moments;
