//! `metrolight replay`: repeats one sample of a render and shows its paths.

use glam::DVec3;
use metrolight::markov::Perturbation;
use metrolight::math::color::is_light;
use metrolight::path::Vertex;
use metrolight::render::{Integrator, PssmltSettings, Replay, SampleId, Settings, Statistics};
use metrolight::scene::Scene;
use metrolight::technique::PathContribution;
use miette::bail;

use super::names::{DEFAULT, IntegratorName};
use super::numbers::duration;
use super::source::SceneArgs;
use super::{Outcome, eprint, print, values, warn};

/// Repeat one sample of a render and show its paths
///
/// A render prints this command for each of the first samples that were not finite. The integrator,
/// the seed and --at identify the sample; --size, --max-depth and -D must be those of the render.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  metrolight replay scene.xml --integrator bdpt --seed 1 --at pass=3,pixel=120
  metrolight replay scene.xml --integrator pssmlt --at chain=5,start=81234,step=600

Exit codes: 0 done, 2 bad input")]
pub struct Args {
    #[command(flatten)]
    scene: SceneArgs,

    /// Integrator of the render
    #[arg(long, default_value_t = IntegratorName(DEFAULT))]
    integrator: IntegratorName,

    /// Seed of the render
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,

    /// The sample, as the render printed it
    #[arg(long, value_name = "SAMPLE", value_parser = str::parse::<SampleId>)]
    at: SampleId,

    /// For a sample of a chain: the probability of a large step in the render
    #[arg(
        long,
        value_name = "P",
        value_parser = values::probability,
        default_value_t = PssmltSettings::default().large_step_probability
    )]
    large_step_probability: f32,

    /// For a sample of a chain: the small steps in the render [default: those of the integrator]
    #[arg(long, value_name = "STEP", value_parser = values::small_step)]
    small_step: Option<Perturbation>,
}

/// Maximum number of command lines that a render prints.
const MAX_COMMANDS: usize = 8;

/// Prints command lines that replay the first samples of a render that were not finite.
pub fn print_commands(scene: &SceneArgs, settings: &Settings, statistics: &Statistics) {
    for &sample in statistics.non_finite_samples.iter().take(MAX_COMMANDS) {
        eprint(format_args!(
            "not finite: {}",
            command(scene, settings, sample)
        ));
    }
}

/// The command line that replays a sample of a render.
fn command(scene: &SceneArgs, settings: &Settings, sample: SampleId) -> String {
    let mut words = format!(
        "metrolight replay {} --integrator {} --seed {} --at {sample}",
        scene.words(),
        settings.method().name(),
        settings.seed
    );
    if let (SampleId::Mutation { .. }, Integrator::Pssmlt(own)) = (sample, &settings.integrator) {
        let defaults = PssmltSettings::default();
        if own.large_step_probability != defaults.large_step_probability {
            words += &format!(" --large-step-probability {}", own.large_step_probability);
        }
        if own.small_step != defaults.small_step {
            words += &format!(" --small-step {}", own.small_step);
        }
    }
    words
}

/// A usual speed of a chain.
const STEPS_PER_SECOND: f64 = 100_000.0;

/// Seconds that need no announcement.
const LONG: f64 = 180.0;

/// Prints subpaths and connections on stdout.
pub fn run(args: &Args) -> miette::Result<Outcome> {
    let opened = args.scene.open(None)?;
    warn(&opened.warnings);
    let mut settings = Settings {
        seed: args.seed,
        ..Settings::new(args.integrator.0)
    };
    if let Integrator::Pssmlt(own) = &mut settings.integrator {
        own.large_step_probability = args.large_step_probability;
        own.small_step = args.small_step.unwrap_or(own.small_step);
    }
    if let SampleId::Mutation { step, .. } = args.at
        && step as f64 > LONG * STEPS_PER_SECOND
    {
        let seconds = step as f64 / STEPS_PER_SECOND;
        eprint(format_args!(
            "repeating {step} steps takes about {}, at {STEPS_PER_SECOND} steps per second",
            duration(seconds)
        ));
    }
    let scene = &opened.scene;
    let replay = match Replay::run(scene, &settings, args.at) {
        Ok(replay) => replay,
        Err(error) => bail!("--at {}: {error}", args.at),
    };
    print(format_args!(
        "{} of {}, {}, seed {}",
        args.at,
        args.scene.path.display(),
        args.integrator,
        args.seed
    ))?;
    subpath(
        scene,
        "camera subpath",
        'z',
        &replay.workspace.camera.vertices,
    )?;
    subpath(
        scene,
        "light subpath",
        'y',
        &replay.workspace.light.vertices,
    )?;
    if replay.contributions.is_empty() {
        print("no technique found light")?;
    }
    for path in &replay.contributions {
        print(path_line(scene, path))?;
    }
    Ok(Outcome::Done)
}

fn subpath(scene: &Scene, name: &str, letter: char, vertices: &[Vertex]) -> miette::Result<()> {
    print(format_args!("{name}: {} surface vertices", vertices.len()))?;
    for (i, vertex) in (1..).zip(vertices) {
        let surface = &vertex.surface;
        print(format_args!(
            "  {letter}_{i} at {} on {}, {}; alpha {}",
            triple(scene.to_world(surface.position)),
            scene.geometry.shape_name(surface.shape),
            vertex.material(scene).name(),
            triple(vertex.throughput.as_dvec3()),
        ))?;
    }
    Ok(())
}

/// One line for a path: technique, film position, value and weight.
fn path_line(scene: &Scene, path: &PathContribution) -> String {
    let fault = if is_light(path.splat().value) {
        ""
    } else {
        "  <- not finite or negative: left out of the image"
    };
    format!(
        "technique {} at film position ({:.2}, {:.2}): value {} x weight {}{fault}",
        path.technique,
        path.film.x * scene.film.width as f32,
        path.film.y * scene.film.height as f32,
        triple(path.value.as_dvec3()),
        path.weight,
    )
}

/// Three numbers with six decimals, in scientific notation if they are very small or large.
fn triple(v: DVec3) -> String {
    let number = |x: f64| match x.abs() {
        0.0 => "0".into(),
        1e-3..1e6 => format!("{x:.6}"),
        _ => format!("{x:.6e}"),
    };
    format!("({}, {}, {})", number(v.x), number(v.y), number(v.z))
}
