//! The classical comparator: probes on a grid, interpolated along its axes.

use glam::{DVec3, USizeVec3};
use pointillist_sh::Irradiance;
use pointillist_shprobe::place;

use crate::shprobe::site::{Baked, Ground};

/// Share of the weight of a probe that does not see a position, as in `Field`.
const UNSEEN: f64 = 1e-4;

/// A grid, some of whose places may be without a probe.
pub(crate) struct Grid {
    size: [usize; 3],
    low: DVec3,
    high: DVec3,
    /// For each place, x fastest, the number of its probe.
    probe: Vec<Option<usize>>,
    /// Where probes are: those in solids are moved out.
    pub(crate) positions: Vec<DVec3>,
}

impl Grid {
    pub(crate) fn new(ground: &Ground<'_>, size: [usize; 3]) -> Self {
        let places = place::grid(ground.site.low, ground.site.high, size);
        let (low, high) = (places[0], places[places.len() - 1]);
        let mut positions = vec![];
        let mut add = |place: &DVec3| {
            positions.push(ground.settled(*place)?);
            Some(positions.len() - 1)
        };
        let probe = places.iter().map(&mut add).collect();
        Self { size, low, high, probe, positions }
    }

    /// The light at a position: of eight probes, and with `distances` of those that see it.
    pub(crate) fn light(
        &self,
        baked: &Baked,
        lights: &[Irradiance],
        distances: bool,
        p: DVec3,
    ) -> Irradiance {
        let cells = DVec3::from_array(self.size.map(|n| (n - 1) as f64));
        let at = ((p - self.low) / (self.high - self.low) * cells).clamp(DVec3::ZERO, cells);
        let low = at.floor().min(cells - 1.0).max(DVec3::ZERO);
        let t = at - low;
        let corner = |i: usize| {
            let high = [i & 1, i >> 1 & 1, i >> 2 & 1];
            let weight: f64 = (0..3).map(|k| if high[k] == 1 { t[k] } else { 1.0 - t[k] }).product();
            let place = low.as_usizevec3() + USizeVec3::from_array(high);
            let [nx, ny, _] = self.size;
            let probe = self.probe[(place.z * ny + place.y) * nx + place.x]?;
            let sight = || baked.distances[probe].visibility(p - baked.positions[probe]);
            let seen = if distances { UNSEEN + (1.0 - UNSEEN) * sight() } else { 1.0 };
            Some((probe, weight * seen))
        };
        // A place outside of the grid has no weight: nothing lies beyond the last one.
        let parts: Vec<_> =
            (0..8).filter(|i| (0..3).all(|k| i >> k & 1 == 0 || t[k] > 0.0)).filter_map(corner).collect();
        let sum: f64 = parts.iter().map(|(_, w)| w).sum();
        let mut light = Irradiance::DARK;
        parts.iter().for_each(|&(probe, w)| light.add_scaled(&lights[probe], (w / sum) as f32));
        light
    }
}
