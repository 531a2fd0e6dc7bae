//! The hierarchy of patches: quadtrees over the sides of surfaces. Each element is a polygon; its four children make it up.

use std::collections::HashMap;

use glam::DVec3;

use crate::polygon::Polygon;

/// Index of an element of the tree.
pub(crate) type ElementId = u32;

/// A patch on some level of the hierarchy.
#[derive(Clone, Debug)]
pub(crate) struct Element {
    pub(crate) polygon: Polygon,
    /// Indices of the corners in [`Tree::vertices`]; the first three or four, as many as the polygon has.
    pub(crate) corners: [u32; 4],
    /// Index of the first of four children; 0 for a leaf (element 0 is a root, never a child).
    pub(crate) first_child: ElementId,
    /// Index of the side in `Scene::sides`.
    pub(crate) side: u32,
    /// Length of the longest edge, in scaled units.
    pub(crate) size: f64,
}

impl Element {
    pub(crate) const fn is_leaf(&self) -> bool {
        self.first_child == 0
    }

    pub(crate) fn corners(&self) -> &[u32] {
        &self.corners[..self.polygon.vertices().len()]
    }

    /// The four children.
    pub(crate) fn children(&self) -> std::ops::Range<ElementId> {
        if self.is_leaf() { 0..0 } else { self.first_child..self.first_child + 4 }
    }
}

/// All elements, and the vertices that they share.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tree {
    pub(crate) elements: Vec<Element>,
    pub(crate) roots: Vec<ElementId>,
    pub(crate) vertices: Vec<DVec3>,
    /// Index of each vertex by the bits of its coordinates.
    places: HashMap<[u64; 3], u32>,
    /// Index of the vertex in the middle of two others, by their indices, the smaller first.
    middles: HashMap<(u32, u32), u32>,
}

/// Quadrangles whose length is more than this times their width are divided into a row of squarer ones before the quadtree begins.
const ASPECT: f64 = 1.5;
/// Most quadrangles of such a row.
const MAX_ROW: usize = 64;

impl Tree {
    /// Adds the roots of one side of a surface.
    ///
    /// Quadrangles much longer than wide become rows of squarer ones, but not of shorter ones than `shortest`.
    pub(crate) fn add_side(&mut self, polygon: &Polygon, side: u32, shortest: f64) {
        for quad in polygon.quads() {
            if quad[2] == quad[3] {
                self.add_root(&quad[..3], side);
                continue;
            }
            for part in squarer(quad, shortest) {
                self.add_root(&part, side);
            }
        }
    }

    fn add_root(&mut self, corners: &[DVec3], side: u32) {
        let ids: Vec<u32> = corners.iter().map(|&p| self.vertex(p)).collect();
        if let Some(element) = self.element(&ids, side) {
            self.roots.push(self.elements.len() as u32);
            self.elements.push(element);
        }
    }

    fn vertex(&mut self, p: DVec3) -> u32 {
        // −0.0 + 0.0 is 0.0: both zeros have the same key.
        let key = [p.x + 0.0, p.y + 0.0, p.z + 0.0].map(f64::to_bits);
        let next = self.vertices.len() as u32;
        let id = *self.places.entry(key).or_insert(next);
        if id == next {
            self.vertices.push(p);
        }
        id
    }

    fn middle(&mut self, a: u32, b: u32) -> u32 {
        let key = (a.min(b), a.max(b));
        if let Some(&id) = self.middles.get(&key) {
            return id;
        }
        let id = self.vertex(0.5 * (self.vertices[a as usize] + self.vertices[b as usize]));
        self.middles.insert(key, id);
        id
    }

    /// The vertex in the middle of two others, if an edge between them was divided. `None` also if the two are so near that their middle
    /// rounds to one of them.
    pub(crate) fn known_middle(&self, a: u32, b: u32) -> Option<u32> {
        self.middles.get(&(a.min(b), a.max(b))).copied().filter(|&middle| middle != a && middle != b)
    }

    fn element(&self, ids: &[u32], side: u32) -> Option<Element> {
        let ring: Vec<DVec3> = ids.iter().map(|&i| self.vertices[i as usize]).collect();
        let polygon = Polygon::unchecked(ring)?;
        let size =
            crate::polygon::edges(polygon.vertices()).fold(0.0, |m: f64, (a, b)| m.max((b - a).length()));
        let mut corners = [0; 4];
        corners[..ids.len()].copy_from_slice(ids);
        Some(Element { polygon, corners, first_child: 0, side, size })
    }

