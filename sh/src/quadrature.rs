//! Integration rules that are exact for polynomials on the sphere.

use crate::ShError;
use crate::basis::{MAX_COUNT, checked_order, coefficient_count, fill_basis};
use crate::gauss_legendre::gauss_legendre;
use crate::{Channel, Sh};
use glam::{DVec3, dvec3};
use std::f64::consts::TAU;

/// Directions and weights that integrate spherical polynomials up to a degree exactly: Gauss–Legendre in z, equal steps
/// in the angle about it.
#[derive(Clone, Debug, PartialEq)]
pub struct SphereQuadrature {
    points: Vec<(DVec3, f64)>,
}

impl SphereQuadrature {
    /// Highest degree of a rule: 8 million points, 256 MB.
    pub const MAX_DEGREE: usize = 4096;

    /// The rule for polynomials up to `degree` in the direction: about degree²/2 points of 32 bytes.
    ///
    /// # Panics
    /// If the degree is above [`SphereQuadrature::MAX_DEGREE`].
    #[must_use]
    pub fn new(degree: usize) -> Self {
        assert!(degree <= Self::MAX_DEGREE, "degree {degree} is above {}", Self::MAX_DEGREE);
        let columns = degree + 1;
        let rows = gauss_legendre(degree / 2 + 1);
        let point = |(z, weight): (f64, f64), column: usize| {
            let (sin, cos) = (TAU * (column as f64 + 0.5) / columns as f64).sin_cos();
            let radius = (1.0 - z * z).sqrt();
            (dvec3(radius * cos, radius * sin, z), weight * TAU / columns as f64)
        };
        let points = rows.into_iter().flat_map(|row| (0..columns).map(move |column| point(row, column)));
        Self { points: points.collect() }
    }

    /// Unit directions, each with its weight; the weights sum to 4π.
    #[must_use]
    pub fn points(&self) -> &[(DVec3, f64)] {
        &self.points
    }

    /// ∫ f dω.
    #[must_use]
    pub fn integrate<T: Channel>(&self, mut f: impl FnMut(DVec3) -> T) -> T {
        self.points.iter().fold(T::default(), |sum, &(direction, weight)| sum + f(direction) * weight)
    }

    /// Coefficients of `f`, exact if it is a polynomial of degree at most this rule's less the order.
    ///
    /// # Errors
    /// `OrderTooHigh`; `CoefficientNotFinite` if a value is not finite.
    pub fn project<T: Channel>(&self, order: usize, mut f: impl FnMut(DVec3) -> T) -> Result<Sh<T>, ShError> {
        let count = coefficient_count(checked_order(order)?);
        let mut coefficients = vec![T::default(); count];
        let mut values = [0.0; MAX_COUNT];
        for &(direction, weight) in &self.points {
            fill_basis(order, direction, &mut values);
            let value = f(direction) * weight;
            coefficients.iter_mut().zip(&values).for_each(|(c, &y)| *c += value * y);
        }
        Sh::new(coefficients)
    }
}
