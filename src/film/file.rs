//! Files that are replaced whole or left alone.

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
    /// What the operating system or the encoder said.
    pub cause: io::Error,
}

/// Writes a file under a temporary name in the same directory and renames it at the end: whoever
/// looks at `path` sees the old file or the whole new one.
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

/// Checks that [`replace_file`] has a chance to succeed, by creating and deleting a temporary file.
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
    if let Some(permissions) = usual_permissions() {
        builder.permissions(permissions);
    }
    // The name of the temporary file means nothing to the reader of a message.
    builder
        .tempfile_in(directory)
        .map_err(|error| error.kind().into())
}

/// What a new file may be used for by default (the umask narrows it): a temporary file's own
/// default is to be private.
#[cfg(unix)]
fn usual_permissions() -> Option<Permissions> {
    use std::os::unix::fs::PermissionsExt;
    Some(Permissions::from_mode(0o666))
}

#[cfg(not(unix))]
fn usual_permissions() -> Option<Permissions> {
    None
}
