//! Mitsuba's `serialized` meshes, versions 3 and 4 (Mitsuba 0.6 manual, section 8.2.9). Each mesh
//! is a header of four bytes and a zlib stream. A table with the offsets of the meshes ends the
//! file.

use std::io::{self, BufReader, Read};

use flate2::read::ZlibDecoder;

use super::{MAX_COUNT, MeshError, MeshFile, check};
use crate::scene::TriangleMesh;

const MAGIC: u16 = 0x041C;
const HAS_NORMALS: u32 = 0x0001;
const HAS_UVS: u32 = 0x0002;
const HAS_COLORS: u32 = 0x0008;
// The flag 0x0010, face normals, is ignored as in Mitsuba 3.
const DOUBLE_PRECISION: u32 = 0x2000;

/// Maximum length of the name of a mesh in bytes.
const MAX_NAME_LENGTH: usize = 1 << 16;

/// Meshes of at most this many bytes are always decompressed.
const SMALL: u64 = 1 << 24;

/// Maximum ratio of compression of larger ones: a regular grid of equal normals has less.
const MAX_RATIO: u64 = 100;

#[derive(Clone, Copy, PartialEq, Eq)]
enum Version {
    /// 32-bit offsets, no names.
    V3,
    /// 64-bit offsets, and names.
    V4,
}

/// Reads the mesh number `index`, counted from 0. Without `with_normals` the normals of the file
/// are ignored.
pub fn read(bytes: &[u8], index: usize, with_normals: bool) -> Result<MeshFile, MeshError> {
    let version = version(bytes, 0)?;
    let start = match index {
        0 => 0,
        _ => offset(bytes, version, index)?,
    };
    let version = self::version(bytes, start)?;
    let compressed = &bytes[start + 4..];
    let stream = BufReader::new(ZlibDecoder::new(compressed));
    let limit = SMALL + MAX_RATIO * compressed.len() as u64;
    let mut mesh = decode(Stream(stream), version, with_normals, limit).map_err(|problem| {
        let problem = format!("mesh {index}: {problem}");
        MeshError::at_byte(start, problem)
    })?;
    let notes = check(&mut mesh)?.into_iter().collect();
    Ok(MeshFile { mesh, notes })
}

fn version(bytes: &[u8], start: usize) -> Result<Version, MeshError> {
    let word = |at: usize| {
        let two = bytes.get(at..)?.first_chunk()?;
        Some(u16::from_le_bytes(*two))
    };
    match (word(start), word(start.saturating_add(2))) {
        (Some(MAGIC), Some(3)) => Ok(Version::V3),
        (Some(MAGIC), Some(4)) => Ok(Version::V4),
        (Some(MAGIC), Some(version)) => {
            let problem = format!("version {version} is not known (known: 3, 4)");
            Err(MeshError::at_byte(start, problem))
        }
        _ => Err(MeshError::at_byte(start, "no serialized mesh begins here")),
    }
}

/// The offset of mesh `index`, from the table at the end of the file.
fn offset(bytes: &[u8], version: Version, index: usize) -> Result<usize, MeshError> {
    let truncated = || MeshError::at_byte(bytes.len(), "the table at the end is invalid");
    let count = bytes.last_chunk().ok_or_else(truncated)?;
    let count = u32::from_le_bytes(*count) as usize;
    if index >= count {
        let problem = format!("`shape_index` is {index}, but the file has {count} meshes");
        return Err(MeshError::nowhere(problem));
    }
    let entry_size = match version {
        Version::V3 => 4,
        Version::V4 => 8,
    };
    let from_end = 4 + (count - index) * entry_size;
    let at = bytes.len().checked_sub(from_end).ok_or_else(truncated)?;
    let entry = &bytes[at..at + entry_size];
    let offset = entry
        .iter()
        .rev()
        .fold(0_u64, |n, &b| n << 8 | u64::from(b));
    usize::try_from(offset).map_err(|_| truncated())
}

fn decode<R: Read>(
    mut stream: Stream<R>,
    version: Version,
    with_normals: bool,
    limit: u64,
) -> Result<TriangleMesh, String> {
    let flags = u32::from_le_bytes(stream.take()?);
    if version == Version::V4 {
        stream.skip_name()?;
    }
    let vertices = count("vertices", u64::from_le_bytes(stream.take()?))?;
    let triangles = count("triangles", u64::from_le_bytes(stream.take()?))?;
    let double = flags & DOUBLE_PRECISION != 0;
    let has = |flag| flags & flag != 0;
    let arrays = [(HAS_NORMALS, 3), (HAS_UVS, 2), (HAS_COLORS, 3)].into_iter();
    let optional: u64 = arrays.map(|(flag, n)| if has(flag) { n } else { 0 }).sum();
    let number_bytes = if double { 8 } else { 4 };
    // Both counts have 32 bits, so nothing overflows.
    let claimed = vertices * (3 + optional) * number_bytes + triangles * 12;
    if claimed > limit {
        return Err(format!(
            "it claims {vertices} vertices and {triangles} triangles, in all {claimed} bytes, but data of this \
             length has at most {limit}"
        ));
    }
    let mut mesh = TriangleMesh {
        positions: stream.array(vertices, double)?,
        ..TriangleMesh::default()
    };
    if has(HAS_NORMALS) {
        let normals = stream.array(vertices, double)?;
        if with_normals {
            mesh.normals = normals;
        }
    }
    if has(HAS_UVS) {
        mesh.uvs = stream.array(vertices, double)?;
    }
    if has(HAS_COLORS) {
        stream.array::<3>(vertices, double)?;
    }
    for _ in 0..triangles {
        let mut corner = || stream.take().map(u32::from_le_bytes);
        mesh.triangles.push([corner()?, corner()?, corner()?]);
    }
    Ok(mesh)
}

fn count(what: &str, claimed: u64) -> Result<u64, String> {
    match claimed {
        0..=MAX_COUNT => Ok(claimed),
        _ => Err(format!("it claims {claimed} {what}")),
    }
}

/// Decompressed data. Arrays grow as data arrives: the lengths in the file may be wrong.
struct Stream<R>(R);

impl<R: Read> Stream<R> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let mut bytes = [0; N];
        self.0.read_exact(&mut bytes).map_err(broken)?;
        Ok(bytes)
    }

    fn skip_name(&mut self) -> Result<(), String> {
        for _ in 0..MAX_NAME_LENGTH {
            if self.take()? == [0] {
                return Ok(());
            }
        }
        Err("its name is not terminated".into())
    }

    fn array<const N: usize>(&mut self, count: u64, double: bool) -> Result<Vec<[f32; N]>, String> {
        let mut result = Vec::new();
        for _ in 0..count {
            let mut item = [0.0; N];
            for number in &mut item {
                *number = if double {
                    f64::from_le_bytes(self.take()?) as f32
                } else {
                    f32::from_le_bytes(self.take()?)
                };
            }
            result.push(item);
        }
        Ok(result)
    }
}

fn broken(error: io::Error) -> String {
    match error.kind() {
        io::ErrorKind::UnexpectedEof => "the data ends early".into(),
        _ => format!("the data is corrupt: {error}"),
    }
}
