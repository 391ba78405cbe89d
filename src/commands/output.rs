//! The files that a render writes.

use std::borrow::Cow;
use std::io::Write;
use std::path::{Path, PathBuf};

use metrolight::film::{
    AttributeValue, Crop, ExrLayer, check_writable, replace_file, write_exr, write_png,
};
use metrolight::render::{Budget, Rendering};
use miette::{IntoDiagnostic, bail, miette};
use serde_json::{Value, json};

/// Paths of the output files.
pub struct Outputs {
    pub exr: PathBuf,
    pub png: PathBuf,
    pub stats: Option<PathBuf>,
}

impl Outputs {
    /// The image at `exr`, or in the current directory under the scene's name, and a preview with the
    /// same stem. Fails before rendering if one of the files could not be written.
    pub fn prepare(
        exr: Option<PathBuf>,
        scene_name: &str,
        stats: Option<PathBuf>,
    ) -> miette::Result<Self> {
        let exr = exr.unwrap_or_else(|| format!("{scene_name}.exr").into());
        let outputs = Self {
            png: exr.with_extension("png"),
            exr,
            stats,
        };
        let images = [&outputs.exr, &outputs.png];
        if let Some(stats) = &outputs.stats
            && images.contains(&stats)
        {
            bail!(
                "--stats {} is also the name of an image that this render writes: choose another",
                stats.display()
            );
        }
        for path in images.into_iter().chain(&outputs.stats) {
            check_writable(path).into_diagnostic()?;
        }
        Ok(outputs)
    }

    /// Writes all files.
    pub fn write(
        &self,
        rendering: &Rendering,
        crop: Option<&Crop>,
        report: &Value,
    ) -> miette::Result<()> {
        write_rendering(&self.exr, rendering, crop, report)?;
        if let Some(path) = &self.stats {
            write_json(path, report)?;
        }
        Ok(())
    }
}

/// The layer of standard errors in an image that was rendered with `--error`.
pub const STANDARD_ERROR: &str = "standard_error";

/// Writes the part `crop` of the image to `exr`, with its standard errors as a layer and `report` as attributes, and the
/// preview with the same stem.
pub fn write_rendering(
    exr: &Path,
    rendering: &Rendering,
    crop: Option<&Crop>,
    report: &Value,
) -> miette::Result<()> {
    let whole = &rendering.image;
    let image = match crop {
        Some(crop) => Cow::Owned(whole.part(crop)),
        None => Cow::Borrowed(whole),
    };
    let errors = rendering.error.as_ref().map(|error| match crop {
        Some(crop) => Cow::Owned(crop.of(whole.width, &error.standard_errors)),
        None => Cow::Borrowed(&*error.standard_errors),
    });
    let layers: Vec<ExrLayer> = errors
        .iter()
        .map(|errors| (STANDARD_ERROR, &**errors))
        .collect();
    write_exr(exr, &image, &layers, &attributes(report)).into_diagnostic()?;
    write_png(&exr.with_extension("png"), &image).into_diagnostic()
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
    write_text(path, &format!("{value:#}\n"))
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
