//! Outlines that cross themselves, and holes.

use glam::{DVec2, dvec2};
use pointillist_dice::{
    Accumulator, CellWindow, ConvexPolygon, DiceError, FillRule, Grid, HalfPlane, accumulate,
    accumulate_filled, invariants,
};
use proptest::prelude::*;
use testkit::holds;

fn area(rings: &[&[DVec2]], rule: FillRule) -> f64 {
    let mut sum = 0.0;
    accumulate_filled(rings, rule, &Grid::UNIT, &mut Accumulator::new(), |run| {
        sum += run.area * f64::from(run.columns.end - run.columns.start);
    })
    .expect("outlines within range");
    sum
}

/// Area under both rules: even-odd, non-zero.
fn areas(rings: &[&[DVec2]]) -> [f64; 2] {
    [FillRule::EvenOdd, FillRule::NonZero].map(|rule| area(rings, rule))
}

fn square(low: f64, high: f64) -> [DVec2; 4] {
    [dvec2(low, low), dvec2(high, low), dvec2(high, high), dvec2(low, high)]
}

#[test]
fn a_bow_tie_has_both_its_halves() {
    assert_eq!(areas(&[&[dvec2(0.0, 0.0), dvec2(2.0, 2.0), dvec2(2.0, 0.0), dvec2(0.0, 2.0)]]), [2.0; 2]);
    // Halves that meet in a corner, and ones that an edge along the grid divides.
    let corner = [(0.0, 0.0), (1.0, 1.0), (2.0, 0.0), (2.0, 2.0), (1.0, 1.0), (0.0, 2.0)];
    assert_eq!(areas(&[&corner.map(|(x, y)| dvec2(x, y))]), [2.0; 2]);
    let level = [(0.0, 1.0), (4.0, 1.0), (4.0, 2.0), (2.0, 2.0), (2.0, 0.0), (0.0, 0.0)];
    assert_eq!(areas(&[&level.map(|(x, y)| dvec2(x, y))]), [4.0; 2]);
}

#[test]
fn a_pentagram_has_a_middle_only_where_the_rule_says_so() {
    let tip = |i: usize| DVec2::from_angle(std::f64::consts::TAU * (2 * i) as f64 / 5.0) * 10.0;
    let star: Vec<DVec2> = (0..5).map(tip).collect();
    // The pentagon within has its corners at the golden ratio's square, to the power of −1.
    let inner = 10.0 / ((1.0 + 5.0_f64.sqrt()) / 2.0).powi(2);
    let turn = std::f64::consts::PI / 5.0;
    let pentagon = 2.5 * inner * inner * (2.0 * turn).sin();
    let tips = 5.0 * inner * turn.sin() * (10.0 - inner * turn.cos());
    let [even, nonzero] = areas(&[&star]);
    assert!((nonzero - (pentagon + tips)).abs() < 1e-12, "{nonzero} for {}", pentagon + tips);
    assert!((even - tips).abs() < 1e-12, "{even} for {tips}");
}

#[test]
fn a_ring_within_a_ring_is_a_hole() {
    let (outer, inner) = (square(0.0, 3.0), square(0.5, 2.25));
    let mut other_way = inner;
    other_way.reverse();
    assert_eq!(areas(&[&outer, &inner]), [9.0 - 3.0625, 9.0]);
    assert_eq!(areas(&[&outer, &other_way]), [9.0 - 3.0625; 2]);
    assert_eq!(areas(&[&outer, &outer]), [0.0, 9.0]);
}

#[test]
fn outlines_without_area_have_none_and_wrong_ones_are_named() {
    assert_eq!(areas(&[]), [0.0; 2]);
    assert_eq!(areas(&[&[], &[dvec2(1.0, 1.0)], &[dvec2(0.0, 0.0), dvec2(5.0, 3.0)]]), [0.0; 2]);
    let bad = [dvec2(0.0, 0.0), dvec2(f64::NAN, 1.0)];
    let result = accumulate_filled(
        &[&square(0.0, 1.0), &bad],
        FillRule::EvenOdd,
        &Grid::UNIT,
        &mut Accumulator::new(),
        |_| {},
    );
    assert_eq!(result, Err(DiceError::NotFinite { index: 5 }));
}

fn triangle() -> impl Strategy<Value = [DVec2; 3]> {
    // Steps of an eighth make corners on edges and edges on edges common.
    prop::array::uniform3((0..64_i32, 0..64_i32).prop_map(|(x, y)| dvec2(f64::from(x), f64::from(y)) / 8.0))
}

fn counter_clockwise([a, b, c]: [DVec2; 3]) -> [DVec2; 3] {
    if (b - a).perp_dot(c - a) < 0.0 { [a, c, b] } else { [a, b, c] }
}

