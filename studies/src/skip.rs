//! `skip`: what a scene does not need must cost nothing. Each row draws a scene with something that has nothing to do, and the same scene
//! without it, in turns.

use std::fmt::Write as _;
use std::path::Path;

use glam::{DVec3, Vec3, dvec3};
use pointillist_ibpr as ibpr;
use pointillist_render::{DrawOptions, Scene, Texels, Texture, render};
use pointillist_shade::{self as shade, Falloff, Light};
use pointillist_surfel as surfel;

use crate::common::provenance::provenance;
use crate::common::report::{Outcome, on_one_thread, write};
use crate::common::scenes::{Sketch, checker_ground, lit_spheres, unit_sphere};
use crate::common::timing::{Clock, Ratio, ratio};

/// Pixels along a side.
const SIZE: u32 = 256;

/// How far pictures may be apart: sums in another order, and 1/255 of a mask's texel in its table of means.
const SAME: f32 = 1e-4;

/// What something without use may cost.
const MOST: f64 = 1.05;

/// Two pictures that must be the same, and how much longer the first takes.
struct Row {
    what: &'static str,
    beside: &'static str,
    ratio: Ratio,
    /// Largest difference of a channel.
    apart: f32,
}

/// Measures and writes `skip.md`; fails if a picture changes.
pub(crate) fn run(out_dir: &Path) -> Outcome {
    let rows = on_one_thread(|| -> Result<Vec<Row>, Box<dyn std::error::Error + Send + Sync>> {
        let mut rows = scenes().into_iter().map(row_of_scenes).collect::<Result<Vec<_>, _>>()?;
        rows.push(scans_facing_away()?);
        rows.push(discs_behind_the_eye()?);
        Ok(rows)
    })?;
    write(out_dir, "skip.md", &markdown(&rows))?;
    Ok(rows.iter().all(|row| row.apart <= SAME))
}

fn markdown(rows: &[Row]) -> String {
    let mut text = format!(
        "# What a scene does not need\n\n`cargo run --release -p studies -- skip` made this, on one thread ({}). Processor time of a frame with all that \
         depends on its geometry, without reading files: of a scene with something that changes no pixel over the same scene without it, {SIZE}×{SIZE}. \
         Both are drawn in turns; the ratio is the median of 15 pairs, ± half of the range of the middle half. The aim is at most {MOST}; a ratio \
         nearer to it than its spread is undecided.\n\n\
         | something | beside | time over that without it | at most {MOST} | largest difference |\n| --- | --- | ---: | --- | ---: |\n",
        provenance()
    );
    for Row { what, beside, ratio, apart } in rows {
        let verdict = ratio.at_most(MOST);
        let _ = writeln!(
            text,
            "| {what} | {beside} | {:.3} ± {:.3} | {verdict} | {apart:.0e} |",
            ratio.value, ratio.spread
        );
    }
    text
}

/// A row to be: what has nothing to do, beside what, and the scene with it and without.
type Pair = (&'static str, &'static str, [Scene; 2]);

fn scenes() -> Vec<Pair> {
    let balls = "twelve matt spheres";
    let with = |change: &dyn Fn(&mut Sketch)| {
        let plain = lit_spheres(SIZE);
        let mut sketch = Sketch { scene: plain.clone() };
        change(&mut sketch);
        [sketch.scene, plain]
    };
    vec![
        ("sixteen lamps of no intensity", balls, with(&|s| (0..16).for_each(|i| dark_lamp(s, i)))),
        (
            "sixteen spots that shine away, with shadows",
            balls,
            with(&|s| (0..16).for_each(|i| spot_away(s, i))),
        ),
        ("65,536 triangles behind the eye", balls, with(&|s| ball(s, dvec3(0.4, 1.2, 12.0), 1.0))),
        ("65,536 triangles beside the picture", balls, with(&|s| ball(s, dvec3(40.0, 0.0, -20.0), 1.0))),
        ("65,536 triangles behind a wall", "a wall", behind_a_wall()),
        ("a texture of 4096² of which a pixel is seen", balls, with(&large_texture)),
        ("a million triangles of which one is seen", "a triangle", [million(1_000_000), million(1)]),
        ("a map of opacity that is 1 everywhere", "a texture to the horizon", opaque_map()),
        ("a shadow that falls nowhere", balls, with(&|s| ball(s, dvec3(3.0, -30.0, 0.0), 0.5))),
    ]
}

