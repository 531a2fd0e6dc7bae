//! Frames compared with closed forms: planes, spheres, discs, layers.

use glam::{DVec2, DVec3, dvec3};
use pointillist_ibpr::invariants::{OwnedScan, frame};
use pointillist_ibpr::{Frame, Normals, Options, Projection, Scale, Translucency, View, Weighting};

const SIZE: u32 = 96;

fn options(scale: f32) -> Options {
    let mut options = Options::default();
    options.scale = Scale::Fixed(scale);
    options.surface_layers = true;
    options
}

/// One pixel per world unit, looking along −Z from z = 1000; the middle of the picture is the origin.
fn flat_view() -> View {
    let camera = Projection::Orthographic { height: f64::from(SIZE) };
    View::look_at(DVec3::Z * 1000.0, DVec3::ZERO, DVec3::Y, camera, SIZE, SIZE).unwrap()
}

fn perspective(fov_y_rad: f64, distance: f64) -> View {
    let camera = Projection::Perspective { fov_y_rad };
    View::look_at(DVec3::Z * distance, DVec3::ZERO, DVec3::Y, camera, SIZE, SIZE).unwrap()
}

/// Centre of pixel `i` on the plane z = 0 of [`flat_view`].
fn centre(i: usize) -> (f64, f64) {
    let (x, y) = ((i % SIZE as usize) as f64 + 0.5, (i / SIZE as usize) as f64 + 0.5);
    (x - 0.5 * f64::from(SIZE), 0.5 * f64::from(SIZE) - y)
}

/// Pixels at most `half` from the middle, to the side and up.
fn middle(half: f64) -> impl Iterator<Item = usize> {
    (0..(SIZE * SIZE) as usize).filter(move |i| {
        let (x, y) = centre(*i);
        x.abs().max(y.abs()) <= half
    })
}

fn angle_deg(frame: &Frame, i: usize, wanted: DVec3) -> f64 {
    let n = glam::Vec3::from_array(frame.normal()[i]).as_dvec3();
    n.dot(wanted.normalize()).clamp(-1.0, 1.0).acos().to_degrees()
}

/// z = (slope · (x, y)) over a square of 80 units, points `step` apart and moved by up to a third of it.
fn tilted(slope: (f64, f64), step: f64, seed: u64) -> OwnedScan {
    let n = (80.0 / step) as u32;
    let flat = OwnedScan::plane(DVec3::ZERO, DVec3::X * step, DVec3::Y * step, n, n);
    let loose = flat.jittered(DVec3::X * step / 3.0, seed).jittered(DVec3::Y * step / 3.0, seed + 1);
    loose.moved(|p| dvec3(p.x, p.y, slope.0 * p.x + slope.1 * p.y))
}

#[test]
fn a_plane_seen_from_afar_is_exact_to_rounding() {
    for (k, slope) in [(0.0, 0.0), (0.7, -0.4), (-1.5, 0.2)].into_iter().enumerate() {
        for scale in [1.0, 1.7, 3.0] {
            let frame =
                frame(&[tilted(slope, 0.4 * f64::from(scale), k as u64)], &flat_view(), &options(scale))
                    .unwrap();
            for i in middle(30.0) {
                let (x, y) = centre(i);
                let wanted = 1000.0 - slope.0 * x - slope.1 * y;
                // Corners are placed in steps of 1/256 pixel.
                let rounding = 1e-3 + (slope.0.abs() + slope.1.abs()) / 256.0;
                let error = (f64::from(frame.depth()[i]) - wanted).abs();
                assert!(error <= rounding, "slope {slope:?}, scale {scale}, pixel {i}: {error}");
                let angle = angle_deg(&frame, i, dvec3(-slope.0, -slope.1, 1.0));
                assert!(angle <= 0.1, "slope {slope:?}, scale {scale}, pixel {i}: {angle}°");
            }
        }
    }
}

