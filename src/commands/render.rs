//! `metrolight render`: a scene file becomes an image.

use std::path::PathBuf;

use metrolight::analysis::lost_light;
use metrolight::markov::SmallStep;
use metrolight::render::{Budget, DivisionSettings, Integrator, Settings, choose, render};
use miette::{IntoDiagnostic, bail};

use super::names::{DirectName, IntegratorName};
use super::output::Outputs;
use super::run_args::RunArgs;
use super::source::SceneArgs;
use super::{Outcome, interrupt, replay, say, statistics, tell, values, warn, wording};

/// Render a scene
///
/// Writes an OpenEXR image (linear RGB radiance, 32-bit floats, with the figures of the render as
/// attributes) and a PNG preview (sRGB, clamped). The same scene, seed and --spp give the same image
/// to the bit, whatever the number of threads. Ctrl-C ends the render early and keeps its image.
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

    /// OpenEXR file to write; the preview goes beside it, with .png
    /// [default: NAME.exr in the current directory, NAME the scene file's stem, or its folder's
    /// name if the stem is `scene`]
    #[arg(short, long, value_name = "OUT.exr", value_parser = values::exr_path)]
    output: Option<PathBuf>,

    /// Method [default: bdpt or mmlt, as a short pilot decides]
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

    /// Time to render in (60s, 2m, 1.5h, or plain seconds), instead of --spp; loading does not count
    #[arg(long, value_name = "TIME", value_parser = values::seconds)]
    time: Option<f64>,

    /// Seed of all random numbers
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
    /// [default: until the standard error of b is small]
    #[arg(long, value_name = "N", value_parser = values::positive)]
    bootstrap: Option<u64>,

    /// mmlt: who renders direct light: plain samples, or these and the chains like all else
    #[arg(long, value_name = "WHO")]
    direct: Option<DirectName>,

    /// mmlt: let all regions of the image count by their brightness, and not alike
    #[arg(long)]
    no_importance_map: bool,

    /// mmlt: how bright a path must be for chains to take over, in units of the brightness expected
    /// where it lands [default: as the pilot decides]
    #[arg(long, value_name = "T", value_parser = values::threshold)]
    threshold: Option<f32>,

    /// Estimate the standard error of every pixel: adds the channels standard_error.R, .G and .B to
    /// the EXR file and prints the relMSE that they make expect
    #[arg(long)]
    error: bool,

    /// Stop as soon as the estimated relMSE is E or less; with --spp or --time no later than these
    /// say, else however long it takes. Means --error too
    #[arg(long, value_name = "E", value_parser = values::target_error)]
    target_error: Option<f64>,

    /// Write the figures of the render to a JSON file
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
        "pssmlt, mmlt: how numbers move in a small step: log:SHORTEST:LONGEST or gaussian:DEVIATION \
         [default: {}, {}]",
        default(Integrator::Pssmlt),
        default(Integrator::Mmlt)
    )
}

fn chains_help() -> String {
    let default = Settings::default().chains;
    format!("pssmlt: number of Markov chains [default: {default}]")
}

/// Loads, renders, writes and sums up.
pub fn run(args: Args) -> miette::Result<Outcome> {
    let mut settings = args.settings()?;
    let outputs = Outputs::prepare(args.output, &args.scene.name()?, args.stats)?;
    interrupt::listen()?;

    // Load.
    let opened = args.scene.open()?;
    let mut warnings = opened.warnings.clone();
    warn(&warnings);
    if !args.run.quiet {
        tell(opened.times());
    }
    let progress = args.run.progress();
    // All integrators that the pilot may choose have the same sampler.
    let lost = lost_light(&opened.scene, settings.integrator.sampler());
    if args.integrator.is_none() {
        let choice = choose(&opened.scene, &settings, &lost, &progress).into_diagnostic()?;
        settings.integrator = choice.integrator;
        if !args.run.quiet {
            tell(wording::choice(&choice));
        }
    }
    let lost: Vec<String> = lost.iter().map(wording::lost_light).collect();
    warn(&lost);
    warnings.extend(lost);
    if interrupt::requested() {
        tell("interrupted before rendering began: nothing is written");
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
        tell("interrupted before the first sample: nothing is written");
        return Ok(Outcome::Interrupted);
    }
    let report = statistics::json(&args.scene, &opened, &settings, &rendering, &warnings);
    outputs.write(&rendering, &report.into_diagnostic()?)?;
    if !args.run.quiet {
        say(statistics::summary(&outputs, &rendering));
    }
    if rendering.interrupted {
        tell("interrupted: the image holds what had been rendered by then");
        return Ok(Outcome::Interrupted);
    }
    Ok(Outcome::Done)
}

impl Args {
    fn settings(&self) -> miette::Result<Settings> {
        // Until a pilot has chosen: what it may choose has the same defaults.
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

    /// Options that mean something to some integrators alone must come with one of them.
    fn check_options(&self, integrator: Integrator) -> miette::Result<()> {
        let (pssmlt, mmlt) = (Integrator::Pssmlt, Integrator::Mmlt);
        let large_step = self.large_step_probability.is_some();
        let of_some = [
            ("--large-step-probability", large_step, &[pssmlt][..]),
            ("--small-step", self.small_step.is_some(), &[pssmlt, mmlt]),
            ("--chains", self.chains.is_some(), &[pssmlt]),
            ("--bootstrap", self.bootstrap.is_some(), &[pssmlt]),
            ("--direct", self.direct.is_some(), &[mmlt]),
            ("--no-importance-map", self.no_importance_map, &[mmlt]),
            ("--threshold", self.threshold.is_some(), &[mmlt]),
        ];
        for (option, given, of) in of_some {
            match self.integrator {
                Some(name) if given && !of.contains(&integrator) => {
                    bail!("{option} means nothing to the integrator {name}")
                }
                None if given => bail!("{option} needs --integrator {}", of[0].name()),
                _ => {}
            }
        }
        if integrator.is_metropolis() && self.target_error.is_some() && self.chains == Some(1) {
            bail!("--target-error needs two chains at least: the error is seen from their spread");
        }
        Ok(())
    }
}
