//! Outputs that are either there as a whole or not at all.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use tempfile::Builder;

/// What is being written at the moment: to be removed on Ctrl-C.
static TEMPORARIES: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn temporaries() -> MutexGuard<'static, Vec<PathBuf>> {
    TEMPORARIES.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes what is half written, for a program that is about to leave.
pub fn remove_temporaries() {
    for path in temporaries().drain(..) {
        // Nothing more can be done about a file that cannot be removed.
        let _ = std::fs::remove_file(path);
    }
}

/// Writes a file under a temporary name in the same folder and renames it once `write` has succeeded.
///
/// A file that is replaced keeps its mode; a new one gets what the umask leaves.
///
/// Something that is there and no plain file (a pipe, a device) is written to as it is.
///
/// # Errors
///
/// What `write` says, or the system; the old file is then untouched.
pub fn write_atomically(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&File>) -> io::Result<()>,
) -> io::Result<()> {
    let fill = |file: &File| {
        let mut buffered = BufWriter::new(file);
        write(&mut buffered)?;
        buffered.flush()
    };
    if path.metadata().is_ok_and(|data| !data.is_file() && !data.is_dir()) {
        return fill(&File::create(path)?);
    }
    // Through a link to the file it stands for: a rename would replace the link.
    let path = &path.canonicalize().unwrap_or_else(|_| path.to_path_buf());
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut builder = Builder::new();
    builder.prefix(".pointillist-").suffix(".tmp");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        // As for any new file: the umask takes from it what the user wants taken.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let temporary = builder.tempfile_in(folder)?;
    let name = temporary.path().to_path_buf();
    temporaries().push(name.clone());
    let keep_mode = |file: &File| match path.metadata() {
        Ok(old) => file.set_permissions(old.permissions()),
        Err(_) => Ok(()),
    };
    let result = fill(temporary.as_file())
        .and_then(|()| keep_mode(temporary.as_file()))
        .and_then(|()| temporary.persist(path).map(drop).map_err(|e| e.error));
    temporaries().retain(|path| *path != name);
    result
}
