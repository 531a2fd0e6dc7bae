//! From the items of a node to discs on the picture.

use crate::cloud::{Cloud, Node, radius_of_area};
use crate::lattice::offset;
use crate::links::Links;
use crate::packed;
use crate::select::Selected;
use crate::splat::{LANES, Lanes, Map, Placed, Projected, Shape, Splat, Value, project};
use crate::tile::{self, Scene};
use crate::vector::Vector;
use pulp::{Arch, Simd, WithSimd};
use std::ops::Range;

/// What is drawn of a node.
pub(crate) struct Items<'a> {
    pub(crate) node: &'a Node,
    /// How many of its items, evenly among all, for all.
    pub(crate) drawn: usize,
    /// No disc touches pixels farther from its centre.
    pub(crate) margin: f32,
}

impl<'a> Items<'a> {
    pub(crate) fn new(node: &'a Node, selected: &Selected) -> Self {
        Self { node, drawn: selected.drawn as usize, margin: selected.margin }
    }

    /// The item that is drawn after so many others.
    #[inline(always)]
    fn item(&self, rank: usize) -> usize {
        self.node.items.start as usize + rank * self.node.items.len() / self.drawn
    }

    /// How many items one stands for.
    fn share(&self) -> f32 {
        self.node.items.len() as f32 / self.drawn as f32
    }
}

/// Items of a node in its own frame, and on the picture.
pub(crate) struct Projector {
    offsets: [Lanes; 3],
    normals: [Lanes; 3],
    radii: Lanes,
    areas: Lanes,
    /// Colours without light, if points have any.
    paint: [Lanes; 3],
    out: Projected,
}

impl Projector {
    pub(crate) fn new() -> Box<Self> {
        let zero = [0.0; LANES];
        Box::new(Self {
            offsets: [zero; 3],
            normals: [zero; 3],
            radii: zero,
            areas: zero,
            paint: [zero; 3],
            out: Projected::NOTHING,
        })
    }

    /// Appends what `drawn` puts into a tile.
    pub(crate) fn project(
        &mut self,
        scene: &Scene<'_>,
        drawn: &Items<'_>,
        shape: &Shape,
        tile: &tile::Place,
        splats: &mut Vec<Splat>,
    ) {
        let arch = Arch::new();
        let map = Map::new(&scene.camera, drawn, tile, scene.cloud.two_sided);
        let first = drawn.node.items.start as usize;
        for start in (0..drawn.drawn).step_by(LANES) {
            let ranks = start..(start + LANES).min(drawn.drawn);
            let count = ranks.len();
            if !drawn.node.is_leaf() {
                self.take_links(&scene.cloud.links, drawn, ranks);
            } else if drawn.drawn < drawn.node.items.len() {
                self.take_points(scene.cloud, drawn, ranks);
            } else {
                self.take_run(scene.cloud, drawn.node, first + ranks.start..first + ranks.end);
            }
            arch.dispatch(Project { lanes: self, scene, shape, map: &map, count });
            // Written in place: to push what was made elsewhere copies it once more.
            let mut next = splats.len();
            splats.extend_from_slice(&[Splat::NONE; LANES][..count]);
            for i in 0..count {
                if self.out.get(i, Value::Kept) > 0.0 {
                    splats[next] = self.out.splat(i);
                    next += 1;
                }
            }
            splats.truncate(next);
        }
    }

    /// Takes points that follow one another.
    fn take_run(&mut self, cloud: &Cloud, node: &Node, items: Range<usize>) {
        let points = &cloud.points;
        let count = items.len();
        for axis in 0..3 {
            let cells = &points.cells[axis][items.clone()];
            for (to, &cell) in self.offsets[axis].iter_mut().zip(cells) {
                *to = offset(node.origin[axis], cell);
            }
            self.normals[axis][..count].copy_from_slice(&points.normals[axis][items.clone()]);
        }
        self.radii[..count].copy_from_slice(&points.radii[items.clone()]);
        self.areas[..count].copy_from_slice(&points.areas[items.clone()]);
        if let Some(colours) = &points.colours {
            let [red, green, blue] = &mut self.paint;
            let paint = red.iter_mut().zip(green).zip(blue);
            for (((red, green), blue), colour) in paint.zip(&colours[items]) {
                [*red, *green, *blue] = *colour;
            }
        }
    }

