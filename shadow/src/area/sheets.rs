//! Casters in the frame of a light, with the edges that they share.

use super::light::AreaLight;
use super::shaft::Shaft;
use glam::{DVec3, dvec3};
use pointillist_micropoint::{ClusterFace, ClusterView};
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};
use std::num::NonZeroU32;

/// A triangle, or what of it is in front of the light; coordinates are those of the light's frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sheet {
    /// Unit normal and offset of its plane.
    pub(crate) normal: DVec3,
    pub(crate) offset: f64,
    corners: [u32; 4],
    edges: [SheetEdge; 4],
    count: u8,
    /// Number of its triangle, if its opacity depends on the place.
    pub(crate) mask: Option<NonZeroU32>,
}

/// An edge as a sheet goes along it: twice its number, plus 1 if against its direction.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SheetEdge(u32);

impl SheetEdge {
    pub(crate) fn edge(self) -> u32 {
        self.0 >> 1
    }

    /// 1 in the direction of the edge, −1 against it.
    pub(crate) fn turn(self) -> i32 {
        1 - 2 * (self.0 & 1) as i32
    }
}

impl Sheet {
    pub(crate) fn edges(&self) -> &[SheetEdge] {
        &self.edges[..usize::from(self.count)]
    }
}

/// Sheets that hide alike: 0 for opaque ones, the bits of their opacity for translucent ones, whose order is that of opacities. Edges of
/// different kinds do not cancel.
pub(crate) type Kind = u32;

/// Casters that may stand between a batch of receivers and a light. Vertices and edges at the same place are one.
#[derive(Debug, Default)]
pub(crate) struct Sheets {
    pub(crate) list: Vec<Sheet>,
    vertices: Vec<DVec3>,
    /// Ends and kind.
    edges: Vec<([u32; 2], Kind)>,
    kinds: Vec<Kind>,
    number_of_vertex: HashMap<[u64; 3], u32, BuildHasherDefault<Mixer>>,
    number_of_edge: HashMap<(u64, u32), u32, BuildHasherDefault<Mixer>>,
    /// Triangles of masked sheets; the first has number 1.
    masks: Vec<ClusterFace>,
    /// Vertices of the cluster at hand, their numbers or `NONE`, and their [`Shaft::beyond`].
    local: Vec<DVec3>,
    numbers: Vec<u32>,
    beyond: Vec<u8>,
}

/// Which planes of a shaft vertices lie beyond, each computed once for all sheets that share it.
#[derive(Debug, Default)]
pub(crate) struct Beyond {
    /// For each vertex: the shaft for which its bits are known, and the bits.
    known: Vec<(u32, u8)>,
    shaft: u32,
}

impl Beyond {
    /// Begins a batch.
    pub(crate) fn start(&mut self, sheets: &Sheets) {
        self.known.clear();
        self.known.resize(sheets.vertices.len(), (0, 0));
        self.shaft = 0;
    }

    /// Begins with another shaft.
    pub(crate) fn turn_to_next(&mut self) {
        self.shaft += 1;
    }

    /// Whether the shaft at hand misses a sheet.
    #[inline]
    pub(crate) fn misses(&mut self, sheets: &Sheets, shaft: &Shaft, sheet: u32) -> bool {
        let Sheet { corners, count, .. } = sheets.list[sheet as usize];
        let bits = |&vertex: &u32| {
            let known = &mut self.known[vertex as usize];
            if known.0 != self.shaft {
                *known = (self.shaft, shaft.beyond(sheets.vertices[vertex as usize]));
            }
            known.1
        };
        corners[..usize::from(count)].iter().map(bits).fold(!0, |all, own| all & own) != 0
    }
}

const NONE: u32 = u32::MAX;

impl Sheets {
    /// Removes all sheets and keeps the memory.
    pub(crate) fn clear(&mut self) {
        self.list.clear();
        self.vertices.clear();
        self.edges.clear();
        self.number_of_vertex.clear();
        self.number_of_edge.clear();
        self.masks.clear();
        self.kinds.clear();
    }

