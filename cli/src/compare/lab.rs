//! The colour spaces of FLIP.

/// XYZ of white, the row sums of [`XYZ_FROM_RGB`].
const WHITE: [f64; 3] = [0.950_428_545, 1.0, 1.088_900_371];

/// Linear Rec.709 to XYZ, as the authors of FLIP write it.
const XYZ_FROM_RGB: [[f64; 3]; 3] = [
    [10_135_552.0 / 24_577_794.0, 8_788_810.0 / 24_577_794.0, 4_435_075.0 / 24_577_794.0],
    [2_613_072.0 / 12_288_897.0, 8_788_810.0 / 12_288_897.0, 887_015.0 / 12_288_897.0],
    [1_425_312.0 / 73_733_382.0, 8_788_810.0 / 73_733_382.0, 70_074_185.0 / 73_733_382.0],
];

/// The inverse of [`XYZ_FROM_RGB`].
const RGB_FROM_XYZ: [[f64; 3]; 3] = [
    [3.241_003_232_976_358_6, -1.537_398_969_488_785_2, -0.498_615_881_996_363],
    [-0.969_224_252_202_516_6, 1.875_929_983_695_176_1, 0.041_554_226_340_084_73],
    [0.055_639_419_851_975_43, -0.204_011_206_123_909_96, 1.057_148_977_187_533_4],
];

fn apply(matrix: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

/// Linear colour to the opponent space in which contrast sensitivity is known: luminance, red-green, blue-yellow.
pub(super) fn ycxcz_from_rgb(rgb: [f64; 3]) -> [f64; 3] {
    let xyz = apply(&XYZ_FROM_RGB, rgb);
    let [x, y, z] = [0, 1, 2].map(|i| xyz[i] / WHITE[i]);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// Back again.
pub(super) fn rgb_from_ycxcz([luminance, cx, cz]: [f64; 3]) -> [f64; 3] {
    let y = (luminance + 16.0) / 116.0;
    let [x, z] = [y + cx / 500.0, y - cz / 200.0];
    apply(&RGB_FROM_XYZ, [x * WHITE[0], y * WHITE[1], z * WHITE[2]])
}

/// Linear colour to L*a*b* with colourfulness that falls with lightness (Hunt).
pub(super) fn hunt_lab_from_rgb(rgb: [f64; 3]) -> [f64; 3] {
    const DELTA: f64 = 6.0 / 29.0;
    let xyz = apply(&XYZ_FROM_RGB, rgb);
    let f = |t: f64| {
        if t > DELTA * DELTA * DELTA { t.cbrt() } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
    };
    let [x, y, z] = [0, 1, 2].map(|i| f(xyz[i] / WHITE[i]));
    let lightness = 116.0 * y - 16.0;
    let hunt = 0.01 * lightness;
    [lightness, hunt * 500.0 * (x - y), hunt * 200.0 * (y - z)]
}

/// Distance in L*a*b*: city block in lightness, Euclidean in the plane of colour.
pub(super) fn hyab(a: [f64; 3], b: [f64; 3]) -> f64 {
    (a[0] - b[0]).abs() + (a[1] - b[1]).hypot(a[2] - b[2])
}
