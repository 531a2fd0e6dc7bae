//! What callers and files get wrong: numbers that are not finite or out of range.

use glam::{DMat3, DVec3, Vec3, dvec2, dvec3};
use pointillist_cli::scene::{Format, Overrides, load, parse_str};
use pointillist_micropoint::{Geometry, SurfaceOpacity, TexelCorner, TexelSums, TexelWrap};
use pointillist_render::Projection;
use pointillist_shade::{Falloff, Light};

use super::pictures::finite_or_refused;
use super::row;
use crate::common::casters;
use crate::common::draw;
use crate::common::scenes::{self, transformed};
use crate::stress::check::{Check, Verdict};

/// Every number of it is finite.
const SOUND_SCENE: &str = r#"
[camera]
eye = [0, 0, 5]
target = [0, 0, 0]
fov = 40
[image]
background = [0, 0, 0]
[ambient]
color = [0, 0, 0]
[[light]]
type = "point"
position = [1, 2, 3]
intensity = [9, 9, 9]
[[light]]
type = "directional"
direction = [0, -1, 0]
irradiance = [1, 1, 1]
[[object]]
mesh = "a.obj"
material = "a"
[material.a]
diffuse = [0.5, 0.5, 0.5]
emission = [1, 1, 1]
opacity = 0.5
"#;

pub(super) fn add(rows: &mut Vec<Check>) {
    not_finite(rows);
    out_of_range(rows);
    not_finite_in_files(rows);
}

fn not_finite(rows: &mut Vec<Check>) {
    for (name, value) in [("NaN", f64::NAN), ("∞", f64::INFINITY)] {
        row(rows, format!("a position that is {name}"), "a typed error", move || {
            let corners = [DVec3::ZERO, DVec3::X, dvec3(0.0, value, 0.0)];
            Verdict::refused(Geometry::new(&corners, &[[0, 1, 2]], &[0], &[SurfaceOpacity::default()]))
        });
        row(rows, format!("an eye that is {name}"), "a typed error", move || {
            let mut scene = scenes::quads(16);
            scene.camera.eye.x = value;
            Verdict::refused(draw::with_pipeline(&scene))
        });
        row(rows, format!("a field of view that is {name}"), "a typed error", move || {
            let mut scene = scenes::quads(16);
            scene.camera.projection = Projection::Perspective { fov_y_rad: value };
            Verdict::refused(draw::with_pipeline(&scene))
        });
        row(rows, format!("a light's position that is {name}"), "a typed error", move || {
            let mut scene = casters::spheres(16);
            scene.lights[0].light = Light::Point {
                position: dvec3(value, 1.0, 1.0),
                intensity: Vec3::ONE,
                falloff: Falloff::InverseSquare,
            };
            Verdict::refused(draw::with_pipeline(&scene))
        });
        row(rows, format!("a light's direction that is {name}"), "a typed error", move || {
            let mut scene = casters::spheres(16);
            scene.lights[0].light =
                Light::Directional { direction: DVec3::splat(value), irradiance: Vec3::ONE };
            Verdict::refused(draw::with_pipeline(&scene))
        });
        row(rows, format!("a texel that is {name}"), "a typed error", move || {
            let texel = |x, y| [if x + y == 3 { value as f32 } else { 0.5 }];
            Verdict::refused(TexelSums::<1>::new(4, 4, TexelWrap::Repeat, texel))
        });
        row(rows, format!("an opacity that is {name}"), "a typed error", move || {
            let surface = SurfaceOpacity { opacity: value as f32, ..SurfaceOpacity::default() };
            let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
            Verdict::refused(Geometry::new(&corners, &[[0, 1, 2]], &[0], &[surface]))
        });
        row(
            rows,
            format!("texture coordinates that are {name}, given to the mean"),
            "a finite mean",
            move || {
                let sums = TexelSums::new(4, 4, TexelWrap::Repeat, |x, _| [x as f32]).expect("finite texels");
                let corner = |x, y, u| TexelCorner { grid: dvec2(x, y), rational: 1.0, texel: dvec2(u, 0.0) };
                let mean =
                    sums.mean(&[corner(0.0, 0.0, value), corner(1.0, 0.0, 1.0), corner(0.0, 1.0, 2.0)])[0];
                Verdict { happened: format!("mean {mean}"), passed: mean.is_finite() }
            },
        );
    }
}

