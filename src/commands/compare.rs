//! `metrolight compare`: how far an image is from a reference, and whether it is biased.

use std::io::{IsTerminal, Write, stderr};
use std::path::{Path, PathBuf};

use metrolight::film::{
    AnnotatedImage, Decode, Flip, Image, WriteError, check_writable, flip, read_annotated,
    replace_file,
};
use metrolight::plot::{Picture, draw_with_scale, rasterize};
use metrolight::render::Observer;
use metrolight::statistics::{
    BiasTest, BiasVerdict, Estimate, ImageError, bias, image_errors, relative_square_errors,
    test_bias,
};
use miette::{IntoDiagnostic, bail, miette};
use serde_json::json;

use super::progress::Progress;
use super::{Outcome, interrupt, say, tell};

/// Compare an image with a reference
///
/// Prints what an image differs by in the measures of the field, and how different it looks (FLIP). If
/// both images carry standard errors (`render --error`), tests whether one of them is biased. Images
/// are OpenEXR, Radiance HDR, PNG or JPEG, of one size.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  metrolight compare a.exr reference.exr             a table on stdout
  metrolight compare a.exr reference.exr --json      the same as JSON
  metrolight compare a.exr reference.exr -o out      and out/error.png, out/flip.png, out/compare.json

Exit codes: 0 compared, however different they are; 2 bad input; 130 interrupted by Ctrl-C")]
pub struct Args {
    /// The image to judge
    #[arg(value_name = "IMAGE")]
    image: PathBuf,

    /// What it should be
    #[arg(value_name = "REFERENCE")]
    reference: PathBuf,

    /// Print one JSON object
    #[arg(long)]
    json: bool,

    /// Directory for error.png (relative error per pixel), flip.png (how visible it is) and
    /// compare.json; made if there is none
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
}

/// The files that are written.
const FILES: [&str; 3] = ["error.png", "flip.png", "compare.json"];

/// Errors from this share of pixels on rest on single paths: then tests are not to be trusted.
const MANY_SINGLE: f64 = 0.05;

/// Seconds of work left from which on a log is told of it.
const WORTH_TELLING: f64 = 2.0;

/// What was found.
struct Comparison {
    errors: ImageError,
    flip: Flip,
    bias: Result<BiasTest, String>,
    /// What the user should know about the test.
    notes: Vec<String>,
}

/// Reads, compares, writes and prints.
pub fn run(args: &Args) -> miette::Result<Outcome> {
    let image = read(&args.image)?;
    let reference = read(&args.reference)?;
    let size = |image: &Image| format!("{} x {} pixels", image.width, image.height);
    let [a, b] = [&image.image, &reference.image];
    if [a.width, a.height] != [b.width, b.height] {
        bail!(
            "{} has {}, {} has {}: images of one size are needed",
            args.image.display(),
            size(a),
            args.reference.display(),
            size(b)
        );
    }
    if let Some(directory) = &args.output {
        prepare(directory)?;
    }
    interrupt::listen()?;
    let Some(comparison) = compare(&image, &reference) else {
        tell("interrupted: nothing is written");
        return Ok(Outcome::Interrupted);
    };
    let report = comparison.json(args, &image.image);
    if let Some(directory) = &args.output {
        comparison.write(directory, a, b, &report)?;
    }
    if args.json {
        say(format_args!("{report:#}"));
    } else {
        say(comparison.text(args));
    }
    Ok(Outcome::Done)
}

/// An image whose pixels are all numbers.
fn read(path: &Path) -> miette::Result<AnnotatedImage> {
    let annotated = read_annotated(path, Decode::Srgb)
        .map_err(|error| miette!("{}: {error}", path.display()))?;
    check_finite(path, "", annotated.image.width, &annotated.image.pixels)?;
    for (name, pixels) in &annotated.layers {
        check_finite(path, &format!("{name}."), annotated.image.width, pixels)?;
    }
    Ok(annotated)
}

