//! Light screens: the image planes onto which receivers and casters are projected from a light.

use crate::error::ShadowError;
use glam::{DVec2, DVec3};
use pointillist_micropoint::{Geometry, GridRect, HiddenSides, Lens, LensKind};

/// Where light comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Emitter {
    /// From one point into all directions; `axis` is a direction in which most of it is needed, so
    /// that a narrow spot light gets by with one of the six screens.
    Point {
        /// In the world.
        position: DVec3,
        /// Any length but zero.
        axis: DVec3,
    },
    /// From infinitely far away.
    Directional {
        /// The way the light travels; any length but zero.
        direction: DVec3,
    },
}

/// Units of the grid across a screen. Receivers are then of the order of one unit, which is what the
/// absolute terms of rounding are made for.
const SCREEN_UNITS: f64 = 2048.0;

/// A screen reaches a little beyond its quarter of the sphere, so that casters at its rim are whole.
const RIM: f64 = 1.0625;

/// The screens of one light: six faces of a cube about a point light, one for a directional light.
#[derive(Clone, Debug)]
pub(crate) struct Screens {
    pub(crate) lenses: Vec<Lens>,
    pub(crate) rect: GridRect,
    pub(crate) hidden: HiddenSides,
    /// Units of the grid across a whole screen.
    pub(crate) size: f64,
}

impl Screens {
    pub(crate) fn new(emitter: Emitter, geometry: &Geometry) -> Result<Self, ShadowError> {
        let check = |v: DVec3, what| if v.is_finite() { Ok(v) } else { Err(ShadowError::NotFinite { what }) };
        let unit = |v: DVec3| v.try_normalize().ok_or(ShadowError::NoDirection);
        match emitter {
            Emitter::Point { position, axis } => {
                let position = check(position, "position")?;
                Ok(Self::cube(position, unit(check(axis, "axis")?)?, geometry))
            }
            Emitter::Directional { direction } => {
                Ok(Self::parallel(unit(check(direction, "direction")?)?, geometry))
            }
        }
    }

    fn cube(position: DVec3, axis: DVec3, geometry: &Geometry) -> Self {
        let (x, y) = axis.any_orthonormal_pair();
        let z = axis;
        let half = 0.5 * SCREEN_UNITS;
        // Each frame (right, down, forward) is right-handed.
        let frames = [(x, y, z), (y, x, -z), (y, z, x), (z, y, -x), (z, x, y), (x, z, -y)];
        let lens = |(right, down, forward): (DVec3, DVec3, DVec3)| Lens {
            kind: LensKind::Perspective,
            origin: position,
            right,
            down,
            forward,
            scale: half,
            centre: DVec2::ZERO,
            reach: 1.0,
        };
        let lenses = frames.map(lens).to_vec();
        Self {
            hidden: geometry.hidden_sides(&lenses[0]),
            lenses,
            rect: GridRect { low: DVec2::splat(-half * RIM), high: DVec2::splat(half * RIM) },
            size: SCREEN_UNITS,
        }
    }

    fn parallel(forward: DVec3, geometry: &Geometry) -> Self {
        let (right, down) = forward.any_orthonormal_pair();
        let bounds = geometry.bounds();
        let empty = bounds.low.x > bounds.high.x;
        let (low, high) = if empty { (DVec3::ZERO, DVec3::ONE) } else { (bounds.low, bounds.high) };
        let diagonal = (high - low).length().max(f64::MIN_POSITIVE);
        let lens = Lens {
            kind: LensKind::Orthographic,
            // All depths are positive, with a margin.
            origin: 0.5 * (low + high) - forward * diagonal,
            right,
            down,
            forward,
            scale: SCREEN_UNITS / diagonal,
            centre: DVec2::ZERO,
            reach: 2.0 * diagonal,
        };
        Self {
            rect: GridRect { low: DVec2::splat(-SCREEN_UNITS), high: DVec2::splat(SCREEN_UNITS) },
            hidden: geometry.hidden_sides(&lens),
            lenses: vec![lens],
            size: SCREEN_UNITS,
        }
    }

    /// The screen through whose middle axis, or nearest to it, a vector from the light points.
    pub(crate) fn facing(&self, v: DVec3) -> usize {
        let lens = &self.lenses[0];
        if lens.kind == LensKind::Orthographic {
            return 0;
        }
        // The order of the frames in `cube`: ±forward, ±right, ±down of the first.
        let p = lens.local_vector(v);
        let size = p.abs();
        let (axis, value) = if size.z >= size.x && size.z >= size.y {
            (0, p.z)
        } else if size.x >= size.y {
            (2, p.x)
        } else {
            (4, p.y)
        };
        axis + usize::from(value < 0.0)
    }
}

/// Whether a vector from the light, in the lens's frame, points into its screen.
pub(crate) fn sees(lens: &Lens, p: DVec3) -> bool {
    lens.kind == LensKind::Orthographic || (p.z > 0.0 && p.x.abs() <= p.z && p.y.abs() <= p.z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec3;

    #[test]
    fn six_right_handed_screens_cover_the_sphere() {
        let geometry = Geometry::new(&[], &[], &[], &[]).unwrap();
        let emitter = Emitter::Point { position: DVec3::ZERO, axis: dvec3(0.3, -0.5, 0.8) };
        let screens = Screens::new(emitter, &geometry).unwrap();
        for l in &screens.lenses {
            assert!((l.right.cross(l.down) - l.forward).length() < 1e-12);
        }
        for i in 0..1000 {
            let a = f64::from(i) * 2.399_963;
            let z = 1.0 - (f64::from(i) + 0.5) / 500.0;
            let r = (1.0 - z * z).sqrt();
            let v = dvec3(r * a.cos(), r * a.sin(), z);
            let lens = &screens.lenses[screens.facing(v)];
            assert!(sees(lens, lens.local_vector(v)));
        }
    }
}
