//! Images whose mean is known in closed form, or by a quadrature that shares nothing with the
//! renderer.

mod common;

#[path = "closed_forms/enclosures.rs"]
mod enclosures;
