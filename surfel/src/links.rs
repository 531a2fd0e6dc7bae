//! Coarser levels: links to a few of a cube's points, each of which represents the points around it.
//!
//! While levels are made a link names the point that is nearest to the middle of those that it represents, for its order. Its place, normal, color and
//! opacity are their means and its area is their sum, like the prefiltered textures of \[1\], so that coarse levels are not noisy.
//! `sharpen.rs` goes over the colors when all links are made.

use crate::attributes::Attributes;
use crate::lattice::{between, morton, moved};
use crate::octree::Cube;
use glam::Vec3;
use pointillist_parallel as parallel;
use pointillist_view::MORTON_BITS;

/// A cube of the octree is divided into 2^DIVISIONS cells a side; each cell in which there is surface gets a link for
/// every side that the surface has there.
pub(crate) const DIVISIONS: u32 = 3;

/// A point that represents others, while levels are made.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Link {
    pub(crate) point: u32,
    /// Where it is drawn.
    pub(crate) cell: [u32; 3],
    /// Area of all points that it represents, square units.
    pub(crate) area: f32,
    pub(crate) normal: Vec3,
    /// What light sees in its place, if points have such normals.
    pub(crate) shading_normal: Option<Vec3>,
    /// Premultiplied by the opacity.
    pub(crate) color: Vec3,
    pub(crate) opacity: f32,
}

impl Link {
    /// A link that represents one point only.
    fn of_point(points: &Attributes, point: usize) -> Self {
        let opacity = points.opacity(point);
        let color = points.colors.as_ref().map_or(Vec3::ZERO, |all| Vec3::from_array(all[point]) * opacity);
        Self {
            point: point as u32,
            cell: points.cell(point),
            area: points.areas[point],
            normal: points.normal(point),
            shading_normal: points.shading_normal(point),
            color,
            opacity,
        }
    }
}

/// Radius of a disc over the square root of its share of the surface: a little more than half the diagonal of a square
/// (0.71), so that discs on a square lattice overlap at its corners.
pub(crate) const RADIUS_PER_ROOT_AREA: f32 = 0.75;

/// The radius that a link is drawn with.
pub(crate) fn radius_of_area(area: f32) -> f32 {
    RADIUS_PER_ROOT_AREA * area.sqrt()
}

/// The area of a link that is drawn with this radius.
#[inline(always)]
pub(crate) fn area_of_radius(radius: f32) -> f32 {
    let root = radius / RADIUS_PER_ROOT_AREA;
    root * root
}

/// Makes the links of every cube from those of its children, the deepest first; leaves get none.
pub(crate) fn make(cubes: &[Cube], generations: &[usize], points: &Attributes) -> Vec<Vec<Link>> {
    let mut links: Vec<Vec<Link>> = vec![vec![]; cubes.len()];
    for generation in generations.windows(2).rev() {
        let made = parallel::map_heavy(generation[1] - generation[0], |i| {
            links_of(&cubes[generation[0] + i], cubes, &links, points)
        });
        for (i, list) in made.into_iter().enumerate() {
            links[generation[0] + i] = list;
        }
    }
    links
}

fn links_of(cube: &Cube, cubes: &[Cube], links: &[Vec<Link>], points: &Attributes) -> Vec<Link> {
    let mut finer = vec![];
    for child in cube.children.clone() {
        if cubes[child].children.is_empty() {
            finer.extend(cubes[child].points.clone().map(|p| Link::of_point(points, p)));
        } else {
            finer.extend_from_slice(&links[child]);
        }
    }
    let below = MORTON_BITS.saturating_sub(cube.level + DIVISIONS);
    let cell = |link: &Link| morton(points.cell(link.point as usize)) >> (3 * below);
    let mut made = vec![];
    for of_cell in finer.chunk_by_mut(|a, b| cell(a) == cell(b)) {
        stand_for(of_cell, &mut made);
    }
    absorb_slivers(&mut made);
    // In the order of points, and so in that of cells for the next level.
    made.sort_unstable_by_key(|l| l.point);
    made
}

/// Links with less than this share of the mean area are merged into a neighbour.
const SLIVER: f32 = 0.4;

/// Merges links with less than [`SLIVER`] of the mean area into a neighbour. Surfaces cut corners off cells, and links
/// for those corners would lie close to others and leave gaps elsewhere.
fn absorb_slivers(links: &mut Vec<Link>) {
    let least = SLIVER * links.iter().map(|l| l.area).sum::<f32>() / links.len() as f32;
    // The smallest first, so that several small ones may make a large one.
    links.sort_unstable_by(|a, b| a.area.total_cmp(&b.area).then(a.point.cmp(&b.point)));
    let mut kept = std::mem::take(links);
    for i in 0..kept.len() {
        let sliver = kept[i];
        let distance2 = |l: &Link| between(sliver.cell, l.cell).length_squared();
        let nearest = (i + 1..kept.len())
            .filter(|&j| kept[j].normal.dot(sliver.normal) > 0.5)
            .min_by(|&a, &b| distance2(&kept[a]).total_cmp(&distance2(&kept[b])).then(a.cmp(&b)))
            .filter(|_| sliver.area < least);
        match nearest {
            Some(j) => kept[j] = Link { point: kept[j].point, ..merged(&[kept[j], sliver]) },
            None => links.push(sliver),
        }
    }
}

/// One link for each side that the surface has among `links`: the sides of a thin sheet stay apart.
fn stand_for(mut links: &mut [Link], made: &mut Vec<Link>) {
    while let Some(first) = links.first() {
        let facing = first.normal;
        let count = partition(links, |l| l.normal.dot(facing) > 0.0);
        let (side, rest) = links.split_at_mut(count);
        made.push(merged(side));
        links = rest;
    }
}

/// Moves what passes to the front, in order, and counts it.
fn partition(links: &mut [Link], passes: impl Fn(&Link) -> bool) -> usize {
    let mut count = 0;
    for i in 0..links.len() {
        if passes(&links[i]) {
            // Points that do not pass keep their order, too: the picture must not depend on how this is done.
            links[count..=i].rotate_right(1);
            count += 1;
        }
    }
    count
}

/// What `links` stand for together.
fn merged(links: &[Link]) -> Link {
    let origin = links[0].cell;
    let place = |l: &Link| between(origin, l.cell);
    let area: f32 = links.iter().map(|l| l.area).sum();
    let mean = links.iter().map(|l| place(l) * (l.area / area)).sum::<Vec3>();
    let normal = links.iter().map(|l| l.normal * (l.area / area)).sum::<Vec3>();
    let shading = |l: &Link| l.shading_normal.map(|n| n * (l.area / area));
    let shading_normal = links.iter().map(shading).sum::<Option<Vec3>>();
    let color = links.iter().map(|l| l.color * (l.area / area)).sum::<Vec3>();
    let opacity = links.iter().map(|l| l.opacity * (l.area / area)).sum::<f32>();
    let distance2 = |l: &Link| place(l).distance_squared(mean);
    let nearest = links
        .iter()
        .min_by(|a, b| distance2(a).total_cmp(&distance2(b)).then(a.point.cmp(&b.point)))
        .expect("a cell is made of at least one link");
    Link {
        point: nearest.point,
        cell: moved(origin, mean),
        area,
        normal: normal.try_normalize().unwrap_or(nearest.normal),
        shading_normal: shading_normal.map(|n| n.try_normalize().unwrap_or(nearest.normal)),
        color,
        opacity,
    }
}
