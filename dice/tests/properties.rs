//! The facts of `invariants`, on polygons that aim at trouble.

use glam::{DVec2, IVec2, dvec2};
use pointillist_dice::{
    Accumulator, CellWindow, Code, CodeKind, Grid, HalfPlane, accumulate, clip_ring, invariants, split,
};
use proptest::prelude::*;
use testkit::holds;

/// A coordinate on a grid line, next to one, or anywhere. Boxed: nested, the strategies outgrow a test's stack.
fn coordinate(size: f64) -> BoxedStrategy<f64> {
    let n = size as i32;
    prop_oneof![
        4 => -size..size,
        2 => (-n..=n).prop_map(f64::from),
        1 => (-n..=n).prop_map(|i| f64::from(i).next_up()),
        1 => (-n..=n).prop_map(|i| f64::from(i).next_down()),
        1 => (-n..=n, -16..0).prop_map(|(i, e)| f64::from(i) + 10f64.powi(e)),
        1 => (-2 * n..=2 * n).prop_map(|i| 0.5 * f64::from(i)),
        1 => prop_oneof![Just(5e-324), Just(-5e-324), Just(1e-300), Just(-0.0)],
    ]
    .boxed()
}

fn point(size: f64) -> impl Strategy<Value = DVec2> {
    (coordinate(size), coordinate(size)).prop_map(|(x, y)| dvec2(x, y))
}

/// Where a polygon may lie, in whole cells and in fractions.
fn far_away() -> impl Strategy<Value = DVec2> {
    let far =
        || prop_oneof![3 => Just(0.0), 1 => (-1_000_000..1_000_000).prop_map(f64::from), 1 => -1e9..1e9];
    (far(), far()).prop_map(|(x, y)| dvec2(x, y))
}

/// Triangles: of any kind, slivers, nearly collinear, with a repeated point.
fn triangle() -> BoxedStrategy<Vec<DVec2>> {
    let size = || prop_oneof![Just(1.5), Just(5.0), Just(20.0)];
    prop_oneof![
        4 => size().prop_flat_map(|s| prop::collection::vec(point(s), 3)),
        2 => (point(6.0), point(6.0), -1.0..2.0, -16..-1).prop_map(|(a, b, t, e)| {
            let across = (b - a).perp() * 10f64.powi(e);
            vec![a, b, a + (b - a) * t + across]
        }),
        1 => (point(6.0), point(6.0)).prop_map(|(a, b)| vec![a, b, a]),
        1 => (point(6.0), point(1e-6), point(1e-6)).prop_map(|(a, b, c)| vec![a, a + b, a + c]),
    ]
    .boxed()
}

/// Convex polygons: points of an ellipse (also very flat), and hulls of arbitrary points.
fn convex() -> BoxedStrategy<Vec<DVec2>> {
    let ellipse = (point(4.0), 0.0..7.0, -9..1, prop::collection::vec(0.0..std::f64::consts::TAU, 3..12))
        .prop_map(|(centre, turn, flat, mut angles)| {
            angles.sort_by(f64::total_cmp);
            let minor = 5.0 * 10f64.powi(flat);
            let turned = DVec2::from_angle(turn);
            angles.iter().map(|&t| centre + turned.rotate(dvec2(5.0 * t.cos(), minor * t.sin()))).collect()
        });
    prop_oneof![ellipse, prop::collection::vec(point(5.0), 3..10).prop_map(hull), triangle()].boxed()
}

fn hull(mut points: Vec<DVec2>) -> Vec<DVec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let half = |points: &mut dyn Iterator<Item = DVec2>| {
        let mut chain: Vec<DVec2> = vec![];
        for p in points {
            while let [.., a, b] = chain[..]
                && (b - a).perp_dot(p - b) <= 0.0
            {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let lower = half(&mut points.iter().copied());
    let upper = half(&mut points.iter().rev().copied());
    [lower, upper].concat()
}

/// Star-shaped rings around a point: concave, and simple.
fn star() -> BoxedStrategy<Vec<DVec2>> {
    (point(3.0), prop::collection::vec(0.01..8.0f64, 3..24))
        .prop_map(|(centre, radii)| {
            let step = std::f64::consts::TAU / radii.len() as f64;
            radii.iter().enumerate().map(|(i, r)| centre + DVec2::from_angle(i as f64 * step) * *r).collect()
        })
        .boxed()
}

fn grid() -> impl Strategy<Value = Grid> {
    prop_oneof![
        3 => Just(Grid::UNIT),
        1 => (point(3.0), 0.3..3.0, 0.3..3.0).prop_map(|(o, x, y)| Grid::new(o, dvec2(x, y)).unwrap()),
        1 => Just(Grid::new(dvec2(0.1, -0.3), dvec2(0.1, 0.7)).unwrap()),
    ]
}

/// Any bits at all: NaN, infinities, subnormal and huge numbers, and mixtures with small ones.
fn anything() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<f64>(),
        any::<u64>().prop_map(f64::from_bits),
        -10.0..10.0,
        -1e10..1e10,
        coordinate(1e7),
        Just(0.0)
    ]
}

