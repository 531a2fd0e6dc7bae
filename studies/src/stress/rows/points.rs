//! `ibpr` and `surfel`: clouds that are far away, tiny, huge, flat, in one place or on a line.

use glam::{DVec3, Vec3, dvec3};
use pointillist_ibpr::invariants::{self as scan_facts, OwnedScan};
use pointillist_ibpr::{Cloud, Frame as ScanFrame, Options as ScanOptions, Passes, Projection, Scan, View};
use pointillist_surfel::invariants::{self as disc_facts, OwnedPoints};
use pointillist_surfel::{Frame as DiscFrame, Options as DiscOptions, Points, Procedure};

use super::row;
use crate::stress::check::{Check, Verdict};

pub(super) fn add(rows: &mut Vec<Check>) {
    moved(rows);
    degenerate(rows);
    not_finite(rows);
}

/// A position on a lattice of 2⁻²²: it stays what it is when it is moved by up to 2³⁰, and whatever power of two it is multiplied by.
fn on_lattice(p: DVec3) -> DVec3 {
    const STEP: f64 = 1.0 / (1_u64 << 22) as f64;
    (p / STEP).round() * STEP
}

/// A view of 96 × 72 pixels of what is around the origin within 1, after it was scaled and then moved.
fn view(scale: f64, shift: DVec3) -> View {
    let eye = dvec3(0.5, 0.75, 4.0) * scale + shift;
    View::look_at(eye, shift, DVec3::Y, Projection::Perspective { fov_y_rad: 0.7 }, 96, 72)
        .expect("an eye before its target")
}

/// How far points of [`scans`] are apart.
const SPACING: f64 = 1.0 / 64.0;

fn scans() -> [OwnedScan; 2] {
    let side = |towards: DVec3| {
        let scan = OwnedScan::sphere(DVec3::ZERO, 1.0, SPACING, towards).jittered(DVec3::ONE / 512.0, 7);
        OwnedScan { spacing: None, ..scan.moved(on_lattice) }
    };
    [side(dvec3(0.5, 0.25, 1.0)), side(dvec3(-1.0, 0.5, 1.0))]
}

fn discs() -> OwnedPoints {
    OwnedPoints::sphere(DVec3::ZERO, 1.0, 20_000).moved(on_lattice)
}

/// Powers of two with the name of a power of ten beside them.
const SHIFTS: [(&str, f64); 3] = [
    ("2²⁰ ≈ 1e6", (1_u64 << 20) as f64),
    ("2²⁷ ≈ 1e8", (1_u64 << 27) as f64),
    ("2³⁰ ≈ 1e9", (1_u64 << 30) as f64),
];

/// See [`SHIFTS`].
const SCALES: [(&str, f64); 4] = [
    ("2⁻²⁰ ≈ 1e-6", 1.0 / (1_u64 << 20) as f64),
    ("2⁻⁷ ≈ 1e-2", 1.0 / 128.0),
    ("2⁷ ≈ 1e2", 128.0),
    ("2²⁰ ≈ 1e6", (1_u64 << 20) as f64),
];

fn scanned(scale: f64, shift: DVec3) -> Result<ScanFrame, String> {
    let scans = scans().map(|scan| scan.moved(|p| p * scale + shift));
    scan_facts::frame(&scans, &view(scale, shift), &ScanOptions::DEFAULT).ok_or_else(|| "refused".to_owned())
}

fn splatted(scale: f64, shift: DVec3) -> Result<DiscFrame, String> {
    let points = discs().resized(scale).moved(|p| p + shift);
    disc_facts::frame(&points, &view(scale, shift), &DiscOptions::DEFAULT).ok_or_else(|| "refused".to_owned())
}

fn moved(rows: &mut Vec<Check>) {
    for (name, far) in SHIFTS {
        let shift = dvec3(far, -far, far);
        row(
            rows,
            format!("two scans of a sphere, moved by {name}"),
            "the same colors, to ten roundings of a coordinate over the points' spacing",
            move || {
                let both = scanned(1.0, DVec3::ZERO).and_then(|here| Ok((here, scanned(1.0, shift)?)));
                match both {
                    Err(message) => Verdict { happened: message, passed: false },
                    Ok((here, there)) => {
                        let values = here.color().iter().flatten().zip(there.color().iter().flatten());
                        let off = values.fold(0.0, |m: f64, (a, b)| m.max(f64::from((a - b).abs())));
                        Verdict::within("largest difference", off, 10.0 * f64::EPSILON * far / SPACING)
                    }
                }
            },
        );
        let expected = "the same frame, bit for bit";
        row(rows, format!("20,000 discs of a sphere, moved by {name}"), expected, move || {
            let here = splatted(1.0, DVec3::ZERO);
            Verdict::facts([
                here.and_then(|here| disc_facts::frames_are_identical(&here, &splatted(1.0, shift)?))
            ])
        });
    }
    for (name, scale) in SCALES {
        let expected = "the same frame, bit for bit, but for depths";
        row(rows, format!("two scans of a sphere, scaled by {name}"), expected, move || {
            let one = scanned(1.0, DVec3::ZERO);
            Verdict::facts([one.and_then(|one| {
                scan_facts::frames_are_identical_but_for_size(&one, &scanned(scale, DVec3::ZERO)?, scale)
            })])
        });
        row(rows, format!("20,000 discs of a sphere, scaled by {name}"), expected, move || {
            let one = splatted(1.0, DVec3::ZERO);
            Verdict::facts([one.and_then(|one| {
                disc_facts::frames_are_identical_but_for_size(&one, &splatted(scale, DVec3::ZERO)?, scale)
            })])
        });
    }
}

