//! Code that several integration tests share.
#![allow(dead_code)] // Each test binary uses its own part.

pub mod comparison;
pub mod figures;
#[cfg(unix)]
pub mod interrupt;
pub mod page;
pub mod reference;
pub mod renders;
pub mod scenes;
pub mod tiles;
pub mod truths;
/// The sentences that the program prints, so that the tables in `docs/` quote them word for word.
#[path = "../../src/commands/wording.rs"]
pub mod wording;
pub mod workplace;

use std::path::Path;

use metrolight::sampling::IndependentSampler;
use metrolight::sampling::seeds::Purpose;
use metrolight::scene::Scene;

/// Loads a scene of the repository, with `-D`-like defines.
pub fn load(path: &str, defines: &[(&str, &str)]) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    let defines: Vec<(String, String)> = defines
        .iter()
        .map(|(k, v)| ((*k).into(), (*v).into()))
        .collect();
    let loaded = metrolight::mitsuba::load(&path, &defines).expect("a scene of the repository");
    loaded
        .description
        .build()
        .expect("a scene of the repository")
}

/// Point number `i` of the hypercube.
pub fn sample(i: u64) -> IndependentSampler {
    IndependentSampler::new(0, Purpose::Tests, i)
}
