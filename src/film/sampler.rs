//! Film positions of the samples of a pixel.

use super::filter::{Filter, FilterSampler};

/// Filter importance sampling (Ernst et al. 2006, "Filter importance sampling"): the density of a
/// pixel's samples is proportional to its reconstruction filter, so that the pixel's value is their
/// unweighted mean. At the border of the film the filter is truncated and renormalised.
#[derive(Clone, Debug)]
pub struct FilmSampler {
    filter: Filter,
    sampler: FilterSampler,
    /// Per column and per row, the antiderivative of the filter at both ends of its part within the
    /// film.
    columns: Vec<[f64; 2]>,
    rows: Vec<[f64; 2]>,
}

impl FilmSampler {
    /// For a film of `width` x `height` pixels.
    pub fn new(width: u32, height: u32, filter: Filter) -> Self {
        Self {
            filter,
            sampler: FilterSampler::new(filter),
            columns: filter.parts_within(width),
            rows: filter.parts_within(height),
        }
    }

    /// Maps `u` in [0, 1)^2 to the film position, in [0, 1)^2, of a sample of `pixel` (index in rows
    /// from the top).
    #[inline]
    pub fn pixel_position(&self, pixel: usize, u: [f32; 2]) -> [f32; 2] {
        let width = self.columns.len();
        [
            self.position(&self.columns, pixel % width, u[0]),
            self.position(&self.rows, pixel / width, u[1]),
        ]
    }

    /// Density, over the film as a unit square, of the position of a sample of a uniformly chosen
    /// pixel: the mean of all pixels' normalised filters. It is 1 everywhere for box filters.
    pub fn density(&self, position: [f32; 2]) -> f64 {
        self.side_density(&self.columns, position[0]) * self.side_density(&self.rows, position[1])
    }

    fn side_density(&self, parts: &[[f64; 2]], position: f32) -> f64 {
        let position = f64::from(position) * parts.len() as f64;
        let reached = self.filter.reach(position, parts.len());
        let pixels = reached.clone().zip(&parts[reached]);
        pixels
            .map(|(j, [a, b])| self.filter.evaluate(position - (j as f64 + 0.5)) / (b - a))
            .sum()
    }

    #[inline]
    fn position(&self, parts: &[[f64; 2]], j: usize, u: f32) -> f32 {
        let [begin, end] = parts[j];
        let offset = self.sampler.invert(begin + f64::from(u) * (end - begin));
        let position = (j as f64 + 0.5 + offset) / parts.len() as f64;
        (position as f32).clamp(0.0, 1.0 - f32::EPSILON / 2.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Counts evenly spaced positions of all pixels in cells and compares them with the mean density of
    /// the cells. A count of about 10^4 has an error of some 1%, from the border of its cell.
    #[test]
    fn samples_have_the_evaluated_density() {
        const SIDE: usize = 10;
        let filters = [
            Filter::Box,
            Filter::Tent { radius: 1.3 },
            Filter::Gaussian { stddev: 0.5 },
        ];
        for filter in filters {
            let sampler = FilmSampler::new(5, 5, filter);
            let mut counts = [[0u32; SIDE]; SIDE];
            let side = 200;
            for pixel in 0..25 {
                for i in 0..side * side {
                    let u = [i % side, i / side].map(|j| (j as f32 + 0.5) / side as f32);
                    let [x, y] = sampler.pixel_position(pixel, u);
                    let cell = |x: f32| (x * SIDE as f32) as usize;
                    counts[cell(y)][cell(x)] += 1;
                }
            }
            let per_cell = (25 * side * side) as f64 / (SIDE * SIDE) as f64;
            for (row, counts) in counts.iter().enumerate() {
                for (column, &count) in counts.iter().enumerate() {
                    let densities = (0..64).map(|i| {
                        let position = |cell: usize, i: usize| {
                            (cell as f32 + (i as f32 + 0.5) / 8.0) / SIDE as f32
                        };
                        sampler.density([position(column, i % 8), position(row, i / 8)])
                    });
                    let density = densities.sum::<f64>() / 64.0;
                    let counted = f64::from(count) / per_cell;
                    assert!(
                        (density - counted).abs() < 0.02 * counted,
                        "{filter:?}, cell {column} {row}: {density} and {counted}"
                    );
                }
            }
        }
    }
}
