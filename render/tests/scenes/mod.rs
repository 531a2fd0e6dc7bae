//! Scenes of any kind: triangles, textures, materials, lights and cameras.

use glam::{DAffine2, DVec2, DVec3, Vec3, dvec2, dvec3};
use pointillist_render::sh::Sh;
use pointillist_render::shade::{self, Falloff, Light, LightOutline, MerlTable};
use pointillist_render::shprobe::Field;
use pointillist_render::{
    AmbientLight, BakedLight, BakedSide, Bump, BumpHeight, Camera, Details, LightSource, Lightmap, Map,
    MapPlace, Material, MeasuredBrdf, Part, Scene, SkyLight, Surroundings, Texels, Texture, Transmission,
    Unbaked,
};
use proptest::prelude::*;
use std::num::NonZeroU32;
use std::sync::{Arc, LazyLock};

fn point() -> impl Strategy<Value = DVec3> {
    // On a lattice, too: edges that meet, triangles in one plane.
    let lattice = [-2..=2, -2..=2, -2..=2].prop_map(|c| DVec3::from_array(c.map(|i| f64::from(i) * 0.5)));
    prop_oneof![2 => [-1.5..1.5, -1.5..1.5, -1.5..1.5].prop_map(DVec3::from_array), 1 => lattice]
}

fn color(most: f32) -> impl Strategy<Value = Vec3> {
    [0.0..most, 0.0..most, 0.0..most].prop_map(Vec3::from_array)
}

fn surface() -> impl Strategy<Value = shade::Material> {
    use shade::Model::{BlinnPhong, Ggx, Lambert, NormalizedPhong, OpenGl};
    let model = prop_oneof![
        3 => Just(Lambert),
        1 => Just(NormalizedPhong),
        1 => Just(BlinnPhong),
        1 => Just(OpenGl),
        1 => Just(Ggx),
    ];
    let opacity = prop_oneof![2 => Just(1.0f32), 1 => 0.0..=1.0f32];
    (model, color(1.0), color(0.5), color(0.3), opacity, 1.0..60.0f32, 0.05..1.0f32).prop_map(
        |(model, diffuse, specular, emission, opacity, shininess, roughness)| {
            let surface = shade::Material::lambert(diffuse).with_specular(model, specular, shininess);
            surface.with_emission(emission).with_opacity(opacity).with_roughness(roughness)
        },
    )
}

fn texture() -> impl Strategy<Value = Texture> {
    (1..5u32, 1..4u32).prop_flat_map(|(width, height)| {
        prop::collection::vec(any::<[u8; 4]>(), (width * height) as usize)
            .prop_map(move |texels| Texture::new("any", [width, height], Texels::Srgb8(texels.into())))
    })
}

fn light() -> impl Strategy<Value = Light> {
    let direction = point().prop_filter("a direction", |d| d.length() > 0.1);
    let falloff = Falloff::InverseSquare;
    prop_oneof![
        (direction, color(3.0))
            .prop_map(|(direction, irradiance)| Light::Directional { direction, irradiance }),
        (point(), color(3.0)).prop_map(move |(p, intensity)| Light::Point {
            position: p * 2.0,
            intensity,
            falloff
        }),
        (point(), color(3.0), 0..3u32).prop_map(move |(corner, radiance, samples)| Light::Rect {
            corner,
            edge_u: DVec3::X * 0.5,
            edge_v: DVec3::Z * 0.5,
            radiance,
            // 0: as a whole.
            samples: NonZeroU32::new(samples),
            falloff,
        }),
        (point(), point(), color(3.0), 0..3u32).prop_filter_map(
            "a line",
            move |(from, to, radiance, samples)| {
                let samples = NonZeroU32::new(samples);
                (from != to).then_some(Light::Line { from, to, radiance, samples, falloff })
            }
        ),
        (point(), color(3.0), any::<bool>()).prop_map(move |(place, radiance, two_sided)| {
            let vertices = [DVec3::ZERO, DVec3::X, DVec3::ONE, DVec3::new(0.2, 0.9, 0.9)];
            let outline = LightOutline::new(&vertices.map(|v| place + v)).expect("four vertices");
            Light::Polygon { outline, radiance, two_sided, samples: None, falloff }
        }),
    ]
}

