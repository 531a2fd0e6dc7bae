//! Products of functions in spherical harmonics.

use crate::ShError;
use crate::basis::{MAX_COUNT, checked_order, coefficient_count, fill_basis};
use crate::{Channel, Sh, SphereQuadrature};

/// Multiplies functions of given orders, such as radiance and visibility, and keeps bands up to a given order of the
/// product: exactly, by quadrature of sufficient degree.
pub struct Product {
    orders: [usize; 2],
    order: usize,
    /// Basis functions of the highest of the orders at each point, and its weight.
    points: Vec<([f64; MAX_COUNT], f64)>,
}

impl Product {
    /// For functions of order `left` times functions of order `right`, to bands 0 to `order`.
    ///
    /// # Errors
    /// `OrderTooHigh`.
    pub fn new(left: usize, right: usize, order: usize) -> Result<Self, ShError> {
        let [left, right, order] = [checked_order(left)?, checked_order(right)?, checked_order(order)?];
        let most = left.max(right).max(order);
        let rule = SphereQuadrature::new(left + right + order);
        let point = |&(direction, weight): &(glam::DVec3, f64)| {
            let mut values = [0.0; MAX_COUNT];
            fill_basis(most, direction, &mut values);
            (values, weight)
        };
        Ok(Self { orders: [left, right], order, points: rule.points().iter().map(point).collect() })
    }

    /// The product.
    ///
    /// # Errors
    /// `MixedOrders` if one has not the order this was made for.
    pub fn of<T: Channel>(&self, left: &Sh<T>, right: &Sh<f64>) -> Result<Sh<T>, ShError> {
        for (expected, order) in self.orders.into_iter().zip([left.order(), right.order()]) {
            if order != expected {
                return Err(ShError::MixedOrders { left: expected, right: order });
            }
        }
        let mut product = vec![T::default(); coefficient_count(self.order)];
        for (values, weight) in &self.points {
            let l = left.coefficients().iter().zip(values).fold(T::default(), |sum, (&c, &y)| sum + c * y);
            let r: f64 = right.coefficients().iter().zip(values).map(|(c, y)| c * y).sum();
            let value = l * (r * weight);
            product.iter_mut().zip(values).for_each(|(sum, &y)| *sum += value * y);
        }
        Ok(Sh::from_parts(product, self.order))
    }
}

impl<T: Channel> Sh<T> {
    /// This times another, bands 0 to `order`. For many of the same orders, see [`Product`].
    ///
    /// # Errors
    /// `OrderTooHigh`.
    pub fn product(&self, other: &Sh<f64>, order: usize) -> Result<Self, ShError> {
        Product::new(self.order(), other.order(), order)?.of(self, other)
    }
}
