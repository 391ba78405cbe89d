//! Frames, warps, discrete distributions and points of the unit hypercube: mathematics that knows
//! nothing of light.

pub mod color;
pub mod distribution;
pub mod frame;
pub mod hypercube;
pub mod seeds;
pub mod warp;

#[cfg(test)]
mod tests;

pub use color::{Rgb, luminance};
pub use distribution::{Cell, Distribution1D, Distribution2D};
pub use frame::Frame;
pub use hypercube::{Coordinates, FreshCoordinates, Stream};
