//! Charts of a diagnosis.

use metrolight::diagnosis::{Diagnosis, Quality, TILES};
use metrolight::plot::{Axis, Chart, HeatMap, Mark, PlotError, Series, draw, draw_heat_maps};

/// Number of bars in the histogram of p-values.
const BINS: usize = 20;

/// Maximum number of points of a trace in its chart.
const TRACE_POINTS: usize = 1000;

/// File names of all charts.
pub const FILES: [&str; 3] = ["traces.svg", "p-values.svg", "tiles.svg"];

/// File names and SVG documents of all charts.
pub fn all(diagnosis: &Diagnosis) -> Result<Vec<(&'static str, String)>, PlotError> {
    let quality = &diagnosis.quality;
    Ok(vec![
        (
            FILES[0],
            draw(&[traces(quality), autocorrelation(quality)], 2)?,
        ),
        (FILES[1], draw(&[p_values(diagnosis)], 1)?),
        (FILES[2], draw_heat_maps(&tiles(quality))?),
    ])
}

fn line(points: Vec<[f64; 2]>, color: usize) -> Series {
    Series {
        label: String::new(),
        points,
        band: Vec::new(),
        mark: Mark::Line,
        color,
    }
}

fn traces(quality: &Quality) -> Chart {
    let series = |(i, trace): (usize, &Vec<f64>)| {
        let stride = trace.len().div_ceil(TRACE_POINTS).max(1);
        let points = trace.iter().enumerate().step_by(stride);
        line(points.map(|(step, &y)| [step as f64, y]).collect(), i)
    };
    Chart {
        title: format!("log I of {} chains", quality.traces.len()),
        x: Axis::linear("step"),
        y: Axis::linear("log I"),
        series: quality.traces.iter().enumerate().map(series).collect(),
    }
}

fn autocorrelation(quality: &Quality) -> Chart {
    let points = quality.autocorrelation.iter().enumerate();
    let last = quality.autocorrelation.len().saturating_sub(1) as f64;
    let zero = Series {
        mark: Mark::Dashes,
        ..line(vec![[0.0, 0.0], [last, 0.0]], 6)
    };
    Chart {
        title: "autocorrelation of log I, mean of all chains".into(),
        x: Axis::linear("lag in steps"),
        y: Axis::linear("correlation"),
        series: vec![
            zero,
            line(points.map(|(lag, &c)| [lag as f64, c]).collect(), 0),
        ],
    }
}

/// Uncorrected p-values. For correct chains they are uniform, but tests of the same chains are not
/// independent.
fn p_values(diagnosis: &Diagnosis) -> Chart {
    let mut counts = [0u32; BINS];
    for check in &diagnosis.checks {
        counts[((check.p_value * BINS as f64) as usize).min(BINS - 1)] += 1;
    }
    let edge = |i: usize| i as f64 / BINS as f64;
    let bars = counts
        .iter()
        .enumerate()
        .map(|(i, &n)| [edge(i), f64::from(n)]);
    let expected = diagnosis.checks.len() as f64 / BINS as f64;
    Chart {
        title: format!("p-values of {} tests", diagnosis.checks.len()),
        x: Axis::linear("p-value, not corrected"),
        y: Axis::linear("tests"),
        series: vec![
            Series {
                mark: Mark::Bars,
                ..line(bars.chain([[1.0, 0.0]]).collect(), 0)
            },
            Series {
                mark: Mark::Dashes,
                ..line(vec![[0.0, expected], [1.0, expected]], 6)
            },
        ],
    }
}

fn tiles(quality: &Quality) -> Vec<HeatMap> {
    let rows = |value: &dyn Fn(usize) -> f64| -> Vec<Vec<f64>> {
        (0..TILES)
            .map(|row| {
                (0..TILES)
                    .map(|column| value(row * TILES + column))
                    .collect()
            })
            .collect()
    };
    vec![
        HeatMap::new(
            "effective samples per second",
            rows(&|i| quality.tiles[i].ess / quality.seconds),
        ),
        HeatMap::new("R-hat", rows(&|i| quality.tiles[i].r_hat)),
        HeatMap::new(
            "small steps accepted",
            rows(&|i| quality.acceptance_of_tiles[i]),
        ),
    ]
}
