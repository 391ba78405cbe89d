//! The text of scene files, and places in it.

use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use miette::{MietteError, MietteSpanContents, SourceCode, SourceSpan, SpanContents};

/// Longest line that an error report shows, in bytes.
const MAX_SHOWN_LINE: usize = 400;

/// The text of one scene file.
pub struct SourceFile {
    path: PathBuf,
    text: String,
    /// The beginnings of lines and, in long lines, more bytes. Kept because every shape asks for its line.
    marks: Vec<Mark>,
}

/// A byte of the text of which line and column are known, both counted from 1.
#[derive(Clone, Copy)]
struct Mark {
    byte: usize,
    line: usize,
    column: usize,
}

/// Maximum number of bytes between two marks.
const MARK_DISTANCE: usize = 1024;

/// A byte that does not continue a UTF-8 sequence begins a character.
fn begins_character(byte: u8) -> bool {
    byte & 0xC0 != 0x80
}

fn marks(text: &str) -> Vec<Mark> {
    let mut next = Mark {
        byte: 0,
        line: 1,
        column: 1,
    };
    let mut marks = vec![next];
    let mut last = 0;
    for byte in text.bytes() {
        next.byte += 1;
        if byte == b'\n' {
            next.line += 1;
            next.column = 1;
        } else {
            next.column += usize::from(begins_character(byte));
        }
        if byte == b'\n' || next.byte - last == MARK_DISTANCE {
            marks.push(next);
            last = next.byte;
        }
    }
    marks
}

impl SourceFile {
    /// A file with `text`; messages name it by `path`.
    pub(super) fn new(path: PathBuf, text: String) -> Arc<Self> {
        let marks = marks(&text);
        Arc::new(Self { path, text, marks })
    }

    /// The path, as given on the command line or relative to a path given there.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The text.
    pub fn text(&self) -> &str {
        &self.text
    }
}

impl fmt::Debug for SourceFile {
    /// Without the text, which may be long.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("SourceFile").field(&self.path).finish()
    }
}

impl SourceCode for SourceFile {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        lines_before: usize,
        lines_after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        let found = self.text.read_span(span, lines_before, lines_after)?;
        Ok(Box::new(MietteSpanContents::new_named(
            self.path.display().to_string(),
            found.data(),
            *found.span(),
            found.line(),
            found.column(),
            found.line_count(),
        )))
    }
}

/// A range of the text of a scene file. Its `Display` is `path:line:column`, both counted from 1,
/// columns in characters.
#[derive(Clone, Debug)]
pub struct Place {
    file: Arc<SourceFile>,
    /// In bytes.
    span: Range<usize>,
}

impl Place {
    /// The bytes `span` of `file`.
    pub(super) fn new(file: &Arc<SourceFile>, span: Range<usize>) -> Self {
        let file = Arc::clone(file);
        Self { file, span }
    }

    /// The file.
    pub fn file(&self) -> &SourceFile {
        &self.file
    }

    /// Line and column of the start, from 1.
    pub fn line_and_column(&self) -> (usize, usize) {
        let bytes = self.file.text.as_bytes();
        let start = self.span.start.min(bytes.len());
        let after = self.file.marks.partition_point(|mark| mark.byte <= start);
        let mark = self.file.marks[after - 1];
        let between = bytes[mark.byte..start].iter();
        let characters = between.filter(|&&byte| begins_character(byte)).count();
        (mark.line, mark.column + characters)
    }

    /// The text of the range.
    pub(super) fn text(&self) -> &str {
        self.file.text.get(self.span.clone()).unwrap_or_default()
    }

    /// The range, for a report that marks the fault.
    pub(super) fn span(&self) -> SourceSpan {
        (self.span.start, self.span.len()).into()
    }

    /// True if the lines around the place are short enough for a report.
    pub(super) fn fits_in_a_report(&self) -> bool {
        let bytes = self.file.text.as_bytes();
        let start = self.span.start.min(bytes.len());
        let end = self.span.end.min(bytes.len());
        let head = bytes[..start].iter().rev().take_while(|&&b| b != b'\n');
        let tail = bytes[end..].iter().take_while(|&&b| b != b'\n');
        head.take(MAX_SHOWN_LINE).count() + tail.take(MAX_SHOWN_LINE).count() < MAX_SHOWN_LINE
            && end - start < MAX_SHOWN_LINE
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (line, column) = self.line_and_column();
        write!(f, "{}:{line}:{column}", self.file.path.display())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The definition: characters since the last line break.
    #[test]
    fn lines_and_columns_are_those_of_the_text() {
        let text = format!("a\né{}\n\n{}x", "ü€".repeat(2000), "é".repeat(1500));
        let file = SourceFile::new("a.xml".into(), text.clone());
        for (byte, _) in text.char_indices() {
            let before = &text[..byte];
            let line = before.split('\n').count();
            let column = before
                .rsplit('\n')
                .next()
                .map_or(0, |last| last.chars().count());
            let place = Place::new(&file, byte..byte);
            assert_eq!(place.line_and_column(), (line, column + 1), "{byte}");
        }
    }
}
