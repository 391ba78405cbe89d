//! Charts in SVG, and conversion of SVG to PNG. Independent of rendering.
//!
//! ```
//! use metrolight::plot::{Axis, Chart, Mark, Series, draw};
//!
//! let chart = Chart {
//!     title: "error against time".into(),
//!     x: Axis::logarithmic("seconds"),
//!     y: Axis::logarithmic("relMSE"),
//!     series: vec![Series {
//!         label: "bdpt".into(),
//!         points: vec![[1.0, 0.1], [10.0, 0.01]],
//!         band: Vec::new(),
//!         mark: Mark::Line,
//!         color: 0,
//!     }],
//! };
//! let svg = draw(&[chart], 1)?;
//! assert!(svg.starts_with("<svg"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod chart;
pub mod colors;
pub mod contact_sheet;
pub mod heat_map;
pub mod picture;
pub mod raster;

pub use chart::{Axis, Chart, Mark, Scale, Series, draw};
pub use colors::{false_color, series_color};
pub use contact_sheet::{Cell, Row, draw_contact_sheet};
pub use heat_map::{HeatMap, draw_heat_maps};
pub use picture::{Picture, draw_with_scale};
pub use raster::rasterize;

/// Why a chart cannot be drawn, usually because its numbers give no range for an axis.
#[derive(Debug, thiserror::Error)]
#[error("cannot draw the chart: {0}")]
pub struct PlotError(pub String);

impl PlotError {
    fn new(cause: impl std::fmt::Display) -> Self {
        Self(cause.to_string())
    }
}
