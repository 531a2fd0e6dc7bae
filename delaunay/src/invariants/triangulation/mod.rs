//! A partition is Delaunay and fills the hull of its points: checked exactly, without any code that computed it.

mod planar;
mod spatial;

use super::check;
use super::exact::{self, Points};
use crate::{Delaunay, OUTSIDE, Partition};
use glam::DVec3;
use std::collections::BTreeMap;

/// The partition divides the convex hull of these points as a Delaunay triangulation does, with each distinct point a
/// corner.
///
/// # Errors
/// The first cell, facet or point that breaks it.
pub fn partition_is_delaunay(points: &[DVec3]) -> Result<(), String> {
    let Ok(delaunay) = Delaunay::new(points) else { return Ok(()) };
    triangulation_is_delaunay(&delaunay)
}

/// As [`partition_is_delaunay`], of one that may have grown and shrunk.
///
/// # Errors
/// The first cell, facet or point that breaks it.
pub fn triangulation_is_delaunay(delaunay: &Delaunay) -> Result<(), String> {
    representatives_come_first(delaunay)?;
    let points = Points::new(delaunay.points());
    let distinct: Vec<u32> = distinct(delaunay).collect();
    let dimension = points.dimension(&distinct);
    check(dimension == delaunay.dimension(), || format!("the dimension is {dimension}"))?;
    let partition = delaunay.partition();
    check(dimension == partition.dimension(), || format!("the partition's dimension is not {dimension}"))?;
    match &partition {
        Partition::Point(point) => check(distinct == [*point], || format!("{point} is not the point")),
        Partition::Line(along) => line_is_sorted(&points, along, &distinct),
        Partition::Triangles(triangles) => planar::check_triangles(&points, triangles, &distinct),
        Partition::Tetrahedra(tetrahedra) => spatial::check_tetrahedra(&points, tetrahedra, &distinct),
    }
}

/// Inserting these points one by one into a triangulation of the first gives what building gives.
///
/// # Errors
/// What differs.
pub fn insertion_is_building(points: &[DVec3]) -> Result<(), String> {
    let Ok(built) = Delaunay::new(points) else { return Ok(()) };
    let mut grown = Delaunay::new(&points[..1]).map_err(|e| e.to_string())?;
    for (i, &p) in points.iter().enumerate().skip(1) {
        let index = grown.insert(p).map_err(|e| e.to_string())?;
        check(index as usize == i, || format!("point {i} was given index {index}"))?;
    }
    check(grown.representative() == built.representative(), || "other representatives".into())?;
    check(grown.partition() == built.partition(), || "another partition".into())
}

/// Removing a point gives what building without it gives.
///
/// # Errors
/// The point without which the two differ.
pub fn removal_is_building(points: &[DVec3], removed: &[usize]) -> Result<(), String> {
    let Ok(mut shrunk) = Delaunay::new(points) else { return Ok(()) };
    let mut left: Vec<u32> = (0..points.len() as u32).collect();
    for &r in removed.iter().take(points.len() - 1) {
        let index = left.remove(r % left.len());
        shrunk.remove(index).map_err(|e| e.to_string())?;
        check(shrunk.representative()[index as usize] == OUTSIDE, || format!("{index} is still there"))?;
        let rest: Vec<DVec3> = left.iter().map(|&i| points[i as usize]).collect();
        let built = Delaunay::new(&rest).map_err(|e| e.to_string())?;
        let named = renamed(built.partition(), &left);
        check(shrunk.partition() == named, || format!("without {index}, another partition"))?;
        representatives_come_first(&shrunk)?;
    }
    Ok(())
}

/// The same partition with other names for its points, which keep their order.
#[must_use]
pub fn renamed(mut partition: Partition, names: &[u32]) -> Partition {
    let rename = |corner: &mut u32| *corner = names[*corner as usize];
    match &mut partition {
        Partition::Point(point) => rename(point),
        Partition::Line(along) => along.iter_mut().for_each(rename),
        Partition::Triangles(t) => t.corners.iter_mut().flatten().for_each(rename),
        Partition::Tetrahedra(t) => t.corners.iter_mut().flatten().for_each(rename),
    }
    partition
}

/// Each point's representative is the first that coincides with it and has not been removed.
fn representatives_come_first(delaunay: &Delaunay) -> Result<(), String> {
    let mut first = BTreeMap::new();
    for (i, (p, &of)) in (0..).zip(delaunay.points().iter().zip(delaunay.representative())) {
        if of == OUTSIDE {
            continue;
        }
        // −0 is 0.
        let key = p.to_array().map(|x| (x + 0.0).to_bits());
        let expected = *first.entry(key).or_insert(i);
        check(expected == of, || format!("{of} stands for point {i}, which coincides with {expected}"))?;
    }
    Ok(())
}

/// Points that stand for themselves.
fn distinct(delaunay: &Delaunay) -> impl Iterator<Item = u32> {
    (0..).zip(delaunay.representative()).filter(|(i, r)| i == *r).map(|(i, _)| i)
}

fn line_is_sorted(points: &Points, along: &[u32], distinct: &[u32]) -> Result<(), String> {
    let mut sorted = along.to_vec();
    sorted.sort_unstable();
    check(sorted == distinct, || "the line does not go through each point once".into())?;
    let step = |w: &[u32]| points.difference(w[1], w[0]);
    let ahead = |w: &[u32]| exact::dot(&step(w), &step(&along[..2])) > exact::zero();
    check(along.windows(2).all(ahead), || "the line turns back".into())
}

/// Cells know each other across the faces that they share, and corners are points of which each is used.
fn check_links<const N: usize>(
    corners: &[[u32; N]],
    neighbours: &[[u32; N]],
    distinct: &[u32],
) -> Result<(), String> {
    let mut used: Vec<u32> = corners.iter().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();
    check(used == distinct, || "the corners are not the distinct points".into())?;
    check(corners.len() == neighbours.len(), || "cells without neighbours".into())?;
    let face = |cell: usize, k: usize| {
        let mut face: Vec<u32> = (0..N).filter(|j| *j != k).map(|j| corners[cell][j]).collect();
        face.sort_unstable();
        face
    };
    for (cell, of) in neighbours.iter().enumerate() {
        for (k, &n) in of.iter().enumerate().filter(|(_, n)| **n != OUTSIDE) {
            let back = neighbours.get(n as usize).and_then(|of| of.iter().position(|&m| m as usize == cell));
            let shared = back.is_some_and(|j| face(n as usize, j) == face(cell, k));
            check(shared, || format!("cell {cell} and its neighbour {n} across face {k} share no face"))?;
        }
    }
    Ok(())
}

/// Every cell, and the corner opposite in a neighbour: face by face, inner ones only.
fn across<'a, const N: usize>(
    corners: &'a [[u32; N]],
    neighbours: &'a [[u32; N]],
) -> impl Iterator<Item = (usize, usize, u32)> + 'a {
    let all = (0..corners.len()).flat_map(|cell| (0..N).map(move |k| (cell, k)));
    all.filter(|&(cell, k)| neighbours[cell][k] != OUTSIDE).map(move |(cell, k)| {
        let beyond = neighbours[cell][k] as usize;
        let back =
            neighbours[beyond].iter().position(|&m| m as usize == cell).expect("links are checked first");
        (cell, k, corners[beyond][back])
    })
}
