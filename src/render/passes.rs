//! The pass loop: each pass takes one sample of every pixel, tile by tile.

use std::ops::Range;

use rayon::prelude::*;

use super::clock::Clock;
use super::pixel_sampler::{PixelSampler, PixelSamples};
use crate::integrators::Workspace;
use crate::scene::{RayCounts, Scene};

/// Pixels of one tile.
const TILE: u64 = 256;

/// Minimum number of tiles sampled in parallel, unless the pass ends, so that no thread is idle.
const MIN_TILES: u64 = 8;

/// Maximum number of samples between two checks of the clock.
pub(super) const BLOCK: u64 = 1 << 16;

/// Consecutive pixels, with one sample each.
pub(super) struct Tile {
    /// The pass.
    pub pass: u64,
    /// Indices of the pixels, in rows from the top.
    pub pixels: Range<u64>,
}

impl Tile {
    /// Number of samples.
    pub fn samples(&self) -> u64 {
        self.pixels.end - self.pixels.start
    }
}

/// The results of the samples of a tile. The memory is reused for later tiles.
pub(super) trait TileBuffer: Default + Send + Sync {
    /// Removes all results.
    fn clear(&mut self);
}

/// The state of the loop. The samples depend only on the scene and the seed.
pub(super) struct PassLoop<B> {
    samples: PixelSamples,
    tiles_per_pass: u64,
    /// Index of the next tile, counted from the first pass on.
    next_tile: u64,
    /// Memory for the tiles of a block.
    buffers: Vec<(Workspace, B)>,
    /// Samples taken.
    done: u64,
}

impl<B: TileBuffer> PassLoop<B> {
    /// A loop at the start of the first pass.
    pub fn new(scene: &Scene, seed: u64) -> Self {
        let samples = PixelSamples::new(scene, seed);
        Self {
            tiles_per_pass: samples.pixels().div_ceil(TILE),
            samples,
            next_tile: 0,
            buffers: Vec::new(),
            done: 0,
        }
    }

    /// Takes the next samples in parallel, about as many as `block`, within the budget of `clock`. `sample` is called for each
    /// pixel with its sampler and the buffer of its tile. Returns the tiles in order, with their buffers; fewer, or
    /// none, if the observer cancels meanwhile.
    pub fn advance(
        &mut self,
        clock: &Clock,
        block: u64,
        sample: impl Fn(u64, &mut PixelSampler, &mut Workspace, &mut B) + Sync,
    ) -> Vec<(Tile, &B)> {
        // A block consists of whole tiles of one pass.
        let left_in_pass = self.tiles_per_pass - self.next_tile % self.tiles_per_pass;
        let block = block.div_ceil(TILE);
        let block = block.max(MIN_TILES).min(left_in_pass);
        let block = block.min(self.tiles_left(clock)).max(1);
        let first = self.next_tile;
        let tile = |i: usize| {
            let index = first + i as u64;
            let begin = index % self.tiles_per_pass * TILE;
            Tile {
                pass: index / self.tiles_per_pass,
                pixels: begin..self.samples.pixels().min(begin + TILE),
            }
        };
        let mut tiles: Vec<Tile> = (0..block as usize).map(tile).collect();
        let needed = self.buffers.len().max(tiles.len());
        self.buffers.resize_with(needed, Default::default);
        let samples = &self.samples;
        let active = tiles.par_iter().zip(self.buffers.par_iter_mut());
        let complete = active.map(|(tile, (workspace, buffer))| {
            buffer.clear();
            if clock.is_cancelled() {
                return false;
            }
            for pixel in tile.pixels.clone() {
                let mut sampler = samples.sample(tile.pass, pixel);
                sample(pixel, &mut sampler, workspace, buffer);
            }
            true
        });
        let complete: Vec<bool> = complete.collect();

        // A cancelled block ends before the first tile that is missing.
        let count = complete.iter().take_while(|complete| **complete).count();
        tiles.truncate(count);
        self.done += tiles.iter().map(Tile::samples).sum::<u64>();
        self.next_tile += count as u64;
        let buffers = self.buffers.iter().map(|(_, buffer)| buffer);
        tiles.into_iter().zip(buffers).collect()
    }

    /// Number of tiles until the budget is spent, if it is a number of samples.
    fn tiles_left(&self, clock: &Clock) -> u64 {
        let Some(total) = clock.total_samples() else {
            return u64::MAX;
        };
        let (passes, rest) = (total / self.samples.pixels(), total % self.samples.pixels());
        let tiles = passes.saturating_mul(self.tiles_per_pass);
        tiles
            .saturating_add(rest.div_ceil(TILE))
            .saturating_sub(self.next_tile)
    }

    /// True if all pixels have the same number of samples.
    pub fn at_pass_end(&self) -> bool {
        self.next_tile.is_multiple_of(self.tiles_per_pass)
    }

    /// Samples taken.
    pub fn samples(&self) -> u64 {
        self.done
    }

    /// True if every pixel has a sample.
    pub fn is_complete(&self) -> bool {
        self.done >= self.samples.pixels()
    }

    /// Rays traced.
    pub fn rays(&self) -> RayCounts {
        self.buffers.iter().map(|(w, _)| w.rays).sum()
    }
}
