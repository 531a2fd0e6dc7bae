//! An order of points and links in which neighbours follow one another, two by two.
//!
//! Between a level of the octree and the next lies a factor of more than two in distance. A node that is drawn with one
//! disc for every pair gives a level in between, and needs no memory for it.

use crate::attributes::Attributes;
use crate::lattice::between;
use crate::links::{Link, radius_of_area};
use crate::octree::Cube;
use glam::Vec3;
use pointillist_parallel as parallel;

/// Neighbours whose normals have a smaller product than this are no pair, nor are those that are farther apart than
/// this, in the larger of their radii: one disc cannot stand for both.
const ALIKE: f32 = 0.5;
pub(crate) const FARTHEST: f32 = 2.0;

/// Something that may be half of a pair.
#[derive(Clone, Copy)]
struct Item {
    cell: [u32; 3],
    normal: Vec3,
    radius: f32,
    /// Its number in the order before.
    number: usize,
}

impl Item {
    fn is_like(&self, other: &Self) -> bool {
        let farthest = FARTHEST * self.radius.max(other.radius);
        self.normal.dot(other.normal) >= ALIKE && between(self.cell, other.cell).length() <= farthest
    }
}

/// Brings the points of leaves and the links of other cubes into an order in which items 2·k and 2·k + 1 are neighbours
/// that face alike, as far as there are any, and all others follow; the number of pairs of each cube.
pub(crate) fn arrange(cubes: &[Cube], points: &mut Attributes, links: &mut [Vec<Link>]) -> Vec<u32> {
    let arranged = parallel::map_heavy(cubes.len(), |number| {
        let cube = &cubes[number];
        let items = if cube.children.is_empty() {
            let item = |number| Item {
                cell: points.cell(number),
                normal: points.normal(number),
                radius: points.radii[number],
                number,
            };
            cube.points.clone().map(item).collect()
        } else {
            let item = |(number, link): (usize, &Link)| Item {
                cell: link.cell,
                normal: link.normal,
                radius: radius_of_area(link.area),
                number,
            };
            links[number].iter().enumerate().map(item).collect()
        };
        order(items)
    });
    let mut new_places = vec![0; cubes[0].points.len()];
    let mut old_places = new_places.clone();
    for (cube, (order, _)) in cubes.iter().zip(&arranged).filter(|(cube, _)| cube.children.is_empty()) {
        for (new, &old) in cube.points.clone().zip(order) {
            new_places[old] = new as u32;
            old_places[new] = old as u32;
        }
    }
    *points = points.at(&old_places);
    for (list, (order, _)) in links.iter_mut().zip(&arranged).filter(|(list, _)| !list.is_empty()) {
        let moved = |link: Link| Link { point: new_places[link.point as usize], ..link };
        *list = order.iter().map(|&old| moved(list[old])).collect();
    }
    arranged.into_iter().map(|(_, pairs)| pairs).collect()
}

/// Numbers of the items in their new order, and how many pairs they begin with.
fn order(mut items: Vec<Item>) -> (Vec<usize>, u32) {
    let (mut pairs, mut singles) = (vec![], vec![]);
    let mut rest = &mut items[..];
    while let Some(&Item { normal: facing, .. }) = rest.first() {
        // The sides of a thin sheet are no neighbours.
        let count = front_first(rest, facing);
        let (side, others) = rest.split_at_mut(count);
        halve(side);
        for two in side.chunks(2) {
            match *two {
                [a, b] if a.is_like(&b) => pairs.extend([a.number, b.number]),
                _ => singles.extend(two.iter().map(|i| i.number)),
            }
        }
        rest = others;
    }
    let count = pairs.len() / 2;
    pairs.append(&mut singles);
    (pairs, count as u32)
}

/// Moves those that face forwards to the front and counts them: at least the first.
fn front_first(items: &mut [Item], facing: Vec3) -> usize {
    let is_front = |item: &Item| item.normal.dot(facing) > 0.0;
    items.sort_by_key(|item| !is_front(item));
    items.partition_point(is_front).max(1)
}

/// Halves items across the longest side of their box until two are left, so that those which follow one another are
/// close.
fn halve(items: &mut [Item]) {
    if items.len() <= 2 {
        return;
    }
    let side = |axis: &usize| {
        let cells = items.iter().map(|i| i.cell[*axis]);
        cells.clone().max().unwrap_or(0) - cells.min().unwrap_or(0)
    };
    let axis = (0..3).max_by_key(side).unwrap_or(0);
    let middle = (items.len() / 2).next_multiple_of(2);
    items.select_nth_unstable_by_key(middle, |i| (i.cell[axis], i.number));
    let (first, second) = items.split_at_mut(middle);
    halve(first);
    halve(second);
}
