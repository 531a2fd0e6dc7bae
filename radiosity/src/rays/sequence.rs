//! Quasi-random numbers: Sobol's first two dimensions, scrambled by a hash (Owen scrambling, \[9\]), so that places have different
//! numbers and every one has its own evenly spread ones.

use glam::DVec3;

/// Numbers of one place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sequence {
    seeds: [u32; 2],
}

impl Sequence {
    pub(crate) fn new(place: u64) -> Self {
        let mixed = mix(place);
        Self { seeds: [mixed as u32, (mixed >> 32) as u32] }
    }

    /// The `index`-th pair in [0, 1)². Any 2^k in a row from a multiple of 2^k are a (0, k, 2)-net.
    pub(crate) fn pair(self, index: u32) -> [f64; 2] {
        let first = index.reverse_bits();
        [scrambled(first, self.seeds[0]), scrambled(second_dimension(index), self.seeds[1])]
    }
}

/// Points of a second kind for the same indices, independent of the pairs: the golden ratio's relatives in two dimensions.
pub(crate) fn lattice(index: u32, shift: [f64; 2]) -> [f64; 2] {
    const STEPS: [f64; 2] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_2];
    let at = |k: usize| (shift[k] + f64::from(index) * STEPS[k]).fract();
    [at(0), at(1)]
}

/// Two pairs that are spread evenly together: the golden ratio's relatives in four dimensions, powers of the root of x⁵ = x + 1.
pub(crate) fn lattice_of_pairs(index: u32) -> [[f64; 2]; 2] {
    const ROOT: f64 = 1.167_303_978_261_418_7;
    let at = |power: i32| (0.5 + f64::from(index) * ROOT.powi(-power)).fract();
    [[at(1), at(2)], [at(3), at(4)]]
}

/// A shift for [`lattice`].
pub(crate) fn shift_of(place: u64) -> [f64; 2] {
    let unit = |bits: u64| (bits >> 40) as f64 / (1_u64 << 24) as f64;
    let bits = mix(place);
    [unit(bits), unit(mix(bits))]
}

/// splitmix64's mixing of the bits of a number.
pub(crate) const fn mix(value: u64) -> u64 {
    let mut z = value.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Bits of Sobol's second dimension, the highest first.
const fn second_dimension(mut index: u32) -> u32 {
    let (mut result, mut direction) = (0, 1_u32 << 31);
    while index != 0 {
        if index & 1 == 1 {
            result ^= direction;
        }
        index >>= 1;
        direction ^= direction >> 1;
    }
    result
}

/// Owen's scrambling by Laine's and Karras' hash on reversed bits.
const fn scrambled(bits: u32, seed: u32) -> f64 {
    let mut x = bits.reverse_bits();
    x = x.wrapping_add(seed);
    x ^= x.wrapping_mul(0x6c50_b47c);
    x ^= x.wrapping_mul(0xb82f_1e52);
    x ^= x.wrapping_mul(0xc7af_e638);
    x ^= x.wrapping_mul(0x8d22_f6e6);
    x.reverse_bits() as f64 / 4_294_967_296.0
}

/// Directions distributed by the cosine about a normal.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hemisphere {
    axes: [DVec3; 3],
}

impl Hemisphere {
    pub(crate) fn new(normal: DVec3) -> Self {
        let u = normal.any_orthonormal_vector();
        Self { axes: [u, normal.cross(u), normal] }
    }

    /// Shirley's and Chiu's map of the square to the disc, lifted to the hemisphere: neighbours stay neighbours.
    pub(crate) fn direction(&self, [x, y]: [f64; 2]) -> DVec3 {
        let (a, b) = (2.0 * x - 1.0, 2.0 * y - 1.0);
        let quarter = std::f64::consts::FRAC_PI_4;
        let (radius, angle) = if a == 0.0 && b == 0.0 {
            (0.0, 0.0)
        } else if a.abs() > b.abs() {
            (a, quarter * b / a)
        } else {
            (b, 2.0 * quarter - quarter * a / b)
        };
        let (sine, cosine) = angle.sin_cos();
        let up = (1.0 - radius * radius).max(1e-12).sqrt();
        self.axes[0] * (radius * cosine) + self.axes[1] * (radius * sine) + self.axes[2] * up
    }
}

/// A point of a convex ring with evenly distributed area, for a pair in [0, 1)².
pub(crate) fn point_of(ring: &[DVec3], [x, y]: [f64; 2]) -> DVec3 {
    let double = |i: usize| (ring[i] - ring[0]).cross(ring[i + 1] - ring[0]).length();
    let whole: f64 = (1..ring.len() - 1).map(double).sum();
    let mut left = x * whole;
    let mut triangle = 1;
    while triangle + 2 < ring.len() && left > double(triangle) {
        left -= double(triangle);
        triangle += 1;
    }
    let share = (left / double(triangle).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    let root = share.sqrt();
    let [a, b, c] = [ring[0], ring[triangle], ring[triangle + 1]];
    a * (1.0 - root) + b * (root * (1.0 - y)) + c * (root * y)
}
