//! Convergence curves: means over repeats, slopes, and the cost to reach an error.

use super::Measurement;
use crate::metrics::ImageError;

/// Cost of a render.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cost {
    /// Seconds of rendering.
    Seconds,
    /// Rays traced.
    Rays,
}

/// Error of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// relMSE of all pixels.
    Whole,
    /// relMSE without the worst 0.1% of the pixels: the error without single bright dots.
    Trimmed,
}

impl Measure {
    /// The error of an image.
    fn of(self, error: &ImageError) -> f64 {
        match self {
            Self::Whole => error.relative_mse,
            Self::Trimmed => error.relative_mse_trimmed,
        }
    }
}

/// Mean over all repeats at a scheduled time.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct CurvePoint {
    /// Mean seconds.
    pub seconds: f64,
    /// Mean number of rays.
    pub rays: f64,
    /// Mean relMSE: an estimate of the expected relMSE.
    pub relative_mse: f64,
    /// Minimum and maximum relMSE of any repeat.
    pub spread: [f64; 2],
    /// Mean relMSE without the worst 0.1% of the pixels.
    pub relative_mse_trimmed: f64,
    /// Minimum and maximum of these of any repeat.
    pub spread_trimmed: [f64; 2],
}

impl CurvePoint {
    /// The mean cost.
    pub fn cost(&self, cost: Cost) -> f64 {
        match cost {
            Cost::Seconds => self.seconds,
            Cost::Rays => self.rays,
        }
    }

    /// The mean error.
    pub fn error(&self, measure: Measure) -> f64 {
        match measure {
            Measure::Whole => self.relative_mse,
            Measure::Trimmed => self.relative_mse_trimmed,
        }
    }

    /// Minimum and maximum error of any repeat.
    pub fn spread(&self, measure: Measure) -> [f64; 2] {
        match measure {
            Measure::Whole => self.spread,
            Measure::Trimmed => self.spread_trimmed,
        }
    }
}

/// The error of one variant against its cost.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct Curve {
    /// Points in the order of cost.
    pub points: Vec<CurvePoint>,
}

/// Cost to reach a given error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reached {
    /// Reached at this cost, between two measurements.
    At(f64),
    /// Reached before the first measurement, which is at this cost.
    Before(f64),
    /// Not reached: the final error is this multiple of the given one.
    Never(f64),
}

impl Curve {
    /// The curve of variant `variant`, from the scheduled times that all its repeats have measured.
    pub fn new(measurements: &[Measurement], variant: usize) -> Self {
        let of_variant = || measurements.iter().filter(move |m| m.variant == variant);
        let repeats = 1 + of_variant().map(|m| m.repeat).max().unwrap_or(0);
        let times = 1 + of_variant().map(|m| m.index).max().unwrap_or(0);
        let point = |index: usize| {
            let at: Vec<&Measurement> = of_variant().filter(|m| m.index == index).collect();
            (at.len() as u64 == repeats).then(|| CurvePoint::mean(&at))
        };
        Self {
            points: (0..times).filter_map(point).collect(),
        }
    }

    /// The last point.
    pub fn end(&self) -> Option<&CurvePoint> {
        self.points.last()
    }

    /// Least-squares slope of log error over log cost, over all costs above an eighth of the last: -1
    /// for independent samples without bias. `None` if there are fewer than three points.
    pub fn slope(&self, cost: Cost, measure: Measure) -> Option<f64> {
        let last = self.end()?.cost(cost);
        let logs: Vec<[f64; 2]> = self
            .points
            .iter()
            .filter(|p| p.cost(cost) >= last / 8.0 && p.error(measure) > 0.0)
            .map(|p| [p.cost(cost).ln(), p.error(measure).ln()])
            .collect();
        if logs.len() < 3 {
            return None;
        }
        let n = logs.len() as f64;
        let [x, y] = [0, 1].map(|i| logs.iter().map(|p| p[i]).sum::<f64>() / n);
        let covariance: f64 = logs.iter().map(|p| (p[0] - x) * (p[1] - y)).sum();
        let variance: f64 = logs.iter().map(|p| (p[0] - x).powi(2)).sum();
        (variance > 0.0).then(|| covariance / variance)
    }

