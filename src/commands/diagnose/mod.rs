//! `metrolight diagnose`: tests whether Markov chains are stationary, and measures how well they mix.

mod charts;
mod text;

use std::io::{IsTerminal, stderr};
use std::path::{Path, PathBuf};

use clap::ValueEnum;
use metrolight::diagnosis::{
    DiagnoseError, Diagnosis, DiagnosisBudget, MmltChains, MmltSamples, PssmltChains, diagnose,
};
use metrolight::render::{Method, MmltSettings, PssmltSettings};
use metrolight::scene::Scene;
use miette::{IntoDiagnostic, bail};
use serde_json::{Value, json};

use super::files::{Content, OutputFiles};
use super::integrator_args::check_applies;
use super::names::DEFAULT;
use super::output::{make_directory, write_json, write_text};
use super::progress::Progress;
use super::source::SceneArgs;
use super::{Outcome, eprint, interrupt, print, values, warn};

/// Test whether Markov chains are stationary, and measure how well they mix
///
/// Chains start exactly in the target distribution. Hypothesis tests check that they still have it
/// after 1, 8, 64 and 512 steps, that steps are reversible, and that b and the weights of the samples
/// agree with independent sampling. All p-values are corrected for multiple testing. Long chains that
/// start like those of a render give R-hat, effective sample sizes, autocorrelation and acceptance.
#[derive(clap::Args)]
#[command(
    allow_negative_numbers = true,
    after_help = "\
Examples:
  metrolight diagnose scenes/pool/scene.xml
  metrolight diagnose scenes/pool/scene.xml --alpha 1e-4 --json -o pool-chains
  metrolight diagnose scene.xml --integrator pssmlt --large-step-probability 0.1

Exit codes: 0 no test rejects, 1 the chains are not stationary, 2 bad input, 130 interrupted"
)]
pub struct Args {
    #[command(flatten)]
    scene: SceneArgs,

    /// Integrator whose chains are tested
    #[arg(long, default_value_t = ChainIntegrator::DEFAULT, value_enum)]
    integrator: ChainIntegrator,

    /// Significance level: the probability of rejecting correct chains
    #[arg(long, value_name = "A", value_parser = values::level, default_value_t = 1e-3)]
    alpha: f64,

    /// pssmlt: probability of a large step, from 0 to 1 [default: that of render]
    #[arg(long, value_name = "P", value_parser = values::probability)]
    large_step_probability: Option<f32>,

    /// mmlt: threshold above which the residual of a path's contribution is sampled by chains
    /// [default: the pilot decides]
    #[arg(long, value_name = "T", value_parser = values::threshold)]
    threshold: Option<f32>,

    /// Number of chains that start in equilibrium, if there are as many independent starts
    #[arg(long, value_name = "N", value_parser = values::chains, default_value_t = DiagnosisBudget::default().chains as u64)]
    chains: u64,

    /// Number of steps of each long chain
    #[arg(long, value_name = "N", value_parser = values::steps, default_value_t = DiagnosisBudget::default().steps)]
    steps: u64,

    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,

    /// Number of threads [default: one per core]
    #[arg(long, value_name = "N", value_parser = values::threads)]
    threads: Option<usize>,

    /// Print one JSON object with all tests instead of the text
    #[arg(long)]
    json: bool,

    /// Directory for diagnose.json, diagnose.txt and charts (SVG); made if it does not exist
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,

    /// Show no progress
    #[arg(short, long)]
    quiet: bool,
}

/// Integrators that have chains.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum ChainIntegrator {
    /// Primary sample space Metropolis over bidirectional path tracing
    Pssmlt,
    /// Multiplexed Metropolis for bright paths
    Mmlt,
}

impl ChainIntegrator {
    const DEFAULT: Self = match DEFAULT {
        Method::Pssmlt => Self::Pssmlt,
        _ => Self::Mmlt,
    };
}

impl From<ChainIntegrator> for Method {
    fn from(integrator: ChainIntegrator) -> Self {
        match integrator {
            ChainIntegrator::Pssmlt => Self::Pssmlt,
            ChainIntegrator::Mmlt => Self::Mmlt,
        }
    }
}

/// Files in the output directory, besides the charts.
const JSON_FILE: &str = "diagnose.json";
const TEXT_FILE: &str = "diagnose.txt";

