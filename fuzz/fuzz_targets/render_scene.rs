//! Scenes whose lists need not fit together, with any numbers: refused by a typed error, or drawn with sound pixels.
#![no_main]

use arbitrary::Arbitrary;
use glam::{DAffine3, DVec2, DVec3, Vec3};
use libfuzzer_sys::fuzz_target;
use pointillist_render::shade::{self, Falloff, Light, Wrap};
use pointillist_render::{
    Bump, BumpHeight, Camera, Channel, LightSource, Map, Material, Object, Scene, Surroundings, Texels,
    Texture, invariants,
};

#[derive(Arbitrary, Debug)]
struct Input {
    positions: Vec<[i8; 3]>,
    raw_position: Option<[f64; 3]>,
    normals: Vec<[i8; 3]>,
    uvs: Vec<[i8; 2]>,
    /// Corners, normals, coordinates, material, object.
    triangles: Vec<([u8; 3], [u8; 3], [u8; 3], u8, u8)>,
    /// Lists that are left as short as they are.
    cut: u8,
    materials: Vec<MaterialInput>,
    texture: (u8, u8, Vec<[u8; 4]>),
    lights: Vec<([i8; 3], [u8; 3], bool)>,
    raw_light: Option<[f32; 3]>,
    eye: [i8; 3],
    objects: u8,
    environment: Option<u8>,
    /// Where all of the mesh stands once more: scales in quarters, and steps.
    places: Vec<([i8; 3], [i8; 3])>,
}

#[derive(Arbitrary, Debug)]
struct MaterialInput {
    model: u8,
    colors: [[u8; 3]; 3],
    opacity: u8,
    maps: [Option<u8>; 4],
    surroundings: u8,
}

fn steps([x, y, z]: [i8; 3]) -> DVec3 {
    DVec3::new(x.into(), y.into(), z.into()) / 64.0
}

fn color(bytes: [u8; 3]) -> Vec3 {
    Vec3::from_array(bytes.map(|b| f32::from(b) / 255.0))
}

fn material(input: &MaterialInput) -> Material {
    let [diffuse, specular, emission] = input.colors.map(color);
    let models =
        [shade::Model::Lambert, shade::Model::Phong, shade::Model::NormalizedBlinnPhong, shade::Model::Ggx];
    let model = models[input.model as usize % models.len()];
    let surface = shade::Material::lambert(diffuse)
        .with_specular(model, specular, 20.0)
        .with_emission(emission)
        .with_opacity(f32::from(input.opacity) / 255.0)
        .with_roughness(0.3);
    let mut material = Material::new("any", surface);
    let map = |n: u8| Map { wrap: Wrap::Mirror, channel: Channel::Red, ..Map::new(usize::from(n % 3)) };
    let [diffuse, opacity, bump, roughness] = input.maps;
    material.diffuse_map = diffuse.map(|n| usize::from(n % 3));
    material.opacity_map = opacity.map(|n| usize::from(n % 3));
    material.details.bump = bump.map(|n| Bump { map: map(n), height: BumpHeight::World(0.2) });
    material.details.roughness_map = roughness.map(map);
    material.details.surroundings = match input.surroundings % 8 {
        0 => Surroundings::Texture(0),
        _ => Surroundings::Scene,
    };
    material
}

fn scene(input: &Input) -> Scene {
    let camera = Camera::perspective(steps(input.eye) + DVec3::Z * 2.0, DVec3::ZERO, 1.0);
    let mut scene = Scene::new(camera, [9, 7]);
    let mesh = &mut scene.mesh;
    mesh.positions = input.positions.iter().take(24).map(|&p| steps(p)).collect();
    mesh.positions.extend(input.raw_position.map(DVec3::from_array));
    mesh.normals = input.normals.iter().take(24).map(|&n| steps(n).as_vec3().normalize_or(Vec3::Y)).collect();
    mesh.uvs = input.uvs.iter().take(24).map(|&[u, v]| DVec2::new(u.into(), v.into()) / 32.0).collect();
    let objects = 0..input.objects % 4;
    mesh.objects = objects.map(|i| Object { name: i.to_string(), two_sided: i % 2 == 0 }).collect();
    for &(corners, normals, uvs, material, object) in input.triangles.iter().take(12) {
        mesh.triangles.push(corners.map(u32::from));
        mesh.material_of.push(material.into());
        mesh.object_of.push(object.into());
        if input.cut & 1 == 0 {
            mesh.normal_of.push(normals.map(u32::from));
        }
        if input.cut & 2 == 0 {
            mesh.uv_of.push(uvs.map(u32::from));
        }
    }
    if input.cut & 4 != 0 {
        mesh.object_of.pop();
    }
    scene.materials = input.materials.iter().take(8).map(material).collect();
    let (width, height, texels) = &input.texture;
    let texels: Vec<[u8; 4]> = texels.iter().take(64).copied().collect();
    let size = [u32::from(width % 9), u32::from(height % 9)];
    scene.textures.push(Texture::new("any", size, Texels::Srgb8(texels.into())));
    scene.image.environment = input.environment.map(usize::from);
    for &(place, intensity, directional) in input.lights.iter().take(3) {
        let intensity = input.raw_light.map_or(color(intensity), Vec3::from_array);
        let light = if directional {
            Light::Directional { direction: steps(place), irradiance: intensity }
        } else {
            Light::Point { position: steps(place), intensity, falloff: Falloff::InverseSquare }
        };
        scene.lights.push(LightSource::new("any", light));
    }
    scene
}

fuzz_target!(|input: Input| {
    let scene = scene(&input);
    // Light of any size overflows pixels, and then an answer is enough.
    if input.raw_light.is_some() || input.raw_position.is_some() {
        let _ = invariants::picture(&scene);
        return;
    }
    let place = |&(scale, to): &([i8; 3], [i8; 3])| {
        let scale = DVec3::from_array(scale.map(|s| f64::from(s) / 4.0));
        DAffine3::from_translation(steps(to)) * DAffine3::from_scale(scale)
    };
    let places: Vec<DAffine3> = input.places.iter().take(3).map(place).collect();
    let instances = invariants::with_instances(&scene, &places).filter(|_| !places.is_empty());
    if let Err(broken) = invariants::pixels_are_sound(instances.as_ref().unwrap_or(&scene)) {
        panic!("{broken}");
    }
});
