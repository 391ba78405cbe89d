//! `metrolight converge`: measures the error of integrators against time.

mod files;
mod reference;
mod sweep;

use std::path::PathBuf;

use metrolight::convergence::{Curve, Experiment, Variant};
use metrolight::render::{Budget, Method, Warning};
use miette::{IntoDiagnostic, bail};

use self::files::{Files, Results};
use self::reference::RenderOptions;
use self::sweep::Sweep;
use super::names::IntegratorName;
use super::numbers::duration;
use super::progress::Progress;
use super::run_args::RunArgs;
use super::source::{Opened, SceneArgs};
use super::{Outcome, eprint, interrupt, memory, output, print, values, warn, wording};

/// Chart the error of integrators against time
///
/// Renders the scene several times with each integrator, and measures the error of the image against a
/// reference during each render; the time of measuring does not count. Writes convergence.svg and .png
/// (relMSE against seconds and against rays, and relMSE without the worst 0.1% of the pixels against
/// seconds; a line for the mean of the repeats, a band from the least to the greatest), convergence.csv
/// (all measurements), convergence.json, and for each integrator the final image of its first repeat
/// with a false-colour image of its error.
#[derive(clap::Args)]
#[command(
    allow_negative_numbers = true,
    after_help = "\
Examples:
  metrolight converge scenes/pool/scene.xml --integrators bdpt,mmlt --time 60s -o pool-chart
  metrolight converge scene.xml --reference truth.exr --integrators path,bdpt --spp 256 -o chart
  metrolight converge scene.xml --integrators pssmlt --time 20s -o chart \\
      --sweep large-step-probability=0.05,0.1,0.3,0.6

Exit codes: 0 done, 2 bad input, 130 interrupted by Ctrl-C, 143 by SIGTERM, 129 by SIGHUP (complete
renders are charted)"
)]
pub struct Args {
    #[command(flatten)]
    scene: SceneArgs,

    /// Integrators to measure; the first is the baseline that the others are compared with
    #[arg(
        long,
        value_name = "NAME,...",
        default_value = "bdpt,mmlt",
        value_delimiter = ','
    )]
    integrators: Vec<IntegratorName>,

    /// Time of each render (60s, 2m, 1.5h, or seconds) [default: 60s]
    #[arg(long, value_name = "TIME", value_parser = values::seconds)]
    time: Option<f64>,

    /// Samples (for pssmlt mutations) per pixel of each render, instead of --time
    #[arg(long, value_name = "N", value_parser = values::samples, conflicts_with = "time")]
    spp: Option<u64>,

    /// Number of renders of each integrator; each has its own seed, counting up from --seed
    #[arg(long, value_name = "N", value_parser = values::repeats, default_value_t = 5)]
    repeats: u64,

    /// Directory for all files; made if it does not exist
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,

    /// Reference image, of the scene's size [default: rendered first, into reference.exr]
    #[arg(long, value_name = "REF.exr")]
    reference: Option<PathBuf>,

    /// Integrator of the reference
    /// [default: mmlt or pssmlt if it is among --integrators, else bdpt]
    #[arg(long, value_name = "NAME", conflicts_with = "reference")]
    reference_integrator: Option<IntegratorName>,

    /// Time (or samples) of the reference, in multiples of those of one render
    #[arg(
        long,
        value_name = "N",
        value_parser = values::repeats,
        conflicts_with = "reference",
        default_value_t = 10
    )]
    reference_effort: u64,

    /// Measure several values of one option: large-step-probability, chains, bootstrap, threads,
    /// small-step, threshold, direct (separate, joint), importance-map (on, off) or specular (auto, on, everywhere, off)
    #[arg(long, value_name = "OPTION=V1,V2,...", value_parser = sweep::sweep)]
    sweep: Option<Sweep>,

    /// Seed of the first repeat
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,

    #[command(flatten)]
    run: RunArgs,
}

/// Default time of a render, in seconds.
const DEFAULT_SECONDS: f64 = 60.0;

/// Loads the scene, reads or renders the reference, measures the renders and writes the results.
pub fn run(args: &Args) -> miette::Result<Outcome> {
    let variants = args.variants()?;
    let files = Files::new(&args.output, &variants)?;
    let outputs = files.outputs(args.reference.is_none());
    let inputs = [Some(&args.scene.path), args.reference.as_ref()];
    outputs.protect(&inputs.into_iter().flatten().collect::<Vec<_>>())?;
    outputs.check_writable(0)?;
    interrupt::listen()?;
    let mut opened = args.scene.open(args.run.threads)?;
    outputs.protect(&opened.files)?;
    outputs.check_writable(opened.pixels())?;
    for Variant { settings, .. } in &variants {
        // The reference, and an image of each variant.
        let images = (variants.len() as u64 + 2).saturating_mul(3 * 4);
        let images = opened.pixels().saturating_mul(images);
        memory::check(settings, opened.pixels(), images)?;
    }
    warn(&opened.warnings);
    let progress = args.run.progress();
    warn(lost(&mut opened, &variants, &progress));
    if !args.run.quiet {
        args.announce(variants.len());
    }

    // Read or render the reference.
    let reference = match &args.reference {
        Some(path) => reference::read(path, &opened.scene)?,
        None => {
            let options = args.reference_options();
            let rendered =
                reference::render(&args.scene, &opened, options, &files.reference(), &progress)?;
            let Some(reference) = rendered else {
                eprint("interrupted before the reference was complete: nothing is measured");
                return Ok(Outcome::Interrupted);
            };
            reference
        }
    };
    if !args.run.quiet {
        print(&reference.description)?;
    }

    // Measure.
    let mut experiment = Experiment {
        scene: &mut opened.scene,
        reference: &reference.image,
        variants: &variants,
        repeats: args.repeats,
    };
    let outcome = experiment.run(&progress).into_diagnostic()?;
    progress.finish();
    let warnings = limits(&outcome.warnings, &variants);
    warn(&warnings);
    if outcome.measurements.is_empty() {
        eprint("interrupted before the first render was complete: nothing is charted");
        return Ok(Outcome::Interrupted);
    }

    // Write.
    let curves: Vec<Curve> = (0..variants.len())
        .map(|i| Curve::new(&outcome.measurements, i))
        .collect();
    files.write_or_rescue(&Results {
        scene_name: &args.scene.name()?,
        settings: args.settings_json(&opened),
        reference: &reference,
        variants: &variants,
        curves: &curves,
        outcome: &outcome,
        warnings: &warnings,
    })?;
    warn(reference.doubt(&curves));
    if !args.run.quiet {
        print(files::summary(&variants, &curves))?;
        print(files.wrote())?;
    }
    if outcome.interrupted {
        eprint("interrupted: the chart holds the complete renders");
        return Ok(Outcome::Interrupted);
    }
    Ok(Outcome::Done)
}

