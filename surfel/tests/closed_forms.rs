//! Frames compared with closed forms: spheres, lenses, edges.

use glam::{DVec3, Vec3, dvec3};
use pointillist_surfel::invariants::{
    OwnedPoints, cloud, covered_px, drawn, frame, level_of_detail_converges, look_at, sphere_at,
    sphere_has_no_holes,
};
use pointillist_surfel::{Cloud, Focus, Frame, Options, Procedure, Projection, View, field_of_view_rad};
use std::f64::consts::PI;
use std::sync::LazyLock;

const SIZE: u32 = 96;

fn perspective(eye: DVec3, target: DVec3, fov_y_rad: f64) -> View {
    look_at(eye, target, Projection::Perspective { fov_y_rad }, SIZE, SIZE).unwrap()
}

/// One pixel per world unit, looking along −Z from z = 1000; the middle of the picture is the origin.
fn flat_view() -> View {
    let camera = Projection::Orthographic { height: f64::from(SIZE) };
    look_at(DVec3::Z * 1000.0, DVec3::ZERO, camera, SIZE, SIZE).unwrap()
}

fn with(change: impl Fn(&mut Options)) -> Options {
    let mut options = Options::default();
    options.surface_layers = true;
    change(&mut options);
    options
}

/// Centre of pixel `i` from the middle of the picture: to the right and up.
fn centre(frame: &Frame, i: usize) -> (f64, f64) {
    let (x, y) = ((i % frame.width()) as f64 + 0.5, (i / frame.width()) as f64 + 0.5);
    (x - 0.5 * frame.width() as f64, 0.5 * frame.height() as f64 - y)
}

/// A sphere of [`COUNT`] points about the origin.
fn sphere() -> OwnedPoints {
    OwnedPoints::sphere(DVec3::ZERO, 1.0, COUNT)
}

const COUNT: u32 = 12_000;

static SPHERE: LazyLock<Cloud> = LazyLock::new(|| cloud(&sphere()).unwrap());

fn alpha(frame: &Frame, i: usize) -> f64 {
    f64::from(frame.color()[i][3])
}

/// Pixels per world unit at depth 1 of a square picture.
fn focal_px(fov_y_rad: f64) -> f64 {
    0.5 * f64::from(SIZE) / (0.5 * fov_y_rad).tan()
}

/// Largest and mean errors of normals (in degrees) and of depths (in spacings) over a sphere, all but a rim of
/// 3 pixels, in perspective and in parallel.
fn errors_of_a_sphere(procedure: Procedure) -> Vec<[f64; 4]> {
    let (middle, radius) = (dvec3(0.3, -0.2, 0.1), 1.0);
    let cloud = cloud(&OwnedPoints::sphere(middle, radius, COUNT)).unwrap();
    let spacing = (4.0 * PI / f64::from(COUNT)).sqrt();
    let eye = dvec3(1.0, 1.5, 4.0);
    let camera = Projection::Orthographic { height: 2.6 };
    let views = [perspective(eye, middle, 0.6), look_at(eye, middle, camera, SIZE, SIZE).unwrap()];
    let of = |view: &View| {
        let frame = drawn(&cloud, view, &with(|o| o.procedure = procedure)).unwrap();
        let (mut errors, mut count) = ([0.0f64; 4], 0.0);
        for i in 0..frame.depth().len() {
            let Some((depth, place)) = sphere_at(view, i, middle, radius, 3.0) else { continue };
            let error = (f64::from(frame.depth()[i]) - depth).abs() / spacing;
            let normal = Vec3::from_array(frame.normal()[i]).as_dvec3();
            let angle =
                if normal == DVec3::ZERO { 180.0 } else { normal.angle_between(place - middle).to_degrees() };
            let [angles, mean_angle, depths, mean_depth] = errors;
            errors = [angles.max(angle), mean_angle + angle, depths.max(error), mean_depth + error];
            count += 1.0;
        }
        assert!(count > 3000.0, "{count} pixels");
        [errors[0], errors[1] / count, errors[2], errors[3] / count]
    };
    views.iter().map(of).collect()
}

#[test]
fn a_sphere_has_its_depths_and_normals() {
    for errors @ [angle, mean_angle, depth, mean_depth] in errors_of_a_sphere(Procedure::Blended) {
        println!("{errors:?}");
        // Measured: 1° and 0.1 spacings at most.
        assert!(angle < 3.0 && mean_angle < 0.2 && depth < 0.3 && mean_depth < 0.02, "{errors:?}");
    }
}

