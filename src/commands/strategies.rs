//! `metrolight strategies`: an image for each technique (s, t) of bidirectional path tracing.

use std::path::{Path, PathBuf};

use metrolight::film::{Image, check_writable, srgb_bytes, write_exr};
use metrolight::integrators::{Sampler, Technique};
use metrolight::math::{Rgb, luminance};
use metrolight::plot::{Cell, Picture, Row, draw_contact_sheet, rasterize};
use metrolight::render::strategies::check;
use metrolight::render::{
    Budget, Integrator, Settings, Strategies, TechniqueImages, strategies, techniques,
};
use miette::{IntoDiagnostic, bail};
use serde_json::{Value, json};

use super::numbers::{duration, quantity};
use super::run_args::RunArgs;
use super::source::SceneArgs;
use super::values::MaxDepth;
use super::{Outcome, interrupt, output, replay, say, tell, values, warn, wording};

/// Render each technique (s, t) of bidirectional path tracing separately
///
/// A path of k edges has k + 1 = s + t vertices, s of them on the light subpath and t on the camera
/// subpath. Writes two images for every (s, t) with t >= 1: unweighted, and weighted by the power
/// heuristic. The sum of all weighted images is the image of `render --integrator bdpt` with the same
/// seed and --spp. Two contact sheets show the techniques as in Veach (1997, figures 10.3 and 10.4).
#[derive(clap::Args)]
#[command(
    mut_arg("max_depth", |arg| arg.help(depth_help())),
    allow_negative_numbers = true,
    after_help = "\
Examples:
  metrolight strategies scenes/bidir/scene.xml -o out        paths of up to 5 edges
  metrolight strategies scene.xml --size 160x120 --max-depth 7 --spp 128 -o out

Files in DIR: unweighted.png and weighted.png (contact sheets), strategies.json (means and shares), and
linear images unweighted_sS_tT.exr and weighted_sS_tT.exr.

Exit codes: 0 done, 2 bad input, 130 interrupted by Ctrl-C (the images so far are written)"
)]
pub struct Args {
    #[command(flatten)]
    scene: SceneArgs,

    /// Directory for the images; made if it does not exist
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,

    /// Samples per pixel
    #[arg(long, value_name = "N", value_parser = values::positive, default_value_t = 32)]
    spp: u64,

    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = Settings::default().seed)]
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

/// Mean luminance of a row's sum on the sheet, roughly: middle grey.
const MIDDLE_GREY: f64 = 0.2;

fn depth_help() -> String {
    format!(
        "Maximum number of edges of a path: 1 shows emitters only, 2 adds direct light \
         [default: {DEFAULT_EDGES}]"
    )
}

const JSON: &str = "strategies.json";

/// The two images of a technique.
#[derive(Clone, Copy)]
enum Kind {
    Unweighted,
    Weighted,
}

impl Kind {
    const ALL: [Self; 2] = [Self::Unweighted, Self::Weighted];

    fn name(self) -> &'static str {
        match self {
            Self::Unweighted => "unweighted",
            Self::Weighted => "weighted",
        }
    }

    fn of(self, images: &TechniqueImages) -> &Image {
        match self {
            Self::Unweighted => &images.unweighted,
            Self::Weighted => &images.weighted,
        }
    }

    fn exr(self, Technique { s, t }: Technique) -> String {
        format!("{}_s{s}_t{t}.exr", self.name())
    }

    fn sheet(self) -> String {
        format!("{}.png", self.name())
    }
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
    let opened = args.scene.open()?;
    let settings = Settings {
        budget: Budget::SamplesPerPixel(args.spp),
        seed: args.seed,
        threads: args.run.threads,
        ..Settings::new(Integrator::Bdpt)
    };
    let edges = check(&opened.scene).into_diagnostic()?;
    prepare(&args.output, edges)?;
    interrupt::listen()?;
    let mut warnings = opened.warnings.clone();
    warnings.extend(opened.lost_light(Sampler::Bidirectional));
    warn(&warnings);
    if !args.run.quiet {
        tell(opened.times());
    }

    let progress = args.run.progress();
    let found = strategies(&opened.scene, &settings, &progress).into_diagnostic()?;
    progress.finish();
    let limits: Vec<String> = found.warnings.iter().map(wording::warning).collect();
    warn(&limits);
    warnings.extend(limits);
    replay::print_commands(&args.scene, &settings, &found.statistics);
    if found.interrupted && found.statistics.samples == 0 {
        tell("interrupted before the first sample: nothing is written");
        return Ok(Outcome::Interrupted);
    }

    let shares = Shares::of(&found);
    write(&args, edges, &found, &shares, &warnings)?;
    if !args.run.quiet {
        say(summary(&args, &found, &shares));
    }
    if found.interrupted {
        tell("interrupted: the images hold the samples taken so far");
        return Ok(Outcome::Interrupted);
    }
    Ok(Outcome::Done)
}

