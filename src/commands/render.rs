//! `metrolight render`: renders a scene file to an image.

use std::path::PathBuf;

use metrolight::render::{Budget, Integrator, Method, Rendering, Settings, choose, render};
use metrolight::scene::Scene;
use miette::{IntoDiagnostic, bail};

use super::integrator_args::IntegratorArgs;
use super::names::IntegratorName;
use super::output::Outputs;
use super::progress::Progress;
use super::run_args::RunArgs;
use super::saves::Saves;
use super::source::{Opened, SceneArgs, find_lost_light};
use super::values::SaveEvery;
use super::{
    Outcome, eprint, interrupt, memory, print, replay, statistics, values, warn, warn_more, wording,
};

/// Render a scene
///
/// Writes an OpenEXR image (linear RGB radiance, 32-bit floats, with the statistics of the render as
/// attributes) and a PNG preview (sRGB, clamped). The same scene, seed and --spp give bit-identical
/// images for any number of threads. Ctrl-C, SIGTERM and SIGHUP end the render early and keep its image.
/// No file that the render reads is ever replaced.
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

Exit codes: 0 done, 2 bad input, 130 interrupted by Ctrl-C, 143 by SIGTERM, 129 by SIGHUP (the image so far
is written)"
)]
pub struct Args {
    #[command(flatten)]
    scene: SceneArgs,

    /// OpenEXR file to write; the preview has the same name with .png
    /// [default: NAME.exr in the current directory; NAME is the scene file's name without extension,
    /// or that of its directory if the file is named `scene`]
    #[arg(short, long, value_name = "OUT.exr", value_parser = values::exr_path())]
    output: Option<PathBuf>,

    /// Integrator [default: bdpt or mmlt; a short pilot render decides]
    #[arg(long)]
    integrator: Option<IntegratorName>,

    #[arg(
        long,
        value_name = "N",
        value_parser = values::samples,
        conflicts_with = "time",
        help = spp_help()
    )]
    spp: Option<u64>,

    /// Rendering time (60s, 2m, 1.5h, or seconds) instead of --spp; loading does not count
    #[arg(long, value_name = "TIME", value_parser = values::seconds)]
    time: Option<f64>,

    /// Samples or mutations in all, instead of --spp: those of a render with --time, to render its image
    /// again. The statistics of that render have the whole command
    #[arg(long, value_name = "N", value_parser = values::samples, conflicts_with_all = ["spp", "time"])]
    samples: Option<u64>,

    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,

    #[command(flatten)]
    options: IntegratorArgs,

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

    /// Write the image so far (and its preview and statistics) from time to time (60s, 5m, or never)
    /// [default: 60s for renders that will take more than five minutes]
    #[arg(long, value_name = "TIME", value_parser = values::save_every)]
    save_every: Option<SaveEvery>,

    #[command(flatten)]
    run: RunArgs,
}

fn spp_help() -> String {
    let defaults: Vec<String> = Method::ALL
        .iter()
        .map(|method| {
            let n = method.default_samples_per_pixel();
            format!("{} {n}", method.name())
        })
        .collect();
    format!(
        "Samples per pixel; for pssmlt mutations per pixel [default: {}]",
        defaults.join(", ")
    )
}

