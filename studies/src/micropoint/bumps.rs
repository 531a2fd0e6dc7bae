//! A bumpy metal plane from near to far, where bumps are larger than pixels and where they are much smaller.

use crate::common::draw;
use crate::common::picture::Picture;
use crate::common::report::on_one_thread;
use crate::common::timing::{Timing, timed};
use glam::{DVec2, DVec3, Vec2, Vec3, dvec2, dvec3};
use pointillist_render::{
    Bump, BumpHeight, Camera, LightSource, Map, Material, Part, Scene, Texels, Texture,
};
use pointillist_shade::{self as shade, Light, UvFrame, Wrap, keep_visible, slope_of_heights};
use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;

/// Pixels on a side.
const SIZE: u32 = 96;

/// Samples of the reference along a side of a pixel: 4096 in all, and fewer for a trial.
pub(super) const SAMPLES: u32 = 64;
pub(super) const FEW_SAMPLES: u32 = 32;

/// Texels on a side of the height map.
const TEXELS: u32 = 128;

/// World units that the map covers, and the height of its white.
const PERIOD: f64 = 2.0;
const HEIGHT: f32 = 0.03;

/// Half a side of the plane.
const REACH: f64 = 400.0;

const ROUGHNESS: f32 = 0.25;

/// Rows of pixels with the distance of the plane in their middle.
const BANDS: [(u32, u32, &str); 4] =
    [(60, 96, "near"), (42, 60, "middle"), (33, 42, "far"), (26, 33, "very far")];

/// The section: errors by distance, with as many cells and with as many samples.
pub(super) fn section(side: u32) -> String {
    let scene = scene();
    let reference = sampled(&scene, side);
    let mut text = format!(
        "\n## Bumpy metal\n\nA plane of rough metal (roughness {ROUGHNESS}) under a height map, lit from before the eye, against {} samples a pixel. Errors are \
         relative to the mean radiance of the band.\n\n| method | seconds |",
        side * side
    );
    BANDS
        .iter()
        .for_each(|(_, _, name)| write!(text, " {name}: RMSE | bias |").expect("writing to a string"));
    text += "\n| --- | ---: |";
    BANDS.iter().for_each(|_| text += " ---: | ---: |");
    text.push('\n');
    let mut row = |name: String, time: Timing, picture: &Picture| {
        write!(text, "| {name} | {time} |").expect("writing to a string");
        for (first, end, _) in BANDS {
            let (rmse, bias) = errors(picture, &reference, first, end);
            write!(text, " {rmse:.3} | {:+.1} % |", 100.0 * bias).expect("writing to a string");
        }
        text.push('\n');
    };
    for cells in [1, 2, 4] {
        let mut scene = scene.clone();
        scene.render.cells_per_pixel = Some(cells);
        let (time, picture) =
            on_one_thread(|| timed(|| draw::with_pipeline(&scene).expect("the scene is valid")));
        row(format!("{cells}×{cells} cells"), time, &picture);
    }
    for samples in [1, 4, 16] {
        let (time, picture) = on_one_thread(|| timed(|| sampled(&scene, samples)));
        row(format!("{samples}×{samples} samples"), time, &picture);
    }
    text
}

/// Root of the mean squared difference and mean difference over rows of pixels, as shares of the reference's mean.
fn errors(picture: &Picture, reference: &Picture, first: u32, end: u32) -> (f64, f64) {
    let rows = (first * SIZE) as usize..(end * SIZE) as usize;
    let (mut squares, mut sum, mut whole) = (0.0, 0.0, 0.0);
    for (a, b) in picture.pixels[rows.clone()].iter().zip(&reference.pixels[rows.clone()]) {
        squares += (a.x - b.x).powi(2);
        sum += a.x - b.x;
        whole += b.x;
    }
    let count = rows.len() as f64;
    ((squares / count).sqrt() / (whole / count), sum / whole)
}

