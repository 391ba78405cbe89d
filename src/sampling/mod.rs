//! Sources of sample values, and their transformation: discrete distributions and warps.
//!
//! ```
//! use metrolight::sampling::seeds::Purpose;
//! use metrolight::sampling::{Dimension, IndependentSampler, Sampler, Stream};
//!
//! // A sample is identified by seed, purpose and index. Each of its dimensions has one value.
//! let mut sampler = IndependentSampler::new(7, Purpose::Pixels, 42);
//! let film: [f32; 2] = sampler.get(Dimension::new(Stream::Camera, 0));
//! let [y] = sampler.get(Dimension::new(Stream::Camera, 1));
//! assert_eq!(film[1], y);
//! ```

pub mod distribution;
pub mod independent;
pub mod sampler;
pub mod seeds;
pub mod warp;

#[cfg(test)]
mod tests;

pub use distribution::{Cell, Distribution1D, Distribution2D};
pub use independent::IndependentSampler;
pub use sampler::{Dimension, Sampler, Stream};