/// Loads the scene, renders it, writes the image and prints a summary.
pub fn run(args: &Args) -> miette::Result<Outcome> {
    let mut settings = args.settings()?;
    let mut outputs = args.outputs()?;

    // Load.
    let opened = args.open(&settings, &outputs)?;
    outputs.crop = opened.scene.film.crop;
    let mut warnings = opened.warnings.clone();
    warn(&warnings);
    if !args.run.quiet {
        eprint(opened.times());
        if let Some(choice) = &opened.specular {
            eprint(wording::specular_choice(choice));
        }
    }
    let progress = args.run.progress();
    let lost = args.choose(&mut settings, &opened.scene, &progress)?;
    warn_more(&mut warnings, lost);
    if interrupt::requested() {
        eprint("interrupted before rendering began: nothing is written");
        return Ok(Outcome::Interrupted);
    }

    // Render.
    let report = |rendering: &Rendering, warnings: &[String]| {
        statistics::json(&args.scene, &opened, &settings, rendering, warnings).into_diagnostic()
    };
    let save = |rendering: &Rendering| {
        let so_far = rendering.warnings.iter().map(wording::warning);
        let warnings: Vec<String> = warnings.iter().cloned().chain(so_far).collect();
        outputs.write(rendering, &report(rendering, &warnings)?)
    };
    let every = args.save_every.unwrap_or(SaveEvery::Default);
    let saves = Saves::new(&progress, every, &save);
    let rendering = render(&opened.scene, &settings, &saves).into_diagnostic()?;
    progress.finish();
    warn_more(
        &mut warnings,
        rendering.warnings.iter().map(wording::warning),
    );
    replay::print_commands(&args.scene, &settings, &rendering.statistics);

    // Write.
    if rendering.interrupted && rendering.statistics.samples == 0 {
        eprint("interrupted before the first sample: nothing is written");
        return Ok(Outcome::Interrupted);
    }
    outputs.write_or_rescue(&rendering, &report(&rendering, &warnings)?)?;
    if !args.run.quiet {
        print(statistics::summary(&outputs, &rendering))?;
    }
    if rendering.interrupted {
        eprint("interrupted: the image holds the samples taken so far");
        return Ok(Outcome::Interrupted);
    }
    Ok(Outcome::Done)
}

impl Args {
    fn outputs(&self) -> miette::Result<Outputs> {
        let exr = match &self.output {
            Some(path) => path.clone(),
            None => format!("{}.exr", self.scene.name()?).into(),
        };
        Ok(Outputs::new(exr, self.stats.clone()))
    }

    /// Loads the scene. Fails if one of the outputs is a file that is read, or cannot be written, or if the
    /// render does not fit into memory.
    fn open(&self, settings: &Settings, outputs: &Outputs) -> miette::Result<Opened> {
        let files = outputs.files(if settings.wants_error() { 2 } else { 1 });
        files.protect(&[&self.scene.path])?;
        files.check_writable(0)?;
        interrupt::listen()?;
        let opened = self.scene.open(self.run.threads)?;
        files.protect(&opened.files)?;
        files.check_writable(opened.pixels())?;
        memory::check(settings, opened.pixels(), 0)?;
        Ok(opened)
    }

    /// Chooses the integrator by a pilot, unless it is given. Returns warnings of light that it cannot find.
    fn choose(
        &self,
        settings: &mut Settings,
        scene: &Scene,
        progress: &Progress,
    ) -> miette::Result<Vec<String>> {
        // All integrators that the pilot may choose combine the same techniques.
        let lost = find_lost_light(scene, settings.method().techniques(), progress);
        if let (None, Integrator::Mmlt(own)) = (self.integrator, &settings.integrator) {
            let choice = choose(scene, settings, own, &lost, progress).into_diagnostic()?;
            if !self.run.quiet {
                eprint(wording::choice(&choice));
            }
            settings.integrator = choice.integrator;
        }
        let method = Some(settings.method());
        let lost = lost.iter().map(|lost| wording::lost_light(lost, method));
        Ok(lost.collect())
    }

    fn settings(&self) -> miette::Result<Settings> {
        if self.target_error.is_some() && self.options.chains == Some(1) {
            bail!(
                "--target-error needs --chains 2 or more: the error is estimated from the spread of the chains"
            );
        }
        let defaults = Settings::of(self.options.integrator(self.integrator)?);
        Ok(Settings {
            budget: match (self.spp, self.time, self.samples) {
                (Some(n), _, _) => Budget::SamplesPerPixel(n),
                (None, Some(seconds), _) => Budget::Seconds(seconds),
                (None, None, Some(n)) => Budget::Samples(n),
                (None, None, None) if self.target_error.is_some() => Budget::Unlimited,
                (None, None, None) => defaults.budget,
            },
            error: self.error,
            target_error: self.target_error,
            seed: self.seed,
            threads: self.run.threads,
            ..defaults
        })
    }
}
