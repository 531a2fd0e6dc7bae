//! A cloud in parts.

use super::{OwnedPoints, check, cloud, octree_is_sound};
use crate::cloud::Cloud;
use crate::lattice::Lattice;
use crate::parts::{Division, NO_PART};
use crate::{Points, SurfelError};
use glam::DVec3;

/// The octants of a cloud's cube as parts, each with all points within `margin` of it (in parts of the cube's side), joined.
///
/// # Errors
/// What [`Cloud::parts`] and [`Cloud::join`] refuse.
pub fn in_octants(points: &OwnedPoints, spacing: f64, margin: f64) -> Result<Cloud, SurfelError> {
    points.as_points().check()?;
    let lattice = Lattice::around(&points.positions);
    let division = Division { low: lattice.low, side: lattice.side, spacing };
    let place = |p: DVec3| (p - lattice.low) / lattice.side;
    let mut parts = vec![];
    for octant in 0..8usize {
        let low = DVec3::from_array([0, 1, 2].map(|axis| 0.5 * (octant >> axis & 1) as f64));
        let is_own = |p: DVec3| (0..3).all(|axis| (place(p)[axis] >= 0.5) == (low[axis] > 0.0));
        let is_near = |p: DVec3| {
            let beyond = (low - place(p)).max(place(p) - low - 0.5);
            beyond.max_element() <= margin
        };
        let near: Vec<usize> =
            (0..points.positions.len()).filter(|&i| is_near(points.positions[i])).collect();
        if near.is_empty() {
            continue;
        }
        let numbers: Vec<u8> =
            near.iter().map(|&i| if is_own(points.positions[i]) { 3 } else { NO_PART }).collect();
        parts.extend(Cloud::parts(&points.chosen(&near).as_points(), &numbers, &division)?);
    }
    let parts: Vec<&Cloud> = parts.iter().flatten().collect();
    Cloud::join(&parts)
}

/// Parts that were prepared among all others have, together, the points of the whole with the same normals and areas, if all
/// have radii: what is estimated otherwise depends on the spacing that is announced.
///
/// # Errors
/// What differs.
pub fn parts_are_the_whole(points: &OwnedPoints) -> Result<(), String> {
    let Ok(whole) = cloud(points) else { return Ok(()) };
    let joined = in_octants(points, whole.spacing().max(1e-280), 1.0).map_err(|error| error.to_string())?;
    octree_is_sound(&joined)?;
    check(joined.lattice == whole.lattice && joined.is_estimated == whole.is_estimated, || {
        "another cube, or normals of another kind".to_owned()
    })?;
    let (one, other) = (rows(&whole, points.radii.is_some()), rows(&joined, points.radii.is_some()));
    let first = one.iter().zip(&other).find(|(a, b)| a != b);
    check(one.len() == other.len() && first.is_none(), || format!("points differ: {first:?}"))
}

/// All that is known of each point, sorted; radii and areas only on demand.
fn rows(cloud: &Cloud, with_sizes: bool) -> Vec<Vec<u32>> {
    let points = &cloud.points;
    let row = |i: usize| {
        let mut row = points.cell(i).to_vec();
        row.extend(points.normal(i).to_array().map(f32::to_bits));
        if with_sizes {
            row.extend([points.radii[i].to_bits(), points.areas[i].to_bits()]);
        }
        row.extend(points.colors.iter().flat_map(|all| all[i].map(f32::to_bits)));
        row.push(points.opacity(i).to_bits());
        row.extend(points.shading_normals.iter().map(|all| all[i]));
        row
    };
    let mut rows: Vec<Vec<u32>> = (0..cloud.len()).map(row).collect();
    rows.sort_unstable();
    rows
}

impl OwnedPoints {
    /// Those with these numbers.
    #[must_use]
    pub fn chosen(&self, numbers: &[usize]) -> Self {
        fn of<T: Clone>(all: &[T], numbers: &[usize]) -> Vec<T> {
            numbers.iter().map(|&i| all[i].clone()).collect()
        }
        Self {
            positions: of(&self.positions, numbers),
            normals: self.normals.as_ref().map(|all| of(all, numbers)),
            shading_normals: self.shading_normals.as_ref().map(|all| of(all, numbers)),
            colors: self.colors.as_ref().map(|all| of(all, numbers)),
            radii: self.radii.as_ref().map(|all| of(all, numbers)),
            opacities: self.opacities.as_ref().map(|all| of(all, numbers)),
        }
    }
}

/// Parts of any size and number can be made of any points, in any cube, or are refused; those that are made have all of
/// their points.
///
/// # Errors
/// A part that is not sound.
pub fn parts_are_sound(points: &OwnedPoints, numbers: &[u8], division: &Division) -> Result<(), String> {
    let borrowed: Points<'_> = points.as_points();
    let Ok(parts) = Cloud::parts(&borrowed, numbers, division) else { return Ok(()) };
    for (part, cloud) in parts.iter().enumerate() {
        let wanted = numbers.iter().filter(|&&number| usize::from(number) == part).count();
        check(cloud.as_ref().map_or(0, Cloud::len) == wanted, || format!("part {part} is not of {wanted}"))?;
        cloud.as_ref().map_or(Ok(()), octree_is_sound)?;
    }
    let parts: Vec<&Cloud> = parts.iter().flatten().collect();
    match Cloud::join(&parts) {
        Ok(joined) => octree_is_sound(&joined),
        Err(SurfelError::NoPoints) if parts.is_empty() => Ok(()),
        Err(error) => Err(format!("parts of one cube cannot be joined: {error}")),
    }
}
