//! `shape`: surfaces.

mod mesh;
mod sphere;
mod to_world;

use super::builder::Builder;
use super::error::LoadError;
use super::xml::{Object, Tag};
use super::{bsdf, emitter};
use crate::scene::{ShapeDescription, ShapeGeometry};

/// Makes the geometry of a shape in its local coordinates.
type Constructor = fn(&mut Builder, &Object) -> Result<ShapeGeometry, LoadError>;

/// The shapes.
const PLUGINS: [(&str, Constructor); 6] = [
    ("cube", mesh::cube),
    ("obj", mesh::obj),
    ("ply", mesh::ply),
    ("rectangle", mesh::rectangle),
    ("serialized", mesh::serialized),
    ("sphere", sphere::sphere),
];

/// Adds the shape at `index` to the scene.
pub fn shape(builder: &mut Builder, index: usize) -> Result<(), LoadError> {
    let object = builder.object(index);
    let constructor = object.find_plugin(&PLUGINS)?;
    let to_world = to_world::to_world(object)?;
    let geometry = constructor(builder, object)?;
    let emission = match builder.child(object, Tag::Emitter)? {
        Some(index) => Some(emitter::area_radiance(builder, index)?),
        None => None,
    };
    let material = match builder.child(object, Tag::Bsdf)? {
        Some(index) => bsdf::material(builder, index)?,
        None => bsdf::default_material(builder, emission.is_some()),
    };
    let flip_normals = object.boolean("flip_normals", false)?;
    object.ignore(&["silhouette_sampling_weight"]);
    builder.finish(object)?;
    builder.shapes.push(ShapeDescription {
        name: name(object),
        geometry,
        to_world,
        flip_normals,
        material,
        emission,
    });
    Ok(())
}

/// `shape "Floor" (scene.xml:12:3)`, or the type in place of the id if there is none.
fn name(object: &Object) -> String {
    match &object.id {
        Some(id) => format!("shape \"{id}\" ({})", object.place),
        None => format!("shape of type {} ({})", object.plugin, object.place),
    }
}
