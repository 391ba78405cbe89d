//! The reference image that renders are measured against.

use std::path::Path;

use metrolight::convergence::Curve;
use metrolight::film::Image;
use metrolight::metrics::expected_relative_mse;
use metrolight::render::{self, Budget, Method, Settings};
use metrolight::scene::Scene;
use miette::{IntoDiagnostic, bail};

use crate::commands::numbers::{digits, duration};
use crate::commands::output::Outputs;
use crate::commands::progress::Progress;
use crate::commands::source::{Opened, SceneArgs};
use crate::commands::statistics::json;
use crate::commands::{input, output, warn, wording};

/// A reference image and its error.
pub struct Reference {
    pub image: Image,
    /// Its expected relMSE, if known.
    pub relative_mse: Option<f64>,
    /// Its source and its error, in words.
    pub description: String,
}

/// Largest error of a reference without a warning, relative to the smallest error that was measured.
const MAX_SHARE: f64 = 0.1;

/// Reads a reference from a file.
pub fn read(path: &Path, scene: &Scene) -> miette::Result<Reference> {
    let annotated = input::read(path)?;
    let image = annotated.image;
    let [width, height] = [scene.film.width as usize, scene.film.height as usize];
    if (image.width, image.height) != (width, height) {
        bail!(
            "{}: {} x {} pixels, but the scene has {width} x {height}: give --size {}x{}",
            path.display(),
            image.width,
            image.height,
            image.width,
            image.height
        );
    }
    let errors = annotated.layers.get(output::STANDARD_ERROR);
    let relative_mse = errors.map(|errors| expected_relative_mse(&image.pixels, errors));
    Ok(Reference {
        description: format!("reference: {}; {}", path.display(), trust(relative_mse)),
        image,
        relative_mse,
    })
}

/// How a reference is rendered.
pub struct RenderOptions {
    pub method: Method,
    pub budget: Budget,
    pub seed: u64,
    pub threads: Option<usize>,
}

/// Renders a reference and writes it to `path`; `None` if the user interrupted.
pub fn render(
    args: &SceneArgs,
    opened: &Opened,
    options: RenderOptions,
    path: &Path,
    progress: &Progress,
) -> miette::Result<Option<Reference>> {
    let settings = Settings {
        budget: options.budget,
        seed: options.seed,
        threads: options.threads,
        error: true,
        ..Settings::new(options.method)
    };
    let rendering = render::render(&opened.scene, &settings, progress).into_diagnostic()?;
    progress.finish();
    if rendering.interrupted {
        return Ok(None);
    }
    let warnings: Vec<String> = rendering
        .warnings
        .iter()
        .map(|warning| format!("reference: {}", wording::warning(warning)))
        .collect();
    warn(&warnings);
    let report = json(args, opened, &settings, &rendering, &warnings).into_diagnostic()?;
    Outputs::new(path.into(), None).write_or_rescue(&rendering, &report)?;
    let relative_mse = rendering.error.as_ref().map(|error| error.relative_mse);
    let spent = match options.budget {
        Budget::SamplesPerPixel(n) => format!("{n} samples per pixel"),
        Budget::Seconds(_) | Budget::Samples(_) | Budget::Unlimited => {
            duration(rendering.statistics.render_seconds)
        }
    };
    let name = options.method.name();
    let description = format!("reference: {name}, {spent}; {}", trust(relative_mse));
    Ok(Some(Reference {
        image: rendering.image,
        relative_mse,
        description,
    }))
}

fn trust(relative_mse: Option<f64>) -> String {
    match relative_mse {
        Some(error) => format!(
            "its own relMSE is about {}, estimated from its samples",
            digits(error)
        ),
        None => "its own error is not known".into(),
    }
}

impl Reference {
    /// A warning if the error of the reference is a large part of the errors measured.
    pub fn doubt(&self, curves: &[Curve]) -> Option<String> {
        let own = self.relative_mse?;
        let ends = curves
            .iter()
            .filter_map(|curve| Some(curve.end()?.relative_mse));
        let least = ends.fold(f64::INFINITY, f64::min);
        (own > MAX_SHARE * least).then(|| {
            format!(
                "the reference's own relMSE, about {}, is part of every error measured, and \
                 {:.0}% of the least: increase --reference-effort",
                digits(own),
                100.0 * own / least
            )
        })
    }
}
