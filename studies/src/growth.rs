//! `growth`: time and memory of every stage against its size. Each row runs in a process of its own, whose memory is then that of the row.

use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

use cpu_time::ThreadTime;
use glam::{DAffine3, DVec3, Vec3, dvec3};
use pointillist_delaunay::Delaunay;
use pointillist_ibpr as ibpr;
use pointillist_render::{DrawOptions, Scene, render};
use pointillist_shade::{Falloff, Light};
use pointillist_shprobe::place;
use pointillist_surfel as surfel;

use crate::common::casters::hills;
use crate::common::charts::chart_along;
use crate::common::provenance::provenance;
use crate::common::report::{Outcome, Row, on_one_thread, write};
use crate::common::scenes::{Sketch, lit_spheres, spheres};
use crate::common::timing::Timing;

/// A stage with ever more of something.
struct Stage {
    name: &'static str,
    /// What is counted.
    of: &'static str,
    sizes: &'static [usize],
    /// Makes the input; what comes back is what is measured, and returns how large it really was.
    prepare: fn(usize) -> Work,
}

type Work = Box<dyn FnOnce() + Send>;

/// Steepest growth that needs no explanation: that of n log n over these sizes is up to 1.15.
const STEEP: f64 = 1.2;

/// Sizes below which a row says little of growth: what a frame costs whatever is in it.
const FROM_SECONDS: f64 = 0.02;

const STAGES: [Stage; 10] = [
    Stage {
        name: "terrain, under the sun with shadows",
        of: "triangles",
        sizes: &[1_000, 10_000, 100_000, 1_000_000, 10_000_000],
        prepare: terrain,
    },
    Stage {
        name: "spheres behind one another, emissive",
        of: "triangles",
        sizes: &[1_000, 10_000, 100_000, 1_000_000],
        prepare: balls,
    },
    Stage {
        name: "spheres of 512 triangles in 64×64 pixels, in the sun with shadows",
        of: "triangles",
        sizes: &[4_096, 40_960, 409_600, 4_096_000],
        prepare: small_balls,
    },
    Stage {
        name: "the same spheres as instances of one",
        of: "triangles",
        sizes: &[4_096, 40_960, 409_600, 4_096_000],
        prepare: instances,
    },
    Stage {
        name: "twelve spheres",
        of: "pixels",
        sizes: &[10_000, 100_000, 1_000_000, 10_000_000],
        prepare: pixels,
    },
    Stage { name: "lamps with shadows", of: "lights", sizes: &[1, 4, 16, 64, 256], prepare: lights },
    Stage {
        name: "tetrahedra between random places",
        of: "probes",
        sizes: &[10, 100, 1_000, 10_000, 100_000, 1_000_000],
        prepare: probes,
    },
    Stage {
        name: "scans: sorted once, and a frame",
        of: "points",
        sizes: &[100_000, 1_000_000, 10_000_000, 30_000_000],
        prepare: scan,
    },
    Stage {
        name: "discs: a tree once",
        of: "points",
        sizes: &[100_000, 1_000_000, 10_000_000],
        prepare: disc_tree,
    },
    Stage {
        name: "discs: a frame of the level that it needs",
        of: "points",
        sizes: &[100_000, 1_000_000, 10_000_000],
        prepare: disc_frame,
    },
];

/// What a row's process prints.
struct Measured {
    seconds: f64,
    /// Largest memory of the process so far, less what the input took before.
    bytes: f64,
}

/// Measures and writes `growth.md` and `growth.svg`.
pub(crate) fn run(out_dir: &Path) -> Outcome {
    measure(out_dir, usize::MAX)
}

/// The same of small sizes.
pub(crate) fn run_quick(out_dir: &Path) -> Outcome {
    measure(out_dir, 100_000)
}

