//! Colours, frames and small linear systems: mathematics independent of rendering.

pub mod color;
pub mod frame;
pub mod linear;

pub use color::{Rgb, luminance};
pub use frame::Frame;
pub use linear::inverse_form;
