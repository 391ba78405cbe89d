//! Grids of numbers in false colours, with a colour scale.

use plotters::prelude::*;

use super::chart::number;
use super::{PlotError, false_color};

/// Width and height of one map with title and colour scale, in pixels of the SVG.
const SIZE: (u32, u32) = (400, 320);

/// Number of steps of the colour scale.
const STEPS: i32 = 64;

/// Numbers on a grid.
#[derive(Clone, Debug)]
pub struct HeatMap {
    /// Title above the map.
    pub title: String,
    /// Rows from top to bottom, all of the same length. NaN is drawn in grey.
    pub rows: Vec<Vec<f64>>,
    /// The values of the darkest and the brightest colour.
    pub range: [f64; 2],
}

impl HeatMap {
    /// A map whose range is that of its finite numbers.
    pub fn new(title: impl Into<String>, rows: Vec<Vec<f64>>) -> Self {
        let finite = rows.iter().flatten().copied().filter(|v| v.is_finite());
        let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
            (low.min(v), high.max(v))
        });
        Self {
            title: title.into(),
            rows,
            range: if low < high { [low, high] } else { [0.0, 1.0] },
        }
    }

    fn color(&self, value: f64) -> RGBColor {
        let [low, high] = self.range;
        let [r, g, b] = false_color((value - low) / (high - low));
        RGBColor(r, g, b)
    }
}

/// Draws `maps` side by side as an SVG document.
///
/// # Errors
/// If the drawing library fails.
pub fn draw_heat_maps(maps: &[HeatMap]) -> Result<String, PlotError> {
    let size = (SIZE.0 * maps.len().max(1) as u32, SIZE.1);
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        root.fill(&WHITE).map_err(PlotError::new)?;
        for (area, map) in root.split_evenly((1, maps.len().max(1))).iter().zip(maps) {
            let (title, body) = area.split_vertically(34);
            let style = ("sans-serif", 15).into_text_style(&title);
            title
                .draw_text(&map.title, &style, (14, 10))
                .map_err(PlotError::new)?;
            draw_map(map, &body)?;
        }
        root.present().map_err(PlotError::new)?;
    }
    Ok(svg)
}

type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;

fn draw_map(map: &HeatMap, area: &Area) -> Result<(), PlotError> {
    let (rows, columns) = (map.rows.len(), map.rows.first().map_or(0, Vec::len));
    let side = (300.0 / columns.max(1) as f64).min(270.0 / rows.max(1) as f64);
    let edge = |i: usize, start: i32| start + (i as f64 * side).round() as i32;
    for (j, row) in map.rows.iter().enumerate() {
        for (i, &value) in row.iter().enumerate() {
            let corners = [(edge(i, 14), edge(j, 0)), (edge(i + 1, 14), edge(j + 1, 0))];
            let cell = Rectangle::new(corners, map.color(value).filled());
            area.draw(&cell).map_err(PlotError::new)?;
        }
    }
    draw_scale(map, area)
}

/// Draws the colour scale, a column of colours with some of their values.
fn draw_scale(map: &HeatMap, area: &Area) -> Result<(), PlotError> {
    let [low, high] = map.range;
    let height = 4;
    for step in 0..STEPS {
        let value = high - (high - low) * f64::from(step) / f64::from(STEPS - 1);
        let corners = [(324, step * height), (338, (step + 1) * height)];
        let cell = Rectangle::new(corners, map.color(value).filled());
        area.draw(&cell).map_err(PlotError::new)?;
    }
    let style = ("sans-serif", 12).into_text_style(area);
    for (value, y) in [
        (high, 0),
        (0.5 * (low + high), STEPS * height / 2 - 6),
        (low, STEPS * height - 12),
    ] {
        area.draw_text(&number(value), &style, (344, y))
            .map_err(PlotError::new)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_have_the_colours_of_their_numbers() {
        let map = HeatMap::new("map", vec![vec![1.0, 2.0, f64::NAN], vec![3.0, 1.5, 1.0]]);
        assert_eq!(map.range, [1.0, 3.0]);
        let svg = draw_heat_maps(&[map.clone(), map]).unwrap();
        roxmltree::Document::parse(&svg).unwrap();
        let png = super::super::rasterize(&svg, 1.0).unwrap();
        let image = image::load_from_memory(&png).unwrap().into_rgb8();
        assert_eq!(image.dimensions(), (2 * SIZE.0, SIZE.1));
        // Cells are 100 pixels wide, from (14, 34) on.
        assert_eq!(image.get_pixel(64, 84).0, false_color(0.0));
        assert_eq!(image.get_pixel(264, 84).0, [128; 3]);
        assert_eq!(image.get_pixel(64, 184).0, false_color(1.0));
    }
}
