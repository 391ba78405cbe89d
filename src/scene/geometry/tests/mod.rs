//! Tests of intersection.

mod intersection;
mod robustness;
mod surfaces;
