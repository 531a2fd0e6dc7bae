//! What a planar polygon carries, as a function of place.

use glam::{DVec2, DVec3};

/// A quantity that is affine over the plane: `a + b·x + c·y`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AttributePlane {
    /// The value at the origin.
    pub a: f64,
    /// Its change per unit of x.
    pub b: f64,
    /// Its change per unit of y.
    pub c: f64,
}

impl AttributePlane {
    /// The plane through three values; `None` if the points lie on one line (or anything is not finite).
    ///
    /// Its accuracy falls with the distance from the origin: subtract a point near the triangle first if it is far away.
    ///
    /// ```
    /// use glam::dvec2;
    /// use pointillist_dice::AttributePlane;
    /// let plane = AttributePlane::from_points([dvec2(0.0, 0.0), dvec2(2.0, 0.0), dvec2(0.0, 4.0)], [1.0, 2.0, 5.0]);
    /// assert_eq!(plane, Some(AttributePlane { a: 1.0, b: 0.5, c: 1.0 }));
    /// ```
    #[must_use]
    pub fn from_points(points: [DVec2; 3], values: [f64; 3]) -> Option<Self> {
        let (p, q) = (points[1] - points[0], points[2] - points[0]);
        let (dp, dq) = (values[1] - values[0], values[2] - values[0]);
        let area = p.perp_dot(q);
        if area == 0.0 {
            return None;
        }
        let b = (dp * q.y - dq * p.y) / area;
        let c = (dq * p.x - dp * q.x) / area;
        let a = values[0] - (b * points[0].x + c * points[0].y);
        (a.is_finite() && b.is_finite() && c.is_finite()).then_some(Self { a, b, c })
    }

    /// The value at `p`. For the mean over a piece ask at its centroid.
    #[inline]
    #[must_use]
    pub fn at(&self, p: DVec2) -> f64 {
        self.a + self.b * p.x + self.c * p.y
    }

    /// The same plane with `origin` as its origin: `plane.relative_to(o).at(p - o)` is `plane.at(p)`.
    #[must_use]
    pub fn relative_to(&self, origin: DVec2) -> Self {
        Self { a: self.at(origin), ..*self }
    }

    /// The smallest and largest value over `points`, and so over their convex hull. `None` without points.
    #[must_use]
    pub fn range(&self, points: &[DVec2]) -> Option<(f64, f64)> {
        points.iter().map(|&p| self.at(p)).fold(None, |range, v| match range {
            None => Some((v, v)),
            Some((low, high)) => Some((v.min(low), v.max(high))),
        })
    }
}

/// A quantity that is affine in space, seen in perspective: value/w over 1/w, both affine on the screen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PerspectivePlane {
    /// The value divided by w.
    pub value_over_w: AttributePlane,
    /// 1/w, shared by all quantities of a triangle.
    pub one_over_w: AttributePlane,
}

impl PerspectivePlane {
    /// The quantity with `values` at three screen points whose clip-space w are `w`.
    ///
    /// `None` if the points lie on one line or a w is zero.
    #[must_use]
    pub fn from_points(points: [DVec2; 3], values: [f64; 3], w: [f64; 3]) -> Option<Self> {
        let over_w = |i: usize| values[i] / w[i];
        Some(Self {
            value_over_w: AttributePlane::from_points(points, [over_w(0), over_w(1), over_w(2)])?,
            one_over_w: AttributePlane::from_points(points, w.map(f64::recip))?,
        })
    }

    /// The value at `p`.
    #[inline]
    #[must_use]
    pub fn at(&self, p: DVec2) -> f64 {
        self.value_over_w.at(p) / self.one_over_w.at(p)
    }
}

/// The barycentric coordinates of the triangle `points` as planes: their sum is 1 everywhere.
impl AttributePlane {
    /// The three planes that are 1 at one of the points and 0 at the others; `None` if the points lie on one line.
    #[must_use]
    pub fn barycentric(points: [DVec2; 3]) -> Option<[Self; 3]> {
        let plane = |v: DVec3| Self::from_points(points, v.to_array());
        Some([plane(DVec3::X)?, plane(DVec3::Y)?, plane(DVec3::Z)?])
    }
}
