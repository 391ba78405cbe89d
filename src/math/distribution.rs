//! Discrete and piecewise constant distributions, sampled by inversion: monotone, so that a small
//! step of the random number is a small step of the outcome.

/// A distribution over `0..len`, proportional to given weights; O(log n) to sample.
#[derive(Clone, Debug)]
pub struct Distribution1D {
    /// `cdf[i]` is the probability of an outcome below `i`; `len + 1` values from 0 to 1.
    cdf: Vec<f32>,
    total: f64,
}

/// Least probability of an outcome of positive weight: the spacing of random numbers in [0, 1).
const LEAST: f32 = f32::EPSILON / 2.0;

impl Distribution1D {
    /// A distribution proportional to `weights`; `None` if there are none, if one is negative or
    /// not finite, or if all are 0.
    ///
    /// Probabilities are rounded such that no outcome of positive weight gets 0: it would be lost
    /// without a trace, however much depends on it.
    pub fn new(weights: impl IntoIterator<Item = f64>) -> Option<Self> {
        let weights: Vec<f64> = weights.into_iter().collect();
        if !weights.iter().all(|w| *w >= 0.0 && w.is_finite()) {
            return None;
        }
        let total: f64 = weights.iter().sum();
        if total <= 0.0 || !total.is_finite() {
            return None;
        }
        let least = |weight: f64| if weight > 0.0 { LEAST } else { 0.0 };
        let mut cdf = Vec::with_capacity(weights.len() + 1);
        cdf.push(0.0);
        let (mut sum, mut last) = (0.0, 0.0_f32);
        for &weight in &weights {
            sum += weight;
            last = ((sum / total) as f32).max(last + least(weight));
            cdf.push(last);
        }
        // From the top, so that what was pushed up ends at 1.
        let mut above = 1.0;
        for (value, &weight) in cdf[1..].iter_mut().zip(&weights).rev() {
            *value = value.min(above);
            above = (*value - least(weight)).max(0.0);
        }
        *cdf.last_mut()? = 1.0;
        Some(Self { cdf, total })
    }

    /// Number of outcomes.
    pub fn len(&self) -> usize {
        self.cdf.len() - 1
    }

    /// Never true: a distribution has at least one outcome.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// Sum of the weights it was made from.
    pub fn total(&self) -> f64 {
        self.total
    }

    /// Probability of outcome `i`.
    #[inline]
    pub fn probability(&self, i: usize) -> f32 {
        self.cdf[i + 1] - self.cdf[i]
    }

    /// The outcome for `u` in [0, 1), and the part of `u` that the choice did not use: again
    /// uniform in [0, 1), to be spent on a place within the outcome.
    #[inline]
    pub fn sample(&self, u: f32) -> (usize, f32) {
        // Last i with cdf[i] <= u; an outcome of probability 0 is never chosen.
        let i = (self.cdf.partition_point(|&c| c <= u) - 1).min(self.len() - 1);
        let width = self.probability(i);
        let rest = if width > 0.0 {
            (u - self.cdf[i]) / width
        } else {
            0.5
        };
        (i, rest.clamp(0.0, 1.0 - f32::EPSILON / 2.0))
    }
}

/// A piecewise constant density on the unit square: rows chosen by a marginal distribution, columns
/// by a conditional one.
#[derive(Clone, Debug)]
pub struct Distribution2D {
    rows: Distribution1D,
    /// One per row; `None` for a row of weight 0, which is never chosen.
    columns: Vec<Option<Distribution1D>>,
    width: usize,
}

impl Distribution2D {
    /// From `weights` in row-major order, `width` a row; `None` as for [`Distribution1D::new`].
    pub fn new(weights: &[f64], width: usize) -> Option<Self> {
        if width == 0 || !weights.len().is_multiple_of(width) {
            return None;
        }
        let rows = Distribution1D::new(weights.chunks(width).map(|row| row.iter().sum()))?;
        let columns = weights
            .chunks(width)
            .map(|row| Distribution1D::new(row.iter().copied()))
            .collect();
        Some(Self {
            rows,
            columns,
            width,
        })
    }

    /// A point of the unit square and its density there (1 where the density is uniform).
    #[inline]
    pub fn sample(&self, u: [f32; 2]) -> ([f32; 2], f32) {
        let (row, v) = self.rows.sample(u[1]);
        let Some(columns) = &self.columns[row] else {
            return ([u[0], (row as f32 + v) / self.rows.len() as f32], 0.0);
        };
        let (column, w) = columns.sample(u[0]);
        let point = [
            (column as f32 + w) / self.width as f32,
            (row as f32 + v) / self.rows.len() as f32,
        ];
        (point, self.cell_density(row, column))
    }

    /// Density at a point of the unit square.
    #[inline]
    pub fn pdf(&self, point: [f32; 2]) -> f32 {
        let cell = |x: f32, n: usize| ((x * n as f32) as usize).min(n - 1);
        self.cell_density(cell(point[1], self.rows.len()), cell(point[0], self.width))
    }

    fn cell_density(&self, row: usize, column: usize) -> f32 {
        let cells = (self.rows.len() * self.width) as f32;
        match &self.columns[row] {
            Some(columns) => self.rows.probability(row) * columns.probability(column) * cells,
            None => 0.0,
        }
    }
}
