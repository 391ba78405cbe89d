//! PLY (Turk 1994, "The PLY polygon file format"): ASCII and binary in both byte orders. Elements
//! and properties other than positions, normals, texture coordinates and polygons are ignored.

use super::{MAX_COUNT, MeshError, MeshFile, check, line_of};
use crate::scene::TriangleMesh;

/// Types of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Number {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Number {
    /// The type called `name`, by its old or its new name.
    fn named(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Number::I8,
            "uchar" | "uint8" => Number::U8,
            "short" | "int16" => Number::I16,
            "ushort" | "uint16" => Number::U16,
            "int" | "int32" => Number::I32,
            "uint" | "uint32" => Number::U32,
            "float" | "float32" => Number::F32,
            "double" | "float64" => Number::F64,
            _ => return None,
        })
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// What a property contributes to the mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Role {
    Position(usize),
    Normal(usize),
    Uv(usize),
    /// The list of the vertices of a polygon.
    Polygon,
    None,
}

#[derive(Debug)]
struct Property {
    role: Role,
    number: Number,
    /// The type of the length if the property is a list.
    length: Option<Number>,
}

#[derive(Debug)]
struct Element {
    name: String,
    count: u64,
    properties: Vec<Property>,
}

#[derive(Debug)]
struct Header {
    encoding: Encoding,
    elements: Vec<Element>,
    /// Length in bytes; the data follow.
    length: usize,
}

/// Reads a mesh. `flip_v` turns texture coordinates (u, v) into (u, 1 - v). Without `with_normals`
/// the normals of the file are ignored.
pub fn read(bytes: &[u8], flip_v: bool, with_normals: bool) -> Result<MeshFile, MeshError> {
    let header = header(bytes)?;
    let mut data = Data {
        bytes,
        position: header.length,
        encoding: header.encoding,
    };
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
    check(&mesh)?;
    Ok(MeshFile { mesh, note: None })
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
            let start = data.position;
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

/// The part of the file after the header, read sequentially.
struct Data<'a> {
    bytes: &'a [u8],
    position: usize,
    encoding: Encoding,
}

impl Data<'_> {
    /// Calls `take` with the value of a property and 0, or with each value of a list and its index.
    fn property(
        &mut self,
        property: &Property,
        mut take: impl FnMut(usize, f64) -> Result<(), String>,
    ) -> Result<(), MeshError> {
        let length = match property.length {
            None => 1,
            Some(number) => {
                let start = self.position;
                let length = self.number(number)?;
                if !(length >= 0.0 && length <= MAX_COUNT as f64) {
                    return Err(self.error(start, format!("a list cannot have {length} entries")));
                }
                length as usize
            }
        };
        for i in 0..length {
            let start = self.position;
            let value = self.number(property.number)?;
            take(i, value).map_err(|problem| self.error(start, problem))?;
        }
        Ok(())
    }

    fn number(&mut self, number: Number) -> Result<f64, MeshError> {
        if self.encoding == Encoding::Ascii {
            return self.word();
        }
        Ok(match number {
            Number::I8 => i8::from_le_bytes(self.take()?).into(),
            Number::U8 => u8::from_le_bytes(self.take()?).into(),
            Number::I16 => i16::from_le_bytes(self.take()?).into(),
            Number::U16 => u16::from_le_bytes(self.take()?).into(),
            Number::I32 => i32::from_le_bytes(self.take()?).into(),
            Number::U32 => u32::from_le_bytes(self.take()?).into(),
            Number::F32 => f32::from_le_bytes(self.take()?).into(),
            Number::F64 => f64::from_le_bytes(self.take()?),
        })
    }

    /// The next `N` bytes in little-endian order.
    fn take<const N: usize>(&mut self) -> Result<[u8; N], MeshError> {
        let rest = &self.bytes[self.position..];
        let Some(&(mut chunk)) = rest.first_chunk::<N>() else {
            return Err(self.error(self.position, "the file ends before its data is complete"));
        };
        self.position += N;
        if self.encoding == Encoding::BigEndian {
            chunk.reverse();
        }
        Ok(chunk)
    }

    /// The next number of an ASCII file.
    fn word(&mut self) -> Result<f64, MeshError> {
        let rest = &self.bytes[self.position..];
        let is_space = |b: &u8| b.is_ascii_whitespace();
        let start = rest.iter().position(|b| !is_space(b));
        let Some(start) = start else {
            return Err(self.error(
                self.bytes.len(),
                "the file ends before its data is complete",
            ));
        };
        let rest = &rest[start..];
        let length = rest.iter().position(is_space).unwrap_or(rest.len());
        let word = String::from_utf8_lossy(&rest[..length]);
        let at = self.position + start;
        self.position = at + length;
        word.parse().map_err(|_| {
            let shown: String = word.chars().take(40).collect();
            self.error(at, format!("`{shown}` is not a number"))
        })
    }

    fn error(&self, byte: usize, problem: impl Into<String>) -> MeshError {
        match self.encoding {
            Encoding::Ascii => {
                let rest = self.bytes[byte..].iter();
                let spaces = rest.take_while(|b| b.is_ascii_whitespace()).count();
                MeshError::at_line(line_of(self.bytes, byte + spaces), problem)
            }
            _ => MeshError::at_byte(byte, problem),
        }
    }
}

