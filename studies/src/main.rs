//! Measurements that the documentation quotes: `cargo run --release -p studies -- NAME` writes `studies/results/NAME.*`.

use std::path::Path;
use std::process::ExitCode;

mod dice;

fn main() -> ExitCode {
    let out_dir = Path::new(env!("CARGO_MANIFEST_DIR")).join("results");
    let result = match std::env::args().nth(1).as_deref() {
        Some("dice") => dice::run(&out_dir),
        _ => {
            eprintln!("usage: studies dice");
            return ExitCode::from(2);
        }
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("writing the results: {error}");
            ExitCode::FAILURE
        }
    }
}
