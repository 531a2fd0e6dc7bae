//! Clouds, views and options of any kind: octrees and frames are sound, neither order nor culling shows, and parts of a cloud are the whole.
//!
//! Making clouds is most of an input's time: each has one of the other facts looked at besides soundness, and most have few points.
#![no_main]

use arbitrary::Arbitrary;
use glam::{DVec3, Vec3, dvec3};
use libfuzzer_sys::fuzz_target;
use pointillist_surfel::invariants::{self, OwnedPoints, look_at};
use pointillist_surfel::{Division, Focus, Light, NO_PART, Options, Procedure, Projection, View};

/// Points in steps of 1/64, often repeated, on a line or on a plane.
#[derive(Arbitrary, Debug)]
enum Shape {
    Loose(Vec<[i8; 3]>),
    Plane { centre: [i8; 3], right: [i8; 3], up: [i8; 3], columns: u8, rows: u8 },
    Noisy { centre: [i8; 3], right: [i8; 3], up: [i8; 3], along: [i8; 3], seed: u64 },
    Sphere { centre: [i8; 3], radius: u8, count: u8 },
    Raw(Vec<[f64; 3]>),
}

#[derive(Arbitrary, Debug)]
struct Attributes {
    normals: Option<Vec<[i8; 3]>>,
    two_sided: bool,
    radii: Option<Vec<u8>>,
    raw_radius: Option<f32>,
    colored: bool,
    opacities: Option<Vec<u8>>,
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
    /// The paper's d and f, or a lens.
    blur: Option<(u8, u8, bool)>,
    paper: bool,
    culling: bool,
    level: u8,
    ambient: u8,
    light: Option<[i8; 3]>,
    normals: bool,
    raw: Option<([f64; 2], [f32; 2])>,
}

fn steps([x, y, z]: [i8; 3]) -> DVec3 {
    dvec3(x.into(), y.into(), z.into()) / 64.0
}

fn shape(shape: &Shape) -> OwnedPoints {
    match shape {
        Shape::Loose(points) => OwnedPoints::loose(points.iter().take(64).map(|p| steps(*p)).collect()),
        Shape::Raw(points) => {
            OwnedPoints::loose(points.iter().take(8).map(|p| DVec3::from_array(*p)).collect())
        }
        Shape::Plane { centre, right, up, columns, rows } => {
            let [right, up] = [right, up].map(|d| steps(*d) / 16.0);
            OwnedPoints::plane(steps(*centre), right, up, (columns % 24).into(), (rows % 24).into())
        }
        Shape::Noisy { centre, right, up, along, seed } => {
            let [right, up] = [right, up].map(|d| steps(*d) / 16.0);
            OwnedPoints::plane(steps(*centre), right, up, 20, 20).jittered(steps(*along) / 8.0, *seed)
        }
        Shape::Sphere { centre, radius, count } => {
            let radius = f64::from(*radius) / 128.0 + 0.01;
            OwnedPoints::sphere(steps(*centre), radius, 2 * u32::from(*count))
        }
    }
}

fn repeated(normals: &[[i8; 3]], count: usize) -> Vec<Vec3> {
    normals.iter().map(|n| Vec3::from_array(n.map(f32::from))).cycle().take(count).collect()
}

/// Points of an input in eight: a few more than a leaf of an octree holds; and of the others.
const MOST: [usize; 8] = [320, 64, 64, 64, 64, 64, 64, 64];

/// Points of which parts are made: each of the eight octants of all of them is prepared among all the others.
const MOST_IN_PARTS: usize = 40;

/// At most so many, from all over.
fn few(points: &OwnedPoints, most: usize) -> OwnedPoints {
    let count = points.positions.len();
    let numbers: Vec<usize> = (0..count.min(most)).map(|i| i * count / count.min(most)).collect();
    points.chosen(&numbers)
}

fn points(shapes: &[Shape], attributes: &Attributes, most: usize) -> OwnedPoints {
    let mut shapes = shapes.iter().take(3).map(shape);
    let first = shapes.next().unwrap_or_default();
    let mut all = few(&shapes.fold(first, |all, next| all.and(&next)), most);
    let n = all.positions.len();
    if let Some(normals) = attributes.normals.as_ref().filter(|some| !some.is_empty()) {
        all.normals = Some(repeated(normals, n));
    }
    if attributes.two_sided {
        all.normals = None;
    }
    if let Some(radii) = attributes.radii.as_ref().filter(|some| !some.is_empty()) {
        let radius = |r: &u8| attributes.raw_radius.unwrap_or(f32::from(*r) / 256.0);
        all.radii = Some(radii.iter().map(radius).cycle().take(n).collect());
    }
    if attributes.colored {
        all.colors = Some((0..n).map(|i| [0.5, (i % 3) as f32, 0.1]).collect());
    }
    if let Some(opacities) = attributes.opacities.as_ref().filter(|some| !some.is_empty()) {
        all.opacities = Some(opacities.iter().map(|o| f32::from(*o) / 255.0).cycle().take(n).collect());
    }
    all
}

