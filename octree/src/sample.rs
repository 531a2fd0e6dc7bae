//! Which points a node takes from its children.

use crate::key::NodeKey;

/// Cells of a node along a side, as a power of two: 128, so that a node that a plane crosses has 16 thousand points and more.
pub(crate) const GRID_BITS: u32 = 7;

/// The deepest level of a tree that is built: cells of a node are then cells of the lattice.
pub(crate) const DEEPEST: u8 = (32 - GRID_BITS) as u8;

/// Stands for no candidate.
const NONE: u32 = u32::MAX;

/// The three numbers at the start of a record.
pub(crate) fn cell_of(record: &[u8]) -> [u32; 3] {
    [0, 4, 8].map(|at| u32::from_le_bytes([record[at], record[at + 1], record[at + 2], record[at + 3]]))
}

/// Chooses from the points of children those that their parent gets.
#[derive(Debug)]
pub(crate) struct Sampler {
    stride: usize,
    /// For each cell of the node, the candidate that is best so far.
    best: Vec<u32>,
    /// Cells that have one.
    touched: Vec<u32>,
}

impl Sampler {
    pub(crate) fn new(stride: usize) -> Self {
        Self { stride, best: vec![NONE; 1 << (3 * GRID_BITS)], touched: vec![] }
    }

    /// Moves one point of each cell of `parent` that has any out of its children into the result: the one nearest to the middle of the cell, and of
    /// equally near ones that with the lowest bytes, so that the order of points does not matter. What is left keeps its order.
    pub(crate) fn sample(&mut self, parent: NodeKey, children: &mut [Vec<u8>]) -> Vec<u8> {
        let all: Vec<(usize, usize)> = children
            .iter()
            .enumerate()
            .flat_map(|(child, records)| (0..records.len() / self.stride).map(move |at| (child, at)))
            .collect();
        let stride = self.stride;
        let record = |number: u32, children: &[Vec<u8>]| {
            let (child, at) = all[number as usize];
            children[child][at * stride..][..stride].to_vec()
        };
        let shift = 32 - u32::from(parent.level) - GRID_BITS;
        for (number, &(child, at)) in all.iter().enumerate() {
            let own = &children[child][at * stride..][..stride];
            let (cell, distance) = in_grid(cell_of(own), shift);
            let best = self.best[cell as usize];
            if best == NONE {
                self.touched.push(cell);
            }
            let is_better = best == NONE || {
                let (child, at) = all[best as usize];
                let other = &children[child][at * stride..][..stride];
                (distance, own) < (in_grid(cell_of(other), shift).1, other)
            };
            if is_better {
                self.best[cell as usize] = number as u32;
            }
        }
        let mut chosen: Vec<u32> = self
            .touched
            .drain(..)
            .map(|cell| std::mem::replace(&mut self.best[cell as usize], NONE))
            .collect();
        chosen.sort_unstable();
        let sample = chosen.iter().flat_map(|&number| record(number, children)).collect();
        let mut chosen = chosen.into_iter().map(|number| all[number as usize]).peekable();
        for (child, records) in children.iter_mut().enumerate() {
            let mut kept = 0;
            for at in 0..records.len() / stride {
                if chosen.next_if_eq(&(child, at)).is_some() {
                    continue;
                }
                records.copy_within(at * stride..(at + 1) * stride, kept);
                kept += stride;
            }
            records.truncate(kept);
        }
        sample
    }
}

/// The number of a cell of a node's grid, whose cells have 2^`shift` lattice cells a side, and the squared distance from its middle, in quarters.
fn in_grid(cell: [u32; 3], shift: u32) -> (u32, u64) {
    let mask = (1u32 << GRID_BITS) - 1;
    let [x, y, z] = cell.map(|c| c >> shift & mask);
    let middle = (1u64 << shift) - 1;
    let off = cell.map(|c| (2 * (u64::from(c) & ((1 << shift) - 1))).abs_diff(middle));
    (x | y << GRID_BITS | z << (2 * GRID_BITS), off.iter().map(|o| o * o).sum())
}
