//! Charts with lines, bands, points and bars, each over one pair of axes, side by side.

use plotters::coord::Shift;
use plotters::coord::ranged1d::{AsRangedCoord, ValueFormatter};
use plotters::prelude::*;

use super::{PlotError, series_color};

/// Size of one chart, in pixels of the SVG.
const SIZE: (u32, u32) = (520, 440);

/// Height of a line of the legend and its left edge, in pixels.
const LEGEND_LINE: i32 = 17;
const LEGEND_LEFT: i32 = 74;

/// The scale of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Equal steps are equally long.
    Linear,
    /// Equal factors are equally long. Values that are not above 0 are omitted.
    Logarithmic,
}

/// An axis.
#[derive(Clone, Debug)]
pub struct Axis {
    /// The quantity and its unit.
    pub label: String,
    /// The scale.
    pub scale: Scale,
}

impl Axis {
    /// An axis with a linear scale.
    pub fn linear(label: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            scale: Scale::Linear,
        }
    }

    /// An axis with a logarithmic scale.
    pub fn logarithmic(label: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            scale: Scale::Logarithmic,
        }
    }

    fn shows(&self, value: f64) -> bool {
        value.is_finite() && (self.scale == Scale::Linear || value > 0.0)
    }

    /// The range that contains all of `values`, with a margin.
    fn range(&self, values: impl Iterator<Item = f64>) -> std::ops::Range<f64> {
        let shown = values.filter(|&v| self.shows(v));
        let (low, high) = shown.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
            (low.min(v), high.max(v))
        });
        let (low, high) = if low <= high { (low, high) } else { (1.0, 1.0) };
        match self.scale {
            Scale::Logarithmic => low / 1.15..high * 1.15,
            Scale::Linear if low == high => low - 0.5..high + 0.5,
            Scale::Linear => low..high + 0.03 * (high - low),
        }
    }
}

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// A line through the points.
    Line,
    /// A dashed line, for values that are not measured.
    Dashes,
    /// A dot at each point.
    Dots,
    /// A bar from 0 to each point. Its left edge is the `x` of the point, its right edge that of
    /// the next point.
    Bars,
}

/// One series of a chart.
#[derive(Clone, Debug)]
pub struct Series {
    /// The label in the legend; no entry if empty.
    pub label: String,
    /// x and y, in the order of drawing.
    pub points: Vec<[f64; 2]>,
    /// x, and the lower and upper edge of a band around the points. May be empty.
    pub band: Vec<[f64; 3]>,
    /// How points are drawn.
    pub mark: Mark,
    /// The colour, as an argument of [`series_color`].
    pub color: usize,
}

/// A chart.
#[derive(Clone, Debug)]
pub struct Chart {
    /// Title above the chart.
    pub title: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// The series, drawn in this order.
    pub series: Vec<Series>,
}

/// Draws `charts` side by side, `columns` in a row, as an SVG document.
///
/// # Errors
/// If the range of an axis cannot be drawn.
pub fn draw(charts: &[Chart], columns: usize) -> Result<String, PlotError> {
    let columns = columns.clamp(1, charts.len().max(1));
    let rows = charts.len().div_ceil(columns).max(1);
    let size = (SIZE.0 * columns as u32, SIZE.1 * rows as u32);
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        root.fill(&WHITE).map_err(PlotError::new)?;
        for (area, chart) in root.split_evenly((rows, columns)).iter().zip(charts) {
            chart.draw_on(area)?;
        }
        root.present().map_err(PlotError::new)?;
    }
    Ok(svg)
}

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

