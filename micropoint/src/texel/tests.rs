//! Means of textures against sums over their texels.

use super::*;
use glam::dvec2;

fn checker(width: u32, height: u32, wrap: TexelWrap) -> TexelSums<1> {
    TexelSums::new(width, height, wrap, |x, y| [((x * 7 + y * 13) % 5) as f32]).unwrap()
}

fn corners(points: &[DVec2]) -> Vec<TexelCorner> {
    points.iter().map(|&p| TexelCorner { grid: p, rational: 1.0, texel: p }).collect()
}

/// The mean by many samples.
fn sampled(sums: &TexelSums<1>, points: &[DVec2]) -> f64 {
    let (low, high) = convex::bounds(points);
    let (mut sum, mut count) = (0.0, 0.0);
    let n = 600;
    for i in 0..n * n {
        let s = dvec2(f64::from(i % n) + 0.5, f64::from(i / n) + 0.5) / f64::from(n);
        let p = low + s * (high - low);
        let inside = (0..points.len()).all(|k| {
            let (a, b) = (points[k], points[(k + 1) % points.len()]);
            (b - a).perp_dot(p - a) >= 0.0
        });
        if inside {
            sum += sums.texel(p.x, p.y)[0];
            count += 1.0;
        }
    }
    sum / count
}

#[test]
fn a_polygon_sees_the_mean_of_its_texels_in_every_wrap_mode() {
    for wrap in [TexelWrap::Repeat, TexelWrap::Clamp, TexelWrap::Mirror] {
        let sums = checker(6, 5, wrap);
        for shift in [dvec2(0.0, 0.0), dvec2(-7.3, 3.1), dvec2(11.2, -6.7)] {
            let triangle = [dvec2(0.3, 0.2) + shift, dvec2(5.1, 1.4) + shift, dvec2(1.7, 6.6) + shift];
            let got = sums.mean(&corners(&triangle))[0];
            let expected = sampled(&sums, &triangle);
            assert!((got - expected).abs() < 0.01, "{wrap:?} {shift}: {got} {expected}");
        }
    }
}

#[test]
fn bytes_have_the_means_of_the_same_texels() {
    let (width, height) = (37, 24);
    let bytes: Vec<[u8; 3]> =
        (0..width * height).map(|i| [i * i % 251, i * 7 % 256, i % 13 * 19].map(|v| v as u8)).collect();
    let values: [f32; 256] = std::array::from_fn(|byte| (byte as f32 / 255.0).powf(2.2));
    for wrap in [TexelWrap::Repeat, TexelWrap::Clamp, TexelWrap::Mirror] {
        let texel = |x: u32, y: u32| bytes[(y * width + x) as usize].map(|byte| values[byte as usize]);
        let whole = TexelSums::<3>::new(width, height, wrap, texel).unwrap();
        let shared = Arc::new(bytes.clone());
        let compact = TexelSums::from_bytes(width, height, wrap, shared, &values).unwrap();
        for size in [1.3, 7.1, 33.3, 210.7] {
            let ring = [dvec2(-3.3, 2.1), dvec2(1.0, 0.3) * size, dvec2(0.4, 1.0) * size];
            let (expected, got) = (whole.mean(&corners(&ring)), compact.mean(&corners(&ring)));
            // Where texels are taken together, they are in 16 bits.
            let bound = if size < 128.0 { 0.0 } else { 1.0 / 65535.0 };
            assert!(
                (0..3).all(|c| (expected[c] - got[c]).abs() <= bound),
                "{wrap:?} {size}: {expected:?} {got:?}"
            );
        }
        assert_eq!(whole.whole_mean(), compact.whole_mean());
    }
}

