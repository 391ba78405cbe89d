//! Drivers: each chooses points of the hypercube, evaluates a path sampler there, and adds the splats to a
//! film until the budget is spent.
//!
//! ```
//! use metrolight::render::{Budget, Integrator, PssmltSettings, Settings, Unobserved, render};
//!
//! # let size = metrolight::mitsuba::Overrides { size: Some([16, 12]) };
//! # let path = std::path::Path::new("scenes/cornell/scene.xml");
//! # let scene = metrolight::mitsuba::load_with(path, &[], size)?.description.build()?;
//! let own = PssmltSettings { chains: 16, bootstrap: Some(4096), ..Default::default() };
//! let settings = Settings {
//!     budget: Budget::SamplesPerPixel(32),
//!     ..Settings::of(Integrator::Pssmlt(own))
//! };
//! let rendering = render(&scene, &settings, &Unobserved)?;
//! assert_eq!(rendering.statistics.samples, 32 * 16 * 12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod bootstrap;
mod choice;
mod clock;
mod driver;
pub mod error;
mod estimate;
mod independent;
pub mod memory;
pub mod mmlt;
mod passes;
mod pixel_sampler;
pub mod plan;
mod pssmlt;
pub mod replay;
pub mod sample_id;
pub mod settings;
mod specular;
pub mod statistics;
pub mod strategies;
pub mod target;
mod warnings;

use crate::film::Image;
use crate::integrators::PathSampler;
use crate::scene::Scene;

pub use choice::{Choice, ChoiceReason, choose};
pub use error::ErrorEstimate;
pub use memory::Memory;
pub use plan::pilot::MAX_SAMPLES as MAX_PILOT_SAMPLES;
pub use plan::{MmltSettings, Plan};
pub use replay::{Replay, ReplayError};
pub use sample_id::{NonFinite, SampleId};
pub use settings::{Budget, Integrator, MAX_CHAINS, Method, PssmltSettings, Settings};
pub use specular::{SpecularChoice, choose_specular};
pub use statistics::{MmltStatistics, MutationStatistics, PssmltStatistics, Statistics};
pub use strategies::{Strategies, StrategiesError, TechniqueImages, strategies};
pub use target::SplatTarget;
pub use warnings::Warning;

/// Progress of a render.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Seconds of rendering so far, excluding the time spent on snapshots.
    pub seconds: f64,
    /// Path samples, or mutations.
    pub samples: u64,
    /// Closest-hit and shadow rays.
    pub rays: u64,
}

/// Receives progress and may cancel the render.
pub trait Observer: Sync {
    /// A new phase of the work begins.
    fn phase(&self, name: &str);
    /// `fraction` of the phase is done; `seconds_left` is an estimate, once there is one.
    fn progress(&self, fraction: f64, seconds_left: Option<f64>);
    /// True if the render should finish the current block and return the image so far.
    fn interrupted(&self) -> bool;
    /// True if [`Self::on_snapshot`] should receive the image now.
    fn wants_snapshot(&self, _progress: &Progress) -> bool {
        false
    }
    /// Receives the image so far. The clock of the render is stopped meanwhile.
    fn on_snapshot(&self, _progress: &Progress, _image: &Image) {}
    /// True if [`Self::on_rendering`] should receive the result so far now.
    fn wants_rendering(&self, _progress: &Progress) -> bool {
        false
    }
    /// Receives the result so far, as an interrupted render would return it. The clock of the render is
    /// stopped meanwhile, and the final image stays the same to the bit.
    fn on_rendering(&self, _rendering: &Rendering) {}
}

/// An observer that ignores progress and never cancels.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unobserved;

impl Observer for Unobserved {
    fn phase(&self, _name: &str) {}
    fn progress(&self, _fraction: f64, _seconds_left: Option<f64>) {}
    fn interrupted(&self) -> bool {
        false
    }
}

/// The result of a render.
#[derive(Debug)]
pub struct Rendering {
    /// Linear RGB radiance, W/(m^2 sr) in the units of the scene.
    pub image: Image,
    /// Its error, if requested and if it could be estimated.
    pub error: Option<ErrorEstimate>,
    /// Samples, rays, times.
    pub statistics: Statistics,
    /// The observer cancelled the render before its budget was spent.
    pub interrupted: bool,
    /// Reasons to distrust the image, or to render for longer.
    pub warnings: Vec<Warning>,
}

