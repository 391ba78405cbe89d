//! `metrolight render`: renders a scene file to an image.

use std::path::PathBuf;

use metrolight::analysis::lost_light;
use metrolight::markov::SmallStep;
use metrolight::render::{Budget, DivisionSettings, Integrator, Settings, choose, render};
use miette::{IntoDiagnostic, bail};

use super::names::{DirectName, IntegratorName};
use super::output::Outputs;
use super::run_args::RunArgs;
use super::source::SceneArgs;
use super::{Outcome, eprint, interrupt, print, replay, statistics, values, warn, wording};

/// Render a scene
///
/// Writes an OpenEXR image (linear RGB radiance, 32-bit floats, with the statistics of the render as
/// attributes) and a PNG preview (sRGB, clamped). The same scene, seed and --spp give bit-identical
/// images for any number of threads. Ctrl-C ends the render early and keeps its image.
#[derive(clap::Args)]
#[command(
    allow_negative_numbers = true,
    after_help = "\
Examples:
  metrolight render scenes/pool/scene.xml                    writes pool.exr and pool.png
  metrolight render scene.xml --time 2m -o out/a.exr         two minutes, into a directory
  metrolight render scene.xml --integrator bdpt --spp 64     bidirectional path tracing
  metrolight render scene.xml --target-error 0.01            until the relMSE is about 0.01
  metrolight render scene.xml --size 320x240 -D light=3      a small image, a variable set

Exit codes: 0 done, 2 bad input, 130 interrupted by Ctrl-C (the image so far is written)"
)]
pub struct Args {
    #[command(flatten)]
    scene: SceneArgs,

    /// OpenEXR file to write; the preview has the same name with .png
    /// [default: NAME.exr in the current directory; NAME is the scene file's name without extension,
    /// or that of its directory if the file is named `scene`]
    #[arg(short, long, value_name = "OUT.exr", value_parser = values::exr_path)]
    output: Option<PathBuf>,

    /// Integrator [default: bdpt or mmlt; a short pilot render decides]
    #[arg(long)]
    integrator: Option<IntegratorName>,

    #[arg(
        long,
        value_name = "N",
        value_parser = values::positive,
        conflicts_with = "time",
        help = spp_help()
    )]
    spp: Option<u64>,

    /// Rendering time (60s, 2m, 1.5h, or seconds) instead of --spp; loading does not count
    #[arg(long, value_name = "TIME", value_parser = values::seconds)]
    time: Option<f64>,

    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = Settings::default().seed)]
    seed: u64,

    #[arg(
        long,
        value_name = "P",
        value_parser = values::probability,
        help = large_step_help()
    )]
    large_step_probability: Option<f32>,

    #[arg(long, value_name = "STEP", value_parser = values::small_step, help = small_step_help())]
    small_step: Option<SmallStep>,

    #[arg(
        long,
        value_name = "N",
        value_parser = values::chains,
        help = chains_help()
    )]
    chains: Option<u64>,

    /// pssmlt: number of bootstrap samples
    /// [default: as many as make the standard error of b small]
    #[arg(long, value_name = "N", value_parser = values::positive)]
    bootstrap: Option<u64>,

    /// mmlt: how direct light is rendered: by independent samples only, or by both these and chains
    #[arg(long, value_name = "MODE")]
    direct: Option<DirectName>,

    /// mmlt: distribute chains by brightness alone, instead of equally over bright and dark regions
    #[arg(long)]
    no_importance_map: bool,

    /// mmlt: brightness above which chains render the rest of a path's contribution, relative to the
    /// expected brightness at its pixel [default: the pilot decides]
    #[arg(long, value_name = "T", value_parser = values::threshold)]
    threshold: Option<f32>,

    /// Estimate the standard error of every pixel: adds the channels standard_error.R, .G and .B to
    /// the EXR file and prints the expected relMSE
    #[arg(long)]
    error: bool,

    /// Stop as soon as the estimated relMSE is E or less; --spp or --time set an upper limit, without
    /// them there is none. Implies --error
    #[arg(long, value_name = "E", value_parser = values::target_error)]
    target_error: Option<f64>,

    /// Write the statistics of the render to a JSON file
    #[arg(long, value_name = "FILE.json")]
    stats: Option<PathBuf>,

    #[command(flatten)]
    run: RunArgs,
}

fn spp_help() -> String {
    let defaults: Vec<String> = Integrator::ALL
        .iter()
        .map(|integrator| {
            let n = integrator.default_samples_per_pixel();
            format!("{} {n}", integrator.name())
        })
        .collect();
    format!(
        "Samples per pixel; for pssmlt mutations per pixel [default: {}]",
        defaults.join(", ")
    )
}

fn large_step_help() -> String {
    let default = Settings::default().large_step_probability;
    format!("pssmlt: probability of a large step, from 0 to 1 [default: {default}]")
}

fn small_step_help() -> String {
    let default = |integrator: Integrator| integrator.default_small_step().to_string();
    format!(
        "pssmlt, mmlt: distribution of small steps: log:SHORTEST:LONGEST or gaussian:DEVIATION \
         [default: {}, {}]",
        default(Integrator::Pssmlt),
        default(Integrator::Mmlt)
    )
}