#[test]
fn a_sphere_has_its_depths_and_normals_by_the_paper_too() {
    for errors @ [angle, mean_angle, depth, mean_depth] in errors_of_a_sphere(Procedure::Paper) {
        println!("{errors:?}");
        // Discs are flat, and one point's normal is that of a spacing.
        assert!(angle < 12.0 && mean_angle < 1.5 && depth < 1.5 && mean_depth < 0.2, "{errors:?}");
    }
}

/// Radius of what is covered and what it has to be, and how far its middle is off, in pixels: of a sphere from 13 to
/// 100 pixels across, in parallel and in perspective.
fn outlines_of_a_sphere(procedure: Procedure) -> Vec<[f64; 3]> {
    let mut all = vec![];
    for (height, distance) in [(2.5, 5.0), (6.0, 3.0), (20.0, 9.0)] {
        let camera = Projection::Orthographic { height };
        let flat = look_at(DVec3::Z * distance, DVec3::ZERO, camera, SIZE, SIZE).unwrap();
        // The same size in perspective: a cone of half the angle asin(1 / distance).
        let tangent = 1.0 / (distance * distance - 1.0f64).sqrt();
        let near = perspective(DVec3::Z * distance, DVec3::ZERO, 2.0 * (0.5 * height * tangent).atan());
        for view in [flat, near] {
            let frame = drawn(&SPHERE, &view, &with(|o| o.procedure = procedure)).unwrap();
            let (mut x, mut y) = (0.0, 0.0);
            for i in 0..frame.depth().len() {
                let (cx, cy) = centre(&frame, i);
                (x, y) = (x + cx * alpha(&frame, i), y + cy * alpha(&frame, i));
            }
            let covered = covered_px(&frame);
            all.push([(covered / PI).sqrt(), f64::from(SIZE) / height, x.hypot(y) / covered]);
        }
    }
    all
}

#[test]
fn a_sphere_has_its_outline() {
    for [radius, wanted, off] in outlines_of_a_sphere(Procedure::Blended) {
        println!("radius {radius:.3} of {wanted:.3}, centre {off:.4} off");
        // Discs reach over the outline by a share of a spacing, of which there are up to 40 to a radius.
        assert!((radius - wanted).abs() < 0.15 && off < 0.05, "{radius} of {wanted}, {off}");
    }
}

#[test]
fn a_sphere_has_its_outline_by_the_paper_too() {
    for [radius, wanted, off] in outlines_of_a_sphere(Procedure::Paper) {
        println!("radius {radius:.3} of {wanted:.3}, centre {off:.4} off");
        // Its discs have their full radius.
        assert!((radius - wanted).abs() < 1.0 && off < 0.05, "{radius} of {wanted}, {off}");
    }
}

/// Errors of pictures of a sphere: from 3 pixels across to points that are 20 pixels apart, on all levels
/// between.
fn holes(cloud: &Cloud, procedure: Procedure) -> Vec<String> {
    let eye = dvec3(0.7, 0.5, 1.0).normalize();
    let near = [80.0, 40.0, 20.0, 14.0, 10.0, 8.0, 6.0, 4.0, 2.8, 2.0, 1.5, 1.1];
    let near = near.map(|distance| (distance, perspective(eye * distance, DVec3::ZERO, 0.9)));
    let flat = [60.0, 20.0, 9.0, 6.0, 4.0, 2.5, 1.5, 1.0, 0.2, 0.04].map(|height| {
        let camera = Projection::Orthographic { height };
        (height, look_at(eye * 5.0, DVec3::ZERO, camera, SIZE, SIZE).unwrap())
    });
    let mut found = vec![];
    for level in [0.0, 1.0, 1.27, 1.4] {
        let options = with(|o| (o.procedure, o.level) = (procedure, level));
        for (zoom, view) in near.iter().chain(&flat) {
            let holes = sphere_has_no_holes(cloud, view, &options, DVec3::ZERO, 1.0, 1.5);
            found.extend(holes.err().map(|e| format!("level {level}, distance or height {zoom}: {e}")));
        }
    }
    found
}

const NO_HOLES: Vec<String> = vec![];

