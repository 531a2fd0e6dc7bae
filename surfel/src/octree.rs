//! The octree: which points lie in which cube.

use pointillist_view::MORTON_BITS;
use std::ops::Range;

/// Most points of a leaf that can be divided.
pub(crate) const LEAF: usize = 256;

/// A cube of the octree: the range of its points, and its children.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Cube {
    /// Its points, in Morton order.
    pub(crate) points: Range<usize>,
    /// Divisions that lead from the root's cube to this one.
    pub(crate) level: u32,
    /// Numbers of the cubes that it is divided into; none for a leaf.
    pub(crate) children: Range<usize>,
}

/// All cubes, level by level from the root, children of one cube in a row; and where each generation begins.
///
/// Cubes that would have one child only are left out: a cube is the smallest that holds its points.
pub(crate) fn divide(codes: &[u64]) -> (Vec<Cube>, Vec<usize>) {
    let mut cubes = vec![cube(codes, 0..codes.len())];
    let mut generations = vec![0];
    let mut start = 0;
    while start < cubes.len() {
        let end = cubes.len();
        for parent in start..end {
            let Cube { points, level, .. } = cubes[parent].clone();
            if points.len() <= LEAF || level == MORTON_BITS {
                continue;
            }
            let first = cubes.len();
            let octant = |code: u64| code >> (3 * (MORTON_BITS - 1 - level)) & 7;
            let mut rest = points;
            while !rest.is_empty() {
                let here = octant(codes[rest.start]);
                let count = codes[rest.clone()].partition_point(|&code| octant(code) <= here);
                cubes.push(cube(codes, rest.start..rest.start + count));
                rest.start += count;
            }
            cubes[parent].children = first..cubes.len();
        }
        start = end;
        generations.push(end);
    }
    (cubes, generations)
}

/// The smallest cube around points.
fn cube(codes: &[u64], points: Range<usize>) -> Cube {
    let differing = codes[points.start] ^ codes[points.end - 1];
    let below = (64 - differing.leading_zeros()).div_ceil(3);
    Cube { points, level: MORTON_BITS - below, children: 0..0 }
}