fn chains_help() -> String {
    let default = Settings::default().chains;
    format!("pssmlt: number of Markov chains [default: {default}]")
}

/// Loads the scene, renders it, writes the image and prints a summary.
pub fn run(args: Args) -> miette::Result<Outcome> {
    let mut settings = args.settings()?;
    let outputs = Outputs::prepare(args.output, &args.scene.name()?, args.stats)?;
    interrupt::listen()?;

    // Load.
    let opened = args.scene.open()?;
    let mut warnings = opened.warnings.clone();
    warn(&warnings);
    if !args.run.quiet {
        eprint(opened.times());
    }
    let progress = args.run.progress();
    // All integrators that the pilot may choose have the same sampler.
    let lost = lost_light(&opened.scene, settings.integrator.sampler());
    if args.integrator.is_none() {
        let choice = choose(&opened.scene, &settings, &lost, &progress).into_diagnostic()?;
        settings.integrator = choice.integrator;
        if !args.run.quiet {
            eprint(wording::choice(&choice));
        }
    }
    let lost: Vec<String> = lost.iter().map(wording::lost_light).collect();
    warn(&lost);
    warnings.extend(lost);
    if interrupt::requested() {
        eprint("interrupted before rendering began: nothing is written");
        return Ok(Outcome::Interrupted);
    }

    // Render.
    let rendering = render(&opened.scene, &settings, &progress).into_diagnostic()?;
    progress.finish();
    let limits: Vec<String> = rendering.warnings.iter().map(wording::warning).collect();
    warn(&limits);
    warnings.extend(limits);
    replay::print_commands(&args.scene, &settings, &rendering.statistics);

    // Write.
    if rendering.interrupted && rendering.statistics.samples == 0 {
        eprint("interrupted before the first sample: nothing is written");
        return Ok(Outcome::Interrupted);
    }
    let report = statistics::json(&args.scene, &opened, &settings, &rendering, &warnings);
    outputs.write(&rendering, &report.into_diagnostic()?)?;
    if !args.run.quiet {
        print(statistics::summary(&outputs, &rendering));
    }
    if rendering.interrupted {
        eprint("interrupted: the image holds the samples taken so far");
        return Ok(Outcome::Interrupted);
    }
    Ok(Outcome::Done)
}

impl Args {
    fn settings(&self) -> miette::Result<Settings> {
        // Until the pilot has chosen; both of its choices have the same default settings.
        let integrator = self.integrator.map_or(Integrator::Mmlt, Integrator::from);
        self.check_options(integrator)?;
        let defaults = Settings::new(integrator);
        Ok(Settings {
            integrator,
            budget: match (self.spp, self.time) {
                (Some(n), _) => Budget::SamplesPerPixel(n),
                (None, Some(seconds)) => Budget::Seconds(seconds),
                (None, None) if self.target_error.is_some() => Budget::Unlimited,
                (None, None) => defaults.budget,
            },
            error: self.error,
            target_error: self.target_error,
            seed: self.seed,
            threads: self.run.threads,
            large_step_probability: self
                .large_step_probability
                .unwrap_or(defaults.large_step_probability),
            small_step: self.small_step.unwrap_or(defaults.small_step),
            chains: self.chains.unwrap_or(defaults.chains),
            bootstrap: self.bootstrap,
            division: DivisionSettings {
                separate_direct: self.direct != Some(DirectName::Joint),
                importance: !self.no_importance_map,
                threshold: self.threshold,
            },
        })
    }

    /// Checks that options of some integrators only are given with one of these.
    fn check_options(&self, integrator: Integrator) -> miette::Result<()> {
        let (pssmlt, mmlt) = (Integrator::Pssmlt, Integrator::Mmlt);
        let large_step = self.large_step_probability.is_some();
        let options = [
            ("--large-step-probability", large_step, &[pssmlt][..]),
            ("--small-step", self.small_step.is_some(), &[pssmlt, mmlt]),
            ("--chains", self.chains.is_some(), &[pssmlt]),
            ("--bootstrap", self.bootstrap.is_some(), &[pssmlt]),
            ("--direct", self.direct.is_some(), &[mmlt]),
            ("--no-importance-map", self.no_importance_map, &[mmlt]),
            ("--threshold", self.threshold.is_some(), &[mmlt]),
        ];
        for (option, given, of) in options {
            let names: Vec<&str> = of.iter().map(|integrator| integrator.name()).collect();
            match self.integrator {
                Some(name) if given && !of.contains(&integrator) => {
                    bail!("{option} applies to {}, not to {name}", names.join(" and "))
                }
                None if given => bail!("{option} needs --integrator {}", names.join(" or ")),
                _ => {}
            }
        }
        if integrator.is_metropolis() && self.target_error.is_some() && self.chains == Some(1) {
            bail!(
                "--target-error needs --chains 2 or more: the error is estimated from the spread of the chains"
            );
        }
        Ok(())
    }
}
