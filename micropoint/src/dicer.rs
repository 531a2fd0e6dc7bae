//! The bucket of cells that one thread finishes: faces diced into parts, nearest first.

use crate::bounds::Bounds;
use crate::face::{DepthRange, Face, GridRect, ProjectedVertex, Setup, TexturedOpacity};
use crate::geometry::{Geometry, HiddenSides, SurfaceOpacity};
use crate::interval::Interval;
use crate::lens::{Lens, LensKind};
use crate::neighbours::{self, Neighbours, THINNEST};
use crate::visit::{FaceVisitor, VisitMemory};
use glam::{DVec2, IVec2, Vec2};
use pointillist_dice::{CellWindow, ConvexPolygon, Cut, convex, cut};
use std::cmp::Ordering;

/// End of a list of parts.
const NONE: u32 = u32::MAX;

/// Cells on a side of the blocks in which closing depths are summed up.
const BLOCK: usize = 4;

/// The part of a face in one cell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part {
    /// Index into [`Dicer::faces`].
    pub(crate) face: u32,
    first_vertex: u32,
    /// 0: the whole cell.
    vertex_count: u32,
    /// Area in cells.
    pub(crate) area: f64,
    /// Centroid relative to the cell.
    pub(crate) centroid: DVec2,
    pub(crate) bounds: Extent,
    /// Smallest and largest nearness.
    pub(crate) nearness: Interval,
    pub(crate) opacity: f32,
}

/// Bounds of a part within its cell, in f32 and rounded outward.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    low: Vec2,
    high: Vec2,
}

impl Extent {
    const CELL: Self = Self { low: Vec2::ZERO, high: Vec2::ONE };

    fn of(outline: &[DVec2]) -> Self {
        Self::around(convex::bounds(outline))
    }

    fn around((low, high): (DVec2, DVec2)) -> Self {
        // A cell is 1 wide: this is half a unit in the last place of its far corner.
        let slack = Vec2::splat(f32::EPSILON);
        Self { low: low.as_vec2() - slack, high: high.as_vec2() + slack }
    }

    /// The lower and the upper corner.
    pub(crate) fn corners(&self) -> (DVec2, DVec2) {
        (self.low.as_dvec2(), self.high.as_dvec2())
    }

    /// Whether two parts may have a common interior.
    #[inline]
    pub(crate) fn overlap(&self, other: &Self) -> bool {
        self.low.cmplt(other.high).all() && other.low.cmplt(self.high).all()
    }
}

/// Whether an edge of a triangle separates it from a window by more than a cell, which is far more than the edge's crossings with grid
/// lines are rounded by.
fn misses(corners: [DVec2; 3], start: DVec2, end: DVec2) -> bool {
    const MARGIN: f64 = 1.0;
    const SLACK: f64 = 8.0 * f64::EPSILON;
    let (middle, half) = (0.5 * (start + end), 0.5 * (end - start) + MARGIN);
    let [a, b, c] = corners;
    let turn = (b - a).perp_dot(c - a);
    [(a, b), (b, c), (c, a)].into_iter().any(|(from, to)| {
        let outward = (from - to).perp() * turn.signum();
        let away = middle - from;
        outward.dot(away) > outward.abs().dot(half) + SLACK * outward.abs().dot(away.abs())
    })
}

/// Integers in the order of numbers, that of [`f64::total_cmp`]: many are sorted faster.
fn ordered(number: f64) -> i64 {
    let bits = number.to_bits().cast_signed();
    // Negative numbers have their magnitude's order reversed.
    bits ^ (bits >> 63).cast_unsigned().wrapping_shr(1).cast_signed()
}

/// Outline of a whole cell.
const CELL: [DVec2; 4] = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];

/// The sides of the cell that a point of it lies on, a bit for each.
#[inline]
fn sides_at(p: DVec2) -> u8 {
    let [left, right, top, bottom] = [p.x <= 0.0, p.x >= 1.0, p.y <= 0.0, p.y >= 1.0].map(u8::from);
    left | right << 1 | top << 2 | bottom << 3
}

/// Most edges within a cell with which [`Dicer::edges_close`] goes on: more do not belong to a few neighbours in a mesh.
const MOST_INNER_EDGES: usize = 64;

/// Areas of pieces that tile a cell add up to less than this: to 1, within [`CUT_ERROR`](pointillist_dice::CUT_ERROR) for each, which is below 1e-9 as
/// far from the origin as faces reach. Where they add up to more, edges need not be compared.
const MOST_TILED: f64 = 1.0 + 1e-6;

