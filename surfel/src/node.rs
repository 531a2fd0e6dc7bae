//! The nodes of the octree for the renderer: boxes, cones of normals, and the items that are drawn for them.

use crate::attributes::{Attributes, SMALLEST};
use crate::lattice::{between, offset};
use crate::links::{Link, area_of_radius, radius_of_area};
use crate::octree::Cube;
use crate::pairs::FARTHEST;
use glam::Vec3;
use pointillist_parallel as parallel;
use std::ops::Range;

/// Steps of a packed coordinate on either side of 0.
const STEPS: f32 = 32767.0;

/// Steps of a packed area.
const SHARES: f32 = 65535.0;

/// No radius may exceed the widest of its node by rounding: nodes are skipped by that.
const AREA_ROUNDED_DOWN: f32 = 1.0 - 1e-6;

/// All normals of a node lie within `half_angle_rad` of `axis`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cone {
    pub(crate) axis: Vec3,
    pub(crate) half_angle_rad: f32,
}

/// Which way all that lies below a node faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Facing {
    /// Some of it is seen from both sides, and so is all that is drawn for the node.
    BothWays,
    /// It is seen from the front, and faces everywhere.
    Everywhere,
    /// It is seen from the front.
    Within(Cone),
}

/// A cube of the octree, for the renderer.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Node {
    /// Middle of the box around its points.
    pub(crate) origin: [u32; 3],
    /// Half the sides of that box, units.
    pub(crate) half: Vec3,
    /// Of all points below.
    pub(crate) facing: Facing,
    /// Distance of what is drawn for it, units: the square root of its mean area.
    pub(crate) spacing: f32,
    /// Largest radius of what is drawn for it, units.
    pub(crate) widest: f32,
    /// What is drawn for it: links, or for a leaf points. Pairs of neighbours first, then those that have none.
    pub(crate) items: Range<u32>,
    pub(crate) pairs: u32,
    pub(crate) children: Range<u32>,
}

impl Node {
    pub(crate) fn is_leaf(&self) -> bool {
        self.children.is_empty()
    }

    /// Holds all normals of what is seen from the front only; none if that faces everywhere.
    pub(crate) fn cone(&self) -> Option<Cone> {
        match self.facing {
            Facing::Within(cone) => Some(cone),
            Facing::BothWays | Facing::Everywhere => None,
        }
    }

    /// Whether it only holds others together: see [`around`].
    pub(crate) fn is_bare(&self) -> bool {
        self.items.is_empty()
    }

    /// What is drawn for it with one disc for every pair.
    pub(crate) fn count_in_pairs(&self) -> usize {
        self.items.len() - self.pairs as usize
    }

    /// As `spacing`, with one disc for every pair.
    pub(crate) fn spacing_of_pairs(&self) -> f32 {
        self.spacing * (self.items.len() as f32 / self.count_in_pairs() as f32).sqrt()
    }

    /// A bound of radii with one disc for every pair: kernels have half of that for a standard deviation, and the
    /// places of a pair up to half of what they are apart.
    pub(crate) fn widest_of_pairs(&self) -> f32 {
        self.widest * (1.0 + FARTHEST * FARTHEST).sqrt()
    }

    /// The area of a link in 65535ths of the largest of an inner node.
    pub(crate) fn share(&self, area: f32) -> u16 {
        // At least 1: what has no area has no kernel either.
        (area / self.share_unit()).round().clamp(1.0, SHARES) as u16
    }

    /// That area again, square units; off by 1/131070 of the largest at most, or by as much as that is rounded down.
    #[inline(always)]
    pub(crate) fn area(&self, share: u16) -> f32 {
        f32::from(share) * self.share_unit()
    }

    #[inline(always)]
    fn share_unit(&self) -> f32 {
        area_of_radius(self.widest) * (AREA_ROUNDED_DOWN / SHARES)
    }

    /// A coordinate of a cell of its box in steps of half a side over [`STEPS`], from the middle.
    pub(crate) fn relative_cell(&self, axis: usize, cell: u32) -> i16 {
        (offset(self.origin[axis], cell) / self.half[axis] * STEPS).round() as i16
    }

    /// That coordinate again, units from the middle; off by 1/65534 of half a side at most.
    #[inline(always)]
    pub(crate) fn offset(&self, axis: usize, place: i16) -> f32 {
        f32::from(place) * (self.half[axis] * (1.0 / STEPS))
    }
}

/// Boxes, cones and sizes of all cubes, the deepest first. `two_sided`: which points are seen from both sides.
pub(crate) fn nodes(
    cubes: &[Cube],
    generations: &[usize],
    links: &[Vec<Link>],
    points: &Attributes,
    two_sided: &[bool],
) -> Vec<Node> {
    let mut starts = Vec::with_capacity(cubes.len());
    let mut link_count = 0;
    for list in links {
        starts.push(link_count);
        link_count += list.len() as u32;
    }
    let mut nodes: Vec<Option<Node>> = vec![None; cubes.len()];
    for generation in generations.windows(2).rev() {
        let made = parallel::map_heavy(generation[1] - generation[0], |i| {
            let (number, cube) = (generation[0] + i, &cubes[generation[0] + i]);
            if cube.children.is_empty() {
                leaf(cube, points, two_sided)
            } else {
                let children: Vec<&Node> = nodes[cube.children.clone()].iter().flatten().collect();
                inner(cube, &children, &links[number], starts[number])
            }
        });
        for (i, node) in made.into_iter().enumerate() {
            nodes[generation[0] + i] = Some(node);
        }
    }
    nodes.into_iter().flatten().collect()
}

