//! Legendre polynomials.

/// Fills `values` with P_0(x), P_1(x), …
pub(crate) fn legendre(x: f64, values: &mut [f64]) {
    let (mut last, mut p) = (0.0, 1.0);
    for (l, value) in values.iter_mut().enumerate() {
        *value = p;
        let l = l as f64;
        (last, p) = (p, ((2.0 * l + 1.0) * x * p - l * last) / (l + 1.0));
    }
}