/// Writes the edges of an outline that are not on the border of the cell to the front of `edges`, and returns how many they are.
#[inline]
fn collect_inner_edges(outline: &[DVec2], edges: &mut [(DVec2, DVec2)]) -> usize {
    let mut from = outline[outline.len() - 1];
    let mut sides_from = sides_at(from);
    let mut count = 0;
    for &to in outline {
        let sides_to = sides_at(to);
        // Written in any case: whether an edge is on the border is hard to predict.
        edges[count] = (from, to);
        count += usize::from(sides_from & sides_to == 0);
        (from, sides_from) = (to, sides_to);
    }
    count
}

/// Whether an edge of one outline is one of the other, the other way round.
fn have_common_edge(a: &[DVec2], b: &[DVec2]) -> bool {
    let mut from = a[a.len() - 1];
    a.iter().any(|&to| {
        let start = b.iter().position(|&v| v == to);
        let common = start.is_some_and(|i| b[if i + 1 == b.len() { 0 } else { i + 1 }] == from);
        from = to;
        common
    })
}

/// Whether each edge has another that is its reverse, or no length.
fn pair_up(edges: &mut [(DVec2, DVec2)]) -> bool {
    let mut unpaired = edges;
    while let Some((&mut (from, to), others)) = unpaired.split_first_mut() {
        unpaired = others;
        if from != to {
            let Some(reverse) = unpaired.iter().position(|&other| other == (to, from)) else { return false };
            unpaired[reverse] = unpaired[0];
            unpaired = &mut unpaired[1..];
        }
    }
    true
}

/// State of one cell of the tile.
#[derive(Clone, Copy, Debug)]
struct Cell {
    head: u32,
    count: u32,
    /// Parts whose nearness is at most this are hidden.
    closed: f64,
    /// Area of the opaque parts, overlaps counted twice.
    opaque_area: f64,
    /// Area at which to try next whether the parts close the cell.
    next_try: f64,
    /// If the nearest parts were found to tile the cell: how many they are, and how many parts
    /// the cell had then.
    tiling: u32,
    tiling_count: u32,
}

impl Cell {
    const OPEN: Self = Self {
        head: NONE,
        count: 0,
        closed: f64::NEG_INFINITY,
        opaque_area: 0.0,
        next_try: 1.0 - COVERED,
        tiling: 0,
        tiling_count: 0,
    };
}

/// A cell whose disjoint parts leave less than this uncovered is covered: the tolerance to which sums of weights are tested. The parts' own rounding is a
/// hundred times smaller.
const COVERED: f64 = 1e-12;

/// Counts of work done and of work skipped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct TileCounts {
    /// Clusters that were looked into.
    pub clusters: u64,
    /// Clusters refused: outside the tile or behind its closed cells.
    pub clusters_skipped: u64,
    /// Triangles set up.
    pub triangles: u64,
    /// Triangles that were culled: back faces of solids, outside the tile.
    pub triangles_culled: u64,
    /// Triangles that lay behind closed cells and were never diced.
    pub triangles_hidden: u64,
    /// Parts made by cutting.
    pub pieces: u64,
    /// Whole cells inside spans: not cut.
    pub span_cells: u64,
    /// Parts refused by a closed cell.
    pub parts_hidden: u64,
    /// Cells by how they were resolved: empty, one part, parts that tile the cell.
    pub cells_empty: u64,
    /// See `cells_empty`.
    pub cells_single: u64,
    /// See `cells_empty`.
    pub cells_tiled: u64,
    /// Cells whose parts lie side by side, or in which the nearest hides the others.
    pub cells_apart: u64,
    /// Cells in which parts had to be cut by others.
    pub cells_compared: u64,
    /// Visible micropoints.
    pub micropoints: u64,
}

impl std::ops::AddAssign for TileCounts {
    fn add_assign(&mut self, o: Self) {
        self.clusters += o.clusters;
        self.clusters_skipped += o.clusters_skipped;
        self.triangles += o.triangles;
        self.triangles_culled += o.triangles_culled;
        self.triangles_hidden += o.triangles_hidden;
        self.pieces += o.pieces;
        self.span_cells += o.span_cells;
        self.parts_hidden += o.parts_hidden;
        self.cells_empty += o.cells_empty;
        self.cells_single += o.cells_single;
        self.cells_tiled += o.cells_tiled;
        self.cells_apart += o.cells_apart;
        self.cells_compared += o.cells_compared;
        self.micropoints += o.micropoints;
    }
}

