//! One scene file: its text, its XML and its version.

use std::io;
use std::path::Path;
use std::sync::Arc;

use encoding_rs::{Encoding, WINDOWS_1252};
use roxmltree::{Document, Node};

use super::object::Tag;
use crate::mitsuba::error::{Cause, LoadError, Located, Warning};
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
pub fn read(
    path: &Path,
    fail: impl Fn(Cause) -> LoadError,
    warnings: &mut Vec<Warning>,
) -> Result<Arc<SourceFile>, LoadError> {
    let bytes = read_bytes(path).map_err(fail)?;
    match String::from_utf8(bytes) {
        Ok(text) => Ok(SourceFile::new(path.to_owned(), text)),
        Err(error) => {
            let valid = error.utf8_error().valid_up_to();
            other_encoding(path, error.as_bytes(), valid, warnings)
        }
    }
}

/// Parses `xml`, the text of the file `source` made well-formed.
pub fn parse<'a>(source: &Arc<SourceFile>, xml: &'a str) -> Result<Document<'a>, LoadError> {
    if !begins_like_a_scene(xml) {
        return Err(Place::new(source, 0..0).error(Cause::NotXml));
    }
    if let Some(tag) = overlong_tag(xml) {
        let cause = Cause::TooManyAttributes(MAX_ATTRIBUTES);
        return Err(Place::new(source, tag..tag).error(cause));
    }
    Document::parse(xml).map_err(|error| {
        let position = error.pos();
        let at = byte_offset(xml, position.row, position.col);
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

/// The text of bytes that are UTF-8 only up to `valid`: in the encoding of the byte order mark or of the
/// declaration, else in Windows-1252, of which Latin-1 is a part.
fn other_encoding(
    path: &Path,
    bytes: &[u8],
    valid: usize,
    warnings: &mut Vec<Warning>,
) -> Result<Arc<SourceFile>, LoadError> {
    let marked = Encoding::for_bom(bytes).map(|(encoding, _)| encoding);
    let declared = marked.or_else(|| declared_encoding(&bytes[..valid]));
    let encoding = declared.unwrap_or(WINDOWS_1252);
    let (text, _, is_malformed) = encoding.decode(bytes);
    let source = SourceFile::new(path.to_owned(), text.into_owned());
    let at = valid.min(source.text().len());
    let place = Place::new(&source, at..at);
    if is_malformed {
        return Err(place.error(Cause::Encoding(encoding.name())));
    }
    if declared.is_none() {
        let guess = "the file is not UTF-8 and declares no other encoding: read as Windows-1252";
        warnings.push(place.warning(guess));
    }
    Ok(source)
}

/// The encoding in the declaration `<?xml ... encoding="NAME"?>` at the start of a file.
fn declared_encoding(start: &[u8]) -> Option<&'static Encoding> {
    let text = std::str::from_utf8(start).ok()?;
    let (declaration, _) = text.trim_start().strip_prefix("<?xml")?.split_once("?>")?;
    let (_, value) = declaration.split_once("encoding")?;
    let label = value.split(['"', '\'']).nth(1)?;
    Encoding::for_label(label.as_bytes())
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

/// True if XML, a comment, or an element of a scene file begins the text. Other files are not quoted in messages.
fn begins_like_a_scene(text: &str) -> bool {
    let text = text.trim_start_matches('\u{feff}').trim_start();
    let names = Tag::ALL.iter().map(|(name, _)| *name);
    let mut beginnings = ["?", "!"].into_iter().chain(names);
    text.strip_prefix('<')
        .is_some_and(|text| beginnings.any(|begin| text.starts_with(begin)))
}

/// Maximum number of attributes of an element. The time of the parser grows with the square of their number.
const MAX_ATTRIBUTES: usize = 256;

/// The offset in bytes of the first start tag with more than [`MAX_ATTRIBUTES`] attributes.
fn overlong_tag(text: &str) -> Option<usize> {
    let mut at = 0;
    while let Some(offset) = text[at..].find('<') {
        let open = at + offset;
        let tag = &text[open..];
        let skipped = [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>")];
        let skipped = skipped.iter().find(|(begin, _)| tag.starts_with(begin));
        let length = match skipped {
            Some((begin, end)) => tag[begin.len()..].find(end).map(|i| begin.len() + i),
            None => {
                let (length, attributes) = scan_tag(tag);
                if attributes > MAX_ATTRIBUTES {
                    return Some(open);
                }
                length
            }
        };
        at = open + length?;
    }
    None
}

/// The length of a tag up to its `>`, and the number of its quoted values.
fn scan_tag(tag: &str) -> (Option<usize>, usize) {
    let (mut quote, mut values) = (None, 0);
    for (i, byte) in tag.bytes().enumerate() {
        match (quote, byte) {
            (None, b'>') => return (Some(i), values),
            (None, b'"' | b'\'') => quote = Some(byte),
            (Some(open), _) if byte == open => {
                quote = None;
                values += 1;
            }
            _ => {}
        }
    }
    (None, values)
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
