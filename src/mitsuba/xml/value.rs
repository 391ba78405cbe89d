//! Parsing of attribute values.

use glam::DVec3;

use crate::mitsuba::error::Cause;

/// Splits at commas and white space, as Mitsuba does.
pub fn tokens(text: &str) -> Vec<&str> {
    text.split(|c: char| c == ',' || c.is_ascii_whitespace())
        .filter(|token| !token.is_empty())
        .collect()
}

/// A finite number.
pub fn float(text: &str) -> Result<f64, Cause> {
    let number = text.trim().parse::<f64>().ok();
    number
        .filter(|x| x.is_finite())
        .ok_or_else(|| malformed(text, "a finite number"))
}

/// A whole number.
pub fn integer(text: &str) -> Result<i64, Cause> {
    let number = text.trim().parse();
    number.map_err(|_| malformed(text, "a whole number"))
}

/// `true` or `false`, in any case.
pub fn boolean(text: &str) -> Result<bool, Cause> {
    match text.to_ascii_lowercase().as_str() {
        "true" => Ok(true),
        "false" => Ok(false),
        _ => Err(malformed(text, "`true` or `false`")),
    }
}

/// Exactly three numbers.
pub fn triple(text: &str) -> Result<DVec3, Cause> {
    match floats(text)?[..] {
        [x, y, z] => Ok(DVec3::new(x, y, z)),
        _ => Err(malformed(text, "three numbers")),
    }
}

/// Three numbers, or one for all three.
pub fn one_or_three(text: &str) -> Result<DVec3, Cause> {
    match floats(text)?[..] {
        [x] => Ok(DVec3::splat(x)),
        [x, y, z] => Ok(DVec3::new(x, y, z)),
        _ => Err(malformed(text, "one or three numbers")),
    }
}

/// Any number of numbers.
pub fn floats(text: &str) -> Result<Vec<f64>, Cause> {
    tokens(text).into_iter().map(float).collect()
}

/// `text` is not what was `expected`.
pub fn malformed(text: &str, expected: &str) -> Cause {
    /// Longest part of the text that the message quotes, in characters.
    const MAX_SHOWN: usize = 60;
    let mut shown: String = text.chars().take(MAX_SHOWN).collect();
    if shown.len() < text.len() {
        shown.push_str("...");
    }
    Cause::Malformed {
        text: shown,
        expected: expected.to_owned(),
    }
}
