//! A room with a red and a green wall, lit by one lamp and by what its walls send on to one another.
//! `cargo run --release -p pointillist-render --example radiosity_room` writes `radiosity_room.png`.

use glam::{Vec3, dvec3};
use pointillist_render::radiosity::{self, SceneOptions, SolveOptions};
use pointillist_render::shade::{self, Falloff, Light};
use pointillist_render::{
    AmbientLight, Camera, DrawOptions, Lamps, LightSource, Lightmap, Material, Part, Scene, render,
    scene_surfaces, srgb_from_linear, with_lamps,
};

const SIZE: [u32; 2] = [400, 300];

/// Corners of each wall of a box of 4 × 3 × 4, counter-clockwise seen from inside, and their materials. Bit k of a corner's number tells
/// which end of axis k it is at.
const WALLS: [([u32; 4], usize); 6] = [
    ([0, 2, 6, 4], 1),
    ([1, 5, 7, 3], 2),
    ([0, 4, 5, 1], 0),
    ([2, 3, 7, 6], 0),
    ([0, 1, 3, 2], 0),
    ([4, 6, 7, 5], 0),
];

fn room() -> Result<Scene, Box<dyn std::error::Error>> {
    let mut scene = Scene::new(Camera::perspective(dvec3(2.0, 1.5, 3.9), dvec3(2.0, 1.4, 0.0), 1.2), SIZE);
    let paints =
        [("white", Vec3::splat(0.7)), ("red", Vec3::new(0.7, 0.1, 0.1)), ("green", Vec3::new(0.1, 0.6, 0.1))];
    let materials = paints
        .map(|(name, albedo)| scene.add_material(Material::new(name, shade::Material::lambert(albedo))));
    for (wall, paint) in WALLS {
        let end = |i: u32, axis: u32| f64::from(i >> axis & 1);
        let corners = wall.map(|i| dvec3(4.0 * end(i, 0), 3.0 * end(i, 1), 4.0 * end(i, 2)));
        let part = Part::new("wall", &corners, &[[0, 1, 2], [0, 2, 3]]);
        scene.mesh.add(&part.with_material(materials[paint]))?;
    }
    let (position, falloff) = (dvec3(2.0, 2.5, 2.0), Falloff::InverseSquare);
    scene
        .lights
        .push(LightSource::new("lamp", Light::Point { position, intensity: Vec3::splat(3.0), falloff }));
    Ok(scene)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut scene = room()?;
    // Surfaces are divided into patches; these get light from lamps first, then from one another.
    let surfaces = scene_surfaces(&scene)?;
    let mut patches = radiosity::Scene::new(&surfaces.surfaces, &SceneOptions::DEFAULT.with_patch(0.25))?;
    let direct = with_lamps(&Lamps::new(&scene), |lamps| patches.direct(lamps))?;
    let transport = patches.transport(&direct)?;
    let solution = transport.gauss_seidel(&SolveOptions::DEFAULT)?;
    println!("{} patches, solved to within {:.1e}", transport.patch_count(), solution.bound);

    let light = Lightmap::of_baked(&solution.bake(), &surfaces.faces, scene.mesh.triangles.len())?;
    scene.ambient = AmbientLight::Radiosity { light: Box::new(light), fingerprint: 0 };
    let frame = render(&scene, &DrawOptions::DEFAULT, &())?;
    let byte = |v: f32| (255.0 * srgb_from_linear(v.clamp(0.0, 1.0))).round() as u8;
    let bytes: Vec<u8> = frame.color.iter().flat_map(|c| [byte(c[0]), byte(c[1]), byte(c[2])]).collect();
    image::save_buffer("radiosity_room.png", &bytes, SIZE[0], SIZE[1], image::ColorType::Rgb8)?;
    Ok(())
}