/// Makes the directory and checks that all files can be written.
fn prepare(directory: &Path, edges: u32) -> miette::Result<()> {
    output::make_directory(directory)?;
    for kind in Kind::ALL {
        check_writable(&directory.join(kind.sheet())).into_diagnostic()?;
        for technique in techniques(edges) {
            check_writable(&directory.join(kind.exr(technique))).into_diagnostic()?;
        }
    }
    check_writable(&directory.join(JSON)).into_diagnostic()
}

/// Mean luminances of all images, in the order of the techniques.
struct Shares {
    /// Unweighted and weighted.
    means: Vec<[f64; 2]>,
    /// Sum of the weighted means: the mean luminance of the image.
    total: f64,
}

impl Shares {
    fn of(found: &Strategies) -> Self {
        let images = found.images.iter();
        let means: Vec<[f64; 2]> = images
            .map(|images| Kind::ALL.map(|kind| mean_luminance(kind.of(images))))
            .collect();
        Self {
            total: means.iter().map(|mean| mean[1]).sum(),
            means,
        }
    }

    /// Share of technique `i` in the light of the image; `None` if the image is black.
    fn share(&self, i: usize) -> Option<f64> {
        (self.total > 0.0).then(|| self.means[i][1] / self.total)
    }
}

fn mean_luminance(image: &Image) -> f64 {
    let luminances = image.pixels.iter().map(|&p| luminance(Rgb::from(p)));
    luminances.map(f64::from).sum::<f64>() / image.pixels.len() as f64
}

fn edges_of(technique: Technique) -> usize {
    technique.s + technique.t - 1
}

/// Exposure in stops of the rows for 1, 2, ... edges: whole stops that bring the mean of a row's sum
/// near [`MIDDLE_GREY`], or 0 for a black row.
fn exposures(args: &Args, edges: u32, found: &Strategies, shares: &Shares) -> Vec<f64> {
    let row = |k: usize| {
        if let Some(stops) = args.exposure {
            return stops;
        }
        let images = found.images.iter().zip(&shares.means);
        let images = images.filter(|(images, _)| edges_of(images.technique) == k);
        let sum: f64 = images.map(|(_, mean)| mean[1]).sum();
        if sum > 0.0 {
            // Adding 0 avoids -0.
            (MIDDLE_GREY / sum).log2().round() + 0.0
        } else {
            0.0
        }
    };
    (1..=edges as usize).map(row).collect()
}

fn write(
    args: &Args,
    edges: u32,
    found: &Strategies,
    shares: &Shares,
    warnings: &[String],
) -> miette::Result<()> {
    let mut report = json!({
        "version": env!("CARGO_PKG_VERSION"),
        "scene": args.scene.path,
        "defines": args.scene.defines.iter().cloned().collect::<std::collections::BTreeMap<_, _>>(),
        "max_depth": edges,
        "samples_per_pixel": args.spp,
        "statistics": found.statistics,
        "interrupted": found.interrupted,
        "warnings": warnings,
    });
    for images in &found.images {
        for kind in Kind::ALL {
            let Technique { s, t } = images.technique;
            let mut attributes = output::attributes(&report);
            let technique = json!({ "s": s, "t": t, "image": kind.name() });
            let technique = json!({ "technique": technique });
            attributes.extend(output::attributes(&technique));
            let path = args.output.join(kind.exr(images.technique));
            write_exr(&path, kind.of(images), &[], &attributes).into_diagnostic()?;
        }
    }
    let exposures = exposures(args, edges, found, shares);
    for kind in Kind::ALL {
        let png = sheet(args, kind, found, shares, &exposures)?;
        output::write_bytes(&args.output.join(kind.sheet()), &png)?;
    }
    report["mean_luminance"] = json!(shares.total);
    report["exposures"] = json!(exposures);
    report["techniques"] = table(found, shares);
    output::write_json(&args.output.join(JSON), &report)
}

