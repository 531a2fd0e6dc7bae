//! A cloud, made ready for drawing.

use crate::error::SurfelError;
use crate::lattice::{Lattice, between, morton, offset};
use crate::links::{self, Link, Links};
use crate::neighbours::Places;
use crate::octree::{self, Cube};
use crate::points::Points;
use crate::{areas, normals, pairs, radius};
use glam::{DVec3, Vec3};
use pointillist_parallel as parallel;
use std::cmp::Ordering;
use std::ops::Range;

/// Radii and areas are at least this many units: 2⁻³³, half a cell of the lattice.
const SMALLEST: f32 = 1.164_153_2e-10;

/// Steps of a packed coordinate on either side of 0.
const STEPS: f32 = 32767.0;

/// What points are: those of a leaf follow one another.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Attributes {
    pub(crate) cells: [Vec<u32>; 3],
    /// Unit vectors.
    pub(crate) normals: [Vec<f32>; 3],
    /// Units.
    pub(crate) radii: Vec<f32>,
    /// Share of the surface, square units.
    pub(crate) areas: Vec<f32>,
    pub(crate) colours: Option<Vec<[f32; 3]>>,
}

impl Attributes {
    pub(crate) fn cell(&self, point: usize) -> [u32; 3] {
        [0, 1, 2].map(|axis| self.cells[axis][point])
    }

    pub(crate) fn normal(&self, point: usize) -> Vec3 {
        Vec3::from_array([0, 1, 2].map(|axis| self.normals[axis][point]))
    }

    /// Puts the point that was at `places[i]` at place i.
    pub(crate) fn reorder(&mut self, places: &[u32]) {
        fn reordered<T: Copy>(list: &mut Vec<T>, places: &[u32]) {
            *list = places.iter().map(|&old| list[old as usize]).collect();
        }
        self.cells.iter_mut().for_each(|list| reordered(list, places));
        self.normals.iter_mut().for_each(|list| reordered(list, places));
        reordered(&mut self.radii, places);
        reordered(&mut self.areas, places);
        self.colours.iter_mut().for_each(|list| reordered(list, places));
    }

    /// The point as a link that stands for itself.
    pub(crate) fn link(&self, point: usize) -> Link {
        let colour = self.colours.as_ref().map_or(Vec3::ZERO, |all| Vec3::from_array(all[point]));
        Link {
            point: point as u32,
            cell: self.cell(point),
            area: self.areas[point],
            normal: self.normal(point),
            colour,
        }
    }
}

/// All normals of a node lie within `half_angle_rad` of `axis`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cone {
    pub(crate) axis: Vec3,
    pub(crate) half_angle_rad: f32,
}

/// A cube of the octree as the renderer sees it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Node {
    /// Middle of the box around its points.
    pub(crate) origin: [u32; 3],
    /// Half the sides of that box, units.
    pub(crate) half: Vec3,
    /// Of all points below; none if they face everywhere.
    pub(crate) cone: Option<Cone>,
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

    /// What is drawn for it with one disc for every pair.
    pub(crate) fn count_in_pairs(&self) -> usize {
        self.items.len() - self.pairs as usize
    }

    /// As `spacing`, with one disc for every pair.
    pub(crate) fn spacing_of_pairs(&self) -> f32 {
        self.spacing * (self.items.len() as f32 / self.count_in_pairs() as f32).sqrt()
    }

    /// A bound of radii with one disc for every pair: kernels have half of that for a standard deviation, and the places of a
    /// pair up to half of what they are apart.
    pub(crate) fn widest_of_pairs(&self) -> f32 {
        self.widest * (1.0 + pairs::FARTHEST * pairs::FARTHEST).sqrt()
    }

    /// A coordinate of a cell of its box in steps of half a side over [`STEPS`], from the middle.
    pub(crate) fn place(&self, axis: usize, cell: u32) -> i16 {
        (offset(self.origin[axis], cell) / self.half[axis] * STEPS).round() as i16
    }

    /// That coordinate again, units from the middle; off by 1/65534 of half a side at most.
    #[inline(always)]
    pub(crate) fn offset(&self, axis: usize, place: i16) -> f32 {
        f32::from(place) * (self.half[axis] * (1.0 / STEPS))
    }
}

/// A cloud of surfels in an octree: points at the leaves, links to them above.
///
/// The same for every order of the points. Positions are kept to 2⁻³² of the cloud's extent.
#[derive(Clone, Debug, PartialEq)]
pub struct Cloud {
    pub(crate) lattice: Lattice,
    pub(crate) points: Attributes,
    pub(crate) nodes: Vec<Node>,
    pub(crate) links: Links,
    /// Whether normals may point to either side.
    pub(crate) two_sided: bool,
}

