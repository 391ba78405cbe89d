//! Charts of error against time and against rays.

use super::curve::Reached;
use super::{Cost, Curve, Measure, Variant};
use crate::plot::{Axis, Chart, Mark, PlotError, Series, draw};

/// Three charts side by side as an SVG document: relMSE against seconds and against rays, and relMSE
/// without the worst 0.1% of the pixels against seconds. Each curve has a line and a band from the least
/// to the greatest of all repeats. A dashed line shows the reference's own expected relMSE, if known.
///
/// # Errors
/// If the charts cannot be drawn.
pub fn convergence_chart(
    title: &str,
    variants: &[Variant],
    curves: &[Curve],
    reference_error: Option<f64>,
) -> Result<String, PlotError> {
    let panels = [
        (Cost::Seconds, Measure::Whole),
        (Cost::Rays, Measure::Whole),
        (Cost::Seconds, Measure::Trimmed),
    ];
    let charts = panels.map(|(cost, measure)| Chart {
        title: title.into(),
        x: Axis::logarithmic(match cost {
            Cost::Seconds => "seconds of rendering",
            Cost::Rays => "rays",
        }),
        y: Axis::logarithmic(match measure {
            Measure::Whole => "relMSE",
            Measure::Trimmed => "relMSE without the worst 0.1% of the pixels",
        }),
        series: series(variants, curves, reference_error, cost, measure),
    });
    draw(&charts, 3)
}

fn series(
    variants: &[Variant],
    curves: &[Curve],
    reference_error: Option<f64>,
    cost: Cost,
    measure: Measure,
) -> Vec<Series> {
    let ends = curves.iter().flat_map(|curve| {
        let ends = [curve.points.first(), curve.points.last()];
        ends.into_iter().flatten().map(|p| p.cost(cost))
    });
    let (first, last) = ends.fold((f64::INFINITY, 0.0f64), |(a, b), x| (a.min(x), b.max(x)));
    let known = reference_error.filter(|_| measure == Measure::Whole);
    let reference = known.map(|error| Series {
        label: "the reference's own error".into(),
        points: vec![[first, error], [last, error]],
        band: Vec::new(),
        mark: Mark::Dashes,
        color: 6,
    });
    let line = |(i, curve): (usize, &Curve)| {
        let points = curve.points.iter();
        Series {
            label: legend(variants, curves, i, cost, measure),
            points: points
                .clone()
                .map(|p| [p.cost(cost), p.error(measure)])
                .collect(),
            band: points
                .map(|p| {
                    let [least, greatest] = p.spread(measure);
                    [p.cost(cost), least, greatest]
                })
                .collect(),
            mark: Mark::Line,
            color: i,
        }
    };
    let lines = curves.iter().enumerate().map(line);
    lines.chain(reference).collect()
}

/// `pssmlt: slope -0.62, reaches bdpt's 60 s error in 4.1 s`.
fn legend(
    variants: &[Variant],
    curves: &[Curve],
    i: usize,
    cost: Cost,
    measure: Measure,
) -> String {
    let label = &variants[i].label;
    let slope = curves[i].slope(cost, measure);
    let slope = slope.map_or_else(String::new, |slope| format!("slope {slope:.2}"));
    let parts = [
        slope,
        comparison(variants, curves, i, cost, measure).unwrap_or_default(),
    ];
    let said: Vec<&str> = parts
        .iter()
        .map(String::as_str)
        .filter(|p| !p.is_empty())
        .collect();
    if said.is_empty() {
        label.clone()
    } else {
        format!("{label}: {}", said.join(", "))
    }
}

/// The cost at which variant `i` reaches the final error of the baseline: `reaches bdpt's 60 s error in
/// 4.1 s`. `None` for the baseline itself, and without measurements.
pub fn comparison(
    variants: &[Variant],
    curves: &[Curve],
    i: usize,
    cost: Cost,
    measure: Measure,
) -> Option<String> {
    let (baseline, end) = (variants.first()?, curves.first()?.end()?);
    if i == 0 {
        return None;
    }
    let whose = format!(
        "{}'s {} error",
        baseline.label,
        amount(end.cost(cost), cost)
    );
    Some(
        match curves.get(i)?.reaches(end.error(measure), cost, measure)? {
            Reached::At(x) => format!("reaches {whose} in {}", amount(x, cost)),
            Reached::Before(x) => format!(
                "is below {whose} from the first measurement on, at {}",
                amount(x, cost)
            ),
            Reached::Never(ratio) => format!("ends at {ratio:.2} times {whose}"),
        },
    )
}

/// A cost with its unit: `4.1 s`, or `1.2e8 rays`.
fn amount(x: f64, cost: Cost) -> String {
    match cost {
        Cost::Seconds if x < 9.95 => format!("{x:.1} s"),
        Cost::Seconds => format!("{x:.0} s"),
        Cost::Rays => format!("{x:.1e} rays"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::convergence::CurvePoint;
    use crate::render::Method;

    fn curve(errors: &[f64]) -> Curve {
        let point = |(i, &relative_mse): (usize, &f64)| CurvePoint {
            seconds: f64::from(1 << i),
            rays: 1e6 * f64::from(1 << i),
            relative_mse,
            spread: [0.5 * relative_mse, 2.0 * relative_mse],
            relative_mse_trimmed: relative_mse,
            spread_trimmed: [relative_mse; 2],
        };
        Curve {
            points: errors.iter().enumerate().map(point).collect(),
        }
    }

    #[test]
    fn the_legend_compares_with_the_baseline() {
        let variants = [Method::Bdpt, Method::Pssmlt, Method::Path].map(Variant::new);
        let curves = [
            curve(&[8.0, 4.0, 2.0, 1.0]),
            curve(&[2.0, 1.0, 0.5, 0.25]),
            curve(&[8.0, 4.0, 3.0, 3.0]),
        ];
        let said = |i| comparison(&variants, &curves, i, Cost::Seconds, Measure::Whole);
        assert_eq!(said(0), None);
        assert_eq!(said(1).unwrap(), "reaches bdpt's 8.0 s error in 2.0 s");
        assert_eq!(said(2).unwrap(), "ends at 3.00 times bdpt's 8.0 s error");
        assert_eq!(
            legend(&variants, &curves, 1, Cost::Rays, Measure::Trimmed),
            "pssmlt: slope -1.00, reaches bdpt's 8.0e6 rays error in 2.0e6 rays"
        );
        let svg = convergence_chart("title", &variants, &curves, Some(0.1)).unwrap();
        assert!(svg.contains("the reference&apos;s own error"), "{svg}");
        assert!(convergence_chart("title", &variants, &[], None).is_ok());
    }
}
