//! Atomic replacement of files.

use std::fs::{File, Permissions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

/// Why a file could not be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {}: {cause}", path.display())]
pub struct WriteError {
    /// The file.
    pub path: PathBuf,
    /// The error of the operating system or of the encoder.
    pub cause: io::Error,
}

/// Writes a file under a temporary name in the same directory and renames it at the end: `path` is at
/// any time the old file or the complete new one.
///
/// # Errors
/// If the directory does not exist or is not writable, the disk is full, or `write` fails.
pub fn replace_file(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<(), WriteError> {
    let replace = || {
        let (file, temporary) = create_beside(path)?.into_parts();
        let mut writer = BufWriter::new(file);
        write(&mut writer)?;
        writer.flush()?;
        temporary.persist(path).map_err(|error| error.error)
    };
    replace().map_err(|cause| error(path, cause))
}

/// Checks that [`replace_file`] can succeed, by creating and deleting a temporary file.
///
/// # Errors
/// As for [`replace_file`], or if `path` is a directory.
pub fn check_writable(path: &Path) -> Result<(), WriteError> {
    if path.is_dir() {
        return Err(error(path, io::ErrorKind::IsADirectory.into()));
    }
    create_beside(path).map_err(|cause| error(path, cause))?;
    Ok(())
}

fn error(path: &Path, cause: io::Error) -> WriteError {
    WriteError {
        path: path.into(),
        cause,
    }
}

fn create_beside(path: &Path) -> io::Result<NamedTempFile> {
    let directory = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    if !directory.is_dir() {
        let message = format!("there is no directory {}", directory.display());
        return Err(io::Error::new(io::ErrorKind::NotFound, message));
    }
    let mut builder = tempfile::Builder::new();
    builder.prefix(".metrolight-");
    if let Some(permissions) = default_permissions() {
        builder.permissions(permissions);
    }
    // Without the name of the temporary file, which the user does not know.
    builder
        .tempfile_in(directory)
        .map_err(|error| error.kind().into())
}

/// Permissions of new files, which the umask restricts. Temporary files are private by default.
#[cfg(unix)]
fn default_permissions() -> Option<Permissions> {
    use std::os::unix::fs::PermissionsExt;
    Some(Permissions::from_mode(0o666))
}

#[cfg(not(unix))]
fn default_permissions() -> Option<Permissions> {
    None
}
