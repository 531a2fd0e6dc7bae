//! `speed`: whole pictures by the `pointillist` program: seconds a stage, threads, memory.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use glam::{DVec3, dvec3};
use serde_json::Value;

use crate::common::casters::hills;
use crate::common::data;
use crate::common::provenance::provenance;
use crate::common::report::{Outcome, on_threads, write};
use crate::common::scenes::Sketch;
use crate::common::timing::{Clock, HOW, slowdown, timed_part};

/// A picture to be drawn.
struct Subject {
    name: &'static str,
    /// Scene file or mesh; `None` is the built-in scene.
    path: Option<PathBuf>,
    arguments: Vec<String>,
}

/// Measures and writes `speed.md` and `speed.csv`.
pub(crate) fn run(out_dir: &Path) -> Outcome {
    let mut text = format!(
        "# Whole pictures\n\n`cargo build --release && cargo run --release -p studies -- speed` made this ({}). \
         Each picture is drawn by the `pointillist` program, reading and writing included in the total. {HOW} Of each picture that holds for \
         the tiles; the other columns are of the last run.\n\n",
        provenance()
    );
    let program =
        std::env::current_exe()?.with_file_name(format!("pointillist{}", std::env::consts::EXE_SUFFIX));
    if !program.exists() {
        text += "Skipped: the program is not built; `cargo build --release` builds it.\n";
        eprintln!("speed: skipped, `cargo build --release` first");
        write(out_dir, "speed.md", &text)?;
        return Ok(true);
    }
    let folder = std::env::temp_dir().join(format!("speed-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let result = measure(&program, &folder, &mut text);
    std::fs::remove_dir_all(&folder)?;
    let csv = result?;
    write(out_dir, "speed.md", &text)?;
    write(out_dir, "speed.csv", &csv)?;
    Ok(true)
}

fn measure(program: &Path, folder: &Path, text: &mut String) -> Result<String, std::io::Error> {
    let mut csv =
        "picture,size,threads,total,load,build,tiles,cpu_visibility,cpu_shadow,cpu_shade,peak_bytes\n"
            .to_owned();
    *text += "| picture | size | threads | total s | load s | build s | tiles s | CPU s: visibility | shadow | shade | peak MiB |\n\
              | --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n";
    let cores = std::thread::available_parallelism().map_or(1, usize::from).min(2);
    let mut ratios = String::new();
    for subject in subjects(folder)? {
        eprintln!("speed: {}", subject.name);
        let mut tiles = vec![];
        let mut peaks = vec![];
        for (size, threads) in [("1280x720", 1), ("1280x720", cores), ("2560x1440", cores)] {
            let draw_once = || {
                let stats = draw(program, folder, &subject, size, threads);
                let tiles =
                    stats.as_ref().ok().and_then(|stats| stats.as_ref()?["seconds"]["tiles"].as_f64());
                (tiles.unwrap_or(0.0), stats)
            };
            let (tiles_time, stats) = on_threads(threads, || timed_part(Clock::Wall, draw_once));
            let Some(stats) = stats? else {
                let _ = writeln!(text, "| {} | {size} | {threads} | failed | | | | | | | |", subject.name);
                continue;
            };
            let seconds = |map: &str, key: &str| stats[map][key].as_f64().unwrap_or(0.0);
            let values = [
                seconds("seconds", "total"),
                seconds("seconds", "load"),
                seconds("seconds", "build"),
                tiles_time.seconds,
                seconds("cpu_seconds", "visibility"),
                seconds("cpu_seconds", "shadow"),
                seconds("cpu_seconds", "shade"),
            ];
            let peak = stats["peak_bytes"].as_f64().unwrap_or(0.0);
            let mut cells = values.map(|v| format!("{v:.2}"));
            cells[3] = format!("{tiles_time:.2}");
            let line: String = cells.iter().map(|cell| format!(" {cell} |")).collect();
            let _ =
                writeln!(text, "| {} | {size} | {threads} |{line} {:.0} |", subject.name, peak / 1048576.0);
            let line: String = values.iter().map(|v| format!("{v:.4},")).collect();
            let _ = writeln!(csv, "{},{size},{threads},{line}{peak:.0}", subject.name);
            tiles.push(values[3]);
            peaks.push(peak / 1048576.0);
        }
        if let ([one, two, _], [_, small, large]) = (&tiles[..], &peaks[..]) {
            let _ = writeln!(ratios, "| {} | {:.2} | {:.0} |", subject.name, one / two, large - small);
        }
    }
    let _ = write!(
        text,
        "\n| picture | tiles: 1 thread / {cores} threads | memory added by twice the resolution, MiB |\n| --- | ---: | ---: |\n{ratios}"
    );
    if cores > 1 {
        let longer = slowdown(cores);
        let _ = writeln!(
            text,
            "\nFixed work that needs no memory takes {:.2} ± {:.2} times as long on {cores} threads at once as on one: they do {:.2} times as much of it in the same time on this machine.",
            longer.value,
            longer.spread,
            cores as f64 / longer.value
        );
    }
    if data::folder().is_none() {
        *text += &format!("\n{}\n", data::SKIPPED);
    }
    Ok(csv)
}

fn subjects(folder: &Path) -> std::io::Result<Vec<Subject>> {
    let lit = ["--set", "render.shading=flat"].map(str::to_owned).to_vec();
    let mut list = vec![
        Subject { name: "built-in scene", path: None, arguments: vec![] },
        Subject { name: "terrain, 1 M triangles", path: Some(terrain(folder)?), arguments: lit.clone() },
        Subject { name: "spheres, 1 M triangles", path: Some(spheres(folder)?), arguments: lit },
    ];
    let Some(data) = data::folder() else { return Ok(list) };
    for (name, path, eye, target, light) in [
        ("Crytek Sponza", "scenes/sponza-crytek/sponza.obj", "-1000,200,-30", "0,300,0", "0,900,0"),
        ("Sibenik", "scenes/sibenik/sibenik.obj", "-16,-12,0", "0,-10,0", "0,0,0"),
    ] {
        let path = data.join(path);
        if path.exists() {
            let scene = folder.join(format!("{}.toml", name.replace(' ', "-")));
            let text = format!(
                "[camera]\neye = [{eye}]\ntarget = [{target}]\nfov = 60\n[[object]]\nmesh = {:?}\n[[light]]\n\
                 type = \"point\"\nposition = [{light}]\nintensity = [1, 1, 1]\nattenuation = [0.5, 0, 0]\n",
                path.canonicalize()?.display().to_string()
            );
            std::fs::write(&scene, text)?;
            list.push(Subject { name, path: Some(scene), arguments: vec![] });
        }
    }
    Ok(list)
}

/// Draws, and returns what `--stats` wrote.
fn draw(
    program: &Path,
    folder: &Path,
    subject: &Subject,
    size: &str,
    threads: usize,
) -> std::io::Result<Option<Value>> {
    let stats = folder.join("stats.json");
    let mut command = Command::new(program);
    command.arg("render").args(&subject.path).args(&subject.arguments);
    command.args(["--size", size, "--threads", &threads.to_string(), "--quiet", "--overwrite"]);
    command.arg("--stats").arg(&stats).arg("-o").arg(folder.join("picture.exr"));
    let output = command.stdin(Stdio::null()).output()?;
    if !output.status.success() {
        eprintln!("speed: {}: {}", subject.name, String::from_utf8_lossy(&output.stderr).trim());
        return Ok(None);
    }
    Ok(serde_json::from_slice(&std::fs::read(stats)?).ok())
}

fn terrain(folder: &Path) -> std::io::Result<PathBuf> {
    let (positions, triangles) = hills(708, 4.0);
    let scene = "[camera]\neye = [0, 3.2, 7]\ntarget = [0, 0, 0.5]\nfov = 40\n";
    write_scene(folder, "terrain", scene, &positions, &triangles)
}

fn spheres(folder: &Path) -> std::io::Result<PathBuf> {
    let mut s = Sketch::new(DVec3::Z, DVec3::ZERO, 40.0, 16);
    let white = s.matt(1.0, 1.0);
    for i in 0..8 {
        let (x, y) = (f64::from(i % 4) - 1.5, f64::from(i / 4) - 0.5);
        s.sphere(dvec3(1.1 * x + 0.2 * y, 1.1 * y, -1.2 * y - 0.2 * x), 0.5, 7, white);
    }
    let scene = "[camera]\neye = [0.4, 1.2, 7]\ntarget = [0, 0, 0]\nfov = 30\n";
    write_scene(folder, "spheres", scene, &s.scene.mesh.positions, &s.scene.mesh.triangles)
}

fn write_scene(
    folder: &Path,
    name: &str,
    camera: &str,
    positions: &[DVec3],
    triangles: &[[u32; 3]],
) -> std::io::Result<PathBuf> {
    let mut obj = String::new();
    for p in positions {
        let _ = writeln!(obj, "v {} {} {}", p.x, p.y, p.z);
    }
    for [a, b, c] in triangles {
        let _ = writeln!(obj, "f {} {} {}", a + 1, b + 1, c + 1);
    }
    std::fs::write(folder.join(format!("{name}.obj")), obj)?;
    let light = "[[light]]\ntype = \"directional\"\ndirection = [1, -0.4, 0.3]\nirradiance = [3, 3, 3]\n";
    let path = folder.join(format!("{name}.toml"));
    std::fs::write(&path, format!("{camera}[[object]]\nmesh = \"{name}.obj\"\n{light}"))?;
    Ok(path)
}
