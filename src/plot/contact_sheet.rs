//! Many small images on one sheet.

use super::PlotError;
use super::picture::{Picture, document, text};

/// A picture with a label.
#[derive(Clone, Debug)]
pub struct Cell {
    /// Label below the picture.
    pub label: String,
    /// The picture.
    pub picture: Picture,
}

/// Pictures side by side, centred on the sheet.
#[derive(Clone, Debug)]
pub struct Row {
    /// Title above the row.
    pub title: String,
    /// The pictures, from left to right.
    pub cells: Vec<Cell>,
}

/// Minimum and maximum width of a picture on the sheet, in pixels.
const WIDTH_RANGE: [f64; 2] = [128.0, 256.0];

/// Space around a picture, in pixels.
const GAP: f64 = 10.0;

/// Height of a line of text, in pixels.
const LINE: f64 = 18.0;

/// Minimum width of a sheet, so that its title fits, in pixels.
const MIN_WIDTH: f64 = 620.0;

/// Draws `rows` from top to bottom as an SVG document, below a title and a note. All pictures have
/// the same size.
///
/// # Errors
/// If the data of a picture does not match its size.
pub fn draw_contact_sheet([title, note]: [&str; 2], rows: &[Row]) -> Result<String, PlotError> {
    let cells = || rows.iter().flat_map(|row| &row.cells);
    let (width, height) = cells().next().map_or((1.0, 1.0), |cell| {
        let native = cell.picture.width as f64;
        let width = native.clamp(WIDTH_RANGE[0], WIDTH_RANGE[1]);
        (width, width * cell.picture.height as f64 / native)
    });
    let columns = rows.iter().map(|row| row.cells.len()).max().unwrap_or(0);
    let sheet = (columns as f64 * (width + GAP) + GAP).max(MIN_WIDTH);

    let mut body = text([GAP, LINE + 4.0, 18.0], false, title);
    body += &text([GAP, 2.0 * LINE + 4.0, 12.0], false, note);
    let mut y = 3.0 * LINE;
    for row in rows {
        y += LINE;
        body += &text([0.5 * sheet, y, 13.0], true, &row.title);
        y += 6.0;
        let row_width = row.cells.len() as f64 * (width + GAP) - GAP;
        for (cell, i) in row.cells.iter().zip(0..) {
            let x = 0.5 * (sheet - row_width) + f64::from(i) * (width + GAP);
            body += &cell.picture.element([x, y, width])?;
            let baseline = y + height + 0.8 * LINE;
            body += &text([x + 0.5 * width, baseline, 12.0], true, &cell.label);
        }
        y += height + LINE + GAP;
    }
    Ok(document([sheet, y], &body))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_centred_and_labelled() {
        let cell = |shade: u8| Cell {
            label: format!("({shade}, <)"),
            picture: Picture {
                width: 200,
                height: 100,
                rgb: vec![shade; 60_000],
            },
        };
        let row = |shades: &[u8]| Row {
            title: "row".into(),
            cells: shades.iter().map(|&shade| cell(shade)).collect(),
        };
        let svg = draw_contact_sheet(["a", "b"], &[row(&[50, 60]), row(&[70, 80, 90])]).unwrap();
        let png = super::super::rasterize(&svg, 1.0).unwrap();
        let image = image::load_from_memory(&png).unwrap().into_rgb8();
        // Rows are 152 high, their pictures begin at y = 78; the sheet is 640 wide.
        assert_eq!(image.dimensions(), (640, 358));
        for (x, y, shade) in [
            (120, 100, 50),
            (520, 170, 60),
            (15, 240, 70),
            (320, 300, 80),
            (625, 300, 90),
            (100, 100, 255),
        ] {
            assert_eq!(image.get_pixel(x, y).0, [shade; 3], "{x} {y}");
        }
    }
}
