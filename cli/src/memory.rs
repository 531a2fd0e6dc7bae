//! How much memory was used, how much there is, and whether something fits: the only place that decides.
//!
//! What comes from outside (a file's header, an option) is asked about here before memory is allocated for it, because a
//! failed allocation ends the program without a message. There is as much as the system can give without swapping, the
//! container it runs in, and the limit on its address space (`ulimit -v`), whichever is least. `--memory` replaces what
//! the system and the container say.

use crate::input_error::InputError;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::time::SystemTime;
use sysinfo::{MemoryRefreshKind, RefreshKind, System};

/// What `--memory` allows, set once by the first command.
static ALLOWED: OnceLock<u64> = OnceLock::new();

/// Something that grows is asked about each time it has grown by this much.
const STEP: u64 = 16 << 20;

/// The way out that every message offers.
const HELP: &str = "`--memory SIZE` (or POINTILLIST_MEMORY) says how much may be used";

/// Something that does not fit.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{what} {} of memory, and {}", human(*.needed), left(*.available))]
pub struct MemoryError {
    /// What would take it, with its verb: `16384×16384 pixels take`.
    pub what: String,
    /// Bytes it would take.
    pub needed: u128,
    /// Bytes there are.
    pub available: u64,
}

impl MemoryError {
    /// The error of the file that asks for so much.
    #[must_use]
    pub fn in_file(&self, name: impl Into<String>) -> InputError {
        InputError::of_file(name, self.to_string()).with_help(HELP)
    }

    /// The message with the way out, for what no file is to blame for.
    #[must_use]
    pub fn with_help(&self) -> String {
        format!("{self}; {HELP}")
    }
}

/// Sets how much this process may hold, in the place of what the system says.
pub fn allow(bytes: u64) {
    // A second command in one process, which only tests have, keeps the first's.
    let _ = ALLOWED.set(bytes);
}

/// The most this process has held at once, or 0 where that cannot be known.
pub fn peak_bytes() -> u64 {
    kibibytes("/proc/self/status", "VmHWM:").unwrap_or(0)
}

/// What could be had now, or `None` where that cannot be known.
pub fn available_bytes() -> Option<u64> {
    let allowed = ALLOWED.get().map(|allowed| {
        let used = kibibytes("/proc/self/status", "VmRSS:").unwrap_or(0);
        allowed.saturating_sub(used)
    });
    [allowed.or_else(system_bytes), address_space()].into_iter().flatten().min()
}

/// Whether `needed` bytes can be had now; `what` begins the sentence and has its verb: `16384×16384 pixels take`.
///
/// # Errors
///
/// [`MemoryError`] if they cannot.
pub fn check(needed: u128, what: impl FnOnce() -> String) -> Result<(), MemoryError> {
    match available_bytes() {
        Some(available) if needed > u128::from(available) => {
            Err(MemoryError { what: what(), needed, available })
        }
        _ => Ok(()),
    }
}

/// What has been read since the last [`forget_files`], and what it was like then.
static FILES: Mutex<BTreeMap<PathBuf, (SystemTime, u64)>> = Mutex::new(BTreeMap::new());

/// The files that [`read`] has read since the last [`forget_files`], with the time of their last change and their length at that moment.
pub fn files_read() -> BTreeMap<PathBuf, (SystemTime, u64)> {
    FILES.lock().unwrap_or_else(PoisonError::into_inner).clone()
}

/// Begins a new list of [`files_read`].
pub fn forget_files() {
    FILES.lock().unwrap_or_else(PoisonError::into_inner).clear();
}

/// All bytes of a file, if they fit.
///
/// # Errors
///
/// As [`read_to_end`].
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
    let file = File::open(path)?;
    // Devices and pipes have no length.
    let data = file.metadata()?;
    let length = data.len();
    if let Ok(changed) = data.modified() {
        FILES.lock().unwrap_or_else(PoisonError::into_inner).insert(path.to_path_buf(), (changed, length));
    }
    read_to_end(file, length, "its bytes take")
}