    /// Divides a leaf in four; false, without a change, if one of the parts would have no area.
    pub(crate) fn divide(&mut self, id: ElementId) -> bool {
        let (corners, side) =
            (self.elements[id as usize].corners().to_vec(), self.elements[id as usize].side);
        let n = corners.len();
        let middles: Vec<u32> = (0..n).map(|i| self.middle(corners[i], corners[(i + 1) % n])).collect();
        let parts: Vec<Vec<u32>> = if n == 3 {
            let mut list: Vec<Vec<u32>> =
                (0..3).map(|i| vec![corners[i], middles[i], middles[(i + 2) % 3]]).collect();
            list.push(middles);
            list
        } else {
            let centre = self.middle(middles[0], middles[2]);
            (0..4).map(|i| vec![corners[i], middles[i], centre, middles[(i + 3) % 4]]).collect()
        };
        let children: Option<Vec<Element>> = parts.iter().map(|part| self.element(part, side)).collect();
        let Some(children) = children else { return false };
        self.elements[id as usize].first_child = self.elements.len() as u32;
        self.elements.extend(children);
        true
    }

    /// Divides until no edge is longer than `size` (scaled units), or until the area is below `area` if that is sooner; false if that takes more
    /// than `limit` elements.
    pub(crate) fn divide_all(&mut self, size: f64, area: f64, limit: usize) -> bool {
        // A patch has at most the area of the square of its longest edge, so at least this many are needed: an impossible size is refused
        // before any work.
        let least = self.elements.iter().map(|e| e.polygon.area()).sum::<f64>() / (size * size);
        if least > limit as f64 {
            return false;
        }
        let mut next = 0;
        while next < self.elements.len() {
            let Element { size: longest, polygon, .. } = &self.elements[next];
            if *longest > size && polygon.area() > area && !self.divide(next as u32) {
                // Its parts would have no area in `f64`: it stays a leaf.
                self.elements[next].size = size;
            }
            if self.elements.len() > limit {
                return false;
            }
            next += 1;
        }
        true
    }

    /// Makes leaves of divided elements whose edges are no longer than `size`, or whose area is at most `area`.
    pub(crate) fn merge(&mut self, size: f64, area: f64) {
        let is_fine = |e: &&mut Element| e.size <= size || e.polygon.area() <= area;
        self.elements.iter_mut().filter(is_fine).for_each(|element| element.first_child = 0);
    }

    /// Calls `f` with the leaves below an element, in order.
    pub(crate) fn leaves_below(&self, id: ElementId, f: &mut impl FnMut(ElementId)) {
        let element = &self.elements[id as usize];
        if element.is_leaf() {
            f(id);
        }
        for child in element.children() {
            self.leaves_below(child, f);
        }
    }

    /// All leaves, root by root.
    pub(crate) fn leaves(&self) -> Vec<ElementId> {
        let mut list = vec![];
        for &root in &self.roots {
            self.leaves_below(root, &mut |leaf| list.push(leaf));
        }
        list
    }
}

/// A long quadrangle as a row of at most [`MAX_ROW`] squarer ones; as it is if its sides differ by less than [`ASPECT`].
fn squarer([a, b, c, d]: [DVec3; 4], shortest: f64) -> Vec<[DVec3; 4]> {
    let length = 0.5 * ((b - a).length() + (c - d).length());
    let width = 0.5 * ((d - a).length() + (c - b).length());
    if length.max(width) <= ASPECT * length.min(width) {
        return vec![[a, b, c, d]];
    }
    if width > length {
        return squarer([b, c, d, a], shortest);
    }
    let count = (length / width.max(shortest)).round().clamp(1.0, MAX_ROW as f64) as usize;
    let along = |p: DVec3, q: DVec3, i: usize| {
        // The ends are the corners bit for bit: quadrangles that share corners then share vertices.
        if i == 0 {
            p
        } else if i == count {
            q
        } else {
            p + (q - p) * (i as f64 / count as f64)
        }
    };
    (0..count).map(|i| [along(a, b, i), along(a, b, i + 1), along(d, c, i + 1), along(d, c, i)]).collect()
}
