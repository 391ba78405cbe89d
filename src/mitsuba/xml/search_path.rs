//! Where files named in a scene are looked for.

use std::path::{Path, PathBuf};

use crate::mitsuba::source::Place;

/// The folders of `<path>`, the last given first, and after them the folder of the scene file.
#[derive(Debug)]
pub struct SearchPath(Vec<PathBuf>);

impl SearchPath {
    /// The folder of the scene file at `path`.
    pub fn new(path: &Path) -> Self {
        Self(vec![parent(path)])
    }

    /// Adds a folder before the others.
    pub fn add(&mut self, folder: PathBuf) {
        self.0.insert(0, folder);
    }

    /// The path of the mesh or image `name`: in one of these folders or, if none has it, in the
    /// folder of the file that names it at `place`.
    pub fn locate(&self, name: &str, place: &Place) -> PathBuf {
        let own = folder_of(place);
        first_with(name, self.0.iter().chain([&own]))
    }

    /// The path of the included file `name`: in the folder of the file that names it at `place` or,
    /// if that does not have it, in one of these folders.
    pub fn locate_include(&self, name: &str, place: &Place) -> PathBuf {
        let own = folder_of(place);
        first_with(name, [&own].into_iter().chain(&self.0))
    }
}

/// The folder of the file in which `place` is.
pub fn folder_of(place: &Place) -> PathBuf {
    parent(place.file().path())
}

fn parent(path: &Path) -> PathBuf {
    path.parent().map(Path::to_owned).unwrap_or_default()
}

/// The path of `name` in the first of the folders that has it; in the very first if none has.
fn first_with<'a>(name: &str, folders: impl Iterator<Item = &'a PathBuf>) -> PathBuf {
    let mut candidates = folders.map(|folder| folder.join(name)).peekable();
    let first = candidates.peek().cloned().unwrap_or_default();
    candidates.find(|path| path.exists()).unwrap_or(first)
}