/// Measures sizes up to `largest`.
fn measure(out_dir: &Path, largest: usize) -> Outcome {
    let mut text = format!(
        "# Growth with size\n\n`cargo run --release -p studies -- growth` made this, on one thread ({}). Processor time of the stage alone, once, and the memory \
         that it adds to that of its input. The exponent is that of time against size since the row above, where that row takes at least {FROM_SECONDS} s; \
         a stage of n log n has up to 1.15. Charts: `growth.svg`. Radiosity has its own in `radiosity.md`, parts in a cell in \
         `micropoint.md`.\n",
        provenance()
    );
    let mut rows = vec![];
    let mut steep = vec![];
    for (index, stage) in STAGES.iter().enumerate() {
        let of = stage.of;
        let _ = write!(
            text,
            "\n## {}\n\n| {of} | CPU s | exponent | µs each | added memory, MiB | bytes each |\n| ---: | ---: | ---: | ---: | ---: | ---: |\n",
            capitalised(stage.name)
        );
        let mut before: Option<(usize, f64)> = None;
        for &size in stage.sizes.iter().filter(|size| **size <= largest) {
            eprintln!("growth: {}, {size} {of}", stage.name);
            let Measured { seconds, bytes } = in_child(index, size)?;
            let exponent = before
                .filter(|b| b.1 >= FROM_SECONDS)
                .map(|(n, s)| (seconds / s).ln() / (size as f64 / n as f64).ln());
            let shown = exponent.map_or("–".to_owned(), |e| format!("{e:.2}"));
            let each = size as f64;
            let _ = writeln!(
                text,
                "| {size} | {seconds:.3} | {shown} | {:.2} | {:.1} | {:.0} |",
                1e6 * seconds / each,
                bytes / 1_048_576.0,
                bytes / each
            );
            if let Some(e) = exponent.filter(|e| *e > STEEP) {
                steep.push(format!("* {}, {size} {of}: {e:.2}", stage.name));
            }
            before = Some((size, seconds));
            rows.push(Row {
                scene: stage.name.to_owned(),
                series: "CPU seconds".to_owned(),
                setting: String::new(),
                time: Timing::exactly(size as f64),
                rmse: seconds,
                largest: 0.0,
                more: vec![],
            });
        }
    }
    let _ = match steep.is_empty() {
        true => write!(text, "\nNo stage grows faster than with the power {STEEP}.\n"),
        false => write!(text, "\n## Steeper than {STEEP}\n\n{}\n", steep.join("\n")),
    };
    write(out_dir, "growth.md", &text)?;
    chart_along(out_dir, "growth", ["size", "processor seconds"], &rows)?;
    Ok(true)
}

fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

fn in_child(stage: usize, size: usize) -> Result<Measured, Box<dyn std::error::Error + Send + Sync>> {
    let output = Command::new(std::env::current_exe()?)
        .args(["growth", &stage.to_string(), &size.to_string()])
        .output()?;
    let text = String::from_utf8_lossy(&output.stdout);
    let numbers: Vec<f64> = text.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    match numbers[..] {
        [seconds, bytes] if output.status.success() => Ok(Measured { seconds, bytes }),
        _ => {
            Err(format!("{} of {size}: {}", STAGES[stage].name, String::from_utf8_lossy(&output.stderr))
                .into())
        }
    }
}

/// Runs one row in this process and prints its seconds and bytes.
pub(crate) fn run_row(stage: usize, size: usize) -> bool {
    let Some(stage) = STAGES.get(stage) else { return false };
    on_one_thread(|| {
        let work = (stage.prepare)(size);
        // The peak of the preparation is forgotten; Linux counts from here on.
        let _ = std::fs::write("/proc/self/clear_refs", "5");
        let before = memory("VmRSS");
        let start = ThreadTime::now();
        work();
        println!("{} {}", start.elapsed().as_secs_f64(), (memory("VmHWM") - before).max(0.0));
    });
    true
}

/// A line of Linux's account of this process, in bytes; 0 elsewhere.
fn memory(line: &str) -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let found = status.lines().find_map(|l| l.strip_prefix(line)?.strip_prefix(':'));
    let kilobytes = found.and_then(|text| text.trim().trim_end_matches("kB").trim().parse::<f64>().ok());
    kilobytes.unwrap_or(0.0) * 1024.0
}

fn draw(scene: Scene) -> Work {
    Box::new(move || {
        render(&scene, &DrawOptions::DEFAULT, &()).expect("the scene is valid");
    })
}

fn terrain(count: usize) -> Work {
    let mut s = Sketch::new(dvec3(0.0, 3.2, 7.0), dvec3(0.0, 0.0, 0.5), 40.0, 1);
    (s.scene.image.width, s.scene.image.height) = (1280, 720);
    let ground = s.matt(0.7, 1.0);
    let (positions, triangles) = hills((count as f64 / 2.0).sqrt().round() as u32, 4.0);
    s.triangles(&positions, &triangles, ground);
    s.sun(dvec3(1.0, -0.4, 0.3));
    draw(s.scene)
}

/// Spheres in rows, one behind the other.
fn balls(count: usize) -> Work {
    let mut s = Sketch::new(dvec3(0.4, 1.2, 7.0), DVec3::ZERO, 30.0, 512);
    let material = s.emissive(Vec3::splat(0.7), 1.0);
    // Spheres of 8·4^level triangles, as many as come nearest to the count.
    let level = ((count as f64 / 64.0).log2() / 2.0).floor().max(0.0) as u32;
    let number = (count / (8 << (2 * level))).max(1);
    for i in 0..number {
        let (x, y) = (f64::from((i % 6) as u32) - 2.5, f64::from((i / 6) as u32) - 1.5);
        s.sphere(dvec3(0.7 * x + 0.2 * y, 0.6 * y, -1.2 * y - 0.2 * x), 0.4, level, material);
    }
    draw(s.scene)
}

/// Of 512 triangles.
const SMALL_BALL: u32 = 3;

