//! Which grid points a triangle covers, so that triangles with common edges share out every point exactly once.
//!
//! Vertices are rounded to a fine integer lattice and all signs are exact. A grid point on an edge belongs to the side
//! that is left of the edge when that is walked from its lexicographically smaller end: as if every grid point were
//! moved by (−ε², ε), which puts none on an edge.

/// Lattice steps between neighbouring grid points: a vertex moves by at most half of `1 / STEPS` spacings.
pub(crate) const STEPS: i64 = 1 << 20;

/// Most grid points along an axis: products of two lattice coordinates then stay below 2⁹⁰, far inside `i128`.
pub(crate) const MAX_CELLS: u32 = 1 << 24;

/// A vertex on the lattice.
pub(crate) type Vertex = [i64; 2];

/// The lattice point nearest to a position in spacings; grid point `i` is at `i + ½`.
pub(crate) fn vertex(u: f64, v: f64) -> Vertex {
    [u, v].map(|x| (x * STEPS as f64).round() as i64)
}

/// Where grid point `i` is on the lattice.
fn grid(i: i64) -> i64 {
    i * STEPS + STEPS / 2
}

/// The half of the plane on a triangle's side of an edge: `a·x + b·y + c ≥ 0`.
#[derive(Clone, Copy)]
struct Side {
    a: i128,
    b: i128,
    c: i128,
}

impl Side {
    /// The side of `from → to` that lies to the left, points on the edge by the rule above.
    fn left_of(from: Vertex, to: Vertex) -> Self {
        let [dx, dy] = [to[0] - from[0], to[1] - from[1]].map(i128::from);
        let (a, b) = (-dy, dx);
        let c = -(a * i128::from(from[0]) + b * i128::from(from[1]));
        // Integers: `> 0` is `− 1 ≥ 0`.
        Self { a, b, c: if from < to { c } else { c - 1 } }
    }

    /// The grid columns on this side in a row, as a range cut from `columns`.
    fn cut(&self, y: i64, (first, last): (i64, i64)) -> (i64, i64) {
        // a·(x·S + S/2) + rest ≥ 0.
        let rest = self.b * i128::from(y) + self.c + self.a * i128::from(STEPS / 2);
        let step = self.a * i128::from(STEPS);
        let to_i64 = |x: i128| x.clamp(-(1 << 40), 1 << 40) as i64;
        match step {
            0 if rest >= 0 => (first, last),
            0 => (0, -1),
            // x ≥ −rest / step, rounded up.
            1.. => (first.max(to_i64(-rest.div_euclid(step))), last),
            // x ≤ rest / −step, rounded down.
            _ => (first, last.min(to_i64(rest.div_euclid(-step)))),
        }
    }
}

/// Calls `found` with column and row of every grid point that a triangle covers. Costs its rows and its points.
pub(crate) fn covered(triangle: [Vertex; 3], mut found: impl FnMut(i64, i64)) {
    let [p, q, r] = triangle;
    let area =
        i128::from(q[0] - p[0]) * i128::from(r[1] - p[1]) - i128::from(q[1] - p[1]) * i128::from(r[0] - p[0]);
    if area == 0 {
        return;
    }
    let [p, q, r] = if area > 0 { [p, q, r] } else { [p, r, q] };
    let sides = [Side::left_of(p, q), Side::left_of(q, r), Side::left_of(r, p)];
    let range = |axis: usize| {
        let (low, high) = (p[axis].min(q[axis]).min(r[axis]), p[axis].max(q[axis]).max(r[axis]));
        // The first grid point at or after the low end, the last one at or before the high end.
        ((low + STEPS / 2 - 1).div_euclid(STEPS), (high - STEPS / 2).div_euclid(STEPS))
    };
    let (columns, rows) = (range(0), range(1));
    if columns.0 > columns.1 {
        return;
    }
    for row in rows.0..=rows.1 {
        let y = grid(row);
        let (first, last) = sides.iter().fold(columns, |columns, side| side.cut(y, columns));
        (first..=last).for_each(|column| found(column, row));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A fan about a grid point, with others on edges, all of which every ray rule gets wrong that is not exact.
    #[test]
    fn a_fan_about_a_grid_point_hits_it_once() {
        let centre = vertex(2.5, 2.5);
        let rim = [(0.0, 0.0), (2.5, 0.0), (5.0, 0.0), (5.0, 5.0), (1.5, 5.0), (0.0, 5.0)]
            .map(|(u, v)| vertex(u, v));
        let mut hits = [[0; 5]; 5];
        for i in 0..rim.len() {
            covered([centre, rim[i], rim[(i + 1) % rim.len()]], |x, y| hits[y as usize][x as usize] += 1);
        }
        assert_eq!(hits, [[1; 5]; 5]);
    }

    #[test]
    fn the_brute_force_rule_agrees() {
        // Corners on a coarse lattice: many grid points on edges and corners.
        let mut random = 1u64;
        let mut next = || {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            0.5 * ((random >> 60) as f64) - 1.0
        };
        for _ in 0..2000 {
            let t = [0; 3].map(|_| vertex(next(), next()));
            let mut fast = vec![];
            covered(t, |x, y| fast.push((x, y)));
            let mut slow = vec![];
            for (y, x) in (-3..9).flat_map(|y| (-3..9).map(move |x| (y, x))) {
                // Moved by (−ε², ε) with ε² still a step of the scaled lattice.
                const E: i128 = 1 << 12;
                let at = [i128::from(grid(x)) * E * E - 1, i128::from(grid(y)) * E * E + E];
                let corner = |i: usize| t[i % 3].map(|c| i128::from(c) * E * E);
                let turn = |i: usize| {
                    let (a, b) = (corner(i), corner(i + 1));
                    ((b[0] - a[0]) * (at[1] - a[1]) - (b[1] - a[1]) * (at[0] - a[0])).signum()
                };
                if turn(0) == turn(1) && turn(1) == turn(2) {
                    slow.push((x, y));
                }
            }
            assert_eq!(fast, slow, "{t:?}");
        }
    }
}