/// Warnings of light that an integrator cannot find: it is part of the error if the reference has it.
fn lost(opened: &mut Opened, variants: &[Variant], progress: &Progress) -> Vec<String> {
    let usual = opened.scene.casters.search();
    let mut lines = Vec::new();
    for variant in variants {
        opened
            .scene
            .casters
            .set_search(variant.search.unwrap_or(usual));
        let method = variant.settings.method();
        let lost = opened.lost_light(method.techniques(), Some(method), progress);
        lines.extend(lost.iter().map(|lost| format!("{}: {lost}", variant.label)));
    }
    opened.scene.casters.set_search(usual);
    lines
}

/// Warnings of all renders, each sentence once.
fn limits(warnings: &[(usize, Warning)], variants: &[Variant]) -> Vec<String> {
    let mut lines = Vec::new();
    for (variant, warning) in warnings {
        let line = format!(
            "{}: {}",
            variants[*variant].label,
            wording::warning(warning)
        );
        if !lines.contains(&line) {
            lines.push(line);
        }
    }
    lines
}

impl Args {
    /// Says how long the experiment takes, if it is long and time ends its renders.
    fn announce(&self, variants: usize) {
        /// Seconds that need no announcement.
        const LONG: f64 = 180.0;
        let Budget::Seconds(seconds) = self.budget() else {
            return;
        };
        let renders = variants as u64 * self.repeats;
        let reference = match self.reference {
            Some(_) => 0.0,
            None => self.reference_effort as f64 * seconds,
        };
        let total = reference + renders as f64 * seconds;
        if total > LONG {
            let each = duration(seconds);
            let after = match self.reference {
                Some(_) => String::new(),
                None => format!(", after a reference of {}", duration(reference)),
            };
            eprint(format_args!(
                "this takes about {}: {renders} renders of {each}{after}",
                duration(total)
            ));
        }
    }

    fn budget(&self) -> Budget {
        match (self.spp, self.time) {
            (Some(n), _) => Budget::SamplesPerPixel(n),
            (None, seconds) => Budget::Seconds(seconds.unwrap_or(DEFAULT_SECONDS)),
        }
    }

    /// Every integrator, with every value of the sweep if the option applies to it.
    fn variants(&self) -> miette::Result<Vec<Variant>> {
        let mut variants = Vec::new();
        for &name in &self.integrators {
            let method = name.0;
            let mut variant = Variant::new(method);
            variant.settings.budget = self.budget();
            variant.settings.seed = self.seed;
            variant.settings.threads = self.run.threads;
            match &self.sweep {
                Some(sweep) if sweep.applies_to(method) => variants.extend(sweep.apply(&variant)),
                _ => variants.push(variant),
            }
        }
        if let Some(sweep) = &self.sweep
            && !self
                .integrators
                .iter()
                .any(|&name| sweep.applies_to(name.0))
        {
            bail!(
                "--sweep: {} applies to none of the integrators",
                sweep.name()
            );
        }
        for (i, variant) in variants.iter().enumerate() {
            if variants[..i]
                .iter()
                .any(|other| other.label == variant.label)
            {
                bail!("{} is named twice", variant.label);
            }
        }
        Ok(variants)
    }

    fn reference_options(&self) -> RenderOptions {
        let measured = |method| {
            let mut names = self.integrators.iter();
            names.any(|&name| name.0 == method)
        };
        let method = match self.reference_integrator {
            Some(name) => name.0,
            None if measured(Method::Mmlt) => Method::Mmlt,
            None if measured(Method::Pssmlt) => Method::Pssmlt,
            None => Method::Bdpt,
        };
        RenderOptions {
            method,
            budget: match self.budget() {
                Budget::SamplesPerPixel(n) => {
                    Budget::SamplesPerPixel(n.saturating_mul(self.reference_effort))
                }
                Budget::Seconds(seconds) => Budget::Seconds(seconds * self.reference_effort as f64),
                budget @ (Budget::Samples(_) | Budget::Unlimited) => budget,
            },
            // No repeat may have this seed: its image would be correlated with the reference.
            seed: !self.seed,
            threads: self.run.threads,
        }
    }

    fn settings_json(&self, opened: &Opened) -> serde_json::Value {
        let film = &opened.scene.film;
        serde_json::json!({
            "version": env!("CARGO_PKG_VERSION"),
            "scene": self.scene.path.to_string_lossy(),
            "size": [film.width, film.height],
            "max_depth": opened.scene.depth.max_depth,
            "budget": output::budget_json(self.budget()),
            "repeats": self.repeats,
            "seed": self.seed,
            "threads": self.run.threads.unwrap_or_else(rayon::current_num_threads),
        })
    }
}
