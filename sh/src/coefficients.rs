//! A function on the sphere as coefficients.

use crate::ShError;
use crate::basis::{
    MAX_COUNT, Y0, basis_l2, checked_order, coefficient_count, coefficient_index, fill_basis,
};
use crate::{Channel, Lobe};
use glam::DVec3;

/// A function of direction that is a sum of spherical harmonics: radiance per color, or (`Sh<f64>`) one number, such as
/// visibility.
#[derive(Clone, Debug, PartialEq)]
pub struct Sh<T = DVec3> {
    coefficients: Vec<T>,
    order: usize,
}

impl<T: Channel> Sh<T> {
    /// From coefficients in the order of the module's documentation; their number determines the order.
    ///
    /// # Errors
    /// `CoefficientCount` if it is not a square from 1 to 81, `CoefficientNotFinite`.
    pub fn new(coefficients: Vec<T>) -> Result<Self, ShError> {
        let count = coefficients.len();
        let order = count.isqrt().wrapping_sub(1);
        if count > MAX_COUNT || count == 0 || coefficient_count(order) != count {
            return Err(ShError::CoefficientCount { count });
        }
        if let Some(index) = coefficients.iter().position(|c| !c.is_finite()) {
            return Err(ShError::CoefficientNotFinite { index });
        }
        Ok(Self { coefficients, order })
    }

    /// Takes coefficients that the caller has checked: their number is that of an order, and they are finite.
    pub(crate) fn from_parts(coefficients: Vec<T>, order: usize) -> Self {
        debug_assert_eq!(coefficients.len(), coefficient_count(order), "one coefficient per function");
        Self { coefficients, order }
    }

    /// The function that is 0 in all directions.
    ///
    /// # Errors
    /// `OrderTooHigh`.
    pub fn zero(order: usize) -> Result<Self, ShError> {
        let order = checked_order(order)?;
        Ok(Self::from_parts(vec![T::default(); coefficient_count(order)], order))
    }

    /// The function that has this value in all directions.
    ///
    /// # Errors
    /// `OrderTooHigh`, `CoefficientNotFinite`.
    pub fn constant(value: T, order: usize) -> Result<Self, ShError> {
        let mut sh = Self::zero(order)?;
        sh.coefficients[0] = value * Y0.recip();
        if sh.coefficients[0].is_finite() { Ok(sh) } else { Err(ShError::CoefficientNotFinite { index: 0 }) }
    }

    /// The highest band.
    #[must_use]
    pub const fn order(&self) -> usize {
        self.order
    }

    /// All coefficients, by band and m.
    #[must_use]
    pub fn coefficients(&self) -> &[T] {
        &self.coefficients
    }

    /// All coefficients, by band and m.
    #[must_use]
    pub fn into_coefficients(self) -> Vec<T> {
        self.coefficients
    }

    /// The coefficients of a band, from m = −l to l; none above the order.
    #[must_use]
    pub fn band(&self, l: usize) -> &[T] {
        if l > self.order { &[] } else { &self.coefficients[l * l..(l + 1) * (l + 1)] }
    }

    /// The coefficient of l and m; 0 where there is none.
    #[must_use]
    pub fn coefficient(&self, l: usize, m: isize) -> T {
        let exists = l <= self.order && m.unsigned_abs() <= l;
        if exists { self.coefficients[coefficient_index(l, m)] } else { T::default() }
    }

    /// The value in a direction of unit length.
    #[must_use]
    pub fn at(&self, direction: DVec3) -> T {
        if let Ok(coefficients) = <&[T; 9]>::try_from(self.coefficients.as_slice()) {
            return dot(coefficients, &basis_l2(direction));
        }
        let mut values = [0.0; MAX_COUNT];
        fill_basis(self.order, direction, &mut values);
        dot(&self.coefficients, &values)
    }