/// The middle of a box of cells, and half its sides in units, rounded up. The middle is rounded up too: from it, no
/// cell of the lattice is more than 2³¹ cells down or 2³¹ − 1 up, as [`offset`] requires.
fn middle_and_half(low: [u32; 3], high: [u32; 3]) -> ([u32; 3], Vec3) {
    let middle = [0, 1, 2].map(|i| low[i] + (high[i] - low[i]).div_ceil(2));
    let half = between(middle, high).max(between(low, middle)) * (1.0 + 1e-6) + SMALLEST;
    (middle, half)
}

fn spacing(area: f32, count: usize) -> f32 {
    (area / count as f32).sqrt()
}

fn leaf(cube: &Cube, points: &Attributes, two_sided: &[bool]) -> Node {
    let range = cube.points.clone();
    let ends = |axis: usize| {
        let cells = &points.cells[axis][range.clone()];
        cells.iter().fold((u32::MAX, 0), |(low, high), &c| (c.min(low), c.max(high)))
    };
    let ends = [ends(0), ends(1), ends(2)];
    let (origin, half) = middle_and_half(ends.map(|e| e.0), ends.map(|e| e.1));
    let normals = range.clone().map(|p| points.normal(p));
    Node {
        origin,
        half,
        facing: if two_sided[range.clone()].contains(&true) {
            Facing::BothWays
        } else {
            cone(normals).map_or(Facing::Everywhere, Facing::Within)
        },
        spacing: spacing(points.areas[range.clone()].iter().sum(), range.len()),
        widest: points.radii[range.clone()].iter().copied().fold(0.0, f32::max),
        items: range.start as u32..range.end as u32,
        pairs: 0,
        children: 0..0,
    }
}

/// What rounding may add to the angle between normals.
const ROUNDING_RAD: f32 = 2e-3;

fn cone(normals: impl Iterator<Item = Vec3> + Clone) -> Option<Cone> {
    let axis = normals.clone().sum::<Vec3>().try_normalize()?;
    let widest = normals.map(|n| n.dot(axis)).fold(1.0, f32::min);
    Some(Cone { axis, half_angle_rad: widest.clamp(-1.0, 1.0).acos() + ROUNDING_RAD })
}

/// The middle of the box around some nodes, and half its sides.
fn box_around(children: &[&Node]) -> ([u32; 3], Vec3) {
    // Bounds grow by rounding from level to level; as whole numbers they do not.
    let reach = |node: &Node, axis: usize| (f64::from(node.half[axis]) * 4_294_967_296.0).ceil() as u32;
    let low = [0, 1, 2].map(|axis| {
        children.iter().map(|c| c.origin[axis].saturating_sub(reach(c, axis))).min().unwrap_or(0)
    });
    let high = [0, 1, 2].map(|axis| {
        children.iter().map(|c| c.origin[axis].saturating_add(reach(c, axis))).max().unwrap_or(0)
    });
    middle_and_half(low, high)
}

fn inner(cube: &Cube, children: &[&Node], links: &[Link], first_link: u32) -> Node {
    let (origin, half) = box_around(children);
    let area = links.iter().map(|l| l.area).sum();
    Node {
        origin,
        half,
        facing: facing_around(children, links),
        spacing: spacing(area, links.len()),
        widest: links.iter().map(|l| radius_of_area(l.area)).fold(0.0, f32::max),
        items: first_link..first_link + links.len() as u32,
        pairs: 0,
        children: cube.children.start as u32..cube.children.end as u32,
    }
}

/// A node around others that has nothing to draw itself: they are drawn in its place at any distance.
pub(crate) fn around(children: &[&Node], numbers: Range<u32>) -> Node {
    let (origin, half) = box_around(children);
    Node {
        origin,
        half,
        facing: facing_around(children, &[]),
        spacing: f32::INFINITY,
        widest: children.iter().map(|c| c.widest).fold(0.0, f32::max),
        items: 0..0,
        pairs: 0,
        children: numbers,
    }
}

/// Which way a node faces that holds others and links.
fn facing_around(children: &[&Node], links: &[Link]) -> Facing {
    if children.iter().any(|c| c.facing == Facing::BothWays) {
        return Facing::BothWays;
    }
    cone_around(children, links).map_or(Facing::Everywhere, Facing::Within)
}

/// Holds the cones of all children and the mean normals of the links.
fn cone_around(children: &[&Node], links: &[Link]) -> Option<Cone> {
    let cones: Vec<Cone> = children.iter().map(|c| c.cone()).collect::<Option<_>>()?;
    let axis = cones.iter().map(|c| c.axis).sum::<Vec3>().try_normalize()?;
    let below = cones.iter().map(|c| c.axis.angle_between(axis) + c.half_angle_rad).fold(0.0, f32::max);
    let own = links.iter().map(|l| l.normal.angle_between(axis)).fold(0.0, f32::max);
    Some(Cone { axis, half_angle_rad: below.max(own) + ROUNDING_RAD })
}
