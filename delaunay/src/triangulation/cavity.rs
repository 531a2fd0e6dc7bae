//! The hole that a new vertex makes, and which of the new cells share an edge of its rim.

use super::cell::{Cell, CellId, FACE, Link, Vertex, replaced};

/// The table of edges has at most 2 to this power rows and columns, 4 MiB; edges of larger rims are sorted.
const MAX_SHIFT: u32 = 10;

/// Faces of a cell: memory for them is reserved before the cell is visited.
const FACES: usize = 4;

/// A face of the rim, and the cell to be that joins it to the new vertex.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RimFace {
    /// Of the new cell.
    pub(super) corners: [Vertex; 4],
    /// Across the face, outside the cavity.
    pub(super) beyond: Link,
    /// Which corner is the new vertex.
    slot: u8,
    /// The numbers that the others have in the rim, in the order of [`FACE`].
    local: [u16; 3],
}

impl RimFace {
    /// Which corner is the new vertex.
    #[inline]
    pub(super) fn slot(&self) -> usize {
        usize::from(self.slot)
    }

    fn edge(&self, from: usize, to: usize) -> [Vertex; 2] {
        [from, to].map(|j| self.corners[FACE[self.slot()][j]])
    }
}

/// Working memory of an insertion.
#[derive(Clone, Debug)]
pub(super) struct Cavity {
    /// Cells in the cavity; then, in their places, those that fill it. What comes after `dug_count` is left over.
    dug: Vec<CellId>,
    dug_count: usize,
    /// Faces between a cell of the cavity and one outside, from both. What comes after `rim_count` is left over.
    rim: Vec<(Link, Link)>,
    rim_count: usize,
    faces: Vec<RimFace>,
    /// Vertices of the rim, by number. What comes after `vertex_count` is left over.
    vertices: Vec<Vertex>,
    vertex_count: usize,
    /// The number of a vertex, if that number is its own.
    number: Vec<u32>,
    /// By numbers of the ends of an edge, as it runs around a face: the face of a new cell that has it. No larger than
    /// the rim needs, which is a kilobyte mostly, to stay in the nearest cache.
    table: Vec<Link>,
    /// Two to this power is the length of its rows.
    shift: u32,
    /// The same, sorted, for rims too large for the table.
    sorted: Vec<([Vertex; 2], Link)>,
}

#[inline]
fn entry(shift: u32, from: u16, to: u16) -> usize {
    usize::from(from) << shift | usize::from(to)
}

impl Cavity {
    /// For meshes of fewer vertices than this.
    pub(super) fn new(vertices: usize) -> Self {
        Self {
            dug: vec![],
            dug_count: 0,
            rim: vec![],
            rim_count: 0,
            faces: vec![],
            vertices: vec![],
            vertex_count: 0,
            number: vec![0; vertices],
            table: vec![],
            shift: 0,
            sorted: vec![],
        }
    }

    /// Makes room for vertices below this.
    pub(super) fn grow(&mut self, vertices: usize) {
        self.number.resize(vertices.max(self.number.len()), 0);
    }

    /// Forgets the last insertion and starts another at this cell.
    pub(super) fn start(&mut self, start: CellId) {
        (self.dug_count, self.rim_count) = (0, 0);
        self.dug.resize(self.dug.len().max(1), CellId::default());
        self.add_dug(start, true);
    }

    /// The cell of this number in the cavity; `None` if there are fewer. Reserves memory for the faces around it.
    #[inline]
    pub(super) fn dug_cell(&mut self, at: usize) -> Option<CellId> {
        if at == self.dug_count {
            return None;
        }
        if self.dug_count + FACES > self.dug.len() {
            self.dug.resize(2 * self.dug_count + FACES, CellId::default());
        }
        if self.rim_count + FACES > self.rim.len() {
            self.rim.resize(2 * self.rim_count + FACES, Default::default());
        }
        Some(self.dug[at])
    }

    /// Adds a cell to the cavity, if it belongs to it.
    #[inline]
    pub(super) fn add_dug(&mut self, id: CellId, belongs: bool) {
        self.dug[self.dug_count] = id;
        self.dug_count += usize::from(belongs);
    }

    /// Adds a face to the rim, if it belongs to it.
    #[inline]
    pub(super) fn add_rim(&mut self, inside: Link, beyond: Link, belongs: bool) {
        self.rim[self.rim_count] = (inside, beyond);
        self.rim_count += usize::from(belongs);
    }

