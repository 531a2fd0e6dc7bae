//! The items that are drawn for a node, in the node's own frame: its points or links, one by one or in pairs.

use crate::attributes::Attributes;
use crate::batch::BATCH;
use crate::cloud::Cloud;
use crate::lattice::offset;
use crate::links::radius_of_area;
use crate::node::Node;
use crate::packed;
use crate::packed_links::PackedLinks;
use pulp::{Arch, NullaryFnOnce};
use std::ops::Range;

/// One value of each disc; twice as many before pairs become one disc each.
pub(crate) type Values = [f32; 2 * BATCH];

/// Discs in the frame of their node.
pub(crate) struct Items {
    pub(crate) offsets: [Values; 3],
    pub(crate) normals: [Values; 3],
    /// What light sees in their place, if points have such normals.
    pub(crate) shading_normals: [Values; 3],
    pub(crate) radii: Values,
    pub(crate) areas: Values,
    /// The way between the places of a pair, times their standard deviation in shares of it; 0 for one item.
    pub(crate) spreads: [Values; 3],
    /// Colors without light, if points have any; premultiplied by the opacity.
    pub(crate) paint: [Values; 3],
    /// 1 unless points have opacities.
    pub(crate) opacities: Values,
}

impl Items {
    pub(crate) const NOTHING: Self = Self {
        offsets: [[0.0; 2 * BATCH]; 3],
        normals: [[0.0; 2 * BATCH]; 3],
        shading_normals: [[0.0; 2 * BATCH]; 3],
        radii: [0.0; 2 * BATCH],
        areas: [0.0; 2 * BATCH],
        spreads: [[0.0; 2 * BATCH]; 3],
        paint: [[0.0; 2 * BATCH]; 3],
        opacities: [1.0; 2 * BATCH],
    };

    /// Takes items of a node, at most [`BATCH`] discs.
    pub(crate) fn take(&mut self, cloud: &Cloud, node: &Node, run: &Run) {
        Arch::new().dispatch(Take { discs: self, cloud, node, run });
    }
}

/// Items that follow one another.
#[derive(Clone, Debug)]
pub(crate) struct Run {
    items: Range<usize>,
    in_pairs: bool,
}

impl Run {
    /// All of a node.
    pub(crate) fn all(node: &Node, in_pairs: bool) -> impl Iterator<Item = Self> {
        let (start, end) = (node.items.start as usize, node.items.end as usize);
        let middle = if in_pairs { start + 2 * node.pairs as usize } else { start };
        let parts = move |items: Range<usize>, in_pairs: bool| {
            let step = if in_pairs { 2 * BATCH } else { BATCH };
            let end = items.end;
            items.step_by(step).map(move |first| Self { items: first..(first + step).min(end), in_pairs })
        };
        parts(start..middle, true).chain(parts(middle..end, false))
    }

    /// The number of its discs.
    pub(crate) fn discs(&self) -> usize {
        self.items.len() / if self.in_pairs { 2 } else { 1 }
    }
}

struct Take<'a> {
    discs: &'a mut Items,
    cloud: &'a Cloud,
    node: &'a Node,
    run: &'a Run,
}

impl NullaryFnOnce for Take<'_> {
    type Output = ();

    // Everything is inlined: a function compiled on its own would not use the wide instructions.
    #[inline(always)]
    fn call(self) {
        let Self { discs, cloud, node, run } = self;
        if node.is_leaf() {
            discs.take_points(&cloud.points, node, run.items.clone());
        } else {
            discs.take_links(&cloud.links, node, run.items.clone());
        }
        if !cloud.has_opacities() {
            discs.opacities.fill(1.0);
        }
        if run.in_pairs {
            discs.unite(cloud.has_shading_normals());
        } else {
            discs.spreads.iter_mut().for_each(|s| s[..BATCH].fill(0.0));
        }
    }
}

impl Items {
    #[inline(always)]
    fn take_points(&mut self, points: &Attributes, node: &Node, items: Range<usize>) {
        let count = items.len();
        for axis in 0..3 {
            let cells = &points.cells[axis][items.clone()];
            for (to, &cell) in self.offsets[axis].iter_mut().zip(cells) {
                *to = offset(node.origin[axis], cell);
            }
            self.normals[axis][..count].copy_from_slice(&points.normals[axis][items.clone()]);
        }
        if let Some(normals) = &points.shading_normals {
            unpack(&normals[items.clone()], &mut self.shading_normals);
        }
        self.radii[..count].copy_from_slice(&points.radii[items.clone()]);
        self.areas[..count].copy_from_slice(&points.areas[items.clone()]);
        if let Some(colors) = &points.colors {
            self.take_colors(colors[items.clone()].iter().copied());
        }
        if let Some(opacities) = &points.opacities {
            self.take_opacities(opacities[items].iter().copied());
        }
    }