/// Renders `scene`. The same scene and settings give a bit-identical image, for any number of threads,
/// unless the budget is a time or the observer cancels. Snapshots change an image of `pssmlt` by rounding:
/// they add the weights that states have so far.
///
/// # Errors
/// If the threads cannot be started.
pub fn render(
    scene: &Scene,
    settings: &Settings,
    observer: &dyn Observer,
) -> Result<Rendering, rayon::ThreadPoolBuildError> {
    match &settings.integrator {
        Integrator::Path | Integrator::Light | Integrator::Bdpt | Integrator::Pssmlt(_) => {
            render_paths(scene, settings.method().techniques(), settings, observer)
        }
        Integrator::Mmlt(method_settings) => run(settings, || {
            mmlt::render(scene, settings, method_settings, observer)
        }),
    }
}

/// Renders the paths of `path_sampler`, for example one of the caller's: by Markov chains if
/// `settings.integrator` is [`Integrator::Pssmlt`], otherwise by independent samples.
///
/// ```
/// use metrolight::integrators::{PathSampler, Workspace};
/// use metrolight::math::Rgb;
/// use metrolight::path::dimensions;
/// use metrolight::render::{Budget, Method, Settings, Unobserved, render_paths};
/// use metrolight::sampling::Sampler;
/// use metrolight::scene::Scene;
/// use metrolight::technique::{Connection, PathContribution, Technique};
///
/// /// Radiance 1/2 at every point of the film.
/// #[derive(Clone, Copy)]
/// struct Constant;
///
/// impl PathSampler for Constant {
///     fn sample_paths<S: Sampler>(
///         &self,
///         _: &Scene,
///         sampler: &mut S,
///         _: &mut Workspace,
///         mut visit: impl FnMut(PathContribution),
///     ) {
///         let film = sampler.get::<2>(dimensions::FILM).into();
///         let connection = Connection { value: Rgb::splat(0.5), weight: 1.0 };
///         visit(PathContribution::new(Technique::Hit { t: 2 }, film, connection));
///     }
/// }
///
/// # let size = metrolight::mitsuba::Overrides { size: Some([16, 12]) };
/// # let path = std::path::Path::new("scenes/cornell/scene.xml");
/// # let scene = metrolight::mitsuba::load_with(path, &[], size)?.description.build()?;
/// let mean = |method| {
///     let settings = Settings { budget: Budget::SamplesPerPixel(16), ..Settings::new(method) };
///     let image = render_paths(&scene, Constant, &settings, &Unobserved)?.image;
///     let values = image.pixels.iter().flatten();
///     Ok::<f32, Box<dyn std::error::Error>>(values.sum::<f32>() / (3 * 16 * 12) as f32)
/// };
/// assert!((mean(Method::Bdpt)? - 0.5).abs() < 1e-4);
/// assert!((mean(Method::Pssmlt)? - 0.5).abs() < 0.02);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// If the threads cannot be started.
pub fn render_paths<P: PathSampler + Copy + Send>(
    scene: &Scene,
    path_sampler: P,
    settings: &Settings,
    observer: &dyn Observer,
) -> Result<Rendering, rayon::ThreadPoolBuildError> {
    run(settings, || match &settings.integrator {
        Integrator::Pssmlt(method_settings) => {
            pssmlt::render(scene, path_sampler, settings, method_settings, observer)
        }
        _ => independent::render(scene, path_sampler, settings, observer),
    })
}

/// Runs a render on the threads of `settings`. Warns of a black image.
fn run(
    settings: &Settings,
    work: impl FnOnce() -> Rendering + Send,
) -> Result<Rendering, rayon::ThreadPoolBuildError> {
    let mut rendering = in_pool(settings.threads, work)?;
    let black = rendering
        .image
        .pixels
        .iter()
        .flatten()
        .all(|&value| value == 0.0);
    if black && !rendering.interrupted && rendering.warnings.is_empty() {
        rendering.warnings.push(Warning::Black);
    }
    Ok(rendering)
}

/// Runs `work` on `threads` threads, or on one per core.
fn in_pool<R: Send>(
    threads: Option<usize>,
    work: impl FnOnce() -> R + Send,
) -> Result<R, rayon::ThreadPoolBuildError> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads.unwrap_or(0))
        .build()?;
    Ok(pool.install(work))
}

/// Number of pixels of the film.
fn pixel_count(scene: &Scene) -> u64 {
    u64::from(scene.film.width) * u64::from(scene.film.height)
}
