//! The directory that a report reads.

use std::cell::RefCell;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use metrolight::film::{Decode, read_image};
use miette::miette;
use serde::de::DeserializeOwned;

use crate::commands::warn;

/// The input of `report`, in error messages.
pub const EXPECTED: &str =
    "expected a directory that converge, diagnose, compare, strategies or render wrote into";

/// Larger pictures are left out of the page.
const MAX_PICTURE_BYTES: usize = 16 << 20;

/// A directory with results of other commands.
pub struct Folder<'a> {
    pub path: &'a Path,
    /// File names in it, sorted.
    pub names: Vec<PathBuf>,
    /// The files that have been read.
    read: RefCell<Vec<PathBuf>>,
}

/// A picture in the page.
pub struct Figure {
    /// The file as a data URI.
    pub uri: String,
    pub caption: String,
}

impl<'a> Folder<'a> {
    /// Lists the directory.
    pub fn open(path: &'a Path) -> miette::Result<Self> {
        let read = || {
            let names = fs::read_dir(path)?.map(|entry| Ok(PathBuf::from(entry?.file_name())));
            names.collect::<std::io::Result<Vec<_>>>()
        };
        let mut names = read().map_err(|error| {
            let cause = match error.kind() {
                ErrorKind::NotFound => "there is no such directory".into(),
                ErrorKind::NotADirectory => "it is a file".into(),
                _ => error.to_string(),
            };
            miette!("cannot read {}: {cause}; {EXPECTED}", path.display())
        })?;
        names.sort();
        Ok(Self {
            path,
            names,
            read: RefCell::default(),
        })
    }

    /// The path of a file that is about to be read.
    pub fn locate(&self, name: impl AsRef<Path>) -> PathBuf {
        let path = self.path.join(name);
        self.read.borrow_mut().push(path.clone());
        path
    }

    /// The files that have been read.
    pub fn inputs(&self) -> Vec<PathBuf> {
        self.read.borrow().clone()
    }

    /// The contents of a file; `None` if it is not in the directory. Names of files outside the
    /// directory, such as `../a`, are never read.
    fn read(&self, name: &str) -> miette::Result<Option<Vec<u8>>> {
        if !self.names.iter().any(|known| known.as_os_str() == name) {
            return Ok(None);
        }
        let path = self.locate(name);
        let bytes = fs::read(&path);
        let bytes = bytes.map_err(|error| miette!("cannot read {}: {error}", path.display()))?;
        Ok(Some(bytes))
    }

    /// The error of a file that is not as `command` wrote it.
    fn broken(&self, name: &str, command: &str, cause: impl std::fmt::Display) -> miette::Report {
        miette!(
            "{} is not what `metrolight {command}` writes: {cause}. Run {command} again, or remove the \
             file",
            self.path.join(name).display()
        )
    }

    /// A JSON file that `command` wrote.
    pub fn json<T: DeserializeOwned>(
        &self,
        name: &str,
        command: &str,
    ) -> miette::Result<Option<T>> {
        let Some(bytes) = self.read(name)? else {
            return Ok(None);
        };
        let parsed = serde_json::from_slice(&bytes);
        parsed
            .map(Some)
            .map_err(|error| self.broken(name, command, error))
    }

    /// A text file that `command` wrote.
    pub fn text(&self, name: &str, command: &str) -> miette::Result<Option<String>> {
        let Some(bytes) = self.read(name)? else {
            return Ok(None);
        };
        let text = String::from_utf8(bytes);
        text.map(Some)
            .map_err(|error| self.broken(name, command, error))
    }

    /// An SVG chart that `command` wrote. As an image it cannot run scripts, and its ids do not clash
    /// with those of the page.
    pub fn chart(
        &self,
        name: &str,
        command: &str,
        caption: impl Into<String>,
    ) -> miette::Result<Option<Figure>> {
        let Some(svg) = self.text(name, command)? else {
            return Ok(None);
        };
        let document = roxmltree::Document::parse(&svg);
        let document = document.map_err(|error| self.broken(name, command, error))?;
        let root = document.root_element().tag_name();
        if (root.name(), root.namespace()) != ("svg", Some("http://www.w3.org/2000/svg")) {
            return Err(self.broken(name, command, "it is not an SVG document"));
        }
        Ok(self.figure(name, "svg+xml", svg.as_bytes(), caption.into()))
    }

    /// A PNG file that `command` wrote.
    pub fn picture(
        &self,
        name: &str,
        command: &str,
        caption: impl Into<String>,
    ) -> miette::Result<Option<Figure>> {
        let Some(bytes) = self.read(name)? else {
            return Ok(None);
        };
        let path = self.path.join(name);
        read_image(&path, Decode::Srgb).map_err(|error| self.broken(name, command, error))?;
        if !bytes.starts_with(b"\x89PNG") {
            return Err(self.broken(name, command, "it is not a PNG file"));
        }
        Ok(self.figure(name, "png", &bytes, caption.into()))
    }

    fn figure(&self, name: &str, kind: &str, bytes: &[u8], caption: String) -> Option<Figure> {
        if bytes.len() > MAX_PICTURE_BYTES {
            warn([format!(
                "{} is left out: it is larger than {} MiB",
                self.path.join(name).display(),
                MAX_PICTURE_BYTES >> 20
            )]);
            return None;
        }
        Some(Figure {
            uri: format!("data:image/{kind};base64,{}", STANDARD.encode(bytes)),
            caption,
        })
    }
}
