//! Clipping in homogeneous space, before there is a screen to cut by a grid.

use glam::{DVec2, DVec3, DVec4, Vec4Swizzles};

use crate::DiceError;

/// A vertex in clip space, with what lets the caller recover everything else it carries.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClipVertex {
    /// Homogeneous position.
    pub position: DVec4,
    /// Barycentric coordinates in the original triangle, or any three values that are affine in space.
    pub weights: DVec3,
}

impl ClipVertex {
    /// The corners of a triangle, with the unit vectors as weights.
    #[must_use]
    pub fn triangle(positions: [DVec4; 3]) -> [Self; 3] {
        let weights = [DVec3::X, DVec3::Y, DVec3::Z];
        [0, 1, 2].map(|i| Self { position: positions[i], weights: weights[i] })
    }

    /// The place on the screen, position divided by w: x and y in −1 to 1.
    #[must_use]
    pub fn ndc(&self) -> DVec2 {
        self.position.xy() / self.position.w
    }
}

/// Keeps the part of a convex polygon in front of the eye: w ≥ `relative` × the largest |w| of the polygon.
///
/// There is no absolute distance in this, so scenes of any scale are treated alike: a vertex at the eye or behind it is
/// cut off, one at a millionth of the polygon's depth is kept with `relative` = 1e-9. `out` is cleared first, and stays
/// empty if nothing is in front. New vertices are computed from the nearer to the farther end, so neighbours that
/// share an edge and a limit get the same ones.
///
/// # Errors
/// [`DiceError::NotFinite`] for a position or weight that is NaN or infinite.
pub fn clip_near(polygon: &[ClipVertex], relative: f64, out: &mut Vec<ClipVertex>) -> Result<(), DiceError> {
    check_finite(polygon)?;
    let largest = polygon.iter().fold(0.0_f64, |m, v| m.max(v.position.w.abs()));
    let limit = relative * largest;
    out.clear();
    if largest > 0.0 {
        clip_half_space(polygon, out, |v| v.w - limit);
        out.retain(|v| v.position.w > 0.0);
    }
    Ok(())
}

/// Keeps the part of a convex polygon with |x| ≤ `guard`·w and |y| ≤ `guard`·w; guard 1 is the viewport itself.
///
/// A guard band a few times the viewport keeps cell numbers small and leaves most polygons as they are. `scratch` is
/// overwritten. Call [`clip_near`] first.
///
/// # Errors
/// [`DiceError::NotFinite`] for a position or weight that is NaN or infinite.
pub fn clip_guard_band(
    polygon: &mut Vec<ClipVertex>,
    guard: f64,
    scratch: &mut Vec<ClipVertex>,
) -> Result<(), DiceError> {
    check_finite(polygon)?;
    let sides: [fn(DVec4, f64) -> f64; 4] =
        [|v, g| g * v.w - v.x, |v, g| g * v.w + v.x, |v, g| g * v.w - v.y, |v, g| g * v.w + v.y];
    for side in sides {
        if polygon.iter().all(|v| side(v.position, guard) >= 0.0) {
            continue;
        }
        scratch.clear();
        clip_half_space(polygon, scratch, |v| side(v, guard));
        std::mem::swap(polygon, scratch);
    }
    Ok(())
}

fn check_finite(polygon: &[ClipVertex]) -> Result<(), DiceError> {
    let finite = |v: &ClipVertex| v.position.is_finite() && v.weights.is_finite();
    match polygon.iter().position(|v| !finite(v)) {
        Some(index) => Err(DiceError::NotFinite { index }),
        None => Ok(()),
    }
}

/// Sutherland–Hodgman for one plane; `distance` is linear and not negative on the side that stays.
fn clip_half_space(polygon: &[ClipVertex], out: &mut Vec<ClipVertex>, distance: impl Fn(DVec4) -> f64) {
    let Some(mut a) = polygon.last() else { return };
    let mut a_distance = distance(a.position);
    for b in polygon {
        let b_distance = distance(b.position);
        if (a_distance < 0.0) != (b_distance < 0.0) {
            // Always from the vertex that stays, so that both neighbours of an edge find the same point.
            out.push(if a_distance < 0.0 {
                between(b, a, b_distance, a_distance)
            } else {
                between(a, b, a_distance, b_distance)
            });
        }
        if b_distance >= 0.0 {
            out.push(*b);
        }
        (a, a_distance) = (b, b_distance);
    }
}

/// The point of the edge at distance 0; `inside` ≥ 0 > `outside`.
fn between(a: &ClipVertex, b: &ClipVertex, inside: f64, outside: f64) -> ClipVertex {
    // Halved: the difference of two large numbers may be infinite, its half is not.
    let t = (0.5 * inside) / (0.5 * inside - 0.5 * outside);
    // Both ends weighted, not a + t·(b − a): exact at both ends, and no overflow.
    let mix = |a: f64, b: f64| (1.0 - t) * a + t * b;
    let mix4 = |a: DVec4, b: DVec4| DVec4::new(mix(a.x, b.x), mix(a.y, b.y), mix(a.z, b.z), mix(a.w, b.w));
    let mix3 = |a: DVec3, b: DVec3| DVec3::new(mix(a.x, b.x), mix(a.y, b.y), mix(a.z, b.z));
    ClipVertex { position: mix4(a.position, b.position), weights: mix3(a.weights, b.weights) }
}
