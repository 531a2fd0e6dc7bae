//! Atomic writing: an output is written under a temporary name and renamed when it is complete.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use tempfile::{Builder, NamedTempFile};

/// What is being written at the moment: to be removed on Ctrl-C. Locked while a temporary file is made, so that each is either in the
/// list or not there.
static TEMPORARIES: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn temporaries() -> MutexGuard<'static, Vec<PathBuf>> {
    TEMPORARIES.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes what is half written and ends the program.
///
/// The list stays locked until the program has ended, so that no other thread makes a temporary file after that.
pub fn leave(code: i32) -> ! {
    let mut temporaries = temporaries();
    for path in temporaries.drain(..) {
        // Nothing more can be done about a file that cannot be removed.
        let _ = std::fs::remove_file(path);
    }
    std::process::exit(code)
}

/// Whether [`write_atomically`] can begin: tries to make a temporary file where it would.
///
/// # Errors
///
/// What the system says, in words that need no path.
pub fn check_writable(path: &Path) -> io::Result<()> {
    if path.as_os_str().is_empty() {
        return Err(io::Error::other("the name is empty"));
    }
    match path.metadata() {
        Ok(data) if data.is_dir() => Err(io::Error::other("it is a folder")),
        Ok(data) if !data.is_file() => Ok(()),
        _ => {
            let _locked = temporaries();
            temporary_for(path).map(drop)
        }
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
    let (temporary, name) = {
        let mut list = temporaries();
        let temporary = temporary_for(path)?;
        let name = temporary.path().to_path_buf();
        list.push(name.clone());
        (temporary, name)
    };
    let keep_mode = |file: &File| match path.metadata() {
        Ok(old) => file.set_permissions(old.permissions()),
        Err(_) => Ok(()),
    };
    let result = fill(temporary.as_file())
        .and_then(|()| keep_mode(temporary.as_file()))
        .and_then(|()| temporary.persist(target_of(path)).map(drop).map_err(|e| e.error));
    temporaries().retain(|path| *path != name);
    result
}

/// Through a link to the file it stands for: a rename would replace the link.
fn target_of(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_path_buf())
}

/// A new file in the folder of `path`.
fn temporary_for(path: &Path) -> io::Result<NamedTempFile> {
    let target = target_of(path);
    let folder = target.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut builder = Builder::new();
    builder.prefix(".pointillist-").suffix(".tmp");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        // As for any new file: the umask limits the permissions.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder).map_err(|error| {
        // The system's message would name the temporary file.
        let folder = folder.display();
        let reason = match error.kind() {
            io::ErrorKind::NotFound => format!("the folder `{folder}` is not there"),
            io::ErrorKind::NotADirectory => format!("`{folder}` is not a folder"),
            io::ErrorKind::PermissionDenied => format!("the folder `{folder}` may not be written to"),
            kind => format!("in the folder `{folder}`: {kind}"),
        };
        io::Error::new(error.kind(), reason)
    })
}
