//! `shape`: surfaces.

use glam::{DMat3, DMat4, DVec3, DVec4};

use super::error::{Cause, LoadError, Warning};
use super::mesh::{self, MeshError, MeshFile};
use super::object::{Object, Tag};
use super::scene::Builder;
use super::{bsdf, emitter};
use crate::scene::{ShapeDescription, ShapeGeometry, TriangleMesh};

const KNOWN: [&str; 6] = ["cube", "obj", "ply", "rectangle", "serialized", "sphere"];

/// A transform whose determinant is smaller than this, for columns of unit length, is singular.
const FLATTEST: f64 = 1e-12;

/// Adds the shape at `index` to the scene.
pub fn shape(builder: &mut Builder, index: usize) -> Result<(), LoadError> {
    let object = builder.object(index);
    let to_world = to_world(object)?;
    let geometry = match object.plugin.as_str() {
        "rectangle" | "cube" => {
            // Their vertex normals are those of their faces.
            object.boolean("face_normals", false)?;
            ShapeGeometry::Mesh(match object.plugin.as_str() {
                "cube" => TriangleMesh::cube(),
                _ => TriangleMesh::rectangle(),
            })
        }
        "sphere" => ShapeGeometry::Sphere {
            center: object.vector("center")?.unwrap_or(DVec3::ZERO),
            radius: object.float_in("radius", 1.0, "above 0", |r| r > 0.0)?,
        },
        "obj" | "ply" | "serialized" => {
            ShapeGeometry::Mesh(mesh_from_file(builder, object, &to_world)?)
        }
        _ => return Err(object.unknown_plugin(&KNOWN)),
    };
    let objects = &builder.tree.objects;
    let emission = match object.child(objects, Tag::Emitter)? {
        Some(index) => Some(emitter::area_radiance(builder, index)?),
        None => None,
    };
    let material = match object.child(objects, Tag::Bsdf)? {
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

/// `shape "Floor" (scene.xml:12:3)`, or its type in place of its id.
fn name(object: &Object) -> String {
    match &object.id {
        Some(id) => format!("shape \"{id}\" ({})", object.place),
        None => format!("shape of type {} ({})", object.plugin, object.place),
    }
}

fn to_world(object: &Object) -> Result<DMat4, LoadError> {
    let matrix = object.transform("to_world")?;
    let Some(property) = object.find("to_world") else {
        return Ok(matrix);
    };
    if matrix.row(3) != DVec4::W {
        let what = "perspective in the transform of a shape: its last row must be 0 0 0 1";
        return Err(property.error(Cause::NotModelled(what.into())));
    }
    let linear = DMat3::from_mat4(matrix);
    let lengths = linear.x_axis.length() * linear.y_axis.length() * linear.z_axis.length();
    let determinant = linear.determinant().abs();
    // Not a comparison with `<=`: NaN is singular too.
    if lengths.is_finite() && determinant > FLATTEST * lengths {
        Ok(matrix)
    } else {
        Err(property.error(Cause::SingularTransform(object.title())))
    }
}

fn mesh_from_file(
    builder: &mut Builder,
    object: &Object,
    to_world: &DMat4,
) -> Result<TriangleMesh, LoadError> {
    let (Some(filename), Some(property)) = (object.text("filename")?, object.find("filename"))
    else {
        return Err(object.missing("the string `filename`"));
    };
    let path = builder.tree.locate(filename, &property.place);
    let smooth = !object.boolean("face_normals", false)?;
    let flip_v = match object.plugin.as_str() {
        "serialized" => false,
        plugin => object.boolean("flip_tex_coords", plugin == "obj")?,
    };
    let index = shape_index(object)?;
    let read = || -> Result<MeshFile, MeshError> {
        let bytes = mesh::read_bytes(&path)?;
        match object.plugin.as_str() {
            "obj" => mesh::obj::read(&bytes, flip_v, smooth),
            "ply" => mesh::ply::read(&bytes, flip_v, smooth),
            _ => mesh::serialized::read(&bytes, index, smooth),
        }
    };
    match read() {
        Ok(MeshFile { mut mesh, note }) => {
            if smooth && mesh.normals.is_empty() {
                mesh.compute_vertex_normals(to_world);
            }
            builder.warnings.extend(note.map(|note| Warning {
                place: Some(property.place.clone()),
                text: format!("{}: {note}", path.display()),
            }));
            Ok(mesh)
        }
        Err(error) => Err(property.error(Cause::Mesh { path, error })),
    }
}

/// Which mesh of a `serialized` file.
fn shape_index(object: &Object) -> Result<usize, LoadError> {
    if object.plugin != "serialized" {
        return Ok(0);
    }
    let (Some(value), Some(property)) =
        (object.integer("shape_index")?, object.find("shape_index"))
    else {
        return Ok(0);
    };
    usize::try_from(value).map_err(|_| property.out_of_range(value, "at least 0"))
}
