//! `render --watch`: draws again when the scene, or a file that it reads, has changed.
//!
//! Files are looked at a few times a second: this works on every file system, also over a network, and for editors that replace files.

use crate::error::CliError;
use crate::input::is_standard;
use crate::memory;
use crate::options::RenderOptions;
use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::PathBuf;
use std::time::{Duration, SystemTime};

/// Between two looks.
const INTERVAL: Duration = Duration::from_millis(200);

/// When a file was changed and how long it is; nothing for one that is not there, as while an editor replaces it.
type State = Option<(SystemTime, u64)>;

/// Draws with `draw` until Ctrl-C. What is wrong with the scene is told, and the next change is waited for.
pub(super) fn run(
    options: &RenderOptions,
    draw: &dyn Fn(&RenderOptions) -> Result<(), CliError>,
) -> Result<(), CliError> {
    let Some(scene) = &options.scene else {
        return Err(CliError::Usage("--watch needs a SCENE: the built-in one does not change".to_owned()));
    };
    if is_standard(scene) {
        return Err(CliError::Usage("--watch needs a file: standard input is read once".to_owned()));
    }
    loop {
        memory::forget_files();
        // Looked at before it is read: a change in between is one.
        let own = BTreeMap::from([(scene.clone(), state(scene))]);
        match draw(options) {
            Ok(()) => {}
            Err(error @ (CliError::Input(_) | CliError::Failed(_))) => {
                // Nobody to tell is no reason to stop.
                let _ = writeln!(std::io::stderr(), "error: {error}");
            }
            Err(error) => return Err(error),
        }
        let mut before: BTreeMap<PathBuf, State> =
            memory::files_read().into_iter().map(|(path, state)| (path, Some(state))).collect();
        before.extend(own);
        while before.iter().all(|(path, before)| state(path) == *before) {
            std::thread::sleep(INTERVAL);
        }
        if !options.common.quiet {
            let _ = writeln!(std::io::stderr(), "a file has changed");
        }
    }
}

fn state(path: &PathBuf) -> State {
    let data = std::fs::metadata(path).ok()?;
    Some((data.modified().ok()?, data.len()))
}