fn dark_lamp(s: &mut Sketch, i: u32) {
    let position = dvec3(f64::from(i) - 8.0, 4.0, 3.0);
    s.light(Light::Point { position, intensity: Vec3::ZERO, falloff: Falloff::InverseSquare });
}

fn spot_away(s: &mut Sketch, i: u32) {
    s.light(Light::Spot {
        position: dvec3(f64::from(i) - 8.0, 4.0, 9.0),
        direction: DVec3::Z,
        intensity: Vec3::splat(50.0),
        beam_rad: 0.2,
        cutoff_rad: 0.4,
        exponent: 0.0,
        falloff: Falloff::InverseSquare,
    });
}

/// 8·4⁶ = 32,768 triangles, twice.
fn ball(s: &mut Sketch, centre: DVec3, radius: f64) {
    let material = s.matt(0.5, 1.0);
    s.sphere(centre, radius, 6, material);
    s.sphere(centre + 0.1 * DVec3::X, radius, 6, material);
}

fn behind_a_wall() -> [Scene; 2] {
    let mut s = Sketch::new(dvec3(0.0, 0.0, 5.0), DVec3::ZERO, 40.0, SIZE);
    let wall = s.matt(0.7, 1.0);
    s.polygon(
        &[dvec3(-9.0, -9.0, 0.0), dvec3(9.0, -9.0, 0.0), dvec3(9.0, 9.0, 0.0), dvec3(-9.0, 9.0, 0.0)],
        wall,
    );
    s.lamp(dvec3(1.0, 2.0, 4.0), 5.0);
    let plain = s.scene.clone();
    ball(&mut s, dvec3(0.0, 0.0, -3.0), 1.0);
    [s.scene, plain]
}

/// On a triangle that is smaller than a pixel, in the middle of the nearest sphere, and within it.
fn large_texture(s: &mut Sketch) {
    const SIDE: u32 = 4096;
    let texels = Texels::from_grays((0..SIDE * SIDE).map(|i| (i % 251) as u8).collect());
    let map = s.scene.add_texture(Texture::new("large", [SIDE, SIDE], texels));
    let material = s.material(shade::Material::lambert(Vec3::ONE), Some(map));
    let (at, h) = (dvec3(-1.8, -0.6, 0.0), 1e-3);
    s.textured_quad(&[at, at + h * DVec3::X, at + h * (DVec3::X + DVec3::Y), at + h * DVec3::Y], material);
}