#[test]
fn slopes_of_bytes_are_those_of_the_heights() {
    let (width, height) = (20, 24);
    let bytes: Vec<[u8; 1]> = (0..width * height).map(|i| [(i * i % 251) as u8]).collect();
    for wrap in [TexelWrap::Repeat, TexelWrap::Clamp, TexelWrap::Mirror] {
        let sums = TexelSums::slopes_of_bytes(width, height, wrap, Arc::new(bytes.clone())).unwrap();
        let place = |i: i64, size: u32| match wrap {
            TexelWrap::Repeat => i.rem_euclid(i64::from(size)),
            _ => i.clamp(0, i64::from(size) - 1),
        };
        let at = |x: i64, y: i64| {
            let (x, y) = (place(x, width), place(y, height));
            f32::from(bytes[(y * i64::from(width) + x) as usize][0]) / 255.0
        };
        let slope = |x: u32, y: u32| {
            let (x, y) = (i64::from(x), i64::from(y));
            let [u, v] = [at(x + 1, y) - at(x - 1, y), at(x, y - 1) - at(x, y + 1)];
            [0.5 * width as f32 * u, 0.5 * height as f32 * v]
        };
        let plain = TexelSums::<2>::new_signed(width, height, wrap, slope).unwrap();
        for size in [1.3, 7.1, 33.3, 210.7] {
            let ring = [dvec2(-3.3, 2.1), dvec2(1.0, 0.3) * size, dvec2(0.4, 1.0) * size];
            let [got, expected] = [&sums, &plain].map(|sums| sums.mean(&corners(&ring)));
            for (a, b) in got.iter().zip(expected) {
                assert!((a - b).abs() < 2e-6 * f64::from(width), "{wrap:?} {size}: {got:?} {expected:?}");
            }
        }
    }
}

#[test]
fn a_line_sees_each_texel_by_the_area_that_sees_it() {
    // A triangle whose three corners lie on one row of texels: the share of texel k of 4 is the area between two verticals.
    let sums =
        TexelSums::<1>::new(4, 2, TexelWrap::Clamp, |x, _| [[0.0, 1.0, 5.0, 2.0][x as usize]]).unwrap();
    let corner = |grid: DVec2| TexelCorner { grid, rational: 1.0, texel: dvec2(grid.x, 0.5) };
    let triangle = [dvec2(0.0, 0.0), dvec2(4.0, 0.0), dvec2(0.0, 4.0)].map(corner);
    let expected = (5.0 * 1.0 + 3.0 * 5.0 + 1.0 * 2.0) / 16.0;
    assert!((sums.mean(&triangle)[0] - expected).abs() < 1e-7, "{}", sums.mean(&triangle)[0]);
    // Without area in the grid, by length.
    let edge_on =
        [0.5, 3.5, 2.0].map(|x| TexelCorner { grid: DVec2::X, rational: 1.0, texel: dvec2(x, 0.5) });
    let expected = (0.5 * 0.0 + 1.0 + 5.0 + 0.5 * 2.0) / 3.0;
    assert!((sums.mean(&edge_on)[0] - expected).abs() < 1e-7, "{}", sums.mean(&edge_on)[0]);
}

#[test]
fn a_line_in_perspective_is_cut_where_texels_meet() {
    let sums = TexelSums::<1>::new(2, 1, TexelWrap::Clamp, |x, _| [x as f32]).unwrap();
    // The texture runs into the depth only, from 1 to 4.
    let corner = |x: f64, depth: f64, u: f64| TexelCorner {
        grid: dvec2(x, 1.0) / depth,
        rational: 1.0 / depth,
        texel: dvec2(u, 0.5),
    };
    let quad = [(0.0, 1.0, 0.0), (1.0, 1.0, 0.0), (1.0, 4.0, 2.0), (0.0, 4.0, 2.0)];
    let far = [(0.0, 2.5, 1.0), (1.0, 2.5, 1.0), (1.0, 4.0, 2.0), (0.0, 4.0, 2.0)];
    let [quad, far] = [quad, far].map(|ring| ring.map(|(x, depth, u)| corner(x, depth, u)));
    let area = |ring: &[TexelCorner; 4]| convex::area(&ring.map(|c| c.grid));
    assert!((sums.mean(&quad)[0] - area(&far) / area(&quad)).abs() < 1e-9);
}

#[test]
fn a_place_on_a_border_belongs_to_the_texel_on_its_right_and_below() {
    let sums = checker(6, 5, TexelWrap::Repeat);
    let at = |x: f64, y: f64| sums.mean(&corners(&[dvec2(x, y); 3]))[0];
    assert_eq!(at(2.0, 3.0), sums.texel(2.0, 3.0)[0]);
    assert_eq!(at(2.5, 0.0), sums.texel(2.0, 0.0)[0]);
    assert_eq!(at(6.0, 5.0), sums.texel(0.0, 0.0)[0]);
}

