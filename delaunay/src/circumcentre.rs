//! Centres of spheres through the corners of cells: the vertices of the Voronoi diagram.
//!
//! With the first corner as origin and b, c, d the others, the centre of a tetrahedron is (|b|² c×d + |c|² d×b + |d|²
//! b×c) / (2 b·c×d), and of a triangle with n = b×c it is (|b|² c×n + |c|² n×b) / (2 |n|²). Where the denominator is
//! small beside the longest side, rounding of the numerator would move the centre: there both are computed exactly.

use crate::Cell;
use crate::scale::power_of_two_to_one;
use crate::wide::{self, Vector};
use glam::DVec3;
use num_bigint::{BigInt, Sign};

/// Least b·c×d for which `f64` is used, over the cube of the longest side along an axis. With it the centre errs by
/// about 1e-11 of the radius at most: 27·10 roundings of a numerator of at most 27, over twice this.
const LEAST_VOLUME: f64 = 1.0 / 64.0;

/// Least |b×c|² for which `f64` is used, over the fourth power of the longest side along an axis.
const LEAST_SQUARED_AREA: f64 = 1.0 / 64.0;

impl Cell<'_> {
    /// The centre of the sphere through the corners that has no point inside: a vertex of the Voronoi diagram. Of a
    /// triangle or segment the centre in its plane or line, of a point the point.
    ///
    /// Accuracy as of [`circumcentre`]. `None` if a corner is none of the points, or where [`circumcentre`] has none.
    ///
    /// ```
    /// use glam::dvec3;
    /// use pointillist_delaunay::Delaunay;
    ///
    /// let delaunay = Delaunay::new(&[[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]])?;
    /// let partition = delaunay.partition();
    /// let centres: Vec<_> = partition.cells().map(|cell| cell.circumcentre(delaunay.points())).collect();
    /// assert_eq!(centres, [Some(dvec3(1.0, 1.0, 1.0))]);
    /// # Ok::<(), pointillist_delaunay::DelaunayError>(())
    /// ```
    #[must_use]
    pub fn circumcentre(self, points: &[DVec3]) -> Option<DVec3> {
        let mut corners = [DVec3::ZERO; 4];
        for (corner, &index) in corners.iter_mut().zip(self.corners()) {
            *corner = *points.get(index as usize)?;
        }
        circumcentre(&corners[..self.corners().len()])
    }
}

/// The centre of the smallest sphere through all of one to four points: of a point, segment, triangle or tetrahedron.
///
/// The distances of the corners from it differ by at most 1e-10 of the radius and 4 ulp of the largest coordinate, of
/// corners and centre, however flat the cell is. `None` if the corners lie in a plane or line of fewer dimensions, one
/// is not finite, the centre is too far away for `f64`, or there are none or more than four.
#[must_use]
pub fn circumcentre(corners: &[DVec3]) -> Option<DVec3> {
    if !corners.iter().all(|p| p.is_finite()) {
        return None;
    }
    let centre = match *corners {
        [a] => Some(a),
        [a, b] => (a != b).then(|| a * 0.5 + b * 0.5),
        [a, b, c] => rounded_triangle(a, b - a, c - a).or_else(|| exact_triangle([a, b, c])),
        [a, b, c, d] => {
            rounded_tetrahedron(a, [b - a, c - a, d - a]).or_else(|| exact_tetrahedron([a, b, c, d]))
        }
        _ => None,
    };
    centre.filter(|c| c.is_finite())
}

/// A power of two that brings the longest of these to about 1; `None` if one is not finite, or if scaling could round.
fn scale_of(sides: &[DVec3]) -> Option<f64> {
    let longest = sides.iter().fold(0.0_f64, |m, s| m.max(s.abs().max_element()));
    let scale = power_of_two_to_one(longest);
    // Neither multiplying by the scale nor dividing by it again may round.
    (longest.is_finite() && (1e-290..1e290).contains(&longest)).then_some(scale)
}

fn rounded_triangle(a: DVec3, b: DVec3, c: DVec3) -> Option<DVec3> {
    let scale = scale_of(&[b, c])?;
    let (b, c) = (b * scale, c * scale);
    let n = b.cross(c);
    let longest = b.abs().max(c.abs()).max_element();
    let centre = b.length_squared() * c.cross(n) + c.length_squared() * n.cross(b);
    let is_thick = n.length_squared() >= LEAST_SQUARED_AREA * longest.powi(4);
    is_thick.then(|| a + centre / (2.0 * n.length_squared()) / scale)
}

fn rounded_tetrahedron(a: DVec3, sides: [DVec3; 3]) -> Option<DVec3> {
    let scale = scale_of(&sides)?;
    let [b, c, d] = sides.map(|s| s * scale);
    let longest = b.abs().max(c.abs()).max(d.abs()).max_element();
    let volume = b.dot(c.cross(d));
    let centre =
        b.length_squared() * c.cross(d) + c.length_squared() * d.cross(b) + d.length_squared() * b.cross(c);
    let is_thick = volume.abs() >= LEAST_VOLUME * longest.powi(3);
    is_thick.then(|| a + centre / (2.0 * volume) / scale)
}

/// The sum of vectors, each times a number.
fn sum(parts: &[(BigInt, Vector)]) -> Vector {
    std::array::from_fn(|k| parts.iter().map(|(factor, vector)| factor * &vector[k]).sum())
}

fn exact_triangle([a, b, c]: [DVec3; 3]) -> Option<DVec3> {
    let (b, c) = (wide::difference(b, a), wide::difference(c, a));
    let n = wide::cross(&b, &c);
    let centre = sum(&[(wide::dot(&b, &b), wide::cross(&c, &n)), (wide::dot(&c, &c), wide::cross(&n, &b))]);
    quotient(a, &centre, &(wide::dot(&n, &n) * 2))
}

fn exact_tetrahedron([a, b, c, d]: [DVec3; 4]) -> Option<DVec3> {
    let [b, c, d] = [b, c, d].map(|p| wide::difference(p, a));
    let centre = sum(&[
        (wide::dot(&b, &b), wide::cross(&c, &d)),
        (wide::dot(&c, &c), wide::cross(&d, &b)),
        (wide::dot(&d, &d), wide::cross(&b, &c)),
    ]);
    quotient(a, &centre, &(wide::det(&b, &c, &d) * 2))
}

/// a + numerator / denominator, each coordinate within an ulp; nothing if the denominator is 0.
fn quotient(a: DVec3, numerator: &Vector, denominator: &BigInt) -> Option<DVec3> {
    if denominator.sign() == Sign::NoSign {
        return None;
    }
    let coordinate =
        |k: usize| wide::to_f64(&(wide::to_integer(a[k]) * denominator + &numerator[k]), denominator);
    Some(DVec3::from_array(std::array::from_fn(coordinate)))
}
