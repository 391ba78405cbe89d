//! All objects of a scene, from its files.

use std::cell::RefCell;
use std::path::{Path, PathBuf};

use super::nesting::check_nesting;
use super::object::Object;
use super::reader::Reader;
use super::search_path::SearchPath;
use crate::mitsuba::error::{LoadError, Warning};
use crate::mitsuba::source::Place;

/// The objects of a scene. The first is the scene itself.
#[derive(Debug)]
pub struct Tree {
    /// The objects, with references resolved and free of cycles.
    pub objects: Vec<Object>,
    /// Suspicious parts of the files.
    pub warnings: Vec<Warning>,
    search_path: SearchPath,
    /// The scene files, and the files that have been located.
    files: RefCell<Vec<PathBuf>>,
}

impl Tree {
    /// Reads the scene file at `path` and the files it includes.
    pub fn read(path: &Path, defines: &[(String, String)]) -> Result<Self, LoadError> {
        let mut reader = Reader::new(path, defines);
        reader.scene(path)?;
        let unused = reader.variables.unused().map(|name| Warning {
            place: None,
            text: format!("-D {name}: no file of the scene uses ${name}"),
        });
        let warnings = unused.chain(reader.warnings);
        let warnings = warnings.chain(reader.ids.duplicates()).collect();
        reader.ids.resolve_references(&mut reader.objects)?;
        check_nesting(&reader.objects)?;
        Ok(Self {
            objects: reader.objects,
            warnings,
            search_path: reader.search_path,
            files: RefCell::new(reader.files),
        })
    }

    /// The path of the mesh or image `name`, which is named at `place`.
    pub fn locate(&self, name: &str, place: &Place) -> PathBuf {
        let path = self.search_path.locate(name, place);
        self.files.borrow_mut().push(path.clone());
        path
    }

    /// The scene file, the files that it includes, and all files that have been located.
    pub fn into_files(self) -> Vec<PathBuf> {
        self.files.into_inner()
    }
}
