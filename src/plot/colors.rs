//! Colours that stay apart for every reader.

/// Okabe and Ito's colours ("Color universal design", 2008), which readers without one kind of cone
/// tell apart, less yellow, which white paper swallows.
const SERIES: [[u8; 3]; 7] = [
    [0, 114, 178],
    [213, 94, 0],
    [0, 158, 115],
    [204, 121, 167],
    [86, 180, 233],
    [230, 159, 0],
    [0, 0, 0],
];

/// The colour of series `i`; they repeat after seven.
pub fn series_color(i: usize) -> [u8; 3] {
    SERIES[i % SERIES.len()]
}

/// Nine colours of matplotlib's map "inferno" at equal distances: dark to bright in even steps of
/// perceived lightness, in colour and in grey.
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

/// A false colour for `value` in [0, 1], from black over red to a bright yellow; clamped, and NaN is
/// grey.
pub fn false_color(value: f64) -> [u8; 3] {
    if value.is_nan() {
        return [128; 3];
    }
    let place = value.clamp(0.0, 1.0) * (MAP.len() - 1) as f64;
    let i = (place as usize).min(MAP.len() - 2);
    let share = place - i as f64;
    std::array::from_fn(|c| {
        let [a, b] = [MAP[i][c], MAP[i + 1][c]].map(f64::from);
        (a + share * (b - a)).round() as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn false_colors_grow_brighter_and_never_leave_the_map() {
        let brightness = |v: f64| -> u32 { false_color(v).iter().map(|&c| u32::from(c)).sum() };
        let steps: Vec<u32> = (0..=8).map(|i| brightness(f64::from(i) / 8.0)).collect();
        assert!(steps.is_sorted(), "{steps:?}");
        assert_eq!(false_color(-1.0), MAP[0]);
        assert_eq!(false_color(2.0), MAP[8]);
        assert_eq!(false_color(f64::NAN), [128; 3]);
    }
}
