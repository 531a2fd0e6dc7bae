//! `expected`: what `--dry-run` and `--error` say beside what is true, on scenes of the gallery.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use pointillist_cli::image_io::{Picture, read_picture};
use serde_json::Value;

use crate::common::data;
use crate::common::provenance::provenance;
use crate::common::report::{Outcome, write};

/// Pixels of the truth on a side of a pixel that is judged; each has 4 × 4 cells.
const FINER: u32 = 4;
/// Width and height of the pictures whose error is judged.
const JUDGED: [u32; 2] = [240, 150];

/// Anything that the program can do with `--dry-run`.
struct Run {
    name: String,
    arguments: Vec<String>,
}

/// Measures and writes `expected.md`.
pub(crate) fn run(out_dir: &Path) -> Outcome {
    let mut text = format!(
        "# What is expected, and what is true\n\n`cargo build --release && cargo run --release -p studies -- expected` made this ({}).\n\n",
        provenance()
    );
    let program =
        std::env::current_exe()?.with_file_name(format!("pointillist{}", std::env::consts::EXE_SUFFIX));
    if !program.exists() {
        eprintln!("expected: skipped, `cargo build --release` first");
        return Ok(true);
    }
    let folder = std::env::temp_dir().join(format!("expected-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let skipped = if data::folder().is_none() { format!("\n{}\n", data::SKIPPED) } else { String::new() };
    let result = times(&program, &folder, &mut text).and_then(|()| {
        text += &skipped;
        errors(&program, &folder, &mut text)
    });
    std::fs::remove_dir_all(&folder)?;
    result?;
    text += &skipped;
    write(out_dir, "expected.md", &text)?;
    print!("{text}");
    Ok(true)
}

/// Seconds and memory.
fn times(program: &Path, folder: &Path, text: &mut String) -> std::io::Result<()> {
    *text += "## `--dry-run`\n\nExpected / measured; the run follows its dry run at once. Wall time suffers from what else the machine does.\n\n\
              | run | dry run s | wall s | CPU s | memory MiB | ratio: wall | CPU | memory |\n\
              | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n";
    let mut runs: Vec<Run> = scenes(folder)?
        .into_iter()
        .map(|(name, scene)| {
            let arguments = ["render".to_owned()].into_iter().chain(scene);
            Run { name, arguments: arguments.chain(["-o", "o.png"].map(str::to_owned)).collect() }
        })
        .collect();
    runs.extend(bakes(program, folder)?);
    for run in runs {
        eprintln!("expected: {}", run.name);
        let dry = stats(program, folder, &[&run.arguments[..], &["--dry-run".to_owned()]].concat())?;
        let real = stats(program, folder, &run.arguments)?;
        let (Some(dry), Some(real)) = (dry, real) else {
            let _ = writeln!(text, "| {} | failed | | | | | | |", run.name);
            continue;
        };
        let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
        let mib = 1_048_576.0;
        let pairs = [
            (number(&dry["expected"]["seconds"]["total"]), number(&real["seconds"]["total"])),
            (number(&dry["expected"]["cpu_seconds"]["total"]), number(&real["cpu_seconds"]["total"])),
            (number(&dry["expected"]["peak_bytes"]) / mib, number(&real["peak_bytes"]) / mib),
        ];
        let columns: String = pairs.iter().map(|(a, b)| format!(" {a:.2} / {b:.2} |")).collect();
        let ratios: String = pairs.iter().map(|(a, b)| format!(" {:.2} |", a / b)).collect();
        let _ = writeln!(text, "| {} | {:.2} |{columns}{ratios}", run.name, number(&dry["seconds"]["total"]));
    }
    Ok(())
}

/// Errors of pictures with few and with many cells.
fn errors(program: &Path, folder: &Path, text: &mut String) -> std::io::Result<()> {
    let [width, height] = JUDGED;
    let _ = write!(
        text,
        "\n## `--error`\n\nBelieved / true RMSE of {width}×{height} pixels with 1 and with 4 cells a pixel side, R G B. The truth is a picture of {FINER} \
         times as many pixels on a side with 4 cells each, averaged.\n\n\
         | scene | 1 cell: believed | true | ratio | 4 cells: believed | true | ratio |\n\
         | --- | ---: | ---: | ---: | ---: | ---: | ---: |\n"
    );
    for (name, scene) in scenes(folder)? {
        eprintln!("expected: error of {name}");
        let draw = |file: &str, times: u32, more: &[&str]| {
            let size = format!("{}x{}", width * times, height * times);
            let own = ["render".to_owned()].into_iter().chain(scene.clone());
            let line = own.chain(["--size", &size, "--float", "--overwrite", "-o", file].map(str::to_owned));
            stats(program, folder, &line.chain(more.iter().map(|&word| word.to_owned())).collect::<Vec<_>>())
        };
        let truth = draw("truth.exr", FINER, &["--set", "render.subpixel=4"])?;
        let (one, four) =
            (draw("one.exr", 1, &["--error", "1e9"])?, draw("four.exr", 1, &["--error", "1e-9"])?);
        let (Some(_), Some(one), Some(four)) = (truth, one, four) else {
            let _ = writeln!(text, "| {name} | failed | | | | | |");
            continue;
        };
        let read = |file: &str| read_picture(&folder.join(file)).map_err(std::io::Error::other);
        let truth = averaged(&read("truth.exr")?);
        let mut line = format!("| {name} |");
        for (stats, file) in [(one, "one.exr"), (four, "four.exr")] {
            let believed = stats["expected_rmse"].as_f64().unwrap_or(f64::NAN);
            let real = rmse(&read(file)?.color, &truth);
            let _ = write!(line, " {believed:.1e} | {real:.1e} | {:.2} |", believed / real);
        }
        let _ = writeln!(text, "{line}");
    }
    Ok(())
}

/// Scenes and what draws them after `render`: nothing for the built-in one.
fn scenes(folder: &Path) -> std::io::Result<Vec<(String, Vec<String>)>> {
    let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize()?;
    let file = |name: &str| repository.join(name).display().to_string();
    let mut list = vec![
        ("built-in scene".to_owned(), vec![]),
        ("house".to_owned(), vec![file("examples/house.toml")]),
        ("rabbit".to_owned(), vec![file("examples/rabbit.obj")]),
    ];
    let Some(data) = data::folder() else { return Ok(list) };
    let data = data.canonicalize()?;
    // The gallery's scenes name their models beside them.
    let places = [
        ("\"CornellBox", "scenes/cornell/CornellBox"),
        ("\"sponza-crytek/", "scenes/sponza-crytek/"),
        ("\"oaktree/", "scenes/oaktree/"),
        ("\"DamagedHelmet", "gltf/DamagedHelmet"),
        ("\"city.exr", "env/city.exr"),
        ("\"teapot.obj", "meshes/teapot/teapot.obj"),
        ("\"textures/", "scenes/sponza-crytek/textures/"),
    ];
    for name in [
        "cornell",
        "shade-glass",
        "shade-helmet",
        "shade-lion",
        "shade-maps",
        "shade-oak",
        "shade-spheres",
        "shade-sponza",
        "shade-teapot",
    ] {
        let mut text = std::fs::read_to_string(repository.join(format!("docs/{name}.toml")))?;
        for (before, place) in places {
            text = text.replace(before, &format!("\"{}", data.join(place).display()));
        }
        for own in ["unit-sphere.obj", "panes.obj"] {
            text = text.replace(&format!("\"{own}"), &format!("\"{}", file(&format!("docs/{own}"))));
        }
        let scene = folder.join(format!("{name}.toml"));
        std::fs::write(&scene, text)?;
        list.push((name.to_owned(), vec![scene.display().to_string()]));
    }
    Ok(list)
}

/// Bakes of radiosity and of probes.
fn bakes(program: &Path, folder: &Path) -> std::io::Result<Vec<Run>> {
    let run = |name: &str, line: &[&str]| Run {
        name: name.to_owned(),
        arguments: line.iter().map(|&word| word.to_owned()).collect(),
    };
    let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize()?;
    let house = repository.join("examples/house.toml").display().to_string();
    let place = ["probe", "place", &house, "--grid", "6x3x4", "-o", "p.json"].map(str::to_owned);
    stats(program, folder, &place)?;
    let mut list = vec![
        run("probes of the house", &["probe", "bake", &house, "p.json", "--overwrite", "-o", "b.json"]),
        run(
            "probes without bounces",
            &["probe", "bake", &house, "p.json", "--bounces", "0", "--overwrite", "-o", "b.json"],
        ),
        run("radiosity of the house, patches of 1", &["radiosity", &house, "--patch", "1", "-o", "r.json"]),
    ];
    let cornell = folder.join("cornell.toml");
    if cornell.exists() {
        let cornell = cornell.display().to_string();
        list.push(run("radiosity of the Cornell box", &["radiosity", &cornell, "-o", "r.json"]));
        let full = ["radiosity", &cornell, "--links", "full", "--patch", "0.2", "-o", "r.json"];
        list.push(run("the same, each patch with each", &full));
    }
    Ok(list)
}

/// Runs the program in a folder; its statistics, or nothing if it failed.
fn stats(program: &Path, folder: &Path, line: &[String]) -> std::io::Result<Option<Value>> {
    let path: PathBuf = folder.join("stats.json");
    let status = Command::new(program)
        .current_dir(folder)
        .args(line)
        .args(["--quiet", "--stats", "stats.json"])
        .stdout(Stdio::null())
        .status()?;
    if !status.success() {
        return Ok(None);
    }
    Ok(serde_json::from_str(&std::fs::read_to_string(path)?).ok())
}

/// Means over squares of pixels.
fn averaged(fine: &Picture) -> Vec<[f32; 4]> {
    let [width, height] = JUDGED.map(|n| n as usize);
    let times = FINER as usize;
    let pixel = |i: usize| {
        let (x, y) = (i % width * times, i / width * times);
        let square = (0..times * times).map(|k| fine.color[(y + k / times) * width * times + x + k % times]);
        let sum = square.fold([0.0_f32; 4], |sum, p| std::array::from_fn(|c| sum[c] + p[c]));
        sum.map(|n| n / (times * times) as f32)
    };
    (0..width * height).map(pixel).collect()
}

fn rmse(a: &[[f32; 4]], b: &[[f32; 4]]) -> f64 {
    let squares = a.iter().zip(b).flat_map(|(a, b)| (0..3).map(move |c| f64::from(a[c] - b[c]).powi(2)));
    (squares.sum::<f64>() / (3 * a.len()) as f64).sqrt()
}
