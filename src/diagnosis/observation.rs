//! What tests look at in a state of a chain.

use crate::markov::{Sample, SmallStep, Target};

/// Tiles of the image in a row and in a column.
pub const TILES: usize = 8;

/// Coordinates of the hypercube that are watched.
pub const COORDINATES: usize = 4;

/// Kinds of paths that are told apart.
pub const TECHNIQUES: usize = 64;

/// What a state is like, besides its density.
#[derive(Clone, Debug, Default)]
pub struct Observation {
    /// What the brightest of its paths is like.
    pub features: Features,
    /// The parts of its density, which is their sum, with the tile in which each lands.
    pub light: Vec<(usize, f64)>,
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
    /// Single coordinates of the hypercube; NaN where the state has none.
    pub coordinates: [f64; COORDINATES],
}

impl Features {
    /// Those of a chain's state.
    pub fn of(sample: &Sample<Observation>) -> Self {
        Self {
            log_density: sample.density.ln(),
            ..sample.contribution.features
        }
    }

    /// Block of 2 x 2 tiles, of which the image has 4 x 4.
    pub fn block(&self) -> usize {
        let [row, column] = [self.tile / TILES, self.tile % TILES];
        row / 2 * (TILES / 2) + column / 2
    }

    /// Block of tiles x technique: a cell for counts.
    pub fn cell(&self) -> usize {
        self.block() * TECHNIQUES + self.technique
    }

    /// Number of cells.
    pub const CELLS: usize = TILES * TILES / 4 * TECHNIQUES;
}

/// The tile of a place in a rectangle of `size`.
pub fn tile_at(place: [f64; 2], size: [f64; 2]) -> usize {
    let index = |i: usize| ((place[i] / size[i] * TILES as f64) as usize).min(TILES - 1);
    index(1) * TILES + index(0)
}

/// A target whose chains can be diagnosed.
pub trait Subject: Sync {
    /// The target, with what tests look at.
    type Target: Target<Contribution = Observation>;

    /// A target to be used by one thread.
    fn target(&self) -> Self::Target;

    /// What is plainly sampled, without a chain: independent estimates of the integral of I over
    /// each tile. Their sum over all tiles estimates b. One vector for each estimate.
    fn plain(&self, seed: u64) -> Vec<Vec<f64>>;

    /// Small steps of the chains.
    fn small_step(&self) -> SmallStep {
        SmallStep::default()
    }
}
