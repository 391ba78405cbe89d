//! Parsers of argument values. Their messages say what was expected.

use std::fmt::Display;
use std::path::PathBuf;
use std::str::FromStr;

use clap::builder::{PathBufValueParser, TypedValueParser};
use metrolight::markov::Perturbation;
use metrolight::mitsuba::MAX_PIXELS;
use metrolight::render::{MAX_CHAINS, MAX_PILOT_SAMPLES};

/// A time in seconds, from `60`, `60s`, `2m` or `1.5h`.
pub fn seconds(text: &str) -> Result<f64, String> {
    let (number, unit) = match text.char_indices().next_back() {
        Some((i, 's')) => (&text[..i], 1.0),
        Some((i, 'm')) => (&text[..i], 60.0),
        Some((i, 'h')) => (&text[..i], 3600.0),
        _ => (text, 1.0),
    };
    match number.parse::<f64>() {
        Ok(value) if value > 0.0 && value * unit <= MAX_SECONDS => Ok(value * unit),
        Ok(value) if value > 0.0 => Err("expected at most 100000h".into()),
        _ => Err("expected a time above 0, such as 60s, 2m, 1.5h or 90".into()),
    }
}

/// Longest time that can be asked for: more than eleven years.
const MAX_SECONDS: f64 = 3600.0 * 100_000.0;

/// When a render is saved while it runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SaveEvery {
    /// From time to time, if it is long.
    Default,
    /// Never.
    Never,
    /// With this time between two saves, in seconds.
    Seconds(f64),
}

/// A time between saves, or `never`.
pub fn save_every(text: &str) -> Result<SaveEvery, String> {
    match text {
        "never" => Ok(SaveEvery::Never),
        _ => match seconds(text) {
            Ok(value) if value <= MAX_SECONDS => Ok(SaveEvery::Seconds(value)),
            _ => Err("expected a time above 0, such as 60s, 2m or 1.5h, or never".into()),
        },
    }
}

/// Width and height, from `640x480`.
pub fn size(text: &str) -> Result<[u32; 2], String> {
    let pixels = |side: &str| side.parse().ok().filter(|&n: &u32| n > 0);
    let size = text.split_once('x');
    let size = size.and_then(|(width, height)| Some([pixels(width)?, pixels(height)?]));
    match size {
        Some(size) if size.map(u64::from).iter().product::<u64>() <= MAX_PIXELS => Ok(size),
        Some(_) => Err(format!("expected at most {MAX_PIXELS} pixels in all")),
        None => Err("expected width and height in pixels, both at least 1, such as 640x480".into()),
    }
}

/// The value of `text` if it can be parsed and is accepted.
fn parse<T: FromStr>(
    text: &str,
    accepts: impl Fn(&T) -> bool,
    expected: impl Display,
) -> Result<T, String> {
    let value = text.parse().ok().filter(accepts);
    value.ok_or_else(|| format!("expected {expected}"))
}

/// An exposure in stops: each doubles the brightness.
pub fn stops(text: &str) -> Result<f64, String> {
    let expected = format_args!("a number of stops from -{MAX_STOPS} to {MAX_STOPS}");
    parse(text, |stops: &f64| stops.abs() <= MAX_STOPS, expected)
}

/// Larger exposures turn every image white or black.
const MAX_STOPS: f64 = 60.0;

/// A number from 0 to 1.
pub fn probability(text: &str) -> Result<f32, String> {
    parse(text, |p| (0.0..=1.0).contains(p), "a number from 0 to 1")
}

/// A small step: log-uniform between two lengths, or Gaussian.
pub fn small_step(text: &str) -> Result<Perturbation, String> {
    let length = |text: &str| {
        let parsed: Option<f32> = text.parse().ok();
        parsed.filter(|length| (1e-7..=0.5).contains(length))
    };
    let parts: Vec<&str> = text.split(':').collect();
    let step = match parts[..] {
        ["log", shortest, longest] => match (length(shortest), length(longest)) {
            (Some(a), Some(b)) if a <= b => Some(Perturbation::new(a, b)),
            _ => None,
        },
        ["gaussian", deviation] => {
            length(deviation).map(|deviation| Perturbation::Gaussian { deviation })
        }
        _ => None,
    };
    step.ok_or_else(|| {
        "expected log:SHORTEST:LONGEST or gaussian:DEVIATION with lengths from 1e-7 to 0.5, such as \
         log:0.001:0.016"
            .into()
    })
}

/// A brightness above which chains take over.
pub fn threshold(text: &str) -> Result<f32, String> {
    let accepts = |t: &f32| *t >= 0.0 && t.is_finite();
    parse(text, accepts, "a number of at least 0")
}

/// Greatest number of samples, mutations or steps: more than a thousand years of the fastest machine.
const MAX_COUNT: u64 = 1 << 62;

/// Greatest number of bootstrap samples, of which each is stored.
const MAX_BOOTSTRAP: u64 = 1 << 32;

/// Greatest number of renders of an integrator.
const MAX_REPEATS: u64 = 10_000;

/// Greatest number of steps of a chain that is diagnosed, of which each is stored.
const MAX_STEPS: u64 = 1 << 24;

/// Greatest number of edges whose techniques are rendered one by one: 650 images.
const MAX_EDGES: u32 = 24;

fn count(text: &str, max: u64) -> Result<u64, String> {
    let accepts = |n: &u64| (1..=max).contains(n);
    parse(text, accepts, format_args!("an integer from 1 to {max}"))
}

/// A number of samples or mutations.
pub fn samples(text: &str) -> Result<u64, String> {
    count(text, MAX_COUNT)
}

/// A number of bootstrap samples.
pub fn bootstrap(text: &str) -> Result<u64, String> {
    count(text, MAX_BOOTSTRAP)
}