fn any_ring() -> impl Strategy<Value = Vec<DVec2>> {
    prop::collection::vec((anything(), anything()).prop_map(|(x, y)| dvec2(x, y)), 0..8)
}

proptest! {
    #![proptest_config(testkit::config(512))]

    #[test]
    fn cut_equals_accumulate(p in triangle(), far in far_away()) {
        let triangle: [DVec2; 3] = p.try_into().expect("three corners");
        holds!(invariants::cut_equals_accumulate(&triangle.map(|v| v + far)));
    }

    #[test]
    fn cut_pieces_lie_in_their_cells(p in convex(), far in far_away()) {
        let ring: Vec<_> = p.iter().map(|v| *v + far).collect();
        holds!(invariants::cut_pieces_lie_in_their_cells(&ring));
    }

    #[test]
    fn cut_window_is_part_of_the_whole(p in convex(), corner in (-8..8, -8..8), size in (0..9, 0..9)) {
        let ((x0, y0), (width, height)) = (corner, size);
        let window = CellWindow { x0, y0, x1: x0 + width, y1: y0 + height };
        holds!(invariants::cut_window_is_part_of_the_whole(&p, window));
    }

    #[test]
    fn cut_shares_edges(a in point(9.0), b in point(9.0), left in point(9.0), right in point(9.0), far in far_away()) {
        holds!(invariants::cut_shares_edges([a + far, b + far], left + far, right + far));
    }

    #[test]
    fn area_and_moments_are_conserved(p in convex(), g in grid()) {
        holds!(invariants::area_and_moments_are_conserved(&p, &g));
    }

    #[test]
    fn vertices_lie_in_their_cells(p in convex(), g in grid()) {
        holds!(invariants::vertices_lie_in_their_cells(&p, &g));
    }

    #[test]
    fn pieces_are_convex_and_turn_like_the_polygon(p in convex(), g in grid()) {
        holds!(invariants::pieces_are_convex_polygons(&p, &g));
    }

    #[test]
    fn pieces_do_not_overlap(p in convex(), g in grid()) {
        holds!(invariants::pieces_do_not_overlap(&p, &g));
    }

    #[test]
    fn split_equals_sutherland_hodgman(p in convex(), g in grid()) {
        holds!(invariants::equals_sutherland_hodgman(&p, &g));
    }

    #[test]
    fn split_equals_accumulate(p in convex(), g in grid()) {
        holds!(invariants::split_equals_accumulate(&p, &g));
    }

    #[test]
    fn accumulate_equals_clipping_for_concave_rings(p in prop_oneof![star(), convex()], g in grid()) {
        holds!(invariants::accumulate_equals_clipping(&p, &g));
    }

    #[test]
    fn order_of_vertices_does_not_matter(p in prop_oneof![star(), convex()], g in grid()) {
        holds!(invariants::order_of_vertices_does_not_matter(&p, &g));
    }

    #[test]
    fn shared_edges_are_cut_alike(a in point(9.0), b in point(9.0), c in point(9.0), d in point(9.0), g in grid()) {
        holds!(invariants::shared_edge_is_cut_alike([a, b], c, d, &g));
    }

    #[test]
    fn shift_by_whole_cells_shifts_the_result(
        p in prop::collection::vec((-4000..4000, -4000..4000), 3), x in -9_000_000..9_000_000, y in -9_000_000..9_000_000,
    ) {
        let p: Vec<_> = p.iter().map(|&(x, y)| dvec2(f64::from(x), f64::from(y)) / 512.0).collect();
        holds!(invariants::shift_by_whole_cells_shifts_the_result(&p, IVec2::new(x, y)));
    }

    #[test]
    fn polygons_far_away_obey_the_same_facts(p in convex(), x in -1e7..1e7, y in -1e7..1e7) {
        let p: Vec<_> = p.iter().map(|v| *v + dvec2(x, y)).collect();
        holds!(invariants::all_of(&p, &Grid::UNIT));
    }

    #[test]
    fn no_code_is_impossible(p in convex(), g in grid()) {
        for piece in invariants::pieces(&p, &g).unwrap_or_default() {
            let cuts = matches!(piece.code.kind(), CodeKind::Cuts { .. });
            prop_assert!(cuts, "{}", piece.code);
        }
    }

    #[test]
    fn a_point_on_the_line_has_no_area(p in point(5.0), q in point(5.0), t in prop::collection::vec(0..=64, 1..6)) {
        // Multiples of 1/64 of a vector with few digits are on its line exactly.
        let few = |v: DVec2| (v * 64.0).round() / 64.0;
        let (p, q) = (few(p), few(q));
        let ring: Vec<_> = t.iter().map(|&t| p + (q - p) * (f64::from(t) / 64.0)).collect();
        prop_assert!(invariants::pieces(&ring, &Grid::UNIT).unwrap().is_empty());
        prop_assert!(invariants::cells(&ring, &Grid::UNIT).unwrap().is_empty());
    }

    #[test]
    fn fans_of_triangles_sum_to_one(centre in (0.0..8.0, 0.0..8.0), rim in prop::collection::vec(0.0..32.0f64, 3..24)) {
        // Triangles between a point and the outline of an 8 × 8 square.
        let mut rim = rim;
        rim.extend([0.0, 8.0, 16.0, 24.0]);
        rim.sort_by(f64::total_cmp);
        let on_rim = |t: f64| match t {
            t if t < 8.0 => dvec2(t, 0.0),
            t if t < 16.0 => dvec2(8.0, t - 8.0),
            t if t < 24.0 => dvec2(24.0 - t, 8.0),
            t => dvec2(0.0, 32.0 - t),
        };
        let (mut sums, mut split_sums) = ([0.0; 64], [0.0; 64]);
        for i in 0..rim.len() {
            let fan = [dvec2(centre.0, centre.1), on_rim(rim[i]), on_rim(rim[(i + 1) % rim.len()])];
            for ((y, x), (area, _)) in invariants::cells(&fan, &Grid::UNIT).unwrap() {
                sums[(8 * y + x) as usize] += area;
            }
            for p in invariants::pieces(&fan, &Grid::UNIT).unwrap() {
                split_sums[(8 * p.cell.y + p.cell.x) as usize] += p.area;
            }
        }
        for (a, s) in sums.iter().zip(&split_sums) {
            prop_assert!((a - 1.0).abs() <= 4.0 * f64::EPSILON, "accumulate: {a}");
            prop_assert!((s - 1.0).abs() <= 4.0 * f64::EPSILON, "split: {s}");
        }
    }

    #[test]
    fn split_never_panics(p in any_ring(), o in (anything(), anything()), c in (anything(), anything())) {
        let grid = Grid::new(dvec2(o.0, o.1), dvec2(c.0, c.1)).unwrap_or(Grid::UNIT);
        if cheap(&p, &grid) {
            let _ = split(&p, &grid, |_| ());
        }
    }

    #[test]
    fn accumulate_never_panics(p in any_ring(), o in (anything(), anything()), c in (anything(), anything())) {
        let grid = Grid::new(dvec2(o.0, o.1), dvec2(c.0, c.1)).unwrap_or(Grid::UNIT);
        if cheap(&p, &grid) {
            let _ = accumulate(&p, &grid, &mut Accumulator::new(), |_| ());
        }
    }

    #[test]
    fn a_clipped_ring_lies_on_one_side_and_the_parts_make_up_the_whole(
        ring in prop::collection::vec(point(8.0), 3..9),
        line in (point(8.0), point(8.0)),
    ) {
        holds!(invariants::clipping_divides(&ring, &HalfPlane::left_of(line.0, line.1)));
    }

    #[test]
    fn clipping_never_panics(ring in any_ring(), line in (anything(), anything(), anything())) {
        let normal = dvec2(line.0, line.1);
        let mut kept = 0;
        let middle = |(a, _): (DVec2, f64), (b, _): (DVec2, f64)| 0.5 * (a + b);
        clip_ring(&ring, |p| normal.dot(p) + line.2, middle, |_| kept += 1);
        prop_assert!(kept <= 2 * ring.len());
    }
}

/// Whether the call takes little time: the largest that are allowed take seconds.
fn cheap(p: &[DVec2], grid: &Grid) -> bool {
    let size = p.iter().fold(DVec2::ZERO, |m, v| m.max(((*v - grid.origin()) / grid.cell()).abs()));
    let cells = 4.0 * (size.x * size.y + size.x + size.y);
    cells < 1e6 || !cells.is_finite() || size.max_element() > pointillist_dice::MAX_COORDINATE || cells > 1e12
}

#[test]
fn all_thirty_four_codes_occur_and_no_other() {
    let mut seen = [false; Code::COUNT as usize];
    let mut state = 1u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / (1u64 << 24) as f64
    };
    for size in [1.5, 3.0, 10.0, 30.0] {
        for _ in 0..2000 {
            let triangle = [(); 3].map(|()| dvec2(size * random(), size * random()));
            split(&triangle, &Grid::UNIT, |p| seen[usize::from(p.code.value())] = true).unwrap();
        }
    }
    for code in Code::all() {
        let cuts = matches!(code.kind(), CodeKind::Cuts { .. });
        assert_eq!(seen[usize::from(code.value())], cuts, "code {code}");
    }
}
