//! `sensor`: pinhole and thin-lens cameras.

use glam::{DMat3, DMat4, DVec4};

use super::builder::Builder;
use super::error::{Cause, LoadError, Located};
use super::film;
use super::xml::{Object, Tag, value};
use crate::scene::{CameraDescription, FilmSettings, ThinLens};

/// Diagonal of a frame of 35 mm film (36 mm x 24 mm), which `focal_length` refers to, in
/// millimetres.
const FRAME_DIAGONAL: f64 = 43.266_615_305_567_87;
/// Maximum deviation of the scalar products of the camera's axes from those of orthonormal axes.
const MAX_AXIS_ERROR: f64 = 1e-3;

/// The sensors. True for those with a lens.
const PLUGINS: [(&str, bool); 2] = [("perspective", false), ("thinlens", true)];

/// Which extent of the image the field of view refers to.
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
    builder: &Builder,
    index: usize,
) -> Result<(CameraDescription, FilmSettings), LoadError> {
    let object = builder.object(index);
    let has_lens = object.find_plugin(&PLUGINS)?;
    let film = film::film(builder, builder.child(object, Tag::Film)?)?;
    let aspect = f64::from(film.width) / f64::from(film.height);
    let positive = |x: f64| x > 0.0;
    let near_clip = object.float_in("near_clip", 1e-2, "above 0", positive)?;
    let far_clip = object.float_in("far_clip", 1e4, "above `near_clip`", |x| x > near_clip)?;
    if far_clip <= near_clip {
        return Err(object.conflict(format!(
            "`near_clip` {near_clip} is not below `far_clip` {far_clip}"
        )));
    }
    let lens = if has_lens {
        Some(lens(object, far_clip)?)
    } else {
        None
    };
    let camera = CameraDescription {
        to_world: to_world(object)?,
        fov_x: horizontal_fov(object, aspect)?,
        near_clip,
        far_clip,
        lens,
    };
    for name in ["principal_point_offset_x", "principal_point_offset_y"] {
        object.float_in(name, 0.0, "0: a shifted film is not supported", |x| {
            x == 0.0
        })?;
    }
    object.ignore(&["shutter_open", "shutter_close", "focus_distance"]);
    // The sampler does not change what the image converges to.
    builder.child(object, Tag::Sampler)?;
    builder.finish(object)?;
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
    let Some((matrix, property)) = object.transform("to_world")? else {
        return Ok(DMat4::IDENTITY);
    };
    let m = DMat3::from_mat4(matrix);
    let gram = m.transpose() * m;
    let is_orthogonal = gram.abs_diff_eq(DMat3::IDENTITY, MAX_AXIS_ERROR);
    let is_affine = matrix.row(3) == DVec4::W;
    if is_orthogonal && is_affine {
        return Ok(matrix);
    }
    let feature = "scale and shear in the transform of a sensor; it may only translate, rotate and \
                   reflect";
    Err(property.not_modelled(feature))
}

/// Horizontal field of view in degrees, as Mitsuba 3 derives it from `fov` or `focal_length`.
/// `aspect` is the width of the film over its height.
fn horizontal_fov(object: &Object, aspect: f64) -> Result<f64, LoadError> {
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
