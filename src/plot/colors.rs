//! Colours that readers with any colour vision can distinguish.

/// The colours of Okabe and Ito ("Color universal design", 2008), which are distinguishable with
/// any kind of colour blindness, without yellow, which is hard to see on white.
const SERIES: [[u8; 3]; 7] = [
    [0, 114, 178],
    [213, 94, 0],
    [0, 158, 115],
    [204, 121, 167],
    [86, 180, 233],
    [230, 159, 0],
    [0, 0, 0],
];

/// The colour of series `i`. Colours repeat after seven.
pub fn series_color(i: usize) -> [u8; 3] {
    SERIES[i % SERIES.len()]
}

/// Nine equidistant colours of matplotlib's colour map "inferno", whose perceived lightness
/// increases uniformly, also when printed in grey.
const MAP: [[u8; 3]; 9] = [
    [0, 0, 4],
    [31, 12, 72],
    [85, 15, 109],
    [136, 34, 106],
    [186, 54, 85],
    [227, 89, 51],
    [249, 140, 10],
    [249, 201, 50],
    [252, 255, 164],
];

/// The false colour of `value`, clamped to [0, 1], from black over red to bright yellow. NaN is
/// grey.
pub fn false_color(value: f64) -> [u8; 3] {
    if value.is_nan() {
        return [128; 3];
    }
    let position = value.clamp(0.0, 1.0) * (MAP.len() - 1) as f64;
    let i = (position as usize).min(MAP.len() - 2);
    let fraction = position - i as f64;
    std::array::from_fn(|c| {
        let [a, b] = [MAP[i][c], MAP[i + 1][c]].map(f64::from);
        (a + fraction * (b - a)).round() as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn false_colors_increase_in_brightness_and_are_clamped() {
        let brightness = |v: f64| -> u32 { false_color(v).iter().map(|&c| u32::from(c)).sum() };
        let steps: Vec<u32> = (0..=8).map(|i| brightness(f64::from(i) / 8.0)).collect();
        assert!(steps.is_sorted(), "{steps:?}");
        assert_eq!(false_color(-1.0), MAP[0]);
        assert_eq!(false_color(2.0), MAP[8]);
        assert_eq!(false_color(f64::NAN), [128; 3]);
    }
}
