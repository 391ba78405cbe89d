//! The sections of a report, each made of the files of one command.

use serde_json::{Map, Value};

use super::folder::{Figure, Folder};
use super::images::Found;
use super::records::{Comparison, Convergence, Diagnosis, Strategies};
use crate::commands::numbers::{digits, quantity, short};

/// A table of names and values.
pub struct Facts {
    pub heading: String,
    pub rows: Vec<(String, String)>,
}

impl Facts {
    fn new(heading: &str) -> Self {
        Self {
            heading: heading.into(),
            rows: Vec::new(),
        }
    }

    fn with(mut self, name: &str, value: impl ToString) -> Self {
        self.rows.push((name.into(), value.to_string()));
        self
    }

    fn with_all(mut self, fields: &Map<String, Value>) -> Self {
        for (name, value) in fields {
            self.add(name, value);
        }
        self
    }

    /// Adds a row for a value, and for an object a row for each field.
    fn add(&mut self, name: &str, value: &Value) {
        match value {
            Value::Object(fields) => {
                for (field, value) in fields {
                    self.add(&format!("{name}.{field}"), value);
                }
            }
            value => self.rows.push((name.replace('_', " "), plain(value))),
        }
    }
}

/// A value without the quotes and brackets of JSON.
fn plain(value: &Value) -> String {
    match value {
        Value::Null => "none".into(),
        Value::String(text) => text.clone(),
        Value::Array(values) => values.iter().map(plain).collect::<Vec<_>>().join(", "),
        Value::Number(number) => match number.as_f64().filter(|_| number.is_f64()) {
            Some(number) => short(number),
            None => number.to_string(),
        },
        Value::Bool(_) | Value::Object(_) => value.to_string(),
    }
}

/// The results of `converge`.
pub struct ConvergenceSection {
    pub chart: Option<Figure>,
    pub table: Option<ConvergenceTable>,
    /// An image of the error of each variant.
    pub errors: Vec<Figure>,
}

/// The errors at the end of the chart.
pub struct ConvergenceTable {
    pub reference: String,
    pub rows: Vec<ConvergenceRow>,
    pub notes: Vec<String>,
    pub settings: Facts,
    /// File names of the images, without extension.
    pub stems: Vec<String>,
}

/// The end of one curve.
pub struct ConvergenceRow {
    pub label: String,
    pub seconds: String,
    pub rays: String,
    pub relative_mse: String,
    pub spread: String,
    pub trimmed: String,
    pub slope: String,
    pub comparisons: Vec<String>,
}

const CONVERGE: &str = "converge";

pub fn convergence(folder: &Folder) -> miette::Result<Option<ConvergenceSection>> {
    let caption = "relMSE against time and against rays, and without the worst 0.1% of the pixels \
                   against time: the mean of the repeats, and a band from the least to the greatest";
    let chart = folder.chart("convergence.svg", CONVERGE, caption)?;
    let record: Option<Convergence> = folder.json("convergence.json", CONVERGE)?;
    let mut errors = Vec::new();
    for variant in record.iter().flat_map(|record| &record.variants) {
        let name = format!("{}-error.png", variant.image);
        errors.extend(folder.picture(&name, CONVERGE, &variant.label)?);
    }
    let table = record.map(convergence_table);
    Ok(
        (chart.is_some() || table.is_some()).then_some(ConvergenceSection {
            chart,
            table,
            errors,
        }),
    )
}

fn error(error: Option<f64>) -> String {
    error.map_or("infinite".into(), digits)
}

fn convergence_table(record: Convergence) -> ConvergenceTable {
    let rows = record.variants.iter().filter_map(|variant| {
        let end = variant.points.last()?;
        let comparisons = [
            (&variant.comparison, ""),
            (&variant.comparison_by_rays, ""),
            (
                &variant.comparison_trimmed,
                ", without the worst 0.1% of the pixels",
            ),
        ];
        Some(ConvergenceRow {
            label: variant.label.clone(),
            seconds: format!("{:.1}", end.seconds),
            rays: quantity(end.rays),
            relative_mse: error(end.relative_mse),
            spread: end.spread.map(error).join(" to "),
            trimmed: error(end.relative_mse_trimmed),
            slope: variant.slope.map_or("-".into(), |s| format!("{s:.2}")),
            comparisons: comparisons
                .iter()
                .filter_map(|(said, of)| Some(format!("{}{of}", said.as_ref()?)))
                .collect(),
        })
    });
    let mut notes = record.warnings.clone();
    if record.interrupted {
        notes.push("interrupted: only complete renders are counted".into());
    }
    ConvergenceTable {
        rows: rows.collect(),
        reference: record.reference.description,
        notes,
        settings: Facts::new("converge").with_all(&record.settings),
        stems: record.variants.into_iter().map(|v| v.image).collect(),
    }
}

/// The results of `diagnose`.
pub struct DiagnosisSection {
    pub verdict: Option<Verdict>,
    /// The tables as printed text.
    pub tables: Option<String>,
    pub charts: Vec<Figure>,
}

/// The result of all tests, and the settings.
pub struct Verdict {
    pub stationary: bool,
    pub text: String,
    pub settings: Facts,
}

const DIAGNOSE: &str = "diagnose";

