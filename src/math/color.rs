//! Linear RGB with the primaries of sRGB (ITU-R BT.709) and no unit of its own: what it measures
//! (radiance, importance, reflectance) is said where it is used.

use glam::Vec3A;

/// Three linear channels; `x`, `y`, `z` are red, green and blue.
pub type Rgb = Vec3A;

/// Relative luminance of a linear sRGB colour (ITU-R BT.709, section 3.2).
#[inline]
pub fn luminance(rgb: Rgb) -> f32 {
    rgb.dot(Vec3A::new(0.212_671, 0.715_16, 0.072_169))
}

/// True if no channel is NaN, infinite or negative: what a contribution of light must be.
#[inline]
pub fn is_light(rgb: Rgb) -> bool {
    rgb.is_finite() && rgb.min_element() >= 0.0
}

/// `rgb` with the largest f32 in place of what is beyond it: light so bright stays a number.
#[inline]
pub fn saturated(rgb: Rgb) -> Rgb {
    rgb.min(Rgb::splat(f32::MAX))
}

/// To f32, with its largest number in place of what is beyond it.
#[inline]
pub fn to_pixel(rgb: [f64; 3]) -> [f32; 3] {
    rgb.map(|value| value.min(f64::from(f32::MAX)) as f32)
}
