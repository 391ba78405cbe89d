//! Checks the statements of an OBJ file line by line, and rewrites those that define the mesh so
//! that tobj reads them as Mitsuba 3 would. By itself, tobj divides positions by a fourth number,
//! reads comments at the end of statements, begins a new model at each group or material, and does
//! not report the line of an error.

use std::fmt::Write;

use super::super::MeshError;

/// The first texture coordinate and the first normal, which corners without their own refer to.
/// tobj omits what a corner lacks, so that its arrays would no longer match the vertices.
const MISSING: &str = "vt nan nan\nvn nan nan nan\n";

/// [`MISSING`], followed by the statements `v x y z`, `vt u v` and `vn x y z` with finite numbers,
/// and `f v/vt/vn ...` with at least three corners and valid indices. Without `with_normals` no
/// corner has a normal.
pub fn checked(bytes: &[u8], with_normals: bool) -> Result<String, MeshError> {
    let mut statements = Statements {
        text: MISSING.to_owned(),
        positions: 0,
        uvs: 0,
        normals: 0,
        with_normals,
    };
    for (i, line) in bytes.split(|&b| b == b'\n').enumerate() {
        let passed = statements.line(line);
        passed.map_err(|problem| MeshError::at_line(i + 1, problem))?;
    }
    Ok(statements.text)
}

struct Statements {
    text: String,
    // Number of statements so far.
    positions: usize,
    uvs: usize,
    normals: usize,
    with_normals: bool,
}

impl Statements {
    fn line(&mut self, line: &[u8]) -> Result<(), String> {
        // Names of groups and materials may have any encoding; numbers are ASCII.
        let line = String::from_utf8_lossy(line);
        let words = line.split_ascii_whitespace();
        let mut words = words.take_while(|word| !word.starts_with('#'));
        match words.next() {
            Some("v") => {
                self.positions += 1;
                self.numbers("v", 3, words)
            }
            Some("vt") => {
                self.uvs += 1;
                // The second number is optional and defaults to 0.
                self.numbers("vt", 2, words.chain(["0"]))
            }
            Some("vn") => {
                self.normals += 1;
                self.numbers("vn", 3, words)
            }
            Some("f") => self.face(words),
            _ => Ok(()),
        }
    }

    /// Writes a statement with the first `count` numbers. Further ones, weights and colours, are
    /// ignored.
    fn numbers<'a>(
        &mut self,
        keyword: &str,
        count: usize,
        mut words: impl Iterator<Item = &'a str>,
    ) -> Result<(), String> {
        self.text.push_str(keyword);
        for _ in 0..count {
            let word = words
                .next()
                .ok_or_else(|| format!("{count} numbers expected"))?;
            if !word.parse().is_ok_and(f32::is_finite) {
                return Err(format!("`{word}` is not a finite number"));
            }
            self.text.push(' ');
            self.text.push_str(word);
        }
        self.text.push('\n');
        Ok(())
    }

    fn face<'a>(&mut self, words: impl Iterator<Item = &'a str>) -> Result<(), String> {
        self.text.push('f');
        let mut count = 0;
        for word in words {
            let [position, uv, normal] = self.corner(word)?;
            // Writing to a string cannot fail.
            let _ = write!(self.text, " {position}/{uv}/{normal}");
            count += 1;
        }
        self.text.push('\n');
        match count {
            3.. => Ok(()),
            _ => Err(format!(
                "a face needs three corners, but this one has {count}"
            )),
        }
    }

    /// The indices, counted from 1 and after [`MISSING`], in `position`, `position/uv`,
    /// `position//normal` or `position/uv/normal`.
    fn corner(&self, word: &str) -> Result<[usize; 3], String> {
        let mut parts = word.split('/');
        let mut next = |what: &str, count: usize| match parts.next() {
            None | Some("") => Ok(None),
            Some(text) => index(text, count).map(Some).ok_or_else(|| {
                format!("`{text}` in `{word}` is none of the {count} {what} before this line")
            }),
        };
        let position = next("positions", self.positions)?;
        let uv = next("texture coordinates", self.uvs)?;
        let normal = next("normals", self.normals)?.filter(|_| self.with_normals);
        let after_missing = |index: Option<usize>| index.map_or(1, |i| i + 1);
        match (position, parts.next()) {
            (Some(position), None) => Ok([position, after_missing(uv), after_missing(normal)]),
            _ => Err(format!("`{word}` is not a corner of a face")),
        }
    }
}

/// Converts an index to one that counts from 1. Negative indices count backwards from the last
/// element so far, which is -1.
fn index(text: &str, count: usize) -> Option<usize> {
    let index = match text.parse::<isize>().ok()? {
        i if i < 0 => count.checked_sub(i.unsigned_abs())? + 1,
        i => i.unsigned_abs(),
    };
    (1..=count).contains(&index).then_some(index)
}
