//! Scans prepared once, to be drawn from any view; more may come and go between frames.

use crate::error::IbprError;
use crate::occupied::Occupied;
use crate::options::check_base;
use crate::prepared::{Block, PartView, Prepared};
use crate::scan::Scan;
use crate::spacing;
use glam::{DVec3, Vec3};
use std::ops::Range;

/// Most points of a cloud.
const MOST_POINTS: usize = u32::MAX as usize;

/// A scan of a [`Cloud`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ScanId(u64);

/// A scan's part of the cloud's arrays.
#[derive(Clone, Copy, Debug)]
struct Part {
    id: ScanId,
    blocks: usize,
    points: usize,
    is_colored: bool,
    has_opacities: bool,
    low: DVec3,
    high: DVec3,
    spacing: f64,
}

/// Several scans as blocks in Morton order, with positions relative to their block.
///
/// The same for every order of scans and of points in them, and however it came to hold them.
#[derive(Clone, Debug)]
pub struct Cloud {
    /// In an order that does not depend on the order in which they came.
    parts: Vec<Part>,
    pub(crate) blocks: Vec<Block>,
    /// World units per unit of a frame's depths: a power of 2 near the extent, so that `f32` never over- or underflows.
    pub(crate) unit: f64,
    /// Coordinates relative to the origin of their block, in its units.
    pub(crate) offsets: [Vec<f32>; 3],
    /// Linear RGB, or empty.
    pub(crate) colors: Vec<[f32; 3]>,
    /// From 0 to 1, or empty: all opaque.
    opacities: Vec<f32>,
    /// Color of points without one beside points with one.
    base: [f32; 3],
    occupied: Occupied,
    low: DVec3,
    high: DVec3,
    spacing: f64,
    density: f64,
    next_id: u64,
}

impl Cloud {
    /// Sorts the points of `scans`, measures their spacing and finds where their surfaces face.
    ///
    /// Takes about 0.3 µs per point; holds 12 bytes per point, 24 with color, 4 more with opacity. Points of
    /// scans without color get `base` if other scans have colors, those without opacity are opaque.
    ///
    /// # Errors
    /// [`IbprError::NoPoints`], [`IbprError::PointNotFinite`], [`IbprError::PointTooFar`], [`IbprError::BadColor`],
    /// [`IbprError::BadOpacity`], [`IbprError::OpacityCount`],
    /// [`IbprError::LengthMismatch`], [`IbprError::BadSpacing`], [`IbprError::BadDirection`],
    /// [`IbprError::TooManyPoints`]; [`IbprError::BadOption`] if a channel of `base` is not from 0 to
    /// [`Scan::BRIGHTEST`].
    pub fn new(scans: &[Scan<'_>], base: Vec3) -> Result<Self, IbprError> {
        check_base(base)?;
        // Scans may be the same slice several times, so the total may exceed memory and, on 32-bit targets, the range
        // of `usize`.
        check_count(scans.iter().fold(0_usize, |sum, scan| sum.saturating_add(scan.positions.len())))?;
        for (i, scan) in scans.iter().enumerate() {
            scan.check(i)?;
        }
        let with_points = scans.iter().enumerate().filter(|(_, scan)| !scan.positions.is_empty());
        let mut prepared: Vec<(u64, Prepared)> =
            with_points.map(|(i, scan)| (i as u64, Prepared::new(scan))).collect();
        if prepared.is_empty() {
            return Err(IbprError::NoPoints);
        }
        prepared.sort_by(|a, b| a.1.view().compare(b.1.view()));
        let mut cloud = Self::empty(base, scans.len() as u64);
        if prepared.len() > 1 {
            cloud.reserve(&prepared);
        }
        for (id, scan) in prepared {
            cloud.insert(cloud.parts.len(), ScanId(id), scan);
        }
        cloud.measure(|_| {});
        Ok(cloud)
    }

    /// Makes room for scans, once, so that arrays are as long as they have to be.
    fn reserve(&mut self, scans: &[(u64, Prepared)]) {
        let points = scans.iter().map(|(_, scan)| scan.offsets[0].len()).sum();
        self.offsets.iter_mut().for_each(|axis| axis.reserve_exact(points));
        if scans.iter().any(|(_, scan)| scan.colors.is_some()) {
            self.colors.reserve_exact(points);
        }
        if scans.iter().any(|(_, scan)| scan.opacities.is_some()) {
            self.opacities.reserve_exact(points);
        }
    }

    fn empty(base: Vec3, next_id: u64) -> Self {
        Self {
            parts: vec![],
            blocks: vec![],
            unit: 1.0,
            offsets: [vec![], vec![], vec![]],
            colors: vec![],
            opacities: vec![],
            base: base.to_array(),
            occupied: Occupied::default(),
            low: DVec3::ZERO,
            high: DVec3::ZERO,
            spacing: 0.0,
            density: 0.0,
            next_id,
        }
    }

    /// Adds a scan. Takes what it takes to prepare that scan alone, and a copy of the cloud's arrays; frames are then the same, to the bit,
    /// as those of a [`Self::new`] with all scans.
    ///
    /// # Errors
    /// As [`Self::new`], with 0 for the number of the scan; the cloud is then as it was.
    pub fn push(&mut self, scan: &Scan<'_>) -> Result<ScanId, IbprError> {
        scan.check(0)?;
        check_count(self.len().saturating_add(scan.positions.len()))?;
        if scan.positions.is_empty() {
            return Err(IbprError::NoPoints);
        }
        let prepared = Prepared::new(scan);
        let is_before = |index: &usize| self.view(*index).compare(prepared.view()).is_lt();
        let place = (0..self.parts.len()).take_while(is_before).count();
        let id = ScanId(self.next_id);
        self.next_id += 1;
        self.insert(place, id, prepared);
        let cells = self.occupied.cells_of(self.positions_of(place));
        self.measure(|occupied| occupied.add(&cells));
        Ok(id)
    }

    /// Removes a scan; frames are then as if it had never been there.
    ///
    /// # Errors
    /// [`IbprError::UnknownScan`]; [`IbprError::NoPoints`] for the last scan, which stays.
    pub fn remove(&mut self, id: ScanId) -> Result<(), IbprError> {
        let place = self.parts.iter().position(|part| part.id == id).ok_or(IbprError::UnknownScan)?;
        if self.parts.len() == 1 {
            return Err(IbprError::NoPoints);
        }
        let cells = self.occupied.cells_of(self.positions_of(place));
        self.cut_out(place);
        self.measure(|occupied| occupied.remove(&cells));
        Ok(())
    }

    /// The scans that it holds, in the order in which they came: those that [`Self::new`] was given, but for empty ones, then those that
    /// were added.
    #[must_use]
    pub fn scans(&self) -> Vec<ScanId> {
        let mut scans: Vec<ScanId> = self.parts.iter().map(|part| part.id).collect();
        scans.sort_unstable();
        scans
    }

    /// Where the blocks and the points of a part are.
    fn ranges(&self, place: usize) -> (Range<usize>, Range<usize>) {
        let before = &self.parts[..place];
        let block = before.iter().map(|part| part.blocks).sum();
        let point = before.iter().map(|part| part.points).sum();
        match self.parts.get(place) {
            Some(part) => (block..block + part.blocks, point..point + part.points),
            None => (block..block, point..point),
        }
    }

    fn view(&self, place: usize) -> PartView<'_> {
        let part = &self.parts[place];
        let (blocks, points) = self.ranges(place);
        PartView {
            blocks: &self.blocks[blocks],
            offsets: self.offsets.each_ref().map(|axis| &axis[points.clone()]),
            colors: part.is_colored.then(|| &self.colors[points.clone()]),
            opacities: part.has_opacities.then(|| &self.opacities[points.clone()]),
            spacing: part.spacing,
        }
    }

