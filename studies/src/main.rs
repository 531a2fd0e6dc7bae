//! Measurements that the documentation quotes: `cargo run --release -p studies -- NAME` writes `studies/results/NAME.*`.

use std::path::Path;
use std::process::ExitCode;

mod common;
mod dice;
mod expected;
mod growth;
mod ibpr;
mod micropoint;
mod radiosity;
mod report;
mod shade;
mod shadow;
mod shprobe;
mod skip;
mod speed;
mod stress;
mod surfel;

use common::report::Outcome;

/// Name, what it measures, and the study itself.
type Study = (&'static str, &'static str, fn(&Path) -> Outcome);

const STUDIES: [Study; 15] = [
    ("dice", "areas of a triangle in the cells of a grid", run_dice),
    ("micropoint", "pictures against point sampling; foliage; shadows across texels", micropoint::run),
    ("shadow", "shadows against a shadow map, area lights against samples", shadow::run),
    ("shade", "energy, reciprocity and time of every reflection model; fails if one makes light", shade::run),
    ("ibpr", "raw range scans against the surface that they measured", ibpr::run),
    ("surfel", "point clouds against rays through a lens; fails if order or threads show", surfel::run),
    (
        "shprobe",
        "light probes: coefficients, tetrahedra, placement, against direct integration",
        shprobe::run,
    ),
    ("together", "whole pictures by radiosity and by probes, against paths", shprobe::together::run),
    ("radiosity", "form factors, hemicubes and solutions: time against error", radiosity::run),
    ("stress", "input at the limits of numbers; fails if a row does", stress::run),
    ("expected", "what `--dry-run` and `--error` say beside what is true", expected::run),
    ("speed", "whole pictures: seconds, threads, memory", speed::run),
    ("growth", "time and memory of every stage against its size", growth::run),
    ("skip", "what costs nothing where it has nothing to do", skip::run),
    ("report", "report.html, one page of all that is there", report::run),
];

fn run_dice(out_dir: &Path) -> Outcome {
    dice::run(out_dir)?;
    Ok(true)
}

/// Draws the pictures, too; the table is printed.
fn together_with_pictures(folder: &str) -> Outcome {
    std::fs::create_dir_all(folder)?;
    print!("{}", shprobe::together::measure(Some(Path::new(folder)))?);
    Ok(true)
}

fn usage() -> String {
    let mut text = "usage: studies NAME\n\nWrites studies/results/NAME.*; NAME is one of\n".to_owned();
    for (name, what, _) in STUDIES {
        text += &format!("  {name:<12}{what}\n");
    }
    text + "  all         all of these\n\n`micropoint foliage`, `micropoint checker` and `shadow area` write NAME-PART.* alone.\n`micropoint quick` prints a trial of a minute; `surfel quick` and `shprobe quick` take some minutes and write elsewhere. `shprobe --pictures DIR` and `together DIR` draw, too. `radiosity PART…` runs parts alone, such as `buildings` and `growth`.\n"
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let out_dir = Path::new(env!("CARGO_MANIFEST_DIR")).join("results");
    let name = match arguments[..] {
        ["--help" | "-h"] => {
            print!("{}", usage());
            return ExitCode::SUCCESS;
        }
        // How the study starts its own rows.
        ["stress", row] if row.parse::<usize>().is_ok() => {
            let ended = row.parse().is_ok_and(stress::run_row);
            return if ended { ExitCode::SUCCESS } else { ExitCode::FAILURE };
        }
        ["growth", stage, size] => {
            let row = stage.parse().ok().zip(size.parse().ok());
            let ended = row.is_some_and(|(stage, size)| growth::run_row(stage, size));
            return if ended { ExitCode::SUCCESS } else { ExitCode::FAILURE };
        }
        ["surfel", "quick"] => return code(surfel::run_quick()),
        ["micropoint", "quick"] => return code(micropoint::run_quick()),
        ["micropoint", "foliage"] => return code(micropoint::foliage::run(&out_dir)),
        ["micropoint", "checker"] => return code(micropoint::checker::run(&out_dir)),
        ["shadow", "area"] => return code(shadow::area::run(&out_dir)),
        ["radiosity", _, ..] => return code(radiosity::run_parts(&out_dir, &arguments[1..])),
        ["together", folder] => return code(together_with_pictures(folder)),
        ["shprobe", _, ..] => return code(shprobe::run_with(&out_dir, &arguments[1..])),
        [name] if name == "all" || STUDIES.iter().any(|s| s.0 == name) => name,
        _ => {
            eprint!("{}", usage());
            return ExitCode::from(2);
        }
    };
    let chosen = STUDIES.iter().filter(|s| name == "all" || s.0 == name);
    let codes: Vec<ExitCode> = chosen.map(|(_, _, study)| code(study(&out_dir))).collect();
    codes.into_iter().find(|c| *c != ExitCode::SUCCESS).unwrap_or(ExitCode::SUCCESS)
}

/// Says what went wrong, if anything did.
fn code(outcome: Outcome) -> ExitCode {
    match outcome {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