/// A square cell of the grid that sees a plane: `extent` in texels across, `squeeze` times less along, depths in this ratio.
fn seen(random: &mut impl FnMut() -> f64, extent: f64, squeeze: f64, ratio: f64) -> [TexelCorner; 4] {
    let turn = DVec2::from_angle(6.3 * random());
    let tilt = DVec2::from_angle(6.3 * random());
    let place = 100.0 * dvec2(random(), random());
    [dvec2(0.0, 0.0), dvec2(1.0, 0.0), dvec2(1.0, 1.0), dvec2(0.0, 1.0)].map(|grid| {
        let d = grid - 0.5;
        // From 1 to `ratio` over the circle around the cell.
        let rational = 1.0 + (ratio - 1.0) * (0.5 + d.dot(tilt) * std::f64::consts::FRAC_1_SQRT_2);
        let texel = place + extent * turn.rotate(dvec2(d.x, d.y / squeeze)) / rational;
        TexelCorner { grid, rational, texel }
    })
}

#[test]
fn means_keep_the_stated_bound() {
    let mut state = 1_u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let noise: Vec<f32> = (0..128 * 128).map(|_| f32::from(u8::from(random() < 0.5))).collect();
    let textures: [&dyn Fn(u32, u32) -> f32; 3] =
        [&|x, y| noise[(y * 128 + x) as usize], &|x, y| ((x + y) % 2) as f32, &|x, y| {
            f32::from(u8::from((x / 16 + y / 16) % 2 == 0))
        }];
    for texture in textures {
        let sums = TexelSums::<1>::new(128, 128, TexelWrap::Repeat, |x, y| [texture(x, y)]).unwrap();
        let mut errors = [(0.0_f64, 0.0); 2];
        let count = 1000;
        for _ in 0..count {
            let extent = 400.0_f64.powf(random());
            let squeeze = 60.0_f64.powf(random() * random());
            let ratio = 1.0 + 0.5 * random().powi(4);
            let cell = seen(&mut random, extent, squeeze, ratio);
            let exact = perspective::mean_by_texels(&cell, |x, y| sums.texel(x, y)).unwrap();
            let means = [sums.mean(&cell), sums.rough_mean(&cell)];
            for ((worst, squares), mean) in errors.iter_mut().zip(means) {
                let error = (mean[0] - exact[0]).abs();
                *worst = worst.max(error);
                *squares += error * error;
            }
        }
        let [fine, rough] = errors.map(|(worst, squares)| (worst, (squares / f64::from(count)).sqrt()));
        // Measured: 1.1e-2 and 8.5e-4 for noise, which is the worst of the three; rough 8e-2 and 8.0e-3.
        assert!(fine.0 < 0.015 && fine.1 < 0.001, "{fine:?}");
        assert!(rough.0 < 0.1 && rough.1 < 0.009, "{rough:?}");
    }
}

#[test]
fn whole_texels_are_exact() {
    let sums = checker(8, 8, TexelWrap::Repeat);
    let square = [dvec2(2.0, 3.0), dvec2(4.0, 3.0), dvec2(4.0, 5.0), dvec2(2.0, 5.0)];
    let texels = [(2, 3), (3, 3), (2, 4), (3, 4)];
    let expected = texels.iter().map(|&(x, y)| f64::from((x * 7 + y * 13) % 5)).sum::<f64>() / 4.0;
    assert!((sums.mean(&corners(&square))[0] - expected).abs() < 1e-7);
}

#[test]
fn coarse_levels_agree_with_fine_ones() {
    let sums =
        TexelSums::<1>::new(64, 300, TexelWrap::Repeat, |x, y| [((x * 31 + y * y) % 17) as f32]).unwrap();
    let ring = [dvec2(3.2, -500.3), dvec2(9.9, -500.3), dvec2(17.7, 900.4), dvec2(11.0, 900.4)];
    let fine: [f64; 1] = sums.integral(0, &ring);
    let fine = fine[0] / convex::area(&ring);
    let got = sums.mean(&corners(&ring))[0];
    assert!((got - fine).abs() < 2e-3 * fine, "{got} {fine}");
}

#[test]
fn perspective_weighs_texels_by_their_area_on_screen() {
    // Two texels, one of which is seen at four times the distance.
    let sums = TexelSums::<1>::new(2, 1, TexelWrap::Clamp, |x, _| [x as f32]).unwrap();
    let corner = |x: f64, y: f64, depth: f64| TexelCorner {
        grid: dvec2(x, y) / depth,
        rational: 1.0 / depth,
        texel: dvec2(x, y),
    };
    let quad = [corner(0.0, 0.0, 1.0), corner(2.0, 0.0, 4.0), corner(2.0, 1.0, 4.0), corner(0.0, 1.0, 1.0)];
    let far = {
        let ring =
            [corner(1.0, 0.0, 2.5), corner(2.0, 0.0, 4.0), corner(2.0, 1.0, 4.0), corner(1.0, 1.0, 2.5)];
        convex::area(&ring.map(|c| c.grid)) / convex::area(&quad.map(|c| c.grid))
    };
    assert!((sums.mean(&quad)[0] - far).abs() < 1e-9);
}

