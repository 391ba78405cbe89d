//! Sources of sample values, and their transformation: discrete distributions and warps.

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
