//! Items of a node that are projected together, as one list per value.

use crate::splat::Splat;
use crate::vector::Vector;
use pulp::Simd;

/// Items of a node that are projected together.
pub(crate) const BATCH: usize = 64;

pub(crate) type Values = [f32; BATCH];

/// The values that [`Projected`] holds of each item.
#[derive(Clone, Copy)]
pub(crate) enum Value {
    X,
    Y,
    Xx,
    Xy,
    Yy,
    Depth,
    DepthX,
    DepthY,
    Kx,
    Ky,
    Weight,
    Thickness,
    Flat,
    Sharpness,
    Red,
    Green,
    Blue,
    NormalX,
    NormalY,
    NormalZ,
    Left,
    Right,
    Top,
    Bottom,
    Opacity,
    Kept,
}

/// Discs on the picture, a list for each value: as vectors compute them.
pub(crate) struct Projected([Values; Value::Kept as usize + 1]);

impl Projected {
    pub(crate) const NOTHING: Self = Self([[0.0; BATCH]; Value::Kept as usize + 1]);

    #[inline(always)]
    fn get(&self, item: usize, value: Value) -> f32 {
        self.0[value as usize][item]
    }

    /// Whether an item has a disc that may touch pixels.
    #[inline(always)]
    pub(crate) fn is_kept(&self, item: usize) -> bool {
        self.get(item, Value::Kept) > 0.0
    }

    /// Sets a vector of items.
    #[inline(always)]
    pub(crate) fn set<S: Simd>(&mut self, place: usize, value: Value, vector: Vector<S>) {
        S::as_mut_simd_f32s(&mut self.0[value as usize]).0[place] = vector.lanes;
    }

    #[inline(always)]
    pub(crate) fn splat(&self, item: usize) -> Splat {
        let get = |value: Value| self.get(item, value);
        Splat {
            x: get(Value::X),
            y: get(Value::Y),
            xx: get(Value::Xx),
            xy: get(Value::Xy),
            yy: get(Value::Yy),
            depth: get(Value::Depth),
            depth_x: get(Value::DepthX),
            depth_y: get(Value::DepthY),
            kx: get(Value::Kx),
            ky: get(Value::Ky),
            weight: get(Value::Weight),
            thickness: get(Value::Thickness),
            flat: get(Value::Flat) > 0.0,
            columns: [whole(get(Value::Left)), whole(get(Value::Right))],
            rows: [whole(get(Value::Top)), whole(get(Value::Bottom))],
            sharpness: get(Value::Sharpness),
            color: [get(Value::Red), get(Value::Green), get(Value::Blue)],
            opacity: get(Value::Opacity),
            normal: [get(Value::NormalX), get(Value::NormalY), get(Value::NormalZ)],
        }
    }
}

/// Adding this rounds a number of pixels to the nearest whole number, which is then in the last bits of the sum: no
/// bits are left for fractions.
pub(crate) const WHOLE: f32 = 8_388_608.0;

/// The whole number to which [`WHOLE`] was added.
#[inline(always)]
fn whole(sum: f32) -> u8 {
    sum.to_bits() as u8
}
