//! Hypothesis tests and error metrics; nothing of rendering.

pub mod bias;
pub mod hypothesis;
pub mod image_error;
pub mod moments;

pub use bias::{BiasTest, BiasVerdict, Estimate, test_bias};
pub use hypothesis::{
    chi_square, distance_from_uniform, holm, normal_two_sided, smallest_detectable, welch,
    welch_score,
};
pub use image_error::{
    ImageError, expected_relative_mse, image_errors, relative_mse, relative_square_errors,
};
pub use moments::Moments;
