//! The data of a PLY file.

use super::header::{Encoding, Header, Number, Property};
use crate::mitsuba::mesh::{MAX_COUNT, MeshError};

/// The part of the file after the header, read sequentially.
pub struct Data<'a> {
    bytes: &'a [u8],
    position: usize,
    encoding: Encoding,
}

impl<'a> Data<'a> {
    /// The data of a file with this header.
    pub fn new(bytes: &'a [u8], header: &Header) -> Self {
        Self {
            bytes,
            position: header.length,
            encoding: header.encoding,
        }
    }

    /// Offset of the next byte in the file.
    pub fn position(&self) -> usize {
        self.position
    }

    /// Calls `take` with the value of a property and 0, or with each value of a list and its index.
    pub fn property(
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

    /// An error at the value that begins at `byte`.
    pub fn error(&self, byte: usize, problem: impl Into<String>) -> MeshError {
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

/// The line, counted from 1, of the byte at an offset in `text`.
fn line_of(text: &[u8], byte: usize) -> usize {
    let before = &text[..byte.min(text.len())];
    before.iter().filter(|&&b| b == b'\n').count() + 1
}