#[test]
fn a_closed_surface_has_no_holes_at_any_zoom() {
    assert_eq!(holes(&SPHERE, Procedure::Blended), NO_HOLES);
}

#[test]
fn a_closed_surface_without_normals_has_no_holes_at_any_zoom() {
    let cloud = cloud(&OwnedPoints { normals: None, ..sphere() }).unwrap();
    assert_eq!(holes(&cloud, Procedure::Blended), NO_HOLES);
}

#[test]
fn a_closed_surface_has_no_holes_at_any_zoom_by_the_paper_too() {
    assert_eq!(holes(&SPHERE, Procedure::Paper), NO_HOLES);
}

/// Front and back do not mix at the outline, because the back is not drawn.
#[test]
fn a_closed_surface_without_normals_looks_as_with_those_of_its_outside() {
    let given = cloud(&OwnedPoints { normals: Some(outside(&sphere())), ..sphere() }).unwrap();
    let estimated = cloud(&OwnedPoints { normals: None, ..sphere() }).unwrap();
    let view = perspective(DVec3::Z * 4.0, DVec3::ZERO, 0.7);
    let [given, estimated] = [given, estimated].map(|cloud| drawn(&cloud, &view, &with(|_| {})).unwrap());
    let most =
        given.color().iter().zip(estimated.color()).map(|(a, b)| (a[3] - b[3]).abs()).fold(0.0, f32::max);
    assert!(most < 0.01, "opacity differs by {most}");
    assert!(estimated.counts().points <= given.counts().points);
}

fn outside(sphere: &OwnedPoints) -> Vec<Vec3> {
    sphere.positions.iter().map(|p| p.as_vec3().normalize()).collect()
}

/// An orthographic eye whose plane cuts it does, too.
#[test]
fn a_sphere_that_is_cut_open_shows_its_inside() {
    let cloud = cloud(&OwnedPoints { normals: None, ..sphere() }).unwrap();
    let camera = Projection::Orthographic { height: 1.0 };
    let view = View::look_at(DVec3::ZERO, -DVec3::Z, DVec3::Y, camera, 64, 64).unwrap();
    let drawn = drawn(&cloud, &view, &with(|_| {})).unwrap();
    assert!((0..64 * 64).all(|i| alpha(&drawn, i) > 0.999));
}

#[test]
fn an_open_surface_without_normals_is_seen_from_both_sides() {
    let cloud = cloud(&OwnedPoints {
        normals: None,
        ..OwnedPoints::plane(DVec3::ZERO, DVec3::X * 0.05, DVec3::Y * 0.05, 40, 40)
    })
    .unwrap();
    for eye in [DVec3::Z * 4.0, -DVec3::Z * 4.0] {
        let drawn = drawn(&cloud, &perspective(eye, DVec3::ZERO, 0.1), &with(|_| {})).unwrap();
        assert!((0..drawn.depth().len()).all(|i| alpha(&drawn, i) > 0.999), "from {eye}");
    }
}

/// The eye in it sees the inside, without a hole, where normals have no sign.
#[test]
fn a_sphere_around_the_eye_has_no_holes() {
    let cloud = cloud(&OwnedPoints { normals: None, ..sphere() }).unwrap();
    for (eye, fov) in [(DVec3::ZERO, 1.2), (dvec3(0.3, 0.2, 0.5), 2.0), (DVec3::X * 0.9, 0.3)] {
        let drawn = drawn(&cloud, &perspective(eye, dvec3(-1.0, 0.1, -0.2), fov), &with(|_| {})).unwrap();
        let bare = (0..drawn.depth().len()).filter(|i| alpha(&drawn, *i) < 0.999).count();
        assert_eq!(bare, 0, "from {eye}");
    }
}

/// The inside of a blurred sphere is opaque: farther from the outline than the blur reaches.
#[test]
fn a_blurred_sphere_has_no_holes() {
    let view = perspective(DVec3::Z * 4.0, DVec3::ZERO, 0.7);
    for blur_px in [1.0, 3.0, 8.0, 20.0] {
        // Focused far behind: from z = 1 to the rim, blur = f·a·(1/Z − 1/F).
        let (focus, nearest) = (40.0, 3.0);
        let aperture = blur_px / (focal_px(0.7) * (1.0 / nearest - 1.0 / focus));
        let options = with(|o| o.focus = Focus::Lens { aperture, focus });
        sphere_has_no_holes(&SPHERE, &view, &options, DVec3::ZERO, 1.0, blur_px + 2.0)
            .unwrap_or_else(|e| panic!("{blur_px} px: {e}"));
    }
}

