//! Where the items of a node are on the picture, and which way they face.

use crate::camera::Camera;
use crate::grid::TileRect;
use crate::node::{Facing, Node};
use crate::vector::Vector;
use glam::{DVec3, Vec3};
use pulp::Simd;

/// The map from a node's frame to a tile.
#[derive(Clone, Copy)]
pub(crate) struct Map {
    /// Rows x·w, y·w and relative depth, with w the depth or 1.
    rows: [f32; 12],
    /// The tile's first pixel, and the principal point in the tile.
    pub(crate) first: [f32; 2],
    centre: [f32; 2],
    /// Last row and column, not included.
    pub(crate) size: [f32; 2],
    both_sides: bool,
    margin: f32,
    /// The edges of the picture, from the tile's first pixel.
    edges: [Edges; 2],
}

/// Two opposite edges of the picture.
#[derive(Clone, Copy)]
struct Edges {
    first: f32,
    last: f32,
    /// Distance of a point from the plane through the eye and an edge, as pixels across at the point's depth over pixels along the plane's normal.
    roots: [f32; 2],
}

/// Pixels that are added to what is seen of a disc.
const PAD_PX: f32 = 4.0;

impl Edges {
    fn new(camera: &Camera, size: u32, centre: f64, tile: usize) -> Self {
        let root = |edge: f64| {
            let slope = if camera.is_perspective { (edge - centre) / f64::from(camera.focal) } else { 0.0 };
            slope.hypot(1.0) as f32
        };
        let size = f64::from(size);
        let (first, last) = (-(tile as f64) as f32 - PAD_PX, (size - tile as f64) as f32 + PAD_PX);
        Self { first, last, roots: [root(0.0), root(size)] }
    }
}

impl Map {
    /// `margin` is how far from its centre any disc of `node` may touch pixels.
    pub(crate) fn new(camera: &Camera, node: &Node, margin: f32, tile: &TileRect) -> Self {
        let f = f64::from(camera.focal);
        let (right, down, forward) = (camera.view.right(), -camera.view.up(), camera.view.forward());
        let origin = camera.local(node);
        let [cx, cy] = [camera.centre[0] - tile.x as f64, camera.centre[1] - tile.y as f64];
        let (x, y) = if camera.is_perspective {
            (
                (f * right + cx * forward, f * origin.x + cx * origin.z),
                (f * down + cy * forward, f * origin.y + cy * origin.z),
            )
        } else {
            ((f * right, f * origin.x + cx), (f * down, f * origin.y + cy))
        };
        let depth = (forward, origin.z - camera.reference);
        let mut rows = [0.0; 12];
        for (row, (n, offset)) in rows.chunks_exact_mut(4).zip::<[(DVec3, f64); 3]>([x, y, depth]) {
            row.copy_from_slice(&[n.x as f32, n.y as f32, n.z as f32, offset as f32]);
        }
        let size = [tile.width as f32, tile.height as f32];
        let first = [tile.x as f32, tile.y as f32];
        let edges = [
            Edges::new(camera, camera.view.width(), camera.centre[0], tile.x),
            Edges::new(camera, camera.view.height(), camera.centre[1], tile.y),
        ];
        let both_sides = camera.sees_both_sides || node.facing == Facing::BothWays;
        Self { rows, first, centre: [cx as f32, cy as f32], size, both_sides, margin, edges }
    }

    /// Which discs have anything in view, by the balls around them.
    ///
    /// The ellipse of a disc next to the plane through the eye is no bound: as a map of the surroundings of its centre, it may reach
    /// all over the picture from a disc that lies far beside it.
    #[inline(always)]
    pub(crate) fn may_see<S: Simd>(&self, simd: S, place: [Vector<S>; 2], reach_px: Vector<S>) -> S::m32s {
        let [x, y] = [0, 1].map(|axis| {
            let Edges { first, last, roots } = self.edges[axis];
            let after = (place[axis] + reach_px * roots[0]).exceeds(first);
            simd.and_m32s(after, (reach_px * roots[1] - place[axis]).exceeds(-last))
        });
        simd.and_m32s(x, y)
    }
}

/// Where centres are on the picture, and which way discs face.
pub(crate) struct Placed<S: Simd> {
    pub(crate) x: Vector<S>,
    pub(crate) y: Vector<S>,
    pub(crate) depth: Vector<S>,
    /// 1/distance from the eye along the view axis, and pixels per unit there.
    pub(crate) inverse: Vector<S>,
    pub(crate) scale: Vector<S>,
    /// Vector from the eye to the centre, over its component along the view axis.
    pub(crate) way: [Vector<S>; 2],
    pub(crate) normal: [Vector<S>; 3],
    /// See [`crate::items::Items::spreads`].
    pub(crate) spread: [Vector<S>; 3],
    /// Product of the normal and the vector (`way`, 1): below 0 where the disc faces the eye.
    pub(crate) facing: Vector<S>,
}

impl<S: Simd> Placed<S> {
    /// Steps: 1 place and depth; 2 normal, seen from the eye.
    #[inline(always)]
    pub(crate) fn new(
        simd: S,
        camera: &Camera,
        map: &Map,
        offset: [Vector<S>; 3],
        normal: [Vector<S>; 3],
        spread: [Vector<S>; 3],
    ) -> Self {
        // 1
        let rows = map.rows;
        let depth = row(offset, [rows[8], rows[9], rows[10]]) + rows[11];
        let inverse = (depth + camera.reference as f32).inverse();
        let w = if camera.is_perspective { inverse } else { Vector::all(simd, 1.0) };
        let x = (row(offset, [rows[0], rows[1], rows[2]]) + rows[3]) * w;
        let y = (row(offset, [rows[4], rows[5], rows[6]]) + rows[7]) * w;
        // 2
        let slope = if camera.is_perspective { 1.0 / camera.focal } else { 0.0 };
        let way = [(x - map.centre[0]) * slope, (y - map.centre[1]) * slope];
        let (normal, spread) = (turned(normal, &camera.axes), turned(spread, &camera.axes));
        let facing = normal[0] * way[0] + normal[1] * way[1] + normal[2];
        let scale = w * camera.focal;
        let mut placed = Self { x, y, depth, inverse, scale, way, normal, spread, facing };
        if map.both_sides {
            let flip = Vector::all(simd, -1.0).if_set(facing.exceeds(0.0), 1.0);
            placed.facing = facing * flip;
            placed.normal = [normal[0] * flip, normal[1] * flip, normal[2] * flip];
        }
        placed
    }

    /// Which discs face the eye and may have parts in the tile.
    #[inline(always)]
    pub(crate) fn may_show(&self, simd: S, camera: &Camera, map: &Map) -> S::m32s {
        let right =
            simd.and_m32s(self.x.exceeds(-map.margin), (-self.x).exceeds(-(map.size[0] + map.margin)));
        let below =
            simd.and_m32s(self.y.exceeds(-map.margin), (-self.y).exceeds(-(map.size[1] + map.margin)));
        let faces = simd.and_m32s(self.depth.exceeds(camera.near), (-self.facing).exceeds(0.0));
        simd.and_m32s(simd.and_m32s(right, below), faces)
    }
}

#[inline(always)]
fn row<S: Simd>(v: [Vector<S>; 3], row: [f32; 3]) -> Vector<S> {
    v[0] * row[0] + v[1] * row[1] + v[2] * row[2]
}

#[inline(always)]
pub(crate) fn turned<S: Simd>(v: [Vector<S>; 3], [a, b, c]: &[Vec3; 3]) -> [Vector<S>; 3] {
    [row(v, a.to_array()), row(v, b.to_array()), row(v, c.to_array())]
}