    /// Takes points one by one.
    fn take_points(&mut self, cloud: &Cloud, drawn: &Items<'_>, ranks: Range<usize>) {
        let points = &cloud.points;
        for (lane, point) in ranks.map(|rank| drawn.item(rank)).enumerate() {
            let colour = points.colours.as_ref().map_or([0.0; 3], |all| all[point]);
            for (axis, channel) in colour.into_iter().enumerate() {
                self.offsets[axis][lane] = offset(drawn.node.origin[axis], points.cells[axis][point]);
                self.normals[axis][lane] = points.normals[axis][point];
                self.paint[axis][lane] = channel;
            }
            self.areas[lane] = points.areas[point] * drawn.share();
            self.radii[lane] = points.radii[point];
        }
    }

    /// Takes links one by one.
    fn take_links(&mut self, links: &Links, drawn: &Items<'_>, ranks: Range<usize>) {
        let count = ranks.len();
        for (lane, link) in ranks.map(|rank| drawn.item(rank)).enumerate() {
            let way = packed::unpack_way(links.normals[link]);
            let colour = links.colours.as_ref().map_or([0.0; 3], |all| packed::unpack_colour(all[link]));
            for (axis, channel) in colour.into_iter().enumerate() {
                self.offsets[axis][lane] = drawn.node.offset(axis, links.places[axis][link]);
                self.normals[axis][lane] = way[axis];
                self.paint[axis][lane] = channel;
            }
            self.areas[lane] = links.areas[link];
        }
        // Roots for all of them at once, as vectors.
        let [x, y, z] = &mut self.normals;
        for (((x, y), z), _) in x.iter_mut().zip(y).zip(z).zip(0..count) {
            let inverse = 1.0 / (*x * *x + *y * *y + *z * *z).sqrt();
            (*x, *y, *z) = (*x * inverse, *y * inverse, *z * inverse);
        }
        for ((radius, area), _) in self.radii.iter_mut().zip(&mut self.areas).zip(0..count) {
            *radius = radius_of_area(*area);
            *area *= drawn.share();
        }
    }
}

/// The arithmetic of [`Projector::project`].
struct Project<'a> {
    lanes: &'a mut Projector,
    scene: &'a Scene<'a>,
    shape: &'a Shape,
    map: &'a Map,
    count: usize,
}

impl WithSimd for Project<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { lanes, scene, shape, map, count } = self;
        let Projector { offsets, normals, radii, areas, paint, out } = lanes;
        let vector = |all: &Lanes, i: usize| Vector::new(simd, S::as_simd_f32s(all).0[i]);
        let vectors =
            |all: &[Lanes; 3], i: usize| [vector(&all[0], i), vector(&all[1], i), vector(&all[2], i)];
        for i in 0..count.div_ceil(S::F32_LANES) {
            let placed = Placed::new(simd, &scene.camera, map, vectors(offsets, i), vectors(normals, i));
            let may_show = placed.may_show(simd, &scene.camera, map);
            // Neighbours in the cloud are neighbours in the picture: often none of a vector is in the tile.
            if simd.first_true_m32s(may_show) == S::F32_LANES {
                out.set(i, Value::Kept, Vector::all(simd, 0.0));
                continue;
            }
            project(simd, &placed, [vector(radii, i), vector(areas, i)], (&scene.camera, shape, map), out, i);
            let at = (placed.x + map.first[0], placed.y + map.first[1]);
            let [red, green, blue] = scene.shader.lit(simd, vectors(paint, i), placed.normal, at);
            for (value, shaded) in [(Value::Red, red), (Value::Green, green), (Value::Blue, blue)] {
                out.set(i, value, shaded);
            }
        }
    }
}
