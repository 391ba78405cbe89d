//! The files of an experiment: tables, charts and images.

use std::path::{Path, PathBuf};

use metrolight::convergence::{
    Cost, Curve, Measure, Outcome, Variant, comparison, convergence_chart,
};
use metrolight::film::{Image, write_exr, write_png};
use metrolight::plot::rasterize;
use miette::IntoDiagnostic;
use serde_json::{Value, json};

use super::reference::Reference;
use crate::commands::comparison::relative_map;
use crate::commands::files::{Content, OutputFiles};
use crate::commands::numbers::digits;
use crate::commands::output;
use crate::commands::rescue::rescue;

const CSV: &str = "convergence.csv";
const SVG: &str = "convergence.svg";
const PNG: &str = "convergence.png";
const JSON: &str = "convergence.json";

/// The option that names the directory.
const OPTION: &str = "-o";

/// Pixels of the PNG chart per unit of the SVG.
const PNG_SCALE: f32 = 1.5;

/// Results of an experiment, and its settings.
pub struct Results<'a> {
    /// Title of the chart.
    pub scene_name: &'a str,
    /// Settings of the command.
    pub settings: Value,
    pub reference: &'a Reference,
    pub variants: &'a [Variant],
    /// One for each variant.
    pub curves: &'a [Curve],
    pub outcome: &'a Outcome,
    /// Sentences for the user.
    pub warnings: &'a [String],
}

/// The directory and file names of one experiment.
pub struct Files {
    directory: PathBuf,
    /// File names of the variants, without extension.
    stems: Vec<String>,
}

impl Files {
    /// Makes `directory` if it does not exist.
    pub fn new(directory: &Path, variants: &[Variant]) -> miette::Result<Self> {
        output::make_directory(directory)?;
        Ok(Self {
            directory: directory.into(),
            stems: variants
                .iter()
                .map(|v| v.label.replace([' ', '='], "-"))
                .collect(),
        })
    }

    /// All files that are written, among them the reference if it is rendered.
    pub fn outputs(&self, renders_reference: bool) -> OutputFiles {
        let mut outputs = OutputFiles::default();
        for name in [CSV, SVG, PNG, JSON] {
            outputs.add(self.path(name), Content::Text, OPTION);
        }
        for stem in &self.stems {
            let [exr, png, error] = self.images(stem);
            outputs.add(exr, Content::Linear { layers: 1 }, OPTION);
            outputs.add(png, Content::Preview, OPTION);
            outputs.add(error, Content::Preview, OPTION);
        }
        if renders_reference {
            let reference = self.reference();
            let preview = reference.with_extension("png");
            outputs.add(reference, Content::Linear { layers: 2 }, OPTION);
            outputs.add(preview, Content::Preview, OPTION);
        }
        outputs
    }

    /// Paths of a variant's image, of its preview, and of the image of its error.
    fn images(&self, stem: &str) -> [PathBuf; 3] {
        [".exr", ".png", "-error.png"].map(|end| self.path(&format!("{stem}{end}")))
    }

    fn path(&self, name: &str) -> PathBuf {
        self.directory.join(name)
    }

    /// Path of a reference that is rendered for the experiment.
    pub fn reference(&self) -> PathBuf {
        self.path("reference.exr")
    }

    /// A line about the files that were written.
    pub fn wrote(&self) -> String {
        format!(
            "wrote convergence.svg, .png, .csv, .json and images to {}",
            self.directory.display()
        )
    }

    /// Writes everything; if that fails, writes it elsewhere, and the error says where.
    pub fn write_or_rescue(&self, results: &Results) -> miette::Result<()> {
        self.write(results).map_err(|error| {
            rescue(&self.directory, "converge", &error, |directory| {
                let elsewhere = Self {
                    directory: directory.into(),
                    stems: self.stems.clone(),
                };
                elsewhere.write(results)
            })
        })
    }

