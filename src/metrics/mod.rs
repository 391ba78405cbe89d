//! Metrics of the difference between an image and a reference: relMSE and others, FLIP, and a test of bias.

pub mod bias;
pub mod flip;
pub mod relative_mse;

pub use bias::{BiasTest, BiasVerdict, Estimate, test_bias};
pub use flip::{Flip, flip};
pub use relative_mse::{
    ImageError, expected_relative_mse, image_errors, relative_mse, relative_square_errors,
};