/// Dices the faces of one tile. Memory is reused from tile to tile.
#[derive(Debug, Default)]
pub(crate) struct Dicer {
    window: Option<CellWindow>,
    cells: Vec<Cell>,
    /// Smallest `closed` of each block of cells.
    blocks: Vec<f64>,
    /// How many cells of each block were never closed: while there are any, its smallest `closed` is known.
    open_cells: Vec<usize>,
    block_columns: usize,
    /// Smallest `closed` of the tile.
    tile_closed: f64,
    parts: Vec<Part>,
    /// The next part of the same cell, for parts that are in cells. Apart from them: a walk along a list then stays in little memory.
    next: Vec<u32>,
    vertices: Vec<DVec2>,
    pub(crate) faces: Vec<Face>,
    memory: VisitMemory,
    order: Vec<u32>,
    keys: Vec<(i64, u32)>,
    /// Memory of [`Dicer::edges_close`].
    edges: Vec<(DVec2, DVec2)>,
    neighbours: Neighbours,
    pub(crate) counts: TileCounts,
}

/// What all tiles of a picture share.
#[derive(Clone, Copy)]
pub(crate) struct DiceJob<'a> {
    pub(crate) geometry: &'a Geometry,
    pub(crate) lens: &'a Lens,
    pub(crate) rect: &'a GridRect,
    pub(crate) hidden: &'a HiddenSides,
    pub(crate) opacity: &'a dyn TexturedOpacity,
    /// Squares on a side of a cell that it is divided into where masks are partly open.
    pub(crate) squares_per_side: i32,
    pub(crate) depths: DepthRange,
}

/// Dices the faces that it is handed.
struct DicedFaces<'a> {
    dicer: &'a mut Dicer,
    job: &'a DiceJob<'a>,
}

impl FaceVisitor for DicedFaces<'_> {
    fn wants(&self, _: &Bounds) -> bool {
        true
    }

    #[inline]
    fn skips(&self, corners: [&ProjectedVertex; 3], _: &SurfaceOpacity) -> bool {
        self.dicer.outside_window(corners)
    }

    #[inline]
    fn visit(&mut self, face: Face, outline: &[DVec2], opacity: Option<f32>) {
        self.dicer.dice_face(self.job, face, outline, opacity);
    }

    fn farthest(&self) -> f64 {
        self.dicer.farthest_visible(self.job.lens)
    }
}

impl Dicer {
    /// Dices everything that may be visible in the window.
    pub(crate) fn dice(&mut self, job: &DiceJob<'_>, window: CellWindow) {
        self.reset(window);
        if self.cells.is_empty() {
            return;
        }
        let low = DVec2::new(f64::from(window.x0), f64::from(window.y0));
        let high = DVec2::new(f64::from(window.x1), f64::from(window.y1));
        let (lens, rect, hidden) = (job.lens, job.rect, job.hidden);
        let range = job.depths;
        let setup = Setup { lens, rect, hidden, keeps_backs: false, range };
        let mut memory = std::mem::take(&mut self.memory);
        let mut faces = DicedFaces { dicer: self, job };
        let seen =
            job.geometry.visit_faces(&setup, &GridRect { low, high }, range.far, &mut memory, &mut faces);
        self.memory = memory;
        self.counts.clusters += seen.clusters;
        self.counts.clusters_skipped += seen.clusters_skipped;
        self.counts.triangles_culled += seen.triangles_culled;
    }

    fn reset(&mut self, window: CellWindow) {
        let (columns, rows) = ((window.x1 - window.x0) as usize, (window.y1 - window.y0) as usize);
        self.window = Some(window);
        self.block_columns = columns.div_ceil(BLOCK);
        self.cells.clear();
        self.cells.resize(columns * rows, Cell::OPEN);
        let block_rows = rows.div_ceil(BLOCK);
        self.blocks.clear();
        self.blocks.resize(self.block_columns * block_rows, f64::NEG_INFINITY);
        let side = |cells: usize, block: usize| BLOCK.min(cells - block * BLOCK);
        let cells_of = |i: usize| side(columns, i % self.block_columns) * side(rows, i / self.block_columns);
        self.open_cells.clear();
        self.open_cells.extend((0..self.blocks.len()).map(cells_of));
        self.tile_closed = f64::NEG_INFINITY;
        self.parts.clear();
        self.next.clear();
        self.vertices.clear();
        self.faces.clear();
        self.counts = TileCounts::default();
    }

    pub(crate) fn window(&self) -> CellWindow {
        self.window.unwrap_or(CellWindow { x0: 0, y0: 0, x1: 0, y1: 0 })
    }

