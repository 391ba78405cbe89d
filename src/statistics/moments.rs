//! Mean and variance of a stream of numbers.

/// Running moments (Welford 1962, "Note on a method for calculating corrected sums of squares").
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    /// Number of values.
    pub count: u64,
    /// Their mean; 0 if there are none.
    pub mean: f64,
    /// Sum of squared deviations from the mean.
    sum_squares: f64,
}

impl Moments {
    /// Moments known from elsewhere: the number of values, their mean and their unbiased sample
    /// variance.
    pub fn from_summary(count: u64, mean: f64, variance: f64) -> Self {
        Self {
            count,
            mean,
            sum_squares: variance * count.saturating_sub(1) as f64,
        }
    }

    /// Adds a value.
    #[inline]
    pub fn add(&mut self, value: f64) {
        self.count += 1;
        let delta = value - self.mean;
        self.mean += delta / self.count as f64;
        self.sum_squares += delta * (value - self.mean);
    }

    /// The moments of both streams together (Chan et al. 1983, "Algorithms for computing the sample
    /// variance", eq. 2.1).
    pub fn merge(&self, other: &Self) -> Self {
        if other.count == 0 {
            return *self;
        }
        let count = self.count + other.count;
        let share = other.count as f64 / count as f64;
        let delta = other.mean - self.mean;
        Self {
            count,
            mean: self.mean + delta * share,
            sum_squares: self.sum_squares
                + other.sum_squares
                + delta * delta * self.count as f64 * share,
        }
    }

    /// Unbiased sample variance; 0 for fewer than two values.
    pub fn variance(&self) -> f64 {
        if self.count < 2 {
            0.0
        } else {
            self.sum_squares / (self.count - 1) as f64
        }
    }

    /// Standard error of the mean; infinite for fewer than two values.
    pub fn standard_error(&self) -> f64 {
        if self.count < 2 {
            f64::INFINITY
        } else {
            (self.variance() / self.count as f64).sqrt()
        }
    }
}

impl FromIterator<f64> for Moments {
    fn from_iter<I: IntoIterator<Item = f64>>(values: I) -> Self {
        let mut moments = Self::default();
        values.into_iter().for_each(|v| moments.add(v));
        moments
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_and_their_merge_equal_the_textbook_formulas() {
        let values: Vec<f64> = (0..50)
            .map(|i| (f64::from(i) * 0.7).sin() * 3.0 + 1e6)
            .collect();
        let mean = values.iter().sum::<f64>() / 50.0;
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 49.0;
        let whole: Moments = values.iter().copied().collect();
        let a: Moments = values[..13].iter().copied().collect();
        let b: Moments = values[13..].iter().copied().collect();
        for m in [
            whole,
            a.merge(&b),
            b.merge(&a),
            Moments::default().merge(&whole),
        ] {
            assert_eq!(m.count, 50);
            assert!((m.mean - mean).abs() < 1e-8, "{} {mean}", m.mean);
            assert!(
                (m.variance() - variance).abs() < 1e-6,
                "{} {variance}",
                m.variance()
            );
        }
    }
}
