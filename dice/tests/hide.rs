//! The facts of `invariants` about what is left of a polygon behind others.

use glam::{DVec2, dvec2};
use pointillist_dice::hide::Regions;
use pointillist_dice::invariants::{self, Rectangle, Sheet};
use pointillist_dice::{ConvexPolygon, HalfPlane, convex};
use proptest::prelude::*;
use testkit::holds;
use testkit::numbers::number;

/// A coordinate about the unit square, often on its border or shared with others.
fn coordinate() -> BoxedStrategy<f64> {
    prop_oneof![
        4 => -0.5..1.5,
        2 => (-2..=6).prop_map(|i| 0.25 * f64::from(i)),
        1 => (0..=4, -16..-3).prop_map(|(i, e)| 0.25 * f64::from(i) + 10f64.powi(e)),
    ]
    .boxed()
}

fn point() -> impl Strategy<Value = DVec2> {
    (coordinate(), coordinate()).prop_map(|(x, y)| dvec2(x, y))
}

fn opacity() -> impl Strategy<Value = f64> {
    prop_oneof![Just(1.0), Just(0.5), 0.0..1.0]
}

/// Triangles in positive order, some of them thin.
fn sheet() -> impl Strategy<Value = Sheet> {
    let corners = prop_oneof![
        4 => [point(), point(), point()],
        1 => (point(), point(), -1.0..2.0, -14..-1).prop_map(|(a, b, t, e)| {
            [a, b, a + (b - a) * t + (b - a).perp() * 10f64.powi(e)]
        }),
    ];
    (corners, opacity()).prop_map(|(mut corners, opacity)| {
        if convex::area(&corners) < 0.0 {
            corners.reverse();
        }
        (corners.to_vec(), opacity)
    })
}

/// At most as many as are exact whatever regions they make.
fn sheets() -> impl Strategy<Value = Vec<Sheet>> {
    prop::collection::vec(sheet(), 0..=12)
}

fn rectangle() -> impl Strategy<Value = Rectangle> {
    (point(), point(), opacity()).prop_map(|(a, b, opacity)| (a.min(b), a.max(b), opacity))
}

proptest! {
    #![proptest_config(testkit::config(512))]

    #[test]
    fn regions_make_up_the_polygon(sheets in sheets()) {
        holds!(invariants::regions_make_up_the_polygon(&sheets));
    }

    #[test]
    fn order_of_occluders_does_not_matter(sheets in sheets()) {
        holds!(invariants::order_of_occluders_does_not_matter(&sheets));
    }

    #[test]
    fn rectangles_take_what_they_cover(rectangles in prop::collection::vec(rectangle(), 0..=12)) {
        holds!(invariants::rectangles_take_what_they_cover(&rectangles));
    }

    #[test]
    fn kernels_take_any_polygon(
        a in prop::collection::vec((number(), number()), 0..9), b in prop::collection::vec((number(), number()), 0..9),
        half in prop::collection::vec(number(), 5), negligible in number(), opacity in number(),
    ) {
        let [a, b] = [a, b].map(|p| p.iter().map(|&(x, y)| dvec2(x, y)).collect::<Vec<DVec2>>());
        let _ = convex::are_disjoint(&a, &b);
        let mut regions = Regions::default();
        regions.start(ConvexPolygon::from_vertices(&a), negligible);
        let front = HalfPlane { anchor: dvec2(half[0], half[1]), normal: dvec2(half[2], half[3]), offset: half[4] };
        for front in [None, Some(front)] {
            regions.attenuate(&b, front, |_| opacity);
        }
        let _ = regions.is_hidden();
    }
}
