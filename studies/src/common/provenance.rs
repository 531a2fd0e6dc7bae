//! What made a table: so that somebody else can make it again, and see why theirs differs.

use std::process::Command;

use time::OffsetDateTime;

/// Commit, date, compiler, what it compiled for, processor and load, as text.
pub(crate) fn provenance() -> String {
    format!("{}, {}, {}, {}, {}, {}", commit(), today(), compiler(), compiled_for(), processor(), load())
}

/// The commit that is checked out, and whether files differ from it.
fn commit() -> String {
    let Some(hash) = output("git", &["rev-parse", "--short=10", "HEAD"]) else {
        return "not in a repository".to_owned();
    };
    // Results are being written.
    let changes = output("git", &["status", "--porcelain", "--", ":/", ":!/studies/results"]);
    let changed = if changes.is_some_and(|files| !files.is_empty()) { " with changes" } else { "" };
    format!("commit {hash}{changed}")
}

/// Whether any of these files and folders, from the root of the repository, differs from what it was in a commit, or the commit is unknown. Prose and tests are no
/// sources.
pub(crate) fn differs_from(commit: &str, sources: &[String]) -> bool {
    let of_root = sources.iter().map(|source| format!(":/{source}"));
    let no_sources = [":(top,exclude,glob)**/*.md", ":(top,exclude,glob)*/tests/**"].map(str::to_owned);
    let paths: Vec<String> = of_root.chain(no_sources).collect();
    let mut arguments = vec!["diff", "--quiet", commit, "--"];
    arguments.extend(paths.iter().map(String::as_str));
    output("git", &arguments).is_none()
}

/// UTC, as 2026-11-25.
fn today() -> String {
    OffsetDateTime::now_utc().date().to_string()
}

fn compiler() -> String {
    // Where a name follows the version, it is that of a build: `rustc 1.95.0 (59807616e 2026-04-14)`.
    let version = output("rustc", &["--version"]).unwrap_or_else(|| "unknown compiler".to_owned());
    version.split(" (").next().unwrap_or_default().to_owned()
}

/// Architecture, the widest vectors that the compiler may use, and whether it optimised.
fn compiled_for() -> String {
    let vectors = [
        (cfg!(target_feature = "avx512f"), "AVX-512"),
        (cfg!(target_feature = "avx2"), "AVX2"),
        (cfg!(target_feature = "sse2"), "SSE2"),
        (cfg!(target_feature = "neon"), "NEON"),
    ];
    let widest = vectors.iter().find(|v| v.0).map_or("no vectors", |v| v.1);
    let unoptimised = if cfg!(debug_assertions) { ", not optimised" } else { "" };
    format!("{} with {widest}{unoptimised}", std::env::consts::ARCH)
}

/// Cores and processor.
pub(crate) fn processor() -> String {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = info.lines().find_map(|l| l.strip_prefix("model name")?.split_once(':'));
    let name = name.map_or("unknown processor", |(_, name)| name.trim());
    format!("{cores} cores of {name}")
}

/// Programs that ran or waited to run, in the mean of the last minute; this one is among them.
fn load() -> String {
    let load = std::fs::read_to_string("/proc/loadavg").unwrap_or_default();
    load.split(' ')
        .next()
        .filter(|first| !first.is_empty())
        .map_or("unknown load".to_owned(), |l| format!("load {l}"))
}

/// What a program prints, without the white space at its end; `None` if it is missing or fails.
fn output(program: &str, arguments: &[&str]) -> Option<String> {
    let folder = env!("CARGO_MANIFEST_DIR");
    let run = Command::new(program).args(arguments).current_dir(folder).output().ok()?;
    run.status.success().then(|| String::from_utf8_lossy(&run.stdout).trim_end().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_names_a_date_a_compiler_and_a_processor() {
        let text = provenance();
        assert!(text.contains("rustc 1.") || text.contains("unknown compiler"), "{text}");
        assert!(text.contains(" cores of ") && text.contains("load") && text.contains(", 20"), "{text}");
    }
}