/// A number of repetitions, or a multiple of the work of one.
pub fn repeats(text: &str) -> Result<u64, String> {
    count(text, MAX_REPEATS)
}

/// A number of steps of a chain.
pub fn steps(text: &str) -> Result<u64, String> {
    count(text, MAX_STEPS)
}

/// A number of edges up to which every technique is rendered; -1 is an error of its own.
pub fn edges(text: &str) -> Result<MaxDepth, String> {
    match max_depth(text)? {
        MaxDepth(Some(edges)) if edges > MAX_EDGES => Err(format!(
            "expected at most {MAX_EDGES} edges, since each path length has its own techniques"
        )),
        other => Ok(other),
    }
}

/// A number of Markov chains.
pub fn chains(text: &str) -> Result<u64, String> {
    let expected = format_args!("a number of chains from 1 to {MAX_CHAINS}");
    parse(text, |n| (1..=MAX_CHAINS).contains(n), expected)
}

/// A number of samples of a pilot.
pub fn pilot(text: &str) -> Result<u64, String> {
    let expected = format_args!("a number of samples from 1 to {MAX_PILOT_SAMPLES}");
    parse(text, |n| (1..=MAX_PILOT_SAMPLES).contains(n), expected)
}

/// A number of threads.
pub fn threads(text: &str) -> Result<usize, String> {
    let expected = format_args!("a number of threads from 1 to {MAX_THREADS}");
    parse(text, |n| (1..=MAX_THREADS).contains(n), expected)
}

/// The operating system refuses to start many more.
const MAX_THREADS: usize = 512;

/// A significance level.
pub fn level(text: &str) -> Result<f64, String> {
    let accepts = |a: &f64| *a > 0.0 && *a < 1.0;
    parse(text, accepts, "a number between 0 and 1, such as 1e-3")
}

/// A relMSE at which a render stops.
pub fn target_error(text: &str) -> Result<f64, String> {
    let accepts = |e: &f64| *e > 0.0 && e.is_finite();
    parse(text, accepts, "a relMSE above 0, such as 0.01")
}

/// Maximum number of edges of a path; `None` for no limit, which is written -1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MaxDepth(pub Option<u32>);

/// A maximum number of edges.
pub fn max_depth(text: &str) -> Result<MaxDepth, String> {
    match text.parse::<i64>() {
        Ok(-1) => Ok(MaxDepth(None)),
        Ok(depth @ 1..=0xffff_ffff) => Ok(MaxDepth(Some(depth as u32))),
        _ => Err("expected a number of edges, at least 1, or -1 for no limit".into()),
    }
}

/// A variable of the scene and its value, from `name=value`.
pub fn define(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.is_empty() => Ok((name.into(), value.into())),
        _ => Err("expected a name and a value: name=value".into()),
    }
}

/// The parser of a path that ends in `.exr`.
pub fn exr_path() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(|given| path(given, "exr"))
}

/// The parser of a path that ends in `.html`.
pub fn html_path() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(|given| path(given, "html"))
}

fn path(path: PathBuf, extension: &str) -> Result<PathBuf, String> {
    match path.extension() {
        Some(found) if found.eq_ignore_ascii_case(extension) => Ok(path),
        _ => Err(format!("expected a name that ends in .{extension}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_units() {
        for (text, expected) in [("60", 60.0), ("0.5s", 0.5), ("2m", 120.0), ("1.5h", 5400.0)] {
            assert_eq!(seconds(text), Ok(expected), "{text}");
        }
        for text in ["", "s", "0", "-1s", "inf", "nan", "1d", "1 s", "2ms", "é"] {
            assert!(seconds(text).is_err(), "{text}");
        }
    }

    #[test]
    fn sizes_are_positive() {
        assert_eq!(size("640x480"), Ok([640, 480]));
        assert_eq!(size("16384x16384"), Ok([16384; 2]));
        for text in [
            "",
            "640",
            "0x4",
            "4x0",
            "-4x4",
            "4x4x4",
            "4X",
            "99999999999x1",
            "32768x16384",
        ] {
            assert!(size(text).is_err(), "{text}");
        }
    }

    #[test]
    fn numbers_stay_in_range() {
        assert_eq!(stops("-1.5"), Ok(-1.5));
        assert!(stops("nan").is_err() && stops("1e9").is_err());
        assert_eq!(probability("0.3"), Ok(0.3));
        assert_eq!(probability("1"), Ok(1.0));
        assert_eq!(target_error("1e-3"), Ok(1e-3));
        assert!(
            ["0", "-1", "inf", "nan", "1%"]
                .iter()
                .all(|e| target_error(e).is_err())
        );
        assert_eq!(max_depth("-1"), Ok(MaxDepth(None)));
        assert_eq!(max_depth("12"), Ok(MaxDepth(Some(12))));
        assert!(
            ["1.1", "-0.1", "nan", "x"]
                .iter()
                .all(|p| probability(p).is_err())
        );
        assert!(
            ["0", "-2", "4294967296", "x"]
                .iter()
                .all(|d| max_depth(d).is_err())
        );
    }

    #[test]
    fn definitions_and_outputs_are_checked() {
        assert_eq!(define("a=b=c"), Ok(("a".into(), "b=c".into())));
        assert_eq!(define("a="), Ok(("a".into(), String::new())));
        assert!(define("a").is_err() && define("=b").is_err());
        let accepts = |name: &str, extension| path(name.into(), extension).is_ok();
        assert!(accepts("out/a.EXR", "exr"));
        assert!(!accepts("out/", "exr") && !accepts("a.png", "exr"));
        assert!(accepts("a.HTML", "html") && !accepts("convergence.svg", "html"));
    }
}