/// All but the first are outside of the picture.
fn million(count: u32) -> Scene {
    let mut s = Sketch::new(dvec3(0.0, 0.0, 5.0), DVec3::ZERO, 40.0, SIZE);
    let material = s.matt(0.7, 1.0);
    s.lamp(dvec3(1.0, 2.0, 4.0), 5.0);
    let corner = |i: u32| {
        let (x, y) = (f64::from(i % 1000), f64::from(i / 1000));
        if i == 0 { DVec3::ZERO } else { dvec3(100.0 + x, y, -10.0) }
    };
    let positions: Vec<DVec3> = (0..count)
        .flat_map(|i| [DVec3::ZERO, 0.9 * DVec3::X, 0.9 * DVec3::Y].map(|d| corner(i) + d))
        .collect();
    let triangles: Vec<[u32; 3]> = (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    s.triangles(&positions, &triangles, material);
    s.scene
}

fn opaque_map() -> [Scene; 2] {
    let plain = checker_ground(SIZE, false);
    let mut scene = plain.clone();
    let texels = Texels::from_grays(vec![255; 512 * 512]);
    let map = scene.add_texture(Texture::new("opaque", [512, 512], texels));
    for material in &mut scene.materials {
        material.opacity_map = Some(map);
    }
    [scene, plain]
}

fn row_of_scenes(
    (what, beside, [with, without]): Pair,
) -> Result<Row, Box<dyn std::error::Error + Send + Sync>> {
    eprintln!("skip: {what}");
    let draw = |scene: &Scene| render(scene, &DrawOptions::DEFAULT, &());
    let apart = largest_difference(&draw(&with)?.color, &draw(&without)?.color);
    // Both were drawn above, so neither fails.
    let ratio = ratio(Clock::Processor, || drop(draw(&with)), || drop(draw(&without)));
    Ok(Row { what, beside, ratio, apart })
}

fn largest_difference(a: &[[f32; 4]], b: &[[f32; 4]]) -> f32 {
    a.iter().zip(b).flat_map(|(p, q)| p.iter().zip(q)).map(|(x, y)| (x - y).abs()).fold(0.0, f32::max)
}

/// Both sides of a ball, three times each, up to 64° from the axes: one side is not seen. Without culling it would cost as much as the other.
fn scans_facing_away() -> Result<Row, Box<dyn std::error::Error + Send + Sync>> {
    eprintln!("skip: scans");
    let scan = |towards: DVec3| {
        let (right, up) = towards.any_orthonormal_pair();
        let grid = (-200..=200).flat_map(|i| (-200..=200).map(move |j| (f64::from(i), f64::from(j))));
        let flat = grid.map(|(i, j)| (i * right + j * up) / 208.0).filter(|flat| flat.length() < 0.9);
        flat.map(|flat| flat + (1.0 - flat.length_squared()).sqrt() * towards).collect::<Vec<DVec3>>()
    };
    let towards: Vec<DVec3> = (0..6)
        .map(|i| dvec3(0.2 * ((i % 3) as f64 - 1.0), 0.1, if i < 3 { 1.0 } else { -1.0 }).normalize())
        .collect();
    let points: Vec<Vec<DVec3>> = towards.iter().map(|d| scan(*d)).collect();
    let scans: Vec<ibpr::Scan<'_>> =
        points.iter().zip(&towards).map(|(p, d)| ibpr::Scan::new(p).with_scanner(*d)).collect();
    let [all, front] = [&scans[..], &scans[..3]].map(|scans| ibpr::Cloud::new(scans, Vec3::splat(0.8)));
    let (all, front) = (all?, front?);
    let camera = ibpr::Projection::Orthographic { height: 2.4 };
    let view = ibpr::View::look_at(5.0 * DVec3::Z, DVec3::ZERO, DVec3::Y, camera, SIZE, SIZE)?;
    let mut options = ibpr::Options::default();
    // That of all scans depends on those that are not seen.
    options.scale = ibpr::Scale::Fixed(2.0);
    let mut renderer = ibpr::Renderer::new();
    let mut frames = [ibpr::Frame::default(), ibpr::Frame::default()];
    let mut draw =
        |cloud: &ibpr::Cloud, frame: &mut ibpr::Frame| renderer.draw(cloud, &view, &options, frame);
    draw(&all, &mut frames[0])?;
    draw(&front, &mut frames[1])?;
    let apart = largest_difference(frames[0].color(), frames[1].color());
    let [mut a, mut b] = frames;
    let mut other = ibpr::Renderer::new();
    let ratio = ratio(
        Clock::Processor,
        || drop(draw(&all, &mut a)),
        || drop(other.draw(&front, &view, &options, &mut b)),
    );
    Ok(Row { what: "three scans that face away", beside: "three scans of a ball", ratio, apart })
}

fn discs_behind_the_eye() -> Result<Row, Box<dyn std::error::Error + Send + Sync>> {
    eprintln!("skip: discs");
    let (ball, _) = unit_sphere(7);
    let behind: Vec<DVec3> = ball.iter().map(|p| *p + 12.0 * DVec3::Z).collect();
    let normals: Vec<Vec3> = ball.iter().map(|p| p.as_vec3()).collect();
    let radii = vec![0.008; ball.len()];
    let cloud = |positions: &[DVec3], copies: usize| {
        let (normals, radii) = (normals.repeat(copies), radii.repeat(copies));
        surfel::Cloud::new(&surfel::Points::new(positions).with_normals(&normals).with_radii(&radii))
    };
    let (all, front) = (cloud(&[&ball[..], &behind].concat(), 2)?, cloud(&ball, 1)?);
    let camera = surfel::Projection::Perspective { fov_y_rad: 0.5 };
    let view = surfel::View::look_at(5.0 * DVec3::Z, DVec3::ZERO, DVec3::Y, camera, SIZE, SIZE)?;
    let mut options = surfel::Options::default();
    // All points: which level is taken depends on the spacing of all.
    options.level = 0.0;
    let (mut first, mut second) = (surfel::Renderer::new(), surfel::Renderer::new());
    let (mut a, mut b) = (surfel::Frame::default(), surfel::Frame::default());
    first.draw(&all, &view, &options, &mut a)?;
    second.draw(&front, &view, &options, &mut b)?;
    let apart = largest_difference(a.color(), b.color());
    let ratio = ratio(
        Clock::Processor,
        || drop(first.draw(&all, &view, &options, &mut a)),
        || drop(second.draw(&front, &view, &options, &mut b)),
    );
    Ok(Row { what: "as many discs behind the eye", beside: "131,074 discs of a ball", ratio, apart })
}