fn check_finite(
    path: &Path,
    prefix: &str,
    width: usize,
    pixels: &[[f32; 3]],
) -> miette::Result<()> {
    let is_finite = |pixel: &[f32; 3]| pixel.iter().all(|v| v.is_finite());
    let Some(i) = pixels.iter().position(|pixel| !is_finite(pixel)) else {
        return Ok(());
    };
    let channel = pixels[i].iter().position(|v| !v.is_finite()).unwrap_or(0);
    let count = pixels.iter().filter(|pixel| !is_finite(pixel)).count();
    let more = match count {
        1 => String::new(),
        n => format!(", and so are {} more pixels", n - 1),
    };
    bail!(
        "{}: channel {prefix}{} of the pixel in column {}, row {} (from 0, at the top left) is {}{more}: \
         only numbers can be compared",
        path.display(),
        ["R", "G", "B"][channel],
        i % width,
        i / width,
        pixels[i][channel]
    )
}

/// Makes the directory and checks that all files can be written.
fn prepare(directory: &Path) -> miette::Result<()> {
    super::output::make_directory(directory)?;
    for name in FILES {
        check_writable(&directory.join(name)).into_diagnostic()?;
    }
    Ok(())
}

/// `None` if the user interrupted.
fn compare(image: &AnnotatedImage, reference: &AnnotatedImage) -> Option<Comparison> {
    let progress = Progress::new(false, stderr().is_terminal());
    progress.phase("FLIP");
    let start = std::time::Instant::now();
    let flip = flip(&image.image, &reference.image, &|done| {
        let left = start.elapsed().as_secs_f64() * (1.0 / done - 1.0);
        progress.progress(
            done,
            (left.is_finite() && left > WORTH_TELLING).then_some(left),
        );
        !progress.interrupted()
    });
    progress.finish();
    Some(Comparison {
        errors: image_errors(&image.image.pixels, &reference.image.pixels),
        flip: flip?,
        bias: bias_test(image, reference),
        notes: notes(image, reference),
    })
}

/// The test for bias, or why there is none.
fn bias_test(image: &AnnotatedImage, reference: &AnnotatedImage) -> Result<BiasTest, String> {
    let [Some(a), Some(b)] = [image, reference].map(|image| estimate(image)) else {
        let without = match [image, reference].map(|image| estimate(image).is_some()) {
            [false, true] => "the image has no",
            [true, false] => "the reference has no",
            _ => "neither image has",
        };
        return Err(format!(
            "{without} standard errors: render with --error to have bias tested"
        ));
    };
    Ok(test_bias(&a, &b, image.image.width))
}

/// The image with its standard errors, if it has them. Only a path tracer's pixels have samples of
/// their own alone.
fn estimate(image: &AnnotatedImage) -> Option<Estimate<'_>> {
    let parts = image.number("metrolight.error.independent_parts");
    Some(Estimate {
        pixels: &image.image.pixels,
        standard_errors: image.layers.get("standard_error")?,
        parts: parts.filter(|&n| n >= 2.0).map(|n| n as u64),
        independent_pixels: image.text("metrolight.integrator") == Some("path"),
    })
}

fn notes(image: &AnnotatedImage, reference: &AnnotatedImage) -> Vec<String> {
    let mut notes = Vec::new();
    let images = [("the image", image), ("the reference", reference)];
    for (name, image) in images {
        let Some(estimate) = estimate(image) else {
            return notes;
        };
        if estimate.parts.is_none() {
            notes.push(format!(
                "{name} does not say how many independent parts its standard errors come from: they \
                 are taken as exact"
            ));
        }
        let single = image.number("metrolight.error.pixels_resting_on_one_part");
        if let Some(single) = single.filter(|&share| share > MANY_SINGLE) {
            notes.push(format!(
                "in {:.0}% of the pixels of {name} nearly all variance comes from one part of the \
                 samples: its errors are probably larger than it says, and the test sees bias where \
                 there may be none",
                100.0 * single
            ));
        }
    }
    let seeds = images.map(|(_, image)| image.number("metrolight.seed"));
    if seeds[0].is_some() && seeds[0] == seeds[1] {
        notes.push(
            "both images come from one seed and may share random numbers: the test then finds less"
                .into(),
        );
    }
    notes
}

