//! One scene file: its text, its XML and its version.

use std::io;
use std::path::Path;
use std::sync::Arc;

use roxmltree::{Document, Node};

use crate::mitsuba::error::{Cause, LoadError, Located};
use crate::mitsuba::file::regular_file_size;
use crate::mitsuba::source::{Place, SourceFile};

/// Maximum size of a scene file in bytes. Meshes and images are in files of their own.
const MAX_BYTES: u64 = 1 << 28;

/// A scene file that is being read.
pub struct File {
    /// Its text.
    pub source: Arc<SourceFile>,
    /// True for versions 0.x and 1, which use the old names.
    pub legacy: bool,
}

impl File {
    /// The file with the text `source` and the root element `root`.
    pub fn new(root: Node, source: &Arc<SourceFile>) -> Result<Self, LoadError> {
        let version = root.attribute("version");
        let major = version.and_then(major_version).ok_or_else(|| {
            start_tag(root, source).error(Cause::Version(version.map(str::to_owned)))
        })?;
        Ok(Self {
            source: Arc::clone(source),
            legacy: major < 2,
        })
    }

    /// The start tag of an element, without its contents.
    pub fn start_tag(&self, node: Node) -> Place {
        start_tag(node, &self.source)
    }

    /// The element `node` is not allowed in an element named `parent`; `known` are.
    pub fn unknown_element<'a>(
        &self,
        node: Node,
        parent: &str,
        known: impl Iterator<Item = &'a str>,
    ) -> LoadError {
        self.start_tag(node).error(Cause::UnknownElement {
            found: node.tag_name().name().to_owned(),
            parent: parent.to_owned(),
            known: known.map(str::to_owned).collect(),
        })
    }

    /// Checks that an element contains no other elements.
    pub fn no_elements_in(&self, node: Node) -> Result<(), LoadError> {
        match node.children().find(Node::is_element) {
            None => Ok(()),
            Some(child) => {
                let parent = node.tag_name().name();
                Err(self.unknown_element(child, parent, std::iter::empty()))
            }
        }
    }
}

/// Reads the text of a file; `fail` makes an error of the cause if it cannot be read.
pub fn read(path: &Path, fail: impl Fn(Cause) -> LoadError) -> Result<Arc<SourceFile>, LoadError> {
    let bytes = read_bytes(path).map_err(fail)?;
    Ok(SourceFile::new(path.to_owned(), checked_utf8(path, bytes)?))
}

/// Parses the XML of a file.
pub fn parse(source: &Arc<SourceFile>) -> Result<Document<'_>, LoadError> {
    Document::parse(source.text()).map_err(|error| {
        let position = error.pos();
        let at = byte_offset(source.text(), position.row, position.col);
        let message = without_position(&error.to_string());
        Place::new(source, at..at).error(Cause::Xml(message))
    })
}

fn read_bytes(path: &Path) -> Result<Vec<u8>, Cause> {
    let unreadable = |error: io::Error| Cause::Unreadable {
        path: path.to_owned(),
        error,
    };
    let bytes = regular_file_size(path).map_err(unreadable)?;
    if bytes > MAX_BYTES {
        return Err(Cause::FileTooLarge {
            path: path.to_owned(),
            bytes,
            limit: MAX_BYTES,
        });
    }
    std::fs::read(path).map_err(unreadable)
}

fn checked_utf8(path: &Path, bytes: Vec<u8>) -> Result<String, LoadError> {
    String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let text = String::from_utf8_lossy(error.as_bytes()).into_owned();
        let file = SourceFile::new(path.to_owned(), text);
        Place::new(&file, valid..valid).error(Cause::NotUtf8)
    })
}

fn start_tag(node: Node, source: &Arc<SourceFile>) -> Place {
    let whole = node.range();
    let attributes_end = node.attributes().map(|a| a.range().end).max();
    let name_end = whole.start + 1 + node.tag_name().name().len();
    let end = attributes_end.unwrap_or(name_end).min(whole.end);
    Place::new(source, whole.start..end)
}

/// The first of one to three numbers separated by dots.
fn major_version(text: &str) -> Option<u32> {
    let parts = text.trim().split('.').map(|part| part.parse().ok());
    let parts: Vec<u32> = parts.collect::<Option<_>>()?;
    (parts.len() <= 3).then_some(parts.first().copied())?
}

/// The offset in bytes of a line and a column, both counted from 1, the column in characters.
fn byte_offset(text: &str, row: u32, column: u32) -> usize {
    let lines = text.split_inclusive('\n').take(row as usize - 1);
    let line_start: usize = lines.map(str::len).sum();
    let line = &text[line_start..];
    let within = line.char_indices().nth(column as usize - 1);
    line_start + within.map_or(line.len(), |(byte, _)| byte)
}

/// Removes the " at row:column" at the end of the XML parser's message: the error shows its place.
fn without_position(message: &str) -> String {
    let is_position = |tail: &str| tail.chars().all(|c| c.is_ascii_digit() || c == ':');
    match message.rsplit_once(" at ") {
        Some((head, tail)) if is_position(tail) => head.to_owned(),
        _ => message.to_owned(),
    }
}
