//! Splats: contributions to any point of the film, and their accumulation.

use rayon::prelude::*;

use super::Filter;
use crate::math::Rgb;

/// A contribution to a point of the film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Splat {
    /// In [0, 1)^2; (0, 0) is the top left corner of the image.
    pub position: [f32; 2],
    /// A sample of the integral over the film, taken as the unit square.
    pub value: Rgb,
}

/// Splats in the order of their creation. Clear and refill it to reuse its memory.
#[derive(Clone, Debug, Default)]
pub struct SplatLog {
    splats: Vec<Splat>,
}

impl SplatLog {
    /// A log without splats.
    pub fn new() -> Self {
        Self::default()
    }

    /// Appends a splat. Its value must be finite.
    #[inline]
    pub fn push(&mut self, splat: Splat) {
        self.splats.push(splat);
    }

    /// Removes all splats and keeps the memory.
    pub fn clear(&mut self) {
        self.splats.clear();
    }

    /// All splats, in order.
    pub fn splats(&self) -> &[Splat] {
        &self.splats
    }
}

/// For each pixel, the sum of all splats times the pixel's normalised filter.
#[derive(Clone, Debug, PartialEq)]
pub struct SplatFilm {
    grid: Grid,
    sums: Vec<[f64; 3]>,
}

impl SplatFilm {
    /// A black film of `width` x `height` pixels, both at least 1.
    pub fn new(width: u32, height: u32, filter: Filter) -> Self {
        Self {
            grid: Grid::new(width, height, filter),
            sums: vec![[0.0; 3]; width as usize * height as usize],
        }
    }

    /// Pixels in a row and in a column.
    pub fn size(&self) -> [usize; 2] {
        [self.grid.columns.len(), self.grid.rows.len()]
    }

    /// Adds a splat to every pixel whose filter reaches its position.
    pub fn splat(&mut self, splat: &Splat) {
        let mut scratch = Vec::new();
        self.grid.add(&mut self.sums, 0, splat, &mut scratch);
    }

    /// Adds all splats of `logs`, those of the first log first. Bands of rows are filled in parallel,
    /// and every pixel adds its splats in the order of the logs: the sums are bit-identical for any
    /// number of threads.
    pub fn apply(&mut self, logs: &[&SplatLog]) {
        let grid = &self.grid;
        let orders: Vec<BandOrder> = logs.par_iter().map(|log| grid.sort(log)).collect();
        let band_pixels = grid.band_rows * grid.columns.len();
        let bands = self.sums.par_chunks_mut(band_pixels).enumerate();
        bands.for_each(|(band, sums)| {
            let mut scratch = Vec::new();
            for (log, order) in logs.iter().zip(&orders) {
                for &i in order.of(band) {
                    grid.add(sums, band * grid.band_rows, &log.splats[i], &mut scratch);
                }
            }
        });
    }

    /// Moves the sums of `other`, a film of the same size, into this one.
    pub fn take(&mut self, other: &mut Self) {
        for (sum, taken) in self.sums.iter_mut().zip(&mut other.sums) {
            add(sum, std::mem::take(taken));
        }
    }

    /// The sum at a pixel (index in rows from the top).
    #[inline]
    pub fn sum(&self, pixel: usize) -> [f64; 3] {
        self.sums[pixel]
    }
}

#[inline]
pub(super) fn add(sum: &mut [f64; 3], value: [f64; 3]) {
    for (s, v) in sum.iter_mut().zip(value) {
        *s += v;
    }
}

/// Positions of pixels and normalisation of their filters.
#[derive(Clone, Debug, PartialEq)]
struct Grid {
    filter: Filter,
    /// Per column and per row, the normalisation of the filter on a film of unit width: the number of
    /// pixels along the side over the integral of the filter within the film, in pixels.
    columns: Vec<f64>,
    rows: Vec<f64>,
    /// Rows that one task of [`SplatFilm::apply`] fills; the same for any number of threads.
    band_rows: usize,
}

/// The splats of one log by the bands of rows that they reach: a stable counting sort.
struct BandOrder {
    /// Index in `splats` of the start of each band, and of the end of the last one.
    starts: Vec<usize>,
    /// Indices in the log, ascending within a band.
    splats: Vec<usize>,
}

impl BandOrder {
    fn of(&self, band: usize) -> &[usize] {
        &self.splats[self.starts[band]..self.starts[band + 1]]
    }
}

impl Grid {
    /// Minimum height of a band: a splat rarely reaches more than two bands.
    const MIN_BAND_ROWS: usize = 8;
    /// Maximum number of bands: about the largest number of threads that can be used.
    const MAX_BANDS: usize = 64;

    fn new(width: u32, height: u32, filter: Filter) -> Self {
        let normalise = |size: u32| -> Vec<f64> {
            let parts = filter.parts_within(size);
            parts
                .iter()
                .map(|[a, b]| f64::from(size) / (b - a))
                .collect()
        };
        let rows = normalise(height);
        let band_rows = rows
            .len()
            .div_ceil(Self::MAX_BANDS)
            .max(Self::MIN_BAND_ROWS);
        Self {
            filter,
            columns: normalise(width),
            rows,
            band_rows,
        }
    }

    /// Adds a splat to the rows of a film in `sums`, which begin with row `first_row`. `scratch` is
    /// memory for a row of weights.
    #[inline]
    fn add(&self, sums: &mut [[f64; 3]], first_row: usize, splat: &Splat, scratch: &mut Vec<f64>) {
        let width = self.columns.len();
        let x = f64::from(splat.position[0]) * width as f64;
        let y = f64::from(splat.position[1]) * self.rows.len() as f64;
        let columns = self.filter.reach(x, width);
        let rows = self.filter.reach(y, first_row + sums.len() / width);

        scratch.clear();
        scratch.extend(columns.clone().map(|j| self.weight(&self.columns, x, j)));
        let value = splat.value.to_array().map(f64::from);
        for row in rows.start.max(first_row)..rows.end {
            let row_weight = self.weight(&self.rows, y, row);
            let begin = (row - first_row) * width;
            let pixels = &mut sums[begin + columns.start..begin + columns.end];
            for (pixel, &column_weight) in pixels.iter_mut().zip(scratch.iter()) {
                let weight = row_weight * column_weight;
                add(pixel, value.map(|v| v * weight));
            }
        }
    }

    /// The normalised filter of pixel `j` along one side, at `position` in pixels.
    #[inline]
    fn weight(&self, normalisation: &[f64], position: f64, j: usize) -> f64 {
        self.filter.evaluate(position - (j as f64 + 0.5)) * normalisation[j]
    }

    fn sort(&self, log: &SplatLog) -> BandOrder {
        let height = self.rows.len();
        let bands = |splat: &Splat| {
            let rows = self
                .filter
                .reach(f64::from(splat.position[1]) * height as f64, height);
            rows.start / self.band_rows..rows.end.div_ceil(self.band_rows)
        };
        // Counts, shifted by one band: their prefix sums are the starts of the bands.
        let mut starts = vec![0; height.div_ceil(self.band_rows) + 1];
        for splat in &log.splats {
            bands(splat).for_each(|band| starts[band + 1] += 1);
        }
        for band in 1..starts.len() {
            starts[band] += starts[band - 1];
        }
        let mut next = starts.clone();
        let mut splats = vec![0; starts[starts.len() - 1]];
        for (i, splat) in log.splats.iter().enumerate() {
            for band in bands(splat) {
                splats[next[band]] = i;
                next[band] += 1;
            }
        }
        BandOrder { starts, splats }
    }
}
