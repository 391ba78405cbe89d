//! `emitter`: lights that are not surfaces, and the radiance of those that are.

use glam::{DMat3, DMat4, DVec3};

use super::color::{self, Quantity};
use super::error::{Cause, LoadError};
use super::object::Object;
use super::property::Value;
use super::scene::Builder;
use super::texture;
use crate::film::Decode;
use crate::math::Rgb;
use crate::scene::EmitterDescription;

const KNOWN: [&str; 5] = ["area", "constant", "directional", "envmap", "point"];

/// Adds the emitter at `index` to the scene.
pub fn emitter(builder: &mut Builder, index: usize) -> Result<(), LoadError> {
    let object = builder.object(index);
    // How often an emitter is sampled has no influence on what is estimated.
    object.ignore(&["sampling_weight"]);
    let emitter = match object.plugin.as_str() {
        "point" => EmitterDescription::Point {
            position: place(object, "position", |m| m.transform_point3(DVec3::ZERO))?,
            intensity: emission(object, "intensity")?,
        },
        "directional" => EmitterDescription::Directional {
            direction: direction(object)?,
            irradiance: emission(object, "irradiance")?,
        },
        "constant" => {
            object.ignore(&["to_world"]);
            EmitterDescription::Constant {
                radiance: emission(object, "radiance")?,
            }
        }
        "envmap" => environment(builder, object)?,
        "area" => {
            let problem = "an area emitter belongs into the shape that shines";
            return Err(object.error(Cause::Conflict(problem.into())));
        }
        _ => return Err(object.unknown_plugin(&KNOWN)),
    };
    builder.finish(object)?;
    builder.emitters.push(emitter);
    Ok(())
}

/// Radiance of the area emitter at `index`, which stands in a shape.
pub fn area_radiance(builder: &Builder, index: usize) -> Result<Rgb, LoadError> {
    let object = builder.object(index);
    match object.plugin.as_str() {
        "area" => {}
        name if KNOWN.contains(&name) => {
            let problem = format!("emitter `{name}` cannot stand in a shape; only `area` can");
            return Err(object.error(Cause::Conflict(problem)));
        }
        _ => return Err(object.unknown_plugin(&KNOWN)),
    }
    object.ignore(&["sampling_weight"]);
    let radiance = emission(object, "radiance")?;
    builder.finish(object)?;
    Ok(radiance)
}

fn emission(object: &Object, name: &str) -> Result<Rgb, LoadError> {
    match object.find(name) {
        Some(property) if matches!(property.value, Value::Object(_)) => {
            let what = "light that varies over an emitter; give a colour";
            Err(property.error(Cause::NotModelled(what.into())))
        }
        _ => color::color(object, name, Quantity::Emission, 1.0),
    }
}

/// The vector `name`, or what `of_transform` makes of `to_world`.
fn place(
    object: &Object,
    name: &str,
    of_transform: impl Fn(DMat4) -> DVec3,
) -> Result<DVec3, LoadError> {
    match (object.vector(name)?, object.find("to_world")) {
        (Some(vector), None) => Ok(vector),
        (None, _) => Ok(of_transform(object.transform("to_world")?)),
        (Some(_), Some(property)) => {
            let problem = format!("give either `{name}` or `to_world`, not both");
            Err(property.error(Cause::Conflict(problem)))
        }
    }
}

fn direction(object: &Object) -> Result<DVec3, LoadError> {
    let direction = place(object, "direction", |m| m.transform_vector3(DVec3::Z))?;
    match direction.try_normalize() {
        Some(direction) => Ok(direction),
        None => Err(object.error(Cause::OutOfRange {
            name: "direction".into(),
            found: "zero".into(),
            range: "a vector with a direction".into(),
        })),
    }
}

fn environment(builder: &Builder, object: &Object) -> Result<EmitterDescription, LoadError> {
    let is_valid = |x: f64| x >= 0.0 && x <= f64::from(f32::MAX);
    let scale = object.float_in("scale", 1.0, "0 or above", is_valid)?;
    let to_world = object.transform("to_world")?;
    if let Some(property) = object.find("to_world")
        && !turns_only(to_world)
    {
        let what = "a sky that is stretched or sheared; the transform may turn and mirror";
        return Err(property.error(Cause::NotModelled(what.into())));
    }
    object.ignore(&["mis_compensation"]);
    let is_radiance = |x: f32| x >= 0.0 && x.is_finite();
    let range = "0 or above, and finite";
    let image = texture::image(builder, object, Decode::Srgb, range, is_radiance)?;
    Ok(EmitterDescription::Environment {
        width: image.width,
        pixels: image.pixels,
        scale: scale as f32,
        to_world,
    })
}

/// True for a rotation, with or without mirroring, even scale and translation.
fn turns_only(m: DMat4) -> bool {
    let m = DMat3::from_mat4(m);
    let gram = m.transpose() * m;
    let scale = gram.x_axis.x;
    scale > 0.0 && (gram / scale).abs_diff_eq(DMat3::IDENTITY, 1e-3)
}
