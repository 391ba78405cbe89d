//! `sensor`: pinhole and thin-lens cameras.

use glam::DMat4;

use super::error::{Cause, LoadError};
use super::object::{Object, Tag};
use super::tree::Tree;
use super::{Overrides, film, value};
use crate::scene::{CameraDescription, FilmSettings, ThinLens};

/// Diagonal of a frame of 35 mm film, which `focal_length` refers to, in millimetres: 36 x 24.
const FRAME_DIAGONAL: f64 = 43.266_615_305_567_87;
/// Greatest departure of the camera's axes from unit length and right angles.
const UNEVENNESS: f64 = 1e-3;

#[derive(Clone, Copy, PartialEq, Eq)]
enum Axis {
    X,
    Y,
    Diagonal,
    Smaller,
    Larger,
}

/// The camera at `index` and its film.
pub fn sensor(
    tree: &Tree,
    index: usize,
    overrides: Overrides,
) -> Result<(CameraDescription, FilmSettings), LoadError> {
    let object = &tree.objects[index];
    if !["perspective", "thinlens"].contains(&object.plugin.as_str()) {
        return Err(object.unknown_plugin(&["perspective", "thinlens"]));
    }
    let film = film::film(tree, object.child(&tree.objects, Tag::Film)?, overrides)?;
    let aspect = f64::from(film.width) / f64::from(film.height);
    let positive = |x: f64| x > 0.0;
    let near_clip = object.float_in("near_clip", 1e-2, "above 0", positive)?;
    let far_clip = object.float_in("far_clip", 1e4, "above `near_clip`", |x| x > near_clip)?;
    if far_clip <= near_clip {
        let problem = format!("`near_clip` {near_clip} is not below `far_clip` {far_clip}");
        return Err(object.error(Cause::Conflict(problem)));
    }
    let lens = match object.plugin.as_str() {
        "thinlens" => Some(lens(object, far_clip)?),
        _ => None,
    };
    let camera = CameraDescription {
        to_world: to_world(object)?,
        fov_x: horizontal_fov(object, aspect)?,
        near_clip,
        far_clip,
        lens,
    };
    for name in ["principal_point_offset_x", "principal_point_offset_y"] {
        object.float_in(name, 0.0, "0: a shifted film is not modelled", |x| x == 0.0)?;
    }
    object.ignore(&["shutter_open", "shutter_close", "focus_distance"]);
    // A sampler has no influence on what an image converges to.
    object.child(&tree.objects, Tag::Sampler)?;
    object.finish(&tree.objects)?;
    Ok((camera, film))
}

fn lens(object: &Object, far_clip: f64) -> Result<ThinLens, LoadError> {
    if object.find("aperture_radius").is_none() {
        return Err(object.missing("the float `aperture_radius`"));
    }
    let positive = |x: f64| x > 0.0;
    let range = "above 0 (for a pinhole use the sensor `perspective`)";
    let aperture_radius = object.float_in("aperture_radius", 0.0, range, positive)?;
    let focus_distance = object.float_in("focus_distance", far_clip, "above 0", positive)?;
    Ok(ThinLens {
        aperture_radius,
        focus_distance,
    })
}

fn to_world(object: &Object) -> Result<DMat4, LoadError> {
    let matrix = object.transform("to_world")?;
    let m = glam::DMat3::from_mat4(matrix);
    let gram = m.transpose() * m;
    let is_even = gram.abs_diff_eq(glam::DMat3::IDENTITY, UNEVENNESS);
    let is_affine = matrix.row(3) == glam::DVec4::W;
    match object.find("to_world") {
        Some(property) if !(is_even && is_affine) => Err(property.error(Cause::NotModelled(
            "scale and shear in the transform of a sensor; it may move, turn and mirror".into(),
        ))),
        _ => Ok(matrix),
    }
}

/// Horizontal field of view in degrees, as Mitsuba 3 derives it from `fov` or `focal_length` for a
/// film of the given width over height.
fn horizontal_fov(object: &Object, aspect: f64) -> Result<f64, LoadError> {
    let is_angle = |x: f64| x > 0.0 && x < 180.0;
    let (half, axis) = if object.find("fov").is_some() {
        if let Some(property) = object.find("focal_length") {
            let problem = "give either `fov` or `focal_length`, not both";
            return Err(property.error(Cause::Conflict(problem.into())));
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
    let Some(text) = object.text("focal_length")? else {
        return Ok(50.0);
    };
    let number = text.trim().strip_suffix("mm").unwrap_or(text);
    let length = value::float(number).ok().filter(|&x| x > 0.0);
    match (length, object.find("focal_length")) {
        (Some(length), _) => Ok(length),
        (None, Some(property)) => {
            Err(property.error(value::malformed(text, "a length such as `50mm`")))
        }
        (None, None) => Err(object.missing("`focal_length`")),
    }
}