impl Comparison {
    /// What the user wants to know, in one line.
    fn verdict(&self, args: &Args) -> String {
        let brightness = match self.errors.mean_ratio {
            _ if self.errors.mse == 0.0 => "identical".into(),
            None => "the reference is black".into(),
            Some(ratio) if (ratio - 1.0).abs() < 5e-5 => "equally bright".into(),
            Some(ratio) if ratio > 1.0 => format!("{} brighter", percent(ratio - 1.0)),
            Some(ratio) => format!("{} darker", percent(1.0 - ratio)),
        };
        let bias = match &self.bias {
            Err(_) => "bias not tested",
            Ok(test) => match test.verdict {
                BiasVerdict::Differs => "BIASED: one of them, at least",
                BiasVerdict::Unclear => "bias unclear",
                BiasVerdict::NoneFound => "no bias found",
            },
        };
        format!(
            "{} against {}: relMSE {:.3e}, {brightness}; {bias}",
            args.image.display(),
            args.reference.display(),
            self.errors.relative_mse,
        )
    }

    fn text(&self, args: &Args) -> String {
        let e = &self.errors;
        let pixels = self.flip.errors.len();
        let mut rows = vec![
            ("MSE", format!("{:.4e}", e.mse)),
            ("RMSE", format!("{:.4e}", e.rmse)),
            ("relMSE", format!("{:.4e}", e.relative_mse)),
            (
                "relMSE, trimmed",
                format!(
                    "{:.4e}  without the worst {} of {} pixels",
                    e.relative_mse_trimmed, e.trimmed_pixels, pixels
                ),
            ),
            ("MAPE", percent(e.mape)),
            ("SMAPE", percent(e.smape)),
            (
                "mean ratio",
                e.mean_ratio
                    .map_or("none: the reference is black".into(), |r| format!("{r:.6}")),
            ),
            (
                "FLIP",
                format!(
                    "{:.4}  HDR, {}, {} pixels per degree",
                    self.flip.mean,
                    exposures_text(&self.flip),
                    self.flip.pixels_per_degree,
                ),
            ),
            ("bias", self.bias_text()),
        ];
        rows.extend(self.notes.iter().map(|note| ("note", note.clone())));
        if let Some(directory) = &args.output {
            let files = FILES.map(|name| directory.join(name).display().to_string());
            rows.push(("wrote", files.join(", ")));
        }
        let rows = rows
            .iter()
            .map(|(name, value)| format!("  {name:<16} {value}"));
        let lines: Vec<String> = [self.verdict(args)].into_iter().chain(rows).collect();
        lines.join("\n")
    }

    fn bias_text(&self) -> String {
        let test = match &self.bias {
            Err(reason) => return format!("not tested: {reason}"),
            Ok(test) => test,
        };
        let side = bias::TILE;
        let [columns, rows] = &test.worst_tile;
        let place = format!(
            "worst in columns {}-{}, rows {}-{}",
            columns.start,
            columns.end - 1,
            rows.start,
            rows.end - 1
        );
        let power = match test.smallest_detectable {
            Some(size) if size > 0.0 => format!(
                "; a difference of {} of the mean in a tile would be found",
                percent(size)
            ),
            _ => String::new(),
        };
        let all = format!("{} tiles of {side} x {side} pixels", test.tiles);
        match test.verdict {
            BiasVerdict::Differs => format!(
                "{} of {all} differ by more than their errors allow (p = {:.1e}, level {}); {place}",
                test.differing_tiles,
                test.smallest_p,
                bias::LEVEL
            ),
            BiasVerdict::Unclear => format!(
                "{all}: some differ by more than independent pixels would (p = {:.1e}), but pixels of \
                 one tile may err alike (p = {:.2}); {place}{power}. Render for longer",
                test.smallest_p_if_independent, test.smallest_p
            ),
            BiasVerdict::NoneFound if test.smallest_p == test.smallest_p_if_independent => {
                format!("none in {all} (p = {:.2}){power}", test.smallest_p)
            }
            BiasVerdict::NoneFound => format!(
                "none in {all} (p = {:.2} if pixels are independent, {:.2} if not){power}",
                test.smallest_p_if_independent, test.smallest_p
            ),
        }
    }

