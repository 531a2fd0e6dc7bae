//! How much of the sphere a texel covers.

use glam::{DVec3, dvec3};

/// The exact solid angle of a texel of a face with size × size texels; 0 outside of it.
///
/// It is the difference of four arctangents of st/√(s² + t² + 1), which loses digits as texels get small; so it is
/// computed as two triangles \[6\], whose arctangents are of the size of the result. Relative error below 1e-15.
#[must_use]
pub fn texel_solid_angle(size: usize, x: usize, y: usize) -> f64 {
    if x >= size || y >= size {
        return 0.0;
    }
    let edge = |i: usize| (2.0 * i as f64 - size as f64) / size as f64;
    let corner = |i: usize, j: usize| dvec3(edge(i), edge(j), 1.0);
    let [a, b, c, d] = [corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)];
    let step = 2.0 / size as f64;
    // All triangles lie in the plane z = 1: the triple product is twice their area.
    triangle(step * step, a, b, c) + triangle(step * step, a, c, d)
}

/// tan(Ω/2) = a·(b×c) / (|a||b||c| + (a·b)|c| + (b·c)|a| + (c·a)|b|).
fn triangle(triple_product: f64, a: DVec3, b: DVec3, c: DVec3) -> f64 {
    let [la, lb, lc] = [a, b, c].map(DVec3::length);
    let below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    2.0 * triple_product.atan2(below)
}
