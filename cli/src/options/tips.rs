//! What to do about the usual slips on the command line, where the parser does not know.

use clap::builder::StyledStr;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use std::path::Path;

/// An error with a tip, if it is one of these slips: the name of a file where a command is due, numbers of one option with blanks between them.
pub(super) fn with_tip(mut error: clap::Error) -> clap::Error {
    let text = |error: &clap::Error, kind: ContextKind| match error.get(kind) {
        Some(ContextValue::String(text)) => Some(text.clone()),
        _ => None,
    };
    let tip = match error.kind() {
        ErrorKind::InvalidSubcommand => {
            let word = text(&error, ContextKind::InvalidSubcommand).filter(|word| is_file(word));
            word.map(|word| format!("a command comes first: pointillist {} {word}", command_for(&word)))
        }
        ErrorKind::UnknownArgument => {
            let word = text(&error, ContextKind::InvalidArg).filter(|word| word.parse::<f64>().is_ok());
            word.map(|_| {
                "several numbers of one option have commas between them, and no blanks: --eye 1,2,3"
                    .to_owned()
            })
        }
        _ => None,
    };
    if let Some(tip) = tip {
        error.remove(ContextKind::SuggestedSubcommand);
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![StyledStr::from(tip)]));
    }
    error
}

/// Whether a word is the name of a file, or looks like one.
fn is_file(word: &str) -> bool {
    Path::new(word).is_file() || Path::new(word).extension().is_some()
}

/// The command that draws a file.
fn command_for(word: &str) -> &'static str {
    match Path::new(word).extension().and_then(|end| end.to_str()) {
        Some("conf" | "xyz" | "las" | "laz" | "e57" | "pts" | "asc") => "scan",
        Some("exr" | "png" | "jpg" | "hdr" | "probes" | "mtl") => "info",
        _ => "render",
    }
}
