//! `radiosity`: time against error of form factors and of solutions. Writes `radiosity.md`.

use std::fmt::Write as _;
use std::path::Path;
use std::time::Instant;

use cpu_time::ThreadTime;
use glam::{DQuat, DVec3, dvec3};
use pointillist_radiosity::{
    FactorOptions, Hemicube, HemicubeKind, Polygon, Scene, SceneOptions, SolveOptions, form_factor,
};

use crate::common::kept::with_sections;
use crate::common::report::{Outcome, write};
use crate::common::timing::timed;
use crate::radiosity::boxes::{cornell, quad, room};
use crate::radiosity::buildings;
use crate::radiosity::moved;
use crate::radiosity::peer;
use crate::radiosity::pictures;
use crate::radiosity::probes;

/// A part of the study: appends its sections.
type Part = fn(&mut String) -> Outcome;

const PARTS: [(&str, Part); 12] = [
    ("open", |text| Ok(open_pairs(text).map(|()| true)?)),
    ("hidden", |text| Ok(hidden_pairs(text).map(|()| true)?)),
    ("hemicubes", |text| Ok(hemicubes(text).map(|()| true)?)),
    ("boxes", boxes),
    ("rooms", rooms),
    ("moved", moved::compare),
    ("probes", |text| probes::compare(text).map(|()| true)),
    ("patches", pictures::patches),
    ("importance", pictures::importance),
    ("peer", peer::compare),
    ("buildings", buildings::solve),
    ("sizes", buildings::sizes),
];

/// Runs the study.
pub(crate) fn run(out_dir: &Path) -> Outcome {
    for (name, part) in PARTS {
        run_part(out_dir, name, part)?;
    }
    run_part(out_dir, "growth", |text| buildings::growth(text, out_dir))
}

/// Runs some of its parts; the others' sections stay as they are.
pub(crate) fn run_parts(out_dir: &Path, names: &[&str]) -> Outcome {
    for &name in names {
        match PARTS.iter().find(|part| part.0 == name) {
            Some((_, part)) => run_part(out_dir, name, part)?,
            None if name == "growth" => run_part(out_dir, name, |text| buildings::growth(text, out_dir))?,
            None => {
                let known: Vec<&str> = PARTS.iter().map(|part| part.0).chain(["growth"]).collect();
                return Err(format!("no part `{name}`: there are {}", known.join(", ")).into());
            }
        };
    }
    Ok(true)
}

const HEAD: &str = "# Radiosity: time against error\n\n`cargo run --release -p studies -- radiosity`; `radiosity PART…` runs some parts alone, and each section says on \
     what it was measured. Times are wall-clock unless they are said to be the processor's, on a machine that does other things, too.\n";

/// Runs a part, and puts its sections in the place of those of the same name.
fn run_part(out_dir: &Path, name: &str, part: impl Fn(&mut String) -> Outcome) -> Outcome {
    eprintln!("radiosity: {name}");
    let mut text = String::new();
    part(&mut text)?;
    println!("{text}");
    let before = std::fs::read_to_string(out_dir.join("radiosity.md")).unwrap_or_default();
    let whole = with_sections(HEAD, &before, &text);
    write(out_dir, "radiosity.md", &whole)?;
    Ok(true)
}

fn polygon(o: DVec3, u: DVec3, v: DVec3) -> Polygon {
    Polygon::new(&quad(o, u, v)).expect("a parallelogram")
}

/// Microseconds of processor time of one call, the least of five rounds.
fn microseconds(mut work: impl FnMut()) -> f64 {
    const CALLS: u32 = 50;
    let round = |work: &mut dyn FnMut()| {
        let start = ThreadTime::now();
        (0..CALLS).for_each(|_| work());
        start.elapsed().as_secs_f64() * 1e6 / f64::from(CALLS)
    };
    (0..5).map(|_| round(&mut work)).fold(f64::MAX, f64::min)
}

type Written = Result<(), std::fmt::Error>;

