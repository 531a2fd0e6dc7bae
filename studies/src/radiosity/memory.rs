//! The most memory that this process had, where the system says.

/// Begins anew, where that is permitted; elsewhere the peak is that since the process began.
pub(crate) fn forget_peak() {
    // On Linux, 5 sets the peak to what is held now. Where it fails, the peak is too high, which is said in no case to be good.
    let _ = std::fs::write("/proc/self/clear_refs", "5");
}

/// In MiB.
pub(crate) fn peak_mebibytes() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    let kibibytes: f64 = line.trim().trim_end_matches("kB").trim().parse().ok()?;
    Some(kibibytes / 1024.0)
}