fn striped(p: DVec3) -> [f32; 3] {
    let wave = |v: f64| (0.5 + 0.5 * (5.0 * v).sin()) as f32;
    [wave(p.x), wave(p.y), wave(p.z)]
}

#[test]
fn coarser_levels_come_near_to_all_points() {
    let cloud = cloud(&OwnedPoints::sphere(DVec3::ZERO, 1.0, 16_000).painted(striped)).unwrap();
    // About a point per pixel, and fewer pixels than points.
    for distance in [4.0, 9.0] {
        let view = perspective(DVec3::Z * distance, DVec3::ZERO, 0.7);
        let levels = [(0.25, 0.01), (0.5, 0.015), (1.0, 0.03), (1.27, 0.03), (1.4, 0.03)];
        level_of_detail_converges(&cloud, &view, &with(|_| {}), &levels).unwrap();
    }
}

/// Deviation of opacity along x and y about its centre, pixels.
fn deviation(frame: &Frame) -> f64 {
    let moment = |k: i32| {
        let of = |i: usize| {
            let (x, y) = centre(frame, i);
            alpha(frame, i) * (x.hypot(y)).powi(k)
        };
        (0..frame.depth().len()).map(of).sum::<f64>()
    };
    (0.5 * moment(2) / moment(0)).sqrt()
}

/// A disc of radius R has a deviation of R / 2 along x, and so has the circle of confusion f·a·|1/F − 1/Z|.
#[test]
fn a_thin_lens_blurs_a_point_over_its_circle_of_confusion() {
    let focal = focal_px(0.7);
    let dot = OwnedPoints {
        normals: Some(vec![Vec3::Z]),
        radii: Some(vec![0.02]),
        ..OwnedPoints::loose(vec![DVec3::ZERO])
    };
    for (distance, focus, aperture) in
        [(5.0, 2.0, 0.5), (5.0, 3.0, 0.8), (5.0, 12.0, 1.0), (8.0, 60.0, 1.2), (5.0, 4.0, 3.0)]
    {
        let view = perspective(DVec3::Z * distance, DVec3::ZERO, 0.7);
        let blurred = frame(&dot, &view, &with(|o| o.focus = Focus::Lens { aperture, focus })).unwrap();
        let radius = focal * aperture * (1.0f64 / focus - 1.0 / distance).abs();
        let disc = focal * 0.02 / distance;
        let wanted = 0.5 * radius.hypot(disc);
        let got = deviation(&blurred);
        println!("blur of {radius:.2} px: deviation {got:.3}, not {wanted:.3}");
        assert!((got / wanted - 1.0).abs() < 0.05, "blur of {radius} px: {got}, not {wanted}");
    }
}

/// A blurred surface covers as much as a sharp one.
#[test]
fn the_energy_of_a_blurred_point_is_conserved() {
    let dot = OwnedPoints {
        normals: Some(vec![Vec3::Z]),
        radii: Some(vec![0.3]),
        ..OwnedPoints::loose(vec![DVec3::ZERO])
    };
    let view = perspective(DVec3::Z * 5.0, DVec3::ZERO, 0.7);
    let covered = |focus| covered_px(&frame(&dot, &view, &with(|o| o.focus = focus)).unwrap());
    let sharp = covered(Focus::Everywhere);
    let disc = PI * (0.3 * focal_px(0.7) / 5.0).powi(2);
    println!("a disc of {disc:.1} px covers {sharp:.1}");
    for depth in [0.1, 0.2, 0.4, 0.8] {
        for focus in [3.0, 7.0] {
            let blurred = covered(Focus::Depth { depth, focus });
            println!("d = {depth}, focus {focus}: {:.3}", blurred / sharp);
            // A soft disc is cut where it covers half, which leaves 0.85 of its area. A blurred one's edge is made
            // steep by as much as the disc is of the blur, which takes from where little is covered: measured 0.83 to
            // 1.12.
            assert!(
                (blurred / sharp - 1.0).abs() < 0.2,
                "d = {depth}, focus {focus}: {blurred}, not {sharp}"
            );
        }
    }
}

