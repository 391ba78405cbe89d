//! Colours, frames and small linear systems: mathematics independent of rendering.
//!
//! ```
//! use glam::Vec3A;
//! use metrolight::math::{Frame, Rgb, luminance};
//!
//! let frame = Frame::from_normal(Vec3A::Y);
//! assert!((frame.to_local(Vec3A::Y) - Vec3A::Z).length() < 1e-6);
//! assert!((luminance(Rgb::ONE) - 1.0).abs() < 1e-6);
//! ```

pub mod color;
pub mod frame;
pub mod linear;

pub use color::{Rgb, luminance};
pub use frame::Frame;
pub use linear::inverse_form;
