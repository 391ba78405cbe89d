//! Readers of triangle meshes in three file formats.

pub mod obj;
pub mod ply;
pub mod serialized;

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use glam::DMat4;

use super::file::regular_file_size;
use crate::scene::TriangleMesh;

/// Maximum number of vertices or triangles of a mesh: indices have 32 bits.
const MAX_COUNT: u64 = u32::MAX as u64;

/// Why a mesh file cannot be used.
#[derive(Debug, thiserror::Error)]
#[error("{problem}")]
pub struct MeshError {
    position: Position,
    problem: String,
}

#[derive(Debug)]
enum Position {
    Line(usize),
    Byte(usize),
    Unknown,
}

impl MeshError {
    fn new(position: Position, problem: impl Into<String>) -> Self {
        let problem = problem.into();
        Self { position, problem }
    }

    fn at_line(line: usize, problem: impl Into<String>) -> Self {
        Self::new(Position::Line(line), problem)
    }

    fn at_byte(byte: usize, problem: impl Into<String>) -> Self {
        Self::new(Position::Byte(byte), problem)
    }

    fn nowhere(problem: impl Into<String>) -> Self {
        Self::new(Position::Unknown, problem)
    }

    /// The position in messages: ":12" for line 12 of a text file, " (byte 12)" for offset 12 of a
    /// binary file, or nothing.
    pub fn position(&self) -> String {
        match self.position {
            Position::Line(line) => format!(":{line}"),
            Position::Byte(byte) => format!(" (byte {byte})"),
            Position::Unknown => String::new(),
        }
    }
}

/// A mesh read from a file.
pub struct MeshFile {
    /// The mesh: not empty, all numbers finite, all indices in range.
    pub mesh: TriangleMesh,
    /// Warnings for the user.
    pub notes: Vec<String>,
}

/// The contents of a file.
pub fn read_bytes(path: &Path) -> Result<Vec<u8>, MeshError> {
    let bytes = regular_file_size(path).and_then(|_| fs::read(path));
    bytes.map_err(|error| MeshError::nowhere(format!("cannot read it: {error}")))
}

/// Checks the invariants of a [`TriangleMesh`], and replaces missing normals, which are zero, by the mean of
/// those of the triangles around them. Returns a warning if there are any. Normals are checked only where a
/// triangle uses them, because files contain unused vertices with normals of length zero.
fn check(mesh: &mut TriangleMesh) -> Result<Option<String>, MeshError> {
    if mesh.triangles.is_empty() {
        return Err(MeshError::nowhere("the mesh has no triangles"));
    }
    let bad_vertex = |what: &str, i: usize, v: &dyn std::fmt::Debug| {
        Err(MeshError::nowhere(format!("{what} {i} (from 0) is {v:?}")))
    };
    for (i, p) in mesh.positions.iter().enumerate() {
        if !p.iter().all(|x| x.is_finite()) {
            return bad_vertex("the position of vertex", i, p);
        }
    }
    for (i, uv) in mesh.uvs.iter().enumerate() {
        if !uv.iter().all(|x| x.is_finite()) {
            return bad_vertex("the texture coordinate of vertex", i, uv);
        }
    }
    let mut missing = BTreeSet::new();
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        for &index in triangle {
            let i = index as usize;
            if i >= mesh.positions.len() {
                return Err(MeshError::nowhere(format!(
                    "triangle {t} (from 0) refers to vertex {i}, but there are {} vertices",
                    mesh.positions.len()
                )));
            }
            if let Some(n) = mesh.normals.get(i) {
                let length_squared: f32 = n.iter().map(|x| x * x).sum();
                if !length_squared.is_finite() {
                    return bad_vertex("the normal of vertex", i, n);
                }
                if length_squared == 0.0 {
                    missing.insert(i);
                }
            }
        }
    }
    if missing.is_empty() {
        return Ok(None);
    }
    let geometric = mesh.smooth_normals(&DMat4::IDENTITY);
    for &i in &missing {
        mesh.normals[i] = geometric[i];
    }
    Ok(Some(format!(
        "{} of {} vertices have no normal or one of length zero; the normals of the triangles around \
         them are used",
        missing.len(),
        mesh.positions.len()
    )))
}