    /// Depth beyond which nothing in this tile can be seen.
    fn farthest_visible(&self, lens: &Lens) -> f64 {
        let q = self.tile_closed - lens.tie(self.tile_closed, DVec2::ZERO);
        let unlimited = match lens.kind {
            LensKind::Perspective => q.is_nan() || q <= 0.0,
            LensKind::Orthographic => q.is_nan() || q == f64::NEG_INFINITY,
        };
        if unlimited { f64::INFINITY } else { lens.depth(q) }
    }

    /// Whether a triangle that needs no clipping misses the window: the cheapest and commonest test.
    #[inline]
    fn outside_window(&self, v: [&ProjectedVertex; 3]) -> bool {
        if !(v[0].in_front && v[1].in_front && v[2].in_front) {
            return false;
        }
        let w = self.window();
        let low = v[0].grid.min(v[1].grid).min(v[2].grid);
        let high = v[0].grid.max(v[1].grid).max(v[2].grid);
        let [start, end] = [DVec2::new(w.x0.into(), w.y0.into()), DVec2::new(w.x1.into(), w.y1.into())];
        if low.cmpge(end).any() || high.cmple(start).any() {
            return true;
        }
        // Small triangles whose boxes meet the window's mostly meet it, too.
        (high - low).max_element() > (end - start).max_element() && misses(v.map(|v| v.grid), start, end)
    }

    fn dice_face(&mut self, job: &DiceJob<'_>, face: Face, outline: &[DVec2], opacity: Option<f32>) {
        self.counts.triangles += 1;
        if opacity == Some(0.0) {
            return;
        }
        if self.is_hidden(job.lens, &face, outline) {
            self.counts.triangles_hidden += 1;
            return;
        }
        let parts_before = self.parts.len();
        let index = self.faces.len() as u32;
        // Its parts are compared with others by their faces.
        self.faces.push(face);
        cut(outline, self.window(), |c| match c {
            Cut::Span { row, first, end } => {
                for column in first..end {
                    self.add_whole_cell(job, &face, index, IVec2::new(column, row), opacity);
                }
            }
            Cut::Piece { cell, polygon } => self.add_piece(job, &face, index, cell, polygon, opacity),
        });
        if self.parts.len() == parts_before {
            self.faces.pop();
        }
    }

    /// Whether every block that the outline touches is closed in front of the face.
    fn is_hidden(&self, lens: &Lens, face: &Face, outline: &[DVec2]) -> bool {
        let q = face.nearness.most + lens.tie(face.nearness.most, face.plane.slope);
        if q < self.tile_closed {
            return true;
        }
        let w = self.window();
        let (low, high) = convex::bounds(outline);
        let block = |v: f64, first: i32, end: i32| {
            (v.clamp(f64::from(first), f64::from(end - 1)) as i32 - first) as usize / BLOCK
        };
        let columns = block(low.x, w.x0, w.x1)..=block(high.x, w.x0, w.x1);
        (block(low.y, w.y0, w.y1)..=block(high.y, w.y0, w.y1))
            .all(|y| columns.clone().all(|x| q < self.blocks[y * self.block_columns + x]))
    }

    fn cell_index(&self, cell: IVec2) -> usize {
        let w = self.window();
        (cell.y - w.y0) as usize * (w.x1 - w.x0) as usize + (cell.x - w.x0) as usize
    }

    fn add_whole_cell(
        &mut self,
        job: &DiceJob<'_>,
        face: &Face,
        index: u32,
        cell: IVec2,
        opacity: Option<f32>,
    ) {
        self.counts.span_cells += 1;
        let corner = cell.as_dvec2();
        let middle = face.plane.at(corner + 0.5);
        let reach = 0.5 * (face.plane.slope.x.abs() + face.plane.slope.y.abs());
        let nearness = Interval {
            least: face.nearness.clamp(middle - reach),
            most: face.nearness.clamp(middle + reach),
        };
        let i = self.cell_index(cell);
        if self.refuses(job.lens, i, face, nearness.most) {
            return;
        }
        let opacity = opacity.unwrap_or_else(|| opacity_in_cell(job, face, corner, &CELL));
        let part = Part {
            face: index,
            first_vertex: 0,
            vertex_count: 0,
            area: 1.0,
            centroid: DVec2::splat(0.5),
            bounds: Extent::CELL,
            nearness,
            opacity,
        };
        self.link(i, part);
        if opacity >= 1.0 && nearness.least > self.cells[i].closed {
            self.close(i, nearness.least);
        }
    }

