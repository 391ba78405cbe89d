//! `<transform>`: a sequence of steps, each applied after those before it, in f64.

use glam::{DMat3, DMat4, DVec3, DVec4};
use roxmltree::Node;

use super::attributes::Attributes;
use super::document::File;
use super::substitution::Substitution;
use super::value;
use crate::mitsuba::error::{Cause, LoadError, Located, Warning};

/// Makes the matrix of a step from the attributes of its element.
type Step = fn(&mut Attributes, &mut Vec<Warning>) -> Result<DMat4, LoadError>;

/// The elements of the steps.
const STEPS: [(&str, Step); 5] = [
    ("lookat", |attributes, _| look_at(attributes)),
    ("matrix", |attributes, _| attributes.parse("value", matrix)),
    ("rotate", rotate),
    ("scale", |attributes, _| {
        Ok(DMat4::from_scale(xyz(attributes, 1.0)?))
    }),
    ("translate", |attributes, _| {
        Ok(DMat4::from_translation(xyz(attributes, 0.0)?))
    }),
];

/// Maximum deviation of an axis from unit length without a warning.
const MAX_LENGTH_ERROR: f64 = 1e-3;

/// The product of the steps in the `<transform>` element `node`.
pub fn transform(
    node: Node,
    file: &File,
    variables: &mut Substitution,
    warnings: &mut Vec<Warning>,
) -> Result<DMat4, LoadError> {
    let mut matrix = DMat4::IDENTITY;
    for child in node.children().filter(Node::is_element) {
        let mut attributes = Attributes::new(child, file, variables)?;
        let name = match child.tag_name().name() {
            "lookAt" if file.legacy => "lookat",
            name => name,
        };
        let Some((_, step)) = STEPS.iter().find(|(known, _)| *known == name) else {
            let known = STEPS.iter().map(|(name, _)| *name);
            return Err(file.unknown_element(child, "transform", known));
        };
        let step = step(&mut attributes, warnings)?;
        file.no_elements_in(child)?;
        attributes.finish()?;
        matrix = step * matrix;
    }
    if matrix.is_finite() {
        return Ok(matrix);
    }
    Err(file.start_tag(node).error(Cause::OutOfRange {
        name: "transform".into(),
        found: "not finite".into(),
        range: "finite".into(),
    }))
}

/// `value` with one or three numbers, or any of `x`, `y` and `z`; the others are `default`.
fn xyz(attributes: &mut Attributes, default: f64) -> Result<DVec3, LoadError> {
    let value = attributes.parse_optional("value", value::one_or_three)?;
    let mut result = value.unwrap_or(DVec3::splat(default));
    for (i, axis) in ["x", "y", "z"].into_iter().enumerate() {
        if let Some(number) = attributes.parse_optional(axis, value::float)? {
            if value.is_some() {
                return Err(attributes.conflict(format!(
                    "give either `value` or `x`, `y` and `z`, not `value` and `{axis}`"
                )));
            }
            result[i] = number;
        }
    }
    Ok(result)
}

/// Rodrigues' formula with the axis as it is given. As in Mitsuba 3, a transform about an axis that is not a
/// unit vector is no rotation: a published scene looks right only so.
fn rotate(attributes: &mut Attributes, warnings: &mut Vec<Warning>) -> Result<DMat4, LoadError> {
    let degrees: f64 = attributes.parse("angle", value::float)?;
    let axis = xyz(attributes, 0.0)?;
    if axis == DVec3::ZERO {
        return Err(attributes.error(Cause::zero_vector("axis")));
    }
    if (axis.length() - 1.0).abs() > MAX_LENGTH_ERROR {
        warnings.push(attributes.warning(
            "the axis is not of unit length: as in Mitsuba 3, this transform also scales; in Mitsuba 0.x \
             it only rotates",
        ));
    }
    let (sin, cos) = degrees.to_radians().sin_cos();
    let column = |e: DVec3| e * cos + axis.cross(e) * sin + axis * (axis.dot(e) * (1.0 - cos));
    Ok(DMat4::from_mat3(DMat3::from_cols(
        column(DVec3::X),
        column(DVec3::Y),
        column(DVec3::Z),
    )))
}

/// 16 numbers in row-major order, or 9 for a linear map.
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

/// Looks from `origin` to `target`: +z points to the target, +x to the left, and +y is the
/// direction orthogonal to both that is closest to `up`.
fn look_at(attributes: &mut Attributes) -> Result<DMat4, LoadError> {
    let origin = attributes.parse("origin", value::triple)?;
    let target = attributes.parse("target", value::triple)?;
    let up = attributes.parse_optional("up", value::triple)?;
    let degenerate = |problem: &str| attributes.conflict(problem);
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
/// uses if `up` is not given.
fn perpendicular(n: DVec3) -> DVec3 {
    let sign = 1.0_f64.copysign(n.z);
    let a = -(sign + n.z).recip();
    DVec3::new(
        1.0 + sign * n.x * n.x * a,
        sign * n.x * n.y * a,
        -sign * n.x,
    )
}
