//! Contact sheets of all techniques, as in Veach (1997, figures 10.3 and 10.4).

use metrolight::film::srgb_bytes;
use metrolight::plot::{Cell, Picture, Row, draw_contact_sheet, rasterize};
use metrolight::render::{Strategies, TechniqueImages};
use miette::IntoDiagnostic;

use super::shares::{Kind, Shares, edges_text, percent};

/// Mean luminance of a row's sum on the sheet, roughly: middle grey.
const MIDDLE_GREY: f64 = 0.2;

/// Exposure in stops of the rows for 1, 2, ... edges: whole stops that bring the mean of a row's sum
/// near [`MIDDLE_GREY`], or 0 for a black row.
pub fn exposures(edges: u32, rendering: &Strategies, shares: &Shares) -> Vec<f64> {
    let row = |k: usize| {
        let images = rendering.images.iter().zip(&shares.means);
        let images = images.filter(|(images, _)| images.technique.edges() == k);
        let sum: f64 = images.map(|(_, mean)| mean[1]).sum();
        if sum > 0.0 {
            // Adding 0 avoids -0.
            (MIDDLE_GREY / sum).log2().round() + 0.0
        } else {
            0.0
        }
    };
    (1..=edges as usize).map(row).collect()
}

/// A contact sheet of all techniques, with `note` below its title, as a PNG file.
pub fn sheet(
    kind: Kind,
    rendering: &Strategies,
    shares: &Shares,
    exposures: &[f64],
    note: &str,
) -> miette::Result<Vec<u8>> {
    let cell = |i: usize, images: &TechniqueImages, stops: f64| {
        let image = kind.of(images);
        let note = match (kind, shares.share(i)) {
            _ if shares.means[i][0] == 0.0 => "no light".into(),
            (Kind::Weighted, Some(share)) => percent(share),
            _ => format!("mean {:.2e}", shares.means[i][0]),
        };
        Cell {
            label: format!("{}: {note}", images.technique),
            picture: Picture {
                width: image.width,
                height: image.height,
                rgb: srgb_bytes(image, stops.exp2()),
            },
        }
    };
    let row = |(k, &stops): (usize, &f64)| {
        let images = rendering.images.iter().enumerate();
        let images = images.filter(|(_, images)| images.technique.edges() == k);
        Row {
            title: format!(
                "{}, exposure {stops:+} {}",
                edges_text(k),
                stops_text(stops)
            ),
            cells: images.map(|(i, images)| cell(i, images, stops)).collect(),
        }
    };
    let rows: Vec<Row> = (1..).zip(exposures).map(row).collect();
    let title = match kind {
        Kind::Unweighted => "Techniques (s,t), unweighted",
        Kind::Weighted => "Techniques (s,t), weighted: their sum is the image",
    };
    let svg = draw_contact_sheet([title, note], &rows).into_diagnostic()?;
    rasterize(&svg, 1.0).into_diagnostic()
}

fn stops_text(stops: f64) -> &'static str {
    if stops.abs() == 1.0 { "stop" } else { "stops" }
}