#[test]
fn levels_have_the_means_of_the_same_texels() {
    // With halves and without.
    for (width, height) in [(37, 24), (40, 24)] {
        let bytes: Vec<[u8; 1]> = (0..width * height).map(|i| [(i * i % 256) as u8]).collect();
        for wrap in [TexelWrap::Repeat, TexelWrap::Clamp, TexelWrap::Mirror] {
            let texel = |x: u32, y: u32| [f32::from(bytes[(y * width + x) as usize][0]) / 255.0];
            let whole = TexelSums::new(width, height, wrap, texel).unwrap();
            let levels = TexelSums::of_levels(width, height, wrap, Arc::new(bytes.clone())).unwrap();
            for size in [0.2, 1.3, 7.1, 33.3, 210.7] {
                let ring = [dvec2(-3.3, 2.1), dvec2(1.0, 0.3) * size, dvec2(0.4, 1.0) * size];
                let [expected, got] = [&whole, &levels].map(|sums| sums.mean(&corners(&ring))[0]);
                let bound = if size < 32.0 { 1e-7 } else { 1.0 / 65535.0 };
                assert!((expected - got).abs() < bound, "{width} {wrap:?} {size}: {expected} {got}");
            }
            assert!((whole.whole_mean()[0] - levels.whole_mean()[0]).abs() < 1e-7);
        }
        let wrong = TexelSums::of_levels(width, height + 1, TexelWrap::Repeat, Arc::new(bytes));
        assert!(matches!(wrong, Err(MicropointError::BadTexture { .. })));
    }
}

#[test]
fn sixteen_bits_are_right_to_a_part_of_the_bound_which_is_checked() {
    let texel = |x: u32, y: u32| [((x * 31 + y * y) % 17) as f32 / 20.0, 0.7];
    // Even sides, so that four texels and bands of rows are taken together, too.
    let sums = TexelSums::new(80, 48, TexelWrap::Repeat, texel).unwrap();
    let short = TexelSums::in_16_bits(1.0, 80, 48, TexelWrap::Repeat, texel).unwrap();
    for (x, y) in (0..80).flat_map(|x| (0..48).map(move |y| (f64::from(x), f64::from(y)))) {
        let (a, b) = (sums.texel(x, y), short.texel(x, y));
        assert!((0..2).all(|c| (a[c] - b[c]).abs() <= 1.0 / 65535.0), "{x} {y}: {a:?} {b:?}");
    }
    for size in [1.3, 7.1, 33.3, 70.0, 210.7] {
        let ring = corners(&[dvec2(-3.3, 2.1), dvec2(1.0, 0.2) * size, dvec2(0.1, 0.6) * size]);
        let (a, b) = (sums.mean(&ring), short.mean(&ring));
        assert!((0..2).all(|c| (a[c] - b[c]).abs() <= 1.0 / 65535.0), "{size}: {a:?} {b:?}");
    }
    for value in [0.71, -0.1, f32::NAN, f32::INFINITY] {
        let texel = |x: u32, y: u32| [if (x, y) == (3, 1) { value } else { 0.7 }];
        let found = TexelSums::in_16_bits(0.7, 5, 4, TexelWrap::Repeat, texel);
        assert!(matches!(found, Err(MicropointError::BadTexel { index: 8 })), "{value}");
        if value != 0.71 {
            let found = TexelSums::new(5, 4, TexelWrap::Repeat, texel);
            assert!(matches!(found, Err(MicropointError::BadTexel { index: 8 })), "{value}");
        }
    }
}

#[test]
fn a_texture_too_wide_for_sums_of_16_bits_has_as_many_as_there_is_room_for() {
    let width = 1 << 18;
    let texel = |x: u32, _: u32| [(x % 7) as f32 / 6.0];
    let short = TexelSums::in_16_bits(1.0, width, 1, TexelWrap::Clamp, texel).unwrap();
    let (bound, half) = (f64::from(width) / 2.0_f64.powi(32), 0.5 * f64::from(width));
    assert!((short.whole_mean()[0] - 0.5).abs() < bound);
    for x in 0..7 {
        let place = half + f64::from(x);
        let expected = f64::from(texel(place as u32, 0)[0]);
        assert!((short.texel(place, 0.0)[0] - expected).abs() <= bound);
    }
}
