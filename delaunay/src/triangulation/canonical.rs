//! The cells in an order that depends on the points alone.
//!
//! Vertices are ranked along a Hilbert curve, so that vertices near in space are near in memory. A cell's corners start
//! with the one of least rank, then that of least rank that an even permutation can put second; cells are sorted by the
//! ranks of their corners. The triangles of a plane are sorted as they are reported, counterclockwise: on which side of
//! the plane the apex lies depends on what was there before.

use super::cell::{CellId, Vertex};
use super::hilbert::Curve;
use super::solid::Solid;
use crate::{OUTSIDE, Partition, Tetrahedra, Triangles, parallel};

/// Even permutations of the four corners: those that put corner k first, turned three ways.
const EVEN: [[[usize; 4]; 3]; 4] = [
    [[0, 1, 2, 3], [0, 2, 3, 1], [0, 3, 1, 2]],
    [[1, 0, 3, 2], [1, 3, 2, 0], [1, 2, 0, 3]],
    [[2, 0, 1, 3], [2, 1, 3, 0], [2, 3, 0, 1]],
    [[3, 0, 2, 1], [3, 2, 1, 0], [3, 1, 0, 2]],
];

/// Which corner goes in each place; the last two change places if `flip` is set.
fn corner_order(ranks: [u32; 4], flip: bool) -> [usize; 4] {
    let least =
        |of: &mut dyn Iterator<Item = usize>| of.min_by_key(|&k| ranks[k]).expect("cells have corners");
    let first = least(&mut (0..4));
    let second = least(&mut (0..4).filter(|&k| k != first));
    let turned = EVEN[first].iter().find(|order| order[1] == second);
    let [a, b, c, d] = *turned.expect("every corner comes second in one of the turns");
    if flip { [a, b, d, c] } else { [a, b, c, d] }
}

/// Whether the triangles under an apex are clockwise, seen from it.
fn is_flipped(solid: &Solid) -> bool {
    solid.apex.is_some_and(|apex| {
        let mut cells = solid.mesh.live().filter(|(_, cell)| cell.is_finite());
        let (_, cell) = cells.next().expect("a mesh has tetrahedra");
        let k = cell.corners.iter().position(|&v| v == apex).expect("all tetrahedra have the apex");
        let [_, a, b, c] = EVEN[k][0].map(|k| solid.index[cell.corners[k].slot()]);
        !solid.is_counterclockwise([a, b, c])
    })
}

/// The cells of a mesh, sorted.
struct Sorted<'a> {
    solid: &'a Solid,
    /// By vertex.
    ranks: Vec<u32>,
    /// Finite cells in their final order.
    order: Vec<CellId>,
    /// Place in `order`, by cell; [`OUTSIDE`] for ghosts.
    places: Vec<u32>,
    /// See [`is_flipped`].
    flip: bool,
}

/// Runs of cells that are sorted together, by one thread.
const PART: usize = 4096;

/// What windows of one more than [`PART`] leave over.
fn last_part(starts: &[u32]) -> &[u32] {
    &starts[(starts.len() - 1) / PART * PART..]
}

/// Ranks along the curve, from 1. The apex, if there is one, is 0: it comes first in its cells.
fn ranks(solid: &Solid) -> Vec<u32> {
    let vertices: Vec<Vertex> =
        (0..).map(Vertex).zip(&solid.index).filter(|(_, i)| **i != OUTSIDE).map(|(v, _)| v).collect();
    // Scaled positions may have come together: the scale is that of all points there ever were.
    let position = |v: Vertex| solid.sites.exact_position(v);
    let curve = Curve::new(vertices.iter().map(|&v| position(v)));
    let mut keyed = parallel::map(vertices.len(), |k| (curve.index(position(vertices[k])), vertices[k]));
    parallel::sort_by(&mut keyed, |(p, v), (q, w)| p.cmp(q).then_with(|| solid.sites.compare(*v, *w)));
    let mut ranks = vec![0; solid.index.len()];
    for (rank, (_, v)) in (1..).zip(keyed) {
        ranks[v.slot()] = rank;
    }
    ranks
}

