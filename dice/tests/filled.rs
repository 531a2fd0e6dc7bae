//! Outlines that cross themselves, and holes.

use glam::{DVec2, dvec2};
use pointillist_dice::{
    Accumulator, ConvexPolygon, DiceError, FillRule, Grid, HalfPlane, accumulate, accumulate_filled,
};
use proptest::prelude::*;

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
