//! Extreme scenes, settings and numbers: the results, and the warnings that the user gets.
//!
//! Each test records rows of the table in `docs/stability.md`.

#[path = "../common/mod.rs"]
mod common;

mod metropolis;
mod numbers;
mod places;
mod records;
mod rooms;
mod sweeps;