    fn add_piece(
        &mut self,
        job: &DiceJob<'_>,
        face: &Face,
        index: u32,
        cell: IVec2,
        polygon: &ConvexPolygon,
        opacity: Option<f32>,
    ) {
        self.counts.pieces += 1;
        let corner = cell.as_dvec2();
        let first = self.vertices.len();
        // One loop: how many vertices there are is hard to predict.
        let (mut nearness, mut x, mut y) = (Interval::EMPTY, Interval::EMPTY, Interval::EMPTY);
        self.vertices.extend(polygon.vertices().iter().map(|&v| {
            let local = v - corner;
            nearness.include(face.nearness_at(v));
            x.include(local.x);
            y.include(local.y);
            local
        }));
        let i = self.cell_index(cell);
        if self.refuses(job.lens, i, face, nearness.most) {
            self.vertices.truncate(first);
            return;
        }
        let local = &self.vertices[first..];
        let (area, centroid) = convex::area_and_centroid(local);
        if area <= 0.0 || area.is_nan() {
            self.vertices.truncate(first);
            return;
        }
        let opacity = opacity.unwrap_or_else(|| opacity_in_cell(job, face, corner, local));
        let part = Part {
            face: index,
            first_vertex: first as u32,
            vertex_count: local.len() as u32,
            area,
            centroid,
            bounds: Extent::around((DVec2::new(x.least, y.least), DVec2::new(x.most, y.most))),
            nearness,
            opacity,
        };
        self.link(i, part);
        if opacity >= 1.0 {
            self.cells[i].opaque_area += area;
            if self.cells[i].opaque_area >= self.cells[i].next_try {
                self.try_to_close(i, job.lens);
            }
        }
    }

    #[inline]
    fn refuses(&mut self, lens: &Lens, cell: usize, face: &Face, nearest: f64) -> bool {
        let closed = self.cells[cell].closed;
        let refused = nearest + lens.tie(nearest, face.plane.slope) < closed;
        self.counts.parts_hidden += u64::from(refused);
        refused
    }

    #[inline]
    fn link(&mut self, cell: usize, part: Part) {
        if part.opacity <= 0.0 {
            return;
        }
        self.next.push(self.cells[cell].head);
        self.cells[cell].head = self.parts.len() as u32;
        self.cells[cell].count += 1;
        self.parts.push(part);
    }

    /// Finds out whether the nearest opaque parts of a cell tile it, and closes it if so.
    ///
    /// Only disjoint parts are considered: the common case of a mesh whose triangles are about as
    /// large as cells. Whatever else there is gets sorted out when the tile is resolved.
    fn try_to_close(&mut self, cell: usize, lens: &Lens) {
        // Comparing each with each takes longer than the parts that a closed cell refuses.
        const MOST: usize = 128;
        let Cell { opaque_area: summed, count, .. } = self.cells[cell];
        // No part is longer than the cell: fewer parts than this are not thin.
        let thin = f64::from(count) * THINNEST > summed && self.are_thin(self.parts_of(cell));
        if count as usize > MOST && !thin {
            self.cells[cell].next_try = summed + 1.0;
            return;
        }
        if summed < MOST_TILED
            && let Some((pieces, nearness)) = self.tiled_by_edges(cell, lens)
        {
            self.set_tiling(cell, pieces, nearness);
            self.cells[cell].next_try = summed + 0.5;
            return;
        }
        let order = self.sorted_parts(cell);
        let disjoint = if thin { self.disjoint(&order) } else { None };
        if disjoint.is_none() && order.len() > MOST {
            self.cells[cell].next_try = summed + 1.0;
            self.order = order;
            return;
        }
        let mut area = 0.0;
        let mut nearness = f64::INFINITY;
        let mut tiling = 0;
        for (i, &p) in order.iter().enumerate() {
            let part = &self.parts[p as usize];
            let overlaps = || match disjoint {
                Some(count) => i >= count,
                None => order[..i].iter().any(|&o| self.overlap(p, o)),
            };
            if part.opacity < 1.0 || overlaps() {
                break;
            }
            area += part.area;
            nearness = nearness.min(part.nearness.least);
            if area >= 1.0 - COVERED {
                tiling = i + 1;
                break;
            }
        }
        let hidden = |&p: &u32| self.nearest(lens, self.part(p)) < nearness;
        let tiles = tiling > 0 && order[tiling..].iter().all(hidden);
        // Whatever broke the prefix off must come to lie behind it, so that only new parts can add to it.
        self.cells[cell].next_try = if tiling > 0 { summed + 0.5 } else { summed + 1.0 - area - COVERED };
        if tiles {
            self.set_tiling(cell, tiling as u32, nearness);
        }
        self.order = order;
    }