    /// Writes everything.
    fn write(&self, results: &Results) -> miette::Result<()> {
        let Results {
            reference,
            variants,
            curves,
            outcome,
            ..
        } = results;
        let table = csv_table(variants, &reference.image, outcome).into_diagnostic()?;
        output::write_bytes(&self.path(CSV), &table)?;
        let svg = convergence_chart(results.scene_name, variants, curves, reference.relative_mse)
            .into_diagnostic()?;
        output::write_text(&self.path(SVG), &svg)?;
        let png = rasterize(&svg, PNG_SCALE).into_diagnostic()?;
        output::write_bytes(&self.path(PNG), &png)?;
        for (stem, image) in self.stems.iter().zip(&outcome.images) {
            self.write_images(stem, image, &reference.image)?;
        }
        output::write_json(&self.path(JSON), &self.summary_json(results))
    }

    fn write_images(&self, stem: &str, image: &Image, reference: &Image) -> miette::Result<()> {
        let [exr, png, error] = self.images(stem);
        write_exr(&exr, image, &[], &[]).into_diagnostic()?;
        write_png(&png, image).into_diagnostic()?;
        output::write_bytes(&error, &relative_map(image, reference)?)
    }

    fn summary_json(&self, results: &Results) -> Value {
        let (variants, curves) = (results.variants, results.curves);
        let of = |(i, variant): (usize, &Variant)| {
            let comparison = |cost, measure| comparison(variants, curves, i, cost, measure);
            json!({
                "label": variant.label,
                "integrator": variant.settings.method(),
                "image": self.stems[i],
                "slope": curves[i].slope(Cost::Seconds, Measure::Whole),
                "comparison": comparison(Cost::Seconds, Measure::Whole),
                "comparison_trimmed": comparison(Cost::Seconds, Measure::Trimmed),
                "comparison_by_rays": comparison(Cost::Rays, Measure::Whole),
                "points": curves[i].points,
            })
        };
        let reference = results.reference;
        json!({
            "settings": results.settings,
            "reference": {
                "description": reference.description,
                "relative_mse": reference.relative_mse,
            },
            "variants": variants.iter().enumerate().map(of).collect::<Vec<_>>(),
            "interrupted": results.outcome.interrupted,
            "warnings": results.warnings,
        })
    }
}

const COLUMNS: [&str; 15] = [
    "label",
    "integrator",
    "repeat",
    "seed",
    "checkpoint",
    "seconds",
    "samples_per_pixel",
    "rays",
    "mse",
    "rmse",
    "relmse",
    "relmse_trimmed",
    "mape",
    "smape",
    "mean_ratio",
];

/// A row of names, and one row for each measurement.
fn csv_table(variants: &[Variant], reference: &Image, outcome: &Outcome) -> csv::Result<Vec<u8>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(COLUMNS)?;
    for m in &outcome.measurements {
        let Variant {
            label, settings, ..
        } = &variants[m.variant];
        let (progress, error) = (&m.progress, &m.error);
        let numbers = [
            progress.seconds,
            progress.samples as f64 / reference.pixels.len() as f64,
            progress.rays as f64,
            error.mse,
            error.rmse,
            error.relative_mse,
            error.relative_mse_trimmed,
            error.mape,
            error.smape,
        ];
        let texts = [
            label.clone(),
            settings.method().name().into(),
            m.repeat.to_string(),
            settings.seed.wrapping_add(m.repeat).to_string(),
            m.index.to_string(),
        ];
        let ratio = error.mean_ratio.map_or_else(String::new, |r| r.to_string());
        let numbers = numbers.map(|x| x.to_string());
        writer.write_record(texts.into_iter().chain(numbers).chain([ratio]))?;
    }
    writer
        .into_inner()
        .map_err(|error| error.into_error().into())
}

/// A line for each variant: its final error, and the time to reach the error of the baseline.
pub fn summary(variants: &[Variant], curves: &[Curve]) -> String {
    let width = variants.iter().map(|v| v.label.len()).max().unwrap_or(0);
    let line = |(i, variant): (usize, &Variant)| {
        let end = curves[i].end()?;
        let said = comparison(variants, curves, i, Cost::Seconds, Measure::Whole);
        let said = said.map_or_else(String::new, |said| format!("; {said}"));
        Some(format!(
            "{:width$}  relMSE {} ({} to {}), without the worst 0.1% {}, after {:.1} s{said}",
            variant.label,
            digits(end.relative_mse),
            digits(end.spread[0]),
            digits(end.spread[1]),
            digits(end.relative_mse_trimmed),
            end.seconds,
        ))
    };
    let lines: Vec<String> = variants.iter().enumerate().filter_map(line).collect();
    lines.join("\n")
}
