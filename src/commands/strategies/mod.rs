//! `metrolight strategies`: an image for each technique (s, t) of bidirectional path tracing.

mod shares;
mod sheet;

use std::path::{Path, PathBuf};

use metrolight::film::write_exr;
use metrolight::render::strategies::{check, memory_bytes};
use metrolight::render::{Budget, Method, Settings, Strategies, strategies};
use metrolight::technique::{Technique, TechniqueSet, Techniques};
use miette::{IntoDiagnostic, bail};
use serde_json::{Value, json};

use self::shares::{Kind, Shares, edges_text, percent};
use self::sheet::{exposures, sheet};
use super::files::{Content, OutputFiles};
use super::numbers::{duration, quantity};
use super::rescue::rescue;
use super::run_args::RunArgs;
use super::source::SceneArgs;
use super::values::MaxDepth;
use super::{
    Outcome, eprint, interrupt, memory, output, print, replay, values, warn, warn_more, wording,
};

/// Render each technique (s, t) of bidirectional path tracing separately
///
/// A path of k edges has k + 1 = s + t vertices, s of them on the light subpath and t on the camera
/// subpath. Writes two images for every (s, t) with t >= 1: unweighted, and weighted by the power
/// heuristic. The sum of all weighted images is the image of `render --integrator bdpt` with the same
/// seed and --spp. Two contact sheets show the techniques as in Veach (1997, figures 10.3 and 10.4).
#[derive(clap::Args)]
#[command(
    mut_arg("max_depth", |arg| arg.help(depth_help()).value_parser(values::edges)),
    allow_negative_numbers = true,
    after_help = "\
Examples:
  metrolight strategies scenes/bidir/scene.xml -o out        paths of up to 5 edges
  metrolight strategies scene.xml --size 160x120 --max-depth 7 --spp 128 -o out

Files in DIR: unweighted.png and weighted.png (contact sheets), strategies.json (means and shares), and
linear images unweighted_sS_tT.exr and weighted_sS_tT.exr.

Exit codes: 0 done, 2 bad input, 130 interrupted by Ctrl-C, 143 by SIGTERM, 129 by SIGHUP (the
images so far are written)"
)]
pub struct Args {
    #[command(flatten)]
    scene: SceneArgs,

    /// Directory for the images; made if it does not exist
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,

    /// Samples per pixel
    #[arg(long, value_name = "N", value_parser = values::samples, default_value_t = 32)]
    spp: u64,

    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,

    /// Exposure of both sheets in stops
    /// [default: for each row the whole number of stops that suits its sum]
    #[arg(long, value_name = "STOPS", value_parser = values::stops)]
    exposure: Option<f64>,

    #[command(flatten)]
    run: RunArgs,
}

/// Default maximum number of edges: 19 techniques, which fit on a sheet.
const DEFAULT_EDGES: u32 = 5;

const JSON: &str = "strategies.json";

fn depth_help() -> String {
    format!(
        "Maximum number of edges of a path: 1 shows emitters only, 2 adds direct light \
         [default: {DEFAULT_EDGES}]"
    )
}

/// Loads the scene, renders the techniques, writes the images and prints a summary.
pub fn run(mut args: Args) -> miette::Result<Outcome> {
    let limit = args
        .scene
        .max_depth
        .get_or_insert(MaxDepth(Some(DEFAULT_EDGES)));
    if limit.0.is_none() {
        bail!(
            "--max-depth -1: each path length has its own techniques, so a limit is needed, such as 5"
        );
    }
    let opened = args.scene.open(args.run.threads)?;
    let settings = Settings {
        budget: Budget::SamplesPerPixel(args.spp),
        seed: args.seed,
        threads: args.run.threads,
        ..Settings::new(Method::Bdpt)
    };
    let edges = check(&opened.scene).into_diagnostic()?;
    let outputs = outputs(&args.output, Techniques::of(&opened.scene), edges);
    outputs.protect(&opened.files)?;
    output::make_directory(&args.output)?;
    outputs.check_writable(opened.pixels())?;
    let bytes = memory_bytes(&opened.scene, edges);
    memory::check_images("the images of all techniques", bytes)?;
    interrupt::listen()?;
    let mut warnings = opened.warnings.clone();
    let progress = args.run.progress();
    warnings.extend(opened.lost_light(TechniqueSet::Bidirectional, None, &progress));
    warn(&warnings);
    if !args.run.quiet {
        eprint(opened.times());
    }

    let rendering = strategies(&opened.scene, &settings, &progress).into_diagnostic()?;
    progress.finish();
    warn_more(
        &mut warnings,
        rendering.warnings.iter().map(wording::warning),
    );
    replay::print_commands(&args.scene, &settings, &rendering.statistics);
    if rendering.interrupted && rendering.statistics.samples == 0 {
        eprint("interrupted before the first sample: nothing is written");
        return Ok(Outcome::Interrupted);
    }

    let shares = Shares::of(&rendering);
    let write = |directory: &Path| write(&args, directory, edges, &rendering, &shares, &warnings);
    write(&args.output).map_err(|error| rescue(&args.output, "strategies", &error, write))?;
    if !args.run.quiet {
        print(summary(&args, &rendering, &shares))?;
    }
    if rendering.interrupted {
        eprint("interrupted: the images hold the samples taken so far");
        return Ok(Outcome::Interrupted);
    }
    Ok(Outcome::Done)
}

