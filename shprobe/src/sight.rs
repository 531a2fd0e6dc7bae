//! Which probes light a position, once it is known which of them see it.

use crate::delaunay::Blend;
use glam::{DVec3, IVec3};
use std::collections::HashMap;

/// Probes and their shares, which sum to 1.
#[derive(Clone, Debug)]
pub(crate) struct Shares {
    list: [(u32, f64); MOST],
    count: usize,
}

/// Most probes that light a position: those of its cell and those nearby. Shares stay continuous with this limit in
/// practice, since probes at the rim of the neighbourhood have almost no weight.
const MOST: usize = 64;

impl Shares {
    /// Those of a cell.
    pub(crate) fn of_cell(blend: &Blend) -> Self {
        let mut shares = Self { list: [(0, 0.0); MOST], count: 0 };
        blend.parts().for_each(|(probe, weight)| shares.push(probe, weight));
        shares
    }

    fn push(&mut self, probe: u32, weight: f64) {
        if self.count < MOST && weight > 0.0 {
            self.list[self.count] = (probe, weight);
            self.count += 1;
        }
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = (u32, f64)> + '_ {
        self.list[..self.count].iter().copied()
    }

    fn normalise(&mut self) {
        let sum: f64 = self.iter().map(|(_, weight)| weight).sum();
        self.list[..self.count].iter_mut().for_each(|(_, weight)| *weight /= sum);
    }
}

/// Factor on the weight of a probe that does not see the position. It is above 0, so that a position that no probe sees
/// is lit as if all did.
const UNSEEN: f64 = 1e-4;

/// If the probes of the cell that see the position have less weight than this together, nearby probes that see it get
/// shares, too.
const ENOUGH: f64 = 0.25;

/// Probes by where they are.
#[derive(Clone, Debug, Default)]
pub(crate) struct Near {
    boxes: HashMap<IVec3, Vec<u32>>,
    reach: f64,
}

impl Near {
    /// `reach` is the distance, world units, up to which a probe outside of the cell can light a position.
    pub(crate) fn new(positions: &[DVec3], reach: f64) -> Self {
        let mut near = Self { boxes: HashMap::new(), reach };
        if reach > 0.0 {
            for (i, &p) in positions.iter().enumerate() {
                near.boxes.entry(near.number(p)).or_default().push(i as u32);
            }
        }
        near
    }

    fn number(&self, p: DVec3) -> IVec3 {
        // Clamped to the range of `i32`: positions beyond are too far from all probes to take shares.
        (p / self.reach).floor().clamp(DVec3::splat(-1e9), DVec3::splat(1e9)).as_ivec3()
    }

    fn around(&self, p: DVec3) -> impl Iterator<Item = u32> + '_ {
        let middle = self.number(p);
        let offsets = (0..27).map(|i| IVec3::new(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1));
        offsets.filter_map(move |o| self.boxes.get(&(middle + o))).flatten().copied()
    }
}

/// The shares of a position in `cell`, by what is seen: weights times visibility, and where little of the cell's weight
/// is left, other probes nearby that see it, the nearer the more. Continuous if visibility is.
pub(crate) fn by_sight(
    cell: &Blend,
    p: DVec3,
    positions: impl Fn(u32) -> DVec3,
    near: &Near,
    visibility: impl Fn(u32) -> f64,
) -> Shares {
    let mut shares = Shares { list: [(0, 0.0); MOST], count: 0 };
    let mut seen = 0.0;
    for (probe, weight) in cell.parts() {
        let visible = weight * visibility(probe);
        seen += visible;
        shares.push(probe, visible + UNSEEN * weight);
    }
    if seen < ENOUGH && near.reach > 0.0 {
        let first = shares.count;
        let mut sum = 0.0;
        for probe in near.around(p) {
            let d2 = positions(probe).distance_squared(p) / (near.reach * near.reach);
            if d2 < 1.0 {
                let weight = visibility(probe) * (1.0 - d2).powi(2) / (d2 + 0.01);
                sum += weight;
                shares.push(probe, weight);
            }
        }
        // `UNSEEN` keeps the shares continuous where no nearby probe sees the position either.
        let scale = (ENOUGH - seen) / (sum + UNSEEN);
        shares.list[first..shares.count].iter_mut().for_each(|(_, weight)| *weight *= scale);
    }
    shares.normalise();
    shares
}