impl<'a> Sorted<'a> {
    fn new(solid: &'a Solid) -> Self {
        let ranks = ranks(solid);
        let places = vec![OUTSIDE; solid.mesh.cells.len()];
        let mut sorted = Self { solid, ranks, order: vec![], places, flip: is_flipped(solid) };
        let starts = sorted.sort_by_first_corner();
        sorted.sort_runs(&starts);
        for (place, id) in (0..).zip(&sorted.order) {
            sorted.places[id.slot()] = place;
        }
        sorted
    }

    /// Sorts the cells that have their first corner in common, from each start to the next. Most are few.
    fn sort_runs(&mut self, starts: &[u32]) {
        let mut order = std::mem::take(&mut self.order);
        let (mut left, mut parts) = (order.as_mut_slice(), vec![]);
        for part in starts.windows(PART + 1).step_by(PART).map(|w| &w[..=PART]).chain([last_part(starts)]) {
            let (these, rest) = left.split_at_mut((part[part.len() - 1] - part[0]) as usize);
            parts.push((these, part));
            left = rest;
        }
        parallel::for_each_mut(&mut parts, |(cells, starts)| {
            let mut run = vec![];
            for bounds in starts.windows(2) {
                let cells = &mut cells[(bounds[0] - starts[0]) as usize..(bounds[1] - starts[0]) as usize];
                run.clear();
                run.extend(cells.iter().map(|&id| (self.ranked(id), id)));
                run.sort_unstable_by_key(|(ranks, _)| *ranks);
                cells.iter_mut().zip(&run).for_each(|(cell, (_, id))| *cell = *id);
            }
        });
        self.order = order;
    }

    /// Counting sort by the least rank of a corner. Returns where the cells of each begin, and where the last end.
    fn sort_by_first_corner(&mut self) -> Vec<u32> {
        let cells = &self.solid.mesh.cells;
        let firsts = parallel::map(cells.len(), |k| {
            let [a, b, c, d] = cells[k].corners.map(|v| self.ranks[v.slot()]);
            if cells[k].is_finite() { a.min(b).min(c).min(d) } else { OUTSIDE }
        });
        let mut starts = vec![0u32; self.ranks.len() + 1];
        firsts.iter().filter(|f| **f != OUTSIDE).for_each(|&rank| starts[rank as usize + 1] += 1);
        (1..starts.len()).for_each(|i| starts[i] += starts[i - 1]);
        self.order = vec![CellId(0); starts[starts.len() - 1] as usize];
        let mut next = starts.clone();
        for (id, first) in (0..).map(CellId).zip(&firsts).filter(|(_, f)| **f != OUTSIDE) {
            let at = &mut next[*first as usize];
            self.order[*at as usize] = id;
            *at += 1;
        }
        starts
    }

    /// Ranks of a cell's corners, in the order in which they are reported.
    fn ranked(&self, id: CellId) -> [u32; 4] {
        let ranks = self.solid.mesh.cell(id).corners.map(|v| self.ranks[v.slot()]);
        corner_order(ranks, self.flip).map(|k| ranks[k])
    }

    /// Corners and neighbours of the cell at a place.
    fn cell(&self, place: usize) -> ([u32; 4], [u32; 4]) {
        let cell = self.solid.mesh.cell(self.order[place]);
        let order = corner_order(cell.corners.map(|v| self.ranks[v.slot()]), self.flip);
        let corners = order.map(|k| self.solid.index[cell.corners[k].slot()]);
        let neighbours = order.map(|k| self.places[cell.links[k].cell().slot()]);
        (corners, neighbours)
    }
}

/// All cells of a mesh.
pub(super) fn partition(solid: &Solid) -> Partition {
    let sorted = Sorted::new(solid);
    let (corners, neighbours) = parallel::map_pairs(sorted.order.len(), |place| sorted.cell(place));
    let Some(_) = solid.apex else { return Partition::Tetrahedra(Tetrahedra { corners, neighbours }) };
    // The apex comes first.
    let strip = |list: Vec<[u32; 4]>| list.into_iter().map(|[_, a, b, c]| [a, b, c]).collect();
    Partition::Triangles(Triangles { corners: strip(corners), neighbours: strip(neighbours) })
}
