//! Triangle meshes from files.

pub mod obj;
pub mod ply;
pub mod serialized;

use std::fs;
use std::io;
use std::path::Path;

use crate::scene::TriangleMesh;

/// Most vertices or triangles of a mesh: indices have 32 bits.
const MOST: u64 = u32::MAX as u64;

/// What is wrong with a mesh file.
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
    fn at_line(line: usize, problem: impl Into<String>) -> Self {
        let position = Position::Line(line);
        let problem = problem.into();
        Self { position, problem }
    }

    fn at_byte(byte: usize, problem: impl Into<String>) -> Self {
        let position = Position::Byte(byte);
        let problem = problem.into();
        Self { position, problem }
    }

    fn nowhere(problem: impl Into<String>) -> Self {
        let position = Position::Unknown;
        let problem = problem.into();
        Self { position, problem }
    }

    /// ":12" for line 12 of a text, " (byte 12)" for the 12th byte of another file, or nothing.
    pub fn position(&self) -> String {
        match self.position {
            Position::Line(line) => format!(":{line}"),
            Position::Byte(byte) => format!(" (byte {byte})"),
            Position::Unknown => String::new(),
        }
    }
}

/// A mesh as its file has it.
pub struct MeshFile {
    /// Checked: finite, in range, not empty.
    pub mesh: TriangleMesh,
    /// Something that the user should know.
    pub note: Option<String>,
}

/// The whole of a file.
pub fn read_bytes(path: &Path) -> Result<Vec<u8>, MeshError> {
    let unreadable = |error: io::Error| MeshError::nowhere(format!("cannot read it: {error}"));
    let metadata = fs::metadata(path).map_err(unreadable)?;
    if !metadata.is_file() {
        return Err(unreadable(io::Error::other("it is not a file")));
    }
    fs::read(path).map_err(unreadable)
}

/// The line, from 1, of a byte of `text`.
fn line_of(text: &[u8], byte: usize) -> usize {
    let before = &text[..byte.min(text.len())];
    before.iter().filter(|&&b| b == b'\n').count() + 1
}

/// Checks what every user of a [`TriangleMesh`] relies on. Normals count only where a triangle uses
/// them, for files have vertices to spare with normals of no length.
fn check(mesh: &TriangleMesh) -> Result<(), MeshError> {
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
                if !(length_squared > 0.0 && length_squared.is_finite()) {
                    return bad_vertex("the normal of vertex", i, n);
                }
            }
        }
    }
    Ok(())
}
