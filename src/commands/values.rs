//! Values of arguments, with messages that say what would be right.

use std::path::PathBuf;

use metrolight::markov::SmallStep;

/// Seconds, from `60`, `60s`, `2m` or `1.5h`.
pub fn seconds(text: &str) -> Result<f64, String> {
    let (number, unit) = match text.char_indices().next_back() {
        Some((i, 's')) => (&text[..i], 1.0),
        Some((i, 'm')) => (&text[..i], 60.0),
        Some((i, 'h')) => (&text[..i], 3600.0),
        _ => (text, 1.0),
    };
    match number.parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value * unit),
        _ => Err("a time above 0 is needed, such as 60s, 2m, 1.5h or 90".into()),
    }
}

/// Width and height, from `640x480`.
pub fn size(text: &str) -> Result<[u32; 2], String> {
    let pixels = |side: &str| side.parse().ok().filter(|&n: &u32| n > 0);
    text.split_once('x')
        .and_then(|(width, height)| Some([pixels(width)?, pixels(height)?]))
        .ok_or_else(|| "width and height in pixels are needed, both at least 1: 640x480".into())
}

/// Stops of exposure, each twice as bright as the one before.
pub fn stops(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|stops: &f64| stops.abs() <= MOST_STOPS)
        .ok_or_else(|| format!("a number of stops from -{MOST_STOPS} to {MOST_STOPS} is needed"))
}

/// No screen shows the difference beyond.
const MOST_STOPS: f64 = 60.0;

/// A number from 0 to 1.
pub fn probability(text: &str) -> Result<f32, String> {
    text.parse()
        .ok()
        .filter(|p| (0.0..=1.0).contains(p))
        .ok_or_else(|| "a number from 0 to 1 is needed".into())
}

/// A small step: lengths with evenly distributed logarithms between two bounds, or normally
/// distributed ones.
pub fn small_step(text: &str) -> Result<SmallStep, String> {
    let length = |text: &str| {
        let parsed: Option<f32> = text.parse().ok();
        parsed.filter(|length| (1e-7..=0.5).contains(length))
    };
    let parts: Vec<&str> = text.split(':').collect();
    let step = match parts[..] {
        ["log", shortest, longest] => match (length(shortest), length(longest)) {
            (Some(a), Some(b)) if a <= b => Some(SmallStep::new(a, b)),
            _ => None,
        },
        ["gaussian", deviation] => {
            length(deviation).map(|deviation| SmallStep::Gaussian { deviation })
        }
        _ => None,
    };
    step.ok_or_else(|| {
        "log:SHORTEST:LONGEST or gaussian:DEVIATION is needed, with lengths from 1e-7 to 0.5, such \
         as log:0.001:0.016"
            .into()
    })
}

/// A brightness beyond which chains take over.
pub fn threshold(text: &str) -> Result<f32, String> {
    text.parse()
        .ok()
        .filter(|t: &f32| *t >= 0.0 && t.is_finite())
        .ok_or_else(|| "a number from 0 on is needed".into())
}

/// A whole number from 1 on.
pub fn positive(text: &str) -> Result<u64, String> {
    text.parse()
        .ok()
        .filter(|&n: &u64| n > 0)
        .ok_or_else(|| "a whole number from 1 on is needed".into())
}

/// A number of Markov chains.
pub fn chains(text: &str) -> Result<u64, String> {
    text.parse()
        .ok()
        .filter(|n| (1..=MOST_CHAINS).contains(n))
        .ok_or_else(|| format!("a number of chains from 1 to {MOST_CHAINS} is needed"))
}

/// A chain takes some kilobytes.
const MOST_CHAINS: u64 = 1 << 20;

/// A number of threads.
pub fn threads(text: &str) -> Result<usize, String> {
    text.parse()
        .ok()
        .filter(|n| (1..=MOST_THREADS).contains(n))
        .ok_or_else(|| format!("a number of threads from 1 to {MOST_THREADS} is needed"))
}

/// More than any machine has; beyond it the operating system refuses.
const MOST_THREADS: usize = 512;

/// A level of significance.
pub fn level(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|a: &f64| *a > 0.0 && *a < 1.0)
        .ok_or_else(|| "a number between 0 and 1 is needed, such as 1e-3".into())
}

/// A relMSE to stop at.
pub fn target_error(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|e: &f64| *e > 0.0 && e.is_finite())
        .ok_or_else(|| "a relMSE above 0 is needed, such as 0.01".into())
}

/// A limit on the edges of a path; `None` for none, which is written -1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MaxDepth(pub Option<u32>);

/// A limit on the edges of a path.
pub fn max_depth(text: &str) -> Result<MaxDepth, String> {
    match text.parse::<i64>() {
        Ok(-1) => Ok(MaxDepth(None)),
        Ok(depth @ 1..=0xffff_ffff) => Ok(MaxDepth(Some(depth as u32))),
        _ => Err("a number of edges from 1 on is needed, or -1 for no limit".into()),
    }
}

/// A variable of the scene and its value, from `name=value`.
pub fn define(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.is_empty() => Ok((name.into(), value.into())),
        _ => Err("a name and a value are needed: name=value".into()),
    }
}

/// A path that ends in `.exr`.
pub fn exr_path(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let extension = path.extension().unwrap_or_default();
    if extension.eq_ignore_ascii_case("exr") {
        Ok(path)
    } else {
        Err("a name that ends in .exr is needed; the preview beside it ends in .png".into())
    }
}

/// A path that ends in `.html`.
pub fn html_path(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let extension = path.extension().unwrap_or_default();
    if extension.eq_ignore_ascii_case("html") {
        Ok(path)
    } else {
        Err("a name that ends in .html is needed".into())
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
        for text in [
            "",
            "640",
            "0x4",
            "4x0",
            "-4x4",
            "4x4x4",
            "4X",
            "99999999999x1",
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
        assert!(exr_path("out/a.EXR").is_ok());
        assert!(exr_path("out/").is_err() && exr_path("a.png").is_err());
        assert!(html_path("a.HTML").is_ok() && html_path("convergence.svg").is_err());
    }
}
