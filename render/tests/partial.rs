//! Pictures that are drawn in several goes are those that are drawn in one.

use glam::{DAffine3, DVec3, Vec3, dvec3};
use pointillist_render::shade::{self, Light};
use pointillist_render::{
    Camera, DrawOptions, LayerKind, LightSource, Material, Mesh, Part, PartialFrame, PixelRect, Prepared,
    RenderError, Scene, Texels, Texture, Watch,
};
use std::sync::atomic::{AtomicBool, Ordering};

/// Two squares, one before the other, under a lamp.
fn scene() -> Scene {
    let camera = Camera::perspective(DVec3::Z * 4.0, DVec3::ZERO, 1.0);
    let mut scene = Scene::new(camera, [75, 53]);
    scene.image.background = Vec3::new(0.1, 0.2, 0.3);
    scene.add_material(Material::new("white", shade::Material::lambert(Vec3::ONE)));
    for (name, size, z) in [("back", 1.5, -1.0), ("front", 0.6, 0.3)] {
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 0.7)];
        let corners = corners.map(|(x, y)| dvec3(size * x, size * y, z));
        scene.mesh.add(&Part::new(name, &corners, &[[0, 1, 2], [0, 2, 3]])).unwrap();
    }
    let lamp = Light::Point {
        position: dvec3(1.0, 2.0, 3.0),
        intensity: Vec3::splat(20.0),
        falloff: shade::Falloff::InverseSquare,
    };
    scene.lights.push(LightSource::new("lamp", lamp));
    scene
}

fn options() -> [DrawOptions; 2] {
    let layers = vec![LayerKind::Normal, LayerKind::Lit(0), LayerKind::Id];
    let window = PixelRect { x0: 7, y0: 15, x1: 70, y1: 34 };
    [DrawOptions::DEFAULT.with_layers(layers), DrawOptions::DEFAULT.with_window(window)]
}

/// Draws until so many tiles more are there.
fn some_more(prepared: &Prepared<'_>, picture: &mut PartialFrame, tiles: u64) -> Result<(), RenderError> {
    let stop = AtomicBool::new(false);
    let wanted = picture.tiles_drawn() as u64 + tiles;
    let progress = |done: u64, _| {
        stop.fetch_or(done >= wanted, Ordering::Relaxed);
    };
    let watch = Watch::new().with_progress(&progress).with_cancel(&stop);
    prepared.continue_view(picture, &watch)
}

#[test]
fn a_picture_that_was_ended_often_has_the_bytes_of_an_undivided_one() {
    let scene = scene();
    let prepared = Prepared::new(&scene, &()).unwrap();
    for options in options() {
        let mut picture = prepared.begin_view(scene.view().unwrap(), &options).unwrap();
        let mut ends = 0;
        while let Err(error) = some_more(&prepared, &mut picture, 2) {
            assert!(matches!(error, RenderError::Cancelled), "{error}");
            ends += 1;
        }
        assert!(ends > 1 && picture.is_complete(), "{ends}");
        assert_eq!(picture.into_frame(), prepared.draw(&options, &()).unwrap());
    }
}

#[test]
fn what_was_drawn_is_taken_over_by_another_run() {
    let scene = scene();
    let prepared = Prepared::new(&scene, &()).unwrap();
    for options in options() {
        let begin = || prepared.begin_view(scene.view().unwrap(), &options).unwrap();
        let mut first = begin();
        some_more(&prepared, &mut first, 3).unwrap_err();
        let (frame, mut drawn) = (first.frame().clone(), first.pixels_drawn());
        let mut second = begin();
        assert!(second.restore(&frame, &drawn));
        assert_eq!(second.tiles_drawn(), first.tiles_drawn());
        assert_eq!(second.pixels_drawn(), drawn);
        prepared.continue_view(&mut second, &()).unwrap();
        assert_eq!(second.into_frame(), prepared.draw(&options, &()).unwrap());
        // A tile that lacks one pixel is drawn anew.
        let marked = drawn.iter().position(|&drawn| drawn).unwrap();
        drawn[marked] = false;
        let mut third = begin();
        assert!(third.restore(&frame, &drawn));
        assert_eq!(third.tiles_drawn() + 1, first.tiles_drawn());
    }
}