/// How often surroundings are asked for: each environment map takes tens of milliseconds to prepare.
const RARELY: f64 = 0.03;

/// One measured table for all, of one value: made of a file's bytes, because to tabulate a function takes seconds in a test.
static MEASURED: LazyLock<MeasuredBrdf> = LazyLock::new(|| {
    let header = [90_i32, 90, 180].map(i32::to_le_bytes).concat();
    let values = 100.0_f64.to_le_bytes().repeat(3 * 90 * 90 * 180);
    let table = MerlTable::from_bytes(&[header, values].concat()).expect("a table");
    MeasuredBrdf { table: Arc::new(table), fingerprint: 1 }
});

/// What materials have beyond constants, each by chance; the scene's one texture serves as every map.
fn details() -> impl Strategy<Value = Details> {
    let sometimes = || prop::bool::weighted(0.2);
    let maps = (sometimes(), sometimes(), sometimes(), sometimes(), sometimes());
    let index = prop_oneof![Just(1.0), 1.0..2.0f32];
    let numbers = (0.0..=1.0f32, color(0.6), color(0.6), index);
    let kinds =
        (sometimes(), sometimes(), sometimes(), sometimes(), sometimes(), prop::bool::weighted(RARELY));
    (maps, kinds, numbers).prop_map(
        |(
            (bump, rough, emission, occlusion, normal),
            (metal, mirror, glass, measured, one_sided, own),
            n,
        )| {
            let (share, reflection, color, index) = n;
            let turned = DAffine2::from_angle_translation(f64::from(index), DVec2::splat(f64::from(share)));
            let place = MapPlace { map_from_uv: turned, ..MapPlace::default() };
            let map = if mirror { Map { place, ..Map::new(0) } } else { Map::new(0) };
            let mut details = Details::default();
            details.bump = bump.then_some(Bump { map, height: BumpHeight::OfTexture(0.1) });
            details.roughness_map = rough.then_some(map);
            details.emission_map = emission.then_some(map);
            details.occlusion = occlusion.then_some((map, share));
            details.normal = normal.then_some((map, share));
            details.metallic = metal.then_some(share);
            details.metallic_map = metal.then_some(map);
            details.reflection = mirror.then_some(reflection);
            details.reflection_map = (mirror && rough).then_some(map);
            details.mirrors_by_normal = mirror && one_sided;
            details.light_map = (glass || occlusion).then_some(map);
            details.transmission = glass.then_some(Transmission { color, index });
            details.surroundings = if own { Surroundings::Texture(0) } else { Surroundings::Scene };
            details.measured = measured.then(|| MEASURED.clone());
            details.one_sided = one_sided;
            details
        },
    )
}

/// Materials with textures by chance: none, or the first one everywhere.
fn material() -> impl Strategy<Value = Material> {
    let plain = prop_oneof![Just(Details::default()), details()];
    let emits = prop::bool::weighted(0.1);
    (surface(), plain, emits, any::<[bool; 2]>()).prop_map(
        |(surface, mut details, emits, [diffuse, opacity])| {
            details.emits = emits && surface.emission != Vec3::ZERO;
            let mut material = Material::new("any", surface);
            material.diffuse_map = diffuse.then_some(0);
            material.opacity_map = opacity.then_some(0);
            // Holes elsewhere than colours, by a condition that is as good as chance.
            if material.surface.diffuse.x < 0.3 {
                material.opacity_place.map_from_uv = DAffine2::from_scale(DVec2::new(1.5, 0.5));
            }
            material.details = details;
            material
        },
    )
}

