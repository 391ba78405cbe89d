//! How far an image is from a reference: relMSE, FLIP, and whether the difference is bias.

pub mod bias;
pub mod flip;
pub mod relative_mse;

pub use bias::{BiasTest, BiasVerdict, Estimate, test_bias};
pub use flip::{Flip, flip};
pub use relative_mse::{
    ImageError, expected_relative_mse, image_errors, relative_mse, relative_square_errors,
};
