//! The header of a PLY file: its encoding, elements and properties.

use crate::mitsuba::mesh::{MAX_COUNT, MeshError};

/// Types of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Number {
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

/// How numbers are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// What a property contributes to the mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// A component of the position.
    Position(usize),
    /// A component of the normal.
    Normal(usize),
    /// A component of the texture coordinate.
    Uv(usize),
    /// The list of the vertices of a polygon.
    Polygon,
    /// Nothing.
    None,
}

/// A number, or a list of numbers, that each item of an element has.
#[derive(Debug)]
pub struct Property {
    /// What it contributes.
    pub role: Role,
    /// The type of the number or numbers.
    pub number: Number,
    /// The type of the length if the property is a list.
    pub length: Option<Number>,
}

/// A sequence of items with the same properties.
#[derive(Debug)]
pub struct Element {
    /// `vertex`, `face`, ...
    pub name: String,
    /// Number of items.
    pub count: u64,
    /// The properties, in the order of the data.
    pub properties: Vec<Property>,
}

/// A header.
#[derive(Debug)]
pub struct Header {
    /// How numbers are written in the data.
    pub encoding: Encoding,
    /// The elements, in the order of the data.
    pub elements: Vec<Element>,
    /// Length of the header in bytes. The data follows.
    pub length: usize,
}

impl Header {
    /// Reads the header at the beginning of a file.
    pub fn read(bytes: &[u8]) -> Result<Self, MeshError> {
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
                        count: count
                            .ok_or_else(|| error(format!("invalid number of {name} elements")))?,
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
                    let encoding =
                        encoding.ok_or_else(|| error("the header has no format".into()))?;
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
        Err(MeshError::nowhere("the header has no end_header line"))
    }
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
