//! `shape`: surfaces.

mod instance;
mod mesh;
mod round;
mod sphere;
mod to_world;

use glam::DMat4;

use super::builder::Builder;
use super::error::{Faults, LoadError, shown};
use super::xml::{Object, Tag};
use super::{bsdf, emitter};
use crate::scene::{ShapeDescription, ShapeGeometry};

/// Makes the geometry of a shape in its local coordinates.
type Constructor = fn(&mut Builder, &Object) -> Result<ShapeGeometry, LoadError>;

/// The shapes, besides groups and their instances.
const PLUGINS: [(&str, Constructor); 8] = [
    ("cube", mesh::cube),
    ("cylinder", round::cylinder),
    ("disk", round::disk),
    ("obj", mesh::obj),
    ("ply", mesh::ply),
    ("rectangle", mesh::rectangle),
    ("serialized", mesh::serialized),
    ("sphere", sphere::sphere),
];

/// Adds the shape at `index` to the scene. A group has no place of its own.
pub fn shape(builder: &mut Builder, index: usize) -> Result<(), LoadError> {
    match builder.object(index).plugin.as_str() {
        instance::GROUP => instance::check_group(builder, index),
        instance::INSTANCE => instance::instance(builder, index),
        _ => placed(builder, index, DMat4::IDENTITY),
    }
}

/// Adds the shape at `index`, placed by `parent` after its own transform.
fn placed(builder: &mut Builder, index: usize, parent: DMat4) -> Result<(), LoadError> {
    let object = builder.object(index);
    let constructor = object.find_plugin(&PLUGINS)?;
    // Whatever is wrong with one part, the others are looked at.
    let mut faults = Faults::default();
    let to_world = faults.check(to_world::to_world(object));
    let geometry = faults.check(constructor(builder, object));
    let emitter = faults.check(builder.child(object, Tag::Emitter)).flatten();
    let emission = emitter.map(|index| emitter::area_radiance(builder, index));
    let emission = emission.and_then(|radiance| faults.check(radiance));
    let material = match faults.check(builder.child(object, Tag::Bsdf)).flatten() {
        Some(index) => faults.check(bsdf::material(builder, index)),
        None => Some(bsdf::default_material(builder, emitter.is_some())),
    };
    let flip_normals = faults.check(object.boolean("flip_normals", false));
    object.ignore(&["silhouette_sampling_weight"]);
    faults.check(builder.finish(object));
    let parts = (|| Some((geometry?, to_world?, flip_normals?, material?)))();
    let Some((geometry, to_world, flip_normals, material)) = faults.or(parts)? else {
        return Ok(());
    };
    builder.shapes.push(ShapeDescription {
        name: name(object),
        geometry,
        to_world: parent * to_world,
        flip_normals,
        material,
        emission,
    });
    Ok(())
}

/// `shape "Floor" (scene.xml:12:3)`, or the type in place of the id if there is none.
fn name(object: &Object) -> String {
    match &object.id {
        Some(id) => format!("shape \"{}\" ({})", shown(id), object.place),
        None => format!("shape of type {} ({})", object.plugin, object.place),
    }
}
