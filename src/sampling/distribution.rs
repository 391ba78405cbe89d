//! Discrete and piecewise constant distributions, sampled by inversion: monotone, so that a small
//! step of the random number is a small step of the outcome.
//!
//! Random numbers in [0, 1) are multiples of 2^-24, so probabilities are too: an outcome owns a whole
//! number of them, and is chosen with exactly the probability that it claims. A small step may leave
//! the multiples; which outcome a number chooses depends only on the multiple below it, so the
//! probabilities are the same for numbers that are uniform among all reals.

/// How many random numbers there are in [0, 1), all equally likely.
const NUMBERS: u32 = 1 << 24;

/// Most outcomes of positive weight: each owns a random number at least.
pub const MAX_OUTCOMES: usize = NUMBERS as usize;

/// A distribution over `0..len`, proportional to given weights; O(log n) to sample.
#[derive(Clone, Debug)]
pub struct Distribution1D {
    /// `below[i]` is how many random numbers choose an outcome below `i`; `len + 1` values from 0 to
    /// [`NUMBERS`].
    below: Vec<u32>,
    total: f64,
}

impl Distribution1D {
    /// A distribution proportional to `weights`; `None` if there are none, if one is negative or
    /// not finite, if all are 0, or if more than [`MAX_OUTCOMES`] are not.
    ///
    /// Every outcome of positive weight gets one random number first: without one it would be lost
    /// without a trace, however much depends on it. The others are dealt out in proportion. So where
    /// n outcomes are possible, a probability differs from its share p of the weights by at most
    /// (n p + 2) 2^-24.
    pub fn new(weights: impl IntoIterator<Item = f64>) -> Option<Self> {
        let weights: Vec<f64> = weights.into_iter().collect();
        if !weights.iter().all(|w| *w >= 0.0 && w.is_finite()) {
            return None;
        }
        let total: f64 = weights.iter().sum();
        let possible = weights.iter().filter(|w| **w > 0.0).count();
        if possible == 0 || possible > MAX_OUTCOMES || !total.is_finite() {
            return None;
        }
        let to_share = f64::from(NUMBERS - possible as u32);
        let (mut sum, mut owners) = (0.0, 0);
        let mut below = Vec::with_capacity(weights.len() + 1);
        below.push(0);
        for weight in weights {
            sum += weight;
            owners += u32::from(weight > 0.0);
            below.push(owners + (sum / total * to_share).round() as u32);
        }
        Some(Self { below, total })
    }

    /// Number of outcomes.
    pub fn len(&self) -> usize {
        self.below.len() - 1
    }

    /// Never true: a distribution has at least one outcome.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// Sum of the weights it was made from.
    pub fn total(&self) -> f64 {
        self.total
    }

    /// Probability of outcome `i`: exact, and exactly what [`Self::sample`] does.
    #[inline]
    pub fn probability(&self, i: usize) -> f32 {
        (self.below[i + 1] - self.below[i]) as f32 / NUMBERS as f32
    }

    /// The outcome for `u` in [0, 1), and the part of `u` that the choice did not use, to be spent on
    /// a place within the outcome: of k random numbers that choose it, each gets the middle of one
    /// of k equal parts of [0, 1).
    #[inline]
    pub fn sample(&self, u: f32) -> (usize, f32) {
        // Exact: the factor is a power of two.
        let number = ((u * NUMBERS as f32) as u32).min(NUMBERS - 1);
        // The last outcome whose numbers begin at this one or before; it has some.
        let i = self.below.partition_point(|&below| below <= number) - 1;
        let [first, end] = [self.below[i], self.below[i + 1]];
        let rest = ((number - first) as f32 + 0.5) / (end - first) as f32;
        (i, rest.min(1.0 - f32::EPSILON / 2.0))
    }
}

/// A distribution over the cells of a grid: rows chosen by a marginal distribution, columns by a
/// conditional one.
#[derive(Clone, Debug)]
pub struct Distribution2D {
    rows: Distribution1D,
    /// One per row; `None` for a row of weight 0, which is never chosen.
    columns: Vec<Option<Distribution1D>>,
}

/// A place in a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// From 0.
    pub column: usize,
    /// From 0.
    pub row: usize,
    /// Within the cell, in [0, 1)^2: column-wise, then row-wise.
    pub within: [f32; 2],
}

impl Distribution2D {
    /// From `weights` in row-major order, `width` a row; `None` as for [`Distribution1D::new`].
    pub fn new(weights: &[f64], width: usize) -> Option<Self> {
        if width == 0 || !weights.len().is_multiple_of(width) {
            return None;
        }
        let rows = Distribution1D::new(weights.chunks(width).map(|row| row.iter().sum()))?;
        let mut columns = Vec::with_capacity(rows.len());
        for row in weights.chunks(width) {
            let is_void = row.iter().all(|&weight| weight == 0.0);
            columns.push(if is_void {
                None
            } else {
                Some(Distribution1D::new(row.iter().copied())?)
            });
        }
        Some(Self { rows, columns })
    }

    /// A place chosen by `u` in [0, 1)^2, whose first number chooses the column. Uniform within its
    /// cell.
    #[inline]
    pub fn sample(&self, u: [f32; 2]) -> Cell {
        let (row, y) = self.rows.sample(u[1]);
        let (column, x) = match &self.columns[row] {
            Some(columns) => columns.sample(u[0]),
            None => (0, u[0]),
        };
        Cell {
            column,
            row,
            within: [x, y],
        }
    }

    /// Probability of a cell.
    #[inline]
    pub fn probability(&self, column: usize, row: usize) -> f32 {
        match &self.columns[row] {
            Some(columns) => self.rows.probability(row) * columns.probability(column),
            None => 0.0,
        }
    }
}
