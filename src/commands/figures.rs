//! What a render took: as JSON, and as a few lines to read.

use std::path::Path;

use metrolight::render::{
    MetropolisStatistics, MultiplexedStatistics, Rendering, Settings, Statistics,
};
use serde::Serialize;
use serde_json::{Value, json};

use super::output::{Outputs, budget_json};
use super::source::{Opened, SceneArgs};

#[derive(Serialize)]
struct Report<'a> {
    version: &'static str,
    scene: &'a Path,
    defines: std::collections::BTreeMap<&'a str, &'a str>,
    max_depth: Option<u32>,
    budget: Value,
    load_seconds: f64,
    build_seconds: f64,
    #[serde(flatten)]
    statistics: &'a Statistics,
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<Value>,
    interrupted: bool,
    warnings: &'a [String],
}

/// All figures of a render. Times are in seconds.
pub fn json(
    args: &SceneArgs,
    opened: &Opened,
    settings: &Settings,
    rendering: &Rendering,
    warnings: &[String],
) -> serde_json::Result<Value> {
    serde_json::to_value(Report {
        version: env!("CARGO_PKG_VERSION"),
        scene: &args.path,
        defines: args
            .defines
            .iter()
            .map(|(name, value)| (&**name, &**value))
            .collect(),
        max_depth: opened.scene.depth.max_depth,
        budget: budget_json(settings.budget),
        load_seconds: opened.load_seconds,
        build_seconds: opened.build_seconds,
        statistics: &rendering.statistics,
        error: rendering.error.as_ref().map(|error| {
            json!({
                "relative_mse": error.relative_mse,
                "independent_parts": error.parts,
                "pixels_resting_on_one_part": error.single,
                "target_relative_mse": settings.target_error,
            })
        }),
        interrupted: rendering.interrupted,
        warnings,
    })
}

/// A few lines: what was written, how much was done and how fast.
pub fn summary(outputs: &Outputs, rendering: &Rendering) -> String {
    let statistics = &rendering.statistics;
    let [width, height] = statistics.size;
    let files = match &outputs.stats {
        Some(stats) => format!(
            "{}, {} and {}",
            outputs.exr.display(),
            outputs.png.display(),
            stats.display()
        ),
        None => format!("{} and {}", outputs.exr.display(), outputs.png.display()),
    };
    let per_pixel = statistics.samples as f64 / (f64::from(width) * f64::from(height));
    let unit = match statistics.metropolis {
        Some(_) => "mutations",
        None => "samples",
    };
    let mut lines = vec![
        format!("wrote {files}: {width} x {height} pixels"),
        format!(
            "{}: {} {unit} ({} per pixel) in {}, {} per second on {} threads",
            statistics.integrator.name(),
            quantity(statistics.samples as f64),
            (1000.0 * per_pixel).round() / 1000.0,
            duration(statistics.render_seconds),
            quantity(statistics.samples_per_second),
            statistics.threads,
        ),
        format!(
            "rays: {} closest-hit, {} shadow; {} per second",
            quantity(statistics.closest_hit_rays as f64),
            quantity(statistics.shadow_rays as f64),
            quantity(statistics.rays_per_second),
        ),
    ];
    lines.extend(statistics.metropolis.iter().flat_map(metropolis_lines));
    lines.extend(statistics.multiplexed.as_ref().map(multiplexed_line));
    if let Some(error) = &rendering.error {
        let parts = match statistics.metropolis {
            Some(_) => "groups of chains",
            None => "passes",
        };
        lines.push(format!(
            "relMSE about {:.2e}, from the spread of {} {parts}",
            error.relative_mse, error.parts
        ));
    }
    lines.join("\n")
}