fn open_pairs(text: &mut String) -> Written {
    let floor = polygon(DVec3::ZERO, DVec3::X, DVec3::Y);
    let slanted = polygon(DVec3::ZERO, DVec3::Y, dvec3(0.3, 0.2, 0.9));
    let finest = FactorOptions::DEFAULT.with_unoccluded(1e-15);
    let of = |other: &Polygon, options: &FactorOptions| form_factor(&floor, other, &[], options).value;
    let far = polygon(DVec3::Z * 20.0, DVec3::Y, dvec3(0.9, 0.1, 0.2));
    let pairs = [
        ("parallel unit squares", polygon(DVec3::Z, DVec3::Y, DVec3::X), 0.199_824_895_698_387),
        ("unit squares sharing an edge", polygon(DVec3::ZERO, DVec3::Y, DVec3::Z), 0.200_043_776_075_403),
        ("slanted, sharing an edge", slanted.clone(), of(&slanted, &finest)),
        ("20 sizes apart", far.clone(), of(&far, &finest)),
    ];
    writeln!(
        text,
        "\n## Form factors in the open\n\nThe first two against closed forms, the others against 1e-15 asked for.\n"
    )?;
    writeln!(text, "| pair | asked | error | own bound | µs |\n| --- | --- | --- | --- | --- |")?;
    for (name, other, exact) in &pairs {
        for asked in [1e-4, 1e-8, 1e-12] {
            let options = FactorOptions::DEFAULT.with_unoccluded(asked);
            let found = form_factor(&floor, other, &[], &options);
            let time = microseconds(|| _ = std::hint::black_box(of(other, &options)));
            let (error, bound) = ((found.value / exact - 1.0).abs(), found.error / exact);
            writeln!(text, "| {name} | {asked:.0e} | {error:.1e} | {bound:.1e} | {time:.2} |")?;
        }
    }
    Ok(())
}

fn hidden_pairs(text: &mut String) -> Written {
    let floor = polygon(DVec3::ZERO, DVec3::X, DVec3::Y);
    let ceiling = polygon(DVec3::Z, DVec3::Y, DVec3::X);
    let between = [polygon(dvec3(0.3, 0.3, 0.5), dvec3(0.4, 0.1, 0.0), dvec3(-0.1, 0.4, 0.0))];
    let of = |asked: f64| {
        let options = FactorOptions::DEFAULT.with_occluded(asked);
        form_factor(&floor, &ceiling, &between, &options)
    };
    let exact = of(1e-7).value;
    writeln!(
        text,
        "\n## Past an occluder\n\nParallel unit squares, a turned square half as wide between; against 1e-7 asked for.\n"
    )?;
    writeln!(text, "| asked | error | own bound | µs |\n| --- | --- | --- | --- |")?;
    for asked in [1e-2, 1e-3, 1e-4, 1e-5] {
        let found = of(asked);
        let time = microseconds(|| _ = std::hint::black_box(of(asked)));
        let (error, bound) = ((found.value / exact - 1.0).abs(), found.error / exact);
        writeln!(text, "| {asked:.0e} | {error:.1e} | {bound:.1e} | {time:.0} |")?;
    }
    writeln!(text, "\n{WITHOUT_LINES}")
}

/// What was measured in one run with the algorithm before.
const WITHOUT_LINES: &str = "Microseconds are of processor time. The algorithm that did not cut along lines took 76, 61, 195 and 1071 beside 149, 134, 222 and 619 of this \
     one in the same run, at 1e-6 5831 beside 1821, at 1e-7 10605 beside 3109.";

fn hemicubes(text: &mut String) -> Written {
    let squares: Vec<Polygon> = (0..8)
        .map(|i| {
            let turn = DQuat::from_rotation_z(0.37 * f64::from(i));
            polygon(turn * dvec3(-0.37, 0.1, 1.0), turn * DVec3::Y * 0.9, turn * DVec3::X * 0.8)
        })
        .collect();
    let of = |kind, size: usize, square: &Polygon| {
        Hemicube::new(kind, size).factors(DVec3::ZERO, DVec3::Z, std::slice::from_ref(square))[0]
    };
    let exact: Vec<f64> = squares.iter().map(|s| of(HemicubeKind::Exact, 2048, s)).collect();
    writeln!(
        text,
        "\n## Hemicubes\n\nRoot mean square of the relative error over eight turned squares; against 2048 covered cells across.\n"
    )?;
    writeln!(text, "| cells across | exact coverage | µs | classic | µs |\n| --- | --- | --- | --- | --- |")?;
    for size in [8, 16, 32, 64, 128, 256] {
        write!(text, "| {size} |")?;
        for kind in [HemicubeKind::Exact, HemicubeKind::Classic] {
            let square = |(s, e): (&Polygon, &f64)| (of(kind, size, s) / e - 1.0).powi(2);
            let mean = squares.iter().zip(&exact).map(square).sum::<f64>() / squares.len() as f64;
            let mut hemicube = Hemicube::new(kind, size);
            let time = microseconds(|| _ = hemicube.factors(DVec3::ZERO, DVec3::Z, &squares[..1]));
            write!(text, " {:.1e} | {time:.0} |", mean.sqrt())?;
        }
        writeln!(text)?;
    }
    Ok(())
}