fn scene() -> Scene {
    let camera = Camera::perspective(dvec3(0.0, 1.2, 3.0), dvec3(0.0, 0.0, -2.0), 50.0_f64.to_radians());
    let mut scene = Scene::new(camera, [SIZE, SIZE]);
    let heights = (0..TEXELS * TEXELS).map(|i| height(i % TEXELS, i / TEXELS)).collect();
    let texture = scene.add_texture(Texture::new("bumps", [TEXELS, TEXELS], Texels::from_grays(heights)));
    let mut material = Material::new("metal", shade::Material::ggx(Vec3::ZERO, Vec3::splat(0.9), ROUGHNESS));
    let map = Map::new(texture);
    material.details.bump = Some(Bump { map, height: BumpHeight::World(HEIGHT) });
    let material = scene.add_material(material);
    let corners = corners();
    let uvs = corners.map(uv);
    let plane = Part::new("plane", &corners, &[[0, 1, 2], [0, 2, 3]]).with_uvs(&uvs).with_material(material);
    scene.mesh.add(&plane).expect("the plane is valid");
    let irradiance = Vec3::splat(PI as f32);
    scene
        .lights
        .push(LightSource::new("sun", Light::Directional { direction: dvec3(0.1, -0.6, 1.0), irradiance }));
    scene
}

fn corners() -> [DVec3; 4] {
    [(-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)].map(|(x, z)| dvec3(x * REACH, 0.0, z * REACH))
}

fn uv(place: DVec3) -> DVec2 {
    dvec2(place.x, -place.z) / PERIOD
}

/// Waves in several directions that repeat with the map.
fn height(x: u32, y: u32) -> u8 {
    let place = dvec2(f64::from(x), f64::from(y)) / f64::from(TEXELS);
    let waves = [(3.0, 11.0), (-9.0, 7.0), (13.0, 2.0), (5.0, -14.0), (8.0, 9.0)];
    let wave =
        |(i, &(u, v)): (usize, &(f64, f64))| (TAU * (u * place.x + v * place.y) + i as f64 * 1.7).sin();
    let sum: f64 = waves.iter().enumerate().map(wave).sum();
    ((sum / waves.len() as f64 * 0.5 + 0.5) * 255.0 + 0.5) as u8
}

/// The scene by `side`² samples a pixel, each with the slope of the texel that it hits.
fn sampled(scene: &Scene, side: u32) -> Picture {
    let view = scene.camera.view([SIZE, SIZE]).expect("the view is valid");
    let texture = &scene.textures[0];
    let at = |x: i64, y: i64| texture.texel(Wrap::Repeat.texel(x, TEXELS), Wrap::Repeat.texel(y, TEXELS)).x;
    let slopes: Vec<Vec2> = (0..TEXELS * TEXELS)
        .map(|i| slope_of_heights([TEXELS; 2], i % TEXELS, i / TEXELS, at) * HEIGHT)
        .collect();
    let [a, b, c, _] = corners();
    let frame = UvFrame::new([a, b, c], [a, b, c].map(uv)).expect("the plane has an area");
    let (material, light) = (&scene.materials[0].surface, &scene.lights[0].light);
    let sample = |pixel: DVec2| {
        let ray = view.ray(pixel);
        let distance = -ray.origin.y / ray.direction.y;
        let place = ray.origin + ray.direction * distance;
        if ray.direction.y >= 0.0 || place.abs().max_element() > REACH {
            return DVec3::ZERO;
        }
        let texel = uv(place) * f64::from(TEXELS);
        let column = Wrap::Repeat.texel(texel.x.floor() as i64, TEXELS);
        let row = TEXELS - 1 - Wrap::Repeat.texel(texel.y.floor() as i64, TEXELS);
        let to_eye = -ray.direction.normalize().as_vec3();
        let normal = frame.bumped(Vec3::Y, 1.0, slopes[(row * TEXELS + column) as usize]);
        let normal = keep_visible(normal, to_eye, Vec3::Y);
        material.reflect(&light.illuminate(0, place), normal, to_eye).as_dvec3()
    };
    let mut picture = Picture::black(SIZE, SIZE);
    for (i, value) in picture.pixels.iter_mut().enumerate() {
        let corner = dvec2(f64::from(i as u32 % SIZE), f64::from(i as u32 / SIZE));
        for k in 0..side * side {
            let within = dvec2(f64::from(k % side) + 0.5, f64::from(k / side) + 0.5) / f64::from(side);
            *value += sample(corner + within);
        }
        *value /= f64::from(side * side);
    }
    picture
}