/// Loads the scene, diagnoses the chains, and prints and writes the results.
pub fn run(args: &Args) -> miette::Result<Outcome> {
    args.check()?;
    let mut outputs = OutputFiles::default();
    if let Some(directory) = &args.output {
        make_directory(directory)?;
        for name in [JSON_FILE, TEXT_FILE].iter().chain(&charts::FILES) {
            outputs.add(directory.join(name), Content::Text, "-o");
        }
    }
    outputs.protect(&[&args.scene.path])?;
    outputs.check_writable(0)?;
    interrupt::listen()?;
    rayon::ThreadPoolBuilder::new()
        .num_threads(args.threads.unwrap_or(0))
        .build_global()
        .into_diagnostic()?;
    let mut opened = args.scene.open(args.threads)?;
    outputs.protect(&opened.files)?;
    warn(&opened.warnings);
    let method = Method::from(args.integrator);
    let progress = Progress::new(args.quiet, stderr().is_terminal());
    warn(opened.lost_light(method.techniques(), Some(method), &progress));
    let budget = args.budget();
    let diagnosis = match args.diagnose(&mut opened.scene, &budget, &progress) {
        Err(DiagnoseError::Interrupted) => {
            progress.finish();
            eprint("interrupted: nothing is written");
            return Ok(Outcome::Interrupted);
        }
        Err(error @ DiagnoseError::NoResidual(_)) => {
            bail!("{error}; give --integrator pssmlt, whose chains carry all light")
        }
        done => done.into_diagnostic()?,
    };
    progress.finish();

    let verdict = text::verdict(&diagnosis, args.alpha);
    let json = args.report(&budget, &diagnosis, &verdict)?;
    let text = format!("{verdict}\n\n{}", text::tables(&diagnosis, args.alpha));
    if let Some(directory) = &args.output {
        write_all(directory, &json, &text, &diagnosis)?;
        eprint(format_args!(
            "wrote {JSON_FILE}, {TEXT_FILE} and charts to {}",
            directory.display()
        ));
    }
    if args.json {
        print(format_args!("{json:#}"))?;
    } else {
        print(&text)?;
    }
    Ok(if diagnosis.rejections(args.alpha).is_empty() {
        Outcome::Done
    } else {
        Outcome::Rejected
    })
}

fn write_all(
    directory: &Path,
    json: &Value,
    text: &str,
    diagnosis: &Diagnosis,
) -> miette::Result<()> {
    write_json(&directory.join(JSON_FILE), json)?;
    write_text(&directory.join(TEXT_FILE), &format!("{text}\n"))?;
    for (name, svg) in charts::all(diagnosis).into_diagnostic()? {
        write_text(&directory.join(name), &svg)?;
    }
    Ok(())
}

impl Args {
    /// Checks that options are given with the integrator that has them.
    fn check(&self) -> miette::Result<()> {
        let large_step = self.large_step_probability.is_some();
        let options: [(&str, bool, &[Method]); 2] = [
            ("--large-step-probability", large_step, &[Method::Pssmlt]),
            ("--threshold", self.threshold.is_some(), &[Method::Mmlt]),
        ];
        check_applies(Some(self.integrator.into()), &options)
    }

    fn budget(&self) -> DiagnosisBudget {
        DiagnosisBudget {
            seed: self.seed,
            chains: self.chains as usize,
            steps: self.steps,
            ..DiagnosisBudget::default()
        }
    }

    fn pssmlt(&self) -> PssmltSettings {
        let defaults = PssmltSettings::default();
        PssmltSettings {
            large_step_probability: self
                .large_step_probability
                .unwrap_or(defaults.large_step_probability),
            ..defaults
        }
    }

    fn diagnose(
        &self,
        scene: &mut Scene,
        budget: &DiagnosisBudget,
        progress: &Progress,
    ) -> Result<Diagnosis, DiagnoseError> {
        match self.integrator {
            ChainIntegrator::Pssmlt => {
                let chains = PssmltChains::new(scene, self.pssmlt(), self.threads);
                diagnose(&chains, budget, progress)
            }
            ChainIntegrator::Mmlt => {
                let own = MmltSettings {
                    threshold: self.threshold,
                    ..MmltSettings::default()
                };
                let samples = MmltSamples::default();
                let chains = MmltChains::new(scene, own, self.seed, samples)?;
                diagnose(&chains, budget, progress)
            }
        }
    }

    fn report(
        &self,
        budget: &DiagnosisBudget,
        diagnosis: &Diagnosis,
        verdict: &str,
    ) -> miette::Result<Value> {
        let mut budget = serde_json::to_value(budget).into_diagnostic()?;
        // With the options of the integrator.
        match self.integrator {
            ChainIntegrator::Pssmlt => {
                budget["large_step_probability"] = json!(self.pssmlt().large_step_probability);
            }
            ChainIntegrator::Mmlt => budget["threshold"] = json!(self.threshold),
        }
        Ok(json!({
            "version": env!("CARGO_PKG_VERSION"),
            "scene": self.scene.path.to_string_lossy(),
            "integrator": Method::from(self.integrator),
            "alpha": self.alpha,
            "budget": budget,
            "stationary": diagnosis.rejections(self.alpha).is_empty(),
            "verdict": verdict,
            "diagnosis": serde_json::to_value(diagnosis).into_diagnostic()?,
        }))
    }
}
