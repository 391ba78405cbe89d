//! `sensor`: pinhole, thin-lens and orthographic cameras.

use glam::{DMat3, DMat4, DVec2, DVec3, DVec4};

use super::builder::Builder;
use super::error::{LoadError, Located};
use super::field_of_view::horizontal_fov;
use super::film;
use super::xml::{Object, Tag};
use crate::scene::{CameraDescription, FilmSettings, Projection, ThinLens};

/// Maximum deviation of the scalar products of the camera's axes from those of orthonormal axes.
const MAX_AXIS_ERROR: f64 = 1e-3;

/// Largest shift of a film, in widths and heights of it. Beyond it f32 has too few digits for film positions.
const MAX_PRINCIPAL_POINT_OFFSET: f64 = 100.0;

/// The sensors.
const PLUGINS: [(&str, Kind); 3] = [
    ("orthographic", Kind::Orthographic),
    ("perspective", Kind::Pinhole),
    ("thinlens", Kind::ThinLens),
];

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Orthographic,
    Pinhole,
    ThinLens,
}

/// The camera at `index` and its film.
pub fn sensor(
    builder: &mut Builder,
    index: usize,
) -> Result<(CameraDescription, FilmSettings), LoadError> {
    let object = builder.object(index);
    let kind = object.find_plugin(&PLUGINS)?;
    let film = builder.child(object, Tag::Film)?;
    let filter = builder.child(object, Tag::Rfilter)?;
    let film = film::film(builder, film, filter)?;
    let aspect = f64::from(film.width) / f64::from(film.height);
    let positive = |x: f64| x > 0.0;
    let near_clip = object.float_in("near_clip", 1e-2, "above 0", positive)?;
    let far_clip = object.float_in("far_clip", 1e4, "above `near_clip`", |x| x > near_clip)?;
    if far_clip <= near_clip {
        return Err(object.conflict(format!(
            "`near_clip` {near_clip} is not below `far_clip` {far_clip}"
        )));
    }
    let (to_world, scale) = to_world(object, kind)?;
    let camera = CameraDescription {
        to_world,
        projection: match kind {
            // The image is 2 wide before the transform, as in Mitsuba.
            Kind::Orthographic => Projection::Orthographic {
                half_extent: DVec2::new(scale.x, scale.y / aspect),
            },
            Kind::Pinhole => Projection::Perspective {
                fov_x: horizontal_fov(object, aspect)?,
                lens: None,
            },
            Kind::ThinLens => Projection::Perspective {
                fov_x: horizontal_fov(object, aspect)?,
                lens: Some(lens(object, far_clip)?),
            },
        },
        principal_point_offset: principal_point_offset(object, kind)?,
        // Mitsuba scales the distance of an orthographic camera's near plane, but not that between its planes.
        near_clip: near_clip * scale.z,
        far_clip: near_clip * scale.z + (far_clip - near_clip),
    };
    object.ignore(&["shutter_open", "shutter_close", "focus_distance"]);
    // The sampler does not change what the image converges to.
    builder.child(object, Tag::Sampler)?;
    builder.finish(object)?;
    Ok((camera, film))
}

/// A fraction of the width and height of the film.
fn principal_point_offset(object: &Object, kind: Kind) -> Result<DVec2, LoadError> {
    if kind != Kind::Pinhole {
        return Ok(DVec2::ZERO);
    }
    let offset = |name: &str| {
        let is_near = |x: f64| x.abs() <= MAX_PRINCIPAL_POINT_OFFSET;
        let range = format!("at most {MAX_PRINCIPAL_POINT_OFFSET} film widths or heights");
        object.float_in(name, 0.0, &range, is_near)
    };
    let x = offset("principal_point_offset_x")?;
    Ok(DVec2::new(x, offset("principal_point_offset_y")?))
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

/// The transform without scale, and the scale along its axes, which only an orthographic camera may have.
fn to_world(object: &Object, kind: Kind) -> Result<(DMat4, DVec3), LoadError> {
    let Some((matrix, property)) = object.transform("to_world")? else {
        return Ok((DMat4::IDENTITY, DVec3::ONE));
    };
    let m = DMat3::from_mat4(matrix);
    let lengths = DVec3::from_array([m.x_axis, m.y_axis, m.z_axis].map(DVec3::length));
    let scale = match kind {
        Kind::Orthographic if lengths.min_element() > 0.0 => lengths,
        _ => DVec3::ONE,
    };
    let unscaled = matrix * DMat4::from_scale(scale.recip());
    let axes = DMat3::from_mat4(unscaled);
    let gram = axes.transpose() * axes;
    let is_orthogonal = gram.abs_diff_eq(DMat3::IDENTITY, MAX_AXIS_ERROR);
    if is_orthogonal && matrix.row(3) == DVec4::W {
        return Ok((unscaled, scale));
    }
    let feature = "scale and shear in the transform of a sensor; it may only translate, rotate and \
                   reflect, and that of an orthographic one scale along its axes";
    Err(property.not_modelled(feature))
}