    /// Notes that the nearest parts of a cell tile it, and that the others lie behind this nearness.
    fn set_tiling(&mut self, cell: usize, parts: u32, nearness: f64) {
        self.cells[cell].tiling = parts;
        self.cells[cell].tiling_count = self.cells[cell].count;
        if nearness > self.cells[cell].closed {
            self.close(cell, nearness);
        }
    }

    /// Largest nearness of a part, with what it may be rounded by.
    #[inline]
    fn nearest(&self, lens: &Lens, part: &Part) -> f64 {
        let slope = self.faces[part.face as usize].plane.slope;
        part.nearness.most + lens.tie(part.nearness.most, slope)
    }

    /// The number of opaque pieces in a cell and their smallest nearness, if their edges tell that they tile it, and the other parts lie behind them.
    ///
    /// Faces that share an edge are cut at the same points, bit for bit, so that this holds for pieces of a mesh. Their areas add up to that of the
    /// cell at least, and to less than [`MOST_TILED`].
    fn tiled_by_edges(&mut self, cell: usize, lens: &Lens) -> Option<(u32, f64)> {
        let mut pieces = std::mem::take(&mut self.order);
        pieces.clear();
        let (mut nearness, mut others) = (f64::INFINITY, f64::NEG_INFINITY);
        for p in self.parts_of(cell) {
            let part = &self.parts[p as usize];
            if part.vertex_count == 0 || part.opacity < 1.0 {
                others = others.max(self.nearest(lens, part));
            } else {
                nearness = nearness.min(part.nearness.least);
                pieces.push(p);
            }
        }
        let tiled = others < nearness
            && match *pieces {
                // They lie on either side of it.
                [a, b] => have_common_edge(self.outline(self.part(a)), self.outline(self.part(b))),
                _ => self.edges_close(&pieces),
            };
        let count = pieces.len() as u32;
        self.order = pieces;
        tiled.then_some((count, nearness))
    }

    /// Whether each edge of some pieces that is not on the border of the cell is another's edge, the other way round. Then as many of them lie over one
    /// point of the cell as over any other.
    fn edges_close(&mut self, pieces: &[u32]) -> bool {
        let mut edges = std::mem::take(&mut self.edges);
        edges.resize(MOST_INNER_EDGES + convex::MAX_VERTICES, (DVec2::ZERO, DVec2::ZERO));
        let mut inner = 0;
        for &p in pieces {
            inner += collect_inner_edges(self.outline(self.part(p)), &mut edges[inner..]);
            if inner > MOST_INNER_EDGES {
                break;
            }
        }
        let closed = inner <= MOST_INNER_EDGES && pair_up(&mut edges[..inner]);
        self.edges = edges;
        closed
    }

    /// How many parts, from the first on, are disjoint; `None` where it takes comparing each with each to tell.
    fn disjoint(&mut self, parts: &[u32]) -> Option<usize> {
        let mut neighbours = std::mem::take(&mut self.neighbours);
        let outlines = parts.iter().map(|&p| self.outline(self.part(p)));
        let overlap = |a: u32, b: u32| self.overlap(parts[a as usize], parts[b as usize]);
        let count = neighbours.disjoint(outlines, overlap);
        self.neighbours = neighbours;
        count
    }

    /// Whether parts are long and thin.
    pub(crate) fn are_thin(&self, parts: impl Iterator<Item = u32>) -> bool {
        neighbours::are_thin(parts.map(|p| {
            let part = self.part(p);
            let (low, high) = part.bounds.corners();
            (part.area, (high - low).max_element())
        }))
    }

    /// Closes a cell at a nearness and updates the pyramid above it.
    fn close(&mut self, cell: usize, nearness: f64) {
        let before = std::mem::replace(&mut self.cells[cell].closed, nearness);
        let w = self.window();
        let (columns, rows) = ((w.x1 - w.x0) as usize, (w.y1 - w.y0) as usize);
        let (bx, by) = (cell % columns / BLOCK, cell / columns / BLOCK);
        let block = by * self.block_columns + bx;
        self.open_cells[block] -= usize::from(before == f64::NEG_INFINITY);
        // Only the least closed cell of a block decides.
        if self.open_cells[block] > 0 || before > self.blocks[block] {
            return;
        }
        let mut least = f64::INFINITY;
        let row_of_block = bx * BLOCK..((bx + 1) * BLOCK).min(columns);
        for y in by * BLOCK..((by + 1) * BLOCK).min(rows) {
            for c in &self.cells[y * columns..][row_of_block.clone()] {
                least = if c.closed < least { c.closed } else { least };
            }
        }
        let block_before = std::mem::replace(&mut self.blocks[block], least);
        if block_before <= self.tile_closed {
            self.tile_closed = self.blocks.iter().copied().fold(f64::INFINITY, f64::min);
        }
    }