    /// The faces of the rim.
    pub(super) fn rim(&self) -> &[(Link, Link)] {
        &self.rim[..self.rim_count]
    }

    /// How many cells more it takes to fill the cavity than it had.
    pub(super) fn missing(&self) -> usize {
        self.rim_count.saturating_sub(self.dug_count)
    }

    /// Adds a cell to fill it with.
    pub(super) fn add_cell(&mut self, id: CellId) {
        self.dug.truncate(self.dug_count);
        self.dug.push(id);
        self.dug_count += 1;
    }

    /// Cells of the cavity that are not needed to fill it.
    pub(super) fn spare(&self) -> impl Iterator<Item = CellId> {
        self.dug[self.rim_count.min(self.dug_count)..self.dug_count].iter().copied()
    }

    /// The faces of the rim once edges are paired, and the cells that join them to the new vertex.
    pub(super) fn faces(&self) -> impl Iterator<Item = (&RimFace, CellId)> {
        self.faces.iter().zip(self.dug.iter().copied())
    }

    /// Numbers the vertices of the rim and notes where its edges are.
    ///
    /// The rim is a closed surface whose faces are turned alike: each edge runs one way around one face and the other
    /// way around another. So all that is looked up in the table has been written for this rim, and it is never
    /// cleared.
    pub(super) fn pair_edges(&mut self, cells: &[Cell], v: Vertex) {
        self.vertex_count = 0;
        self.faces.clear();
        // A surface without holes has two vertices more than half its faces.
        self.vertices.resize(self.vertices.len().max(self.rim_count / 2 + 3), Vertex::INFINITE);
        for i in 0..self.rim_count {
            let (inside, beyond) = self.rim[i];
            let (corners, k) = (cells[inside.cell().slot()].corners, inside.face());
            let local = FACE[k].map(|j| self.number_of(corners[j]));
            self.faces.push(RimFace { corners: replaced(corners, k, v), beyond, slot: k as u8, local });
        }
        self.shift = self.vertex_count.next_power_of_two().trailing_zeros();
        if self.shift > MAX_SHIFT {
            return self.sort_edges();
        }
        self.table.resize(self.table.len().max(1 << (2 * self.shift)), Link::default());
        for (face, &id) in self.faces.iter().zip(&self.dug) {
            for (j, &corner) in FACE[face.slot()].iter().enumerate() {
                let entry = entry(self.shift, face.local[(j + 1) % 3], face.local[(j + 2) % 3]);
                self.table[entry] = Link::new(id, corner);
            }
        }
    }

    fn sort_edges(&mut self) {
        self.sorted.clear();
        for (face, &id) in self.faces.iter().zip(&self.dug) {
            let edge = |j: usize| (face.edge((j + 1) % 3, (j + 2) % 3), Link::new(id, FACE[face.slot()][j]));
            self.sorted.extend((0..3).map(edge));
        }
        self.sorted.sort_unstable_by_key(|(edge, _)| edge.map(|v| v.0));
    }

    /// The number of a vertex in the rim: a new one if it has none. Cut to what the largest table needs.
    #[inline]
    fn number_of(&mut self, v: Vertex) -> u16 {
        // `number` may hold entries of an older rim: one is valid only if the vertex at that number is this one.
        let claimed = self.number[v.slot()] as usize;
        self.vertices[self.vertex_count] = v;
        let is_new = claimed >= self.vertex_count || self.vertices[claimed] != v;
        let number = if is_new { self.vertex_count } else { claimed };
        self.number[v.slot()] = number as u32;
        self.vertex_count += usize::from(is_new);
        number as u16
    }

    /// The neighbours of the new cell on a face of the rim.
    #[inline]
    pub(super) fn links_of(&self, face: &RimFace) -> [Link; 4] {
        let mut links = [face.beyond; 4];
        for (j, &corner) in FACE[face.slot()].iter().enumerate() {
            let (from, to) = ((j + 1) % 3, (j + 2) % 3);
            links[corner] = if self.shift <= MAX_SHIFT {
                self.table[entry(self.shift, face.local[to], face.local[from])]
            } else {
                self.find(face.edge(to, from))
            };
        }
        links
    }

    #[cold]
    fn find(&self, edge: [Vertex; 2]) -> Link {
        let at = self.sorted.binary_search_by_key(&edge.map(|v| v.0), |(e, _)| e.map(|v| v.0));
        self.sorted[at.expect("the rim is closed")].1
    }
}
