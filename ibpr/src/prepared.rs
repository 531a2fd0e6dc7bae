//! One scan made ready to be drawn, whatever other scans are drawn with it.

use crate::cone::{self, Cone};
use crate::order::{Lattice, in_order};
use crate::parallel::*;
use crate::scan::{Scan, unit};
use crate::spacing;
use glam::{DVec3, Vec3};
use std::cmp::Ordering;
use std::ops::Range;

/// Points per block: few enough to lie close together, many enough that the cost per block is negligible.
pub(crate) const BLOCK: usize = 1024;

/// Points of one scan that lie close together.
#[derive(Clone, Debug)]
pub(crate) struct Block {
    /// Its range in the arrays of its scan, and in those of the cloud once it is part of one.
    pub(crate) points: Range<usize>,
    pub(crate) origin: DVec3,
    /// World units per unit of its offsets: a power of 2 near the extent of its scan, so that `f32` never over- or
    /// underflows whatever the units of the scan.
    pub(crate) unit: f64,
    /// Half the sides of the box about `origin`, in units.
    pub(crate) half: Vec3,
    /// A cone that holds all normals, if they are known.
    pub(crate) cone: Option<Cone>,
    /// Unit, in the world.
    pub(crate) towards_scanner: Option<DVec3>,
}

/// A scan as blocks in Morton order, with positions relative to their block: the same for every order of its points.
#[derive(Clone, Debug)]
pub(crate) struct Prepared {
    pub(crate) blocks: Vec<Block>,
    /// Coordinates relative to the origin of their block, in its units.
    pub(crate) offsets: [Vec<f32>; 3],
    /// Linear RGB, if the scan has colors.
    pub(crate) colors: Option<Vec<[f32; 3]>>,
    /// From 0 to 1, if the scan has opacities.
    pub(crate) opacities: Option<Vec<f32>>,
    pub(crate) low: DVec3,
    pub(crate) high: DVec3,
    /// Of its points, in world units; 0 if it has no two places.
    pub(crate) spacing: f64,
}

impl Prepared {
    /// Of a scan that was checked and has points.
    pub(crate) fn new(scan: &Scan<'_>) -> Self {
        let lattice = Lattice::around(scan.positions.iter());
        let order = in_order(scan, &lattice);
        let spacing = spacing::of_scan(scan, &order);
        let unit = if lattice.extent > 0.0 { lattice.extent.log2().floor().exp2() } else { 1.0 };
        let mut prepared = Self {
            blocks: Vec::with_capacity(order.len().div_ceil(BLOCK)),
            offsets: [0; 3].map(|_| Vec::with_capacity(order.len())),
            colors: scan.colors.map(|colors| order.iter().map(|&i| colors[i as usize]).collect()),
            opacities: scan.opacities.map(|all| order.iter().map(|&i| all[i as usize]).collect()),
            low: lattice.low,
            high: lattice.high,
            spacing,
        };
        for indices in order.chunks(BLOCK) {
            prepared.add_block(scan, indices, unit);
        }
        prepared.find_cones(spacing / unit);
        prepared
    }

    fn add_block(&mut self, scan: &Scan<'_>, indices: &[u32], unit_length: f64) {
        let position = |i: &u32| scan.positions[*i as usize];
        let bounds = Lattice::around(indices.iter().map(|i| &scan.positions[*i as usize]));
        let origin = bounds.centre();
        let start = self.offsets[0].len();
        for i in indices {
            let offset = ((position(i) - origin) / unit_length).as_vec3();
            for (axis, value) in self.offsets.iter_mut().zip(offset.to_array()) {
                axis.push(value);
            }
        }
        // Rounded up: the box must hold the rounded offsets.
        let half = (0.5 / unit_length * (bounds.high - bounds.low)).as_vec3() * (1.0 + 4.0 * f32::EPSILON);
        self.blocks.push(Block {
            points: start..start + indices.len(),
            origin,
            unit: unit_length,
            half,
            cone: None,
            towards_scanner: scan.towards_scanner.and_then(unit),
        });
    }

    /// `spacing` is in units.
    fn find_cones(&mut self, spacing: f64) {
        let offsets = &self.offsets;
        chunks(&mut self.blocks, 1).for_each(|blocks| {
            for block in blocks {
                let of_block = |axis: usize| &offsets[axis][block.points.clone()];
                let points = [of_block(0), of_block(1), of_block(2)];
                block.cone =
                    block.towards_scanner.and_then(|d| cone::of_points(points, spacing, d.as_vec3()));
            }
        });
    }

    pub(crate) fn view(&self) -> PartView<'_> {
        PartView {
            blocks: &self.blocks,
            offsets: self.offsets.each_ref().map(Vec::as_slice),
            colors: self.colors.as_deref(),
            opacities: self.opacities.as_deref(),
            spacing: self.spacing,
        }
    }
}

/// All that a scan's part of a picture depends on.
#[derive(Clone, Copy)]
pub(crate) struct PartView<'a> {
    pub(crate) blocks: &'a [Block],
    pub(crate) offsets: [&'a [f32]; 3],
    pub(crate) colors: Option<&'a [[f32; 3]]>,
    pub(crate) opacities: Option<&'a [f32]>,
    pub(crate) spacing: f64,
}

impl<'a> PartView<'a> {
    /// An order of scans that does not depend on the order in which they came.
    pub(crate) fn compare(self, other: Self) -> Ordering {
        let count = |part: Self| (part.offsets[0].len(), part.colors.is_some(), part.opacities.is_some());
        let values = self.values().zip(other.values());
        count(self)
            .cmp(&count(other))
            .then_with(|| values.map(|(a, b)| a.total_cmp(&b)).find(|o| o.is_ne()).unwrap_or(Ordering::Equal))
    }

    /// All of its numbers; as many as those of any other part with as many points and the same attributes.
    fn values(self) -> impl Iterator<Item = f64> + 'a {
        let of_block = |block: &Block| {
            let towards = block.towards_scanner.unwrap_or_default();
            [block.origin, block.half.as_dvec3() * block.unit, towards].map(|v| v.to_array()).concat()
        };
        let blocks = self.blocks.iter().flat_map(of_block);
        let floats = self.offsets.into_iter().flatten();
        let floats = floats.chain(self.colors.into_iter().flatten().flatten());
        let floats = floats.chain(self.opacities.into_iter().flatten());
        blocks.chain([self.spacing]).chain(floats.map(|value| f64::from(*value)))
    }
}