impl Chart {
    fn draw_on(&self, area: &Area) -> Result<(), PlotError> {
        let legend = self.labelled().count() as i32 * LEGEND_LINE;
        let height = area.dim_in_pixel().1 as i32 - legend - LEGEND_LINE / 2;
        let (area, below) = area.split_vertically(height);
        self.draw_legend(&below)?;
        let area = &area;
        let points = || self.series.iter().flat_map(|s| &s.points);
        let band = || self.series.iter().flat_map(|s| &s.band);
        let bars = self.series.iter().any(|s| s.mark == Mark::Bars);
        let x = self
            .x
            .range(points().map(|p| p[0]).chain(band().map(|b| b[0])));
        let y = points().map(|p| p[1]);
        let y = y.chain(band().flat_map(|b| [b[1], b[2]]));
        let y = self.y.range(y.chain(bars.then_some(0.0)));
        match (self.x.scale, self.y.scale) {
            (Scale::Linear, Scale::Linear) => self.draw_in(area, x, y),
            (Scale::Linear, Scale::Logarithmic) => self.draw_in(area, x, y.log_scale()),
            (Scale::Logarithmic, Scale::Linear) => self.draw_in(area, x.log_scale(), y),
            (Scale::Logarithmic, Scale::Logarithmic) => {
                self.draw_in(area, x.log_scale(), y.log_scale())
            }
        }
    }

    fn draw_in<X, Y>(&self, area: &Area, x: X, y: Y) -> Result<(), PlotError>
    where
        X: AsRangedCoord<Value = f64>,
        Y: AsRangedCoord<Value = f64>,
        X::CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>,
        Y::CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>,
    {
        let mut chart = ChartBuilder::on(area)
            .caption(&self.title, ("sans-serif", 16))
            .margin(10)
            .x_label_area_size(40)
            .y_label_area_size(64)
            .build_cartesian_2d(x, y)
            .map_err(PlotError::new)?;
        chart
            .configure_mesh()
            .light_line_style(RGBColor(240, 240, 240))
            .bold_line_style(RGBColor(215, 215, 215))
            .x_labels(8)
            .y_labels(8)
            .x_desc(&self.x.label)
            .y_desc(&self.y.label)
            .x_label_formatter(&|&v| number(v))
            .y_label_formatter(&|&v| number(v))
            .label_style(("sans-serif", 12))
            .axis_desc_style(("sans-serif", 13))
            .draw()
            .map_err(PlotError::new)?;
        for series in &self.series {
            self.draw_series(&mut chart, series)?;
        }
        Ok(())
    }

    fn draw_series<'a, X, Y>(
        &self,
        chart: &mut ChartContext<'a, SVGBackend<'a>, Cartesian2d<X, Y>>,
        series: &Series,
    ) -> Result<(), PlotError>
    where
        X: Ranged<ValueType = f64>,
        Y: Ranged<ValueType = f64>,
    {
        let [r, g, b] = series_color(series.color);
        let color = RGBColor(r, g, b);
        let shows = |x: f64, y: f64| self.x.shows(x) && self.y.shows(y);
        let band: Vec<_> = series
            .band
            .iter()
            .filter(|b| shows(b[0], b[1]) && shows(b[0], b[2]))
            .collect();
        if !band.is_empty() {
            let there = band.iter().map(|b| (b[0], b[1]));
            let back = band.iter().rev().map(|b| (b[0], b[2]));
            let outline: Vec<_> = there.chain(back).collect();
            let polygon = Polygon::new(outline, color.mix(0.2));
            chart.draw_series([polygon]).map_err(PlotError::new)?;
        }
        let points = series.points.iter().filter(|p| shows(p[0], p[1]));
        let points: Vec<(f64, f64)> = points.map(|p| (p[0], p[1])).collect();
        let drawn = match series.mark {
            Mark::Line => chart.draw_series(LineSeries::new(points, color.stroke_width(2))),
            Mark::Dashes => {
                chart.draw_series(DashedLineSeries::new(points, 6, 4, color.stroke_width(1)))
            }
            Mark::Dots => {
                let dots = points
                    .into_iter()
                    .map(|p| Circle::new(p, 2, color.filled()));
                chart.draw_series(dots)
            }
            Mark::Bars => {
                let bars = points.windows(2).map(|pair| {
                    let corners = [(pair[0].0, 0.0), (pair[1].0, pair[0].1)];
                    Rectangle::new(corners, color.mix(0.6).filled())
                });
                chart.draw_series(bars)
            }
        };
        drawn.map(|_| ()).map_err(PlotError::new)
    }

    /// Draws a line with mark and label for each labelled series.
    fn draw_legend(&self, area: &Area) -> Result<(), PlotError> {
        let style = ("sans-serif", 12).into_text_style(area);
        for (i, series) in self.labelled().enumerate() {
            let y = i as i32 * LEGEND_LINE + 7;
            let [r, g, b] = series_color(series.color);
            let color = RGBColor(r, g, b);
            let from = LEGEND_LEFT;
            let strokes: &[[i32; 2]] = match series.mark {
                Mark::Dashes => &[[0, 7], [11, 18]],
                Mark::Line | Mark::Dots | Mark::Bars => &[[0, 18]],
            };
            for &[a, b] in strokes {
                let stroke =
                    PathElement::new([(from + a, y), (from + b, y)], color.stroke_width(2));
                area.draw(&stroke).map_err(PlotError::new)?;
            }
            area.draw_text(&series.label, &style, (from + 26, y - 6))
                .map_err(PlotError::new)?;
        }
        Ok(())
    }

    fn labelled(&self) -> impl Iterator<Item = &Series> {
        self.series.iter().filter(|series| !series.label.is_empty())
    }
}

