//! `dice`, `micropoint` and `shadow`: whole pictures of scenes that are small, thin, far away or coincident.

use glam::{DMat3, DVec3, Vec3, dvec2, dvec3};
use pointillist_dice::{Accumulator, Grid, accumulate};
use pointillist_micropoint::{MicropointOptions, PlainOpacity};
use pointillist_render::{Projection, Scene};
use pointillist_shade::{Falloff, Light};
use pointillist_shadow::{Emitter, ShadowLight, ShadowOptions};

use super::row;
use crate::common::casters;
use crate::common::closed_form;
use crate::common::data;
use crate::common::draw;
use crate::common::line_reference;
use crate::common::picture::Picture;
use crate::common::scenes::{self, Sketch, transformed};
use crate::stress::check::{Check, Verdict};

pub(super) fn add(rows: &mut Vec<Check>) {
    small_and_thin(rows);
    far_away(rows);
    transforms(rows);
    at_the_eye(rows);
    coincident(rows);
    shared_edges(rows);
    lights(rows);
}

fn picture(scene: &Scene) -> Picture {
    draw::emissive(scene, MicropointOptions::DEFAULT).expect("the scene is valid")
}

/// 16 × 16 pixels, each a unit of the world.
fn flat() -> (Sketch, u32) {
    let mut s = Sketch::new(dvec3(0.0, 0.0, 5.0), DVec3::ZERO, 40.0, 16);
    s.scene.camera.projection = Projection::Orthographic { height: 16.0 };
    let white = s.emissive(Vec3::ONE, 1.0);
    (s, white)
}

fn small_and_thin(rows: &mut Vec<Check>) {
    for width in [1e-3, 1e-6, 1e-9, 1e-12] {
        row(rows, format!("sliver, 9 pixels by {width:e}"), "its area, within 1e-3 of it", move || {
            let (mut s, white) = flat();
            s.polygon(&[dvec3(-4.3, -5.1, 0.0), dvec3(-4.3 + width, -5.1, 0.0), dvec3(1.7, 3.9, 0.0)], white);
            let area = 0.5 * (-4.3 + width + 4.3) * 9.0;
            Verdict::within(
                "area off by a factor of",
                (picture(&s.scene).total() / 3.0 / area - 1.0).abs(),
                1e-3,
            )
        });
    }
    row(rows, "box of aspect 1e6:1, tilted", "its area, within 1e-6 of it", || {
        let (mut s, white) = flat();
        let (along, across) = (dvec3(6.0, 3.0, 0.0), dvec3(-3.0, 6.0, 0.0) * 1e-6);
        s.polygon(&[-along - across, along - across, along + across, -along + across], white);
        let area = 4.0 * along.length() * across.length();
        Verdict::within("area off by a factor of", (picture(&s.scene).total() / 3.0 / area - 1.0).abs(), 1e-6)
    });
    for offset in [1e7, -1e7] {
        row(
            rows,
            format!("dice: 12-cell triangle at {offset:e} cells"),
            "its area and no other cells",
            move || {
                let t = [dvec2(0.25, 0.5), dvec2(11.5, 3.75), dvec2(4.0, 12.25)].map(|p| p + offset);
                let (mut area, mut stray) = (0.0, 0);
                let found = accumulate(&t, &Grid::UNIT, &mut Accumulator::new(), |run| {
                    area += run.area * f64::from(run.columns.end - run.columns.start);
                    let cell = dvec2(run.columns.start.into(), run.row.into()) - offset;
                    stray += u32::from(cell.min_element() < 0.0 || cell.max_element() > 12.5);
                });
                // The corners are representable: the area has no rounding of its own.
                let exact = 0.5 * (t[1] - t[0]).perp_dot(t[2] - t[0]);
                let error = if found.is_ok() && stray == 0 { (area - exact).abs() } else { f64::INFINITY };
                Verdict::within("area off by cells", error, 1e-12)
            },
        );
    }
    row(rows, "dice: a corner at 1e300", "a typed error", || {
        let t = [dvec2(0.0, 0.0), dvec2(1e300, 0.0), dvec2(0.0, 1e300)];
        Verdict::refused(accumulate(&t, &Grid::UNIT, &mut Accumulator::new(), |_| {}))
    });
    row(rows, "dice: a corner that is NaN", "a typed error", || {
        let t = [dvec2(0.0, f64::NAN), dvec2(1.0, 0.0), dvec2(0.0, 1.0)];
        Verdict::refused(accumulate(&t, &Grid::UNIT, &mut Accumulator::new(), |_| {}))
    });
}