/// A plane is a plane for a camera with perspective, too: bent depths are affine over the picture.
#[test]
fn a_plane_in_perspective_is_flat() {
    let scan = tilted((0.5, 0.3), 0.4, 7);
    let view = perspective(0.6, 150.0);
    let frame = frame(&[scan], &view, &options(1.5)).unwrap();
    let focal = 0.5 * f64::from(SIZE) / (0.3f64).tan();
    for i in middle(24.0) {
        let (x, y) = centre(i);
        // On the ray, x = z'·u and y = z'·v with z' = 150 − z and z = 0.5 x + 0.3 y.
        let (u, v) = (x / focal, y / focal);
        let wanted = 150.0 / (1.0 + 0.5 * u + 0.3 * v);
        let error = (f64::from(frame.depth()[i]) - wanted).abs();
        // A buffer pixel is 0.73 units wide.
        assert!(error <= 0.01, "pixel {i}: {error}");
        let angle = angle_deg(&frame, i, dvec3(-0.5, -0.3, 1.0));
        assert!(angle <= 0.4, "pixel {i}: {angle}°");
    }
}

/// Averages of a sphere of radius 40 over windows of S units lie inside it by at most S²/(2·40), and a
/// surface fitted to 3×3 of them turns by less than the third-order term over its width.
#[test]
fn a_sphere_has_its_depths_and_normals() {
    let directions = [DVec3::Z, dvec3(1.0, 0.3, 1.0), dvec3(-1.0, -0.2, 1.0), dvec3(0.1, 1.0, 0.9)];
    let scans = directions.map(|d| OwnedScan::sphere(DVec3::ZERO, 40.0, 0.7, d));
    for (normals, most_deg) in [(Normals::Plane, 1.5), (Normals::Triangles, 8.0)] {
        let mut o = options(1.5);
        o.normals = normals;
        let frame = frame(&scans, &flat_view(), &o).unwrap();
        for i in middle(48.0).filter(|i| centre(*i).0.hypot(centre(*i).1) < 32.0) {
            let (x, y) = centre(i);
            let z = (1600.0 - x * x - y * y).sqrt();
            let error = (f64::from(frame.depth()[i]) - (1000.0 - z)).abs();
            let slope = x.hypot(y) / z;
            assert!(error <= 1.5 * 1.5 / 80.0 * (1.0 + slope).powi(3) + 0.02, "pixel {i}: {error}");
            let angle = angle_deg(&frame, i, dvec3(x, y, z));
            assert!(angle <= most_deg, "{normals:?}, pixel {i}: {angle}°");
        }
    }
}

#[test]
fn one_point_per_pixel_at_scale_one_is_reproduced() {
    let depth = |x: f64, y: f64| 3.0 * (0.2 * x).sin() + 0.1 * y;
    let n = 60;
    let scan =
        OwnedScan::plane(DVec3::ZERO, DVec3::X, DVec3::Y, n, n).moved(|p| dvec3(p.x, p.y, depth(p.x, p.y)));
    let frame = frame(std::slice::from_ref(&scan), &flat_view(), &options(1.0)).unwrap();
    // The smooth outline passes through the last two rows.
    for p in scan.positions.iter().filter(|p| p.x.abs().max(p.y.abs()) < 28.0) {
        let DVec2 { x, y } = flat_view().project(*p).unwrap().pixel;
        let i = y as usize * SIZE as usize + x as usize;
        assert_eq!((x.fract(), y.fract()), (0.5, 0.5), "points lie on pixel centres");
        let error = (f64::from(frame.depth()[i]) - (1000.0 - p.z)).abs();
        // Depths near 1000 are stored in steps of 2⁻¹⁴.
        assert!(error <= 2f64.powi(-13), "{p}: {error}");
        assert!(frame.count()[i] == 1.0 && frame.color()[i][3] == 1.0, "{p}: {:?}", frame.color()[i]);
    }
}

#[test]
fn translucent_planes_cover_as_the_closed_form_says() {
    for alpha in [0.25f32, 0.5, 0.9] {
        for layers in 1..=5 {
            let plane =
                |k: i32| tilted((0.1, 0.0), 0.5, k as u64).moved(|p| p - DVec3::Z * 20.0 * f64::from(k));
            let scans: Vec<_> = (0..layers).map(plane).collect();
            let mut o = options(2.0);
            o.translucency = Some(Translucency::new(alpha));
            let frame = frame(&scans, &flat_view(), &o).unwrap();
            let wanted = 1.0 - (1.0 - alpha).powi(layers);
            for i in middle(30.0) {
                let got = frame.color()[i][3];
                assert!(
                    (got - wanted).abs() <= 1e-5,
                    "α {alpha}, {layers} planes, pixel {i}: {got}, not {wanted}"
                );
            }
        }
    }
}

