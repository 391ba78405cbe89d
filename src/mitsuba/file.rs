//! Access to files that scenes name.

use std::fs;
use std::io;
use std::path::Path;

/// The size of a regular file in bytes. Anything else, such as a folder or a device, is an error.
pub fn regular_file_size(path: &Path) -> io::Result<u64> {
    let metadata = fs::metadata(path)?;
    if metadata.is_file() {
        Ok(metadata.len())
    } else {
        Err(io::Error::other("it is not a file"))
    }
}