#[test]
fn what_is_kept_of_a_scene_that_moved_shows_what_a_new_preparation_shows() {
    let mut scene = scene();
    let card = Texture::new(
        "card",
        [2, 2],
        Texels::Srgb8(vec![[255, 0, 0, 255], [0; 4], [9; 4], [0, 99, 0, 200]].into()),
    );
    let card = scene.add_texture(card);
    let mut leaf = Material::new("leaf", shade::Material::lambert(Vec3::ONE));
    (leaf.diffuse_map, leaf.opacity_map) = (Some(card), Some(card));
    let leaf = scene.add_material(leaf);
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0)].map(|(x, y)| dvec3(x, y, 0.8));
    let uvs = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)].map(|(x, y)| glam::dvec2(x, y));
    let part = Part::new("leaf", &corners, &[[0, 1, 2]]).with_uvs(&uvs).with_material(leaf);
    // Twice in the same place, one of which moves away.
    scene.mesh.add(&part).unwrap();
    scene.mesh.add(&part).unwrap();
    let maps = Prepared::new(&scene, &()).unwrap().maps();
    for position in scene.mesh.positions.iter_mut().rev().take(3) {
        *position += dvec3(-0.4, 0.2, 0.3);
    }
    let draw = |prepared: Prepared<'_>| prepared.draw(&options()[0], &()).unwrap();
    let moved = draw(Prepared::with_maps(&scene, &maps, &()).unwrap());
    assert_eq!(moved, draw(Prepared::new(&scene, &()).unwrap()));
    // And another camera and another light, without any preparation.
    let before = Prepared::new(&scene, &()).unwrap();
    let mut other = scene.clone();
    other.camera.eye.x += 0.3;
    other.lights[0].light =
        Light::Directional { direction: dvec3(0.2, -1.0, -1.0), irradiance: Vec3::splat(2.0) };
    assert_eq!(draw(before.with_scene(&other).unwrap()), draw(Prepared::new(&other, &()).unwrap()));
}

#[test]
fn a_frame_of_another_shape_is_not_taken_over() {
    let scene = scene();
    let prepared = Prepared::new(&scene, &()).unwrap();
    let [with_layers, with_window] = options();
    let view = scene.view().unwrap();
    let mut picture = prepared.begin_view(view, &with_layers).unwrap();
    let all = vec![true; 75 * 53];
    let others = [DrawOptions::DEFAULT, with_window.clone(), with_window.with_layers(vec![LayerKind::Id])];
    for other in others {
        let frame = prepared.draw(&other, &()).unwrap();
        assert!(!picture.restore(&frame, &all[..frame.color.len()]), "{other:?}");
    }
    let frame = prepared.draw(&with_layers, &()).unwrap();
    assert!(!picture.restore(&frame, &all[1..]));
    assert_eq!(picture.tiles_drawn(), 0);
    assert!(picture.restore(&frame, &all) && picture.is_complete());
    prepared.continue_view(&mut picture, &()).unwrap();
    assert_eq!(picture.into_frame(), frame);
}

/// Many triangles a pixel divide the picture into smaller tiles. Here they lie behind the camera, so that the picture must stay as it is.
#[test]
fn smaller_tiles_for_many_triangles_have_the_same_pixels() {
    let few = scene();
    let mut many = scene();
    let mut strip = Mesh::default();
    let corners: Vec<_> = (0..1026).map(|i| dvec3(f64::from(i / 2), f64::from(i % 2), 50.0)).collect();
    let triangles: Vec<_> = (0..1024).map(|i| [i, i + 1, i + 2]).collect();
    strip.add(&Part::new("strip", &corners, &triangles)).unwrap();
    let shape = many.mesh.add_shape(strip).unwrap();
    let pixels = few.image.width * few.image.height;
    let (mut tiles, mut added) = (vec![], 0);
    for triangles_per_pixel in [0, 33, 260] {
        while added * 1024 < triangles_per_pixel * pixels {
            let place = DAffine3::from_translation(DVec3::Z * f64::from(added));
            many.mesh.add_instance(shape, "strip", place).unwrap();
            added += 1;
        }
        let prepared = Prepared::new(&many, &()).unwrap();
        let plain = Prepared::new(&few, &()).unwrap();
        for options in options() {
            let picture = prepared.begin(&options).unwrap();
            tiles.push(picture.tile_count());
            assert_eq!(prepared.draw(&options, &()).unwrap(), plain.draw(&options, &()).unwrap());
        }
    }
    assert_eq!(tiles, [5 * 4, 5 * 3, 10 * 7, 9 * 4, 19 * 14, 17 * 6]);
}

/// Tiles of large pictures are larger, unless there are masks: here one that nothing shows.
#[test]
fn larger_tiles_have_the_same_pixels() {
    let mut plain = scene();
    [plain.image.width, plain.image.height] = [320, 210];
    let mut masked = scene();
    [masked.image.width, masked.image.height] = [320, 210];
    let mask = masked.add_texture(Texture::new("mask", [2, 1], Texels::from_opacities(vec![255, 0])));
    let white = shade::Material::lambert(Vec3::ONE);
    masked.add_material(Material::new("leaf", white).with_opacity_map(mask));
    let [plain, masked] = [&plain, &masked].map(|scene| Prepared::new(scene, &()).unwrap());
    let tiles = [&plain, &masked].map(|p| p.begin(&DrawOptions::DEFAULT).unwrap().tile_count());
    assert_eq!(tiles, [10 * 7, 20 * 14]);
    let layers = DrawOptions::DEFAULT.with_layers(vec![LayerKind::Normal, LayerKind::Lit(0), LayerKind::Id]);
    assert_eq!(plain.draw(&layers, &()).unwrap(), masked.draw(&layers, &()).unwrap());
}