/// Copies of one mesh about a pixel large, all over a cube: up to a thousand triangles a pixel.
fn small_balls(count: usize) -> Work {
    let (mut s, material, places) = small_places(count);
    for place in places {
        s.sphere(place, 1.0, SMALL_BALL, material);
    }
    draw(s.scene)
}

fn instances(count: usize) -> Work {
    let (mut s, material, places) = small_places(count);
    let (mut one, ..) = small_places(0);
    one.sphere(DVec3::ZERO, 1.0, SMALL_BALL, material);
    let mesh = &mut s.scene.mesh;
    let shape = mesh.add_shape(one.scene.mesh).expect("it is one object");
    for place in places {
        mesh.add_instance(shape, "ball", DAffine3::from_translation(place)).expect("the place is finite");
    }
    draw(s.scene)
}

/// A sunlit scene without anything, a material, and where to put as many triangles.
fn small_places(count: usize) -> (Sketch, u32, Vec<DVec3>) {
    let mut s = Sketch::new(dvec3(0.0, 0.0, 140.0), DVec3::ZERO, 40.0, 64);
    let material = s.matt(0.7, 1.0);
    s.sun(DVec3::splat(-1.0));
    let (low, high) = (DVec3::splat(-40.0), DVec3::splat(40.0));
    (s, material, place::random(low, high, count / (8 << (2 * SMALL_BALL)), 5))
}

fn pixels(count: usize) -> Work {
    draw(spheres((count as f64).sqrt().round() as u32))
}

fn lights(count: usize) -> Work {
    let mut s = Sketch { scene: lit_spheres(256) };
    s.scene.lights.clear();
    for i in 0..count {
        let (sin, cos) = (i as f64 * 2.399_963).sin_cos();
        let r = 6.0 * ((i as f64 + 0.5) / count as f64).sqrt();
        let position = dvec3(r * cos, 6.0, 4.0 + r * sin);
        s.light(Light::Point {
            position,
            intensity: Vec3::splat(90.0 / count as f32),
            falloff: Falloff::InverseSquare,
        });
    }
    draw(s.scene)
}

fn probes(count: usize) -> Work {
    let points = place::random(DVec3::ZERO, DVec3::ONE, count, 11);
    Box::new(move || {
        std::hint::black_box(Delaunay::new(&points).expect("the points are finite").partition());
    })
}

/// Points on a sphere in a spiral (Vogel 1979), about evenly.
fn on_a_sphere(count: usize) -> Vec<DVec3> {
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let point = |i: usize| {
        let y = 1.0 - (2.0 * i as f64 + 1.0) / count as f64;
        let (sin, cos) = (golden * i as f64).sin_cos();
        let r = (1.0 - y * y).sqrt();
        dvec3(r * cos, y, r * sin)
    };
    (0..count).map(point).collect()
}

fn scan(count: usize) -> Work {
    let points = on_a_sphere(count);
    Box::new(move || {
        let cloud =
            ibpr::Cloud::new(&[ibpr::Scan::new(&points)], Vec3::splat(0.8)).expect("the points are valid");
        let camera = ibpr::Projection::Perspective { fov_y_rad: 0.5 };
        let view = ibpr::View::look_at(5.0 * DVec3::Z, DVec3::ZERO, DVec3::Y, camera, 1024, 1024)
            .expect("the view is valid");
        let mut frame = ibpr::Frame::default();
        ibpr::Renderer::new()
            .draw(&cloud, &view, &ibpr::Options::default(), &mut frame)
            .expect("the options are valid");
    })
}

fn discs(points: &[DVec3]) -> surfel::Cloud {
    let normals: Vec<Vec3> = points.iter().map(|p| p.as_vec3()).collect();
    surfel::Cloud::new(&surfel::Points::new(points).with_normals(&normals)).expect("the points are valid")
}

fn disc_tree(count: usize) -> Work {
    let points = on_a_sphere(count);
    Box::new(move || {
        std::hint::black_box(discs(&points));
    })
}

fn disc_frame(count: usize) -> Work {
    let cloud = discs(&on_a_sphere(count));
    Box::new(move || {
        let camera = surfel::Projection::Perspective { fov_y_rad: 0.5 };
        let view = surfel::View::look_at(5.0 * DVec3::Z, DVec3::ZERO, DVec3::Y, camera, 1024, 1024)
            .expect("the view is valid");
        let mut frame = surfel::Frame::default();
        surfel::Renderer::new()
            .draw(&cloud, &view, &surfel::Options::default(), &mut frame)
            .expect("the options are valid");
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_stage_runs_at_its_smallest() {
        for stage in &STAGES {
            (stage.prepare)(stage.sizes[0].min(2000))();
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn memory_of_this_process_is_known() {
        assert!(memory("VmRSS") > 1e5 && memory("VmHWM") >= memory("VmRSS"));
        assert_eq!(memory("no such line"), 0.0);
    }
}