/// A ground seen to its end, `far` away, from a height of 1.
fn ground(far: f64) -> (Scene, Picture) {
    let mut s = Sketch::new(dvec3(0.0, 1.0, 0.0), dvec3(0.0, 0.9, -1.0), 40.0, 64);
    let white = s.emissive(Vec3::ONE, 1.0);
    s.polygon(
        &[dvec3(-far, 0.0, far), dvec3(far, 0.0, far), dvec3(far, 0.0, -far), dvec3(-far, 0.0, -far)],
        white,
    );
    let line = [dvec3(-0.2 * far, 0.0, -far), dvec3(0.2 * far, 0.0, -far)];
    let expected = closed_form::half_plane(&s.scene, line, dvec3(0.0, 0.0, -3.0), DVec3::ONE);
    (s.scene, expected)
}

fn far_away(rows: &mut Vec<Check>) {
    for far in [1e2, 1e4, 1e8, 1e10, 1e12] {
        row(
            rows,
            format!("ground that passes under the eye, {far:e} to its end"),
            "the closed form",
            move || {
                let (scene, expected) = ground(far);
                // Corners are rounded to 1e-16 of their distance, which is then a part of the eye's height of 1.
                let limit = (1e-15 * far).max(1e-9);
                let got = picture(&scene);
                let mut verdict = Verdict::within("largest error", got.largest_error(&expected), limit);
                let off =
                    got.pixels.iter().zip(&expected.pixels).filter(|(a, b)| (a.x - b.x).abs() > 1e-9).count();
                verdict.happened += &format!(", {off} of {} pixels off", got.pixels.len());
                verdict
            },
        );
    }
    for far in [1e6, 1e9, 1e15] {
        row(rows, format!("wall at a distance of {far:e}"), "as at a distance of 1", move || {
            let draw = |d: f64| {
                let mut s = Sketch::new(DVec3::ZERO, DVec3::NEG_Z, 40.0, 64);
                let white = s.emissive(Vec3::ONE, 1.0);
                let ring = [dvec3(-0.2, -0.1, -1.0), dvec3(0.3, -0.2, -1.0), dvec3(0.1, 0.25, -1.0)];
                s.polygon(&ring.map(|p| p * d), white);
                picture(&s.scene)
            };
            Verdict::within("largest difference", draw(far).largest_error(&draw(1.0)), 1e-9)
        });
    }
}

