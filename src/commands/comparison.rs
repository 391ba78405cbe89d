//! Results of `metrolight compare`: as text, as JSON, and as images of the errors.

use std::path::Path;

use metrolight::film::Image;
use metrolight::metrics::Flip;
use metrolight::metrics::{BiasTest, BiasVerdict, ImageError, bias, relative_square_errors};
use metrolight::plot::{Picture, PlotError, draw_with_scale, rasterize};
use miette::IntoDiagnostic;
use serde_json::json;

use super::files::Content;
use super::output::{write_bytes, write_json};

/// The files that are written.
pub const FILES: [(&str, Content); 3] = [
    ("error.png", Content::Preview),
    ("flip.png", Content::Preview),
    ("compare.json", Content::Text),
];

/// Errors of an image against a reference.
pub struct Comparison<'a> {
    /// Paths of the image and of the reference.
    pub names: [&'a Path; 2],
    pub errors: ImageError,
    pub flip: Flip,
    /// The test for bias, or the reason why there is none.
    pub bias: Result<BiasTest, String>,
    /// What limits the comparison.
    pub notes: Vec<String>,
}

impl Comparison<'_> {
    /// The result in one line.
    fn verdict(&self) -> String {
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
                BiasVerdict::Differs => "BIASED: at least one of them",
                BiasVerdict::Unclear => "bias unclear",
                BiasVerdict::NoneFound => "no bias found",
            },
        };
        format!(
            "{} against {}: relMSE {:.3e}, {brightness}; {bias}",
            self.names[0].display(),
            self.names[1].display(),
            self.errors.relative_mse,
        )
    }

    /// The verdict in one line, and a table.
    pub fn text(&self, written: Option<&Path>) -> String {
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
        if let Some(directory) = written {
            let files = FILES.map(|(name, _)| directory.join(name).display().to_string());
            rows.push(("wrote", files.join(", ")));
        }
        let rows = rows
            .iter()
            .map(|(name, value)| format!("  {name:<16} {value}"));
        let lines: Vec<String> = [self.verdict()].into_iter().chain(rows).collect();
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
                "; a difference of {} of the mean of a tile would be detected",
                percent(size)
            ),
            _ => String::new(),
        };
        let all = format!("{} tiles of {side} x {side} pixels", test.tiles);
        match test.verdict {
            BiasVerdict::Differs => format!(
                "{} of {all} differ significantly (p = {:.1e}, level {}); {place}",
                test.differing_tiles,
                test.smallest_p,
                bias::LEVEL
            ),
            BiasVerdict::Unclear => format!(
                "{all}: some differ significantly if pixels are independent (p = {:.1e}), but errors of \
                 neighbouring pixels may be correlated (p = {:.2}); {place}{power}. Render for longer",
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

    /// All results.
    pub fn json(&self, image: &Image) -> serde_json::Value {
        json!({
            "version": env!("CARGO_PKG_VERSION"),
            "image": self.names[0].to_string_lossy(),
            "reference": self.names[1].to_string_lossy(),
            "size": [image.width, image.height],
            "verdict": self.verdict(),
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

    /// Writes the images of the errors, and `report`.
    pub fn write(
        &self,
        directory: &Path,
        image: &Image,
        reference: &Image,
        report: &serde_json::Value,
    ) -> miette::Result<()> {
        let flip = self.flip_map(image.width).into_diagnostic()?;
        let maps = [
            (FILES[0].0, relative_map(image, reference)?),
            (FILES[1].0, rasterize(&flip, 1.0).into_diagnostic()?),
        ];
        for (name, png) in maps {
            write_bytes(&directory.join(name), &png)?;
        }
        write_json(&directory.join(FILES[2].0), report)
    }

    fn flip_map(&self, width: usize) -> Result<String, PlotError> {
        let lines = [
            "Visibility of the error of each pixel",
            "FLIP for high dynamic range, from 0 to 1",
        ];
        let errors: Vec<f64> = self.flip.errors.iter().map(|&e| e.into()).collect();
        let marks = [0.0, 0.25, 0.5, 0.75, 1.0].map(|v| (v, format!("{v}")));
        draw_with_scale(&lines, &Picture::in_false_colors(width, &errors), &marks)
    }
}

/// A PNG file of the relative error of each pixel in false colours, with a scale.
pub fn relative_map(image: &Image, reference: &Image) -> miette::Result<Vec<u8>> {
    let lines = [
        "Relative error of each pixel",
        "|x - r| / sqrt(r^2 + 0.01 m^2), r the reference and m its mean; RMS of the channels",
    ];
    let errors = relative_square_errors(&image.pixels, &reference.pixels);
    let errors: Vec<f64> = errors.into_iter().map(on_scale).collect();
    let marks = SCALE.map(|(error, label)| (on_scale(error * error), label.into()));
    let picture = Picture::in_false_colors(image.width, &errors);
    let svg = draw_with_scale(&lines, &picture, &marks).into_diagnostic()?;
    rasterize(&svg, 1.0).into_diagnostic()
}

fn exposures_text(flip: &Flip) -> String {
    let [start, stop] = flip.exposures;
    match flip.count {
        1 => format!("exposure {start:+.1} stops"),
        n => format!("{n} exposures from {start:+.1} to {stop:+.1} stops"),
    }
}

/// Relative errors that are labelled on the colour scale. The first and all below it are black, the
/// last and all above it have the brightest colour.
pub const SCALE: [(f64, &str); 4] = [(0.001, "0.1%"), (0.01, "1%"), (0.1, "10%"), (1.0, "100%")];

/// Position of a squared relative error on the logarithmic scale, from 0 to 1.
fn on_scale(squared: f64) -> f64 {
    let [(low, _), .., (high, _)] = SCALE;
    ((0.5 * squared.log10() - f64::log10(low)) / f64::log10(high / low)).clamp(0.0, 1.0)
}

/// A percentage with three digits: `12.3%`.
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
    fn percentages_have_three_digits_and_colours_are_clamped_to_the_scale() {
        for (share, expected) in [(0.0, "0.0000%"), (0.0123, "1.23%"), (12.0, "1200%")] {
            assert_eq!(percent(share), expected);
        }
        let close = |squared: f64, place: f64| (on_scale(squared) - place).abs() < 1e-9;
        assert!(close(1e-6, 0.0) && close(1e-3, 0.5) && close(1.0, 1.0));
        assert!(close(0.0, 0.0) && close(1e9, 1.0));
    }
}
