//! Atomic replacement of files.

use std::fs::{self, File, OpenOptions, Permissions};
use std::io::{self, BufWriter, Read, Seek, Write};
use std::path::{Path, PathBuf};

use fs4::FileExt;
use tempfile::{NamedTempFile, TempPath};

/// Why a file could not be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {}: {cause}", path.display())]
pub struct WriteError {
    /// The file.
    pub path: PathBuf,
    /// The error of the operating system or of the encoder.
    pub cause: io::Error,
}

impl WriteError {
    fn new(path: &Path, cause: io::Error) -> Self {
        let path = path.into();
        Self { path, cause }
    }
}

/// A file that is written completely and has not yet replaced the one of its name. Several files that
/// belong together are staged first and committed when all of them are written. A staged file that is
/// dropped leaves nothing.
#[derive(Debug)]
pub struct StagedFile {
    path: PathBuf,
    place: Place,
}

#[derive(Debug)]
enum Place {
    /// A file beside the one to be replaced, which is locked while it is open.
    Beside {
        file: File,
        temporary: TempPath,
        target: PathBuf,
    },
    /// The content for a device or a pipe, which cannot be replaced.
    Through(File),
}

impl StagedFile {
    /// Writes a file under a temporary name in the directory of `path`. If `path` is a symbolic link, the
    /// file that it names will be replaced, not the link.
    ///
    /// # Errors
    /// If the directory does not exist or is not writable, the disk is full, or `write` fails.
    pub fn write(
        path: &Path,
        write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
    ) -> Result<Self, WriteError> {
        let stage = || {
            if is_special(path) {
                return Ok(Place::Through(written(tempfile::tempfile()?, write)?));
            }
            let target = target(path)?;
            let (file, temporary) = create_beside(&target)?.into_parts();
            let file = written(file, write)?;
            Ok(Place::Beside {
                file,
                temporary,
                target,
            })
        };
        let place = stage().map_err(|cause| WriteError::new(path, cause))?;
        let path = path.into();
        Ok(Self { path, place })
    }

    /// Gives the file its name: `path` is at any time the old file or the complete new one.
    ///
    /// # Errors
    /// If the file cannot be renamed.
    pub fn commit(self) -> Result<(), WriteError> {
        let done = match self.place {
            Place::Beside {
                file,
                temporary,
                target,
            } => {
                drop(file);
                temporary.persist(&target).map_err(|error| error.error)
            }
            Place::Through(content) => copy_to(content, &self.path),
        };
        done.map_err(|cause| WriteError::new(&self.path, cause))
    }
}

/// Writes a file under a temporary name in the same directory and renames it at the end: see
/// [`StagedFile`].
///
/// # Errors
/// As for [`StagedFile`].
pub fn replace_file(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<(), WriteError> {
    StagedFile::write(path, write)?.commit()
}

/// Checks that all of `files`, each with the number of bytes that it may take, can be written together.
/// Removes the temporary files that processes have left there that were killed while they wrote.
///
/// # Errors
/// As for [`StagedFile`], or if a path is a directory.
pub fn check_writable<'a>(
    files: impl IntoIterator<Item = (&'a Path, u64)>,
) -> Result<(), WriteError> {
    // All of the room is taken before any is given back.
    let mut reserved = Vec::new();
    for (path, bytes) in files {
        let file = reserve(path, bytes).map_err(|cause| WriteError::new(path, cause))?;
        reserved.push(file.map(NamedTempFile::into_temp_path));
    }
    Ok(())
}

fn reserve(path: &Path, bytes: u64) -> io::Result<Option<NamedTempFile>> {
    if path.is_dir() {
        return Err(io::ErrorKind::IsADirectory.into());
    }
    if is_special(path) {
        return Ok(None);
    }
    let target = target(path)?;
    let file = create_beside(&target)?;
    remove_abandoned(directory_of(&target));
    match file.as_file().allocate(bytes) {
        // Not every file system can reserve room.
        Err(error) if error.kind() == io::ErrorKind::Unsupported => {}
        Err(error) => {
            let message = format!("{bytes} bytes are needed: {error}");
            return Err(io::Error::new(error.kind(), message));
        }
        Ok(()) => {}
    }
    Ok(Some(file))
}

/// True for a device, a pipe or a socket.
fn is_special(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|metadata| !metadata.is_file() && !metadata.is_dir())
}

/// Calls `write`, and waits until the content is on the disk.
fn written(
    file: File,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> io::Result<File> {
    let mut writer = BufWriter::new(file);
    write(&mut writer)?;
    let file = writer
        .into_inner()
        .map_err(io::IntoInnerError::into_error)?;
    file.sync_all()?;
    Ok(file)
}

fn copy_to(mut content: File, path: &Path) -> io::Result<()> {
    content.rewind()?;
    // `io::copy` would lend the pages of the temporary file to a pipe, from which they vanish with the file.
    let mut bytes = Vec::new();
    content.read_to_end(&mut bytes)?;
    let mut device = OpenOptions::new().write(true).open(path)?;
    device.write_all(&bytes)?;
    device.flush()
}

/// Symbolic links in a row that are followed, as in Linux.
const MAX_LINKS: usize = 40;

/// The file that `path` names, if it is a symbolic link, even one to a file that does not exist.
fn target(path: &Path) -> io::Result<PathBuf> {
    let mut target = path.to_owned();
    for _ in 0..MAX_LINKS {
        match fs::read_link(&target) {
            Ok(next) => target = directory_of(&target).join(next),
            Err(_) => return Ok(target),
        }
    }
    Err(io::Error::other("too many symbolic links"))
}

fn directory_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// The names of temporary files begin with this.
const PREFIX: &str = ".metrolight-";

/// Length of the random rest of these names.
const RANDOM: usize = 6;

/// Creates a temporary file in the directory of `target`, and locks it.
fn create_beside(target: &Path) -> io::Result<NamedTempFile> {
    let directory = directory_of(target);
    if !directory.is_dir() {
        let message = format!("there is no directory {}", directory.display());
        return Err(io::Error::new(io::ErrorKind::NotFound, message));
    }
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX).rand_bytes(RANDOM);
    if let Some(permissions) = default_permissions() {
        builder.permissions(permissions);
    }
    loop {
        // Without the name of the temporary file, which the user does not know.
        let file = builder.tempfile_in(directory);
        let file = file.map_err(|error| io::Error::from(error.kind()))?;
        // Without locks, nothing is removed as abandoned. With them, another process may have taken the
        // file for abandoned before it was locked.
        if file.as_file().lock().is_err() || file.path().exists() {
            return Ok(file);
        }
    }
}

/// Removes the temporary files in a directory that no living process has locked.
fn remove_abandoned(directory: &Path) {
    let entries = fs::read_dir(directory).into_iter().flatten().flatten();
    let is_temporary = |entry: &fs::DirEntry| {
        let name = entry.file_name();
        let random = name.to_str().and_then(|name| name.strip_prefix(PREFIX));
        let is_name = random.is_some_and(|random| {
            random.len() == RANDOM && random.chars().all(|c| c.is_ascii_alphanumeric())
        });
        is_name && entry.file_type().is_ok_and(|kind| kind.is_file())
    };
    for entry in entries.filter(is_temporary) {
        // A file that cannot be removed does no harm.
        if let Ok(file) = File::open(entry.path())
            && file.try_lock().is_ok()
        {
            let _ = fs::remove_file(entry.path());
        }
    }
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