/// Clouds without a surface, or without room for one.
fn degenerate(rows: &mut Vec<Check>) {
    let lattice = |at: fn(f64, f64) -> DVec3| -> Vec<DVec3> {
        let step = |i: u32| f64::from(i) / 31.0 - 0.5;
        (0..1024).map(|i| at(step(i % 32), step(i / 32))).collect()
    };
    let clouds = [
        ("one point", vec![DVec3::ZERO]),
        ("1024 points in one place", vec![dvec3(0.1, 0.2, 0.3); 1024]),
        ("two points 1e-300 apart", vec![DVec3::ZERO, DVec3::X * 1e-300]),
        ("1024 points on a line", lattice(|x, y| DVec3::X * (x + y / 32.0))),
        ("a sheet of 1 by 1e-6", lattice(|x, y| dvec3(x, 1e-6 * y, 0.0))),
        ("a sheet of 1 by 1e-12", lattice(|x, y| dvec3(x, 1e-12 * y, 0.0))),
        ("a sheet seen edge-on", lattice(|x, y| dvec3(x, 0.0, y) + dvec3(0.5, 0.75, 4.0) * 0.1)),
        ("two sheets 1e-9 apart", lattice(|x, y| dvec3(x, y, if x < 0.0 { 0.0 } else { 1e-9 }))),
        ("a sheet of 1e-310", lattice(|x, y| dvec3(x, y, 0.0) * 1e-310)),
        (
            "half of the points a million times as dense",
            lattice(|x, y| dvec3(x, y, 0.0) * if x < 0.0 { 1e-6 } else { 1.0 }),
        ),
        (
            "one of 1024 points 1e9 away",
            lattice(|x, y| dvec3(x, y, 0.0) + if x * y < -0.249 { DVec3::X * 1e9 } else { DVec3::ZERO }),
        ),
    ];
    for (name, positions) in clouds {
        let points = positions.clone();
        row(rows, format!("scan: {name}"), "sound frames, in any order", move || {
            let scan = [OwnedScan::new(points.clone())];
            let view = view(1.0, DVec3::ZERO);
            let accepted = scan_facts::cloud(&scan).map(|_| ()).map_err(|error| error.to_string());
            let by = |passes| ScanOptions::DEFAULT.with_surface_layers(true).with_passes(passes);
            Verdict::facts(std::iter::once(accepted).chain(
                [Passes::One, Passes::Two { finer: 0.75 }].into_iter().flat_map(|passes| {
                    [
                        scan_facts::frames_are_sound(&scan, &view, &by(passes)),
                        scan_facts::order_does_not_matter(&scan, &view, &by(passes), 5),
                    ]
                }),
            ))
        });
        row(rows, format!("discs: {name}"), "sound estimates and frames, in any order", move || {
            let cloud = OwnedPoints::loose(positions.clone());
            let view = view(1.0, DVec3::ZERO);
            let accepted = disc_facts::cloud(&cloud).map(|_| ()).map_err(|error| error.to_string());
            let by = |procedure| DiscOptions::DEFAULT.with_surface_layers(true).with_procedure(procedure);
            let drawn = [Procedure::Blended, Procedure::Paper].into_iter().flat_map(|procedure| {
                [
                    disc_facts::frames_are_sound(&cloud, &view, &by(procedure)),
                    disc_facts::order_does_not_matter(&cloud, &view, &by(procedure), 5),
                ]
            });
            let estimates = disc_facts::estimates_are_sound(&positions);
            Verdict::facts([accepted, estimates].into_iter().chain(drawn))
        });
    }
}

fn not_finite(rows: &mut Vec<Check>) {
    for (name, value) in [("NaN", f64::NAN), ("∞", f64::INFINITY)] {
        row(
            rows,
            format!("scan: a position that is {name}"),
            "a typed error that names the point",
            move || {
                let positions = [DVec3::ZERO, DVec3::X, dvec3(0.0, value, 0.0)];
                Verdict::refused_naming("point 2", Cloud::new(&[Scan::new(&positions)], Vec3::ONE))
            },
        );
        row(
            rows,
            format!("discs: a position that is {name}"),
            "a typed error that names the point",
            move || {
                let positions = [DVec3::ZERO, DVec3::X, dvec3(0.0, value, 0.0)];
                Verdict::refused_naming("2", pointillist_surfel::Cloud::new(&Points::new(&positions)))
            },
        );
        row(
            rows,
            format!("discs: a normal that is {name}"),
            "a typed error that names the point",
            move || {
                let (positions, normals) =
                    ([DVec3::ZERO, DVec3::X], [Vec3::Z, Vec3::new(value as f32, 0.0, 1.0)]);
                let points = Points::new(&positions).with_normals(&normals);
                Verdict::refused_naming("1", pointillist_surfel::Cloud::new(&points))
            },
        );
    }
}