/// A half plane x < 0 at this depth before a whole one at another, in colors.
fn edge_before_wall(near: f64, far: f64) -> OwnedPoints {
    let plane = |z: f64, from: f64, to: f64, color: [f32; 3]| {
        // A point per pixel or so.
        let step = 0.7 * z / focal_px(0.7);
        let width = z * (0.35f64).tan() * 1.4;
        let (columns, rows) = ((width * (to - from) / step) as u32, (2.0 * width / step) as u32);
        let middle = dvec3(0.5 * (from + to) * width, 0.0, -z);
        OwnedPoints::plane(middle, DVec3::X * step, DVec3::Y * step, columns, rows).painted(move |_| color)
    };
    plane(near, -1.0, 0.0, [1.0, 0.0, 0.0]).and(&plane(far, -1.0, 1.0, [0.0, 1.0, 0.0]))
}

/// Mean color of each column over the middle rows.
fn columns(frame: &Frame) -> Vec<[f64; 4]> {
    let rows = frame.height() / 4..3 * frame.height() / 4;
    let mean = |x: usize| {
        let sum =
            |c: usize| rows.clone().map(|y| f64::from(frame.color()[y * frame.width() + x][c])).sum::<f64>();
        [0, 1, 2, 3].map(|c| sum(c) / rows.len() as f64)
    };
    (0..frame.width()).map(mean).collect()
}

fn eye_at_origin() -> View {
    perspective(DVec3::ZERO, -DVec3::Z, 0.7)
}

fn lit_from_everywhere(focus: Focus) -> Options {
    with(|o| (o.focus, o.ambient) = (focus, 1.0))
}

/// The share of the lens, a disc, on one side of a line at this distance from the middle in radii.
fn share_of_disc(x: f64) -> f64 {
    let x = x.clamp(-1.0, 1.0);
    0.5 + (x * (1.0 - x * x).sqrt() + x.asin()) / PI
}

#[test]
fn a_blurred_foreground_is_transparent_at_its_rim_and_does_not_leak() {
    let (near, far) = (2.0, 6.0);
    let points = edge_before_wall(near, far);
    for blur_px in [4.0, 12.0] {
        let aperture = blur_px / (focal_px(0.7) * (1.0 / near - 1.0 / far));
        let options = lit_from_everywhere(Focus::Lens { aperture, focus: far });
        let drawn = frame(&points, &eye_at_origin(), &options).unwrap();
        let mut worst = 0.0f64;
        for (x, c) in columns(&drawn).iter().enumerate() {
            // The edge is half a step beside the middle.
            let right = x as f64 + 0.5 - 0.5 * f64::from(SIZE);
            let red = share_of_disc(-right / blur_px);
            assert!(c[3] > 0.995, "{blur_px} px, column {right}: a gap, {c:?}");
            assert!((c[0] + c[1] - 1.0).abs() < 0.01, "{blur_px} px, column {right}: {c:?}");
            if right.abs() > blur_px + 2.0 {
                assert!((c[0] - red).abs() < 0.02, "{blur_px} px, column {right}: leaks, {c:?}");
            }
            worst = worst.max((c[0] - red).abs());
        }
        println!("blur of {blur_px} px: rim off by {worst:.3}");
        // A blurred disc's weight is √(1 − q), not even, and its edge is made as steep as a pixel.
        assert!(worst < 0.2, "blur of {blur_px} px: {worst}");
    }
}

#[test]
fn a_sharp_foreground_keeps_its_edge_before_a_blurred_background() {
    let (near, far) = (2.0, 6.0);
    let points = edge_before_wall(near, far);
    for blur_px in [4.0, 12.0] {
        let aperture = blur_px / (focal_px(0.7) * (1.0 / near - 1.0 / far));
        let options = lit_from_everywhere(Focus::Lens { aperture, focus: near });
        let drawn = frame(&points, &eye_at_origin(), &options).unwrap();
        for (x, c) in columns(&drawn).iter().enumerate() {
            let right = x as f64 + 0.5 - 0.5 * f64::from(SIZE);
            assert!(c[3] > 0.995, "{blur_px} px, column {right}: a gap, {c:?}");
            if right.abs() > 2.5 {
                let red = if right < 0.0 { 1.0 } else { 0.0 };
                assert!((c[0] - red).abs() < 0.02, "{blur_px} px, column {right}: {c:?}");
            }
        }
    }
}

