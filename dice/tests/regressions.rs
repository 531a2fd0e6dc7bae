//! Bugs that were fixed, each with the smallest input that showed it.

use glam::{DVec2, dvec2};
use pointillist_dice::{Accumulator, DiceError, Grid, Piece, accumulate, invariants, split};

fn each_piece(polygon: &[DVec2], grid: &Grid, visit: impl FnMut(Piece<'_>)) {
    split(polygon, grid, visit).expect("the polygon is convex and small");
}

/// An edge that ends on a column line was asked for its crossing with it, and answered for the next line.
#[test]
fn an_end_on_a_column_line_is_where_the_edge_meets_it() {
    let grid = Grid::new(dvec2(0.0, 0.0), dvec2(1.0, 1.0)).unwrap();
    each_piece(&[dvec2(2.0, 0.25), dvec2(5.0, 0.75), dvec2(1.5, 0.5)], &grid, |p| {
        for (i, a) in p.vertices.iter().enumerate() {
            let [b, c] = [1, 2].map(|k| p.vertices[(i + k) % p.vertices.len()]);
            assert!((b - *a).perp_dot(c - b) >= -1e-15, "{p:?}");
        }
    });
}

/// A ring that goes forth and back on one line was called not convex; it has no area, which is no error.
#[test]
fn forth_and_back_on_a_line_has_no_pieces() {
    let ring = [0.0, 7.0, 0.0, 1.0].map(|t| dvec2(0.0, -0.25 * t));
    each_piece(&ring, &Grid::UNIT, |p| panic!("{p:?}"));
}

/// Arbitrary work must be refused, not begun.
#[test]
fn more_cells_than_allowed_are_refused_up_front() {
    let ring = [dvec2(0.0, 0.0), dvec2(1e9, 0.0), dvec2(0.0, 1e9)];
    let refused =
        |r: Result<(), DiceError>| assert!(matches!(r, Err(DiceError::TooManyCells { .. })), "{r:?}");
    refused(split(&ring, &Grid::UNIT, |_| panic!("refused up front")));
    refused(accumulate(&ring, &Grid::UNIT, &mut Accumulator::new(), |_| panic!("refused up front")));
}

#[test]
fn every_error_names_its_vertex() {
    let at = |p: DVec2| split(&[DVec2::ZERO, dvec2(1.0, 0.0), p], &Grid::UNIT, |_| ());
    assert_eq!(at(dvec2(f64::NAN, 0.0)), Err(DiceError::NotFinite { index: 2 }));
    assert_eq!(at(dvec2(0.0, f64::INFINITY)), Err(DiceError::NotFinite { index: 2 }));
    assert_eq!(at(dvec2(1e300, 0.0)), Err(DiceError::OutOfRange { index: 2 }));
    let dart = [dvec2(0.0, 0.0), dvec2(4.0, 0.0), dvec2(1.0, 1.0), dvec2(0.0, 4.0)];
    assert_eq!(split(&dart, &Grid::UNIT, |_| ()), Err(DiceError::NotConvex { index: 2 }));
    let star = [0, 2, 4, 1, 3].map(|i| DVec2::from_angle(f64::from(i) * std::f64::consts::TAU / 5.0));
    assert!(matches!(split(&star, &Grid::UNIT, |_| ()), Err(DiceError::NotConvex { .. })));
    assert!(matches!(Grid::new(DVec2::ZERO, dvec2(0.0, 1.0)), Err(DiceError::BadGrid { .. })));
}

/// The comb of teeth along one row: covers add up to nothing between the teeth.
#[test]
fn a_comb_leaves_its_gaps_empty() {
    let mut ring = vec![dvec2(20.0, 2.0), dvec2(0.0, 2.0)];
    for i in 0..10 {
        let x = 2.0 * f64::from(i);
        ring.extend([
            dvec2(x, 0.1 + 0.07 * x),
            dvec2(x + 1.0, 0.1 + 0.07 * x),
            dvec2(x + 1.0, 1.9),
            dvec2(x + 2.0, 1.9),
        ]);
    }
    let mut rows = [vec![], vec![]];
    accumulate(&ring, &Grid::UNIT, &mut Accumulator::new(), |run| rows[run.row as usize].extend(run.columns))
        .unwrap();
    assert_eq!(rows[0], [0, 2, 4, 6, 8, 10, 12]);
    assert_eq!(rows[1], (0..20).collect::<Vec<_>>());
}

/// The slope of an edge from 0 to 5e-324 overflows; times nothing, it gave corners that are NaN.
#[test]
fn slopes_that_overflow_are_cut_at_the_end_of_their_edge() {
    let triangle = |y: f64| [dvec2(-0.413, -1.0), dvec2(0.0, 0.0), dvec2(-1.236, y)];
    for y in [5e-324, -5e-324, 1e-310, -1e-310, 0.0] {
        let upright = triangle(y);
        // The same with x and y exchanged turns the other way.
        let [a, b, c] = upright.map(|v| dvec2(v.y, v.x));
        for ring in [upright, [c, b, a]] {
            invariants::cut_equals_accumulate(&ring).unwrap();
        }
    }
}