/// Rings that often meet: corners on grid lines, on one another, and anywhere.
fn rings() -> impl Strategy<Value = Vec<Vec<DVec2>>> {
    let coordinate = || prop_oneof![(-16_i32..16).prop_map(|i| f64::from(i) / 2.0), -8.0..8.0];
    let ring = prop::collection::vec((coordinate(), coordinate()).prop_map(|(x, y)| dvec2(x, y)), 0..8);
    prop::collection::vec(ring, 1..5)
}

/// Grids with sides of either sign.
fn grid() -> impl Strategy<Value = Grid> {
    let side = || prop_oneof![Just(1.0), Just(-1.0), 0.3..3.0, -3.0..-0.3];
    let any = (-5.0..5.0, -5.0..5.0, side(), side());
    let grid = any.prop_map(|(x, y, w, h)| Grid::new(dvec2(x, y), dvec2(w, h)).expect("sides are not 0"));
    prop_oneof![Just(Grid::UNIT), grid]
}

fn rule() -> impl Strategy<Value = FillRule> {
    prop_oneof![Just(FillRule::EvenOdd), Just(FillRule::NonZero)]
}

proptest! {
    #![proptest_config(testkit::config(512))]

    #[test]
    fn closed_rings_are_open_ones(rings in rings(), rule in rule(), grid in grid()) {
        let rings: Vec<&[DVec2]> = rings.iter().map(Vec::as_slice).collect();
        holds!(invariants::closed_rings_are_open_ones(&rings, rule, &grid));
    }

    #[test]
    fn a_window_is_part_of_the_whole(
        rings in rings(), rule in rule(), grid in grid(), x0 in -9..9, y0 in -9..9, width in 0..9, height in 0..9,
    ) {
        let rings: Vec<&[DVec2]> = rings.iter().map(Vec::as_slice).collect();
        let window = CellWindow { x0, y0, x1: x0 + width, y1: y0 + height };
        holds!(invariants::filled_window_is_part_of_the_whole(&rings, rule, &grid, window));
    }

    #[test]
    fn mirrored_grids_mirror_the_cells(rings in rings(), rule in rule(), grid in grid()) {
        let rings: Vec<&[DVec2]> = rings.iter().map(Vec::as_slice).collect();
        holds!(invariants::mirrored_grids_mirror_the_cells(&rings, rule, &grid));
    }

    #[test]
    fn rings_within_rings_alternate(
        radii in prop::collection::vec(2.0..8.0, 4..16), centre in (-3.0..3.0, -3.0..3.0), far in prop_oneof![Just(0.0), -1e6..1e6],
        shares in prop::collection::vec(0.05..0.95, 1..5), grid in grid(),
    ) {
        let centre = dvec2(centre.0 + far, centre.1 - far);
        let step = std::f64::consts::TAU / radii.len() as f64;
        let spoke = |(i, r): (usize, &f64)| centre + DVec2::from_angle((i as f64 + 0.3) * step) * *r;
        let outline: Vec<_> = radii.iter().enumerate().map(spoke).collect();
        holds!(invariants::nested_rings_alternate(&outline, centre, &shares, &grid));
    }
}

proptest! {
    #![proptest_config(testkit::config(256))]

    #[test]
    fn two_triangles_are_united_or_kept_apart(a in triangle(), b in triangle()) {
        let (a, b) = (counter_clockwise(a), counter_clockwise(b));
        let of = |t: &[DVec2; 3]| 0.5 * (t[1] - t[0]).perp_dot(t[2] - t[0]);
        let mut both = ConvexPolygon::from_vertices(&a);
        for i in 0..3 {
            if of(&b) > 0.0 && !both.is_empty() {
                both = both.clipped(&HalfPlane::left_of(b[i], b[(i + 1) % 3]));
            }
        }
        let shared = if of(&a) > 0.0 && of(&b) > 0.0 { both.area() } else { 0.0 };
        let [even, nonzero] = areas(&[&a, &b]);
        prop_assert!((even - (of(&a) + of(&b) - 2.0 * shared)).abs() < 1e-10, "even-odd {even}, shared {shared}");
        prop_assert!((nonzero - (of(&a) + of(&b) - shared)).abs() < 1e-10, "non-zero {nonzero}, shared {shared}");
    }

    #[test]
    fn a_triangle_is_what_accumulate_makes_of_it(ring in triangle()) {
        let runs = |filled: bool| {
            let (mut runs, mut scratch) = (vec![], Accumulator::new());
            if filled {
                accumulate_filled(&[&ring], FillRule::EvenOdd, &Grid::UNIT, &mut scratch, |r| runs.push(r))
            } else {
                accumulate(&ring, &Grid::UNIT, &mut scratch, |r| runs.push(r))
            }
            .expect("within range");
            runs
        };
        prop_assert_eq!(runs(true), runs(false));
    }

    #[test]
    fn the_way_round_and_the_first_corner_do_not_matter(
        ring in prop::collection::vec((0..40_i32, 0..40_i32), 3..12), first in 0..12_usize,
    ) {
        let ring: Vec<DVec2> = ring.iter().map(|&(x, y)| dvec2(f64::from(x), f64::from(y)) / 7.0).collect();
        let mut other = ring.clone();
        other.rotate_left(first % ring.len());
        other.reverse();
        for (a, b) in areas(&[&ring]).into_iter().zip(areas(&[&other])) {
            prop_assert!((a - b).abs() < 1e-10, "{a} and {b}");
        }
        let [even, nonzero] = areas(&[&ring]);
        prop_assert!(even <= nonzero + 1e-10);
    }
}

