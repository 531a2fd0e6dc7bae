//! Ctrl-C and SIGTERM.
//!
//! Most work ends at once, and only what is half written is removed. Work that has something to keep holds a [`Keeper`]: the first signal
//! is then a request, which the work finds by [`is_requested`], and only the second one ends the program at once.

use crate::error::INTERRUPTED;
use crate::image_io::leave;
use std::io::{self, IsTerminal as _, Write as _};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Whether a request came: what [`is_requested`] reads after every tile without a lock.
static REQUESTED: AtomicBool = AtomicBool::new(false);

static STATE: Mutex<State> = Mutex::new(State { keepers: 0, last_words: None });

struct State {
    keepers: usize,
    last_words: Option<String>,
}

fn state() -> MutexGuard<'static, State> {
    STATE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Sets up the handler of the program.
pub fn watch() {
    // Without a handler Ctrl-C still ends the program; only a temporary file would stay.
    let _ = ctrlc::set_handler(on_signal);
}

fn on_signal() {
    let mut state = state();
    let mut error = io::stderr();
    if state.keepers > 0 && !REQUESTED.swap(true, Ordering::SeqCst) {
        if error.is_terminal() {
            let _ = writeln!(error, "ending after the tiles that are begun; Ctrl-C again ends at once");
        }
        return;
    }
    let words = state.last_words.take();
    let _ = match words {
        Some(words) => writeln!(error, "interrupted: {words}"),
        None => writeln!(error, "interrupted"),
    };
    // The state stays locked: no work begins to rely on being asked.
    leave(i32::from(INTERRUPTED))
}

/// Whether the work is asked to keep what it has and to end. Only while there is a [`Keeper`].
#[must_use]
pub fn is_requested() -> bool {
    REQUESTED.load(Ordering::SeqCst)
}

/// What is said should a signal end the program at once: how far it came.
pub fn set_last_words(words: String) {
    state().last_words = Some(words);
}

/// While there is one, the first signal does not end the program but asks for it.
#[derive(Debug)]
pub struct Keeper(());

impl Keeper {
    /// From here on there is something to keep.
    #[must_use]
    pub fn new() -> Self {
        state().keepers += 1;
        Self(())
    }
}

impl Default for Keeper {
    fn default() -> Self {
        Self::new()
    }
}

impl Drop for Keeper {
    fn drop(&mut self) {
        state().keepers -= 1;
    }
}
