//! Numbers for tests that give functions anything at all.

use glam::DVec3;
use proptest::prelude::*;

/// Any number: mostly small ones, then any bits, NaN and infinities among them.
pub fn number() -> BoxedStrategy<f64> {
    prop_oneof![
        4 => -2.0..2.0,
        1 => any::<f64>(),
        1 => prop_oneof![
            Just(0.0), Just(f64::NAN), Just(f64::INFINITY), Just(f64::NEG_INFINITY), Just(1e300), Just(-1e89),
            Just(5e-324), Just(1e7), Just(-1e16),
        ],
    ]
    .boxed()
}

/// Numbers that coordinates may be, small, huge and tiny: others are refused at once, and more than that is to be tested.
pub fn finite() -> BoxedStrategy<f64> {
    prop_oneof![
        6 => -2.0..2.0,
        1 => prop_oneof![
            Just(0.0), Just(1e80), Just(-1e89), Just(5e-324), Just(1e7), Just(-1e16), Just(1e-160), Just(1e-300),
        ],
    ]
    .boxed()
}

/// Small numbers of one magnitude.
pub fn of_one_size() -> BoxedStrategy<f64> {
    (-2.0..2.0f64).boxed()
}

/// A vector of such numbers.
pub fn vector(number: fn() -> BoxedStrategy<f64>) -> BoxedStrategy<DVec3> {
    [number(), number(), number()].prop_map(DVec3::from_array).boxed()
}
