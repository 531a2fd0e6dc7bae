//! Queries to a triangulation, compared with slow and obvious answers.

use super::check;
use super::exact::{Points, dot, zero};
use super::triangulation::{renamed, triangulation_is_delaunay};
use crate::{Delaunay, DelaunayError, Facet, NearestVertex, OUTSIDE, Partition};
use glam::DVec3;
use std::collections::BTreeSet;

/// Cells and all; nothing if the points are refused.
fn divided(points: &[DVec3]) -> Option<(Delaunay, Partition)> {
    let delaunay = Delaunay::new(points).ok()?;
    let partition = delaunay.partition();
    Some((delaunay, partition))
}

/// Every neighbour has the cell for a neighbour, across the same corners, and cells are numbered as listed.
///
/// # Errors
/// The first cell and side.
pub fn neighbours_are_mutual(points: &[DVec3]) -> Result<(), String> {
    let Some((_, partition)) = divided(points) else { return Ok(()) };
    for (i, cell) in partition.cells().enumerate() {
        check(cell.index() as usize == i && cell.corners().len() == partition.dimension() + 1, || {
            format!("cell {i} is {cell:?}")
        })?;
        for side in 0..cell.corners().len() {
            let Some(next) = cell.neighbour(side) else { continue };
            let shared: BTreeSet<u32> =
                cell.corners().iter().copied().filter(|&c| c != cell.corners()[side]).collect();
            let back = |k: &usize| next.neighbour(*k).is_some_and(|c| c.index() == cell.index());
            let side_back = (0..next.corners().len()).find(back);
            let same = side_back.is_some_and(|k| {
                let rest = next.corners().iter().copied().filter(|&c| c != next.corners()[k]);
                rest.collect::<BTreeSet<_>>() == shared
            });
            check(same, || format!("cells {i} and {} across {shared:?}", next.index()))?;
        }
    }
    Ok(())
}

/// Edges are the pairs of corners of all cells, each once, and vertices around a vertex are the other ends of its
/// edges.
///
/// # Errors
/// What differs.
pub fn edges_are_those_of_cells(points: &[DVec3]) -> Result<(), String> {
    let Some((_, partition)) = divided(points) else { return Ok(()) };
    let mut expected = BTreeSet::new();
    for cell in partition.cells() {
        for &a in cell.corners() {
            expected.extend(cell.corners().iter().filter(|&&b| a < b).map(|&b| [a, b]));
        }
    }
    let graph = partition.graph(points.len()).map_err(|e| e.to_string())?;
    let edges: Vec<[u32; 2]> = graph.edges().collect();
    check(edges == expected.iter().copied().collect::<Vec<_>>(), || format!("edges {edges:?}"))?;
    for v in 0..points.len() as u32 {
        let of = |[a, b]: &[u32; 2]| {
            [(*a, *b), (*b, *a)].into_iter().find(|(from, _)| *from == v).map(|(_, to)| to)
        };
        let ends: BTreeSet<u32> = expected.iter().filter_map(of).collect();
        check(graph.around(v).iter().copied().eq(ends), || format!("around {v}: {:?}", graph.around(v)))?;
    }
    Ok(())
}

/// No point lies beyond a facet of the hull, exactly, and facets close up: every corner is one of two facets or more.
///
/// # Errors
/// The first facet.
pub fn hull_facets_have_all_points_on_one_side(points: &[DVec3]) -> Result<(), String> {
    let Some((delaunay, partition)) = divided(points) else { return Ok(()) };
    let exact = Points::new(points);
    let hull = partition.hull();
    let live = || (0..points.len() as u32).filter(|&v| delaunay.representative()[v as usize] == v);
    for facet in &hull {
        let outside = |v: &u32| is_beyond(&exact, &partition, facet, *v);
        let found = live().find(outside);
        check(found.is_none(), || format!("point {found:?} lies beyond {facet:?}"))?;
    }
    let mut ridges: Vec<Vec<u32>> = hull.iter().flat_map(|f| ridges(f.corners())).collect();
    ridges.sort();
    let pairs = ridges.chunks(2).all(|pair| pair.len() == 2 && pair[0] == pair[1]);
    let is_closed = match partition.dimension() {
        0 => hull.is_empty(),
        1 => hull.len() == 2,
        _ => pairs && ridges.chunk_by(|a, b| a == b).all(|run| run.len() == 2),
    };
    check(is_closed, || format!("the hull is open: {hull:?}"))
}

/// What facets of the hull have in common: all but one corner of each.
fn ridges(corners: &[u32]) -> Vec<Vec<u32>> {
    let without = |k: usize| {
        let mut rest: Vec<u32> = corners.iter().copied().filter(|&c| c != corners[k]).collect();
        rest.sort_unstable();
        rest
    };
    (0..corners.len()).map(without).collect()
}

/// Whether a point lies on the outer side of a facet.
fn is_beyond(exact: &Points, partition: &Partition, facet: &Facet, v: u32) -> bool {
    let cell = partition.cell(facet.cell()).expect("facets are sides of cells");
    let inner = cell.corners()[facet.side()];
    match *facet.corners() {
        [a, b, c] => exact.orientation([a, b, c, v]) > zero(),
        [a, b] => {
            // The cell's own corner lies inside: v must not turn the other way.
            let [own, other] = [inner, v].map(|w| exact.normal([a, b, w]));
            dot(&own, &other) < zero()
        }
        [a] => dot(&exact.difference(a, inner), &exact.difference(v, a)) > zero(),
        _ => false,
    }
}