    /// The parts of a cell, the last first.
    fn parts_of(&self, cell: usize) -> impl Iterator<Item = u32> + '_ {
        let known = |p: u32| (p != NONE).then_some(p);
        std::iter::successors(known(self.cells[cell].head), move |&p| known(self.next[p as usize]))
    }

    /// The parts of a cell, nearest first, in an order that does not depend on the order of triangles.
    pub(crate) fn sorted_parts(&mut self, cell: usize) -> Vec<u32> {
        let mut order = std::mem::take(&mut self.order);
        order.clear();
        if self.cells[cell].count <= 1 {
            order.extend(self.parts_of(cell));
            return order;
        }
        let mut keys = std::mem::take(&mut self.keys);
        keys.clear();
        keys.extend(self.parts_of(cell).map(|p| (ordered(-self.part(p).nearness.most), p)));
        keys.sort_unstable_by_key(|key| key.0);
        if keys.windows(2).any(|pair| pair[0].0 == pair[1].0) {
            for equal in keys.chunk_by_mut(|a, b| a.0 == b.0) {
                equal.sort_unstable_by(|a, b| self.compare(a.1, b.1));
            }
        }
        order.extend(keys.iter().map(|key| key.1));
        self.keys = keys;
        order
    }

    /// Gives the list of [`Dicer::sorted_parts`] back for reuse.
    pub(crate) fn recycle(&mut self, order: Vec<u32>) {
        self.order = order;
    }

    /// Nearest first; then by position and surface; the triangle's number decides only between
    /// parts that are equal in all else.
    pub(crate) fn compare(&self, a: u32, b: u32) -> Ordering {
        let (a, b) = (&self.parts[a as usize], &self.parts[b as usize]);
        let key = |p: &Part| [-p.nearness.most, -p.nearness.least, p.centroid.x, p.centroid.y];
        let mut places = key(a).into_iter().zip(key(b)).map(|(a, b)| a.total_cmp(&b));
        let by_place = places.find(|o| o.is_ne()).unwrap_or(Ordering::Equal);
        by_place.then_with(|| self.faces[a.face as usize].precedence(&self.faces[b.face as usize]))
    }

    pub(crate) fn part(&self, index: u32) -> &Part {
        &self.parts[index as usize]
    }

    /// Adds a piece of a part, of no cell's list. Returns its number.
    pub(crate) fn add_piece_of(
        &mut self,
        part: Part,
        outline: &[DVec2],
        (area, centroid): (f64, DVec2),
        nearness: Interval,
        opacity: f32,
    ) -> u32 {
        let first_vertex = self.vertices.len() as u32;
        self.vertices.extend_from_slice(outline);
        let (vertex_count, bounds) = (outline.len() as u32, Extent::of(outline));
        self.parts.push(Part {
            first_vertex,
            vertex_count,
            area,
            centroid,
            bounds,
            nearness,
            opacity,
            ..part
        });
        self.parts.len() as u32 - 1
    }

    /// Copies parts to where they follow one another, and gives their new numbers. Parts of one cell lie as far apart in memory as the faces
    /// that they come from, and many of them are looked at many times.
    pub(crate) fn bring_together(&mut self, parts: &mut [u32]) {
        for number in parts {
            let mut part = self.parts[*number as usize];
            if part.vertex_count > 0 {
                let first = part.first_vertex as usize;
                part.first_vertex = self.vertices.len() as u32;
                self.vertices.extend_from_within(first..first + part.vertex_count as usize);
            }
            *number = self.parts.len() as u32;
            self.parts.push(part);
        }
    }

    /// How much is stored of parts, for [`Dicer::forget_since`].
    pub(crate) fn stored(&self) -> (usize, usize) {
        (self.parts.len(), self.vertices.len())
    }

    /// Forgets the parts that were added since.
    pub(crate) fn forget_since(&mut self, (parts, vertices): (usize, usize)) {
        self.parts.truncate(parts);
        self.vertices.truncate(vertices);
    }

    /// Whether two parts of a cell are the same piece of two copies of one triangle.
    pub(crate) fn is_copy(&self, a: u32, b: u32) -> bool {
        let (a, b) = (self.part(a), self.part(b));
        a.centroid == b.centroid
            && self.faces[a.face as usize].corners == self.faces[b.face as usize].corners
            && self.outline(a) == self.outline(b)
    }

    /// Whether two parts of a cell have a common interior, beyond rounding.
    #[inline]
    pub(crate) fn overlap(&self, a: u32, b: u32) -> bool {
        let (a, b) = (self.part(a), self.part(b));
        a.bounds.overlap(&b.bounds) && self.outlines_overlap(a, b)
    }

    /// Not inlined: the bounds decide most questions.
    #[inline(never)]
    fn outlines_overlap(&self, a: &Part, b: &Part) -> bool {
        !convex::are_disjoint(self.outline(a), self.outline(b))
    }

    /// A part's outline relative to its cell.
    #[inline]
    pub(crate) fn outline(&self, part: &Part) -> &[DVec2] {
        if part.vertex_count == 0 {
            return &CELL;
        }
        let first = part.first_vertex as usize;
        &self.vertices[first..first + part.vertex_count as usize]
    }

    /// How many of a cell's parts, nearest first, are known to tile it and to hide the others.
    pub(crate) fn tiling(&self, cell: usize) -> Option<usize> {
        let c = &self.cells[cell];
        (c.tiling > 0 && c.tiling_count == c.count).then_some(c.tiling as usize)
    }
}