/// `k`: the size of the scene.
fn options(rules: &Rules, k: f64) -> Options {
    let mut o = Options::default();
    let share = |v: u8| f64::from(v) / 64.0;
    if let Some((amount, focus, is_lens)) = rules.blur {
        let focus = (share(focus) + 0.01) * k;
        o.focus = match is_lens {
            true => Focus::Lens { aperture: share(amount) * k, focus },
            false => Focus::Depth { depth: share(amount), focus },
        };
    }
    o.procedure = if rules.paper { Procedure::Paper } else { Procedure::Blended };
    (o.culling, o.surface_layers) = (rules.culling, rules.normals);
    o.level = f32::from(rules.level) / 32.0;
    o.ambient = f32::from(rules.ambient) / 255.0;
    o.light = rules.light.map_or(Light::Eye, |d| Light::Towards(steps(d)));
    if let Some(([depth, focus], [level, ambient])) = rules.raw {
        (o.focus, o.level, o.ambient) = (Focus::Depth { depth, focus }, level, ambient);
    }
    o
}

/// Of up to this many pixels a side.
fn view(picture: &Picture, k: f64, most: [u8; 2]) -> Option<View> {
    let span = 0.05 + f64::from(picture.fov) / 100.0;
    let projection = match picture.orthographic {
        true => Projection::Orthographic { height: span * k },
        false => Projection::Perspective { fov_y_rad: span },
    };
    let (w, h) = (u32::from(picture.size.0 % most[0]), u32::from(picture.size.1 % most[1]));
    look_at(steps(picture.eye) * k, steps(picture.target) * k, projection, w, h)
}

/// Parts without an order, and points that only lie around them.
fn part_numbers(points: &OwnedPoints, seed: u64) -> Vec<u8> {
    let number = |i: usize| match (seed >> (i % 61)) & 7 {
        7 => NO_PART,
        part => part as u8,
    };
    (0..points.positions.len()).map(number).collect()
}

/// A cube that may hold the points or not.
fn division(picture: &Picture, k: f64) -> Division {
    let side = f64::from(picture.size.0) / 32.0 * k;
    Division {
        low: steps(picture.target) * k - 0.5 * side,
        side,
        spacing: f64::from(picture.fov) / 4096.0 * k,
    }
}

// The last are normals for light.
fuzz_target!(|input: (Vec<Shape>, Attributes, Picture, Rules, u64, Option<Vec<[i8; 3]>>)| {
    let (shapes, attributes, picture, rules, seed, lit) = input;
    let k = f64::from(picture.power).exp2();
    // The paper's filter takes thousands of steps per pixel where discs are large, and a thousand discs of any radius may each cover all pixels in every
    // layer: 5 s of processor time for one input.
    let most = if rules.paper || attributes.raw_radius.is_some() { [40, 30] } else { [150, 80] };
    let Some(view) = view(&picture, k, most) else { return };
    let mut points = points(&shapes, &attributes, MOST[(seed % 8) as usize]).resized(k);
    let lit = lit.filter(|some| !some.is_empty() && points.normals.is_some());
    points.shading_normals = lit.map(|some| repeated(&some, points.positions.len()));
    let options = options(&rules, k);
    let sound = || {
        invariants::octrees_are_sound(&points)?;
        invariants::frames_are_sound(&points, &view, &options)
    };
    let other = || match seed / 8 % 6 {
        0 => invariants::opaque_points_need_no_opacities(&points, &view, &options),
        1 => invariants::shading_normals_only_shade(&points, &view, &options),
        2 => invariants::order_does_not_matter(&points, &view, &options, seed),
        3 => invariants::culling_changes_nothing(&points, &view, &options),
        4 => invariants::one_color_stays_one_color(&points, &view, &options, [0.25, 1.0, 0.7]),
        _ => {
            let few = few(&points, MOST_IN_PARTS);
            invariants::parts_are_the_whole(&few)?;
            invariants::parts_are_sound(&few, &part_numbers(&few, seed), &division(&picture, k))
        }
    };
    let facts = || sound().and_then(|()| other());
    if let (Err(broken), ()) = rayon::join(facts, || ()) {
        panic!("{broken}");
    }
});
