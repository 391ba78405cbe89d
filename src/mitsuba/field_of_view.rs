//! The field of view of cameras and projectors, given as an angle or as a focal length.

use super::error::{Cause, LoadError, Located};
use super::xml::{Object, value};

/// Diagonal of a frame of 35 mm film (36 mm x 24 mm), which `focal_length` refers to, in
/// millimetres.
const FRAME_DIAGONAL: f64 = 43.266_615_305_567_87;
/// Which extent of the image the field of view refers to.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Axis {
    X,
    Y,
    Diagonal,
    Smaller,
    Larger,
}

/// Horizontal field of view in degrees, as Mitsuba 3 derives it from `fov` or `focal_length`.
/// `aspect` is the width of the film over its height.
pub fn horizontal_fov(object: &Object, aspect: f64) -> Result<f64, LoadError> {
    let is_angle = |x: f64| x > 0.0 && x < 180.0;
    // The tangent of half the field of view along an axis.
    let (half, axis) = if object.find("fov").is_some() {
        if let Some(property) = object.find("focal_length") {
            return Err(property.conflict("give either `fov` or `focal_length`, not both"));
        }
        let range = "above 0 and below 180 degrees";
        let fov = object.float_in("fov", 0.0, range, is_angle)?;
        let axis = object.choice(
            "fov_axis",
            Axis::X,
            &[
                ("x", Axis::X),
                ("y", Axis::Y),
                ("diagonal", Axis::Diagonal),
                ("smaller", Axis::Smaller),
                ("larger", Axis::Larger),
            ],
        )?;
        ((0.5 * fov).to_radians().tan(), axis)
    } else {
        let millimetres = focal_length(object)?;
        (FRAME_DIAGONAL / (2.0 * millimetres), Axis::Diagonal)
    };
    let is_wide = aspect > 1.0;
    let half_width = match axis {
        Axis::X => half,
        Axis::Y => half * aspect,
        Axis::Diagonal => half / (1.0 + aspect.powi(-2)).sqrt(),
        Axis::Smaller if is_wide => half * aspect,
        Axis::Larger if !is_wide => half * aspect,
        Axis::Smaller | Axis::Larger => half,
    };
    let fov_x = (2.0 * half_width.atan()).to_degrees();
    if is_angle(fov_x) {
        return Ok(fov_x);
    }
    Err(object.error(Cause::OutOfRange {
        name: "horizontal field of view".into(),
        found: fov_x.to_string(),
        range: "above 0 and below 180 degrees".into(),
    }))
}

/// In millimetres; written `50mm` or `50`.
fn focal_length(object: &Object) -> Result<f64, LoadError> {
    let Some((text, property)) = object.text("focal_length")? else {
        return Ok(50.0);
    };
    let number = text.trim().strip_suffix("mm").unwrap_or(text);
    let length = value::float(number).ok().filter(|&x| x > 0.0);
    length.ok_or_else(|| property.error(value::malformed(text, "a length such as `50mm`")))
}
