//! Where results go that cannot be written to the place that was asked for.

use std::path::Path;

use miette::{Report, miette};

/// Writes the results of a long computation again, by `write` into a new directory: beside those that could
/// not be written to `directory` because of `error` or, if that fails too, in the temporary folder. Returns
/// the error, which says where the results are.
pub fn rescue(
    directory: &Path,
    name: &str,
    error: &Report,
    write: impl Fn(&Path) -> miette::Result<()>,
) -> Report {
    for place in [directory, &std::env::temp_dir()] {
        let new = tempfile::Builder::new()
            .prefix(&format!("{name}-"))
            .tempdir_in(place);
        if let Ok(new) = new
            && write(new.path()).is_ok()
        {
            return miette!(
                "{error}; the results are in {} instead",
                new.keep().display()
            );
        }
    }
    miette!("{error}; nor could the results be written to the temporary folder")
}