#[test]
fn what_is_in_focus_stays_as_it_is() {
    let points = OwnedPoints::plane(DVec3::ZERO, DVec3::X * 0.02, DVec3::Y * 0.02, 80, 80).painted(striped);
    let view = perspective(DVec3::Z * 3.0, DVec3::ZERO, 0.4);
    let sharp = frame(&points, &view, &with(|_| {})).unwrap();
    let lens = frame(&points, &view, &with(|o| o.focus = Focus::Lens { aperture: 0.5, focus: 3.0 })).unwrap();
    for (a, b) in sharp.color().iter().flatten().zip(lens.color().iter().flatten()) {
        assert!((a - b).abs() < 1e-3, "{a} and {b}");
    }
}

/// A plane of 120 × 120 units about the middle of [`flat_view`], of one color and opacity.
fn sheet(z: f64, color: [f32; 3], opacity: f32) -> OwnedPoints {
    let plane = OwnedPoints::plane(DVec3::Z * z, DVec3::X * 0.8, DVec3::Y * 0.8, 150, 150);
    plane.painted(|_| color).thinned(|_| opacity)
}

/// The pixels of [`flat_view`] at most `most` from its middle on either axis.
fn middle(frame: &Frame, most: f64) -> impl Iterator<Item = usize> {
    let inside = move |i: &usize| {
        let (x, y) = centre(frame, *i);
        x.abs().max(y.abs()) <= most
    };
    (0..frame.depth().len()).filter(inside)
}

#[test]
fn light_passes_sheets_by_the_product_of_what_they_let_through() {
    let opacities = [0.6, 0.25, 0.4, 0.75, 0.2f32];
    let sheets = opacities.iter().enumerate().map(|(i, &opacity)| {
        let color = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]][i % 3];
        sheet(-20.0 * i as f64, color, opacity)
    });
    let points = sheets.reduce(|all, next| all.and(&next)).expect("sheets");
    let (mut wanted, mut light) = ([0.0f32; 4], 1.0f32);
    for (i, opacity) in opacities.iter().enumerate() {
        wanted[i % 3] += light * opacity;
        light *= 1.0 - opacity;
    }
    wanted[3] = 1.0 - light;
    for level in [0.0, 1.27, 6.0] {
        let options = with(|o| (o.ambient, o.level) = (1.0, level));
        let drawn = frame(&points, &flat_view(), &options).unwrap();
        for i in middle(&drawn, 40.0) {
            let got = drawn.color()[i];
            let off = got.iter().zip(wanted).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            assert!(off < 2e-3, "level {level}, pixel {i}: {got:?}, not {wanted:?}");
            // More than half of the light is kept back by the first.
            assert!((drawn.depth()[i] - 1000.0).abs() < 0.05, "{}", drawn.depth()[i]);
        }
    }
}

/// Points of both once shared the area of one surface, so that the nearer sheet let half of the farther one through.
#[test]
fn a_sheet_a_little_more_than_a_spacing_behind_another_does_not_show_through() {
    // The spacing is 0.8.
    for behind in [0.75, 1.0, 1.3] {
        let points = sheet(0.0, [1.0, 0.0, 0.0], 1.0).and(&sheet(-behind, [0.0, 1.0, 0.0], 1.0));
        let options = with(|o| (o.ambient, o.level) = (1.0, 0.0));
        let drawn = frame(&points, &flat_view(), &options).unwrap();
        for i in middle(&drawn, 40.0) {
            let got = drawn.color()[i];
            assert!(got[0] > 0.995 && got[1] < 0.005, "{behind}, pixel {i}: {got:?}");
        }
    }
}

