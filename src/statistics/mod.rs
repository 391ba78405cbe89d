//! Hypothesis tests and error metrics; nothing of rendering.

pub mod hypothesis;
pub mod image_error;
pub mod moments;

pub use hypothesis::{chi_square, holm, normal_two_sided, welch};
pub use image_error::{expected_relative_mse, relative_mse};
pub use moments::Moments;
