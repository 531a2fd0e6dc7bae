//! Arithmetic on as many numbers as the processor computes together, written as on one.

use pulp::Simd;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number, or several.
pub(crate) trait Real:
    Copy
    + Add<Output = Self>
    + Add<f32, Output = Self>
    + Sub<Output = Self>
    + Sub<f32, Output = Self>
    + Mul<Output = Self>
    + Mul<f32, Output = Self>
{
    /// A constant of the same kind.
    fn like(self, value: f32) -> Self;
    fn abs(self) -> Self;
    /// The smaller of this and a constant.
    fn at_most(self, limit: f32) -> Self;
}

impl Real for f32 {
    #[inline(always)]
    fn like(self, value: f32) -> Self {
        value
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self::abs(self)
    }

    #[inline(always)]
    fn at_most(self, limit: f32) -> Self {
        self.min(limit)
    }
}

/// A vector of the processor.
#[derive(Clone, Copy)]
pub(crate) struct Vector<S: Simd> {
    simd: S,
    pub(crate) lanes: S::f32s,
}

impl<S: Simd> Vector<S> {
    #[inline(always)]
    pub(crate) fn new(simd: S, lanes: S::f32s) -> Self {
        Self { simd, lanes }
    }

    /// A constant.
    #[inline(always)]
    pub(crate) fn all(simd: S, value: f32) -> Self {
        Self { simd, lanes: simd.splat_f32s(value) }
    }

    /// Other lanes of the same kind.
    #[inline(always)]
    pub(crate) fn with(self, lanes: S::f32s) -> Self {
        Self { lanes, ..self }
    }

    /// 1/x.
    #[inline(always)]
    pub(crate) fn inverse(self) -> Self {
        Self::all(self.simd, 1.0) / self
    }

    #[inline(always)]
    pub(crate) fn sqrt(self) -> Self {
        Self { lanes: self.simd.sqrt_f32s(self.lanes), ..self }
    }

    #[inline(always)]
    pub(crate) fn min(self, other: Self) -> Self {
        Self { lanes: self.simd.min_f32s(self.lanes, other.lanes), ..self }
    }

    #[inline(always)]
    pub(crate) fn max(self, other: Self) -> Self {
        Self { lanes: self.simd.max_f32s(self.lanes, other.lanes), ..self }
    }

    #[inline(always)]
    pub(crate) fn at_least(self, limit: f32) -> Self {
        Self { lanes: self.simd.max_f32s(self.lanes, self.simd.splat_f32s(limit)), ..self }
    }

    #[inline(always)]
    pub(crate) fn is_above(self, other: Self) -> S::m32s {
        self.simd.greater_than_f32s(self.lanes, other.lanes)
    }

    #[inline(always)]
    pub(crate) fn exceeds(self, limit: f32) -> S::m32s {
        self.simd.greater_than_f32s(self.lanes, self.simd.splat_f32s(limit))
    }

    /// This where `mask` is set, a constant elsewhere.
    #[inline(always)]
    pub(crate) fn if_set(self, mask: S::m32s, otherwise: f32) -> Self {
        Self { lanes: self.simd.select_f32s(mask, self.lanes, self.simd.splat_f32s(otherwise)), ..self }
    }

    /// This where `mask` is set, others elsewhere.
    #[inline(always)]
    pub(crate) fn or_where_unset(self, mask: S::m32s, others: S::f32s) -> Self {
        Self { lanes: self.simd.select_f32s(mask, self.lanes, others), ..self }
    }
}

impl<S: Simd> Real for Vector<S> {
    #[inline(always)]
    fn like(self, value: f32) -> Self {
        Self::all(self.simd, value)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self { lanes: self.simd.abs_f32s(self.lanes), ..self }
    }

    #[inline(always)]
    fn at_most(self, limit: f32) -> Self {
        Self { lanes: self.simd.min_f32s(self.lanes, self.simd.splat_f32s(limit)), ..self }
    }
}

/// An operator between vectors, and between a vector and a constant.
macro_rules! operator {
    ($trait:ident, $function:ident, $operation:ident) => {
        impl<S: Simd> $trait for Vector<S> {
            type Output = Self;

            #[inline(always)]
            fn $function(self, other: Self) -> Self {
                Self { lanes: self.simd.$operation(self.lanes, other.lanes), ..self }
            }
        }

        impl<S: Simd> $trait<f32> for Vector<S> {
            type Output = Self;

            #[inline(always)]
            fn $function(self, other: f32) -> Self {
                Self { lanes: self.simd.$operation(self.lanes, self.simd.splat_f32s(other)), ..self }
            }
        }
    };
}

operator!(Add, add, add_f32s);
operator!(Sub, sub, sub_f32s);
operator!(Mul, mul, mul_f32s);
operator!(Div, div, div_f32s);

impl<S: Simd> Neg for Vector<S> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self { lanes: self.simd.neg_f32s(self.lanes), ..self }
    }
}
