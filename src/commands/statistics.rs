//! Statistics of a render: as JSON, and as a few lines to read.

use std::borrow::Cow;

use metrolight::film::Crop;
use metrolight::render::{
    Budget, MmltStatistics, MutationStatistics, PssmltStatistics, Rendering, Settings, Statistics,
};
use serde::Serialize;
use serde_json::{Value, json};

use super::integrator_args::IntegratorArgs;
use super::numbers::{digits, duration, quantity};
use super::output::{Outputs, budget_json};
use super::source::{Opened, SceneArgs};

#[derive(Serialize)]
struct Report<'a> {
    command: String,
    version: &'static str,
    scene: Cow<'a, str>,
    defines: std::collections::BTreeMap<&'a str, &'a str>,
    max_depth: Option<u32>,
    specular: String,
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

/// All statistics of a render. Times are in seconds.
pub fn json(
    args: &SceneArgs,
    opened: &Opened,
    settings: &Settings,
    rendering: &Rendering,
    warnings: &[String],
) -> serde_json::Result<Value> {
    serde_json::to_value(Report {
        command: command(args, settings, rendering),
        version: env!("CARGO_PKG_VERSION"),
        scene: args.path.to_string_lossy(),
        defines: args
            .defines
            .iter()
            .map(|(name, value)| (&**name, &**value))
            .collect(),
        max_depth: opened.scene.depth.max_depth,
        specular: opened.specular_in_use().to_string(),
        budget: budget_json(settings.budget),
        load_seconds: opened.load_seconds,
        build_seconds: opened.build_seconds,
        statistics: &rendering.statistics,
        error: rendering.error.as_ref().map(|error| {
            json!({
                "relative_mse": error.relative_mse,
                "independent_parts": error.parts,
                "pixels_dominated_by_one_part": error.dominated_share,
                "target_relative_mse": settings.target_error,
            })
        }),
        interrupted: rendering.interrupted,
        warnings,
    })
}

/// A command that renders the same image again.
fn command(args: &SceneArgs, settings: &Settings, rendering: &Rendering) -> String {
    let statistics = &rendering.statistics;
    let budget = match settings.budget {
        Budget::SamplesPerPixel(n) if !rendering.interrupted => format!("--spp {n}"),
        _ => format!("--samples {}", statistics.samples),
    };
    format!(
        "metrolight render {} {} --seed {} {budget}",
        args.words(),
        IntegratorArgs::words(settings, statistics),
        settings.seed
    )
}

/// A few lines: the files written, the number of samples, the speed and the error.
pub fn summary(outputs: &Outputs, rendering: &Rendering) -> String {
    let statistics = &rendering.statistics;
    let [width, height] = statistics.size;
    let written = match outputs.crop {
        Some(Crop { size: [w, h], .. }) => format!("{w} x {h} of {width} x {height} pixels"),
        None => format!("{width} x {height} pixels"),
    };
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
    let unit = match statistics.pssmlt {
        Some(_) => "mutations",
        None => "samples",
    };
    let mut lines = vec![
        format!("wrote {files}: {written}"),
        format!(
            "{}: {} {unit} ({} per pixel) in {}, {} per second on {}",
            statistics.integrator.name(),
            quantity(statistics.samples as f64),
            (1000.0 * per_pixel).round() / 1000.0,
            duration(statistics.render_seconds),
            quantity(statistics.samples_per_second),
            match statistics.threads {
                1 => "1 thread".into(),
                n => format!("{n} threads"),
            },
        ),
        format!(
            "rays: {} closest-hit, {} shadow; {} per second",
            quantity(statistics.closest_hit_rays as f64),
            quantity(statistics.shadow_rays as f64),
            quantity(statistics.rays_per_second),
        ),
    ];
    lines.extend(statistics.pssmlt.iter().flat_map(pssmlt_lines));
    lines.extend(statistics.mmlt.as_ref().map(mmlt_line));
    if let Some(error) = &rendering.error {
        let parts = match statistics.pssmlt {
            Some(_) => "groups of chains",
            None => "passes",
        };
        lines.push(format!(
            "relMSE about {:.2e}, estimated from {} {parts}",
            error.relative_mse, error.parts
        ));
    }
    lines.join("\n")
}

fn pssmlt_lines(pssmlt: &PssmltStatistics) -> [String; 2] {
    let error = match pssmlt.b_standard_error {
        Some(error) if pssmlt.b > 0.0 => {
            format!("+- {error:.2e} ({:.2}%)", 100.0 * error / pssmlt.b)
        }
        Some(error) => format!("+- {error:.2e}"),
        None => "with unknown error".into(),
    };
    [
        format!(
            "b = {:.5e} {error}, from {} bootstrap samples and all large steps",
            pssmlt.b,
            quantity(pssmlt.bootstrap_samples as f64),
        ),
        format!(
            "{} chains: accepted {}, longest run of rejections {}",
            pssmlt.chains,
            accepted(&pssmlt.mutations),
            pssmlt.longest_rejection_run,
        ),
    ]
}

fn mmlt_line(mmlt: &MmltStatistics) -> String {
    let mutations: u64 = mmlt.mutations.iter().map(|kind| kind.proposed).sum();
    format!(
        "above {} times the expected brightness: {} chains with {} mutations, accepted {}, longest \
         run of rejections {}",
        digits(f64::from(mmlt.threshold)),
        mmlt.chains,
        quantity(mutations as f64),
        accepted(&mmlt.mutations),
        mmlt.longest_rejection_run,
    )
}

/// The acceptance rates of all kinds of mutations.
pub fn accepted(mutations: &[MutationStatistics]) -> String {
    let rate = |kind: &MutationStatistics| {
        format!("{:.1}% of {}s", 100.0 * kind.acceptance_rate, kind.name)
    };
    let rates: Vec<String> = mutations.iter().map(rate).collect();
    if rates.is_empty() {
        "none".into()
    } else {
        rates.join(" and ")
    }
}
