//! Normals from heights and from normal maps.

use glam::{DVec2, DVec3, Vec2, Vec3};

/// How texture coordinates lie on a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct UvFrame {
    /// Gradient of u over the surface, per world unit.
    pub gradient_u: Vec3,
    /// Gradient of v.
    pub gradient_v: Vec3,
    /// The way the surface goes with growing u, per unit of u.
    pub tangent: Vec3,
    /// 1 if u, v and the front make a right-handed frame, −1 if the texture is mirrored.
    pub handedness: f32,
    /// World units that one unit of u and v spans, as the root of the area they span.
    pub span: f32,
}

impl UvFrame {
    /// The frame of a triangle; `None` if its corners or its coordinates span no area, so that the texture has no directions on it.
    #[must_use]
    pub fn new(corners: [DVec3; 3], uv: [DVec2; 3]) -> Option<Self> {
        let (e1, e2) = (corners[1] - corners[0], corners[2] - corners[0]);
        let (d1, d2) = (uv[1] - uv[0], uv[2] - uv[0]);
        let determinant = d1.perp_dot(d2);
        // ∂P/∂u and ∂P/∂v from e = d.x ∂P/∂u + d.y ∂P/∂v for both sides.
        let du = (e1 * d2.y - e2 * d1.y) / determinant;
        let dv = (e2 * d1.x - e1 * d2.x) / determinant;
        let area = du.cross(dv);
        let area2 = area.length_squared();
        let frame = Self {
            gradient_u: (dv.cross(area) / area2).as_vec3(),
            gradient_v: (area.cross(du) / area2).as_vec3(),
            tangent: du.as_vec3(),
            handedness: if determinant < 0.0 { -1.0 } else { 1.0 },
            span: area2.sqrt().sqrt() as f32,
        };
        let usable = frame.gradient_u.is_finite()
            && frame.gradient_v.is_finite()
            && frame.tangent.is_finite()
            && frame.span.is_finite();
        (usable && area2 > 0.0).then_some(frame)
    }

    /// The normal of the surface raised by heights with this gradient \[14, 15\].
    ///
    /// `slope` is (∂h/∂u, ∂h/∂v) with h in world units along the front normal; `normal` is the unit normal to tilt and
    /// `side` is 1 if it is on the front, −1 if it was turned to the back, where hills are hollows. The silhouette
    /// does not change. No slope gives `normal` back, bit by bit.
    #[must_use]
    pub fn bumped(&self, normal: Vec3, side: f32, slope: Vec2) -> Vec3 {
        if slope == Vec2::ZERO {
            return normal;
        }
        let gradient = self.gradient_u * slope.x + self.gradient_v * slope.y;
        let in_plane = gradient - normal * normal.dot(gradient);
        direction(normal - side * in_plane, normal)
    }

    /// The normal that a normal map's vector stands for: x along growing u, y along growing v, z along the front.
    ///
    /// `vector` need not be of unit length: the mean of several is as good. (0, 0, z) with z > 0 gives `normal` back,
    /// bit by bit. `normal` and `side` as for [`UvFrame::bumped`].
    #[must_use]
    pub fn mapped(&self, normal: Vec3, side: f32, vector: Vec3) -> Vec3 {
        if vector.x == 0.0 && vector.y == 0.0 {
            return normal;
        }
        let front = normal * side;
        let tangent = (self.tangent - front * front.dot(self.tangent)).normalize_or_zero();
        let bitangent = front.cross(tangent) * self.handedness;
        let tilted = tangent * vector.x + bitangent * vector.y + front * vector.z;
        direction(tilted * side, normal)
    }
}

/// A vector's direction; `fallback` for one without.
fn direction(v: Vec3, fallback: Vec3) -> Vec3 {
    let largest = v.abs().max_element();
    if largest > 0.0 && largest.is_finite() { (v / largest).normalize() } else { fallback }
}

/// Turns a shading normal that points away from the eye until it is at right angles to the view; others come back as
/// they are. `fallback` serves where no such direction is left.
#[must_use]
pub fn keep_visible(normal: Vec3, to_eye: Vec3, fallback: Vec3) -> Vec3 {
    let towards = normal.dot(to_eye);
    if towards >= 0.0 {
        return normal;
    }
    let tilted = (normal - to_eye * towards).normalize_or_zero();
    if tilted == Vec3::ZERO { fallback } else { tilted }
}

/// The slope of a height map at every texel, per unit of u and of v (v upward, row 0 the top): differences of the two
/// neighbours.
///
/// `height(x, y)` is asked for the neighbours of texel (x, y), so columns from −1 to `width` and rows from −1 to `height`;
/// the caller wraps them.
#[must_use]
pub fn slope_of_heights(size: [u32; 2], x: u32, y: u32, height: impl Fn(i64, i64) -> f32) -> Vec2 {
    let (x, y) = (i64::from(x), i64::from(y));
    let du = height(x + 1, y) - height(x - 1, y);
    let dv = height(x, y - 1) - height(x, y + 1);
    Vec2::new(0.5 * size[0] as f32 * du, 0.5 * size[1] as f32 * dv)
}
