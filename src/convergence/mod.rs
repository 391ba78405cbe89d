//! Convergence: the error of several renders of a scene against time.
//!
//! All variants are rendered once per repeat, in turn, so that a change of the machine's speed affects
//! all of them. The error is measured at geometrically spaced times of a single render, while its clock
//! is stopped.

pub mod chart;
pub mod curve;
pub mod experiment;
pub mod recorder;

pub use chart::{comparison, convergence_chart};
pub use curve::{Cost, Curve, CurvePoint, Measure, Reached};
pub use experiment::{Experiment, Measurement, Outcome, Variant};
