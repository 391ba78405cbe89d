//! Linear RGB with the primaries of sRGB (ITU-R BT.709). A colour has no unit of its own; the code
//! that uses it states its quantity (radiance, importance, reflectance).

use glam::Vec3A;

/// Three linear channels: `x`, `y`, `z` are red, green and blue.
pub type Rgb = Vec3A;

/// Relative luminance of a linear sRGB colour (ITU-R BT.709, section 3.2).
#[inline]
pub fn luminance(rgb: Rgb) -> f32 {
    rgb.dot(Vec3A::new(0.212_671, 0.715_16, 0.072_169))
}

/// True if all channels are finite and nonnegative, as every contribution of light must be.
#[inline]
pub fn is_light(rgb: Rgb) -> bool {
    rgb.is_finite() && rgb.min_element() >= 0.0
}

/// `rgb` with each channel clamped to the largest f32, so that extremely bright light stays finite.
#[inline]
pub fn saturated(rgb: Rgb) -> Rgb {
    rgb.min(Rgb::splat(f32::MAX))
}

/// Converts to f32, clamped to the largest f32.
#[inline]
pub fn to_pixel(rgb: [f64; 3]) -> [f32; 3] {
    rgb.map(|value| value.min(f64::from(f32::MAX)) as f32)
}
