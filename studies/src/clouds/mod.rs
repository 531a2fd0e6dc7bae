//! `clouds`: clouds of points from disk, made into octrees and looked at. What a view costs is to follow the view and not the cloud.

mod town;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

use cpu_time::ProcessTime;
use pointillist_cli::cloud_io::{CloudBlock, Scalar};
use pointillist_cli::memory::peak_bytes;
use pointillist_cli::points::write_octree;
use serde_json::Value;

use crate::common::charts::chart_along;
use crate::common::provenance::provenance;
use crate::common::report::{Outcome, Row, write};
use crate::common::timing::Timing;
use town::Town;

/// Points of the towns, about.
const SIZES: [f64; 5] = [1e5, 1e6, 1e7, 1e8, 3e8];

/// What may be used, by the builder and by the program that draws.
const MEMORY: u64 = 2 << 30;

/// Views of a flight.
const VIEWS: u32 = 41;

const SIZE: &str = "1280x720";

type Fault = Box<dyn std::error::Error + Send + Sync>;

/// Measures and writes `clouds.md` and `clouds.svg`.
pub(crate) fn run(out_dir: &Path) -> Outcome {
    measure(out_dir, f64::INFINITY)
}

/// The same of the smallest town.
pub(crate) fn run_quick(out_dir: &Path) -> Outcome {
    measure(out_dir, SIZES[0])
}

/// The same of towns up to a number of points: the largest takes nine gigabytes in the temporary folder.
pub(crate) fn run_up_to(out_dir: &Path, points: &str) -> Outcome {
    measure(out_dir, points.parse::<f64>()?)
}