#[test]
fn points_of_their_own_opacity_show_what_lies_behind() {
    let plane = |depth: f64, color: [f32; 3], opacity: Option<f32>| {
        let scan = tilted((0.1, 0.0), 0.5, 1).moved(|p| p - DVec3::Z * depth);
        let n = scan.positions.len();
        OwnedScan { colors: Some(vec![color; n]), opacities: opacity.map(|o| vec![o; n]), ..scan }
    };
    let (red, blue) = ([0.8, 0.0, 0.0], [0.0, 0.0, 0.4]);
    for (own, alpha) in [(0.25f32, 1.0f32), (0.6, 0.5), (0.0, 1.0), (1.0, 0.3)] {
        let mut o = options(2.0);
        o.ambient = 1.0;
        o.translucency = Some(Translucency::new(alpha));
        let frame = frame(&[plane(0.0, red, Some(own)), plane(20.0, blue, None)], &flat_view(), &o).unwrap();
        let front = own * alpha;
        let wanted = [0.8 * front, 0.0, 0.4 * (1.0 - front) * alpha, 1.0 - (1.0 - front) * (1.0 - alpha)];
        for i in middle(30.0) {
            let got = frame.color()[i];
            let apart = got.iter().zip(wanted).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            assert!(apart <= 1e-5, "opacity {own}, α {alpha}, pixel {i}: {got:?}, not {wanted:?}");
            // What is not seen at all is not what is shown.
            assert_eq!(frame.depth()[i] > 1010.0, own == 0.0, "opacity {own}, pixel {i}");
        }
    }
}

/// A mean of colors weights each by its opacity: what cannot be seen gives no color.
#[test]
fn unseen_points_do_not_tint_their_neighbours() {
    let scan = tilted((0.0, 0.0), 0.5, 1);
    let n = scan.positions.len();
    let every_second =
        |a: f32, b: f32| -> Vec<f32> { (0..n).map(|i| if i % 2 == 0 { a } else { b }).collect() };
    let colors = every_second(0.0, 0.5).into_iter().map(|green| [0.5 - green, green, 0.0]).collect();
    let mut o = options(2.0);
    o.ambient = 1.0;
    o.translucency = Some(Translucency::new(1.0));
    let scan = OwnedScan { colors: Some(colors), opacities: Some(every_second(0.0, 1.0)), ..scan };
    let frame = frame(&[scan], &flat_view(), &o).unwrap();
    for i in middle(30.0) {
        let [red, green, _, opacity] = frame.color()[i];
        assert!(red == 0.0 && (0.1..0.9).contains(&opacity), "pixel {i}: {:?}", frame.color()[i]);
        assert!((green - 0.5 * opacity).abs() <= 1e-6, "pixel {i}: {:?}", frame.color()[i]);
    }
}

#[test]
fn faces_of_a_dense_plane_have_no_gaps() {
    for seed in 0..8 {
        let slope = (0.3 * seed as f64 - 1.0, 0.2 * seed as f64 - 0.8);
        let scale = 1.0 + 0.37 * seed as f32;
        let scan = tilted(slope, 0.3 * f64::from(scale), seed);
        for view in [flat_view(), perspective(0.5, 250.0)] {
            let frame = frame(std::slice::from_ref(&scan), &view, &options(scale)).unwrap();
            for i in middle(20.0) {
                assert_eq!(frame.color()[i][3], 1.0, "slope {slope:?}, scale {scale}, pixel {i}");
            }
        }
    }
}