    fn positions_of(&self, place: usize) -> impl Iterator<Item = DVec3> + '_ {
        let (blocks, _) = self.ranges(place);
        self.blocks[blocks].iter().flat_map(|block| self.positions_in(block))
    }

    fn positions_in(&self, block: &Block) -> impl Iterator<Item = DVec3> + '_ {
        let ([x, y, z], origin, unit) = (&self.offsets, block.origin, block.unit);
        let of = |i: usize| DVec3::new(f64::from(x[i]), f64::from(y[i]), f64::from(z[i]));
        block.points.clone().map(move |i| origin + of(i) * unit)
    }

    /// Puts a scan before the part at `place`.
    fn insert(&mut self, place: usize, id: ScanId, scan: Prepared) {
        let (blocks, points) = self.ranges(place);
        let (at, count, before) = (points.start, scan.offsets[0].len(), self.len());
        let part = Part {
            id,
            blocks: scan.blocks.len(),
            points: count,
            is_colored: scan.colors.is_some(),
            has_opacities: scan.opacities.is_some(),
            low: scan.low,
            high: scan.high,
            spacing: scan.spacing,
        };
        self.blocks[blocks.start..].iter_mut().for_each(|block| shift(block, count as isize));
        self.blocks.splice(blocks.start..blocks.start, scan.blocks);
        self.blocks[blocks.start..][..part.blocks].iter_mut().for_each(|block| shift(block, at as isize));
        for (axis, new) in self.offsets.iter_mut().zip(scan.offsets) {
            join(axis, at, new);
        }
        insert_attribute(&mut self.colors, (before, at, count), scan.colors, self.base);
        insert_attribute(&mut self.opacities, (before, at, count), scan.opacities, 1.0);
        self.parts.insert(place, part);
    }

    fn cut_out(&mut self, place: usize) {
        let (blocks, points) = self.ranges(place);
        self.blocks[blocks.end..].iter_mut().for_each(|block| shift(block, -(points.len() as isize)));
        self.blocks.drain(blocks);
        for axis in &mut self.offsets {
            axis.drain(points.clone());
        }
        self.parts.remove(place);
        if self.parts.iter().any(|part| part.is_colored) {
            self.colors.drain(points.clone());
        } else {
            self.colors.clear();
        }
        if self.parts.iter().any(|part| part.has_opacities) {
            self.opacities.drain(points);
        } else {
            self.opacities.clear();
        }
    }

    /// Finds what depends on all scans. `change` brings the cells up to date; if their size changes, they are found anew.
    fn measure(&mut self, change: impl FnOnce(&mut Occupied)) {
        let corner = |pick: fn(&Part) -> DVec3, join: fn(DVec3, DVec3) -> DVec3| {
            self.parts.iter().map(pick).reduce(join).unwrap_or_default()
        };
        (self.low, self.high) = (corner(|part| part.low, DVec3::min), corner(|part| part.high, DVec3::max));
        let extent = (self.high - self.low).max_element();
        self.unit = if extent > 0.0 { extent.log2().floor().exp2() } else { 1.0 };
        self.spacing = spacing::typical(self.parts.iter().map(|part| (part.spacing, part.points)));
        if self.occupied.suits(self.spacing) {
            change(&mut self.occupied);
        } else {
            let mut occupied = Occupied::for_spacing(self.spacing);
            for place in 0..self.parts.len() {
                let cells = occupied.cells_of(self.positions_of(place));
                occupied.add(&cells);
            }
            self.occupied = occupied;
        }
        let is_spread = self.spacing > 0.0 && extent > self.spacing;
        self.density = if is_spread { self.occupied.spacing(self.len()) } else { self.spacing };
    }

    /// Number of points.
    #[must_use]
    #[expect(clippy::len_without_is_empty, reason = "a cloud is never empty")]
    pub fn len(&self) -> usize {
        self.offsets[0].len()
    }

    /// All points in the world, in the cloud's order, as they were stored: to about 1e-7 of the extent of their scan.
    pub fn positions(&self) -> impl Iterator<Item = DVec3> + '_ {
        self.blocks.iter().flat_map(|block| self.positions_in(block))
    }

    /// Whether any scan brought colors.
    #[must_use]
    pub fn has_colors(&self) -> bool {
        !self.colors.is_empty()
    }

    /// Whether any scan brought opacities.
    #[must_use]
    pub fn has_opacities(&self) -> bool {
        !self.opacities.is_empty()
    }

    /// Linear RGB of a point times its opacity, and the opacity; black without colors.
    pub(crate) fn premultiplied(&self, point: usize) -> [f32; 4] {
        let opacity = self.opacities.get(point).copied().unwrap_or(1.0);
        let [r, g, b] = self.colors.get(point).copied().unwrap_or_default();
        [r * opacity, g * opacity, b * opacity, opacity]
    }

    /// Lower and upper corner of the box around all points.
    #[must_use]
    pub fn bounds(&self) -> (DVec3, DVec3) {
        (self.low, self.high)
    }

    /// Typical distance between neighbours of one scan, in world units: what γ is counted in.
    #[must_use]
    pub fn spacing(&self) -> f64 {
        self.spacing
    }

    /// Distance between neighbours when all scans are laid over one another, in world units.
    #[must_use]
    pub fn density_spacing(&self) -> f64 {
        self.density
    }

    /// How many blocks of points there are.
    #[must_use]
    pub fn block_count(&self) -> usize {
        self.blocks.len()
    }
}

fn check_count(count: usize) -> Result<(), IbprError> {
    let limit = MOST_POINTS;
    if count <= limit { Ok(()) } else { Err(IbprError::TooManyPoints { count, limit }) }
}

fn shift(block: &mut Block, points: isize) {
    let moved = |at: usize| at.wrapping_add_signed(points);
    block.points = moved(block.points.start)..moved(block.points.end);
}

/// Puts values into an array at a place; takes them over where there is no array yet.
fn join<T: Copy>(all: &mut Vec<T>, at: usize, new: Vec<T>) {
    if all.capacity() == 0 {
        *all = new;
    } else {
        drop(all.splice(at..at, new));
    }
}

/// Puts a scan's attribute among those of the `before` points, at a place; points without one have `usual` if others have one.
fn insert_attribute<T: Copy>(
    all: &mut Vec<T>,
    (before, at, count): (usize, usize, usize),
    new: Option<Vec<T>>,
    usual: T,
) {
    if all.is_empty() && new.is_some() {
        all.resize(before, usual);
    }
    if new.is_some() || !all.is_empty() {
        join(all, at, new.unwrap_or_else(|| vec![usual; count]));
    }
}