    fn json(&self, args: &Args, image: &Image) -> serde_json::Value {
        json!({
            "version": env!("CARGO_PKG_VERSION"),
            "image": args.image,
            "reference": args.reference,
            "size": [image.width, image.height],
            "verdict": self.verdict(args),
            "errors": self.errors,
            "flip": {
                "mean": self.flip.mean,
                "pixels_per_degree": self.flip.pixels_per_degree,
                "exposures": self.flip.count,
                "start_exposure": self.flip.exposures[0],
                "stop_exposure": self.flip.exposures[1],
            },
            "bias": self.bias.as_ref().ok(),
            "bias_not_tested": self.bias.as_ref().err(),
            "notes": self.notes,
        })
    }

    fn write(
        &self,
        directory: &Path,
        image: &Image,
        reference: &Image,
        report: &serde_json::Value,
    ) -> miette::Result<()> {
        let flip: Vec<f64> = self.flip.errors.iter().map(|&e| e.into()).collect();
        let flip_marks = [0.0, 0.25, 0.5, 0.75, 1.0].map(|v| (v, format!("{v}")));
        let flip_lines = [
            "How visible the error of each pixel is",
            "FLIP for high dynamic range, from 0 to 1",
        ];
        let relative = relative_square_errors(&image.pixels, &reference.pixels);
        let relative: Vec<f64> = relative.into_iter().map(on_scale).collect();
        let marks = SCALE.map(|(error, label)| (on_scale(error * error), label.into()));
        let lines = [
            "Relative error of each pixel",
            "|x - r| / sqrt(r^2 + 0.01 m^2), r the reference and m its mean; RMS of the channels",
        ];
        let maps: [(&str, [&str; 2], &[f64], &[(f64, String)]); 2] = [
            (FILES[0], lines, &relative, &marks),
            (FILES[1], flip_lines, &flip, &flip_marks),
        ];
        for (name, lines, values, marks) in maps {
            let picture = Picture::in_false_colors(image.width, values);
            let svg = draw_with_scale(&lines, &picture, marks).into_diagnostic()?;
            let png = rasterize(&svg, 1.0).into_diagnostic()?;
            write(&directory.join(name), &png).into_diagnostic()?;
        }
        let json = format!("{report:#}\n");
        write(&directory.join(FILES[2]), json.as_bytes()).into_diagnostic()
    }
}

fn exposures_text(flip: &Flip) -> String {
    let [start, stop] = flip.exposures;
    match flip.count {
        1 => format!("exposure {start:+.1} stops"),
        n => format!("{n} exposures from {start:+.1} to {stop:+.1} stops"),
    }
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    replace_file(path, |writer| writer.write_all(bytes))
}

/// Relative errors that are labelled on the scale of colours; the first is black and all below it, the
/// last the brightest and all above it.
const SCALE: [(f64, &str); 4] = [(0.001, "0.1%"), (0.01, "1%"), (0.1, "10%"), (1.0, "100%")];

/// The place of a squared relative error on the logarithmic scale, from 0 to 1.
fn on_scale(squared: f64) -> f64 {
    let [(low, _), .., (high, _)] = SCALE;
    ((0.5 * squared.log10() - f64::log10(low)) / f64::log10(high / low)).clamp(0.0, 1.0)
}

/// `12.3%`, with three digits.
fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    let decimals = match percent.abs() {
        p if p >= 100.0 => 0,
        p if p >= 10.0 => 1,
        p if p >= 1.0 => 2,
        p if p >= 0.1 => 3,
        _ => 4,
    };
    format!("{percent:.decimals$}%")
}

#[cfg(test)]
mod tests {
    use super::{on_scale, percent};

    #[test]
    fn numbers_are_short_and_colours_keep_to_the_scale() {
        for (share, expected) in [(0.0, "0.0000%"), (0.0123, "1.23%"), (12.0, "1200%")] {
            assert_eq!(percent(share), expected);
        }
        let close = |squared: f64, place: f64| (on_scale(squared) - place).abs() < 1e-9;
        assert!(close(1e-6, 0.0) && close(1e-3, 0.5) && close(1.0, 1.0));
        assert!(close(0.0, 0.0) && close(1e9, 1.0));
    }
}
