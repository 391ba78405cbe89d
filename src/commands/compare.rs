//! `metrolight compare`: measures the error of an image, and tests whether it is biased.

use std::io::{IsTerminal, stderr};
use std::path::PathBuf;

use metrolight::film::{AnnotatedImage, Image};
use metrolight::metrics::flip;
use metrolight::metrics::{BiasTest, Estimate, image_errors, test_bias};
use metrolight::render::{ErrorEstimate, Observer};
use miette::bail;

use super::comparison::{Comparison, FILES};
use super::files::OutputFiles;
use super::input::read;
use super::mixture::mixtures;
use super::output::STANDARD_ERROR;
use super::progress::Progress;
use super::{Outcome, eprint, interrupt, print, warn};

/// Compare an image with a reference
///
/// Prints error metrics of an image, among them relMSE and FLIP. If both images have standard errors
/// (`render --error`), tests whether one of them is biased. Images are OpenEXR, Radiance HDR, PNG or
/// JPEG, of the same size.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  metrolight compare a.exr reference.exr             a table on stdout
  metrolight compare a.exr reference.exr --json      the same as JSON
  metrolight compare a.exr reference.exr -o out      and out/error.png, out/flip.png, out/compare.json

Exit codes: 0 compared, however different they are; 2 bad input; 130, 143 or 129
interrupted by Ctrl-C, SIGTERM or SIGHUP")]
pub struct Args {
    /// Image to measure
    #[arg(value_name = "IMAGE")]
    image: PathBuf,

    /// Reference image
    #[arg(value_name = "REFERENCE")]
    reference: PathBuf,

    /// Print one JSON object
    #[arg(long)]
    json: bool,

    /// Directory for error.png (relative error per pixel), flip.png (its visibility) and compare.json;
    /// made if it does not exist
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
}

/// Reads, compares, writes and prints.
pub fn run(args: &Args) -> miette::Result<Outcome> {
    let image = read(&args.image)?;
    let reference = read(&args.reference)?;
    let size = |image: &Image| format!("{} x {} pixels", image.width, image.height);
    let [a, b] = [&image.image, &reference.image];
    if [a.width, a.height] != [b.width, b.height] {
        bail!(
            "{} has {}, {} has {}: images of the same size are needed",
            args.image.display(),
            size(a),
            args.reference.display(),
            size(b)
        );
    }
    if let Some(directory) = &args.output {
        let mut outputs = OutputFiles::default();
        for (name, content) in FILES {
            outputs.add(directory.join(name), content, "-o");
        }
        outputs.protect(&[&args.image, &args.reference])?;
        super::output::make_directory(directory)?;
        outputs.check_writable(image.image.pixels.len() as u64)?;
    }
    for (path, image) in [(&args.image, &image), (&args.reference, &reference)] {
        warn(mixtures(path, image));
    }
    interrupt::listen()?;
    let Some(comparison) = compare(args, &image, &reference) else {
        eprint("interrupted: nothing is written");
        return Ok(Outcome::Interrupted);
    };
    let report = comparison.json(&image.image);
    if let Some(directory) = &args.output {
        comparison.write(directory, a, b, &report)?;
    }
    if args.json {
        print(format_args!("{report:#}"))?;
    } else {
        print(comparison.text(args.output.as_deref()))?;
    }
    Ok(Outcome::Done)
}

/// `None` if the user interrupted.
fn compare<'a>(
    args: &'a Args,
    image: &AnnotatedImage,
    reference: &AnnotatedImage,
) -> Option<Comparison<'a>> {
    let progress = Progress::new(false, stderr().is_terminal());
    progress.phase("FLIP");
    let start = std::time::Instant::now();
    let flip = flip(&image.image, &reference.image, &|done| {
        progress.steady(start, done);
        !progress.interrupted()
    });
    progress.finish();
    Some(Comparison {
        names: [&args.image, &args.reference],
        errors: image_errors(&image.image.pixels, &reference.image.pixels),
        flip: flip?,
        bias: bias_test(image, reference),
        notes: notes(args, image, reference),
    })
}

/// The test for bias, or the reason why there is none.
fn bias_test(image: &AnnotatedImage, reference: &AnnotatedImage) -> Result<BiasTest, String> {
    let [Some(a), Some(b)] = [image, reference].map(estimate) else {
        let without = match [image, reference].map(|image| estimate(image).is_some()) {
            [false, true] => "the image has no",
            [true, false] => "the reference has no",
            _ => "neither image has",
        };
        return Err(format!(
            "{without} standard errors: render with --error to test for bias"
        ));
    };
    Ok(test_bias(&a, &b, image.image.width))
}

/// The image with its standard errors, if it has them. Pixels are independent only if the image was
/// rendered by path tracing, without splats.
fn estimate(image: &AnnotatedImage) -> Option<Estimate<'_>> {
    let parts = image.number("metrolight.error.independent_parts");
    Some(Estimate {
        pixels: &image.image.pixels,
        standard_errors: image.layers.get(STANDARD_ERROR)?,
        parts: parts.filter(|&n| n >= 2.0).map(|n| n as u64),
        independent_pixels: image.text("metrolight.integrator") == Some("path"),
    })
}

fn notes(args: &Args, image: &AnnotatedImage, reference: &AnnotatedImage) -> Vec<String> {
    let mut notes = Vec::new();
    for path in [&args.image, &args.reference] {
        let extension = path.extension().unwrap_or_default();
        if ["png", "jpg", "jpeg"]
            .iter()
            .any(|e| extension.eq_ignore_ascii_case(e))
        {
            notes.push(format!(
                "{} holds no values above 1: larger values of the other image count as error",
                path.display()
            ));
        }
    }
    if estimate(image).is_some() && estimate(reference).is_some() {
        notes.extend(notes_on_errors([
            ("the image", image),
            ("the reference", reference),
        ]));
    }
    notes
}

/// What limits the test for bias.
fn notes_on_errors(images: [(&str, &AnnotatedImage); 2]) -> Vec<String> {
    let mut notes = Vec::new();
    for (name, image) in images {
        if estimate(image).is_some_and(|estimate| estimate.parts.is_none()) {
            notes.push(format!(
                "{name} does not say how many independent parts its standard errors come from: the \
                 test takes them as exact"
            ));
        }
        let dominated = image.number("metrolight.error.pixels_dominated_by_one_part");
        if let Some(dominated) =
            dominated.filter(|&share| share > ErrorEstimate::MAX_DOMINATED_SHARE)
        {
            notes.push(format!(
                "in {:.0}% of the pixels of {name} nearly all variance comes from one part of the \
                 samples: its errors are probably larger than estimated, and the test may report \
                 bias where there is none",
                100.0 * dominated
            ));
        }
    }
    let seeds = images.map(|(_, image)| image.number("metrolight.seed"));
    if seeds[0].is_some() && seeds[0] == seeds[1] {
        notes.push(
            "both images have the same seed and may share random numbers: the test may miss bias"
                .into(),
        );
    }
    notes
}