    /// Adds what a shaft does not miss, where it is in front of the light.
    pub(crate) fn gather(&mut self, light: &AreaLight<'_>, shaft: &Shaft) {
        let AreaLight { geometry, frame, .. } = light;
        let wants = |bounds: &pointillist_micropoint::Bounds| {
            let side = |k: usize, bit: bool| if bit { bounds.high[k] } else { bounds.low[k] };
            let corner = |i: usize| dvec3(side(0, i & 1 > 0), side(1, i & 2 > 0), side(2, i & 4 > 0));
            !shaft.misses((0..8).map(|i| frame.local(corner(i))))
        };
        geometry.visit_clusters(wants, |cluster| self.add_cluster(light, cluster, shaft));
    }

    fn add_cluster(&mut self, light: &AreaLight<'_>, cluster: &ClusterView<'_>, shaft: &Shaft) {
        self.local.clear();
        self.local.extend(cluster.vertices.iter().map(|&v| light.frame.local(v)));
        self.numbers.clear();
        self.numbers.resize(self.local.len(), NONE);
        self.beyond.clear();
        self.beyond.extend(self.local.iter().map(|&v| shaft.beyond(v)));
        for face in cluster.faces() {
            let surface = &light.geometry.surfaces()[face.surface as usize];
            let corners = face.corners.map(|c| self.local[c]);
            let misses = face.corners.iter().fold(!0, |all, &c| all & self.beyond[c]) != 0;
            if surface.opacity <= 0.0 || misses || light.is_own(face.id) {
                continue;
            }
            let mut mask = None;
            let mut kind = 0;
            if surface.textured_opacity {
                self.masks.push(face);
                mask = NonZeroU32::new(self.masks.len() as u32);
            } else if surface.opacity < 1.0 {
                kind = self.kind(surface.opacity);
            }
            self.add(corners, face.corners, light.coincident, (kind, mask));
        }
    }

    /// The kind of translucent sheets of this opacity.
    fn kind(&mut self, opacity: f32) -> Kind {
        let kind = opacity.to_bits();
        if let Err(place) = self.kinds.binary_search(&kind) {
            self.kinds.insert(place, kind);
        }
        kind
    }

    /// The translucent kinds, by opacity.
    pub(crate) fn kinds(&self) -> &[Kind] {
        &self.kinds
    }

    /// The share of light that passes through so many sheets of each translucent kind.
    pub(crate) fn passed(&self, layers: &[i32]) -> f64 {
        let of = |(&kind, &count): (&Kind, &i32)| (1.0 - f64::from(f32::from_bits(kind))).powi(count.abs());
        self.kinds.iter().zip(layers).map(of).product()
    }

    fn add(
        &mut self,
        corners: [DVec3; 3],
        places: [usize; 3],
        lowest: f64,
        (kind, mask): (Kind, Option<NonZeroU32>),
    ) {
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let mut numbers = [0; 4];
        let mut count = 3;
        if corners.iter().all(|c| c.z >= lowest) {
            for (number, place) in numbers.iter_mut().zip(places) {
                if self.numbers[place] == NONE {
                    self.numbers[place] = self.vertex(self.local[place]);
                }
                *number = self.numbers[place];
            }
        } else {
            let ring;
            (ring, count) = above(corners, lowest);
            for (number, &p) in numbers.iter_mut().zip(&ring[..count]) {
                *number = self.vertex(p);
            }
        }
        if normal == DVec3::ZERO || count < 3 {
            return;
        }
        let mut edges = [SheetEdge::default(); 4];
        for i in 0..count {
            edges[i] = self.edge(numbers[i], numbers[(i + 1) % count], kind);
        }
        let offset = normal.dot(a);
        self.list.push(Sheet { normal, offset, corners: numbers, edges, count: count as u8, mask });
    }

    fn vertex(&mut self, p: DVec3) -> u32 {
        // +0 and −0 are one place.
        let key = p.to_array().map(|x| (x + 0.0).to_bits());
        let next = self.vertices.len() as u32;
        let number = *self.number_of_vertex.entry(key).or_insert(next);
        if number == next {
            self.vertices.push(p);
        }
        number
    }

