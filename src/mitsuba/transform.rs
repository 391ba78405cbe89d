//! `<transform>`: a list of steps, each applied after those above it, all in f64.

use glam::{DMat3, DMat4, DVec3, DVec4};

use super::attributes::Attributes;
use super::error::{Cause, LoadError, Warning};
use super::value;

/// The steps there are.
pub const STEPS: [&str; 5] = ["lookat", "matrix", "rotate", "scale", "translate"];

/// Departure of an axis from unit length that is worth a warning.
const UNEVENNESS: f64 = 1e-3;

/// The matrix of one step named `step`; `None` if there is no such step. `legacy` says that the file
/// is of version 0.x, where `lookat` is spelled `lookAt`.
pub fn step(
    step: &str,
    attributes: &mut Attributes,
    legacy: bool,
    warnings: &mut Vec<Warning>,
) -> Result<Option<DMat4>, LoadError> {
    Ok(Some(match step {
        "translate" => DMat4::from_translation(xyz(attributes, 0.0)?),
        "scale" => DMat4::from_scale(xyz(attributes, 1.0)?),
        "rotate" => rotate(attributes, warnings)?,
        "matrix" => attributes.parse("value", matrix)?,
        "lookat" => look_at(attributes)?,
        "lookAt" if legacy => look_at(attributes)?,
        _ => return Ok(None),
    }))
}

/// `value` with one or three numbers, or any of `x`, `y` and `z`; what is absent is `default`.
fn xyz(attributes: &mut Attributes, default: f64) -> Result<DVec3, LoadError> {
    let value = attributes.parse_optional("value", value::one_or_three)?;
    let mut result = value.unwrap_or(DVec3::splat(default));
    for (i, axis) in ["x", "y", "z"].into_iter().enumerate() {
        if let Some(number) = attributes.parse_optional(axis, value::float)? {
            if value.is_some() {
                return Err(attributes.error(Cause::Conflict(format!(
                    "give either `value` or `x`, `y` and `z`, not `value` and `{axis}`"
                ))));
            }
            result[i] = number;
        }
    }
    Ok(result)
}

fn rotate(attributes: &mut Attributes, warnings: &mut Vec<Warning>) -> Result<DMat4, LoadError> {
    let degrees: f64 = attributes.parse("angle", value::float)?;
    let axis = xyz(attributes, 0.0)?;
    if axis != DVec3::ZERO && (axis.length() - 1.0).abs() > UNEVENNESS {
        warnings.push(Warning {
            place: Some(attributes.place().clone()),
            text:
                "the axis is not of unit length: this turns about its direction, while Mitsuba 3 \
                   stretches as well"
                    .into(),
        });
    }
    let axis = axis.try_normalize().ok_or_else(|| {
        attributes.error(Cause::OutOfRange {
            name: "axis".into(),
            found: "zero".into(),
            range: "a vector with a direction".into(),
        })
    })?;
    Ok(DMat4::from_axis_angle(axis, degrees.to_radians()))
}

/// 16 numbers, row by row; or 9 for a linear map.
fn matrix(text: &str) -> Result<DMat4, Cause> {
    let numbers = value::floats(text)?;
    match numbers.len() {
        16 => {
            let row = |i: usize| DVec4::from_slice(&numbers[4 * i..]);
            Ok(DMat4::from_cols(row(0), row(1), row(2), row(3)).transpose())
        }
        9 => {
            let row = |i: usize| DVec3::from_slice(&numbers[3 * i..]);
            let linear = DMat3::from_cols(row(0), row(1), row(2)).transpose();
            Ok(DMat4::from_mat3(linear))
        }
        found => Err(Cause::Malformed {
            text: format!("a list of {found} numbers"),
            expected: "a matrix of 16 or 9 numbers".into(),
        }),
    }
}

/// Looks from `origin` to `target`: +z goes to the target, +x to the left, +y as much up as can be.
fn look_at(attributes: &mut Attributes) -> Result<DMat4, LoadError> {
    let origin = attributes.parse("origin", value::triple)?;
    let target = attributes.parse("target", value::triple)?;
    let up = attributes.parse_optional("up", value::triple)?;
    let degenerate = |what: &str| attributes.error(Cause::Conflict(what.to_owned()));
    let forward = (target - origin)
        .try_normalize()
        .ok_or_else(|| degenerate("`origin` and `target` are the same point"))?;
    let up = up
        .filter(|&up| up != DVec3::ZERO)
        .unwrap_or_else(|| perpendicular(forward));
    let left = up
        .cross(forward)
        .try_normalize()
        .ok_or_else(|| degenerate("`up` is parallel to the line from `origin` to `target`"))?;
    let up = forward.cross(left);
    Ok(DMat4::from_cols(
        left.extend(0.0),
        up.extend(0.0),
        forward.extend(0.0),
        origin.extend(1.0),
    ))
}

/// The first tangent of Duff et al. 2017, "Building an orthonormal basis, revisited", which Mitsuba
/// takes for a missing `up`.
fn perpendicular(n: DVec3) -> DVec3 {
    let sign = 1.0_f64.copysign(n.z);
    let a = -(sign + n.z).recip();
    DVec3::new(
        1.0 + sign * n.x * n.x * a,
        sign * n.x * n.y * a,
        -sign * n.x,
    )
}
