//! One file of a scene: its text, its XML, its version.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use roxmltree::{Document, Node};

use super::attributes::start_tag;
use super::error::{Cause, LoadError};
use super::source::{Place, SourceFile};

/// Largest file, in bytes. Meshes and images are in files of their own, so a scene has no need.
const LARGEST_FILE: u64 = 1 << 28;

/// The text of a file; `fail` makes an error of what keeps it from being read.
pub fn read(path: &Path, fail: impl Fn(Cause) -> LoadError) -> Result<Arc<SourceFile>, LoadError> {
    let bytes = read_bytes(path).map_err(fail)?;
    Ok(SourceFile::new(path.to_owned(), checked_utf8(path, bytes)?))
}

/// The XML of a file.
pub fn parse(source: &Arc<SourceFile>) -> Result<Document<'_>, LoadError> {
    Document::parse(source.text()).map_err(|error| {
        let position = error.pos();
        let at = byte_offset(source.text(), position.row, position.col);
        let place = Place::new(source, at..at);
        LoadError::at(&place, Cause::Xml(without_position(&error.to_string())))
    })
}

/// The folder of a file.
pub fn parent(path: &Path) -> PathBuf {
    path.parent().map(Path::to_owned).unwrap_or_default()
}

fn read_bytes(path: &Path) -> Result<Vec<u8>, Cause> {
    let unreadable = |error| Cause::Unreadable {
        path: path.to_owned(),
        error,
    };
    let metadata = fs::metadata(path).map_err(unreadable)?;
    if !metadata.is_file() {
        return Err(unreadable(io::Error::other("it is not a file")));
    }
    if metadata.len() > LARGEST_FILE {
        return Err(Cause::FileTooLarge {
            path: path.to_owned(),
            bytes: metadata.len(),
            limit: LARGEST_FILE,
        });
    }
    fs::read(path).map_err(unreadable)
}

fn checked_utf8(path: &Path, bytes: Vec<u8>) -> Result<String, LoadError> {
    String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let text = String::from_utf8_lossy(error.as_bytes()).into_owned();
        let file = SourceFile::new(path.to_owned(), text);
        LoadError::at(&Place::new(&file, valid..valid), Cause::NotUtf8)
    })
}

/// True for versions 0.x and 1, whose names are spelled differently.
pub fn is_legacy(root: Node, source: &Arc<SourceFile>) -> Result<bool, LoadError> {
    let text = root.attribute("version");
    let major = text.and_then(|text| {
        let parts: Vec<u32> = text
            .trim()
            .split('.')
            .map(|part| part.parse().ok())
            .collect::<Option<_>>()?;
        (parts.len() <= 3).then_some(parts.first().copied())?
    });
    let invalid = || {
        let cause = Cause::Version(text.map(str::to_owned));
        LoadError::at(&start_tag(root, source), cause)
    };
    major.map(|major| major < 2).ok_or_else(invalid)
}

/// Byte of a line and a column, both from 1, the column in characters.
fn byte_offset(text: &str, row: u32, column: u32) -> usize {
    let lines = text.split_inclusive('\n').take(row as usize - 1);
    let line_start: usize = lines.map(str::len).sum();
    let line = &text[line_start..];
    let within = line.char_indices().nth(column as usize - 1);
    line_start + within.map_or(line.len(), |(byte, _)| byte)
}

/// The XML parser's message ends in " at row:column", which the error says already.
fn without_position(message: &str) -> String {
    let is_position = |tail: &str| tail.chars().all(|c| c.is_ascii_digit() || c == ':');
    match message.rsplit_once(" at ") {
        Some((head, tail)) if is_position(tail) => head.to_owned(),
        _ => message.to_owned(),
    }
}