/// A number formatted for an axis, as short as possible.
pub(super) fn number(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 {
        "0".into()
    } else if !(1e-3..1e5).contains(&size) {
        let text = format!("{value:.1e}");
        text.replace(".0e", "e")
    } else {
        // Four significant digits, at most three after the point.
        let decimals = (3.0 - size.log10().floor()).clamp(0.0, 3.0) as usize;
        let text = format!("{value:.decimals$}");
        if decimals == 0 {
            return text;
        }
        text.trim_end_matches('0').trim_end_matches('.').into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(x: Axis, y: Axis, points: Vec<[f64; 2]>, mark: Mark) -> Chart {
        let series = Series {
            label: "a <series> & more".into(),
            band: points
                .iter()
                .map(|p| [p[0], p[1] / 2.0, p[1] * 2.0])
                .collect(),
            points,
            mark,
            color: 0,
        };
        Chart {
            title: "title".into(),
            x,
            y,
            series: vec![series],
        }
    }

    #[test]
    fn all_axes_and_marks_can_be_rasterized() {
        let points = vec![[1.0, 5.0], [10.0, 0.1], [100.0, 0.0], [f64::NAN, 1.0]];
        let axes = [Axis::linear, Axis::logarithmic];
        let mut charts = Vec::new();
        for x in axes {
            for y in axes {
                for mark in [Mark::Line, Mark::Dashes, Mark::Dots, Mark::Bars] {
                    charts.push(chart(x("x"), y("y"), points.clone(), mark));
                }
            }
        }
        charts.push(chart(
            Axis::linear("x"),
            Axis::logarithmic("y"),
            Vec::new(),
            Mark::Line,
        ));
        let svg = draw(&charts, 4).unwrap();
        roxmltree::Document::parse(&svg).unwrap();
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
        let png = super::super::rasterize(&svg, 0.5).unwrap();
        let image = image::load_from_memory(&png).unwrap();
        assert_eq!((image.width(), image.height()), (1040, 1100));
    }

    #[test]
    fn numbers_are_short() {
        for (value, expected) in [
            (0.0, "0"),
            (0.25, "0.25"),
            (1.0, "1"),
            (1e-5, "1e-5"),
            (-2.5e7, "-2.5e7"),
            (12345.0, "12345"),
            (3546.716, "3547"),
            (12.345, "12.35"),
        ] {
            assert_eq!(number(value), expected);
        }
    }
}
