//! Builds a tree of any number of points in bounded memory.
//!
//! 1. Points come in any order and are put into 8 × 8 × 8 buckets of a temporary file ([`crate::spill`]).
//! 2. A cube whose points fit into memory is divided there, down to leaves of [`LEAF`] points. A larger one is divided into its eight octants, each
//!    made of the buckets in it; and a single bucket that is too large is put into 8 × 8 × 8 smaller ones first.
//! 3. From the leaves up, a node gets an evenly spaced sample of the points of its children ([`crate::sample`]), and these are then complete and
//!    handed out. No more than the eight children of one node on each level wait for that.
//!
//! How much fits into memory decides only where points wait: the tree is the same.

use crate::cube::Cube;
use crate::error::OctreeError;
use crate::key::NodeKey;
use crate::sample::{DEEPEST, GRID_BITS, Sampler, cell_of};
use crate::spill::{Bucket, Spill};
use std::io::{self, Read, Seek, Write};

/// Most points of a leaf.
pub const LEAF: u64 = 20_000;

/// Bytes of a record before its payload: three whole numbers of 32 bits, the lattice cell.
pub const POSITION_BYTES: usize = 12;

/// Levels between a cube and its buckets.
const FAN_LEVELS: u8 = 3;
const FAN: usize = 1 << FAN_LEVELS;

/// What takes finished nodes: the records of each (position, payload), children before the node around them.
pub type NodeSink<'a> = &'a mut dyn FnMut(NodeKey, &[u8]) -> io::Result<()>;

/// Builds a tree; see the module.
#[derive(Debug)]
pub struct Builder<F> {
    cube: Cube,
    stride: usize,
    most_in_memory: u64,
    spill: Spill<F>,
    fan: Vec<Bucket>,
    points: u64,
    record: Vec<u8>,
}

impl<F: Read + Write + Seek> Builder<F> {
    /// Begins a tree of points in `cube`, each with `payload` bytes of the caller's. `spill` is an empty temporary file, and `memory` how many bytes
    /// may be used, about: at least 64 MiB are.
    pub fn new(cube: Cube, payload: usize, memory: u64, spill: F) -> Self {
        let stride = POSITION_BYTES + payload;
        // Points that are divided in memory are there twice.
        let most_in_memory = (memory.max(64 << 20) / 3 / stride as u64).max(2 * LEAF);
        Self {
            cube,
            stride,
            most_in_memory,
            spill: Spill::new(spill, stride),
            fan: vec![Bucket::default(); FAN * FAN * FAN],
            points: 0,
            record: vec![0; stride],
        }
    }

    /// The same with another number of points that are divided in memory: for tests, which have few.
    #[must_use]
    pub fn with_most_in_memory(mut self, points: u64) -> Self {
        self.most_in_memory = points.max(1);
        self
    }

    /// Points so far.
    pub fn points(&self) -> u64 {
        self.points
    }

    /// Distance of points in the root, world units: see [`crate::Tree::new`].
    pub fn spacing(&self) -> f64 {
        self.cube.side / f64::from(1u32 << GRID_BITS)
    }

    /// Takes a point.
    ///
    /// # Errors
    /// [`OctreeError::BadPayload`], [`OctreeError::Outside`]; [`OctreeError::Io`] of the temporary file.
    pub fn push(&mut self, position: glam::DVec3, payload: &[u8]) -> Result<(), OctreeError> {
        let wanted = self.stride - POSITION_BYTES;
        if payload.len() != wanted {
            return Err(OctreeError::BadPayload { length: payload.len(), wanted });
        }
        let (low, high) = (self.cube.low, self.cube.low + self.cube.side);
        // Not `<` or `>`, which NaN passes.
        if !(position.cmpge(low).all() && position.cmple(high).all()) {
            return Err(OctreeError::Outside { position });
        }
        for (bytes, c) in self.record.chunks_exact_mut(4).zip(self.cube.cell(position)) {
            bytes.copy_from_slice(&c.to_le_bytes());
        }
        self.record[POSITION_BYTES..].copy_from_slice(payload);
        let bucket = bucket_of(&self.record, 0);
        self.spill.put(&mut self.fan[bucket], &self.record)?;
        self.points += 1;
        Ok(())
    }

    /// Builds the tree and hands out its nodes. `progress` gets how many points are in place, of [`Builder::points`].
    ///
    /// # Errors
    /// [`OctreeError::TooDense`]; [`OctreeError::Io`] of the temporary file or of `sink`.
    pub fn finish(mut self, sink: NodeSink<'_>, progress: &mut dyn FnMut(u64)) -> Result<(), OctreeError> {
        let fan = std::mem::take(&mut self.fan);
        let mut growth =
            Growth { sampler: Sampler::new(self.stride), builder: &mut self, sink, progress, placed: 0 };
        let root = growth.grow(NodeKey::ROOT, Fan { base: 0, buckets: fan })?;
        if !root.is_empty() {
            (growth.sink)(NodeKey::ROOT, &root)?;
        }
        Ok(())
    }
}

/// The buckets of a cube whose level is `base` that lie in one node.
struct Fan {
    base: u8,
    /// In the order of `bucket_of`; those outside of the node are empty.
    buckets: Vec<Bucket>,
}