fn measure(out_dir: &Path, largest: f64) -> Outcome {
    let program =
        std::env::current_exe()?.with_file_name(format!("pointillist{}", std::env::consts::EXE_SUFFIX));
    if !program.exists() {
        eprintln!("clouds: skipped, `cargo build --release` first");
        return Ok(true);
    }
    let folder = std::env::temp_dir().join(format!("clouds-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let measured = rows(&program, &folder, largest);
    std::fs::remove_dir_all(&folder)?;
    let towns = measured?;
    write(out_dir, "clouds.md", &report(&towns))?;
    chart_along(out_dir, "clouds", ["points", "processor seconds"], &chart_rows(&towns))?;
    Ok(true)
}

/// A town, as its octree was made and looked at.
struct Measured {
    built: Built,
    octree_bytes: f64,
    /// From a process of its own each.
    discs: Drawn,
    flight: Drawn,
    scan: Drawn,
}

/// What a process says that makes an octree.
struct Built {
    points: f64,
    seconds: f64,
    cpu: f64,
    peak_bytes: f64,
}

/// What a process says that draws.
struct Drawn {
    seconds: f64,
    cpu: f64,
    peak_bytes: f64,
    bytes_read: f64,
    points: f64,
}

fn rows(program: &Path, folder: &Path, largest: f64) -> Result<Vec<Measured>, Fault> {
    let mut towns = vec![];
    for points in SIZES.into_iter().filter(|points| *points <= largest) {
        eprintln!("clouds: {points:e} points");
        let octree = folder.join("town.octree");
        let built = build_in_child(points, &octree)?;
        let octree_bytes = std::fs::metadata(&octree)?.len() as f64;
        let (view, flight) = views(&Town::of(points), folder)?;
        let picture = std::env::temp_dir().join("clouds-town.png");
        let view: Vec<&str> = view.iter().map(String::as_str).collect();
        let to_picture = ["-o", &picture.display().to_string()].map(str::to_owned);
        let to_picture = to_picture.each_ref().map(String::as_str);
        let discs = draw(program, folder, "surfel", &[&view[..], &to_picture].concat())?;
        let frames = folder.join("f{frame}.png").display().to_string();
        let flown = ["--views", &flight, "--fov", "50", "-o", &frames];
        let flight = draw(program, folder, "surfel", &flown)?;
        let scanned = folder.join("scan.png").display().to_string();
        let scan = draw(program, folder, "scan", &[&view[..], &["-o", &scanned]].concat())?;
        eprintln!("clouds: the picture is {}", picture.display());
        std::fs::remove_file(&octree)?;
        towns.push(Measured { built, octree_bytes, discs, flight, scan });
    }
    Ok(towns)
}

/// The view of all towns as options, and the file of a flight that begins with it: along a street, 25 m above the ground.
fn views(town: &Town, folder: &Path) -> std::io::Result<(Vec<String>, String)> {
    let middle = town.middle();
    let mut lines = String::new();
    let mut first = None;
    for number in 0..VIEWS {
        let (x, y) = (middle.x - 30.0 + 2.0 * f64::from(number), middle.y - 60.0);
        let (eye, target) =
            (format!("{x},{y},{}", middle.z + 30.0), format!("{},{},{}", x + 15.0, y + 80.0, middle.z));
        let _ = writeln!(lines, "{eye},{target},0,0,1");
        first.get_or_insert([eye, target]);
    }
    let path = folder.join("flight.txt");
    std::fs::write(&path, lines)?;
    let [eye, target] = first.unwrap_or_default();
    let view =
        ["--eye", &eye, "--target", &target, "--up", "0,0,1", "--fov", "50"].map(str::to_owned).to_vec();
    Ok((view, path.display().to_string()))
}

fn draw(program: &Path, folder: &Path, command: &str, more: &[&str]) -> Result<Drawn, Fault> {
    let stats: PathBuf = folder.join("stats.json");
    let output = Command::new(program)
        .arg(command)
        .arg(folder.join("town.octree"))
        .args(["--color-by", "class", "--size", SIZE, "--memory", "2G", "--quiet", "--overwrite", "--stats"])
        .arg(&stats)
        .args(more)
        .stdin(Stdio::null())
        .output()?;
    if !output.status.success() {
        return Err(format!("{command}: {}", String::from_utf8_lossy(&output.stderr).trim()).into());
    }
    let stats: Value = serde_json::from_slice(&std::fs::read(&stats)?)?;
    let number = |map: &str, key: &str| stats[map][key].as_f64().unwrap_or(f64::NAN);
    Ok(Drawn {
        seconds: number("seconds", "total"),
        cpu: number("cpu_seconds", "total"),
        peak_bytes: stats["peak_bytes"].as_f64().unwrap_or(f64::NAN),
        bytes_read: number("counts", "bytes_read"),
        points: number("counts", "points"),
    })
}

fn build_in_child(points: f64, octree: &Path) -> Result<Built, Fault> {
    let output = Command::new(std::env::current_exe()?)
        .args(["clouds", "build", &points.to_string()])
        .arg(octree)
        .output()?;
    let text = String::from_utf8_lossy(&output.stdout);
    let numbers: Vec<f64> = text.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    match numbers[..] {
        [points, seconds, cpu, peak_bytes] if output.status.success() => {
            Ok(Built { points, seconds, cpu, peak_bytes })
        }
        _ => Err(format!("{points:e} points: {}", String::from_utf8_lossy(&output.stderr).trim()).into()),
    }
}

/// Makes the octree of a town in this process, and prints its points, seconds, processor seconds and bytes of memory.
pub(crate) fn build(points: &str, octree: &Path) -> Outcome {
    let town = Town::of(points.parse()?);
    let (start, cpu) = (Instant::now(), ProcessTime::now());
    // The header has their number only for messages.
    let announced = points.parse::<f64>()? as u64;
    let mut count = 0;
    let written = write_octree(octree, town.bounds(), announced, &[Scalar::Class], MEMORY / 2, &mut |sink| {
        for block in town.blocks() {
            count += block.positions.len() as u64;
            let mut scalars = [None; Scalar::ALL.len()];
            scalars[Scalar::Class as usize] = Some(&block.classes[..]);
            sink(CloudBlock {
                positions: &block.positions,
                colours: None,
                opacities: None,
                normals: None,
                face_normals: None,
                radii: None,
                scalars,
            })?;
        }
        Ok(())
    });
    written.map_err(|error| error.to_string())?;
    let seconds = start.elapsed().as_secs_f64();
    println!("{count} {seconds} {} {}", cpu.elapsed().as_secs_f64(), peak_bytes());
    Ok(true)
}

const MEGA: f64 = 1e6;

fn report(towns: &[Measured]) -> String {
    let mut text = format!(
        "# Clouds from disk\n\n`cargo build --release && cargo run --release -p studies -- clouds` made this ({}). A generated town (streets, buildings, parks, 20 \
         points to the square metre with noise of 2 cm, national coordinates) goes into an octree block by block, without ever being a file of its own, and is \
         looked at from above a street in its middle, {SIZE}, coloured by class, each time by a process of its own with `--memory 2G`: as discs \
         (`surfel`), as surfaces (`scan`), and as discs in a flight of {VIEWS} views, 2 m from one to the next. Seconds are of the whole process, and single runs; \
         files may be in the system's cache. `clouds 1e8` ends with that size. Charts: `clouds.svg`.\n",
        provenance()
    );
    text += "\n## Made once\n\n| points | s | CPU s | µs CPU each | peak MB | octree MB |\n| ---: | ---: | ---: | ---: | ---: | ---: |\n";
    for Measured { built, octree_bytes, .. } in towns {
        let Built { points, seconds, cpu, peak_bytes } = built;
        let _ = writeln!(
            text,
            "| {points} | {seconds:.1} | {cpu:.1} | {:.2} | {:.0} | {:.1} |",
            MEGA * cpu / points,
            peak_bytes / MEGA,
            octree_bytes / MEGA
        );
    }
    text += "\n## One view\n\n| points | drawn by | s | CPU s | MB read | points drawn | peak MB |\n| ---: | --- | ---: | ---: | ---: | ---: | ---: |\n";
    for town in towns {
        for (name, drawn) in [("surfel", &town.discs), ("scan", &town.scan)] {
            let Drawn { seconds, cpu, bytes_read, points, peak_bytes } = drawn;
            let _ = writeln!(
                text,
                "| {} | {name} | {seconds:.2} | {cpu:.2} | {:.1} | {points:.0} | {:.0} |",
                town.built.points,
                bytes_read / MEGA,
                peak_bytes / MEGA
            );
        }
    }
    text += "\nPoints drawn are those of the coarse picture that comes first, where there is one, and of the final one.\n";
    text += "\n## A flight\n\n| points | s | CPU s | CPU s of each view after the first | MB read | peak MB |\n| ---: | ---: | ---: | ---: | ---: | ---: |\n";
    for Measured { built, discs, flight, .. } in towns {
        let _ = writeln!(
            text,
            "| {} | {:.1} | {:.1} | {:.2} | {:.1} | {:.0} |",
            built.points,
            flight.seconds,
            flight.cpu,
            (flight.cpu - discs.cpu) / f64::from(VIEWS - 1),
            flight.bytes_read / MEGA,
            flight.peak_bytes / MEGA
        );
    }
    text
}

fn chart_rows(towns: &[Measured]) -> Vec<Row> {
    let of = |scene: &str, value: &dyn Fn(&Measured) -> f64| {
        let row = |town: &Measured| Row {
            scene: scene.to_owned(),
            series: "CPU seconds".to_owned(),
            setting: String::new(),
            time: Timing::exactly(town.built.points),
            rmse: value(town),
            largest: 0.0,
            more: vec![],
        };
        towns.iter().map(row).collect::<Vec<_>>()
    };
    [
        of("octree, made once", &|town| town.built.cpu),
        of("one view, discs", &|town| town.discs.cpu),
        of("one view, scan", &|town| town.scan.cpu),
    ]
    .concat()
}
