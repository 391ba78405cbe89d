//! Numbers and times for people to read.

/// A number with three digits and an SI prefix: `1.23 M`.
pub fn quantity(number: f64) -> String {
    let (scale, suffix) = match number {
        n if n >= 1e9 => (1e9, " G"),
        n if n >= 1e6 => (1e6, " M"),
        n if n >= 1e4 => (1e3, " k"),
        _ => return format!("{number:.0}"),
    };
    let scaled = number / scale;
    let decimals = match scaled {
        s if s < 9.995 => 2,
        s if s < 99.95 => 1,
        _ => 0,
    };
    format!("{scaled:.decimals$}{suffix}")
}

/// A number with three digits, in scientific notation if it would be long: `0.0123`, `4.56e-5`.
pub fn digits(number: f64) -> String {
    let magnitude = number.abs().log10().floor();
    if number == 0.0 {
        "0".into()
    } else if (-3.0..4.0).contains(&magnitude) {
        format!("{number:.*}", (2.0 - magnitude).max(0.0) as usize)
    } else {
        format!("{number:.2e}")
    }
}

/// A number with seven digits; an integer with all of its digits.
pub fn short(number: f64) -> String {
    match number.abs() {
        size if size < 1e15 && number.fract() == 0.0 => number.to_string(),
        size if (1e-4..1e9).contains(&size) => (number as f32).to_string(),
        _ => format!("{number:.6e}"),
    }
}

/// A time in seconds, in suitable units: `1 h 02 min`, `3 min 20 s`, `12.3 s`, `45 ms`.
pub fn duration(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    match seconds {
        s if s < 0.9995 => format!("{:.0} ms", 1000.0 * s),
        s if s < 59.95 => format!("{s:.1} s"),
        s if s < 3599.5 => format!("{} min {:02} s", whole / 60, whole % 60),
        _ => format!("{} h {:02} min", whole / 3600, whole % 3600 / 60),
    }
}

#[cfg(test)]
mod tests {
    use super::{digits, duration, quantity, short};

    #[test]
    fn numbers_and_times_are_rounded() {
        for (number, expected) in [
            (0.0, "0"),
            (9999.0, "9999"),
            (12_345.0, "12.3 k"),
            (999_600.0, "1000 k"),
            (1_234_567.0, "1.23 M"),
            (123.4e9, "123 G"),
        ] {
            assert_eq!(quantity(number), expected);
        }
        for (number, expected) in [
            (0.0, "0"),
            (15.91, "15.9"),
            (0.001_234, "0.00123"),
            (-1234.5, "-1234"),
            (4.567e-5, "4.57e-5"),
            (98765.0, "9.88e4"),
        ] {
            assert_eq!(digits(number), expected);
        }
        for (number, expected) in [
            (20.0, "20"),
            (-4_194_304.0, "-4194304"),
            (f64::from(0.3f32), "0.3"),
            (530_502.175_543, "530502.2"),
            (1.5e-9, "1.500000e-9"),
            (1e300, "1.000000e300"),
        ] {
            assert_eq!(short(number), expected);
        }
        for (seconds, expected) in [
            (0.0123, "12 ms"),
            (0.9996, "1.0 s"),
            (59.96, "1 min 00 s"),
            (200.4, "3 min 20 s"),
            (3599.6, "1 h 00 min"),
            (7325.0, "2 h 02 min"),
        ] {
            assert_eq!(duration(seconds), expected);
        }
    }
}
