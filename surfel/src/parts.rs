//! Parts of a cloud, each prepared with the points around it.
//!
//! What is estimated for a point depends on its neighbours. Those of a point near the end of a part lie in other parts:
//! they are looked at, but do not become part of it. So parts that meet have the discs that the whole would have there.

use crate::attributes::{Sorted, in_order};
use crate::cloud::Cloud;
use crate::error::SurfelError;
use crate::lattice::Lattice;
use crate::points::Points;
use glam::DVec3;

/// The part of a point that is only looked at.
pub const NO_PART: u8 = u8::MAX;

/// How a cloud is divided into parts: see [`Cloud::parts`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Division {
    /// Lowest corner of a cube around all points of the whole cloud, world.
    pub low: DVec3,
    /// Its side, world units; above 0.
    pub side: f64,
    /// Distance of neighbouring points of the whole cloud, about, world units; above 0. No estimated disc has a radius of
    /// more than six times as much, and a point without neighbours has one of three quarters of it.
    pub spacing: f64,
}

/// The distance of the sixth neighbour over that of the first: 1.41 on a square lattice, 1.6 among random points.
const SIXTH_NEIGHBOUR: f64 = 1.5;

impl Cloud {
    /// Prepares parts of a cloud: `parts[i]` is the number of the part of point `i`, or [`NO_PART`] for a point that lies around them. The
    /// result has a cloud, or nothing for a part without points, for each number up to the largest.
    ///
    /// Points should be there up to six spacings around each part: then what is estimated hardly differs from what the
    /// whole cloud would have. Each part is the same for every order of the points. Positions are kept to 2⁻³² of the
    /// division's side; what is outside of its cube is moved to its faces.
    ///
    /// # Errors
    /// Those of [`Cloud::new`]; [`SurfelError::BadCube`], [`SurfelError::BadSpacing`].
    pub fn parts(
        points: &Points<'_>,
        parts: &[u8],
        division: &Division,
    ) -> Result<Vec<Option<Self>>, SurfelError> {
        points.check()?;
        if parts.len() != points.positions.len() {
            let (length, count) = (parts.len(), points.positions.len());
            return Err(SurfelError::LengthMismatch { what: "numbers of parts", length, count });
        }
        let Division { low, side, spacing } = *division;
        let lattice =
            Lattice::of_cube(low, side).ok_or(SurfelError::BadCube { low: low.to_array(), side })?;
        if !(spacing > 0.0 && spacing.is_finite()) {
            return Err(SurfelError::BadSpacing { spacing });
        }
        let Sorted { attributes, codes, numbers, .. } =
            in_order(points, &lattice, Some(SIXTH_NEIGHBOUR * spacing / side));
        let is_estimated = points.normals.is_none();
        let count =
            parts.iter().filter(|&&part| part != NO_PART).max().map_or(0, |&last| usize::from(last) + 1);
        let of_part = |part: usize| {
            let is_in = |place: &u32| usize::from(parts[numbers[*place as usize] as usize]) == part;
            let places: Vec<u32> = (0..numbers.len() as u32).filter(is_in).collect();
            let codes: Vec<u64> = places.iter().map(|&place| codes[place as usize]).collect();
            // What is closed, and where its outside is, only the whole could tell.
            let two_sided = vec![is_estimated; places.len()];
            let made = || Self::of_sorted(lattice, attributes.at(&places), &codes, &two_sided);
            (!places.is_empty()).then(|| Self { is_estimated, ..made() })
        };
        Ok((0..count).map(of_part).collect())
    }
}
