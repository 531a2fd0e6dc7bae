//! The tree of a cloud, as it is kept.

use super::{OwnedPoints, check, cloud};
use crate::cloud::Cloud;
use crate::lattice::between;
use crate::node::Node;
use crate::packed::unpack_way;
use glam::Vec3;
use std::ops::Range;

/// Rounding of areas and their sums, relative.
const AREA_ROUNDING: f64 = 1e-3;

/// Bytes per point that octree, links and areas of a surface take at most, for clouds of 10,000 points and more: 4 for
/// the area, and for nodes and links 3 (a sphere) to 8 (a thin sheet with two sides and colors).
pub const MOST_OVERHEAD: f64 = 12.0;

/// Any points become a sound octree, or are refused.
///
/// # Errors
/// As [`octree_is_sound`].
pub fn octrees_are_sound(points: &OwnedPoints) -> Result<(), String> {
    let Ok(cloud) = cloud(points) else { return Ok(()) };
    check(cloud.len() == points.positions.len(), || format!("{} points", cloud.len()))?;
    octree_is_sound(&cloud)
}

/// Every point is in exactly one leaf; boxes hold their points, cones their normals; links are no more than the points
/// below their node, and stand for all of the area there.
///
/// # Errors
/// The first node for which that does not hold.
pub fn octree_is_sound(cloud: &Cloud) -> Result<(), String> {
    let mut reached = vec![false; cloud.nodes.len()];
    let points = walk(cloud, 0, &mut reached)?;
    check(points == (0..cloud.len() as u32), || format!("the root holds points {points:?}"))?;
    check(reached.iter().all(|r| *r), || "a node is in no other".to_owned())?;
    let links = cloud.links.len();
    let drawn: usize = cloud.nodes.iter().filter(|n| !n.is_leaf()).map(|n| n.items.len()).sum();
    check(drawn == links, || format!("{drawn} of {links} links are drawn"))
}

/// Octree, links and areas of a large cloud take no more than `most` bytes per point.
///
/// # Errors
/// What they take.
pub fn overhead_is_at_most(cloud: &Cloud, most: f64) -> Result<(), String> {
    let bytes = cloud.overhead_per_point();
    check(bytes <= most, || format!("{bytes:.1} bytes per point"))
}

/// Checks a node and all below; the points that they hold.
fn walk(cloud: &Cloud, number: u32, reached: &mut [bool]) -> Result<Range<u32>, String> {
    let at = |message: String| format!("node {number}: {message}");
    let twice = std::mem::replace(&mut reached[number as usize], true);
    check(!twice, || at("is in two others".to_owned()))?;
    let node = &cloud.nodes[number as usize];
    let points = if node.is_leaf() { node.items.clone() } else { points_of_children(cloud, node, reached)? };
    check(!points.is_empty(), || at("holds no point".to_owned()))?;
    let below = points.start as usize..points.end as usize;
    box_holds(cloud, node, below.clone()).map_err(at)?;
    cone_holds(cloud, node, below.clone()).map_err(at)?;
    check(!node.is_bare() || number == 0, || at("has nothing to draw".to_owned()))?;
    if !node.is_leaf() {
        links_are_sound(cloud, node, below).map_err(at)?;
    }
    Ok(points)
}

/// The points of all children, which follow one another.
fn points_of_children(cloud: &Cloud, node: &Node, reached: &mut [bool]) -> Result<Range<u32>, String> {
    let mut all: Option<Range<u32>> = None;
    for child in node.children.clone() {
        let next = walk(cloud, child, reached)?;
        let start = match all {
            Some(before) => {
                check(before.end == next.start, || format!("points {before:?} and then {next:?}"))?;
                before.start
            }
            None => next.start,
        };
        all = Some(start..next.end);
    }
    all.ok_or_else(|| "a node without points".to_owned())
}

fn box_holds(cloud: &Cloud, node: &Node, below: Range<usize>) -> Result<(), String> {
    for point in below {
        let offset = between(node.origin, cloud.points.cell(point)).abs();
        check(offset.cmple(node.half).all(), || format!("point {point} is {offset} off, not {}", node.half))?;
    }
    Ok(())
}

fn cone_holds(cloud: &Cloud, node: &Node, below: Range<usize>) -> Result<(), String> {
    let Some(cone) = node.cone() else { return Ok(()) };
    check((cone.axis.length() - 1.0).abs() < 1e-5, || format!("axis {}", cone.axis))?;
    let off = |normal: Vec3| normal.as_dvec3().angle_between(cone.axis.as_dvec3());
    let holds = |what: &str, normal: Vec3| {
        let angle = off(normal);
        let most = f64::from(cone.half_angle_rad);
        check(angle <= most, || format!("{what} faces {angle} rad off the axis, not {most}"))
    };
    below.into_iter().try_for_each(|point| holds("a point", cloud.points.normal(point)))?;
    let links = if node.is_leaf() { 0..0 } else { node.items.start as usize..node.items.end as usize };
    links.into_iter().try_for_each(|link| holds("a link", unpack_way(cloud.links.normals[link]).normalize()))
}

fn links_are_sound(cloud: &Cloud, node: &Node, below: Range<usize>) -> Result<(), String> {
    let items = node.items.start as usize..node.items.end as usize;
    if node.is_bare() {
        return Ok(());
    }
    check(items.len() <= below.len(), || format!("{} links", items.len()))?;
    let links =
        cloud.links.areas[items.clone()].iter().map(|&share| f64::from(node.area(share))).sum::<f64>();
    let points = cloud.points.areas[below].iter().map(|&a| f64::from(a)).sum::<f64>();
    let off = (links / points - 1.0).abs();
    check(off <= AREA_ROUNDING, || format!("links stand for an area of {links:e}, not {points:e}"))?;
    let colored = cloud.links.colors.as_ref().is_none_or(|c| c.len() == cloud.links.len());
    let lit = cloud.links.shading_normals.as_ref().map(Vec::len);
    let colored = colored && lit == cloud.has_shading_normals().then_some(cloud.links.len());
    check(colored && cloud.links.normals.len() == cloud.links.len(), || "lengths differ".to_owned())
}
