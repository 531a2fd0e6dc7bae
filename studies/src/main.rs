//! Measurements that the documentation quotes: `cargo run --release -p studies -- NAME` writes `studies/results/NAME.*`.

use std::path::Path;
use std::process::ExitCode;

mod closed_form;
mod data;
mod dice;
mod draw;
mod frame_error;
mod ibpr;
mod ibpr_report;
mod ibpr_settings;
mod line_reference;
mod loop_subdivision;
mod micropoint;
mod picture;
mod point_sampling;
mod ray_reference;
mod report;
mod scans;
mod scenes;
mod shadow;
mod shadow_map;
mod shadow_scenes;
mod speed;
mod stress;
mod stress_rows;
mod true_surface;

use report::Outcome;

/// Name, what it measures, and the study itself.
type Study = (&'static str, &'static str, fn(&Path) -> Outcome);

const STUDIES: [Study; 6] = [
    ("dice", "areas of a triangle in the cells of a grid", run_dice),
    ("micropoint", "pictures against point sampling", micropoint::run),
    ("shadow", "shadows against a shadow map", shadow::run),
    ("ibpr", "raw range scans against the surface that they measured", ibpr::run),
    ("stress", "input at the limits of numbers; fails if a row does", stress::run),
    ("speed", "whole pictures: seconds, threads, memory", speed::run),
];

fn run_dice(out_dir: &Path) -> Outcome {
    dice::run(out_dir)?;
    Ok(true)
}

fn usage() -> String {
    let mut text = "usage: studies NAME\n\nWrites studies/results/NAME.*; NAME is one of\n".to_owned();
    for (name, what, _) in STUDIES {
        text += &format!("  {name:<12}{what}\n");
    }
    text + "  all         all of these\n"
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let name = match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["--help" | "-h"] => {
            print!("{}", usage());
            return ExitCode::SUCCESS;
        }
        // How the study starts its own rows.
        ["stress", row] if row.parse::<usize>().is_ok() => {
            let ended = row.parse().is_ok_and(stress::run_row);
            return if ended { ExitCode::SUCCESS } else { ExitCode::FAILURE };
        }
        [name] if name == "all" || STUDIES.iter().any(|s| s.0 == name) => name,
        _ => {
            eprint!("{}", usage());
            return ExitCode::from(2);
        }
    };
    let out_dir = Path::new(env!("CARGO_MANIFEST_DIR")).join("results");
    let mut good = true;
    for (_, _, study) in STUDIES.iter().filter(|s| name == "all" || s.0 == name) {
        match study(&out_dir) {
            Ok(passed) => good &= passed,
            Err(error) => {
                eprintln!("error: {error}");
                good = false;
            }
        }
    }
    if good { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
