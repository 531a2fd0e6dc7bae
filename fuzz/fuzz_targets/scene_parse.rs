//! Any text as a scene: a description or an error that can be shown, never a panic.
#![no_main]

use libfuzzer_sys::fuzz_target;
use pointillist_cli::scene::{Format, parse_str};

fuzz_target!(|text: &str| {
    for (name, format) in [("scene.toml", Format::Toml), ("scene.json", Format::Json)] {
        if let Err(error) = parse_str(name, text, format, &[]) {
            assert!(!error.to_string().is_empty());
        }
    }
});
