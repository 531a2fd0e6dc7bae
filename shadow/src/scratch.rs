//! Memory for one batch of receivers on the screens of one light.

use crate::casters::{Casters, Nearby};
use crate::cells::LightCells;
use crate::copies::Keys;
use crate::counts::ShadowCounts;
use crate::grid::LightGrid;
use crate::lit_regions::{LitRegion, LitRegions};
use crate::target::Targets;
use crate::whole_faces::{ByFace, WholeFace};
use crate::{exact, layers};
use glam::DVec3;
use pointillist_micropoint::{Face, VisitMemory};

/// Which side of a face the viewer sees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    Unknown,
    /// Lit, and looked at whole: [`crate::whole_faces`].
    LitWhole,
    Lit,
    Dark,
}

/// Lit and whole area of a receiver.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sum {
    pub(crate) lit: f64,
    pub(crate) total: f64,
}

impl Sum {
    /// Adds the lit fraction of a part, and its weight.
    pub(crate) fn add(&mut self, (fraction, weight): (f64, f64)) {
        self.lit += weight * fraction;
        self.total += weight;
    }

    /// The lit fraction. Fractions within rounding of 0 or 1, which the parts of a receiver on the border of two screens can
    /// add up to, become 0 or 1.
    pub(crate) fn fraction(&self) -> f64 {
        const ROUNDING: f64 = 1e-12;
        let fraction = if self.total > 0.0 { self.lit / self.total } else { 0.0 };
        if fraction < ROUNDING {
            0.0
        } else if fraction > 1.0 - ROUNDING {
            1.0
        } else {
            fraction
        }
    }
}

/// The viewer's faces in the frame of a screen, each made when first needed.
#[derive(Debug, Default)]
pub(crate) struct LitFaces {
    /// Screen and face.
    list: Vec<(usize, Face)>,
    /// The last entry of each of the viewer's faces.
    last_of: Vec<Option<u32>>,
}

impl LitFaces {
    fn clear(&mut self, faces: usize) {
        self.list.clear();
        self.last_of.clear();
        self.last_of.resize(faces, None);
    }

    /// A face in the frame of a screen.
    pub(crate) fn get(&mut self, face: u32, screen: usize, make: impl FnOnce() -> Face) -> &Face {
        let known = self.last_of[face as usize].filter(|&i| self.list[i as usize].0 == screen);
        let index = known.unwrap_or_else(|| {
            let index = self.list.len() as u32;
            self.list.push((screen, make()));
            self.last_of[face as usize] = Some(index);
            index
        });
        &self.list[index as usize].1
    }
}

/// Memory of the occlusion rules.
#[derive(Debug, Default)]
pub(crate) struct RuleMemory {
    pub(crate) exact: exact::Memory,
    pub(crate) layers: layers::Memory,
}

impl RuleMemory {
    /// How many targets were cut since the last call.
    pub(crate) fn take_partial(&mut self) -> u64 {
        std::mem::take(&mut self.exact.partial) + std::mem::take(&mut self.layers.partial)
    }
}

/// Reusable memory of [`ShadowLight::lit`](crate::ShadowLight::lit), one per thread.
#[derive(Debug, Default)]
pub struct ShadowScratch {
    pub(crate) counts: ShadowCounts,
    pub(crate) sides: Vec<Side>,
    pub(crate) targets: Targets,
    pub(crate) by_face: ByFace,
    /// The face at hand, and the receiver at hand of it.
    pub(crate) whole_face: WholeFace,
    pub(crate) single: Targets,
    /// Corners of the receiver at hand, in the frame of a lens.
    pub(crate) local: Vec<DVec3>,
    pub(crate) lit_faces: LitFaces,
    pub(crate) sums: Vec<Sum>,
    pub(crate) grid: LightGrid,
    pub(crate) casters: Casters,
    pub(crate) copy_keys: Keys,
    pub(crate) visit: VisitMemory,
    pub(crate) nearby: Vec<Nearby>,
    pub(crate) rules: RuleMemory,
    pub(crate) lit_regions: LitRegions,
}

impl ShadowScratch {
    /// What has been done since the last call.
    #[must_use]
    pub fn take_counts(&mut self) -> ShadowCounts {
        std::mem::take(&mut self.counts)
    }

    /// Where the light of the last call of [`ShadowLight::lit`](crate::ShadowLight::lit) reached a receiver that was added by
    /// [`Receivers::push_with_regions`](crate::Receivers::push_with_regions). Nothing for one that is evenly lit, such as wholly lit or
    /// wholly dark or as a mask before all of it lets pass, on a face that the viewer sees edge-on (its plane passes the eye at 1e-9 of its distance or less), and under
    /// [`Occlusion::Paper`](pointillist_micropoint::Occlusion::Paper), which knows fractions only.
    pub fn lit_regions(&self, receiver: u32) -> impl Iterator<Item = LitRegion<'_>> {
        self.lit_regions.of(receiver)
    }

    pub(crate) fn begin(&mut self, receivers: usize, faces: usize, light_cells: Option<LightCells>) {
        self.sides.clear();
        self.sides.resize(faces, Side::Unknown);
        self.lit_faces.clear(faces);
        self.targets.clear(light_cells);
        self.by_face.begin(faces, receivers);
        self.sums.clear();
        self.sums.resize(receivers, Sum::default());
        self.lit_regions.clear();
    }
}
