//! Error against time: several ways to render one scene, measured against one reference as their
//! images grow.
//!
//! The ways take turns, repeat by repeat, so that a machine that slows down slows all alike; each is
//! measured at geometrically spaced moments of one and the same render, while its clock stands still.

pub mod chart;
pub mod curve;
pub mod experiment;
pub mod recorder;

pub use chart::{comparison, convergence_chart};
pub use curve::{Cost, Curve, CurvePoint, Measure, Reached};
pub use experiment::{Experiment, Measurement, Outcome, Variant};