#[test]
fn points_that_are_not_seen_color_nothing_at_any_level() {
    let points = OwnedPoints::plane(DVec3::ZERO, DVec3::X * 0.4, DVec3::Y * 0.4, 300, 300);
    // Every other column is clear and would be bright.
    let clear = |p: DVec3| ((p.x / 0.4).floor() as i64).rem_euclid(2) == 0;
    let points = points.painted(|p| if clear(p) { [0.0, 9.0, 9.0] } else { [0.6, 0.0, 0.0] });
    let points = points.thinned(|p| if clear(p) { 0.0 } else { 0.5 });
    for (procedure, level) in [
        (Procedure::Blended, 0.0),
        (Procedure::Blended, 1.4),
        (Procedure::Blended, 5.0),
        (Procedure::Paper, 1.4),
    ] {
        let options = with(|o| (o.ambient, o.level, o.procedure) = (1.0, level, procedure));
        let drawn = frame(&points, &flat_view(), &options).unwrap();
        let all: Vec<usize> = middle(&drawn, 40.0).collect();
        let mean =
            |c: usize| all.iter().map(|&i| f64::from(drawn.color()[i][c])).sum::<f64>() / all.len() as f64;
        let got = [0, 1, 2, 3].map(mean);
        // One disc per pixel, by the paper: which one is nearest to the middle is its choice, pixel by pixel.
        let slack = if procedure == Procedure::Paper { 0.26 } else { 0.002 };
        assert!((got[3] - 0.25).abs() < slack, "{procedure:?}, level {level}: {got:?}");
        assert!(
            (got[0] - 0.6 * got[3]).abs() < 1e-3 && got[1] == 0.0,
            "{procedure:?}, level {level}: {got:?}"
        );
    }
}

#[test]
fn an_edge_behind_a_clear_sheet_is_the_edge_alone_dimmed() {
    let edge = sheet(-20.0, [0.0, 1.0, 0.0], 1.0).moved(|p| p - DVec3::X * 60.5);
    let front = sheet(0.0, [1.0, 0.0, 0.0], 0.6);
    // All points: the octree of both sheets has other levels than that of one.
    let options = with(|o| (o.ambient, o.level) = (1.0, 0.0));
    let [alone, both] = [&edge, &front.and(&edge)].map(|p| frame(p, &flat_view(), &options).unwrap());
    let mut partly = 0;
    for i in middle(&both, 40.0) {
        let behind = alone.color()[i][3];
        partly += usize::from((0.1..0.9).contains(&behind));
        let wanted = [0.6, 0.4 * behind, 0.0, 0.6 + 0.4 * behind];
        let got = both.color()[i];
        let off = got.iter().zip(wanted).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(off < 5e-3, "pixel {i}: {got:?}, not {wanted:?}");
    }
    assert!(partly > 40, "{partly} pixels show the edge");
}

#[test]
fn a_plane_has_its_depth_and_color() {
    let points = OwnedPoints::plane(DVec3::ZERO, DVec3::X * 0.8, DVec3::Y * 0.8, 120, 120);
    let points = points.moved(|p| dvec3(p.x, p.y, 0.5 * p.x - 0.3 * p.y));
    let normal = Vec3::new(-0.5, 0.3, 1.0).normalize();
    let points = OwnedPoints { normals: Some(vec![normal; points.positions.len()]), radii: None, ..points };
    for (procedure, most) in [(Procedure::Blended, 0.05), (Procedure::Paper, 1.0)] {
        let drawn = frame(&points, &flat_view(), &with(|o| o.procedure = procedure)).unwrap();
        for i in 0..drawn.depth().len() {
            let (x, y) = centre(&drawn, i);
            if x.abs().max(y.abs()) < 40.0 {
                let error = (f64::from(drawn.depth()[i]) - (1000.0 - 0.5 * x + 0.3 * y)).abs();
                assert!(error < most, "{procedure:?}, pixel {i}: depth {error} off");
                // Light from the eye: color × (0.1 + 0.9·cos).
                let wanted = 0.8 * (0.1 + 0.9 * normal.z);
                let got = drawn.color()[i][0];
                assert!((got - wanted).abs() < 2e-3, "{procedure:?}, pixel {i}: {got}, not {wanted}");
            }
        }
    }
}

#[test]
fn a_lens_has_its_field_of_view() {
    // A 50 mm lens on 24 mm: 2·atan(12/50) at infinity, and nearer a little less.
    let far = field_of_view_rad(0.05, 0.024, f64::INFINITY).unwrap();
    assert!((far - 2.0 * 0.24f64.atan()).abs() < 1e-15);
    // At twice the focal length, the sensor is as far behind.
    let one_to_one = field_of_view_rad(0.05, 0.024, 0.1).unwrap();
    assert!((one_to_one - 2.0 * 0.12f64.atan()).abs() < 1e-15);
    let near = field_of_view_rad(0.05, 0.024, 2.0).unwrap();
    assert!(one_to_one < near && near < far, "{near}");
}

#[test]
fn a_photographers_lens_is_half_its_opening_wide() {
    assert_eq!(Focus::photographic(0.05, 2.0, 3.0), Focus::Lens { aperture: 0.0125, focus: 3.0 });
}