    /// Whether all coefficients are finite. [`Sh::new`] accepts no others, but factors and weights of arithmetic are
    /// not checked: NaN and overflow show in the result.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.coefficients.iter().all(|c| (0..T::CHANNELS).all(|i| c.channel(i).is_finite()))
    }

    /// The mean over all directions.
    #[must_use]
    pub fn mean(&self) -> T {
        self.coefficients[0] * Y0
    }

    /// Σ c² of a band, per channel. Rotations keep it.
    #[must_use]
    pub fn band_power(&self, l: usize) -> T {
        self.band(l).iter().fold(T::default(), |sum, &c| sum + c * c)
    }

    /// All values times `factor`.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        self.map(|_, c| c * factor)
    }

    /// The sum of both.
    ///
    /// # Errors
    /// `MixedOrders`.
    pub fn plus(&self, other: &Self) -> Result<Self, ShError> {
        self.same_order(other)?;
        Ok(self.map(|i, c| c + other.coefficients[i]))
    }

    /// This less the other.
    ///
    /// # Errors
    /// `MixedOrders`.
    pub fn minus(&self, other: &Self) -> Result<Self, ShError> {
        self.same_order(other)?;
        Ok(self.map(|i, c| c - other.coefficients[i]))
    }

    /// The sum of all, each times its weight: light between probes.
    ///
    /// # Errors
    /// `NothingToBlend`, `MixedOrders`.
    pub fn blend<'a>(parts: impl IntoIterator<Item = (&'a Self, f64)>) -> Result<Self, ShError>
    where
        T: 'a,
    {
        let mut parts = parts.into_iter();
        let (first, weight) = parts.next().ok_or(ShError::NothingToBlend)?;
        let mut sum = first.scaled(weight);
        parts.try_for_each(|(sh, weight)| sum.add_scaled(sh, weight))?;
        Ok(sum)
    }

    /// As [`Sh::blend`], but overwrites this function, without a new allocation.
    ///
    /// # Errors
    /// `MixedOrders`, also with the order that is here.
    pub fn set_to_blend<'a>(
        &mut self,
        parts: impl IntoIterator<Item = (&'a Self, f64)>,
    ) -> Result<(), ShError>
    where
        T: 'a,
    {
        self.coefficients.fill(T::default());
        parts.into_iter().try_for_each(|(sh, weight)| self.add_scaled(sh, weight))
    }

    /// Adds `weight` times the other.
    ///
    /// # Errors
    /// `MixedOrders`.
    #[inline]
    pub fn add_scaled(&mut self, other: &Self, weight: f64) -> Result<(), ShError> {
        self.same_order(other)?;
        for (sum, &c) in self.coefficients.iter_mut().zip(&other.coefficients) {
            *sum += c * weight;
        }
        Ok(())
    }

    /// With fewer bands, or with more that are 0.
    ///
    /// # Errors
    /// `OrderTooHigh`.
    pub fn with_order(&self, order: usize) -> Result<Self, ShError> {
        let order = checked_order(order)?;
        let mut coefficients = self.coefficients.clone();
        coefficients.resize(coefficient_count(order), T::default());
        Ok(Self::from_parts(coefficients, order))
    }

    /// The convolution with a lobe: each band is multiplied by the lobe's factor.
    #[must_use]
    pub fn convolved(&self, lobe: &Lobe) -> Self {
        self.map_bands(|l| lobe.bands()[l])
    }

    /// One channel on its own.
    #[must_use]
    pub fn channel(&self, index: usize) -> Sh<f64> {
        let coefficients = self.coefficients.iter().map(|c| c.channel(index)).collect();
        Sh::from_parts(coefficients, self.order)
    }

    /// Each band times a factor.
    pub(crate) fn map_bands(&self, factor: impl Fn(usize) -> f64) -> Self {
        let mut sh = self.clone();
        for l in 0..=self.order {
            let factor = factor(l);
            for c in &mut sh.coefficients[l * l..(l + 1) * (l + 1)] {
                *c = *c * factor;
            }
        }
        sh
    }

    fn map(&self, f: impl Fn(usize, T) -> T) -> Self {
        let coefficients = self.coefficients.iter().enumerate().map(|(i, &c)| f(i, c)).collect();
        Self::from_parts(coefficients, self.order)
    }

    fn same_order(&self, other: &Self) -> Result<(), ShError> {
        let (left, right) = (self.order, other.order);
        if left == right { Ok(()) } else { Err(ShError::MixedOrders { left, right }) }
    }
}

#[inline]
fn dot<T: Channel>(coefficients: &[T], values: &[f64]) -> T {
    coefficients.iter().zip(values).fold(T::default(), |sum, (&c, &y)| sum + c * y)
}
