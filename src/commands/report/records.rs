//! The JSON files of other commands, as far as a report shows them.

use serde::Deserialize;
use serde_json::{Map, Value};

/// `convergence.json`.
#[derive(Deserialize)]
pub struct Convergence {
    pub settings: Map<String, Value>,
    pub reference: Reference,
    pub variants: Vec<Variant>,
    pub interrupted: bool,
    pub warnings: Vec<String>,
}

/// The reference of a convergence experiment.
#[derive(Deserialize)]
pub struct Reference {
    pub description: String,
}

/// A curve of the chart.
#[derive(Deserialize)]
pub struct Variant {
    pub label: String,
    /// File name of its image, without extension.
    pub image: String,
    pub slope: Option<f64>,
    pub comparison: Option<String>,
    pub comparison_by_rays: Option<String>,
    pub comparison_trimmed: Option<String>,
    pub points: Vec<Point>,
}

/// A point of the curve. JSON has no infinity, so the error against a black reference is null.
#[derive(Deserialize)]
pub struct Point {
    pub seconds: f64,
    pub rays: f64,
    pub relative_mse: Option<f64>,
    pub spread: [Option<f64>; 2],
    pub relative_mse_trimmed: Option<f64>,
}

/// `diagnose.json`, without the results that are in the tables of `diagnose.txt`.
#[derive(Deserialize)]
pub struct Diagnosis {
    pub version: String,
    pub scene: String,
    pub integrator: Value,
    pub alpha: f64,
    pub budget: Map<String, Value>,
    pub stationary: bool,
    pub verdict: String,
}

/// `compare.json`.
#[derive(Deserialize)]
pub struct Comparison {
    pub version: String,
    pub image: String,
    pub reference: String,
    pub size: [usize; 2],
    pub verdict: String,
    pub errors: Map<String, Value>,
    pub flip: Map<String, Value>,
    pub bias: Value,
    pub bias_not_tested: Option<String>,
    pub notes: Vec<String>,
}

/// `strategies.json`.
#[derive(Deserialize)]
pub struct Strategies {
    pub version: String,
    pub scene: String,
    pub defines: Map<String, Value>,
    pub max_depth: u32,
    pub samples_per_pixel: u64,
    pub statistics: Map<String, Value>,
    pub interrupted: bool,
    pub warnings: Vec<String>,
    pub techniques: Vec<Technique>,
}

/// A technique (s, t), or 1* with `specular` delta vertices.
#[derive(Deserialize)]
pub struct Technique {
    pub s: Option<u32>,
    pub specular: Option<u32>,
    pub t: u32,
    pub edges: u32,
    pub mean_luminance_unweighted: f64,
    pub mean_luminance_weighted: f64,
    pub share: Option<f64>,
}