/// A scene to be made in a size.
type Named = (&'static str, fn(u32) -> Scene);

/// A name and a rigid motion with scale.
type Motion = (&'static str, f64, f64, DVec3);

const MOTIONS: [Motion; 6] = [
    ("moved by 1e4", 1.0, 0.0, DVec3::new(1e4, -1e4, 1e4)),
    ("moved by 1e6", 1.0, 0.0, DVec3::new(-1e6, 1e6, 1e6)),
    ("moved by 1e7", 1.0, 0.0, DVec3::new(1e7, 1e7, -1e7)),
    ("scaled by 1e-4", 1e-4, 0.0, DVec3::ZERO),
    ("scaled by 1e4", 1e4, 0.0, DVec3::ZERO),
    ("turned", 1.0, 1.0, DVec3::ZERO),
];

fn moved(scene: &Scene, (_, scale, turn, shift): Motion) -> Scene {
    let axis = dvec3(0.48, -0.6, 0.64);
    transformed(scene, scale, DMat3::from_axis_angle(axis, turn), shift)
}

fn transforms(rows: &mut Vec<Check>) {
    let emissive: [Named; 2] = [("quads", scenes::quads), ("stacked spheres", scenes::spheres)];
    for motion in MOTIONS {
        for (name, make) in emissive {
            row(rows, format!("{name}, {}", motion.0), "the same error within 5 %", move || {
                let scene = make(128);
                let expected = line_reference::render(&scene, 64);
                let (still, other) = (picture(&scene), picture(&moved(&scene, motion)));
                same_error(still.rmse(&expected), other.rmse(&expected))
            });
        }
        let lit: [Named; 3] = [
            ("spheres with shadows", casters::spheres),
            ("hills under a low light", casters::terrain),
            ("panes with shadows", casters::panes),
        ];
        for (name, make) in lit {
            row(rows, format!("{name}, {}", motion.0), "the same picture, RMSE ≤ 1e-6", move || {
                let scene = make(96);
                let draw = |s: &Scene| draw::with_pipeline(s).expect("the scene is valid");
                Verdict::within("RMSE", draw(&scene).rmse(&draw(&moved(&scene, motion))), 1e-6)
            });
        }
        for name in ["spheres", "terrain", "layers", "quads"] {
            if data::folder().is_some() {
                row(
                    rows,
                    format!("reference {name}, {}", motion.0),
                    "the same error within 5 %",
                    move || {
                        let Some(r) = data::references().into_iter().find(|r| r.name == name) else {
                            return Verdict { happened: "skipped: cannot be read".to_owned(), passed: true };
                        };
                        let draw =
                            |s: &Scene| draw::with_pipeline(s).expect("the scene is valid").rmse(&r.picture);
                        same_error(draw(&r.scene), draw(&moved(&r.scene, motion)))
                    },
                );
            }
        }
    }
}

/// Two errors are the same if they differ by 5 % of the first, or by less than a picture's `f32` resolves.
fn same_error(still: f64, moved: f64) -> Verdict {
    const RESOLVED: f64 = 3e-8;
    let passed = (moved - still).abs() <= (0.05 * still).max(RESOLVED);
    Verdict { happened: format!("RMSE {still:.3e} before, {moved:.3e} after"), passed }
}

fn at_the_eye(rows: &mut Vec<Check>) {
    let wall = || {
        let mut s = Sketch::new(DVec3::ZERO, DVec3::NEG_Z, 40.0, 32);
        let blue = s.emissive(Vec3::Z, 1.0);
        let w = |x, y| dvec3(x, y, -9.0);
        s.polygon(&[w(-9.0, -9.0), w(9.0, -9.0), w(9.0, 9.0), w(-9.0, 9.0)], blue);
        s
    };
    row(rows, "triangle with a corner at the eye", "seen edge-on: only the wall behind shows", move || {
        let mut s = wall();
        let before = picture(&s.scene);
        let red = s.emissive(Vec3::X, 1.0);
        s.polygon(&[DVec3::ZERO, dvec3(-1.0, -0.3, -2.0), dvec3(1.0, 0.5, -2.0)], red);
        Verdict::within("largest difference", picture(&s.scene).largest_error(&before), 1e-9)
    });
    row(rows, "closed box around the eye", "its inside fills the picture", || {
        let mut s = Sketch::new(DVec3::ZERO, DVec3::NEG_Z, 40.0, 32);
        let white = s.emissive(Vec3::ONE, 1.0);
        s.cuboid(DVec3::splat(-1.0), DVec3::splat(2.0), white);
        let full = 3.0 * 32.0 * 32.0;
        Verdict::within("area off by pixels", (picture(&s.scene).total() - full).abs() / 3.0, 1e-9)
    });
    row(rows, "triangles across the near plane", "as by exact lines, largest error ≤ 1e-4", move || {
        let mut s = wall();
        let red = s.emissive(Vec3::X, 1.0);
        s.polygon(&[dvec3(-0.4, -0.2, -3.0), dvec3(0.6, -0.3, -3.0), dvec3(0.1, -0.4, 4.0)], red);
        s.polygon(&[dvec3(-2.0, 0.1, 1.0), dvec3(0.1, 0.5, -2.0), dvec3(-0.3, 0.8, 1.0)], red);
        let expected = line_reference::render(&s.scene, 512);
        Verdict::within("largest error", picture(&s.scene).largest_error(&expected), 1e-4)
    });
    row(rows, "everything behind the eye", "the background", || {
        let mut s = Sketch::new(DVec3::ZERO, DVec3::NEG_Z, 40.0, 32);
        let white = s.emissive(Vec3::ONE, 1.0);
        s.sphere(dvec3(0.0, 0.0, 5.0), 2.0, 3, white);
        Verdict::within("area", picture(&s.scene).total(), 0.0)
    });
    row(rows, "no triangles", "the background", || {
        let mut s = Sketch::new(DVec3::ZERO, DVec3::NEG_Z, 40.0, 32);
        s.matt(1.0, 1.0);
        s.scene.image.background = Vec3::new(0.25, 0.5, 0.75);
        s.lamp(DVec3::ONE, 1.0);
        match draw::with_pipeline(&s.scene) {
            Ok(p) => {
                let off = p.pixels.iter().map(|c| (*c - dvec3(0.25, 0.5, 0.75)).length()).fold(0.0, f64::max);
                Verdict::within("largest error", off, 0.0)
            }
            Err(e) => Verdict { happened: e.to_string(), passed: false },
        }
    });
}

fn coincident(rows: &mut Vec<Check>) {
    row(rows, "two coincident squares of different colours", "one of them in every pixel, whole", || {
        let (mut s, red) = flat();
        s.scene.materials[red as usize].surface.emission = Vec3::X;
        let green = s.emissive(Vec3::Y, 1.0);
        for m in [red, green] {
            s.polygon(
                &[
                    dvec3(-20.0, -19.0, 0.0),
                    dvec3(21.0, -20.0, 0.0),
                    dvec3(19.0, 21.0, 0.0),
                    dvec3(-20.0, 20.0, 0.0),
                ],
                m,
            );
        }
        let p = picture(&s.scene);
        let off =
            p.pixels.iter().map(|c| (c.element_sum() - 1.0).abs().max(c.x.min(c.y))).fold(0.0, f64::max);
        Verdict::within("largest error", off, 1e-9)
    });
    row(
        rows,
        "wall and the same wall in 2 × 3 × 7 parts, coincident",
        "no seam, largest error ≤ 1e-9",
        || {
            let mut s = Sketch::new(dvec3(0.3, 0.2, 3.0), DVec3::ZERO, 40.0, 48);
            let (red, green) = (s.emissive(Vec3::X, 1.0), s.emissive(Vec3::Y, 1.0));
            let at = |x: f64, y: f64| dvec3(x, y, 0.3 * x - 0.2 * y);
            s.polygon(&[at(-9.0, -9.0), at(9.0, -9.0), at(9.0, 9.0), at(-9.0, 9.0)], red);
            for i in 0..42 {
                let (x, y) = (f64::from(i % 6) * 0.31 - 1.0, f64::from(i / 6) * 0.27 - 1.0);
                s.polygon(&[at(x, y), at(x + 0.31, y), at(x + 0.31, y + 0.27), at(x, y + 0.27)], green);
            }
            let p = picture(&s.scene);
            let off = p.pixels.iter().map(|c| (c.element_sum() - 1.0).abs()).fold(0.0, f64::max);
            Verdict::within("largest error of the sum", off, 1e-9)
        },
    );
}

fn shared_edges(rows: &mut Vec<Check>) {
    row(rows, "T-junctions: 7 squares beside 1, 11 below", "no crack, largest error ≤ 1e-9", || {
        let mut s = Sketch::new(dvec3(0.3, 0.2, 3.0), DVec3::ZERO, 40.0, 48);
        let white = s.emissive(Vec3::ONE, 1.0);
        let at = |x: f64, y: f64| dvec3(x, y, 0.3 * x - 0.2 * y);
        let mut cell = |x0: f64, y0: f64, x1: f64, y1: f64| {
            s.polygon(&[at(x0, y0), at(x1, y0), at(x1, y1), at(x0, y1)], white);
        };
        cell(-9.0, 0.1, 0.2, 9.0);
        let cut = |low: f64, high: f64, i: u32, n: u32| low + (high - low) * f64::from(i) / f64::from(n);
        for i in 0..7 {
            cell(0.2, cut(0.1, 9.0, i, 7), 9.0, cut(0.1, 9.0, i + 1, 7));
        }
        for i in 0..11 {
            cell(cut(-9.0, 9.0, i, 11), -9.0, cut(-9.0, 9.0, i + 1, 11), 0.1);
        }
        let off = picture(&s.scene).pixels.iter().map(|c| (c.x - 1.0).abs()).fold(0.0, f64::max);
        Verdict::within("largest error", off, 1e-9)
    });
    row(rows, "every triangle twice, and degenerate ones between", "the same picture, bit for bit", || {
        let scene = scenes::spheres(96);
        let mut other = scene.clone();
        let count = scene.mesh.triangles.len();
        for t in 0..count {
            let [a, b, c] = scene.mesh.triangles[t];
            let mut add = |corners| {
                other.mesh.triangles.push(corners);
                other.mesh.material_of.push(scene.mesh.material_of[t]);
                other.mesh.object_of.push(0);
            };
            add([a, b, c]);
            add([a, a, b]);
            add([c, c, c]);
        }
        let off = picture(&scene).largest_error(&picture(&other));
        // Twice the triangles make an edge that four share: no closed solid, so that backs are kept.
        Verdict::within("largest difference", off, 1e-9)
    });
}

fn lights(rows: &mut Vec<Check>) {
    row(rows, "a light without direction", "a typed error", || {
        let geometry = draw::geometry(&scenes::quads(16)).expect("the scene is valid");
        let emitter = Emitter::Directional { direction: DVec3::ZERO };
        Verdict::refused(ShadowLight::new(&geometry, &PlainOpacity, emitter, ShadowOptions::default()))
    });
    let positions = [
        ("in the ground", dvec3(0.5, 0.0, 0.5)),
        ("at a corner of the ground", dvec3(6.0, 0.0, 6.0)),
        ("at a pole of a sphere", dvec3(1.4, 1.0, 0.0)),
        ("inside a sphere", dvec3(1.4, 0.5, 0.0)),
        ("at the eye", dvec3(0.5, 2.6, 6.0)),
        ("at a distance of 1e12", dvec3(1e12, 1e12, 0.0)),
    ];
    for (name, position) in positions {
        row(rows, format!("a point light {name}"), "a finite picture", move || {
            let mut scene = casters::spheres(48);
            scene.lights[0].light =
                Light::Point { position, intensity: Vec3::ONE, falloff: Falloff::InverseSquare };
            finite_or_refused(&scene)
        });
    }
    row(
        rows,
        "a flat ground lit along itself, 1e-6 above it",
        "lit without acne: every pixel within 1e-6",
        || {
            let mut scene = casters::half_plane(48);
            // The ground alone.
            let mesh = &mut scene.mesh;
            mesh.triangles.truncate(2);
            for list in [&mut mesh.material_of, &mut mesh.object_of] {
                list.truncate(2);
            }
            for list in [&mut mesh.uv_of, &mut mesh.normal_of] {
                list.truncate(2);
            }
            scene.lights[0].light =
                Light::Directional { direction: dvec3(1.0, -1e-6, 0.3), irradiance: Vec3::splat(1e6) };
            let lit = draw::with_pipeline(&scene).expect("the scene is valid");
            scene.lights[0].shadow = false;
            let bright = draw::with_pipeline(&scene).expect("the scene is valid");
            let bright_mean = bright.total() / (3 * bright.pixels.len()) as f64;
            Verdict::within("largest relative error", lit.largest_error(&bright) / bright_mean, 1e-6)
        },
    );
}

pub(super) fn finite_or_refused(scene: &Scene) -> Verdict {
    match draw::with_pipeline(scene) {
        Err(error) => Verdict { happened: format!("error: {error}"), passed: true },
        Ok(p) => {
            let finite = p.pixels.iter().all(|c| c.is_finite());
            Verdict {
                happened: format!("a picture, {}", if finite { "finite" } else { "not finite" }),
                passed: finite,
            }
        }
    }
}
