//! Measurements that the documentation quotes: `cargo run --release -p studies -- NAME` writes `studies/results/NAME.*`.

use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

mod clouds;
mod common;
mod dice;
mod expected;
mod growth;
mod ibpr;
mod micropoint;
mod mutants;
mod quote;
mod radiosity;
mod real;
mod report;
mod shade;
mod shadow;
mod shprobe;
mod skip;
mod speed;
mod stress;
mod surfel;

use common::machine::results_folder;
use common::report::{Outcome, trial_folder};
use common::standing::stands;
use common::timing::take_one_run_each;

/// Something that is measured and written to files of its name.
struct Study {
    name: &'static str,
    what: &'static str,
    run: fn(&Path) -> Outcome,
    /// The same with small sizes, in a minute or less.
    quick: Option<fn(&Path) -> Outcome>,
}

impl Study {
    const fn new(name: &'static str, what: &'static str, run: fn(&Path) -> Outcome) -> Self {
        Self { name, what, run, quick: None }
    }

    const fn with_quick(mut self, quick: fn(&Path) -> Outcome) -> Self {
        self.quick = Some(quick);
        self
    }
}

const STUDIES: [Study; 17] = [
    Study::new("dice", "areas of a triangle in the cells of a grid", dice::run).with_quick(dice::run_quick),
    Study::new(
        "micropoint",
        "pictures against point sampling; foliage; shadows across texels",
        micropoint::run,
    )
    .with_quick(micropoint::run_quick),
    Study::new("real", "buildings and trees with textures and masks, against samples", real::run),
    Study::new("shadow", "shadows against a shadow map, area lights against samples", shadow::run),
    Study::new(
        "shade",
        "energy, reciprocity and time of every reflection model; fails if one makes light",
        shade::run,
    )
    .with_quick(shade::run),
    Study::new("ibpr", "raw range scans against the surface that they measured", ibpr::run),
    Study::new(
        "surfel",
        "point clouds against rays through a lens; fails if order or threads show",
        surfel::run,
    )
    .with_quick(surfel::run_quick),
    Study::new(
        "clouds",
        "clouds of up to 3e8 points from disk: a view's cost against the cloud's",
        clouds::run,
    )
    .with_quick(clouds::run_quick),
    Study::new(
        "shprobe",
        "light probes: coefficients, tetrahedra, placement, against direct integration",
        shprobe::run,
    ),
    Study::new(
        "together",
        "whole pictures by radiosity and by probes, against paths",
        shprobe::together::run,
    ),
    Study::new("radiosity", "form factors, hemicubes and solutions: time against error", radiosity::run),
    Study::new("stress", "input at the limits of numbers; fails if a row does", stress::run)
        .with_quick(stress::run),
    Study::new("expected", "what `--dry-run` and `--error` say beside what is true", expected::run),
    Study::new("speed", "whole pictures: seconds, threads, memory", speed::run),
    Study::new("growth", "time and memory of every stage against its size", growth::run)
        .with_quick(growth::run_quick),
    Study::new("skip", "what costs nothing where it has nothing to do", skip::run),
    Study::new("report", "report.html, one page of all that is there", report::run).with_quick(report::run),
];

/// Small sizes of those that have such, into the temporary folder; `false` if one of them failed.
fn run_quick(studies: &[Study]) -> Outcome {
    let out_dir = trial_folder();
    take_one_run_each();
    let mut passed = true;
    for study in studies {
        let Some(quick) = study.quick else { continue };
        passed &= timed(study, quick, &out_dir)?;
    }
    Ok(passed)
}

/// Runs a study one way, and tells how long it took.
fn timed(study: &Study, run: fn(&Path) -> Outcome, out_dir: &Path) -> Outcome {
    let start = Instant::now();
    let outcome = run(out_dir);
    eprintln!("{}: {:.0} s", study.name, start.elapsed().as_secs_f64());
    outcome
}

fn usage() -> String {
    let mut text = "usage: studies NAME\n\nWrites studies/results/NAME.*, or into a folder there on another machine than that of studies/results/machine.txt; NAME is one of\n".to_owned();
    for Study { name, what, .. } in STUDIES {
        text += &format!("  {name:<12}{what}\n");
    }
    text + "  all         all of these\n  stale       those of these that were made before one of their sources changed, the crates that they measure among these: `all`, or its rest\n  quick       small sizes of most of them in minutes, and their page, in the temporary folder\n  quote       their tables in READMEs, written anew; with --check: whether that would change more than figures\n  mutants     how many faults tests see, from the runs of `.ci/mutants`\n\n`micropoint foliage`, `micropoint checker` and `shadow area` write NAME-PART.* alone.\n`dice quick` and others run alone what they have for `quick`, `shprobe quick` takes ten minutes; all of them write into the temporary folder. `shprobe --pictures DIR` and `together DIR` draw, too, `shprobe pictures DIR` draws alone; `together DIR PART…` does some parts alone. `radiosity PART…` runs parts alone, such as `buildings` and `growth`; `clouds POINTS` ends with that size, and `ibpr floor` and `ibpr relief` print those parts.\n"
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let results = Path::new(env!("CARGO_MANIFEST_DIR")).join("results");
    let out_dir = match results_folder(&results) {
        Ok(folder) => folder,
        Err(error) => return code(Err(error.into())),
    };
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
        ["clouds", "build", points, octree] => return code(clouds::build(points, Path::new(octree))),
        ["clouds", largest] if largest.parse::<f64>().is_ok() => {
            return code(clouds::run_up_to(&out_dir, largest));
        }
        ["quote"] => return code(quote::run(&results, false)),
        ["quote", "--check"] => return code(quote::run(&results, true)),
        ["mutants"] => return code(mutants::run(&out_dir)),
        ["quick"] => return code(run_quick(&STUDIES)),
        [name, "quick"] if name != "shprobe" => match STUDIES.iter().find(|s| s.name == name) {
            Some(study) if study.quick.is_some() => return code(run_quick(std::slice::from_ref(study))),
            _ => {
                eprintln!("`{name}` has no quick form; see --help");
                return ExitCode::from(2);
            }
        },
        ["ibpr", "floor"] => return code(ibpr::run_floor()),
        ["ibpr", "relief"] => return code(ibpr::run_relief()),
        ["micropoint", "foliage"] => return code(micropoint::foliage::run(&out_dir)),
        ["micropoint", "checker"] => return code(micropoint::checker::run(&out_dir)),
        ["shadow", "area"] => return code(shadow::area::run(&out_dir)),
        ["radiosity", _, ..] => return code(radiosity::run_parts(&out_dir, &arguments[1..])),
        ["together", folder, ..] => {
            return code(shprobe::together::run_parts(&out_dir, Some(Path::new(folder)), &arguments[2..]));
        }
        ["shprobe", _, ..] => return code(shprobe::run_with(&out_dir, &arguments[1..])),
        [name] if ["all", "stale"].contains(&name) || STUDIES.iter().any(|s| s.name == name) => name,
        _ => {
            eprint!("{}", usage());
            return ExitCode::from(2);
        }
    };
    let chosen = STUDIES.iter().filter(|study| match name {
        "all" => true,
        "stale" => !stands(&out_dir, study.name),
        _ => study.name == name,
    });
    let chosen: Vec<&Study> = chosen.collect();
    if name == "stale" {
        let names: Vec<&str> = chosen.iter().map(|study| study.name).collect();
        eprintln!("stale: {}", if names.is_empty() { "none".to_owned() } else { names.join(", ") });
    }
    let codes: Vec<ExitCode> =
        chosen.into_iter().map(|study| timed(study, study.run, &out_dir)).map(code).collect();
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
