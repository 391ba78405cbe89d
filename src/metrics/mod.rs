//! Metrics of the difference between an image and a reference: relMSE and others, FLIP, and a test of bias.
//!
//! ```
//! use metrolight::metrics::image_errors;
//!
//! let (image, reference) = ([[1.1; 3], [2.0; 3]], [[1.0; 3], [2.0; 3]]);
//! let error = image_errors(&image, &reference);
//! assert!((error.mse - 0.005).abs() < 1e-6);
//! ```

pub mod bias;
pub mod flip;
pub mod relative_mse;

pub use bias::{BiasTest, BiasVerdict, Estimate, test_bias};
pub use flip::{Flip, flip};
pub use relative_mse::{
    ImageError, expected_relative_mse, image_errors, relative_mse, relative_square_errors,
};
