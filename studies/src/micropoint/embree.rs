//! Embree beside the pictures of `studies -- micropoint`: another program that takes point samples, faster than ours.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use glam::{DVec3, Vec3};
use pointillist_render::shade::{Falloff, Light, Model};
use pointillist_render::{AmbientLight, Material, Scene};

use super::Case;
use crate::common::peers;
use crate::common::picture::Picture;
use crate::common::point_sampling::Pinhole;
use crate::common::report::{Row, distinct};
use crate::common::timing::{Clock, timed_part};

/// Names a program that takes scenes as `studies/peers/embree` does.
const EMBREE: &str = "POINTILLIST_EMBREE";

/// Its rows.
pub(super) const SERIES: &str = "Embree";

/// Samples along a pixel's side.
const SIDES: [u32; 3] = [4, 8, 16];

/// Rows of one case; none if the program is not there, or the scene has what it does not know.
pub(super) fn rows(case: &Case) -> std::io::Result<Vec<Row>> {
    let (Some(program), Some(text)) = (peers::find(EMBREE, "embree"), written(&case.scene)) else {
        return Ok(vec![]);
    };
    let file = |name: &str| std::env::temp_dir().join(format!("embree-{}-{name}", std::process::id()));
    let [scene, out] = [file("scene.txt"), file("picture.f32")];
    std::fs::write(&scene, text)?;
    let drawn = SIDES.map(|side| {
        let (time, picture) = timed_part(Clock::Wall, || match draw(&program, &scene, side, &out, case) {
            Ok((seconds, picture)) => (seconds, Ok(picture)),
            Err(error) => (0.0, Err(error)),
        });
        picture.map(|picture| super::row(case, SERIES.to_owned(), format!("{side}×{side}"), time, &picture))
    });
    [scene, out].iter().try_for_each(std::fs::remove_file)?;
    drawn.into_iter().collect()
}

/// Its processor seconds, and its picture.
fn draw(
    program: &Path,
    scene: &PathBuf,
    side: u32,
    out: &PathBuf,
    case: &Case,
) -> std::io::Result<(f64, Picture)> {
    let output = Command::new(program).arg(scene).arg(side.to_string()).arg(out).output()?;
    let printed = String::from_utf8_lossy(&output.stdout);
    let seconds = printed.trim().strip_prefix("cpu_s ").and_then(|text| text.parse().ok());
    let Some(seconds) = seconds.filter(|_| output.status.success()) else {
        let said = String::from_utf8_lossy(&output.stderr);
        return Err(std::io::Error::other(format!("{}: {}", program.display(), said.trim())));
    };
    let mut picture = Picture::black(case.scene.image.width, case.scene.image.height);
    let bytes = std::fs::read(out)?;
    for (pixel, color) in picture.pixels.iter_mut().zip(bytes.as_chunks::<12>().0) {
        let (channels, _) = color.as_chunks::<4>();
        *pixel = Vec3::from_array([0, 1, 2].map(|c| f32::from_le_bytes(channels[c]))).as_dvec3();
    }
    Ok((seconds, picture))
}

/// The scene as the program reads it; `None` if there is more to it than flat, evenly coloured, matt or glowing surfaces and simple lights.
fn written(scene: &Scene) -> Option<String> {
    let dark = matches!(scene.ambient, AmbientLight::Color(color) if color == Vec3::ZERO);
    if !dark || !scene.materials.iter().all(is_plain) {
        return None;
    }
    let camera = Pinhole::new(scene);
    let [right, down, forward] = camera.axes();
    let mut text = format!("{} {}\n", scene.image.width, scene.image.height);
    for v in [camera.eye, right, down, forward] {
        push(&mut text, v);
    }
    let _ = writeln!(text, "{:e}", camera.scale());
    push(&mut text, scene.image.background.as_dvec3());
    let _ = writeln!(text, "{}", scene.materials.len());
    for material in &scene.materials {
        push(&mut text, material.surface.diffuse.as_dvec3());
        push(&mut text, material.surface.emission.as_dvec3());
        let _ = writeln!(text, "{:e}", material.surface.opacity);
    }
    let _ = writeln!(text, "{}", scene.lights.len());
    for light in &scene.lights {
        let (kind, place, strength) = match light.light {
            Light::Point { position, intensity, falloff: Falloff::InverseSquare } => (0, position, intensity),
            Light::Directional { direction, irradiance } => (1, direction.normalize(), irradiance),
            _ => return None,
        };
        let _ = writeln!(text, "{kind}");
        push(&mut text, place);
        push(&mut text, strength.as_dvec3());
        let _ = writeln!(text, "{}", u8::from(light.shadow));
    }
    let mesh = &scene.mesh;
    let _ = writeln!(text, "{}", mesh.positions.len());
    mesh.positions.iter().for_each(|&p| push(&mut text, p));
    let _ = writeln!(text, "{}", mesh.triangles.len());
    for ([a, b, c], material) in mesh.triangles.iter().zip(&mesh.material_of) {
        let _ = writeln!(text, "{a} {b} {c} {material}");
    }
    Some(text)
}

fn is_plain(material: &Material) -> bool {
    let surface = &material.surface;
    let is_matt = surface.model == Model::Lambert || surface.specular == Vec3::ZERO;
    is_matt && material.diffuse_map.is_none() && material.opacity_map.is_none()
}

fn push(text: &mut String, v: DVec3) {
    let _ = writeln!(text, "{:e} {:e} {:e}", v.x, v.y, v.z);
}

/// Our defaults beside its pictures, as a section.
pub(super) fn section(rows: &[Row]) -> String {
    let mut text = "\n## Beside Embree\n\n".to_owned();
    if !rows.iter().any(|r| r.series == SERIES) {
        return text + &peers::skipped("Embree", EMBREE) + "\n";
    }
    let _ = write!(
        text,
        "`studies/peers/embree`: one thread, stratified samples in packets of 16, compiled for this processor where ours is not. Seconds are its \
         processor's, without reading and writing. Scenes with textures are left out.\n\n\
         | scene | RMSE | seconds |{} our RMSE, seconds in those of 16×16 |\n| --- | ---: | ---: |{} ---: |\n",
        SIDES.map(|side| format!(" {side}×{side}: RMSE | seconds |")).concat(),
        " ---: | ---: |".repeat(SIDES.len())
    );
    for scene in distinct(rows.iter().filter(|r| r.series == SERIES).map(|r| r.scene.as_str())) {
        let of = |series: &'static str| rows.iter().filter(move |r| r.scene == scene && r.series == series);
        let Some(ours) = of("correlated").next() else { continue };
        let _ = write!(text, "| {scene} | {:.2e} | {} |", ours.rmse, ours.time);
        of(SERIES).for_each(|r| {
            let _ = write!(text, " {:.2e} | {} |", r.rmse, r.time);
        });
        if let Some(most) = of(SERIES).next_back() {
            let (error, time) = (ours.rmse / most.rmse, ours.time.seconds / most.time.seconds);
            let _ = writeln!(text, " {error:.3}, {time:.3} |");
        }
    }
    text
}
