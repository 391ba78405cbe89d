//! Code that several integration tests share.
#![allow(dead_code)] // Each test binary uses its own part.

pub mod comparison;
pub mod figures;
pub mod page;
pub mod reference;
pub mod renders;
pub mod scenes;
pub mod tiles;
pub mod truths;
pub mod workplace;

use std::path::Path;

use metrolight::sampling::{Coordinates, Stream};
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

/// A point of the hypercube whose coordinates are a hash of their address, so that reading them again
/// gives the same values.
#[derive(Clone, Debug)]
pub struct HashedPoint {
    seed: u64,
}

impl HashedPoint {
    /// A different point for each seed.
    pub fn new(seed: u64) -> Self {
        Self { seed }
    }
}

impl Coordinates for HashedPoint {
    fn read<const N: usize>(&mut self, stream: Stream, first: usize) -> [f32; N] {
        std::array::from_fn(|i| {
            let mut z = self.seed.wrapping_mul(0x9e37_79b9_7f4a_7c15)
                ^ ((stream as u64) << 40)
                ^ ((first + i) as u64 + 1).wrapping_mul(0xd6e8_feb8_6659_fd93);
            z = (z ^ (z >> 32)).wrapping_mul(0xd6e8_feb8_6659_fd93);
            z = (z ^ (z >> 32)).wrapping_mul(0xd6e8_feb8_6659_fd93);
            z ^= z >> 32;
            (z >> 40) as f32 / (1u32 << 24) as f32
        })
    }
}
