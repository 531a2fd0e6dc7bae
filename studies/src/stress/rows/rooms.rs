//! `radiosity`: form factors far from the origin and of extreme shapes, rooms that give back nearly all light, lamps that touch the ceiling.

use glam::{DQuat, DVec3, dvec3};
use pointillist_radiosity::invariants::{factors, scenes};
use pointillist_radiosity::{
    FactorOptions, Polygon, RadiosityError, Scene, SceneOptions, SolveOptions, Surface, form_factor,
};

use super::row;
use crate::stress::check::{Check, Verdict};

pub(super) fn add(rows: &mut Vec<Check>) {
    moved(rows);
    extreme_shapes(rows);
    rooms(rows);
    refused(rows);
}

fn polygon(vertices: &[DVec3]) -> Polygon {
    Polygon::new(vertices).expect("an area")
}

/// A unit square at this height, looking up or down.
fn square(z: f64, up: bool) -> Polygon {
    let found = polygon(&[dvec3(0.0, 0.0, z), dvec3(1.0, 0.0, z), dvec3(1.0, 1.0, z), dvec3(0.0, 1.0, z)]);
    if up { found } else { found.flipped() }
}

/// Pairs of polygons with a common edge, apart, and of which one is a sliver.
fn pairs() -> [(&'static str, Polygon, Polygon); 3] {
    let wall =
        polygon(&[dvec3(0.0, 0.0, 0.0), dvec3(0.0, 1.0, 0.0), dvec3(0.0, 1.0, 1.0), dvec3(0.0, 0.0, 1.0)]);
    let sliver = polygon(&[dvec3(0.0, 0.0, 0.5), dvec3(1.0, 0.0, 0.5), dvec3(0.5, 1e-3, 0.5)]).flipped();
    [
        ("floor and wall", square(0.0, true), wall),
        ("floor and ceiling", square(0.0, true), square(1.0, false)),
        ("floor and a sliver of 1e-3", square(0.0, true), sliver),
    ]
}

fn moved(rows: &mut Vec<Check>) {
    let turn = DQuat::from_axis_angle(dvec3(0.48, -0.6, 0.64), 1.0);
    let mut motions = vec![("turned".to_owned(), turn, DVec3::ZERO, 1.0)];
    for far in [1e6, 1e9] {
        motions.push((format!("moved by {far:e}"), DQuat::IDENTITY, dvec3(far, -far, far), 1.0));
    }
    for scale in [1e-6, 1e-3, 1e3, 1e6] {
        motions.push((format!("turned and scaled by {scale:e}"), turn, DVec3::ZERO, scale));
    }
    for (name, turn, by, scale) in motions {
        for (pair, from, to) in pairs() {
            row(
                rows,
                format!("form factor: {pair}, {name}"),
                "the same within its error and rounding",
                move || {
                    let moved = |p: &Polygon| {
                        let vertices: Vec<DVec3> =
                            p.vertices().iter().map(|&v| (turn * v + by) * scale).collect();
                        Polygon::new(&vertices).map(|_| ()).map_err(|error| error.to_string())
                    };
                    let same = factors::does_not_depend_on_place(&from, &to, turn, by, scale);
                    Verdict::facts([moved(&from), moved(&to), same])
                },
            );
        }
    }
}

fn extreme_shapes(rows: &mut Vec<Check>) {
    for width in [1e-3, 1e-6, 1e-9] {
        row(
            rows,
            format!("form factor: a strip {width:e} wide beside its wall"),
            "½ within 2 widths",
            move || {
                // A strip that is far longer and lower than the wall above its long edge sees it from 0 to a right angle: half of its sky.
                let far = 1e3;
                let strip = polygon(&[
                    dvec3(0.0, -1.0, 0.0),
                    dvec3(width, -1.0, 0.0),
                    dvec3(width, 1.0, 0.0),
                    dvec3(0.0, 1.0, 0.0),
                ]);
                let wall = polygon(&[
                    dvec3(0.0, -far, 0.0),
                    dvec3(0.0, far, 0.0),
                    dvec3(0.0, far, far),
                    dvec3(0.0, -far, far),
                ]);
                let found = form_factor(&strip, &wall, &[], &FactorOptions::DEFAULT);
                Verdict::within(
                    "off by",
                    (found.value - 0.5).abs(),
                    2.0 * width + found.error + 1e-9 + 0.5 / far,
                )
            },
        );
    }
    for gap in [1e-3, 1e-6, 1e-9] {
        row(
            rows,
            format!("form factor: equal squares {gap:e} apart"),
            "1 less the light past the edges",
            move || {
                let found =
                    form_factor(&square(0.0, true), &square(gap, false), &[], &FactorOptions::DEFAULT);
                // J. R. Howell's C-11 for unit squares a distance h apart tends to 1 − 2 h.
                let h: f64 = gap;
                let x = 1.0 / h;
                let (s, a) = ((1.0 + x * x).sqrt(), x.atan());
                let exact = 2.0 / (std::f64::consts::PI * x * x)
                    * (((1.0 + x * x) / (1.0 + 2.0 * x * x).sqrt()).ln() + 2.0 * x * s * (x / s).atan()
                        - 2.0 * x * a);
                Verdict::within("off by", (found.value - exact).abs(), found.error + 1e-9)
            },
        );
    }
    row(rows, "form factor: coincident squares, and one behind itself", "shares, and reciprocal", || {
        let (up, down) = (square(0.0, true), square(0.0, false));
        Verdict::facts([
            factors::is_a_share(&up, &down, &[]),
            factors::is_a_share(&up, &up, &[]),
            factors::is_reciprocal(&up, &square(-1.0, true), &[]),
        ])
    });
    row(
        rows,
        "form factor: an occluder on the emitter, and one in the receiver's plane",
        "shares no larger than without",
        || {
            let (floor, ceiling) = (square(0.0, true), square(1.0, false));
            Verdict::facts([
                factors::is_a_share(&floor, &ceiling, std::slice::from_ref(&ceiling)),
                factors::is_a_share(&floor, &ceiling, std::slice::from_ref(&floor)),
                factors::is_a_share(&floor, &ceiling, &[square(1e-12, true), square(1.0 - 1e-12, true)]),
            ])
        },
    );
}

/// Six squares that look into a cube of this size.
fn closed_room(size: f64, shift: DVec3, reflectance: f64) -> Vec<Surface> {
    let wall = |o: DVec3, u: DVec3, v: DVec3| {
        let ring = [o, o + u, o + u + v, o + v].map(|p| p * size + shift);
        Surface::new(&ring, [reflectance; 3]).emitting([1.0; 3])
    };
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    vec![
        wall(DVec3::ZERO, x, y),
        wall(z, y, x),
        wall(DVec3::ZERO, y, z),
        wall(x, z, y),
        wall(DVec3::ZERO, z, x),
        wall(y, x, z),
    ]
}

fn rooms(rows: &mut Vec<Check>) {
    let mut cases = vec![];
    for reflectance in [0.5, 0.99, 0.999] {
        cases.push((format!("closed room that reflects {reflectance}"), 1.0, DVec3::ZERO, reflectance));
    }
    for (name, size, shift) in [
        ("of 1e-6", 1e-6, DVec3::ZERO),
        ("of 1e6", 1e6, DVec3::ZERO),
        ("moved by 1e6", 1.0, dvec3(1e6, -1e6, 1e6)),
    ] {
        cases.push((format!("closed room {name}"), size, shift, 0.5));
    }
    for (name, size, shift, reflectance) in cases {
        row(rows, name, "radiosity E/(1 − ρ) everywhere, within its bound", move || {
            let solved = (|| {
                let options = SceneOptions::DEFAULT.with_patch(0.5 * size);
                let transport =
                    Scene::new(&closed_room(size, shift, reflectance), &options)?.transport(&[])?;
                let solved = transport.gauss_seidel(&SolveOptions::DEFAULT)?;
                let exact = 1.0 / (1.0 - reflectance);
                let off = solved.radiosity.iter().flatten().fold(0.0, |m: f64, b| m.max((b - exact).abs()));
                Ok((off / exact, solved.bound / exact))
            })();
            match solved {
                Err(error) => Verdict { happened: RadiosityError::to_string(&error), passed: false },
                Ok((off, bound)) => Verdict::within("off by a share of", off, bound + 1e-6),
            }
        });
    }
    for below in [1e-3, 1e-6, 1e-9] {
        row(
            rows,
            format!("a lamp {below:e} below the ceiling of a room"),
            "solved, no light above it",
            move || {
                let mut surfaces = closed_room(1.0, DVec3::ZERO, 0.5);
                surfaces.iter_mut().for_each(|s| s.emission = [0.0; 3]);
                let z = 1.0 - below;
                let ring =
                    [dvec3(0.25, 0.25, z), dvec3(0.25, 0.75, z), dvec3(0.75, 0.75, z), dvec3(0.75, 0.25, z)];
                surfaces.push(Surface::new(&ring, [0.0; 3]).emitting([1.0; 3]));
                Verdict::facts([
                    scenes::is_refused_or_solved(&surfaces, &SceneOptions::DEFAULT.with_patch(0.5)),
                    lamp_light_stays_below(&surfaces),
                ])
            },
        );
    }
}

/// What a lamp that looks down sends out is what arrives: no more and, in a closed room, no less.
fn lamp_light_stays_below(surfaces: &[Surface]) -> Result<(), String> {
    let text = |error: RadiosityError| error.to_string();
    let scene = Scene::new(surfaces, &SceneOptions::DEFAULT.with_patch(0.25)).map_err(text)?;
    let transport = scene.transport(&[]).map_err(text)?;
    let solved = transport.gauss_seidel(&SolveOptions::DEFAULT).map_err(text)?;
    let above = solved.irradiance(dvec3(0.5, 0.5, 1.0), DVec3::NEG_Z, true).map_err(text)?;
    let below = solved.irradiance(dvec3(0.5, 0.5, 0.0), DVec3::Z, true).map_err(text)?;
    if below[0] > 0.05 && above[0] <= 0.1 * below[0] {
        Ok(())
    } else {
        Err(format!("irradiance {above:?} above the lamp, {below:?} below"))
    }
}

fn refused(rows: &mut Vec<Check>) {
    let ring = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let cases = [
        ("a corner that is NaN", Surface::new(&[DVec3::ZERO, DVec3::X, dvec3(0.0, f64::NAN, 0.0)], [0.5; 3])),
        ("a reflectance of 1.5", Surface::new(&ring, [1.5; 3])),
        ("a reflectance that is NaN", Surface::new(&ring, [f64::NAN; 3])),
        ("an emission below 0", Surface::new(&ring, [0.5; 3]).emitting([-1.0; 3])),
        (
            "an emitter without area",
            Surface::new(&[DVec3::ZERO, DVec3::X, DVec3::X * 2.0], [0.5; 3]).emitting([1.0; 3]),
        ),
    ];
    for (name, surface) in cases {
        row(rows, format!("radiosity: {name}"), "a typed error that names the surface", move || {
            let good = Surface::new(&[DVec3::Z, DVec3::X + DVec3::Z, DVec3::Y + DVec3::Z], [0.5; 3]);
            Verdict::refused_naming("surface 1", Scene::new(&[good, surface.clone()], &SceneOptions::DEFAULT))
        });
    }
}
