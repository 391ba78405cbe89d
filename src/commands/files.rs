//! The files that a command will write: none of them is a file that it reads.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

use metrolight::film::check_writable;
use miette::{IntoDiagnostic, bail, miette};
use same_file::Handle;

/// What an output holds, which limits its size.
#[derive(Clone, Copy)]
pub enum Content {
    /// A linear image with this number of layers, itself included.
    Linear { layers: u64 },
    /// An image with 8 bits per channel.
    Preview,
    /// Text, or a chart.
    Text,
}

impl Content {
    /// Upper limit of the size in bytes, for images of `pixels` pixels.
    fn bytes(self, pixels: u64) -> u64 {
        /// For headers, statistics and labels.
        const OTHER: u64 = 1 << 16;
        let per_pixel = match self {
            Self::Linear { layers } => layers * 3 * 4,
            Self::Preview => 4,
            Self::Text => 0,
        };
        pixels.saturating_mul(per_pixel).saturating_add(OTHER)
    }
}

/// A file that will be written.
struct Output {
    path: PathBuf,
    content: Content,
    /// The option that names it.
    option: &'static str,
}

impl Output {
    /// The error that the output is the same file as `input`.
    fn replaces(&self, input: &Path) -> miette::Report {
        let is = match self.path == input {
            true => "is also read by this command".into(),
            false => format!(
                "is the same file as {}, which this command reads",
                input.display()
            ),
        };
        let (path, option) = (self.path.display(), self.option);
        miette!("the output {path} {is}: choose another name with {option}")
    }
}

/// Maximum number of files that are open at a time.
const MAX_OPEN: usize = 64;

/// The files that a command will write.
#[derive(Default)]
pub struct OutputFiles(Vec<Output>);

impl OutputFiles {
    /// Adds a file, which `option` names.
    pub fn add(&mut self, path: impl Into<PathBuf>, content: Content, option: &'static str) {
        self.0.push(Output {
            path: path.into(),
            content,
            option,
        });
    }

    /// Fails if one of the files cannot be written, or if the disk has no room for all of them with images
    /// of `pixels` pixels.
    pub fn check_writable(&self, pixels: u64) -> miette::Result<()> {
        let files = self.0.iter();
        let files = files.map(|output| (&*output.path, output.content.bytes(pixels)));
        check_writable(files).into_diagnostic()
    }

    /// Fails if two of the files are one, or if one of them is one of `inputs`: under its name, another path
    /// to it, or a link.
    pub fn protect<P: AsRef<Path>>(&self, inputs: &[P]) -> miette::Result<()> {
        self.check_distinct()?;
        // An identity keeps its file open.
        self.0.chunks(MAX_OPEN).try_for_each(|outputs| {
            let existing = outputs.iter();
            let existing = existing.filter_map(|output| Some((handle(&output.path)?, output)));
            let existing: HashMap<Handle, &Output> = existing.collect();
            let inputs = inputs.iter().map(AsRef::as_ref);
            inputs
                .filter(|_| !existing.is_empty())
                .try_for_each(
                    |input| match handle(input).and_then(|input| existing.get(&input)) {
                        Some(output) => Err(output.replaces(input)),
                        None => Ok(()),
                    },
                )
        })
    }

    /// Files that do not exist are the same if their names differ only in case, as on some file systems.
    fn check_distinct(&self) -> miette::Result<()> {
        let mut known: HashMap<PathBuf, &Output> = HashMap::new();
        for output in &self.0 {
            let folder = output.path.parent().unwrap_or(Path::new(""));
            let folder = match folder.as_os_str().is_empty() {
                true => Path::new("."),
                false => folder,
            };
            let folder = folder.canonicalize().unwrap_or_else(|_| folder.into());
            let name = output.path.file_name().unwrap_or_default();
            let key = match output.path.canonicalize() {
                Ok(whole) => whole,
                Err(_) => folder.join(name.to_ascii_lowercase()),
            };
            if let Some(other) = known.insert(key, output) {
                bail!(
                    "the outputs {} and {} are one file: choose another name with {}",
                    other.path.display(),
                    output.path.display(),
                    output.option
                );
            }
        }
        Ok(())
    }
}

/// The identity of an existing regular file.
fn handle(path: &Path) -> Option<Handle> {
    // To open a pipe may wait for ever.
    let is_file = fs::metadata(path).is_ok_and(|metadata| metadata.is_file());
    is_file.then(|| Handle::from_path(path).ok()).flatten()
}