fn table(found: &Strategies, shares: &Shares) -> Value {
    let rows = found.images.iter().enumerate();
    rows.map(|(i, images)| {
        let technique = images.technique;
        json!({
            "s": technique.s,
            "t": technique.t,
            "edges": edges_of(technique),
            "mean_luminance_unweighted": shares.means[i][0],
            "mean_luminance_weighted": shares.means[i][1],
            "share": shares.share(i),
            "unweighted": Kind::Unweighted.exr(technique),
            "weighted": Kind::Weighted.exr(technique),
        })
    })
    .collect()
}

/// A contact sheet of all techniques as a PNG file.
fn sheet(
    args: &Args,
    kind: Kind,
    found: &Strategies,
    shares: &Shares,
    exposures: &[f64],
) -> miette::Result<Vec<u8>> {
    let cell = |i: usize, images: &TechniqueImages, stops: f64| {
        let Technique { s, t } = images.technique;
        let image = kind.of(images);
        let note = match (kind, shares.share(i)) {
            _ if shares.means[i][0] == 0.0 => "no light".into(),
            (Kind::Weighted, Some(share)) => percent(share),
            _ => format!("mean {:.2e}", shares.means[i][0]),
        };
        Cell {
            label: format!("({s},{t}): {note}"),
            picture: Picture {
                width: image.width,
                height: image.height,
                rgb: srgb_bytes(image, stops.exp2()),
            },
        }
    };
    let row = |(k, &stops): (usize, &f64)| {
        let images = found.images.iter().enumerate();
        let images = images.filter(|(_, images)| edges_of(images.technique) == k);
        Row {
            title: format!(
                "{}, exposure {stops:+} {}",
                edges_text(k),
                stops_text(stops)
            ),
            cells: images.map(|(i, images)| cell(i, images, stops)).collect(),
        }
    };
    let rows: Vec<Row> = (1..).zip(exposures).map(row).collect();
    let title = match kind {
        Kind::Unweighted => "Techniques (s,t), unweighted",
        Kind::Weighted => "Techniques (s,t), weighted: their sum is the image",
    };
    let note = format!(
        "{}, {} samples per pixel, seed {}; s light vertices, t camera vertices",
        args.scene.name()?,
        args.spp,
        args.seed
    );
    let svg = draw_contact_sheet([title, &note], &rows).into_diagnostic()?;
    rasterize(&svg, 1.0).into_diagnostic()
}

fn edges_text(k: usize) -> String {
    if k == 1 {
        "1 edge".into()
    } else {
        format!("{k} edges")
    }
}

fn stops_text(stops: f64) -> &'static str {
    if stops.abs() == 1.0 { "stop" } else { "stops" }
}

fn percent(share: f64) -> String {
    format!("{:.1}%", 100.0 * share)
}

/// The files written, and the share of each technique in the light of the image.
fn summary(args: &Args, found: &Strategies, shares: &Shares) -> String {
    let statistics = &found.statistics;
    let [width, height] = statistics.size;
    let directory = args.output.display();
    let mut lines = vec![
        format!(
            "wrote {directory}/weighted.png, unweighted.png, {JSON} and {} images: {width} x {height} \
             pixels, {} samples in {}",
            2 * found.images.len(),
            quantity(statistics.samples as f64),
            duration(statistics.render_seconds),
        ),
        "share of the image's light by technique (s,t):".into(),
    ];
    let edges = found.images.iter().map(|images| edges_of(images.technique));
    for k in 1..=edges.max().unwrap_or(0) {
        let images = found.images.iter().enumerate();
        let images = images.filter(|(_, images)| edges_of(images.technique) == k);
        let cells = images.map(|(i, images)| {
            let Technique { s, t } = images.technique;
            let share = shares.share(i).map_or("-".into(), percent);
            format!("({s},{t}) {share:>5}")
        });
        let cells: Vec<String> = cells.collect();
        lines.push(format!("  {:<8} {}", edges_text(k), cells.join("   ")));
    }
    lines.join("\n")
}
