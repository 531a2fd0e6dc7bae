//! The types that a coefficient can have: a color or one number.

use glam::DVec3;
use std::fmt::Debug;
use std::ops::{Add, AddAssign, Mul, Sub};

/// A color (`DVec3`) or one number (`f64`): what coefficients are made of. Products are channel by channel.
pub trait Channel:
    Copy
    + Debug
    + Default
    + PartialEq
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + AddAssign
    + Mul<f64, Output = Self>
    + Mul<Output = Self>
    + private::Sealed
{
    /// Number of channels.
    const CHANNELS: usize;

    /// The number of a channel; that of the last one if there are fewer.
    fn channel(self, index: usize) -> f64;

    /// Whether all numbers are finite.
    fn is_finite(self) -> bool {
        (0..Self::CHANNELS).all(|i| self.channel(i).is_finite())
    }
}

mod private {
    pub trait Sealed {}
    impl Sealed for f64 {}
    impl Sealed for glam::DVec3 {}
}

impl Channel for f64 {
    const CHANNELS: usize = 1;

    fn channel(self, _: usize) -> f64 {
        self
    }
}

impl Channel for DVec3 {
    const CHANNELS: usize = 3;

    fn channel(self, index: usize) -> f64 {
        self[index.min(2)]
    }
}