/// Centres are as far from all corners of their cell, within 1e-10 of the radius and 4 ulp of the largest coordinate.
///
/// # Errors
/// The first cell, and its distances.
pub fn circumcentres_are_equidistant(points: &[DVec3]) -> Result<(), String> {
    let Some((_, partition)) = divided(points) else { return Ok(()) };
    for cell in partition.cells() {
        let corners: Vec<DVec3> = cell.corners().iter().map(|&c| points[c as usize]).collect();
        let Some(centre) = cell.circumcentre(points) else { continue };
        let largest = corners.iter().fold(centre.abs(), |m, c| m.max(c.abs())).max_element();
        // Squares of distances overflow.
        if largest > 1e150 {
            continue;
        }
        let distances: Vec<f64> = corners.iter().map(|c| c.distance(centre)).collect();
        let (least, most) =
            distances.iter().fold((f64::INFINITY, 0.0_f64), |(l, m), &d| (l.min(d), m.max(d)));
        let bound = 1e-10 * most + 4.0 * f64::EPSILON * largest;
        check(most - least <= bound || most < 1e-150, || {
            format!("cell {}: distances {distances:?} from {centre}, bound {bound:e}", cell.index())
        })?;
    }
    Ok(())
}

/// The nearest vertex is the one that a search among all points finds, exactly, from wherever the walk starts.
///
/// # Errors
/// The first query, and both answers.
pub fn nearest_is_that_of_a_search(points: &[DVec3], queries: &[DVec3]) -> Result<(), String> {
    let Some((delaunay, partition)) = divided(points) else { return Ok(()) };
    let nearest = NearestVertex::new(points, &partition).map_err(|e| e.to_string())?;
    for &query in queries.iter().filter(|q| q.is_finite()) {
        // The query is one more point.
        let all: Vec<DVec3> = points.iter().copied().chain([query]).collect();
        let exact = Points::new(&all);
        let dist2 = |v: u32| {
            let d = exact.difference(v, points.len() as u32);
            dot(&d, &d)
        };
        let vertices: Vec<u32> =
            (0..points.len() as u32).filter(|&v| delaunay.representative()[v as usize] == v).collect();
        // The first of equal ones is the least.
        let expected = vertices.iter().copied().min_by_key(|&v| dist2(v)).ok_or("no vertices")?;
        let found = nearest.find(query).map_err(|e| e.to_string())?;
        check(found == expected, || format!("{found} for {expected}, nearest to {query}"))?;
        for &start in &vertices {
            let found = nearest.find_from(query, start).map_err(|e| e.to_string())?;
            check(found == expected, || format!("from {start}: {found} for {expected}, nearest to {query}"))?;
        }
    }
    Ok(())
}

/// What is built is found valid; with two corners of one cell swapped, a cell that shows it is named: that one or a
/// neighbour.
///
/// # Errors
/// What [`Partition::verify`](crate::Partition::verify) answered instead.
pub fn damage_is_found(points: &[DVec3], which: usize) -> Result<(), String> {
    let Some((delaunay, partition)) = divided(points) else { return Ok(()) };
    partition.verify(delaunay.points()).map_err(|e| e.to_string())?;
    let mut damaged = partition.clone();
    // The first triangle defines the orientation of the others, so another one is damaged.
    let fixed = usize::from(partition.dimension() == 2);
    let cell = fixed + which % (partition.cell_count() - fixed).max(1);
    match &mut damaged {
        Partition::Tetrahedra(t) => t.corners[cell].swap(which % 3, 3),
        Partition::Triangles(t) if t.corners.len() > 1 => t.corners[cell].swap(which % 2, 2),
        // A single triangle has no sense that is wrong.
        _ => return Ok(()),
    }
    match damaged.verify(delaunay.points()) {
        Err(DelaunayError::BadCell { cell: found, .. }) => {
            let damaged_cell = partition.cell(cell as u32).ok_or("no such cell")?;
            let is_near = found == cell || damaged_cell.neighbours().any(|n| n.index() as usize == found);
            check(is_near, || format!("cell {cell} was damaged, {found} was named"))
        }
        other => Err(format!("damage of cell {cell} was answered by {other:?}")),
    }
}

/// Compacting keeps what is left in its order, and its cells; more can be inserted and removed after it.
///
/// # Errors
/// What differs.
pub fn compaction_is_building(points: &[DVec3], removed: &[usize]) -> Result<(), String> {
    let text = |e: DelaunayError| e.to_string();
    let Ok(mut delaunay) = Delaunay::new(points) else { return Ok(()) };
    let mut left: Vec<u32> = (0..points.len() as u32).collect();
    for &r in removed.iter().take(points.len() - 1) {
        delaunay.remove(left.remove(r % left.len())).map_err(text)?;
    }
    let before = delaunay.partition();
    let renumbered = delaunay.compact().map_err(text)?;
    let mut expected = vec![OUTSIDE; points.len()];
    (0..).zip(&left).for_each(|(new, &old)| expected[old as usize] = new);
    check(renumbered == expected, || format!("renumbered {renumbered:?}, left {left:?}"))?;
    check(delaunay.points().len() == left.len() && delaunay.live_count() == left.len(), || {
        "points remain".into()
    })?;
    check(renamed(before, &renumbered) == delaunay.partition(), || "another partition".into())?;
    let index = delaunay.insert(points[0]).map_err(text)?;
    check(index as usize == left.len(), || format!("the next point was given index {index}"))?;
    delaunay.remove(0).map_err(text)?;
    triangulation_is_delaunay(&delaunay)
}
