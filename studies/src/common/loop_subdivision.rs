//! Loop's subdivision: a smooth surface from a mesh of triangles.
//!
//! C. Loop, *Smooth subdivision surfaces based on triangles*, 1987; open edges by the rules for creases.

use std::collections::HashMap;

use glam::DVec3;

/// An edge with the vertices across from it; more than two (an edge of three faces) count as open.
#[derive(Clone, Copy, Debug)]
struct Edge {
    middle: u32,
    across: [u32; 2],
    faces: u32,
}

type Edges = HashMap<(u32, u32), Edge>;

/// Four triangles for each, smoothed.
pub(crate) fn subdivided(positions: &[DVec3], triangles: &[[u32; 3]]) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let (edges, order) = edges_of(positions.len() as u32, triangles);
    let mut finer = smoothed(positions, &edges, &order);
    finer.extend(order.iter().map(|key| {
        let ([a, b], e) = ([key.0, key.1].map(|v| positions[v as usize]), &edges[key]);
        if e.faces == 2 {
            let [c, d] = e.across.map(|v| positions[v as usize]);
            0.375 * (a + b) + 0.125 * (c + d)
        } else {
            0.5 * (a + b)
        }
    }));
    let middle = |a: u32, b: u32| edges[&(a.min(b), a.max(b))].middle;
    let split = |&[a, b, c]: &[u32; 3]| {
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
    };
    (finer, triangles.iter().flat_map(split).collect())
}

/// Edges by their ends, and in the order in which faces name them.
fn edges_of(vertices: u32, triangles: &[[u32; 3]]) -> (Edges, Vec<(u32, u32)>) {
    let (mut edges, mut order) = (Edges::new(), vec![]);
    for t in triangles {
        for k in 0..3 {
            let (a, b, across) = (t[k], t[(k + 1) % 3], t[(k + 2) % 3]);
            let key = (a.min(b), a.max(b));
            let edge = edges.entry(key).or_insert_with(|| {
                order.push(key);
                Edge { middle: vertices + order.len() as u32 - 1, across: [across; 2], faces: 0 }
            });
            edge.faces += 1;
            if edge.faces == 2 {
                edge.across[1] = across;
            }
        }
    }
    (edges, order)
}

/// New places of the old vertices.
fn smoothed(positions: &[DVec3], edges: &Edges, order: &[(u32, u32)]) -> Vec<DVec3> {
    let mut around = vec![(DVec3::ZERO, 0u32); positions.len()];
    let mut open = around.clone();
    for key in order {
        for (v, other) in [(key.0, key.1), (key.1, key.0)] {
            let sums = if edges[key].faces == 2 { &mut around } else { &mut open };
            let sum = &mut sums[v as usize];
            *sum = (sum.0 + positions[other as usize], sum.1 + 1);
        }
    }
    let place = |v: usize| match (open[v], around[v]) {
        ((sum, 2), _) => 0.75 * positions[v] + 0.125 * sum,
        ((_, 0), (sum, n)) if n > 0 => {
            let n = f64::from(n);
            let cos = (std::f64::consts::TAU / n).cos();
            let beta = (0.625 - (0.375 + 0.25 * cos).powi(2)) / n;
            (1.0 - n * beta) * positions[v] + beta * sum
        }
        // Corners of several open edges, and vertices that no face uses.
        _ => positions[v],
    };
    (0..positions.len()).map(place).collect()
}
