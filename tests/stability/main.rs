//! Scenes, settings and numbers at the edge of sense: what happens, and what the user is told.
//!
//! Each test records rows of the table in `docs/stability.md`.

#[path = "../common/mod.rs"]
mod common;

mod metropolis;
mod numbers;
mod places;
mod rooms;
mod sweeps;
