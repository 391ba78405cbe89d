//! The page: a single HTML file without external resources.

use askama::Template;
use metrolight::plot::false_color;
use serde::Serialize;

use super::images::{Embedded, Found};
use super::sections::{
    ComparisonSection, ConvergenceSection, DiagnosisSection, Facts, StrategiesSection,
};
use crate::commands::comparison::SCALE;

/// Contents of the page. The template escapes all of them except the style, the script and its data.
#[derive(Template)]
#[template(path = "page.html")]
pub struct Page<'a> {
    pub title: String,
    pub version: &'static str,
    pub convergence: Option<ConvergenceSection>,
    pub diagnosis: Option<DiagnosisSection>,
    pub comparison: Option<ComparisonSection>,
    pub strategies: Option<StrategiesSection>,
    pub images: Option<Viewer<'a>>,
    /// Attributes of the images.
    pub origins: Vec<Facts>,
    pub style: &'static str,
    pub script: &'static str,
}

pub const STYLE: &str = include_str!("page/page.css");
pub const SCRIPT: &str = include_str!("page/viewer.js");

impl Page<'_> {
    /// Names of the sections that the page has.
    pub fn sections(&self) -> Vec<&'static str> {
        let sections = [
            (self.convergence.is_some(), "convergence"),
            (self.images.is_some(), "images"),
            (self.comparison.is_some(), "comparison"),
            (self.diagnosis.is_some(), "chains"),
            (self.strategies.is_some(), "techniques"),
        ];
        let there = sections.into_iter().filter(|(there, _)| *there);
        there.map(|(_, name)| name).collect()
    }

    /// Settings and versions of all results.
    fn facts(&self) -> Vec<&Facts> {
        let convergence = self.convergence.as_ref().and_then(|c| c.table.as_ref());
        let diagnosis = self.diagnosis.as_ref().and_then(|d| d.verdict.as_ref());
        let strategies = self.strategies.as_ref().and_then(|s| s.table.as_ref());
        let commands = [
            convergence.map(|table| &table.settings),
            diagnosis.map(|verdict| &verdict.settings),
            strategies.map(|table| &table.settings),
        ];
        commands
            .into_iter()
            .flatten()
            .chain(&self.origins)
            .collect()
    }
}

/// The viewer of the images.
pub struct Viewer<'a> {
    /// Name and size of each.
    pub names: Vec<(&'a str, String)>,
    /// The n of the n by n pixels of the files that are one pixel of the page.
    pub joined: usize,
    /// Labels of the scale of errors, and their positions in percent of its width.
    pub marks: Vec<(&'static str, f64)>,
    pub data: Data<'a>,
}

/// Data for the script.
#[derive(Serialize)]
pub struct Data<'a> {
    images: Vec<Embedded<'a>>,
    /// Colours of the scale of errors, at equal distances.
    colors: Vec<[u8; 3]>,
    /// Relative errors at both ends of the logarithmic scale.
    range: [f64; 2],
}

/// Number of colours of the scale of errors.
const COLORS: u32 = 256;

impl<'a> Viewer<'a> {
    /// `None` without images.
    pub fn new(found: &'a [Found]) -> Option<Self> {
        if found.is_empty() {
            return None;
        }
        let [(low, _), .., (high, _)] = SCALE;
        let position = |error: f64| 100.0 * f64::log10(error / low) / f64::log10(high / low);
        let (images, joined) = super::images::embed(found);
        let name = |found: &'a Found| {
            let image = &found.image;
            (&*found.stem, format!("{} x {}", image.width, image.height))
        };
        Some(Self {
            names: found.iter().map(name).collect(),
            joined,
            marks: SCALE.map(|(error, label)| (label, position(error))).into(),
            data: Data {
                images,
                colors: (0..COLORS)
                    .map(|i| false_color(f64::from(i) / f64::from(COLORS - 1)))
                    .collect(),
                range: [low, high],
            },
        })
    }
}
