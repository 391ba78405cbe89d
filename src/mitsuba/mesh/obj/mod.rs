//! Wavefront OBJ: positions, texture coordinates, normals and polygons, as Mitsuba 3 reads them.
//! Groups and materials are ignored: the file is one mesh, and corners with the same indices are
//! one vertex even across groups, which affects computed normals.

mod statements;

use super::{MAX_COUNT, MeshError, MeshFile, check};
use crate::scene::TriangleMesh;

const OPTIONS: tobj::LoadOptions = tobj::LoadOptions {
    single_index: true,
    triangulate: true,
    ignore_points: false,
    ignore_lines: false,
};

/// Reads a mesh. `flip_v` turns texture coordinates (u, v) into (u, 1 - v). Without `with_normals`
/// the normals of the file are ignored.
pub fn read(bytes: &[u8], flip_v: bool, with_normals: bool) -> Result<MeshFile, MeshError> {
    let text = statements::checked(bytes, with_normals)?;
    let without_materials = |_: &_| Err(tobj::LoadError::OpenFileFailed);
    let (mut models, _) = tobj::load_obj_buf(&mut text.as_bytes(), &OPTIONS, without_materials)
        .map_err(|error| MeshError::nowhere(error.to_string()))?;
    // There is one model, because the checked text has no groups and materials.
    let mesh = models.pop().map(|model| model.mesh);
    mesh_file(mesh.unwrap_or_default(), flip_v)
}

/// A mesh from flat arrays, in which NaN stands for a missing normal or texture coordinate.
fn mesh_file(mesh: tobj::Mesh, flip_v: bool) -> Result<MeshFile, MeshError> {
    let positions = mesh.positions.as_chunks().0.to_vec();
    let mut normals: Vec<[f32; 3]> = mesh.normals.as_chunks().0.to_vec();
    let mut uvs: Vec<[f32; 2]> = mesh.texcoords.as_chunks().0.to_vec();
    let total = positions.len();
    if total as u64 > MAX_COUNT {
        return Err(MeshError::nowhere(format!("{total} vertices are too many")));
    }
    if normals.iter().all(|[x, ..]| x.is_nan()) {
        normals.clear();
    }
    for normal in normals.iter_mut().filter(|[x, ..]| x.is_nan()) {
        *normal = [0.0; 3];
    }
    let without_uv = uvs.iter().filter(|[u, _]| u.is_nan()).count();
    if without_uv == total {
        uvs.clear();
    }
    for uv in &mut uvs {
        *uv = match *uv {
            [u, _] if u.is_nan() => [0.0; 2],
            [u, v] if flip_v => [u, 1.0 - v],
            given => given,
        };
    }
    let mut mesh = TriangleMesh {
        positions,
        normals,
        uvs,
        triangles: mesh.indices.as_chunks().0.to_vec(),
    };
    let without_normals = check(&mut mesh)?;
    let without_uvs = (!mesh.uvs.is_empty() && without_uv != 0).then(|| {
        format!("{without_uv} of {total} vertices have no texture coordinates; (0, 0) is used")
    });
    let notes = [without_normals, without_uvs];
    let notes = notes.into_iter().flatten().collect();
    Ok(MeshFile { mesh, notes })
}