/// Radius of a disc over the square root of its share of the surface: a little more than half the diagonal of a square (0.71), so that discs
/// on a square lattice overlap at its corners.
const RADIUS_PER_ROOT_AREA: f32 = 0.75;

/// The radius that a link is drawn with.
pub(crate) fn radius_of_area(area: f32) -> f32 {
    RADIUS_PER_ROOT_AREA * area.sqrt()
}

impl Cloud {
    /// Sorts points into an octree; estimates what they lack.
    ///
    /// # Errors
    /// [`SurfelError::NoPoints`], [`SurfelError::TooMany`], [`SurfelError::LengthMismatch`], [`SurfelError::NotFinite`],
    /// [`SurfelError::BadNormal`], [`SurfelError::BadColour`], [`SurfelError::BadRadius`].
    pub fn new(points: &Points<'_>) -> Result<Self, SurfelError> {
        points.check()?;
        let lattice = Lattice::around(points.positions);
        let (mut attributes, codes) = in_order(points, &lattice);
        let (cubes, generations) = octree::divide(&codes);
        let mut links = links::make(&cubes, &generations, &attributes);
        let pairs = pairs::arrange(&cubes, &mut attributes, &mut links);
        let two_sided = points.normals.is_none();
        let mut nodes = nodes(&cubes, &generations, &links, &attributes, two_sided);
        nodes.iter_mut().zip(pairs).for_each(|(node, pairs)| node.pairs = pairs);
        let links = Links::pack(&links, &nodes, points.colours.is_some());
        Ok(Self { lattice, points: attributes, nodes, links, two_sided })
    }

    /// Number of points.
    #[must_use]
    #[expect(clippy::len_without_is_empty, reason = "a cloud has at least one point")]
    pub fn len(&self) -> usize {
        self.points.radii.len()
    }

    /// Whether points have colours of their own.
    #[must_use]
    pub fn has_colours(&self) -> bool {
        self.points.colours.is_some()
    }

    /// Whether normals were estimated; such a cloud is seen from both sides.
    #[must_use]
    pub fn has_estimated_normals(&self) -> bool {
        self.two_sided
    }

    /// All positions, in an order of the cloud's own, to 2⁻³² of its extent.
    pub fn positions(&self) -> impl Iterator<Item = DVec3> {
        (0..self.len()).map(|i| self.lattice.place(self.points.cell(i)))
    }

    /// Typical distance of neighbouring points, world units: the square root of the mean area of a point.
    #[must_use]
    pub fn spacing(&self) -> f64 {
        let area: f64 = self.points.areas.iter().map(|&a| f64::from(a)).sum();
        (area / self.len() as f64).sqrt() * self.lattice.side
    }

    /// Bytes per point besides position, normal, colour and radius: octree, links and areas.
    #[must_use]
    pub fn overhead_per_point(&self) -> f64 {
        let bytes = self.links.bytes()
            + size_of::<Node>() * self.nodes.len()
            + size_of::<f32>() * self.points.areas.len();
        bytes as f64 / self.len() as f64
    }
}

/// Estimates what is missing and brings all into an order that depends on what points are, not on how they came.
fn in_order(points: &Points<'_>, lattice: &Lattice) -> (Attributes, Vec<u64>) {
    let count = points.positions.len();
    let cells = parallel::map(count, |i| lattice.cell(points.positions[i]));
    let mut keys = parallel::map(count, |i| (morton(cells[i]), i as u32));
    parallel::sort_by(&mut keys, |a, b| {
        a.0.cmp(&b.0).then_with(|| compare(points, &cells, a.1 as usize, b.1 as usize))
    });
    // In units about the cube's corner: estimates see the same numbers wherever the cloud lies.
    let at = |i: u32| (points.positions[i as usize] - lattice.low) / lattice.side;
    let positions: Vec<DVec3> = keys.iter().map(|&(_, i)| at(i)).collect();
    let places = Places::new(&positions);
    let two_sided = points.normals.is_none();
    let unit = |n: Vec3| (n / n.abs().max_element()).normalize();
    let normals: Vec<Vec3> = match points.normals {
        Some(given) => keys.iter().map(|&(_, i)| unit(given[i as usize])).collect(),
        None => normals::estimate(&places),
    };
    let radii: Vec<f32> = match points.radii {
        Some(given) => {
            keys.iter().map(|&(_, i)| (f64::from(given[i as usize]) / lattice.side) as f32).collect()
        }
        None => radius::of_cloud(&places, &normals, two_sided),
    };
    let radii: Vec<f32> = radii.into_iter().map(|r| r.clamp(SMALLEST, 1e6)).collect();
    let areas = areas::of_cloud(&places, &normals, &radii, two_sided);
    let attributes = Attributes {
        cells: [0, 1, 2].map(|axis| keys.iter().map(|&(_, i)| cells[i as usize][axis]).collect()),
        normals: [0, 1, 2].map(|axis| normals.iter().map(|n| n[axis]).collect()),
        radii,
        areas: areas.into_iter().map(|a| a.clamp(SMALLEST * SMALLEST, 1e12)).collect(),
        colours: points.colours.map(|given| keys.iter().map(|&(_, i)| given[i as usize]).collect()),
    };
    (attributes, keys.into_iter().map(|key| key.0).collect())
}

