//! Measurements that the documentation quotes: `cargo run --release -p studies -- NAME` writes `studies/results/NAME.*`.

use std::path::Path;
use std::process::ExitCode;

mod closed_form;
mod coloured_cloud;
mod data;
mod dice;
mod draw;
mod frame_error;
mod ibpr;
mod ibpr_report;
mod ibpr_settings;
mod layer_error;
mod lens_camera;
mod lens_reference;
mod lens_samples;
mod lens_scenes;
mod line_reference;
mod loop_subdivision;
mod micropoint;
mod picture;
mod picture_layers;
mod point_sampling;
mod probe_canvas;
mod probe_delaunay;
mod probe_layouts;
mod probe_maps;
mod probe_objects;
mod probe_paper;
mod probe_peer;
mod probe_pictures;
mod probe_projection;
mod probe_rays;
mod probe_rooms;
mod probe_site;
mod probe_streets;
mod probe_trilinear;
mod probe_truth;
mod probe_walk;
mod radiosity;
mod radiosity_peer;
mod radiosity_probes;
mod ray_reference;
mod report;
mod scans;
mod scenes;
mod shade;
mod shadow;
mod shadow_map;
mod shadow_scenes;
mod shprobe;
mod similarity;
mod speed;
mod stress;
mod stress_rows;
mod surfel;
mod surfel_report;
mod surfel_same;
mod surfel_stage;
mod surfel_views;
mod true_surface;

use report::Outcome;

/// Name, what it measures, and the study itself.
type Study = (&'static str, &'static str, fn(&Path) -> Outcome);

const STUDIES: [Study; 10] = [
    ("dice", "areas of a triangle in the cells of a grid", run_dice),
    ("micropoint", "pictures against point sampling", micropoint::run),
    ("shadow", "shadows against a shadow map", shadow::run),
    ("shade", "energy, reciprocity and time of every reflection model; fails if one makes light", shade::run),
    ("ibpr", "raw range scans against the surface that they measured", ibpr::run),
    ("surfel", "point clouds against rays through a lens; fails if order or threads show", surfel::run),
    (
        "shprobe",
        "light probes: coefficients, tetrahedra, placement, against direct integration",
        shprobe::run,
    ),
    ("radiosity", "form factors, hemicubes and solutions: time against error", radiosity::run),
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
    text + "  all         all of these\n\n`surfel quick` and `shprobe quick` are trials that take a minute and write elsewhere. `shprobe --pictures DIR` draws, too.\n"
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
        ["surfel", "quick"] => return code(surfel::run_quick()),
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
