//! Discrete and piecewise constant distributions, sampled by inversion. The inversion is monotone, so
//! that a small change of the random number is a small change of the outcome.
//!
//! Random numbers in [0, 1) are multiples of 2^-24, and so are probabilities: each outcome is assigned a
//! whole number of these multiples, and is chosen with exactly the probability that is returned for it.
//! A small-step mutation may produce a number between two multiples; the outcome depends only on the
//! multiple below it, so that the probabilities are the same for numbers uniform among all reals.

/// Number of multiples of 2^-24 in [0, 1), all equally likely.
const RESOLUTION: u32 = 1 << 24;

/// Maximum number of outcomes of positive weight, each of which is assigned at least one multiple.
pub const MAX_OUTCOMES: usize = RESOLUTION as usize;

/// A distribution over `0..len`, proportional to given weights; sampling takes O(log n).
#[derive(Clone, Debug)]
pub struct Distribution1D {
    /// `cumulative[i]` is the number of multiples assigned to outcomes below `i`; `len + 1` values from 0
    /// to [`RESOLUTION`].
    cumulative: Vec<u32>,
    total: f64,
}

impl Distribution1D {
    /// A distribution proportional to `weights`; `None` if there are none, if one is negative or
    /// not finite, if all are 0, or if more than [`MAX_OUTCOMES`] are not.
    ///
    /// Every outcome of positive weight is assigned one multiple first, since an outcome that is never
    /// chosen would bias estimates. The others are assigned in proportion to the weights. With n possible
    /// outcomes, a probability differs from the normalised weight p by at most (n p + 2) 2^-24.
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
        let remaining = f64::from(RESOLUTION - possible as u32);
        let (mut sum, mut positive) = (0.0, 0);
        let mut cumulative = Vec::with_capacity(weights.len() + 1);
        cumulative.push(0);
        for weight in weights {
            sum += weight;
            positive += u32::from(weight > 0.0);
            cumulative.push(positive + (sum / total * remaining).round() as u32);
        }
        Some(Self { cumulative, total })
    }

    /// Number of outcomes.
    pub fn len(&self) -> usize {
        self.cumulative.len() - 1
    }

    /// Never true: a distribution has at least one outcome.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// Sum of the weights.
    pub fn total(&self) -> f64 {
        self.total
    }

    /// Probability with which [`Self::sample`] chooses outcome `i`, exactly.
    #[inline]
    pub fn probability(&self, i: usize) -> f32 {
        (self.cumulative[i + 1] - self.cumulative[i]) as f32 / RESOLUTION as f32
    }

    /// The outcome for `u` in [0, 1), and `u` rescaled to [0, 1) within the outcome, for reuse: the k
    /// multiples of an outcome are mapped to the midpoints of k equal parts of [0, 1).
    #[inline]
    pub fn sample(&self, u: f32) -> (usize, f32) {
        // Exact: the factor is a power of two.
        let number = ((u * RESOLUTION as f32) as u32).min(RESOLUTION - 1);
        // The last outcome whose multiples begin at `number` or below; it has at least one.
        let i = self.cumulative.partition_point(|&c| c <= number) - 1;
        let [first, end] = [self.cumulative[i], self.cumulative[i + 1]];
        let within = ((number - first) as f32 + 0.5) / (end - first) as f32;
        (i, within.min(1.0 - f32::EPSILON / 2.0))
    }
}

/// A distribution over the cells of a grid: the marginal distribution of rows, and the conditional
/// distribution of columns for each row.
#[derive(Clone, Debug)]
pub struct Distribution2D {
    rows: Distribution1D,
    /// One per row; `None` for a row of weight 0, which is never chosen.
    columns: Vec<Option<Distribution1D>>,
}

/// A point in a cell of a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// From 0.
    pub column: usize,
    /// From 0.
    pub row: usize,
    /// Position within the cell, in [0, 1)^2: across the columns, then across the rows.
    pub within: [f32; 2],
}

impl Distribution2D {
    /// A distribution proportional to `weights`, in rows of `width`; `None` as for
    /// [`Distribution1D::new`].
    pub fn new(weights: &[f64], width: usize) -> Option<Self> {
        if width == 0 || !weights.len().is_multiple_of(width) {
            return None;
        }
        let rows = Distribution1D::new(weights.chunks(width).map(|row| row.iter().sum()))?;
        let mut columns = Vec::with_capacity(rows.len());
        for row in weights.chunks(width) {
            let is_zero = row.iter().all(|&weight| weight == 0.0);
            columns.push(if is_zero {
                None
            } else {
                Some(Distribution1D::new(row.iter().copied())?)
            });
        }
        Some(Self { rows, columns })
    }

    /// The point for `u` in [0, 1)^2, whose first number chooses the column; uniform within its cell.
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
