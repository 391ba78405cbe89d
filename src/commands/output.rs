//! The files that a render writes.

use std::borrow::Cow;
use std::ffi::OsStr;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::Write;
use std::path::{Path, PathBuf};

use metrolight::film::{
    AttributeValue, Crop, ExrLayer, StagedFile, replace_file, stage_exr, stage_png,
};
use metrolight::render::{Budget, Rendering};
use miette::{IntoDiagnostic, miette};
use serde_json::{Value, json};

use super::files::{Content, OutputFiles};
use super::rescue::rescue;

/// Paths of the output files.
#[derive(Clone)]
pub struct Outputs {
    pub exr: PathBuf,
    pub png: PathBuf,
    pub stats: Option<PathBuf>,
    /// The part of the image that is written; `None` for all of it.
    pub crop: Option<Crop>,
}

impl Outputs {
    /// The image at `exr`, and a preview with the same stem.
    pub fn new(exr: PathBuf, stats: Option<PathBuf>) -> Self {
        Self {
            png: exr.with_extension("png"),
            exr,
            stats,
            crop: None,
        }
    }

    /// The files, of which the image has `layers` layers.
    pub fn files(&self, layers: u64) -> OutputFiles {
        let mut files = OutputFiles::default();
        files.add(&self.exr, Content::Linear { layers }, "-o");
        files.add(&self.png, Content::Preview, "-o");
        if let Some(stats) = &self.stats {
            files.add(stats, Content::Text, "--stats");
        }
        files
    }

    /// Writes all files: the image with its standard errors as a layer and `report` as attributes, the
    /// preview, and `report`. They replace older files only when all of them are complete. All have the
    /// same identifier in them, which tells if later one of them is replaced.
    pub fn write(&self, rendering: &Rendering, report: &Value) -> miette::Result<()> {
        let mut report = report.clone();
        report[RENDER] = json!(identifier(rendering, &report));
        report["files"] = json!({
            "image": self.exr.to_string_lossy(),
            "preview": self.png.to_string_lossy(),
            "statistics": self.stats.as_ref().map(|path| path.to_string_lossy()),
        });
        let staged = self.stage(rendering, &report)?;
        let mut staged = staged.into_iter();
        staged.try_for_each(StagedFile::commit).into_diagnostic()
    }

    fn stage(&self, rendering: &Rendering, report: &Value) -> miette::Result<Vec<StagedFile>> {
        let whole = &rendering.image;
        let image = match &self.crop {
            Some(crop) => Cow::Owned(whole.part(crop)),
            None => Cow::Borrowed(whole),
        };
        let errors = rendering.error.as_ref().map(|error| match &self.crop {
            Some(crop) => Cow::Owned(crop.of(whole.width, &error.standard_errors)),
            None => Cow::Borrowed(&*error.standard_errors),
        });
        let layers: Vec<ExrLayer> = errors
            .iter()
            .map(|errors| (STANDARD_ERROR, &**errors))
            .collect();
        let identifier = report[RENDER].as_str().unwrap_or_default();
        let texts = [(ATTRIBUTE, identifier)];
        let mut staged = vec![
            stage_exr(&self.exr, &image, &layers, &attributes(report)).into_diagnostic()?,
            stage_png(&self.png, &image, &texts).into_diagnostic()?,
        ];
        if let Some(stats) = &self.stats {
            let text = json_text(report);
            let write = StagedFile::write(stats, |writer| writer.write_all(text.as_bytes()));
            staged.push(write.into_diagnostic()?);
        }
        Ok(staged)
    }

    /// As [`Self::write`]; if that fails, writes the files elsewhere, and the error says where.
    pub fn write_or_rescue(&self, rendering: &Rendering, report: &Value) -> miette::Result<()> {
        self.write(rendering, report).map_err(|error| {
            let directory = self.exr.parent().unwrap_or(Path::new(""));
            let stem = self.exr.file_stem().unwrap_or_default().to_string_lossy();
            rescue(directory, &stem, &error, |directory| {
                let moved =
                    |path: &PathBuf| directory.join(path.file_name().unwrap_or(OsStr::new("_")));
                let moved = Self {
                    exr: moved(&self.exr),
                    png: moved(&self.png),
                    stats: self.stats.as_ref().map(moved),
                    crop: self.crop,
                };
                moved.write(rendering, report)
            })
        })
    }
}