    #[inline(always)]
    fn take_links(&mut self, links: &PackedLinks, node: &Node, items: Range<usize>) {
        for axis in 0..3 {
            for (to, &place) in self.offsets[axis].iter_mut().zip(&links.places[axis][items.clone()]) {
                *to = node.offset(axis, place);
            }
        }
        unpack(&links.normals[items.clone()], &mut self.normals);
        if let Some(normals) = &links.shading_normals {
            unpack(&normals[items.clone()], &mut self.shading_normals);
        }
        let areas = &links.areas[items.clone()];
        for ((radius, to), &share) in self.radii.iter_mut().zip(&mut self.areas).zip(areas) {
            let area = node.area(share);
            (*radius, *to) = (radius_of_area(area), area);
        }
        if let Some(colors) = &links.colors {
            self.take_colors(colors[items.clone()].iter().map(|&c| packed::unpack_color(c)));
        }
        if let Some(opacities) = &links.opacities {
            self.take_opacities(opacities[items].iter().map(|&o| packed::unpack_share(o)));
        }
    }

    #[inline(always)]
    fn take_colors(&mut self, colors: impl Iterator<Item = [f32; 3]>) {
        let [red, green, blue] = &mut self.paint;
        for (((red, green), blue), color) in red.iter_mut().zip(green).zip(blue).zip(colors) {
            [*red, *green, *blue] = color;
        }
    }

    /// After the colors, which become premultiplied.
    #[inline(always)]
    fn take_opacities(&mut self, opacities: impl Iterator<Item = f32>) {
        let [red, green, blue] = &mut self.paint;
        let paint = red.iter_mut().zip(green).zip(blue);
        for ((((red, green), blue), to), opacity) in paint.zip(&mut self.opacities).zip(opacities) {
            *to = opacity;
            (*red, *green, *blue) = (*red * opacity, *green * opacity, *blue * opacity);
        }
    }

    /// Makes one disc of two that follow one another: with the sum of their areas, the means by area of all else, and
    /// the covariance of both together. It computes the whole capacity, because the compiler vectorises loops of
    /// constant length.
    #[inline(always)]
    fn unite(&mut self, has_shading_normals: bool) {
        let (mut shares, mut deviations) = ([0.0; BATCH], [0.0; BATCH]);
        for i in 0..BATCH {
            let (first, second) = (self.areas[2 * i], self.areas[2 * i + 1]);
            let (r, q) = (self.radii[2 * i], self.radii[2 * i + 1]);
            let share = second / (first + second);
            (shares[i], deviations[i]) = (share, (share - share * share).sqrt());
            self.areas[i] = first + second;
            self.radii[i] = (r * r + (q * q - r * r) * share).sqrt();
        }
        for (offsets, spreads) in self.offsets.iter().zip(&mut self.spreads) {
            for i in 0..BATCH {
                spreads[i] = (offsets[2 * i + 1] - offsets[2 * i]) * deviations[i];
            }
        }
        let shading = if has_shading_normals { &mut self.shading_normals[..] } else { &mut [] };
        let others = [&mut self.opacities].into_iter().chain(&mut self.paint).chain(shading);
        for values in self.offsets.iter_mut().chain(&mut self.normals).chain(others) {
            for i in 0..BATCH {
                let (first, second) = (values[2 * i], values[2 * i + 1]);
                values[i] = first + (second - first) * shares[i];
            }
        }
        normalise(&mut self.normals, BATCH);
        if has_shading_normals {
            normalise(&mut self.shading_normals, BATCH);
        }
    }
}

/// Unit vectors from their packed form.
#[inline(always)]
fn unpack(directions: &[u32], to: &mut [Values; 3]) {
    for (lane, &direction) in directions.iter().enumerate() {
        let way = packed::unpack_way(direction);
        (to[0][lane], to[1][lane], to[2][lane]) = (way.x, way.y, way.z);
    }
    normalise(to, directions.len());
}

/// Normalises vectors. The square roots are computed for a whole vector of items at once.
#[inline(always)]
fn normalise([x, y, z]: &mut [Values; 3], count: usize) {
    for (((x, y), z), _) in x.iter_mut().zip(y).zip(z).zip(0..count) {
        let inverse = 1.0 / (*x * *x + *y * *y + *z * *z).sqrt();
        (*x, *y, *z) = (*x * inverse, *y * inverse, *z * inverse);
    }
}