/// 400 islands in 400 lakes in a ring with 100,000 corners, in windows of 100 × 100 of its 3·10¹⁶ cells.
#[test]
fn a_map_of_many_corners_is_cut_in_a_window() {
    let ring = |centre: DVec2, radius: f64, corners: usize| -> Vec<DVec2> {
        let corner = |i: usize| {
            let angle = i as f64 * std::f64::consts::TAU / corners as f64;
            let wave = 1.0 + 0.1 * (angle * 0.05 * corners as f64).sin() + 0.2 * (angle * 11.0).sin();
            centre + DVec2::from_angle(angle) * (radius * wave)
        };
        (0..corners).map(corner).collect()
    };
    let mut rings = vec![ring(DVec2::ZERO, 1e8, 100_000)];
    for i in 0..400 {
        let centre = dvec2(f64::from(i % 20) - 9.5, f64::from(i / 20) - 9.5) * 3e6;
        rings.push(ring(centre, 1e6, 100));
        rings.push(ring(centre, 5e5, 100));
    }
    let rings: Vec<&[DVec2]> = rings.iter().map(Vec::as_slice).collect();
    // Wholly in the land around the lakes, on an island, and in a lake.
    for (x0, y0, share) in [(0, 0, 1.0), (1_500_000, 1_500_000, 1.0), (2_150_000, 1_500_000, 0.0)] {
        let window = CellWindow { x0, y0, x1: x0 + 100, y1: y0 + 100 };
        let mut area = 0.0;
        accumulate_filled(
            &rings,
            FillRule::EvenOdd,
            &Grid::UNIT.with_window(window),
            &mut Accumulator::new(),
            |run| {
                area += run.area * run.columns.len() as f64;
            },
        )
        .expect("the window is small");
        assert_eq!(area, 10_000.0 * share, "{window:?}");
    }
}

#[test]
fn rings_that_touch_are_handled_as_those_that_cross() {
    // A hole with a corner on the outline, and one with a side on it.
    let outer = square(0.0, 3.0);
    let corner = [dvec2(0.0, 1.0), dvec2(1.0, 0.5), dvec2(1.0, 1.5)];
    let side = [dvec2(3.0, 1.0), dvec2(3.0, 2.0), dvec2(2.0, 2.0), dvec2(2.0, 1.0)];
    assert_eq!(areas(&[&outer, &corner])[0], 9.0 - 0.5);
    assert_eq!(areas(&[&outer, &side])[0], 8.0);
    assert_eq!(areas(&[&outer, &corner, &side])[0], 7.5);
    // Two parts with a common side, far away from the other rings.
    let far = |ring: [DVec2; 4]| ring.map(|v| v + dvec2(100.0, 50.0));
    let (left, right) = (
        far(square(0.0, 1.0)),
        far([(1.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0)].map(|(x, y)| dvec2(x, y))),
    );
    assert_eq!(areas(&[&outer, &corner, &left, &right])[0], 8.5 + 2.0);
}

/// Underflow of products made two small rings apart from one another a crossing at a height that is NaN.
#[test]
fn tiny_and_huge_cells_change_nothing() {
    for size in [1e-150, 1e-30, 1e150] {
        let grid = Grid::new(DVec2::ZERO, DVec2::splat(size)).expect("a normal size");
        let ring = |low: f64, high: f64| square(low * size, high * size);
        let (mut area, rings) = (0.0, [ring(0.25, 3.0), ring(1.0, 2.0), ring(2.5, 4.0)]);
        let rings: Vec<&[DVec2]> = rings.iter().map(|r| &r[..]).collect();
        accumulate_filled(&rings, FillRule::NonZero, &grid, &mut Accumulator::new(), |run| {
            area += run.area / grid.cell_area() * run.columns.len() as f64;
        })
        .expect("within range");
        assert!((area - (2.75 * 2.75 + 1.5 * 1.5 - 0.25)).abs() < 1e-12, "{area} for {size:e}");
    }
}