/// The covered area of a disc and of a square is that of the points, each with its own cell, less a strip of at most a fifth of a buffer pixel
/// along the outline (where bodies turn away from the eye points become denser, and outlines are made for those), at most three
/// buffer pixels at each corner, which is rounded, and half of the blur's variance times the curvature.
#[test]
fn outlines_enclose_the_area_of_what_was_scanned() {
    let step = 0.5;
    let square = OwnedScan::plane(DVec3::ZERO, DVec3::X * step, DVec3::Y * step, 121, 121);
    let turned = square.moved(|p| glam::DMat3::from_rotation_z(0.4) * p);
    let disc = OwnedScan::new(square.positions.iter().copied().filter(|p| p.length() <= 30.0).collect());
    let pi = std::f64::consts::PI;
    for scale in [1.0f32, 1.5, 2.0, 3.0] {
        let pixel = f64::from(scale);
        let (corners, curved) = (4.0 * 3.0 * pixel / 240.0, 0.5 * 1.8 * 1.8 * pixel / 30.0);
        for (name, scan, length, lost) in [
            ("square", &square, 240.0, corners),
            ("turned square", &turned, 240.0, corners),
            ("disc", &disc, 60.0 * pi, curved),
        ] {
            let area = scan.positions.len() as f64 * step * step;
            let frame = frame(std::slice::from_ref(scan), &flat_view(), &options(scale)).unwrap();
            let got: f64 = frame.color().iter().map(|c| f64::from(c[3])).sum();
            let strip = (got - area) / (length * pixel);
            println!("{name}, S = {scale}: {got:.1}, not {area:.1}: {strip:.3} buffer pixels");
            assert!(
                (-0.2 - lost..=0.05).contains(&strip),
                "{name}, S = {scale}: {got:.1}, not {area:.1}: {strip:.3} buffer pixels"
            );
        }
    }
}

/// The scans of one plane, one shifted by less than γ, are one surface: all depths between the two, and
/// normals that turn by no more than the steps between their means.
#[test]
fn a_plane_scanned_twice_is_one_plane() {
    let (mut worst, gamma) = (0.0f64, 2.0);
    for (k, offset) in [0.25, 0.5, 1.0, 1.5].into_iter().enumerate() {
        let first = tilted((0.0, 0.0), 1.0, k as u64);
        let second = tilted((0.0, 0.0), 1.0, 50 + k as u64).moved(|p| p + DVec3::Z * offset);
        let mut o = options(2.0);
        o.gamma = gamma;
        let scans = [first, second].map(|s| OwnedScan { spacing: Some(1.0), ..s });
        let frame = frame(&scans, &flat_view(), &o).unwrap();
        let mut angles = vec![];
        for i in middle(30.0) {
            let depth = f64::from(frame.depth()[i]);
            assert!((1000.0 - offset - 1e-3..=1000.0 + 1e-3).contains(&depth), "offset {offset}: {depth}");
            angles.push(angle_deg(&frame, i, DVec3::Z));
        }
        let mean = angles.iter().sum::<f64>() / angles.len() as f64;
        worst = worst.max(mean / offset);
        println!("offset {offset}: normals {mean:.2}° in the mean");
    }
    // Means of about eight points, two pixels apart: ±offset/2/√8 against two pixels, over 3×3 of them.
    assert!(worst <= 4.0, "normals turn by {worst}° per spacing of offset");
}

/// Noise below γ leaves one surface: depths spread less than the noise did, about the plane itself.
#[test]
fn noise_below_gamma_leaves_one_surface() {
    for weighting in [Weighting::Even, Weighting::Symmetric, Weighting::Falling, Weighting::Printed] {
        for noise in [0.2, 0.5, 0.9] {
            let scan = tilted((0.0, 0.0), 0.5, 3).jittered(DVec3::Z * noise, 4);
            let mut o = options(2.0);
            (o.gamma, o.weighting) = (2.0, weighting);
            let frame = frame(&[OwnedScan { spacing: Some(1.0), ..scan }], &flat_view(), &o).unwrap();
            let errors: Vec<f64> = middle(30.0).map(|i| f64::from(frame.depth()[i]) - 1000.0).collect();
            let mean = errors.iter().sum::<f64>() / errors.len() as f64;
            let spread = errors.iter().map(|e| (e - mean).powi(2)).sum::<f64>() / errors.len() as f64;
            assert!(errors.iter().all(|e| e.abs() <= noise), "{weighting:?}: a second surface");
            // Uniform noise has a deviation of noise/√3; sixteen points are averaged.
            assert!(spread.sqrt() <= 0.4 * noise / 3f64.sqrt(), "{weighting:?}: {spread}");
            let unbiased = matches!(weighting, Weighting::Even | Weighting::Symmetric);
            assert!(mean.abs() <= if unbiased { 0.02 } else { 0.5 } * noise, "{weighting:?}: bias {mean}");
        }
    }
}
