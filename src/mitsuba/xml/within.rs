//! Where a parameter is given.

use super::document::File;
use super::search_path::SearchPath;

/// The surroundings of a parameter.
pub struct Within<'a> {
    /// The file.
    pub file: &'a File,
    /// Where files that it names are looked for.
    pub search_path: &'a SearchPath,
}
