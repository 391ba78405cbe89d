//! PLY (Turk 1994, "The PLY polygon file format"): ASCII and binary in both byte orders. Elements
//! and properties other than positions, normals, texture coordinates and polygons are ignored.

mod data;
mod header;

use data::Data;
use header::{Element, Header, Role};

use super::{MAX_COUNT, MeshError, MeshFile, check};
use crate::scene::TriangleMesh;

/// Reads a mesh. `flip_v` turns texture coordinates (u, v) into (u, 1 - v). Without `with_normals`
/// the normals of the file are ignored.
pub fn read(bytes: &[u8], flip_v: bool, with_normals: bool) -> Result<MeshFile, MeshError> {
    let header = Header::read(bytes)?;
    let mut data = Data::new(bytes, &header);
    let mut mesh = TriangleMesh::default();
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" => vertices(element, &mut data, &mut mesh, with_normals)?,
            "face" => faces(element, &mut data, &mut mesh)?,
            // Elements without properties take no space: any number of them is skipped at once.
            _ if element.properties.is_empty() => {}
            _ => {
                for _ in 0..element.count {
                    for property in &element.properties {
                        data.property(property, |_, _| Ok(()))?;
                    }
                }
            }
        }
    }
    if flip_v {
        for uv in &mut mesh.uvs {
            uv[1] = 1.0 - uv[1];
        }
    }
    let notes = check(&mut mesh)?.into_iter().collect();
    Ok(MeshFile { mesh, notes })
}

fn vertices(
    element: &Element,
    data: &mut Data,
    mesh: &mut TriangleMesh,
    with_normals: bool,
) -> Result<(), MeshError> {
    let has = |role| element.properties.iter().any(|p| p.role == role);
    if !(0..3).all(|i| has(Role::Position(i))) {
        let problem = "the vertices have no `x`, `y` and `z`";
        return Err(MeshError::nowhere(problem));
    }
    let with_normals = with_normals && (0..3).all(|i| has(Role::Normal(i)));
    let with_uvs = (0..2).all(|i| has(Role::Uv(i)));
    for _ in 0..element.count {
        let mut position = [0.0; 3];
        let mut normal = [0.0; 3];
        let mut uv = [0.0; 2];
        for property in &element.properties {
            data.property(property, |_, value| {
                match property.role {
                    Role::Position(i) => position[i] = value as f32,
                    Role::Normal(i) => normal[i] = value as f32,
                    Role::Uv(i) => uv[i] = value as f32,
                    Role::Polygon | Role::None => {}
                }
                Ok(())
            })?;
        }
        mesh.positions.push(position);
        if with_normals {
            mesh.normals.push(normal);
        }
        if with_uvs {
            mesh.uvs.push(uv);
        }
    }
    Ok(())
}

/// Reads polygons and splits each into triangles that share its first corner.
fn faces(element: &Element, data: &mut Data, mesh: &mut TriangleMesh) -> Result<(), MeshError> {
    if !element.properties.iter().any(|p| p.role == Role::Polygon) {
        let problem = "the faces have no list `vertex_indices` or `vertex_index`";
        return Err(MeshError::nowhere(problem));
    }
    for _ in 0..element.count {
        for property in &element.properties {
            let start = data.position();
            let mut first = 0;
            let mut last = 0;
            let mut corners = 0;
            data.property(property, |i, value| {
                if property.role != Role::Polygon {
                    return Ok(());
                }
                if !(value >= 0.0 && value < MAX_COUNT as f64 && value.fract() == 0.0) {
                    return Err(format!("{value} is not the index of a vertex"));
                }
                let vertex = value as u32;
                match i {
                    0 => first = vertex,
                    1 => {}
                    _ => mesh.triangles.push([first, last, vertex]),
                }
                last = vertex;
                corners = i + 1;
                Ok(())
            })?;
            if property.role == Role::Polygon && corners < 3 {
                let problem = format!("a face needs three corners, but this one has {corners}");
                return Err(data.error(start, problem));
            }
        }
    }
    Ok(())
}
