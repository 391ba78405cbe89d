//! Loads scene files in Mitsuba's XML format: versions 2 and 3, and the older names of version 0.x.
//!
//! Supported plugins and parameters have the meaning and the defaults of Mitsuba 3. Anything else
//! is an error that names its place and the alternatives; only parameters that cannot change the
//! values of a still image are ignored, among them those of methods that the user chooses. Loading takes two steps: `xml` turns files into objects
//! with parameters, then one module for each kind of object turns these into a
//! [`SceneDescription`]. A new plugin is a file in the module of its kind and an entry in that
//! module's list `PLUGINS`.
//!
//! ```
//! use metrolight::mitsuba::{Overrides, load, load_with};
//!
//! let path = std::path::Path::new("scenes/pool/scene.xml");
//! let variables = [("light_radius".to_string(), "0.2".to_string())];
//! let loaded = load_with(path, &variables, Overrides { size: Some([40, 30]) })?;
//! assert!(loaded.warnings.is_empty());
//! assert_eq!(loaded.description.film.width, 40);
//! assert!(load(std::path::Path::new("scenes/no-such.xml"), &[]).is_err());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod bsdf;
mod builder;
mod cie;
mod color;
mod emitter;
mod error;
mod field_of_view;
mod file;
mod film;
mod ignored;
mod image_file;
mod integrator;
mod mesh;
mod scene;
mod sensor;
mod shape;
mod source;
mod spectrum;
mod texture;
mod xml;

use std::path::{Path, PathBuf};

pub use builder::Overrides;
pub use error::{Cause, LoadError, Warning};
pub use film::MAX_PIXELS;
pub use mesh::MeshError;
pub use source::{Place, SourceFile};

use crate::scene::SceneDescription;

/// A scene loaded from files.
#[derive(Debug)]
pub struct Loaded {
    /// The scene.
    pub description: SceneDescription,
    /// Suspicious parts of its files.
    pub warnings: Vec<Warning>,
    /// All files that were read: the scene file, included files, meshes, images. A file that is read several
    /// times may be named several times.
    pub files: Vec<PathBuf>,
}

/// Loads the scene file at `path`. `defines` are names and values for `$name`; they take precedence
/// over the `<default>`s of the file.
///
/// # Errors
/// If a file is missing or invalid, or uses a feature that is not supported.
pub fn load(path: &Path, defines: &[(String, String)]) -> Result<Loaded, LoadError> {
    load_with(path, defines, Overrides::default())
}

/// As [`load`], with `overrides` in place of what the scene file specifies.
///
/// # Errors
/// As [`load`].
pub fn load_with(
    path: &Path,
    defines: &[(String, String)],
    overrides: Overrides,
) -> Result<Loaded, LoadError> {
    let mut tree = xml::Tree::read(path, defines)?;
    let mut warnings = std::mem::take(&mut tree.warnings);
    let description = scene::build(&tree, overrides, &mut warnings)?;
    Ok(Loaded {
        description,
        warnings,
        files: tree.into_files(),
    })
}