pub fn diagnosis(folder: &Folder) -> miette::Result<Option<DiagnosisSection>> {
    let record: Option<Diagnosis> = folder.json("diagnose.json", DIAGNOSE)?;
    let text = folder.text("diagnose.txt", DIAGNOSE)?;
    let mut charts = Vec::new();
    for (name, caption) in [
        (
            "traces.svg",
            "Traces of some chains, and their autocorrelation",
        ),
        (
            "p-values.svg",
            "p-values of all tests: about uniform if the chains are correct",
        ),
        ("tiles.svg", "Mixing of the chains, tile by tile"),
    ] {
        charts.extend(folder.chart(name, DIAGNOSE, caption)?);
    }
    let verdict = record.map(|record| Verdict {
        stationary: record.stationary,
        text: record.verdict,
        settings: Facts::new(DIAGNOSE)
            .with("version", record.version)
            .with("scene", record.scene)
            .with("integrator", plain(&record.integrator))
            .with("alpha", record.alpha)
            .with_all(&record.budget),
    });
    // The text begins with the verdict, which is shown separately.
    let tables = text.map(|text| match &verdict {
        Some(verdict) => text.strip_prefix(&verdict.text).unwrap_or(&text).into(),
        None => text,
    });
    let tables = tables.map(|text: String| text.trim().to_owned());
    let any = verdict.is_some() || tables.is_some() || !charts.is_empty();
    Ok(any.then_some(DiagnosisSection {
        verdict,
        tables,
        charts,
    }))
}

/// The results of `compare`.
pub struct ComparisonSection {
    pub verdict: Option<String>,
    pub notes: Vec<String>,
    pub facts: Option<Facts>,
    pub maps: Vec<Figure>,
}

const COMPARE: &str = "compare";

pub fn comparison(folder: &Folder) -> miette::Result<Option<ComparisonSection>> {
    let record: Option<Comparison> = folder.json("compare.json", COMPARE)?;
    let mut maps = Vec::new();
    for (name, caption) in [
        ("error.png", "Relative error of each pixel"),
        ("flip.png", "Visibility of the error of each pixel (FLIP)"),
    ] {
        maps.extend(folder.picture(name, COMPARE, caption)?);
    }
    if record.is_none() && maps.is_empty() {
        return Ok(None);
    }
    let mut section = ComparisonSection {
        verdict: None,
        notes: Vec::new(),
        facts: None,
        maps,
    };
    if let Some(record) = record {
        let mut facts = Facts::new(COMPARE)
            .with("image", record.image)
            .with("reference", record.reference)
            .with("size", record.size.map(|n| n.to_string()).join(" x "))
            .with_all(&record.errors);
        facts.add("FLIP", &Value::Object(record.flip));
        match record.bias_not_tested {
            Some(reason) => facts = facts.with("bias", format!("not tested: {reason}")),
            None => facts.add("bias", &record.bias),
        }
        section.facts = Some(facts.with("version", record.version));
        section.verdict = Some(record.verdict);
        section.notes = record.notes;
    }
    Ok(Some(section))
}

/// The results of `strategies`.
pub struct StrategiesSection {
    pub sheets: Vec<Figure>,
    pub table: Option<StrategiesTable>,
}

/// The light of each technique, in numbers.
pub struct StrategiesTable {
    pub rows: Vec<[String; 5]>,
    pub notes: Vec<String>,
    pub settings: Facts,
}

const STRATEGIES: &str = "strategies";

pub fn strategies(folder: &Folder) -> miette::Result<Option<StrategiesSection>> {
    let mut sheets = Vec::new();
    for (name, caption) in [
        (
            "weighted.png",
            "Techniques (s, t), weighted: their sum is the image",
        ),
        ("unweighted.png", "Techniques (s, t), unweighted"),
    ] {
        sheets.extend(folder.picture(name, STRATEGIES, caption)?);
    }
    let record: Option<Strategies> = folder.json("strategies.json", STRATEGIES)?;
    let any = record.is_some() || !sheets.is_empty();
    Ok(any.then(|| StrategiesSection {
        sheets,
        table: record.map(strategies_table),
    }))
}

fn strategies_table(record: Strategies) -> StrategiesTable {
    let rows = record.techniques.iter().map(|technique| {
        let share = technique.share;
        [
            match (technique.s, technique.specular) {
                (Some(s), _) => format!("({s}, {})", technique.t),
                (None, n) => format!("(1*, {}) by {} delta vertices", technique.t, n.unwrap_or(0)),
            },
            technique.edges.to_string(),
            digits(technique.mean_luminance_unweighted),
            digits(technique.mean_luminance_weighted),
            share.map_or("-".into(), |share| format!("{:.1}%", 100.0 * share)),
        ]
    });
    let mut notes = record.warnings;
    if record.interrupted {
        notes.push("interrupted: the images hold the samples taken so far".into());
    }
    let mut settings = Facts::new(STRATEGIES)
        .with("version", record.version)
        .with("scene", record.scene);
    settings.add("defines", &Value::Object(record.defines));
    StrategiesTable {
        rows: rows.collect(),
        notes,
        settings: settings
            .with("max depth", record.max_depth)
            .with("samples per pixel", record.samples_per_pixel)
            .with_all(&record.statistics),
    }
}

/// The attributes of an image, if it has any.
pub fn origin(found: &Found) -> Option<Facts> {
    (!found.attributes.is_empty()).then(|| Facts {
        heading: format!("{}.exr", found.stem),
        rows: found.attributes.clone(),
    })
}
