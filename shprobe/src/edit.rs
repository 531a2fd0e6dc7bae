//! Changing a field: what probes hold, and which probes there are; and its arrays, for shaders.

use crate::field::{check_radiance, expect_count, irradiance_of};
use crate::sh::{Irradiance, Sh, coefficient_count};
use crate::{DistanceMap, Field, ProbeError};
use glam::{DVec3, Vec3};
use std::ops::Range;

impl Field {
    /// Replaces the light that a probe holds, in constant time.
    ///
    /// # Errors
    /// [`ProbeError::NoSuchProbe`], [`ProbeError::MixedOrders`] if it has another order than those of the field, or [`ProbeError::BadRadiance`].
    pub fn set_radiance(&mut self, probe: u32, radiance: &Sh) -> Result<(), ProbeError> {
        let index = self.index(probe)?;
        check_radiance(index, radiance, self.order)?;
        let count = coefficient_count(self.order);
        self.irradiance[index * count..][..count].copy_from_slice(&irradiance_of(radiance));
        self.lights[index] = Irradiance::new(radiance);
        self.glossy.set(index, radiance);
        Ok(())
    }

    /// Replaces a probe's map of distances, in constant time.
    ///
    /// # Errors
    /// [`ProbeError::NoSuchProbe`], or [`ProbeError::NoDistances`] if the field was made without distances.
    pub fn set_distances(&mut self, probe: u32, map: DistanceMap) -> Result<(), ProbeError> {
        let index = self.index(probe)?;
        let maps = self.distances.as_mut().ok_or(ProbeError::NoDistances)?;
        maps[index] = map;
        Ok(())
    }

    /// Adds probes after those of the field and divides space anew, in the time of [`Field::new`]; adding many in one call costs that
    /// once. Returns the indices of the new probes. `distances` holds a map for each if the field has distances, and nothing otherwise.
    ///
    /// # Errors
    /// As [`Field::new`] and [`Field::with_distances`]; the field is then as it was.
    pub fn insert(
        &mut self,
        positions: &[DVec3],
        radiance: &[Sh],
        distances: Vec<DistanceMap>,
    ) -> Result<Range<u32>, ProbeError> {
        expect_count(positions.len(), radiance.len())?;
        expect_count(if self.distances.is_some() { positions.len() } else { 0 }, distances.len())?;
        let before = self.probe_count();
        for (i, sh) in radiance.iter().enumerate() {
            check_radiance(before + i, sh, self.order)?;
        }
        self.divide([&self.positions, positions].concat())?;
        self.irradiance.extend(radiance.iter().flat_map(irradiance_of));
        self.lights.extend(radiance.iter().map(Irradiance::new));
        self.glossy.extend(radiance);
        if let Some(maps) = &mut self.distances {
            maps.extend(distances);
        }
        Ok(before as u32..self.probe_count() as u32)
    }

    /// Removes probes and divides space anew, in the time of [`Field::new`]. The remaining probes keep their order; returns the former
    /// index of each. A [`Hint`](crate::delaunay::Hint) from before the call stays valid: only the next lookup with it takes longer.
    ///
    /// # Errors
    /// [`ProbeError::NoSuchProbe`], or [`ProbeError::NoProbes`] if none would be left; the field is then as it was.
    pub fn remove(&mut self, probes: &[u32]) -> Result<Vec<u32>, ProbeError> {
        let mut gone = vec![false; self.probe_count()];
        for &probe in probes {
            gone[self.index(probe)?] = true;
        }
        let left: Vec<u32> = (0..self.probe_count() as u32).filter(|&i| !gone[i as usize]).collect();
        if left.is_empty() {
            return Err(ProbeError::NoProbes);
        }
        let count = coefficient_count(self.order);
        let of = |i: &u32| *i as usize;
        self.divide(left.iter().map(|i| self.positions[of(i)]).collect())?;
        self.irradiance =
            left.iter().flat_map(|i| &self.irradiance[of(i) * count..][..count]).copied().collect();
        self.lights = left.iter().map(|i| self.lights[of(i)]).collect();
        self.glossy.keep(&left, count);
        if let Some(maps) = &mut self.distances {
            let mut kept = gone.iter().map(|gone| !gone);
            maps.retain(|_| kept.next().unwrap_or(false));
        }
        Ok(left)
    }

    /// Where the probes are.
    #[must_use]
    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    /// Coefficients of irradiance, `(order + 1)²` for each probe, probe after probe, in the order of [`crate::sh`]'s basis: an array
    /// to upload for shaders, together with the corners and neighbours in [`Field::partition`]. A shader sums coefficient times
    /// basis function of the normal, times the probe's weight.
    #[must_use]
    pub fn irradiance_coefficients(&self) -> &[Vec3] {
        &self.irradiance
    }

    /// What the probes see, if that is known.
    #[must_use]
    pub fn distances(&self) -> Option<&[DistanceMap]> {
        self.distances.as_deref()
    }

    pub(crate) fn index(&self, probe: u32) -> Result<usize, ProbeError> {
        let index = probe as usize;
        if index < self.probe_count() { Ok(index) } else { Err(ProbeError::NoSuchProbe { index: probe }) }
    }
}