/// All files that are written to `directory`.
fn outputs(directory: &Path, techniques: Techniques, edges: u32) -> OutputFiles {
    let mut outputs = OutputFiles::default();
    for kind in Kind::ALL {
        outputs.add(directory.join(kind.sheet()), Content::Text, "-o");
        for technique in techniques.all(edges as usize) {
            let linear = Content::Linear { layers: 1 };
            outputs.add(directory.join(kind.exr(technique)), linear, "-o");
        }
    }
    outputs.add(directory.join(JSON), Content::Text, "-o");
    outputs
}

/// Writes the images, the contact sheets and the JSON file.
fn write(
    args: &Args,
    directory: &Path,
    edges: u32,
    rendering: &Strategies,
    shares: &Shares,
    warnings: &[String],
) -> miette::Result<()> {
    let mut report = json!({
        "version": env!("CARGO_PKG_VERSION"),
        "scene": args.scene.path.to_string_lossy(),
        "defines": args.scene.defines.iter().cloned().collect::<std::collections::BTreeMap<_, _>>(),
        "max_depth": edges,
        "samples_per_pixel": args.spp,
        "statistics": rendering.statistics,
        "interrupted": rendering.interrupted,
        "warnings": warnings,
    });
    for images in &rendering.images {
        for kind in Kind::ALL {
            let mut attributes = output::attributes(&report);
            let mut technique = json!({ "technique": names(images.technique) });
            technique["technique"]["image"] = json!(kind.name());
            attributes.extend(output::attributes(&technique));
            let path = directory.join(kind.exr(images.technique));
            write_exr(&path, kind.of(images), &[], &attributes).into_diagnostic()?;
        }
    }
    let exposures = match args.exposure {
        Some(stops) => vec![stops; edges as usize],
        None => exposures(edges, rendering, shares),
    };
    let note = format!(
        "{}, {} samples per pixel, seed {}; s light vertices, t camera vertices",
        args.scene.name()?,
        args.spp,
        args.seed
    );
    for kind in Kind::ALL {
        let png = sheet(kind, rendering, shares, &exposures, &note)?;
        output::write_bytes(&directory.join(kind.sheet()), &png)?;
    }
    report["mean_luminance"] = json!(shares.total);
    report["exposures"] = json!(exposures);
    report["techniques"] = table(rendering, shares);
    output::write_json(&directory.join(JSON), &report)
}

fn table(rendering: &Strategies, shares: &Shares) -> Value {
    let rows = rendering.images.iter().enumerate();
    rows.map(|(i, images)| {
        let technique = images.technique;
        let mut row = names(technique);
        row["edges"] = json!(technique.edges());
        row["mean_luminance_unweighted"] = json!(shares.means[i][0]);
        row["mean_luminance_weighted"] = json!(shares.means[i][1]);
        row["share"] = json!(shares.share(i));
        row["unweighted"] = json!(Kind::Unweighted.exr(technique));
        row["weighted"] = json!(Kind::Weighted.exr(technique));
        row
    })
    .collect()
}

/// s and t of a technique; for technique 1* the number of delta vertices in place of s.
fn names(technique: Technique) -> Value {
    match technique {
        Technique::Specular { t, n } => json!({ "specular": n, "t": t }),
        _ => json!({ "s": technique.s(), "t": technique.t() }),
    }
}

/// The files written, and the share of each technique in the light of the image.
fn summary(args: &Args, rendering: &Strategies, shares: &Shares) -> String {
    let statistics = &rendering.statistics;
    let [width, height] = statistics.size;
    let directory = args.output.display();
    let mut lines = vec![
        format!(
            "wrote {directory}/weighted.png, unweighted.png, {JSON} and {} images: {width} x {height} \
             pixels, {} samples in {}",
            2 * rendering.images.len(),
            quantity(statistics.samples as f64),
            duration(statistics.render_seconds),
        ),
        "share of the image's light by technique (s,t):".into(),
    ];
    let edges = rendering
        .images
        .iter()
        .map(|images| images.technique.edges());
    for k in 1..=edges.max().unwrap_or(0) {
        let images = rendering.images.iter().enumerate();
        let images = images.filter(|(_, images)| images.technique.edges() == k);
        let cells = images.map(|(i, images)| {
            let share = shares.share(i).map_or("-".into(), percent);
            format!("{} {share:>5}", images.technique)
        });
        let cells: Vec<String> = cells.collect();
        lines.push(format!("  {:<8} {}", edges_text(k), cells.join("   ")));
    }
    lines.join("\n")
}
