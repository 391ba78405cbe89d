//! `emitter`: light sources that are not surfaces, and the radiance of surfaces.

mod area;
mod constant;
mod directional;
mod envmap;
mod parameters;
mod point;
mod projector;
mod spot;

use super::builder::Builder;
use super::error::{LoadError, Located};
use super::xml::Object;
use crate::scene::{EmitterDescription, Radiance};

type Constructor = fn(&Builder, &Object) -> Result<EmitterDescription, LoadError>;

/// The emitters.
const PLUGINS: [(&str, Constructor); 7] = [
    ("area", area::outside_a_shape),
    ("constant", constant::constant),
    ("directional", directional::directional),
    ("envmap", envmap::envmap),
    ("point", point::point),
    ("projector", projector::projector),
    ("spot", spot::spot),
];

/// Adds the emitter at `index` to the scene.
pub fn emitter(builder: &mut Builder, index: usize) -> Result<(), LoadError> {
    let object = builder.object(index);
    let constructor = object.find_plugin(&PLUGINS)?;
    ignore_weight(object);
    let emitter = constructor(builder, object)?;
    builder.finish(object)?;
    builder.emitters.push(emitter);
    Ok(())
}

/// The radiance of the area emitter at `index`, which is nested in a shape.
pub fn area_radiance(builder: &mut Builder, index: usize) -> Result<Radiance, LoadError> {
    let object = builder.object(index);
    object.find_plugin(&PLUGINS)?;
    if object.plugin != "area" {
        return Err(object.conflict(format!(
            "emitter `{}` cannot be nested in a shape; only `area` can",
            object.plugin
        )));
    }
    ignore_weight(object);
    let radiance = area::radiance(builder, object)?;
    builder.finish(object)?;
    Ok(radiance)
}

/// The probability with which an emitter is sampled does not change what is estimated.
fn ignore_weight(object: &Object) {
    object.ignore(&["sampling_weight"]);
}
