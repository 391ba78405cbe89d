//! Triangle meshes: `rectangle` and `cube`, and meshes from files in the formats `obj`, `ply` and
//! `serialized`.

use super::to_world::to_world;
use crate::mitsuba::builder::Builder;
use crate::mitsuba::error::{Cause, LoadError, Located};
use crate::mitsuba::mesh::{self, MeshError, MeshFile};
use crate::mitsuba::xml::Object;
use crate::scene::{ShapeGeometry, TriangleMesh};

pub fn rectangle(_: &mut Builder, object: &Object) -> Result<ShapeGeometry, LoadError> {
    flat(object, TriangleMesh::rectangle())
}

pub fn cube(_: &mut Builder, object: &Object) -> Result<ShapeGeometry, LoadError> {
    flat(object, TriangleMesh::cube())
}

/// A mesh whose vertex normals are those of its faces, so that `face_normals` has no effect.
fn flat(object: &Object, mesh: TriangleMesh) -> Result<ShapeGeometry, LoadError> {
    object.boolean("face_normals", false)?;
    Ok(ShapeGeometry::Mesh(mesh))
}

pub fn obj(builder: &mut Builder, object: &Object) -> Result<ShapeGeometry, LoadError> {
    let flip_v = object.boolean("flip_tex_coords", true)?;
    let read = |bytes: &[u8], smooth| mesh::obj::read(bytes, flip_v, smooth);
    from_file(builder, object, read)
}

pub fn ply(builder: &mut Builder, object: &Object) -> Result<ShapeGeometry, LoadError> {
    let flip_v = object.boolean("flip_tex_coords", false)?;
    let read = |bytes: &[u8], smooth| mesh::ply::read(bytes, flip_v, smooth);
    from_file(builder, object, read)
}

pub fn serialized(builder: &mut Builder, object: &Object) -> Result<ShapeGeometry, LoadError> {
    let index = object.integer_in("shape_index", 0..=i64::MAX, "at least 0")?;
    let read = |bytes: &[u8], smooth| mesh::serialized::read(bytes, index.unwrap_or(0), smooth);
    from_file(builder, object, read)
}

/// The mesh that `read` makes of the bytes of a file. The second argument of `read` is false if
/// the normals of the file are not used.
fn from_file(
    builder: &mut Builder,
    object: &Object,
    read: impl Fn(&[u8], bool) -> Result<MeshFile, MeshError>,
) -> Result<ShapeGeometry, LoadError> {
    let (path, property) = builder.file(object)?;
    let smooth = !object.boolean("face_normals", false)?;
    let is_angle = |degrees: f64| (0.0..=180.0).contains(&degrees);
    let range = "between 0 and 180 degrees";
    let max_smooth_angle = object.float_in("max_smooth_angle", 0.0, range, is_angle)?;
    // Where vertices are shared, and how many materials a file has, makes no difference here.
    object.ignore(&["collapse", "load_materials"]);
    let found = mesh::read_bytes(&path).and_then(|bytes| read(&bytes, smooth));
    let MeshFile { mut mesh, notes } = match found {
        Ok(found) => found,
        Err(error) => return Err(property.error(Cause::Mesh { path, error })),
    };
    if smooth && max_smooth_angle > 0.0 {
        mesh.smooth_up_to(max_smooth_angle, &to_world(object)?);
    } else if smooth && mesh.normals.is_empty() {
        mesh.compute_vertex_normals(&to_world(object)?);
    }
    let warning = |note: String| property.warning(format!("{}: {note}", path.display()));
    builder.warnings.extend(notes.into_iter().map(warning));
    Ok(ShapeGeometry::Mesh(mesh))
}