/// Ambient light of each kind; what is baked is so after the triangles are known.
fn ambient() -> impl Strategy<Value = Ambient> {
    let sky = |(sky, ground)| AmbientLight::Sky(SkyLight { sky, ground, up: Vec3::Y });
    prop_oneof![
        color(1.0).prop_map(AmbientLight::Color).prop_map(Ambient::Plain),
        (color(1.0), color(1.0)).prop_map(sky).prop_map(Ambient::Plain),
        prop::collection::vec((point(), color(1.0)), 1..7).prop_map(Ambient::Probes),
        prop::collection::vec([color(1.0), color(1.0), color(1.0)], 6).prop_map(Ambient::Baked),
    ]
}

#[derive(Clone, Debug)]
enum Ambient {
    Plain(AmbientLight),
    /// Places with even light.
    Probes(Vec<(DVec3, Vec3)>),
    /// Irradiance at the corners of each triangle's front.
    Baked(Vec<[Vec3; 3]>),
}

impl Ambient {
    fn of(self, scene: &Scene) -> AmbientLight {
        match self {
            Self::Plain(light) => light,
            Self::Probes(probes) => {
                let even = |color: Vec3| Sh::new(vec![color.as_dvec3()]).expect("one band");
                let (places, light): (Vec<_>, Vec<_>) = probes.iter().map(|(p, c)| (*p, even(*c))).unzip();
                let field = Field::new(&places, &light).expect("finite probes");
                AmbientLight::Probes { field: Box::new(field), unbaked: Unbaked::NONE, fingerprint: 1 }
            }
            Self::Baked(corners) => {
                let irradiance: Vec<[f32; 3]> =
                    corners.iter().take(scene.mesh.triangles.len()).flatten().map(Vec3::to_array).collect();
                let light = BakedLight {
                    positions: &scene.mesh.positions.iter().map(DVec3::to_array).collect::<Vec<_>>(),
                    normals: &vec![[0.0, 1.0, 0.0]; irradiance.len()],
                    irradiance: &irradiance,
                    triangles: &scene.mesh.triangles,
                };
                let faces: Vec<[u32; 1]> = (0..scene.mesh.triangles.len() as u32).map(|i| [i]).collect();
                let side = |faces| BakedSide { faces, back: false, count: 1 };
                let sides: Vec<_> = faces.iter().map(|f| side(&f[..])).collect();
                let light = Lightmap::new(&light, &sides, faces.len()).expect("lists that fit");
                AmbientLight::Radiosity { light: Box::new(light), fingerprint: 1 }
            }
        }
    }
}

/// Scenes of a few triangles, with everything that a scene can have but captured surroundings, which take six large pictures.
pub(crate) fn scene() -> impl Strategy<Value = Scene> {
    let triangle = ([point(), point(), point()], material(), any::<bool>());
    let camera = (point(), 0.3..1.8f64, (4..24u32, 4..20u32));
    (
        prop::collection::vec(triangle, 1..6),
        texture(),
        prop::collection::vec(light(), 0..3),
        camera,
        ambient(),
        color(1.0),
        prop::bool::weighted(RARELY),
    )
        .prop_map(
            |(triangles, texture, lights, (eye, fov, (width, height)), ambient, background, open)| {
                let camera = Camera::perspective(eye + dvec3(0.3, 0.2, 4.0), DVec3::ZERO, fov);
                let mut scene = Scene::new(camera, [width, height]);
                scene.add_texture(texture);
                let uvs = [dvec2(0.0, 0.0), dvec2(1.5, 0.2), dvec2(0.3, 2.0)];
                for (corners, material, two_sided) in triangles {
                    let material = scene.add_material(material);
                    let part = Part::new("triangle", &corners, &[[0, 1, 2]]).with_uvs(&uvs);
                    scene.mesh.add(&part.with_material(material).with_two_sided(two_sided)).expect("it fits");
                }
                scene.lights = lights.into_iter().map(|l| LightSource::new("light", l)).collect();
                scene.ambient = if open { AmbientLight::Environment } else { ambient.of(&scene) };
                scene.image.background = background;
                scene.image.environment = open.then_some(0);
                scene
            },
        )
}