    /// An edge, whose direction follows from the places of its ends: what is computed along it is the same for all its sheets.
    fn edge(&mut self, from: u32, to: u32, kind: Kind) -> SheetEdge {
        let key = |v: u32| self.vertices[v as usize].to_array();
        let along = key(from) < key(to);
        let ends = if along { [from, to] } else { [to, from] };
        let next = self.edges.len() as u32;
        let both = u64::from(ends[0]) << 32 | u64::from(ends[1]);
        let edge = *self.number_of_edge.entry((both, kind)).or_insert(next);
        if edge == next {
            self.edges.push((ends, kind));
        }
        SheetEdge(edge << 1 | u32::from(!along))
    }

    pub(crate) fn corners(&self, sheet: &Sheet) -> impl Iterator<Item = DVec3> + Clone + '_ {
        let (corners, count) = (sheet.corners, usize::from(sheet.count));
        (0..count).map(move |i| self.vertices[corners[i] as usize])
    }

    /// The ends of an edge.
    pub(crate) fn ends(&self, edge: u32) -> [DVec3; 2] {
        self.edges[edge as usize].0.map(|v| self.vertices[v as usize])
    }

    pub(crate) fn kind_of(&self, edge: u32) -> Kind {
        self.edges[edge as usize].1
    }

    /// For each edge, which connected piece of casters it belongs to: the least number of that piece's edges.
    pub(crate) fn connected_edges(&self) -> Vec<u32> {
        let mut parents: Vec<u32> = (0..self.edges.len() as u32).collect();
        let root = |parents: &mut [u32], mut edge: u32| {
            while parents[edge as usize] != edge {
                let above = parents[parents[edge as usize] as usize];
                parents[edge as usize] = above;
                edge = above;
            }
            edge
        };
        for sheet in &self.list {
            for pair in sheet.edges().windows(2) {
                let [a, b] = [pair[0], pair[1]].map(|e| root(&mut parents, e.edge()));
                parents[a.max(b) as usize] = a.min(b);
            }
        }
        (0..parents.len() as u32).map(|edge| root(&mut parents, edge)).collect()
    }

    /// The triangle of a masked sheet.
    pub(crate) fn mask(&self, sheet: &Sheet) -> Option<ClusterFace> {
        sheet.mask.map(|number| self.masks[number.get() as usize - 1])
    }

    pub(crate) fn edge_count(&self) -> usize {
        self.edges.len()
    }
}

/// The point of an edge at a height; `a` and `b` in the order of [`Sheets::edge`].
pub(crate) fn at_height(a: DVec3, b: DVec3, height: f64) -> DVec3 {
    let share = (height - a.z) / (b.z - a.z);
    (a + (b - a) * share).with_z(height)
}

/// What of a triangle is above a height.
fn above(corners: [DVec3; 3], lowest: f64) -> ([DVec3; 4], usize) {
    let mut ring = [DVec3::ZERO; 4];
    let mut count = 0;
    let mut push = |p: DVec3| {
        ring[count] = p;
        count += 1;
    };
    for i in 0..3 {
        let (a, b) = (corners[i], corners[(i + 1) % 3]);
        if a.z >= lowest {
            push(a);
        }
        if (a.z >= lowest) != (b.z >= lowest) {
            let (low, high) = if a.to_array() < b.to_array() { (a, b) } else { (b, a) };
            push(at_height(low, high, lowest));
        }
    }
    (ring, count)
}

/// A fast hash of a few integers: casters are no adversaries.
#[derive(Default)]
struct Mixer(u64);

impl Hasher for Mixer {
    fn finish(&self) -> u64 {
        self.0 ^ self.0 >> 32
    }

    fn write(&mut self, bytes: &[u8]) {
        for chunk in bytes.chunks(8) {
            let mut word = [0; 8];
            word[..chunk.len()].copy_from_slice(chunk);
            self.write_u64(u64::from_le_bytes(word));
        }
    }

    fn write_u64(&mut self, n: u64) {
        self.0 = (self.0 ^ n).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29);
    }
}
