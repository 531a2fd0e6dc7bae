//! Scans, views and options of any kind: frames are sound, and order does not matter.
#![no_main]

use arbitrary::Arbitrary;
use glam::{DVec3, dvec3};
use libfuzzer_sys::fuzz_target;
use pointillist_ibpr::invariants::{self, OwnedScan};
use pointillist_ibpr::{
    Culling, EyeDome, Light, Normals, Options, Passes, PixelRect, Projection, Scale, Translucency, View,
    Weighting,
};

/// Points in steps of 1/64, often repeated, on a line or on a plane.
#[derive(Arbitrary, Debug)]
enum Shape {
    Loose(Vec<[i8; 3]>),
    Plane { centre: [i8; 3], right: [i8; 3], up: [i8; 3], columns: u8, rows: u8 },
    Noisy { centre: [i8; 3], right: [i8; 3], up: [i8; 3], along: [i8; 3], seed: u64 },
    Sphere { centre: [i8; 3], radius: u8, towards: [i8; 3] },
    Raw(Vec<[f64; 3]>),
}

#[derive(Arbitrary, Debug)]
struct Part {
    shape: Shape,
    colored: bool,
    opacities: Option<u8>,
    towards: Option<[i8; 3]>,
    spacing: Option<u8>,
}

#[derive(Arbitrary, Debug)]
struct Picture {
    eye: [i8; 3],
    target: [i8; 3],
    fov: u8,
    orthographic: bool,
    size: (u8, u8),
    /// Power of two by which everything is resized.
    power: i8,
}

#[derive(Arbitrary, Debug)]
struct Rules {
    scale: u8,
    fixed: bool,
    gamma: u8,
    weighting: u8,
    culling: u8,
    triangles: bool,
    outline: u8,
    fill: u8,
    finer: Option<u8>,
    layers: Option<(u8, u8, u8)>,
    light: Option<[i8; 3]>,
    dome: bool,
    surface_layers: bool,
    raw: Option<[f32; 3]>,
}

fn steps([x, y, z]: [i8; 3]) -> DVec3 {
    dvec3(x.into(), y.into(), z.into()) / 64.0
}

fn scan(part: &Part) -> OwnedScan {
    let mut scan = match &part.shape {
        Shape::Loose(points) => OwnedScan::new(points.iter().take(64).map(|p| steps(*p)).collect()),
        Shape::Raw(points) => OwnedScan::new(points.iter().take(8).map(|p| DVec3::from_array(*p)).collect()),
        Shape::Plane { centre, right, up, columns, rows } => {
            let [right, up] = [right, up].map(|d| steps(*d) / 16.0);
            OwnedScan::plane(steps(*centre), right, up, (columns % 40).into(), (rows % 40).into())
        }
        Shape::Noisy { centre, right, up, along, seed } => {
            let [right, up] = [right, up].map(|d| steps(*d) / 16.0);
            OwnedScan::plane(steps(*centre), right, up, 24, 24).jittered(steps(*along) / 8.0, *seed)
        }
        Shape::Sphere { centre, radius, towards } => {
            let radius = f64::from(*radius) / 128.0 + 0.01;
            let towards = steps(*towards).try_normalize().unwrap_or(DVec3::Z);
            OwnedScan::sphere(steps(*centre), radius, radius / 15.0, towards)
        }
    };
    if part.colored {
        scan.colors = Some((0..scan.positions.len()).map(|i| [0.5, (i % 3) as f32, 0.1]).collect());
    }
    if let Some(step) = part.opacities {
        let opacity = |i: usize| (i * usize::from(step) % 256) as f32 / 255.0;
        scan.opacities = Some((0..scan.positions.len()).map(opacity).collect());
    }
    scan.towards_scanner = part.towards.map(steps).or(scan.towards_scanner);
    scan.spacing = part.spacing.map(|s| f64::from(s) / 256.0).or(scan.spacing);
    scan
}

fn options(rules: &Rules) -> Options {
    let mut o = Options::default();
    let scale = 0.3 + f32::from(rules.scale) / 32.0;
    o.scale = if rules.fixed { Scale::Fixed(scale.max(1.0)) } else { Scale::Auto(scale) };
    o.gamma = 0.1 + f32::from(rules.gamma) / 64.0;
    o.weighting = [Weighting::Printed, Weighting::Falling, Weighting::Even, Weighting::Symmetric]
        [usize::from(rules.weighting % 4)];
    o.culling =
        [Culling::None, Culling::Printed, Culling::Scans, Culling::Blocks][usize::from(rules.culling % 4)];
    o.normals = if rules.triangles { Normals::Triangles } else { Normals::Plane };
    o.outline = f32::from(rules.outline) / 255.0;
    o.fill = u32::from(rules.fill % 7);
    o.passes = rules.finer.map_or(Passes::One, |f| Passes::Two { finer: (1.0 + f32::from(f)) / 256.0 });
    o.translucency = rules.layers.map(|(alpha, layers, threshold)| {
        Translucency::new(f32::from(alpha) / 255.0)
            .with_layers(usize::from(layers % 8) + 1)
            .with_threshold(0.1 + f32::from(threshold) / 16.0)
    });
    o.light = rules.light.map_or(Light::Eye, |d| Light::Towards(steps(d)));
    o.eye_dome = rules.dome.then_some(EyeDome::new(1.0, 3));
    o.surface_layers = rules.surface_layers;
    if let Some([gamma, outline, scale]) = rules.raw {
        (o.gamma, o.outline, o.scale) = (gamma, outline, Scale::Auto(scale));
    }
    o
}

fn view(picture: &Picture) -> Option<View> {
    let span = 0.05 + f64::from(picture.fov) / 100.0;
    let k = f64::from(picture.power).exp2();
    let projection = match picture.orthographic {
        true => Projection::Orthographic { height: span * k },
        false => Projection::Perspective { fov_y_rad: span },
    };
    let (w, h) = (u32::from(picture.size.0 % 80), u32::from(picture.size.1 % 80));
    View::look_at(steps(picture.eye) * k, steps(picture.target) * k, DVec3::Y, projection, w, h).ok()
}

fuzz_target!(|input: (Vec<Part>, Picture, Rules, u64)| {
    let (parts, picture, rules, seed) = input;
    let Some(view) = view(&picture) else { return };
    let k = f64::from(picture.power).exp2();
    let resized = |part: &Part| {
        let scan = scan(part);
        OwnedScan { spacing: scan.spacing.map(|s| s * k), ..scan.moved(|p| p * k) }
    };
    let scans: Vec<OwnedScan> = parts.iter().take(4).map(resized).collect();
    let options = options(&rules);
    let facts = invariants::frames_are_sound(&scans, &view, &options)
        .and_then(|()| invariants::order_does_not_matter(&scans, &view, &options, seed))
        .and_then(|()| invariants::history_does_not_matter(&scans, &view, &options, seed))
        .and_then(|()| {
            let [x0, y0, w, h] = seed.to_le_bytes()[..4] else { return Ok(()) };
            let (x0, y0) = (u32::from(x0 % 80), u32::from(y0 % 80));
            let window = PixelRect { x0, y0, x1: x0 + u32::from(w % 40), y1: y0 + u32::from(h % 40) };
            invariants::a_window_is_a_part_of_the_picture(&scans, &view, &options, window)
        });
    if let Err(broken) = facts {
        panic!("{broken}");
    }
});
