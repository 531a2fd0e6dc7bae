//! What every command needs beside its work: threads, notes, statistics, text results.

use crate::error::CliError;
use crate::image_io::{check_writable, write_atomically};
use crate::input::is_standard;
use crate::job::{Expected, IS_DEBUG_BUILD, Progress, Stats};
use crate::memory;
use crate::options::Common;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// The running command's voice and clock.
pub(super) struct Report<'a> {
    common: &'a Common,
    pub(super) stats: Stats,
    /// Whether standard output is a result.
    on_stdout: bool,
}

impl<'a> Report<'a> {
    /// Starts the clock, sets up memory and threads, and looks whether `--stats` can be written.
    pub(super) fn new(common: &'a Common) -> Result<Self, CliError> {
        let stats = Stats::new();
        common.memory.into_iter().for_each(memory::allow);
        common.stats.as_deref().map_or(Ok(()), check_output)?;
        start_threads(common.thread_count());
        let on_stdout = common.stats.as_deref().is_some_and(is_standard);
        Ok(Self { common, stats, on_stdout })
    }

    /// Says what the command reads; refuses to read standard input twice.
    pub(super) fn reading<'p>(self, inputs: impl IntoIterator<Item = &'p PathBuf>) -> Result<Self, CliError> {
        if inputs.into_iter().filter(|path| is_standard(path)).count() > 1 {
            let message = "`-` is given twice, but standard input can be read only once";
            return Err(CliError::Usage(message.to_owned()));
        }
        Ok(self)
    }

    /// Says where results go beside `--stats`; refuses to put two of them on standard output, and files that cannot be written.
    pub(super) fn writing<'p>(
        mut self,
        outputs: impl IntoIterator<Item = &'p PathBuf>,
    ) -> Result<Self, CliError> {
        let mut results = usize::from(self.on_stdout);
        for path in outputs {
            results += usize::from(is_standard(path));
            check_output(path)?;
        }
        if results > 1 {
            let message =
                "two results go to standard output; name a file for all but one of -o, --stats and others";
            return Err(CliError::Usage(message.to_owned()));
        }
        self.on_stdout = results == 1;
        Ok(self)
    }

    /// Shows progress in the form that was asked for.
    pub(super) fn progress(&self) -> Progress {
        Progress::new(self.common.progress_mode(self.on_stdout))
    }

    /// Tells the user something worth knowing.
    pub(super) fn note(&self, text: &str) {
        if !self.common.quiet {
            // Nobody to tell is no reason to stop.
            let _ = writeln!(io::stderr(), "{text}");
        }
    }

    /// Tells the user how to light a scene with a baked file: by this key of the scene.
    pub(super) fn tell_use(&self, scene: &Path, key: &str, baked: &Path) {
        if !is_standard(baked) {
            let (scene, baked) = (scene.display(), baked.display());
            self.note(&format!("draw with it: pointillist render {scene} --set {key}={baked}"));
        }
    }

    /// Tells the user something that may be wrong.
    pub(super) fn warn(&self, text: &str) {
        self.note(&format!("warning: {text}"));
    }

    /// A message that is printed with `-v`.
    pub(super) fn detail(&self, text: &str) {
        if self.common.verbose {
            self.note(text);
        }
    }

    /// Prints what `--dry-run` expects on standard output, and ends the command.
    pub(super) fn finish_expecting(&self, expected: Expected) -> Result<(), CliError> {
        let text = expected.to_text();
        self.stats.expect(expected);
        if !self.on_stdout {
            write_text(Path::new("-"), |output| output.write_all(text.as_bytes()))?;
        }
        self.finish()
    }

    /// Threads that compute at once.
    pub(super) fn threads(&self) -> usize {
        let processors = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        self.common.thread_count().min(processors)
    }

    /// Writes `--stats`, and with `-v` the seconds of every stage.
    pub(super) fn finish(&self) -> Result<(), CliError> {
        let json = self.stats.to_json();
        let shows_times =
            self.common.stats.is_some() || self.common.verbose || json.get("expected").is_some();
        if IS_DEBUG_BUILD && shows_times {
            self.warn("this is a debug build: it takes several times as long as one made with `cargo build --release`");
        }
        if let Some(seconds) = json["seconds"].as_object() {
            for (stage, wall) in seconds {
                let [wall, cpu] = [wall, &json["cpu_seconds"][stage]].map(|s| s.as_f64().unwrap_or_default());
                self.detail(&format!("{stage:>10} {}", times(wall, cpu)));
            }
        }
        match &self.common.stats {
            Some(path) => write_text(path, |output| {
                serde_json::to_writer_pretty(&mut *output, &json)?;
                writeln!(output)
            }),
            None => Ok(()),
        }
    }
}

/// How long a stage took. Those of tiles are timed by their processor time alone, since they take place at once on several threads.
fn times(wall: f64, cpu: f64) -> String {
    match (wall > 0.0, cpu > 0.0) {
        (true, true) => format!("{wall:.3} s, {cpu:.3} s of processor time"),
        (false, true) => format!("{cpu:.3} s of processor time"),
        _ => format!("{wall:.3} s"),
    }
}

/// Starts the threads that everything is computed on.
///
/// Where the system refuses so many (a limit on memory or on processes) there are fewer, and in the end only the one that runs already.
fn start_threads(count: usize) {
    // Half of what is possible where there is a limit: threads are not all that a command needs, and those of the pool take more than those that
    // are tried.
    let threads = (threads_possible(2 * count) / 2).min(count);
    let mut pool = rayon::ThreadPoolBuilder::new().num_threads(threads.max(1));
    if threads == 0 {
        pool = pool.use_current_thread();
    }
    // It fails if threads are running already, that is when a test calls a second command in one process; results do not depend on
    // their number.
    let _ = pool.build_global();
}

/// How many of `count` threads can run at once. Tried with threads that do nothing: the global pool can be started only once, even
/// if that fails.
fn threads_possible(count: usize) -> usize {
    let gate = Mutex::new(());
    std::thread::scope(|scope| {
        let closed = gate.lock();
        let waits = || drop(gate.lock());
        let start = |_| std::thread::Builder::new().spawn_scoped(scope, waits).ok();
        let started: Vec<_> = (0..count).map_while(start).collect();
        drop(closed);
        // The end of the scope waits until they have done their work only. Their stacks are free for others once they are joined.
        started.into_iter().filter_map(|thread| thread.join().ok()).count()
    })
}

/// Looks whether a file can be written, before any work is done for it; `-` is standard output.
pub(super) fn check_output(path: &Path) -> Result<(), CliError> {
    if is_standard(path) {
        return Ok(());
    }
    check_writable(path).map_err(|error| CliError::writing(&path.display().to_string(), &error))
}

/// What notes call a result.
pub(super) fn name_of_output(path: &Path) -> String {
    if is_standard(path) { "standard output".to_owned() } else { path.display().to_string() }
}

/// Writes text to a file as a whole, or to standard output for `-`.
pub(super) fn write_text(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), CliError> {
    if is_standard(path) {
        let mut output = BufWriter::new(io::stdout().lock());
        let result = write(&mut output).and_then(|()| output.flush());
        return result.map_err(|error| CliError::writing(&name_of_output(path), &error));
    }
    write_atomically(path, |output| write(output))
        .map_err(|error| CliError::writing(&path.display().to_string(), &error))
}
