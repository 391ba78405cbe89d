//! Frames, warps, discrete distributions, points of the unit hypercube and small linear systems:
//! mathematics that knows nothing of light.

pub mod color;
pub mod distribution;
pub mod frame;
pub mod hypercube;
pub mod linear;
pub mod seeds;
pub mod warp;

#[cfg(test)]
mod tests;

pub use color::{Rgb, luminance};
pub use distribution::{Cell, Distribution1D, Distribution2D};
pub use frame::Frame;
pub use hypercube::{Coordinates, FreshCoordinates, Stream};
pub use linear::inverse_form;