/// Opacity of a mask that may let some light pass, in a cell that will be divided.
const PARTLY_OPEN: f32 = 0.5;

/// Opacity, 0..=1, of a face over an outline in a cell: the mean, unless the cell is divided where masks vary, and its squares will be asked for.
fn opacity_in_cell(job: &DiceJob<'_>, face: &Face, corner: DVec2, local: &[DVec2]) -> f32 {
    if job.squares_per_side == 1 {
        return mean_opacity(job, face, corner, local);
    }
    let surface = &job.geometry.surfaces()[face.surface as usize];
    let even = face.even_opacity(job.lens, surface, job.opacity, corner, local);
    even.unwrap_or_else(|| surface.behind_mask(PARTLY_OPEN))
}

/// Mean opacity, 0..=1, of a face over an outline relative to a cell's corner.
pub(crate) fn mean_opacity(job: &DiceJob<'_>, face: &Face, corner: DVec2, local: &[DVec2]) -> f32 {
    let surface = &job.geometry.surfaces()[face.surface as usize];
    face.mean_opacity(job.lens, surface, job.opacity, corner, local)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec2;

    fn close(pieces: &[[DVec2; 3]]) -> bool {
        let mut edges = [(DVec2::ZERO, DVec2::ZERO); 32];
        let inner =
            pieces.iter().fold(0, |inner, piece| inner + collect_inner_edges(piece, &mut edges[inner..]));
        pair_up(&mut edges[..inner])
    }

    #[test]
    fn edges_of_pieces_that_tile_the_cell_pair_up() {
        let middle = dvec2(0.4, 0.6);
        let fan: Vec<_> = (0..4).map(|i| [CELL[i], CELL[(i + 1) % 4], middle]).collect();
        assert!(close(&fan));
        assert!(!close(&fan[..3]), "two edges of the hole are left");
        // The hole is covered, too, but its edges are not bit for bit those of its neighbours.
        let moved = [CELL[3], CELL[0], middle + dvec2(1e-16, 0.0)];
        assert!(!close(&[fan[0], fan[1], fan[2], moved]));
        // From side to side of the cell is not along a side.
        assert!(!close(&[[dvec2(0.0, 0.5), dvec2(1.0, 0.5), CELL[3]]]));
        // A corner given twice has an edge without a length.
        assert!(close(&[[CELL[0], CELL[1], middle], [middle, CELL[1], middle], [CELL[1], CELL[0], middle]]));
    }

    #[test]
    fn a_common_edge_runs_the_other_way_round_in_the_neighbour() {
        let [a, b, c, d] = CELL;
        assert!(have_common_edge(&[a, b, c], &[c, d, a]));
        assert!(have_common_edge(&[b, c, a], &[a, c, d]));
        assert!(!have_common_edge(&[a, b, c], &[a, b, d]), "on the same side of their edge");
        assert!(!have_common_edge(&[a, b, c], &[c, d, dvec2(0.5, 0.5)]), "only a corner in common");
    }
}