/// Points of one code by everything that they are: those that are equal in all are the same.
fn compare(points: &Points<'_>, cells: &[[u32; 3]], a: usize, b: usize) -> Ordering {
    let exact = |i: usize| points.positions[i].to_array();
    let normal = |i: usize| points.normals.map_or([0.0; 3], |all| all[i].to_array());
    let colour = |i: usize| points.colours.map_or([0.0; 3], |all| all[i]);
    let radius = |i: usize| points.radii.map_or(0.0, |all| all[i]);
    let by = |p: [f32; 3], q: [f32; 3]| {
        p.iter().zip(&q).map(|(p, q)| p.total_cmp(q)).find(|o| o.is_ne()).unwrap_or(Ordering::Equal)
    };
    let by_position = || {
        exact(a)
            .iter()
            .zip(&exact(b))
            .map(|(p, q)| p.total_cmp(q))
            .find(|o| o.is_ne())
            .unwrap_or(Ordering::Equal)
    };
    cells[a]
        .cmp(&cells[b])
        .then_with(by_position)
        .then_with(|| by(normal(a), normal(b)))
        .then_with(|| by(colour(a), colour(b)))
        .then_with(|| radius(a).total_cmp(&radius(b)))
}

/// Boxes, cones and sizes of all cubes, the deepest first.
fn nodes(
    cubes: &[Cube],
    generations: &[usize],
    links: &[Vec<Link>],
    points: &Attributes,
    two_sided: bool,
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

/// The middle of a box of cells, and half its sides in units, rounded up. The middle is rounded up too: from it, no cell of the
/// lattice is more than 2³¹ cells down or 2³¹ − 1 up, as [`offset`] wants it.
fn middle_and_half(low: [u32; 3], high: [u32; 3]) -> ([u32; 3], Vec3) {
    let middle = [0, 1, 2].map(|i| low[i] + (high[i] - low[i]).div_ceil(2));
    let half = between(middle, high).max(between(low, middle)) * (1.0 + 1e-6) + SMALLEST;
    (middle, half)
}

fn spacing(area: f32, count: usize) -> f32 {
    (area / count as f32).sqrt()
}

fn leaf(cube: &Cube, points: &Attributes, two_sided: bool) -> Node {
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
        cone: if two_sided { None } else { cone(normals) },
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

fn inner(cube: &Cube, children: &[&Node], links: &[Link], first_link: u32) -> Node {
    // Bounds grow by rounding from level to level; as whole numbers they do not.
    let reach = |node: &Node, axis: usize| (f64::from(node.half[axis]) * 4_294_967_296.0).ceil() as u32;
    let low = [0, 1, 2].map(|axis| {
        children.iter().map(|c| c.origin[axis].saturating_sub(reach(c, axis))).min().unwrap_or(0)
    });
    let high = [0, 1, 2].map(|axis| {
        children.iter().map(|c| c.origin[axis].saturating_add(reach(c, axis))).max().unwrap_or(0)
    });
    let (origin, half) = middle_and_half(low, high);
    let area = links.iter().map(|l| l.area).sum();
    Node {
        origin,
        half,
        cone: cone_around(children, links),
        spacing: spacing(area, links.len()),
        widest: links.iter().map(|l| radius_of_area(l.area)).fold(0.0, f32::max),
        items: first_link..first_link + links.len() as u32,
        pairs: 0,
        children: cube.children.start as u32..cube.children.end as u32,
    }
}

/// Holds the cones of all children and the mean normals of the links.
fn cone_around(children: &[&Node], links: &[Link]) -> Option<Cone> {
    let cones: Vec<Cone> = children.iter().map(|c| c.cone).collect::<Option<_>>()?;
    let axis = cones.iter().map(|c| c.axis).sum::<Vec3>().try_normalize()?;
    let below = cones.iter().map(|c| c.axis.angle_between(axis) + c.half_angle_rad).fold(0.0, f32::max);
    let own = links.iter().map(|l| l.normal.angle_between(axis)).fold(0.0, f32::max);
    Some(Cone { axis, half_angle_rad: below.max(own) + ROUNDING_RAD })
}
