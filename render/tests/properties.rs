//! Scenes of any kind: triangles, textures, materials, lights and cameras.

use glam::{DVec3, Vec3, dvec2, dvec3};
use pointillist_render::shade::{self, Falloff, Light};
use pointillist_render::{
    AmbientLight, Bump, BumpHeight, Camera, Channel, DrawOptions, LightSource, Map, Material, Part,
    PixelRect, Scene, Texels, Texture, invariants, render,
};
use proptest::prelude::*;
use std::sync::LazyLock;
use testkit::holds;

fn point() -> impl Strategy<Value = DVec3> {
    // On a lattice, too: edges that meet, triangles in one plane.
    let lattice = [-2..=2, -2..=2, -2..=2].prop_map(|c| DVec3::from_array(c.map(|i| f64::from(i) * 0.5)));
    prop_oneof![2 => [-1.5..1.5, -1.5..1.5, -1.5..1.5].prop_map(DVec3::from_array), 1 => lattice]
}

fn color(most: f32) -> impl Strategy<Value = Vec3> {
    [0.0..most, 0.0..most, 0.0..most].prop_map(Vec3::from_array)
}

fn surface() -> impl Strategy<Value = shade::Material> {
    use shade::Model::{BlinnPhong, Ggx, Lambert, NormalizedPhong};
    let model =
        prop_oneof![3 => Just(Lambert), 1 => Just(NormalizedPhong), 1 => Just(BlinnPhong), 1 => Just(Ggx)];
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
            .prop_map(move |texels| Texture::new("any", [width, height], Texels::Srgb8(texels)))
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
        (point(), color(3.0)).prop_map(move |(corner, radiance)| Light::Rect {
            corner,
            edge_u: DVec3::X * 0.5,
            edge_v: DVec3::Z * 0.5,
            radiance,
            samples: 2,
            falloff,
        }),
    ]
}

/// Materials with textures by chance: none, or the first one everywhere.
fn material() -> impl Strategy<Value = Material> {
    (surface(), any::<[bool; 4]>()).prop_map(|(surface, [diffuse, opacity, bump, rough])| {
        let mut material = Material::new("any", surface);
        material.diffuse_map = diffuse.then_some(0);
        material.opacity_map = opacity.then_some(0);
        let map = Map { texture: 0, wrap: shade::Wrap::Repeat, channel: Channel::Mean };
        material.details.bump = bump.then_some(Bump { map, height: BumpHeight::OfTexture(0.1) });
        material.details.roughness_map = rough.then_some(map);
        material
    })
}

fn scene() -> impl Strategy<Value = Scene> {
    let triangle = ([point(), point(), point()], material(), any::<bool>());
    let camera = (point(), 0.3..1.8f64, (4..24u32, 4..20u32));
    let ambient =
        prop_oneof![
            color(1.0).prop_map(AmbientLight::Color),
            (color(1.0), color(1.0)).prop_map(|(sky, ground)| AmbientLight::Sky(
                pointillist_render::SkyLight { sky, ground, up: Vec3::Y }
            )),
        ];
    (
        prop::collection::vec(triangle, 1..6),
        texture(),
        prop::collection::vec(light(), 0..3),
        camera,
        ambient,
        color(1.0),
    )
        .prop_map(|(triangles, texture, lights, (eye, fov, (width, height)), ambient, background)| {
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
            scene.ambient = ambient;
            scene.image.background = background;
            scene
        })
}

fn window() -> impl Strategy<Value = PixelRect> {
    (0..12u32, 0..10u32, 1..14u32, 1..12u32).prop_map(|(x0, y0, w, h)| PixelRect {
        x0,
        y0,
        x1: x0 + w,
        y1: y0 + h,
    })
}

/// One thread and three.
static POOLS: LazyLock<[rayon::ThreadPool; 2]> =
    LazyLock::new(|| [1, 3].map(|n| rayon::ThreadPoolBuilder::new().num_threads(n).build().expect("a pool")));

proptest! {
    #![proptest_config(testkit::config(96))]

    #[test]
    fn pixels_are_sound(s in scene()) {
        holds!(invariants::pixels_are_sound(&s));
    }

    #[test]
    fn a_window_has_the_pixels_of_the_whole_picture(s in scene(), w in window()) {
        holds!(invariants::windows_do_not_matter(&s, w));
    }

    #[test]
    fn a_colour_is_direct_light_and_ambient_light_and_background(s in scene()) {
        holds!(invariants::light_adds_up(&s));
    }

    #[test]
    fn white_surfaces_show_even_light_as_it_is(s in scene(), light in color(2.0)) {
        holds!(invariants::white_surfaces_show_even_light_as_it_is(&s, light));
    }

    #[test]
    fn pictures_do_not_depend_on_those_before(s in scene()) {
        holds!(invariants::pictures_do_not_depend_on_those_before(&s));
    }

    #[test]
    #[cfg_attr(target_family = "wasm", ignore = "one thread is all there is")]
    fn a_picture_does_not_depend_on_threads(s in scene()) {
        let [one, three] = [0, 1].map(|i| POOLS[i].install(|| render(&s, &DrawOptions::DEFAULT, &())));
        match (one, three) {
            (Ok(one), Ok(three)) => holds!(invariants::frames_are_identical(&one, &three)),
            (one, three) => prop_assert!(one.is_err() && three.is_err()),
        }
    }
}

#[test]
fn most_scenes_of_these_tests_can_be_drawn_and_show_something() {
    use proptest::strategy::ValueTree as _;
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    let shown = (0..50).filter(|_| {
        let scene = scene().new_tree(&mut runner).expect("a scene").current();
        invariants::picture(&scene).is_some_and(|f| f.color.iter().any(|c| c[3] > 0.0))
    });
    assert!(shown.count() > 25);
}
