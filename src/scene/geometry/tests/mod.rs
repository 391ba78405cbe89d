//! Tests of surfaces and of rays between them.

mod intersection;
mod robustness;
mod surfaces;
