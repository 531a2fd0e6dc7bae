//! Surfaces with folds and edges: what is one surface has no gaps, and what is in front of another covers no more of it for
//! that.

use glam::{DVec2, DVec3, Vec3, dvec2, dvec3};
use pointillist_surfel::invariants::{OwnedPoints, cloud, drawn, look_at};
use pointillist_surfel::{Options, Projection};
use std::f64::consts::FRAC_PI_4;

/// Points on a side of the fold and along half of it, one unit apart, each up to this far off its place.
const SIDE: i32 = 30;
const OFF: f64 = 0.35;

/// Discs that leave no gap.
const RADIUS: f32 = 0.85;

/// Pixels on a side of the picture, and from point to point.
const SIZE: u32 = 64;
const SPACING_PX: f64 = 2.0;

/// Numbers from 0 to 1.
fn random(mut state: u64) -> impl FnMut() -> f64 {
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Two half planes that meet in the y axis, inclined to the x axis by half the angle each.
fn folded(angle: f64, seed: u64) -> OwnedPoints {
    let (sin, cos) = (0.5 * angle).sin_cos();
    let mut next = random(seed);
    let mut off = || OFF * (2.0 * next() - 1.0);
    let (mut positions, mut normals) = (vec![], vec![]);
    for (i, j) in (-SIDE..SIDE).flat_map(|i| (-SIDE..SIDE).map(move |j| (i, j))) {
        let at = dvec2(f64::from(i) + 0.5 + off(), f64::from(j) + off());
        let side = at.x.signum();
        positions.push(dvec3(cos * at.x, at.y, -sin * at.x.abs()));
        normals.push(dvec3(side * sin, 0.0, cos).as_vec3());
    }
    let radii = Some(vec![RADIUS; positions.len()]);
    OwnedPoints { positions, normals: Some(normals), radii, ..OwnedPoints::default() }
}

/// Pixels about the fold that are not opaque, of 20 surfaces, seen from between the middle, 0, and along one side, 1.
fn specks(angle_deg: f64, seen: f64) -> usize {
    let angle = angle_deg.to_radians();
    let (x, z) = (0.5 * seen * angle).sin_cos();
    let camera = Projection::Orthographic { height: f64::from(SIZE) / SPACING_PX };
    let view = look_at(100.0 * dvec3(x, 0.0, z), DVec3::ZERO, camera, SIZE, SIZE).unwrap();
    let middle = SIZE as usize / 2;
    let of_surface = |seed: u64| {
        let cloud = cloud(&folded(angle, 7919 * seed + 1)).unwrap();
        let frame = drawn(&cloud, &view, &Options::default()).unwrap();
        let rows = frame.color().chunks_exact(frame.width()).skip(8).take(SIZE as usize - 16);
        rows.flat_map(|row| &row[middle - 10..middle + 10]).filter(|color| color[3] < 0.97).count()
    };
    (0..20).map(of_surface).sum()
}

#[test]
fn folds_are_as_opaque_as_planes() {
    for angle_deg in [0.0, 20.0, 40.0, 60.0] {
        for seen in [0.0, 0.5] {
            assert_eq!(specks(angle_deg, seen), 0, "folded by {angle_deg}°, seen from {seen}");
        }
    }
}

/// Two sheets across the view: a red one that ends at x = 0, and a white one behind it, or nothing.
fn edge(behind: bool, seed: u64) -> OwnedPoints {
    let mut next = random(seed);
    let mut off = || OFF * (2.0 * next() - 1.0);
    let (mut positions, mut colors) = (vec![], vec![]);
    for (i, j) in (-SIDE..SIDE).flat_map(|i| (-SIDE..SIDE).map(move |j| (i, j))) {
        let at = dvec2(f64::from(i) + 0.5 + off(), f64::from(j) + off());
        if at.x < 0.0 {
            positions.push(at.extend(0.0));
            colors.push([1.0, 0.0, 0.0]);
        }
        let at = dvec2(f64::from(i) + 0.5 + off(), f64::from(j) + off());
        if behind {
            positions.push(at.extend(-20.0));
            colors.push([1.0, 1.0, 1.0]);
        }
    }
    let (normals, radii) = (Some(vec![Vec3::Z; positions.len()]), Some(vec![RADIUS; positions.len()]));
    OwnedPoints { positions, normals, radii, colors: Some(colors), ..OwnedPoints::default() }
}

#[test]
fn edges_before_a_surface_are_where_they_are_before_nothing() {
    let camera = Projection::Orthographic { height: f64::from(SIZE) / SPACING_PX };
    let view = look_at(100.0 * DVec3::Z, DVec3::ZERO, camera, SIZE, SIZE).unwrap();
    let mut options = Options::default();
    options.ambient = 1.0;
    // Red that is not white, per row, in pixels.
    let covered = |behind: bool, seed: u64| {
        let frame = drawn(&cloud(&edge(behind, seed)).unwrap(), &view, &options).unwrap();
        let red: f32 = frame.color().iter().map(|color| color[0] - color[1]).sum();
        red / SIZE as f32
    };
    for seed in (1..200).step_by(20) {
        let [alone, before] = [false, true].map(|behind| covered(behind, seed));
        assert!((alone - before).abs() < 0.1, "{alone} pixels alone, {before} before a surface");
    }
}

/// Share of the picture that bars cover, as wide and as far apart as this, turned by an eighth; points lie so many pixels
/// apart. All lengths in pixels.
fn covered_by_bars(bar: f64, gap: f64, spacing: f64) -> f64 {
    let mut next = random(77);
    let mut off = || OFF * (2.0 * next() - 1.0);
    let count = (1.5 * f64::from(SIZE) / spacing) as i32;
    let places =
        (-count..count).flat_map(|i| (-count..count).map(move |j| dvec2(f64::from(i), f64::from(j))));
    let places = places.map(|place| spacing * (place + dvec2(off(), off())));
    let of_bars = places.filter(|place| place.x.rem_euclid(bar + gap) < bar);
    let positions: Vec<_> = of_bars.map(|at| DVec2::from_angle(FRAC_PI_4).rotate(at).extend(0.0)).collect();
    let (normals, radii) = (vec![Vec3::Z; positions.len()], vec![RADIUS * spacing as f32; positions.len()]);
    let points =
        OwnedPoints { positions, normals: Some(normals), radii: Some(radii), ..OwnedPoints::default() };
    let camera = Projection::Orthographic { height: f64::from(SIZE) };
    let view = look_at(100.0 * DVec3::Z, DVec3::ZERO, camera, SIZE, SIZE).unwrap();
    let frame = drawn(&cloud(&points).unwrap(), &view, &Options::default()).unwrap();
    frame.color().iter().map(|color| f64::from(color[3])).sum::<f64>() / f64::from(SIZE * SIZE)
}

#[test]
fn gaps_between_bars_stay_open() {
    for (bar, gap, spacing, most) in [(2.0, 2.0, 0.8, 0.75), (6.0, 3.0, 1.3, 0.85)] {
        let covered = covered_by_bars(bar, gap, spacing);
        let exact = bar / (bar + gap);
        assert!((exact..most).contains(&covered), "{covered}, not {exact}, by bars {gap} px apart");
    }
}
