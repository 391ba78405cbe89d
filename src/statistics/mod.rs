//! Hypothesis tests and error metrics; nothing of rendering.

pub mod hypothesis;
pub mod image_error;
pub mod moments;

pub use hypothesis::{
    chi_square, distance_from_uniform, holm, normal_two_sided, smallest_detectable, welch,
    welch_score,
};
pub use image_error::{expected_relative_mse, relative_mse};
pub use moments::Moments;