fn header(bytes: &[u8]) -> Result<Header, MeshError> {
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    let mut length = 0;
    for (i, line) in bytes.split_inclusive(|&b| b == b'\n').enumerate() {
        length += line.len();
        let error = |problem: String| MeshError::at_line(i + 1, problem);
        let line = String::from_utf8_lossy(line);
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        if i == 0 && words != ["ply"] {
            return Err(error("a PLY file begins with the line `ply`".into()));
        }
        match words[..] {
            ["ply"] if i == 0 => {}
            [] | ["comment" | "obj_info", ..] => {}
            ["format", name, _] => encoding = Some(encoding_named(name).map_err(error)?),
            ["element", name, count] => {
                let count = count.parse().ok().filter(|&count| count <= MAX_COUNT);
                elements.push(Element {
                    name: name.to_owned(),
                    count: count.ok_or_else(|| error(format!("not a usable number of {name}")))?,
                    properties: Vec::new(),
                });
            }
            ["property", ref rest @ ..] => {
                let Some(element) = elements.last_mut() else {
                    return Err(error("a property before any element".into()));
                };
                let parsed = property(&element.name, rest).map_err(error)?;
                element.properties.push(parsed);
            }
            ["end_header"] => {
                let encoding = encoding.ok_or_else(|| error("the header has no format".into()))?;
                return Ok(Header {
                    encoding,
                    elements,
                    length,
                });
            }
            _ => {
                let shown: String = line.trim_end().chars().take(60).collect();
                return Err(error(format!("`{shown}` is not a valid header line")));
            }
        }
    }
    Err(MeshError::nowhere("the header has no end"))
}

fn encoding_named(name: &str) -> Result<Encoding, String> {
    match name {
        "ascii" => Ok(Encoding::Ascii),
        "binary_little_endian" => Ok(Encoding::LittleEndian),
        "binary_big_endian" => Ok(Encoding::BigEndian),
        _ => Err(format!("unknown format `{name}`")),
    }
}

fn property(element: &str, words: &[&str]) -> Result<Property, String> {
    let number = |name: &str| Number::named(name).ok_or_else(|| format!("unknown type `{name}`"));
    match words {
        ["list", length, entries, name] => {
            let is_polygon = element == "face" && ["vertex_indices", "vertex_index"].contains(name);
            Ok(Property {
                role: if is_polygon {
                    Role::Polygon
                } else {
                    Role::None
                },
                number: number(entries)?,
                length: Some(number(length)?),
            })
        }
        [kind, name] => Ok(Property {
            role: if element == "vertex" {
                role(name)
            } else {
                Role::None
            },
            number: number(kind)?,
            length: None,
        }),
        _ => Err("a property is `TYPE NAME` or `list TYPE TYPE NAME`".into()),
    }
}

/// The role of a vertex property, by the names that Mitsuba 3 uses.
fn role(name: &str) -> Role {
    match name {
        "x" => Role::Position(0),
        "y" => Role::Position(1),
        "z" => Role::Position(2),
        "nx" => Role::Normal(0),
        "ny" => Role::Normal(1),
        "nz" => Role::Normal(2),
        "u" | "s" | "texture_u" => Role::Uv(0),
        "v" | "t" | "texture_v" => Role::Uv(1),
        _ => Role::None,
    }
}