/// The layer of standard errors in an image that was rendered with `--error`.
pub const STANDARD_ERROR: &str = "standard_error";

/// The key of the identifier of a render in its statistics.
pub const RENDER: &str = "render";

/// The attribute and the keyword of the identifier in images.
pub const ATTRIBUTE: &str = "metrolight.render";

/// An identifier of the results of a render: a hash of its image and its statistics, in 16 digits.
fn identifier(rendering: &Rendering, report: &Value) -> String {
    let mut hasher = DefaultHasher::new();
    for value in rendering.image.pixels.as_flattened() {
        value.to_bits().hash(&mut hasher);
    }
    report.to_string().hash(&mut hasher);
    format!("{:016x}", hasher.finish())
}

/// Writes a whole file, or leaves the existing one unchanged.
pub fn write_bytes(path: &Path, bytes: &[u8]) -> miette::Result<()> {
    replace_file(path, |writer| writer.write_all(bytes)).into_diagnostic()
}

/// Writes a text file.
pub fn write_text(path: &Path, text: &str) -> miette::Result<()> {
    write_bytes(path, text.as_bytes())
}

/// Writes an indented JSON file.
pub fn write_json(path: &Path, value: &Value) -> miette::Result<()> {
    write_text(path, &json_text(value))
}

fn json_text(value: &Value) -> String {
    format!("{value:#}\n")
}

/// Makes a directory and its parents, if they do not exist.
pub fn make_directory(path: &Path) -> miette::Result<()> {
    std::fs::create_dir_all(path).map_err(|error| {
        let cause = match path.exists() && !path.is_dir() {
            true => "it is a file; give the name of a directory".into(),
            false => error.to_string(),
        };
        miette!("cannot make the directory {}: {cause}", path.display())
    })
}

/// A budget in reports.
pub fn budget_json(budget: Budget) -> Value {
    match budget {
        Budget::SamplesPerPixel(n) => json!({ "samples_per_pixel": n }),
        Budget::Seconds(seconds) => json!({ "seconds": seconds }),
        Budget::Samples(n) => json!({ "samples": n }),
        Budget::Unlimited => json!("unlimited"),
    }
}

/// All integers up to 2^53 are exact in a double.
const MAX_EXACT: u64 = 1 << 53;

/// `report` as attributes of an image, with names that begin with `metrolight.`.
pub fn attributes(report: &Value) -> Vec<(String, AttributeValue)> {
    let mut attributes = Vec::new();
    flatten("metrolight", report, &mut attributes);
    attributes
}

/// Appends attributes `prefix.key`, `prefix.key.key`, `prefix.0`, ... of a JSON value. Null has none.
fn flatten(prefix: &str, value: &Value, attributes: &mut Vec<(String, AttributeValue)>) {
    let scalar = match value {
        Value::Null => return,
        Value::Bool(bool) => AttributeValue::Text(bool.to_string()),
        Value::String(text) => AttributeValue::Text(text.clone()),
        // A number that is not exact in a double, such as a large seed, is stored as text.
        Value::Number(number) => match number.as_f64() {
            Some(double) if number.as_u64().is_none_or(|n| n <= MAX_EXACT) => {
                AttributeValue::Number(double)
            }
            _ => AttributeValue::Text(number.to_string()),
        },
        Value::Array(values) => {
            for (i, value) in values.iter().enumerate() {
                flatten(&format!("{prefix}.{i}"), value, attributes);
            }
            return;
        }
        Value::Object(fields) => {
            for (key, value) in fields {
                flatten(&format!("{prefix}.{key}"), value, attributes);
            }
            return;
        }
    };
    attributes.push((prefix.into(), scalar));
}