    /// The cost after which the error stays at `error` or below, by linear interpolation of log error
    /// over log cost. An error that rises above it again, as when a chain is stuck in one state, does
    /// not count as reached. `None` without measurements.
    pub fn reaches(&self, error: f64, cost: Cost, measure: Measure) -> Option<Reached> {
        let end = self.end()?.error(measure);
        if end > error {
            return Some(Reached::Never(end / error));
        }
        let above = self.points.iter().rposition(|p| p.error(measure) > error);
        let Some(above) = above else {
            return Some(Reached::Before(self.points.first()?.cost(cost)));
        };
        let [a, b] = [&self.points[above], &self.points[above + 1]];
        let share = (a.error(measure) / error).ln() / (a.error(measure) / b.error(measure)).ln();
        let [from, to] = [a, b].map(|p| p.cost(cost));
        Some(Reached::At(from * (to / from).powf(share)))
    }
}

impl CurvePoint {
    fn mean(at: &[&Measurement]) -> Self {
        let mean = |value: &dyn Fn(&Measurement) -> f64| {
            at.iter().map(|m| value(m)).sum::<f64>() / at.len() as f64
        };
        let spread = |measure: Measure| {
            let errors = || at.iter().map(|m| measure.of(&m.error));
            let least = errors().fold(f64::INFINITY, f64::min);
            [least, errors().fold(0.0, f64::max)]
        };
        Self {
            seconds: mean(&|m| m.progress.seconds),
            rays: mean(&|m| m.progress.rays as f64),
            relative_mse: mean(&|m| m.error.relative_mse),
            spread: spread(Measure::Whole),
            relative_mse_trimmed: mean(&|m| m.error.relative_mse_trimmed),
            spread_trimmed: spread(Measure::Trimmed),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::image_errors;
    use crate::render::Progress;

    /// relMSE against an image of ones is d^2 / 1.01 for a deviation of d.
    fn measurement(variant: usize, repeat: u64, index: usize, seconds: f64, d: f32) -> Measurement {
        Measurement {
            variant,
            repeat,
            index,
            progress: Progress {
                seconds,
                samples: 1,
                rays: (1000.0 * seconds) as u64,
            },
            error: image_errors(&[[1.0 + d; 3]], &[[1.0; 3]]),
        }
    }

    /// Error 1/seconds, from 1 s to 64 s.
    fn one_over_time() -> Curve {
        let at = |i: usize| {
            let seconds = f64::from(1 << i);
            measurement(0, 0, i, seconds, (1.01 / seconds).sqrt() as f32)
        };
        Curve::new(&(0..7).map(at).collect::<Vec<_>>(), 0)
    }

    #[test]
    fn one_over_time_has_slope_minus_one_and_reaches_errors_at_their_cost() {
        let curve = one_over_time();
        for cost in [Cost::Seconds, Cost::Rays] {
            let slope = curve.slope(cost, Measure::Whole).unwrap();
            assert!((slope + 1.0).abs() < 1e-3, "{slope}");
        }
        let Some(Reached::At(seconds)) = curve.reaches(0.1, Cost::Seconds, Measure::Trimmed) else {
            panic!("0.1 is between 1 and 1/64");
        };
        assert!((seconds - 10.0).abs() < 0.01, "{seconds}");
        assert_eq!(
            curve.reaches(2.0, Cost::Seconds, Measure::Whole),
            Some(Reached::Before(1.0))
        );
        let Some(Reached::Never(ratio)) = curve.reaches(1.0 / 128.0, Cost::Rays, Measure::Whole)
        else {
            panic!("1/128 is beyond the end");
        };
        assert!((ratio - 2.0).abs() < 1e-3);
        // The error rises above 0.1 again in the middle.
        let mut humped = one_over_time();
        humped.points[4].relative_mse = 0.5;
        let Some(Reached::At(seconds)) = humped.reaches(0.1, Cost::Seconds, Measure::Whole) else {
            panic!("0.1 is reached after 16 s");
        };
        assert!((16.0..32.0).contains(&seconds), "{seconds}");
        assert_eq!(
            Curve::default().reaches(1.0, Cost::Rays, Measure::Whole),
            None
        );
    }

    #[test]
    fn points_are_means_at_times_that_all_repeats_have() {
        let all = [
            measurement(1, 0, 0, 1.0, 0.5),
            measurement(1, 0, 1, 2.0, 0.1),
            measurement(1, 1, 1, 4.0, 0.3),
            measurement(0, 0, 1, 9.0, 0.9),
        ];
        let curve = Curve::new(&all, 1);
        assert_eq!(curve.points.len(), 1);
        let point = curve.points[0];
        assert_eq!((point.seconds, point.rays), (3.0, 3000.0));
        let [a, b] = [0.01 / 1.01, 0.09 / 1.01];
        assert!((point.relative_mse - 0.5 * (a + b)).abs() < 1e-6);
        assert!((point.spread[0] - a).abs() < 1e-6 && (point.spread[1] - b).abs() < 1e-6);
    }
}