/// All bytes of an input, if they fit. `expected` is how many there probably are, or 0; `what` begins the message of what
/// does not fit: `its bytes take`.
///
/// # Errors
///
/// What the input says, or [`io::ErrorKind::OutOfMemory`] with a message for what does not fit.
pub fn read_to_end(mut input: impl Read, expected: u64, what: &str) -> io::Result<Vec<u8>> {
    let too_large = |error: MemoryError| io::Error::new(io::ErrorKind::OutOfMemory, error.with_help());
    check(u128::from(expected), || what.to_owned()).map_err(too_large)?;
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(expected as usize)?;
    let mut meter = Meter::default();
    loop {
        let count = input.by_ref().take(STEP).read_to_end(&mut bytes)? as u64;
        if count < STEP {
            return Ok(bytes);
        }
        if bytes.len() as u64 > expected {
            meter.add(count, || what.to_owned()).map_err(too_large)?;
        }
    }
}

/// Limits something that grows while a file is read and whose final size is unknown.
#[derive(Clone, Copy, Debug, Default)]
pub struct Meter {
    taken: u64,
    next: u64,
}

impl Meter {
    /// Adds bytes. Now and then asks whether there is room for twice as much as was taken: a vector that grows is copied
    /// into one of twice the size.
    ///
    /// # Errors
    ///
    /// [`MemoryError`] if there is not.
    pub fn add(&mut self, bytes: u64, what: impl FnOnce() -> String) -> Result<(), MemoryError> {
        self.taken += bytes;
        if self.taken < self.next.max(STEP) {
            return Ok(());
        }
        self.next = self.taken + STEP;
        check(2 * u128::from(self.taken), what)
    }
}

/// An amount as people read it: `1.5 GiB`.
pub fn human(bytes: u128) -> String {
    const UNITS: [&str; 6] = ["KiB", "MiB", "GiB", "TiB", "PiB", "EiB"];
    let mut value = bytes as f64 / 1024.0;
    let mut unit = 0;
    while value >= 1024.0 && unit + 1 < UNITS.len() {
        value /= 1024.0;
        unit += 1;
    }
    format!("{value:.1} {}", UNITS[unit])
}

fn left(bytes: u64) -> String {
    if bytes == 0 { "none is left".to_owned() } else { format!("{} are available", human(u128::from(bytes))) }
}

/// What the system, and the container within it, can give without swapping.
fn system_bytes() -> Option<u64> {
    let kind = RefreshKind::nothing().with_memory(MemoryRefreshKind::nothing().with_ram());
    let system = System::new_with_specifics(kind);
    let container = system.cgroup_limits().map(|limits| limits.free_memory);
    // The library gives 0 for an unknown value.
    [Some(system.available_memory()).filter(|&bytes| bytes > 0), container].into_iter().flatten().min()
}

/// What is left of the address space, if that is limited.
fn address_space() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/self/limits").ok()?;
    let limit = text.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    let limit: u64 = limit.split_whitespace().next()?.parse().ok()?;
    Some(limit.saturating_sub(kibibytes("/proc/self/status", "VmSize:").unwrap_or(0)))
}

fn kibibytes(path: &str, key: &str) -> Option<u64> {
    let text = std::fs::read_to_string(path).ok()?;
    let line = text.lines().find(|line| line.starts_with(key))?;
    let number = line[key.len()..].trim().split(' ').next()?;
    Some(number.parse::<u64>().ok()?.saturating_mul(1024))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_fits_is_no_error_and_what_does_not_is_named() {
        assert_eq!(check(1024, || unreachable!("it fits")), Ok(()));
        if available_bytes().is_some() {
            let error = check(1 << 80, || "a picture takes".to_owned()).unwrap_err();
            assert!(
                error.to_string().starts_with("a picture takes 1048576.0 EiB of memory, and "),
                "{error}"
            );
        }
    }

    #[test]
    fn what_grows_is_asked_about_before_it_has_grown_too_far() {
        let mut meter = Meter::default();
        assert_eq!(meter.add(STEP - 1, || unreachable!("not yet")), Ok(()));
        if available_bytes().is_some() {
            assert!(meter.add(1 << 60, || "points take".to_owned()).is_err());
        }
    }
}
