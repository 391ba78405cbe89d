//! The observed quantities of a state of a chain.

use super::check::Check;
use crate::markov::{Mutations, Sample, Target};

/// Tiles of the image in a row and in a column.
pub const TILES: usize = 8;

/// Number of observed dimensions of the hypercube.
pub const COORDINATES: usize = 4;

/// Number of techniques that are distinguished.
pub const TECHNIQUES: usize = 64;

/// The observed quantities of a state, besides its density.
#[derive(Clone, Debug, Default)]
pub struct Observation {
    /// Features of the brightest path.
    pub features: Features,
    /// Tiles of the image and the part of the density in each. The sum is the density. No tile is repeated.
    pub light: Vec<(usize, f64)>,
}

impl Observation {
    /// Adds light to a tile.
    pub fn add(&mut self, tile: usize, light: f64) {
        match self.light.iter_mut().find(|(known, _)| *known == tile) {
            Some((_, sum)) => *sum += light,
            None => self.light.push((tile, light)),
        }
    }
}

/// Estimates from independent uniform samples, without a chain.
#[derive(Clone, Debug, PartialEq)]
pub struct IndependentEstimate {
    /// Number of samples.
    pub samples: u64,
    /// Mean of I over them, by tile.
    pub tiles: Vec<f64>,
}

/// Numbers that describe a state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Features {
    /// log I(u).
    pub log_density: f64,
    /// Tile of the image, in rows from the top; below [`TILES`] squared.
    pub tile: usize,
    /// Technique; below [`TECHNIQUES`].
    pub technique: usize,
    /// Length of the path in edges.
    pub length: f64,
    /// Observed coordinates; NaN if the state does not use them.
    pub coordinates: [f64; COORDINATES],
}

impl Features {
    /// Features of a state of a chain.
    pub fn of(sample: &Sample<Observation>) -> Self {
        Self {
            log_density: sample.density.ln(),
            ..sample.contribution.features
        }
    }

    /// Index of the block of 2 x 2 tiles. The image has 4 x 4 blocks.
    pub fn block(&self) -> usize {
        let [row, column] = [self.tile / TILES, self.tile % TILES];
        row / 2 * (TILES / 2) + column / 2
    }

    /// Index of the cell for counts: block of tiles x technique.
    pub fn cell(&self) -> usize {
        self.block() * TECHNIQUES + self.technique
    }

    /// Number of cells.
    pub const CELLS: usize = TILES * TILES / 4 * TECHNIQUES;
}

/// A scalar function of the state, whose mixing is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// log I(u).
    LogDensity,
    /// Film position of the camera subpath, from left to right.
    FilmX,
    /// Film position of the camera subpath, from top to bottom.
    FilmY,
    /// Length of the path in edges.
    Length,
}

impl Quantity {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::LogDensity, Self::FilmX, Self::FilmY, Self::Length];

    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::LogDensity => "log I",
            Self::FilmX => "film x",
            Self::FilmY => "film y",
            Self::Length => "path length",
        }
    }

    /// Its value in a state.
    pub fn of(self, state: &Features) -> f64 {
        match self {
            Self::LogDensity => state.log_density,
            Self::FilmX => state.coordinates[0],
            Self::FilmY => state.coordinates[1],
            Self::Length => state.length,
        }
    }
}

/// The tile at `position` in a rectangle of `size`.
pub fn tile_at(position: [f64; 2], size: [f64; 2]) -> usize {
    let index = |i: usize| ((position[i] / size[i] * TILES as f64) as usize).min(TILES - 1);
    index(1) * TILES + index(0)
}

/// A target, and the chains on it that are diagnosed.
pub trait ChainTarget: Sync {
    /// The target, with the observed quantities.
    type Target<'t>: Target<Contribution = Observation>
    where
        Self: 't;

    /// A target for one thread.
    fn target(&self) -> Self::Target<'_>;

    /// Kinds of mutations of the chains.
    fn mutations(&self) -> Mutations;

    /// Estimates the target from independent samples, as far as possible by code that chains do not use.
    fn independent(&self, seed: u64) -> IndependentEstimate;

    /// True if the chains of a render start from a finite bootstrap, which biases their first states.
    fn starts_from_bootstrap(&self) -> bool {
        true
    }

    /// Tests that are specific to this target.
    fn own_checks(&self, _seed: u64) -> Vec<Check> {
        Vec::new()
    }
}
