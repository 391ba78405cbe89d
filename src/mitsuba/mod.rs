//! Scene files: Mitsuba 3's XML, of version 3 and, with their old names, of version 0.x.
//!
//! What is modelled has Mitsuba 3's meaning and defaults. What is not modelled is an error that says
//! where it stands and what there is instead; only parameters that cannot change the values of a
//! still image are passed over. Reading takes two steps: `tree` makes objects with parameters out
//! of files, and one module for each kind of object makes a [`SceneDescription`] out of these.

mod attributes;
mod bsdf;
mod color;
mod document;
mod emitter;
mod error;
mod film;
mod ids;
mod integrator;
mod mesh;
mod nesting;
mod object;
mod parameter;
mod property;
mod scene;
mod sensor;
mod shape;
mod source;
mod substitution;
mod texture;
mod transform;
mod tree;
mod upgrade;
mod value;

use std::path::Path;

pub use error::{Cause, LoadError, Warning};
pub use mesh::MeshError;
pub use source::{Place, SourceFile};

use crate::scene::SceneDescription;

/// A scene as its files say it.
#[derive(Debug)]
pub struct Loaded {
    /// The scene.
    pub description: SceneDescription,
    /// What is strange about its files.
    pub warnings: Vec<Warning>,
}

/// What the user wants otherwise than the scene file says.
#[derive(Clone, Copy, Debug, Default)]
pub struct Overrides {
    /// Width and height of the image in pixels. The field of view follows as if the film said so.
    pub size: Option<[u32; 2]>,
}

/// Loads the scene file at `path`. `defines` are names and values for `$name`; they win over the
/// `<default>`s of the file.
///
/// # Errors
/// If a file is missing or broken, or says something that is not modelled.
pub fn load(path: &Path, defines: &[(String, String)]) -> Result<Loaded, LoadError> {
    load_with(path, defines, Overrides::default())
}

/// As [`load`], with some things otherwise than the scene file says.
///
/// # Errors
/// As [`load`].
pub fn load_with(
    path: &Path,
    defines: &[(String, String)],
    overrides: Overrides,
) -> Result<Loaded, LoadError> {
    let mut tree = tree::Tree::read(path, defines)?;
    let mut warnings = std::mem::take(&mut tree.warnings);
    let description = scene::build(&tree, overrides, &mut warnings)?;
    Ok(Loaded {
        description,
        warnings,
    })
}
