//! An importance map of the image: a coarse estimate of its luminance, by which samples are weighted so
//! that dark regions receive enough of the work (Veach and Guibas 1997, "Metropolis light transport",
//! section 5.3; Hoberock and Hart 2010, "Arbitrary importance functions for Metropolis light transport").

use crate::film::Splat;
use crate::math::luminance;

/// Expected luminance at every film position, in the unit of the image: positive, and constant within each
/// cell.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportanceMap {
    columns: usize,
    rows: usize,
    cells: Vec<f32>,
}

impl ImportanceMap {
    /// Mean number of samples per cell, unless [`Self::MAX_CELLS`] limits the number of cells.
    const SAMPLES_PER_CELL: f64 = 64.0;

    /// Maximum number of cells.
    const MAX_CELLS: f64 = 1024.0;

    /// Lower bound on a cell, relative to the mean of the image: light there may have been missed.
    const MIN_LEVEL: f64 = 0.02;

    /// Upper bound on a splat, relative to the mean of the image, so that a single bright path does not
    /// dominate its cell.
    const MAX_SPLAT: f64 = 50.0;

    /// The luminance `mean` everywhere, or 1 if the pilot has found no light.
    pub fn uniform(mean: f64) -> Self {
        let level = if mean > 0.0 { mean as f32 } else { 1.0 };
        Self {
            columns: 1,
            rows: 1,
            cells: vec![level],
        }
    }

    /// From the splats of `samples` uniform samples of a film of `size` pixels, blurred by one cell.
    pub fn new(splats: &[Splat], samples: u64, size: [u32; 2]) -> Self {
        let mean = Self::mean(splats, samples);
        if mean <= 0.0 {
            return Self::uniform(mean);
        }
        let cells = (samples as f64 / Self::SAMPLES_PER_CELL).clamp(1.0, Self::MAX_CELLS);
        let aspect = f64::from(size[0]) / f64::from(size[1]);
        let columns = (cells * aspect).sqrt().round().clamp(1.0, Self::MAX_CELLS) as usize;
        let rows = ((cells / columns as f64).round() as usize).max(1);
        let mut map = Self {
            columns,
            rows,
            cells: vec![0.0; columns * rows],
        };
        let mut sums = vec![0.0; columns * rows];
        for splat in splats {
            sums[map.cell(splat.position)] += splat_luminance(splat).min(Self::MAX_SPLAT * mean);
        }
        let per_sample = (columns * rows) as f64 / samples as f64;
        for row in 0..rows {
            for column in 0..columns {
                let cell = map.blurred(&sums, column, row) * per_sample;
                map.cells[row * columns + column] = cell.max(Self::MIN_LEVEL * mean) as f32;
            }
        }
        map
    }

    /// Mean luminance of the image, from the splats of `samples` uniform samples.
    pub fn mean(splats: &[Splat], samples: u64) -> f64 {
        splats.iter().map(splat_luminance).sum::<f64>() / samples.max(1) as f64
    }

    /// The expected luminance at `position`, in [0, 1)^2.
    #[inline]
    pub fn at(&self, position: [f32; 2]) -> f32 {
        self.cells[self.cell(position)]
    }

    #[inline]
    fn cell(&self, [x, y]: [f32; 2]) -> usize {
        let column = ((x * self.columns as f32) as usize).min(self.columns - 1);
        let row = ((y * self.rows as f32) as usize).min(self.rows - 1);
        row * self.columns + column
    }

    /// The binomial filter (1, 2, 1)/4 along both axes, truncated and renormalised at the border.
    fn blurred(&self, sums: &[f64], column: usize, row: usize) -> f64 {
        let around = |i: usize, end: usize| i.saturating_sub(1)..(i + 2).min(end);
        let (mut sum, mut weights) = (0.0, 0.0);
        for y in around(row, self.rows) {
            for x in around(column, self.columns) {
                let weight = if x == column { 2.0 } else { 1.0 } * if y == row { 2.0 } else { 1.0 };
                sum += weight * sums[y * self.columns + x];
                weights += weight;
            }
        }
        sum / weights
    }
}

fn splat_luminance(splat: &Splat) -> f64 {
    f64::from(luminance(splat.value))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rgb;

    /// One splat at the centre of each cell of a 256 x 256 grid, dark on the left and bright on the right.
    fn two_halves() -> Vec<Splat> {
        let side = 256;
        let splat = |i: usize| {
            let position = [i % side, i / side].map(|j| (j as f32 + 0.5) / side as f32);
            let value = Rgb::splat(if position[0] < 0.5 { 1.0 } else { 3.0 });
            Splat { position, value }
        };
        (0..side * side).map(splat).collect()
    }

    #[test]
    fn a_map_estimates_the_luminance() {
        let splats = two_halves();
        let map = ImportanceMap::new(&splats, splats.len() as u64, [64, 64]);
        for (position, expected) in [([0.1, 0.5], 1.0), ([0.9, 0.1], 3.0), ([0.7, 0.99], 3.0)] {
            let found = map.at(position);
            assert!((found - expected).abs() < 1e-3, "{position:?}: {found}");
        }
    }

    #[test]
    fn darkness_and_single_bright_splats_are_bounded() {
        let mut splats = two_halves();
        let samples = splats.len() as u64;
        splats.retain(|splat| splat.position[0] > 0.5);
        splats.push(Splat {
            position: [0.75, 0.5],
            value: Rgb::splat(1e4),
        });
        let map = ImportanceMap::new(&splats, samples, [64, 64]);
        let dark = map.at([0.1, 0.5]);
        assert!(dark > 0.02 && dark < 0.05, "{dark}");
        let bright = map.at([0.75, 0.5]);
        assert!(bright < 5.0, "{bright}");
    }
}
