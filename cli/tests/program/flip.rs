//! FLIP against its authors' own implementation.

use pointillist_cli::compare::{PIXELS_PER_DEGREE, compare, flip_map};
use pointillist_cli::image_io::{Picture, PixelRect};

const WIDTH: usize = 120;
const HEIGHT: usize = 90;

/// A picture with edges, waves and flat parts.
fn base() -> Vec<[f32; 3]> {
    let pixel = |x: f64, y: f64| {
        let step = if x > 60.0 { 0.8 } else { 0.0 };
        [0.5 + 0.5 * (x / 7.0).sin(), 0.5 + 0.5 * (y / 5.0 + x / 11.0).cos(), step].map(|c: f64| c as f32)
    };
    (0..WIDTH * HEIGHT).map(|i| pixel((i % WIDTH) as f64, (i / WIDTH) as f64)).collect()
}

fn mean_flip(test: &[[f32; 3]]) -> f64 {
    let map = flip_map(&base(), test, WIDTH, PIXELS_PER_DEGREE);
    map.iter().map(|&e| f64::from(e)).sum::<f64>() / map.len() as f64
}

/// The numbers are the mean that `flip-evaluator` 1.x from the paper's authors gives for the same pixels (LDR, linear
/// input, 67 pixels per degree). It computes in `f32`, which is where the last digits go.
#[test]
fn flip_is_what_its_authors_compute() {
    let changed = |change: &dyn Fn([f32; 3]) -> [f32; 3]| base().into_iter().map(change).collect::<Vec<_>>();
    let tinted = changed(&|[r, g, b]| [0.9 * r, g, b]);
    let inverted = changed(&|rgb| rgb.map(|c| 1.0 - c));
    let still = base();
    let shifted: Vec<[f32; 3]> =
        (0..WIDTH * HEIGHT).map(|i| still[i - i % WIDTH + (i % WIDTH + WIDTH - 1) % WIDTH]).collect();
    for (test, wanted) in [(tinted, 0.134_554_6), (inverted, 0.965_850_7), (shifted, 0.245_593_0)] {
        let got = mean_flip(&test);
        assert!((got - wanted).abs() < 2e-5, "{got}, not {wanted}");
    }
}

#[test]
fn equal_pictures_do_not_flip() {
    assert_eq!(mean_flip(&base()), 0.0);
}

#[test]
fn a_single_pixel_is_a_picture() {
    let pixel = |value: f32| Picture {
        size: [1, 1],
        window: PixelRect::of_picture(1, 1),
        color: vec![[value, value, value, 1.0]],
    };
    let differences = compare(&pixel(0.0), &pixel(1.0)).differences;
    assert_eq!((differences.rmse, differences.max, differences.bias), (1.0, 1.0, -1.0));
    assert!(differences.flip > 0.9);
    assert_eq!(compare(&pixel(f32::NAN), &pixel(0.0)).differences.nonfinite, 3);
}