fn out_of_range(rows: &mut Vec<Check>) {
    row(rows, "eye = target", "a typed error", || {
        let mut scene = scenes::quads(16);
        scene.camera.target = scene.camera.eye;
        Verdict::refused(draw::with_pipeline(&scene))
    });
    row(rows, "a picture of 0 × 16", "a typed error", || {
        let mut scene = scenes::quads(16);
        scene.image.width = 0;
        Verdict::refused(draw::with_pipeline(&scene))
    });
    row(rows, "positions of ±1e300", "no panic: a picture or a typed error", || {
        let mut scene = scenes::quads(16);
        scene.mesh.positions[0] = dvec3(1e300, -1e300, 1e300);
        finite_or_refused(&scene)
    });
    row(rows, "positions of 1e-310", "no panic: a picture or a typed error", || {
        finite_or_refused(&transformed(&scenes::quads(16), 1e-310, DMat3::IDENTITY, DVec3::ZERO))
    });
}

fn not_finite_in_files(rows: &mut Vec<Check>) {
    for (key, good, bad) in [
        ("camera.eye", "eye = [0, 0, 5]", "eye = [0, nan, 5]"),
        ("camera.target", "target = [0, 0, 0]", "target = [0, 0, inf]"),
        ("camera.fov", "fov = 40", "fov = nan"),
        ("image.background", "background = [0, 0, 0]", "background = [0, nan, 0]"),
        ("ambient.color", "color = [0, 0, 0]", "color = [inf, 0, 0]"),
        ("light[0].position", "position = [1, 2, 3]", "position = [nan, 2, 3]"),
        ("light[0].intensity", "intensity = [9, 9, 9]", "intensity = [9, inf, 9]"),
        ("light[1].direction", "direction = [0, -1, 0]", "direction = [0, nan, 0]"),
        ("material.a.diffuse", "diffuse = [0.5, 0.5, 0.5]", "diffuse = [nan, 0.5, 0.5]"),
        ("material.a.emission", "emission = [1, 1, 1]", "emission = [1, 1, inf]"),
        ("material.a.opacity", "opacity = 0.5", "opacity = nan"),
    ] {
        row(rows, format!("scene file: {key} not finite"), "an error that names it", move || {
            let parsed = |text: &str| parse_str("scene.toml", text, Format::Toml, &[]);
            if let Err(error) = parsed(SOUND_SCENE) {
                return Verdict { happened: format!("without it: {error}"), passed: false };
            }
            Verdict::refused_naming(key, parsed(&SOUND_SCENE.replace(good, bad)))
        });
    }
    let meshes = [
        ("a vertex that is nan", 3, "v 0 0 0\nv 1 0 0\nv 0 nan 0\nf 1 2 3\n"),
        ("a vertex that is inf", 3, "v 0 0 0\nv 1 0 0\nv 0 inf 0\nf 1 2 3\n"),
        (
            "a texture coordinate that is nan",
            5,
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt nan 0\nvt 0 1\nf 1/1 2/2 3/3\n",
        ),
        ("a normal that is inf", 4, "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 inf\nf 1//1 2//1 3//1\n"),
        ("an index out of range", 4, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"),
    ];
    for (i, (name, line, text)) in meshes.into_iter().enumerate() {
        row(rows, format!("OBJ: {name}"), "an error that names the line", move || {
            let path = std::env::temp_dir().join(format!("stress-{}-{i}.obj", std::process::id()));
            let written = std::fs::write(&path, text);
            let result = load(&path, &Overrides::default());
            let _ = std::fs::remove_file(&path);
            match written {
                Ok(()) => {
                    let mut verdict = Verdict::refused_naming(&format!(".obj:{line}:"), result);
                    verdict.happened = verdict.happened.replace(&path.display().to_string(), "mesh.obj");
                    verdict
                }
                Err(e) => Verdict { happened: format!("cannot write the file: {e}"), passed: false },
            }
        });
    }
}