fn boxes(text: &mut String) -> Outcome {
    writeln!(text, "\n## Closed boxes\n\nExitance 1; the exact radiosity is 1/(1 − ρ).\n")?;
    writeln!(
        text,
        "| box | ρ | patches | row sums off 1 by | factors s | method | steps | solve s | error | bound |"
    )?;
    writeln!(text, "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |")?;
    for (name, size, patch) in [("unit", DVec3::ONE, 0.126), ("4 × 0.1 × 3", dvec3(4.0, 0.1, 3.0), 0.26)] {
        for reflectance in [0.5, 0.999] {
            let options = SceneOptions::DEFAULT
                .with_patch(patch)
                .with_factors(FactorOptions::DEFAULT.with_unoccluded(1e-13));
            let start = Instant::now();
            let scene = Scene::new(&room(size, reflectance, 1.0), &options)?;
            let transport = scene.transport(&[])?;
            let seconds = start.elapsed().as_secs_f64();
            let off = transport.row_sums().iter().fold(0.0, |m: f64, s| m.max((s - 1.0).abs()));
            for method in ["Gauss–Seidel", "progressive"] {
                let solving = SolveOptions::DEFAULT.with_max_sweeps(200);
                let (time, solved) = timed(|| match method {
                    "progressive" => transport.progressive(&[], &solving),
                    _ => transport.gauss_seidel(&solving),
                });
                let solved = solved?;
                let exact = 1.0 / (1.0 - reflectance);
                let error = solved.radiosity.iter().flatten().fold(0.0, |m: f64, b| m.max((b - exact).abs()));
                writeln!(
                    text,
                    "| {name} | {reflectance} | {} | {off:.1e} | {seconds:.2} | {method} | {} | {time} | {error:.1e} | {:.1e} |",
                    transport.patch_count(),
                    solved.steps,
                    solved.bound
                )?;
            }
        }
    }
    Ok(true)
}

fn rooms(text: &mut String) -> Outcome {
    writeln!(
        text,
        "\n## A Cornell box\n\nError: root mean square of the irradiance at 60 places on the floor against the first row, relative to its mean.\n"
    )?;
    writeln!(
        text,
        "| patch | links | patches | number of links | MB of links | factors s | solve s | error |"
    )?;
    writeln!(text, "| --- | --- | --- | --- | --- | --- | --- | --- |")?;
    let places: Vec<DVec3> = (0..60)
        .map(|i| dvec3(0.05 + 0.1 * f64::from(i % 10), 0.0, 0.03 + 0.16 * f64::from(i / 10)))
        .collect();
    let mut truth: Option<Vec<f64>> = None;
    for (patch, tolerance) in
        [(0.126, None), (0.126, Some(0.05)), (0.126, Some(0.01)), (0.04, Some(0.05)), (0.04, Some(0.01))]
    {
        let options = SceneOptions::DEFAULT.with_patch(patch).with_tolerance(tolerance);
        let start = Instant::now();
        let transport = Scene::new(&cornell(), &options)?.transport(&[])?;
        let seconds = start.elapsed().as_secs_f64();
        let (time, solved) = timed(|| transport.gauss_seidel(&SolveOptions::DEFAULT));
        let solved = solved?;
        let mut light = vec![];
        for &p in &places {
            light.push(solved.irradiance(p, DVec3::Y, true)?[1]);
        }
        let exact = truth.get_or_insert_with(|| light.clone());
        let mean = exact.iter().sum::<f64>() / exact.len() as f64;
        let squares: f64 = light.iter().zip(exact.iter()).map(|(a, b)| (a - b).powi(2)).sum();
        let error = (squares / light.len() as f64).sqrt() / mean;
        let kind = tolerance.map_or("full".to_owned(), |t| format!("groups, {t}"));
        let links = transport.counts().links;
        // A link takes 32 bytes and two entries of 16.
        let megabytes = links as f64 * 64.0 / 1e6;
        writeln!(
            text,
            "| {patch} | {kind} | {} | {links} | {megabytes:.0} | {seconds:.1} | {time} | {error:.1e} |",
            transport.patch_count()
        )?;
    }
    writeln!(text, "\nThe first row is what the others are compared with.")?;
    Ok(true)
}