/// The bucket of a record among those of a cube of level `base`: octants of three levels, the coarsest in the highest bits.
fn bucket_of(record: &[u8], base: u8) -> usize {
    let cell = cell_of(record);
    (base..base + FAN_LEVELS).fold(0, |bucket, level| bucket << 3 | octant_of(cell, level))
}

/// Which child of a node of this level a lattice cell is in.
fn octant_of(cell: [u32; 3], level: u8) -> usize {
    let bit = |axis: usize| (cell[axis] >> (31 - u32::from(level)) & 1) as usize;
    bit(0) | bit(1) << 1 | bit(2) << 2
}

struct Growth<'a, F> {
    builder: &'a mut Builder<F>,
    sampler: Sampler,
    sink: NodeSink<'a>,
    progress: &'a mut dyn FnMut(u64),
    placed: u64,
}

impl<F: Read + Write + Seek> Growth<'_, F> {
    /// Builds all of a node but its own points, which are the result.
    fn grow(&mut self, key: NodeKey, mut fan: Fan) -> Result<Vec<u8>, OctreeError> {
        let count: u64 = fan.buckets.iter().map(|bucket| bucket.records).sum();
        if count <= self.builder.most_in_memory {
            let mut records = Vec::with_capacity(count as usize * self.builder.stride);
            for bucket in &mut fan.buckets {
                self.builder.spill.take(bucket, |_, bytes| {
                    records.extend_from_slice(bytes);
                    Ok(())
                })?;
            }
            drop(fan);
            let root = self.divide(key, records)?;
            self.placed += count;
            (self.progress)(self.placed);
            return Ok(root);
        }
        if key.level >= DEEPEST - FAN_LEVELS {
            return Err(self.too_dense(key, count));
        }
        if fan.buckets.len() == 1 {
            fan = self.spread(key, fan)?;
        }
        let each = fan.buckets.len() / 8;
        let mut children: Vec<Vec<u8>> = vec![vec![]; 8];
        for (octant, own) in children.iter_mut().enumerate() {
            let buckets =
                fan.buckets[octant * each..(octant + 1) * each].iter_mut().map(std::mem::take).collect();
            let child = key.child(octant).expect("levels above the deepest have children");
            *own = self.grow(child, Fan { base: fan.base, buckets })?;
        }
        self.close(key, children)
    }

    /// Puts the one bucket of a cube into 8 × 8 × 8 of their own.
    fn spread(&mut self, key: NodeKey, mut fan: Fan) -> Result<Fan, OctreeError> {
        let mut buckets = vec![Bucket::default(); FAN * FAN * FAN];
        let stride = self.builder.stride;
        self.builder.spill.take(&mut fan.buckets[0], |spill, bytes| {
            bytes
                .chunks_exact(stride)
                .try_for_each(|record| spill.put(&mut buckets[bucket_of(record, key.level)], record))
        })?;
        Ok(Fan { base: key.level, buckets })
    }

    /// [`Self::grow`] for points in memory.
    fn divide(&mut self, key: NodeKey, mut records: Vec<u8>) -> Result<Vec<u8>, OctreeError> {
        let stride = self.builder.stride;
        let count = (records.len() / stride) as u64;
        if count <= LEAF {
            sort(&mut records, stride);
            return Ok(records);
        }
        if key.level >= DEEPEST {
            return Err(self.too_dense(key, count));
        }
        let mut children: Vec<Vec<u8>> = vec![vec![]; 8];
        let octant = |record: &[u8]| octant_of(cell_of(record), key.level);
        let mut counts = [0; 8];
        records.chunks_exact(stride).for_each(|record| counts[octant(record)] += 1);
        children
            .iter_mut()
            .zip(counts)
            .for_each(|(child, count): (_, usize)| child.reserve_exact(count * stride));
        records.chunks_exact(stride).for_each(|record| children[octant(record)].extend_from_slice(record));
        drop(records);
        for (octant, child) in children.iter_mut().enumerate() {
            let child_key = key.child(octant).expect("levels above the deepest have children");
            *child = self.divide(child_key, std::mem::take(child))?;
        }
        self.close(key, children)
    }

    /// Gives a node its points and hands out its children.
    fn close(&mut self, key: NodeKey, mut children: Vec<Vec<u8>>) -> Result<Vec<u8>, OctreeError> {
        let was_there = children.iter().map(|child| !child.is_empty()).collect::<Vec<_>>();
        let own = self.sampler.sample(key, &mut children);
        for (octant, records) in children.iter().enumerate().filter(|&(octant, _)| was_there[octant]) {
            let child = key.child(octant).expect("it has children");
            // A child without points may be around others: it is handed out, too.
            (self.sink)(child, records)?;
        }
        Ok(own)
    }

    fn too_dense(&self, key: NodeKey, count: u64) -> OctreeError {
        let cube = self.builder.cube.of(key);
        OctreeError::TooDense { count, extent: cube.side, position: cube.low, most: LEAF }
    }
}

/// Sorts records by their bytes, so that their order does not depend on that in which they came.
fn sort(records: &mut [u8], stride: usize) {
    let mut order: Vec<&[u8]> = records.chunks_exact(stride).collect();
    order.sort_unstable();
    let sorted = order.concat();
    records.copy_from_slice(&sorted);
}