fn metropolis_lines(metropolis: &MetropolisStatistics) -> [String; 2] {
    let error = match metropolis.b_standard_error {
        Some(error) if metropolis.b > 0.0 => {
            format!("+- {error:.2e} ({:.2}%)", 100.0 * error / metropolis.b)
        }
        Some(error) => format!("+- {error:.2e}"),
        None => "with unknown error".into(),
    };
    let percent = |rate: f64| format!("{:.1}%", 100.0 * rate);
    [
        format!(
            "b = {:.5e} {error}, from {} bootstrap samples and all large steps",
            metropolis.b,
            quantity(metropolis.bootstrap_samples as f64),
        ),
        format!(
            "{} chains: {} of large and {} of small steps accepted, longest run of rejections {}",
            metropolis.chains,
            percent(metropolis.large_steps.acceptance_rate),
            percent(metropolis.small_steps.acceptance_rate),
            metropolis.longest_rejection_run,
        ),
    ]
}

fn multiplexed_line(multiplexed: &MultiplexedStatistics) -> String {
    format!(
        "beyond {} times the expected brightness: {} chains with {} mutations, {:.1}% of them \
         accepted, longest run of rejections {}",
        f64::from(multiplexed.threshold),
        multiplexed.chains,
        quantity(multiplexed.mutations.proposed as f64),
        100.0 * multiplexed.mutations.acceptance_rate,
        multiplexed.longest_rejection_run,
    )
}

/// A number to three digits with a suffix: `1.23 M`.
pub fn quantity(number: f64) -> String {
    let (scale, suffix) = match number {
        n if n >= 1e9 => (1e9, " G"),
        n if n >= 1e6 => (1e6, " M"),
        n if n >= 1e4 => (1e3, " k"),
        _ => return format!("{number:.0}"),
    };
    let scaled = number / scale;
    let decimals = match scaled {
        s if s < 9.995 => 2,
        s if s < 99.95 => 1,
        _ => 0,
    };
    format!("{scaled:.decimals$}{suffix}")
}

/// A number to three digits, with an exponent where it would be long: `0.0123`, `4.56e-5`.
pub fn digits(number: f64) -> String {
    let magnitude = number.abs().log10().floor();
    if number == 0.0 {
        "0".into()
    } else if (-3.0..4.0).contains(&magnitude) {
        format!("{number:.*}", (2.0 - magnitude).max(0.0) as usize)
    } else {
        format!("{number:.2e}")
    }
}

/// A time to read: `1 h 02 min`, `3 min 20 s`, `12.3 s`, `45 ms`.
pub fn duration(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    match seconds {
        s if s < 0.9995 => format!("{:.0} ms", 1000.0 * s),
        s if s < 59.95 => format!("{s:.1} s"),
        s if s < 3599.5 => format!("{} min {:02} s", whole / 60, whole % 60),
        _ => format!("{} h {:02} min", whole / 3600, whole % 3600 / 60),
    }
}

#[cfg(test)]
mod tests {
    use super::{digits, duration, quantity};

    #[test]
    fn numbers_and_times_are_short() {
        for (number, expected) in [
            (0.0, "0"),
            (9999.0, "9999"),
            (12_345.0, "12.3 k"),
            (999_600.0, "1000 k"),
            (1_234_567.0, "1.23 M"),
            (123.4e9, "123 G"),
        ] {
            assert_eq!(quantity(number), expected);
        }
        for (number, expected) in [
            (0.0, "0"),
            (15.91, "15.9"),
            (0.001_234, "0.00123"),
            (-1234.5, "-1234"),
            (4.567e-5, "4.57e-5"),
            (98765.0, "9.88e4"),
        ] {
            assert_eq!(digits(number), expected);
        }
        for (seconds, expected) in [
            (0.0123, "12 ms"),
            (0.9996, "1.0 s"),
            (59.96, "1 min 00 s"),
            (200.4, "3 min 20 s"),
            (3599.6, "1 h 00 min"),
            (7325.0, "2 h 02 min"),
        ] {
            assert_eq!(duration(seconds), expected);
        }
    }
}
