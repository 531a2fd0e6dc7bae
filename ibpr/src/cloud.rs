//! Scans prepared once, to be drawn from any view.

use crate::cone::{self, Cone};
use crate::error::IbprError;
use crate::options::check_base;
use crate::order::{Lattice, in_order};
use crate::parallel::*;
use crate::scan::{Scan, unit};
use crate::spacing;
use glam::{DVec3, Vec3};
use std::ops::Range;

/// Points per block: few enough to lie close together, many enough that the cost per block is negligible.
pub(crate) const BLOCK: usize = 1024;

/// Points of one scan that lie close together.
#[derive(Clone, Debug)]
pub(crate) struct Block {
    /// Its range in the cloud's arrays.
    pub(crate) points: Range<usize>,
    pub(crate) origin: DVec3,
    /// Half the sides of the box about `origin`, in units.
    pub(crate) half: Vec3,
    /// A cone that holds all normals, if they are known.
    pub(crate) cone: Option<Cone>,
    /// Unit, in the world.
    pub(crate) towards_scanner: Option<DVec3>,
}

/// Several scans as blocks in Morton order, with positions relative to their block.
///
/// The same for every order of scans and of points in them.
#[derive(Clone, Debug)]
pub struct Cloud {
    pub(crate) blocks: Vec<Block>,
    /// World units per unit of offsets: a power of 2 near the extent, so that `f32` never over- or
    /// underflows whatever the units of the scan.
    pub(crate) unit: f64,
    /// Coordinates relative to the origin of their block, in units.
    pub(crate) offsets: [Vec<f32>; 3],
    /// Linear RGB, or empty.
    pub(crate) colors: Vec<[f32; 3]>,
    /// From 0 to 1, or empty: all opaque.
    opacities: Vec<f32>,
    low: DVec3,
    high: DVec3,
    spacing: f64,
    density: f64,
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
        let add = |sum: usize, scan: &Scan<'_>| sum.checked_add(scan.positions.len());
        let limit = u32::MAX as usize;
        // Scans may be the same slice several times, so the total may exceed memory and, on 32-bit targets, the range
        // of `usize`.
        let Some(points) = scans.iter().try_fold(0, add).filter(|&points| points <= limit) else {
            let count = scans.iter().fold(0_usize, |sum, s| sum.saturating_add(s.positions.len()));
            return Err(IbprError::TooManyPoints { count, limit });
        };
        for (i, scan) in scans.iter().enumerate() {
            scan.check(i)?;
        }
        if points == 0 {
            return Err(IbprError::NoPoints);
        }
        let lattice = Lattice::around(scans.iter().flat_map(|s| s.positions));
        let ordered = in_order(scans, &lattice);
        let spacings: Vec<f64> = ordered.iter().map(|o| spacing::of_scan(&scans[o.scan], o)).collect();
        let spacing = spacing::typical(&ordered, &spacings);
        let colored = scans.iter().any(|s| s.colors.is_some());
        let has_opacities = scans.iter().any(|s| s.opacities.is_some());
        let mut cloud = Self {
            blocks: vec![],
            unit: if lattice.extent > 0.0 { lattice.extent.log2().floor().exp2() } else { 1.0 },
            offsets: [0; 3].map(|_| Vec::with_capacity(points)),
            colors: Vec::with_capacity(if colored { points } else { 0 }),
            opacities: Vec::with_capacity(if has_opacities { points } else { 0 }),
            low: lattice.low,
            high: lattice.high,
            spacing,
            density: spacing::of_all(&ordered, &lattice, spacing, points),
        };
        for o in &ordered {
            let scan = &scans[o.scan];
            for indices in o.points.chunks(BLOCK) {
                cloud.add_block(scan, indices);
                if colored {
                    let color = |&i: &u32| scan.colors.map_or(base.to_array(), |c| c[i as usize]);
                    cloud.colors.extend(indices.iter().map(color));
                }
                if has_opacities {
                    let opacity = |&i: &u32| scan.opacities.map_or(1.0, |o| o[i as usize]);
                    cloud.opacities.extend(indices.iter().map(opacity));
                }
            }
        }
        cloud.find_cones();
        Ok(cloud)
    }

    fn find_cones(&mut self) {
        let (spacing, offsets) = (self.spacing / self.unit, &self.offsets);
        chunks(&mut self.blocks, 1).for_each(|blocks| {
            for block in blocks {
                let of_block = |axis: usize| &offsets[axis][block.points.clone()];
                let points = [of_block(0), of_block(1), of_block(2)];
                block.cone =
                    block.towards_scanner.and_then(|d| cone::of_points(points, spacing, d.as_vec3()));
            }
        });
    }

    fn add_block(&mut self, scan: &Scan<'_>, indices: &[u32]) {
        let position = |i: &u32| scan.positions[*i as usize];
        let bounds = Lattice::around(indices.iter().map(|i| &scan.positions[*i as usize]));
        let origin = bounds.centre();
        let start = self.offsets[0].len();
        for i in indices {
            let offset = ((position(i) - origin) / self.unit).as_vec3();
            for (axis, value) in self.offsets.iter_mut().zip(offset.to_array()) {
                axis.push(value);
            }
        }
        let towards_scanner = scan.towards_scanner.and_then(unit);
        let points = start..start + indices.len();
        // Rounded up: the box must hold the rounded offsets.
        let half = (0.5 / self.unit * (bounds.high - bounds.low)).as_vec3() * (1.0 + 4.0 * f32::EPSILON);
        self.blocks.push(Block { points, origin, half, cone: None, towards_scanner });
    }

    /// Number of points.
    #[must_use]
    #[expect(clippy::len_without_is_empty, reason = "a cloud is never empty")]
    pub fn len(&self) -> usize {
        self.offsets[0].len()
    }

    /// All points in the world, in the cloud's order, as they were stored: to about 1e-7 of the extent.
    pub fn positions(&self) -> impl Iterator<Item = DVec3> + '_ {
        let [x, y, z] = &self.offsets;
        self.blocks.iter().flat_map(move |block| {
            let of = |i: usize| DVec3::new(f64::from(x[i]), f64::from(y[i]), f64::from(z[i]));
            block.points.clone().map(move |i| block.origin + of(i) * self.unit)
        })
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
