//! Lights with an area: facts of `invariants::area`, closed forms and limits.

use glam::{DVec3, dvec3};
use pointillist_micropoint::invariants::Soup;
use pointillist_micropoint::{Projection, View};
use pointillist_shadow::invariants::area::{self, seen_picture, shares_on};
use pointillist_shadow::{AreaLight, AreaOptions, ShadowError, check_outline};
use proptest::prelude::*;
use testkit::holds;

/// Looks down on the ground from just above it: what casts shadow there is out of view.
fn down(height: f64, pixels: u32) -> View {
    let camera = Projection::Orthographic { height };
    View::look_at(DVec3::Y * 0.5, DVec3::ZERO, DVec3::NEG_Z, camera, pixels, pixels).unwrap()
}

fn square(half: f64, y: f64) -> [DVec3; 4] {
    [dvec3(-half, y, half), dvec3(half, y, half), dvec3(half, y, -half), dvec3(-half, y, -half)]
}

/// A square light that looks down.
fn lamp(half: f64, y: f64) -> [DVec3; 4] {
    let [a, b, c, d] = square(half, y);
    [d, c, b, a]
}

fn ground() -> Soup {
    let mut soup = Soup::default();
    let surface = soup.surface(1.0);
    soup.polygon(&square(20.0, 0.0), surface);
    soup
}

fn point() -> BoxedStrategy<DVec3> {
    (-1.0..1.0, -1.0..1.0, -1.0..1.0).prop_map(|(x, y, z)| dvec3(x, y, z)).boxed()
}

fn direction() -> BoxedStrategy<DVec3> {
    point().prop_filter("not zero", |d| d.length() > 1e-2).boxed()
}

/// A corner and two sides.
fn parallelogram() -> BoxedStrategy<[DVec3; 3]> {
    (point(), direction(), direction(), 0.05..2.0f64, 0.5..3.0f64)
        .prop_filter("no line", |(_, u, v, ..)| u.cross(*v).length() > 0.05 * u.length() * v.length())
        .prop_map(|(p, u, v, size, far)| [p * far, u * size, v * size])
        .boxed()
}

fn outline([corner, u, v]: [DVec3; 3]) -> [DVec3; 4] {
    [corner, corner + u, corner + u + v, corner + v]
}

fn soup() -> BoxedStrategy<Soup> {
    let opacity = || prop_oneof![2 => Just(1.0f32), 1 => 0.0..1.0f32];
    // A coarse grid makes shared corners, coplanar triangles and points in planes of others.
    let coarse = || point().prop_map(|p| (p * 2.0).round() * 0.5);
    let corner = move || prop_oneof![coarse().boxed(), point()];
    let loose = prop::collection::vec(([corner(), corner(), corner()], opacity()), 0..6);
    let solids = prop::collection::vec((point(), 0.1..0.6f64, 3..5u32, any::<bool>()), 0..3);
    (loose, solids)
        .prop_map(|(loose, solids)| {
            let mut soup = ground().moved(|p| p - DVec3::Y);
            for (corners, opacity) in loose {
                let surface = soup.surface(opacity);
                soup.polygon(&corners, surface);
            }
            for (centre, size, rows, is_box) in solids {
                let surface = soup.surface(1.0);
                match is_box {
                    true => soup.cuboid(centre - size, centre + size * 0.5, surface),
                    false => soup.sphere(centre, size, rows, rows + 1, surface),
                }
            }
            soup
        })
        .boxed()
}

fn view() -> BoxedStrategy<View> {
    (direction(), 0.5..4.0f64, point(), 0.3..1.6f64, 1..7u32, 1..7u32)
        .prop_filter_map("eye and target differ", |(d, distance, target, fov_y_rad, w, h)| {
            let camera = Projection::Perspective { fov_y_rad };
            View::look_at(d.normalize() * distance, target, DVec3::Y, camera, w, h).ok()
        })
        .boxed()
}

proptest! {
    #![proptest_config(testkit::config(64))]

    #[test]
    fn what_is_seen_does_not_depend_on_tiles(s in soup(), v in view(), l in parallelogram()) {
        holds!(area::tiles_do_not_matter(&s, v, &outline(l)));
    }

    #[test]
    fn what_is_seen_does_not_depend_on_the_order_of_triangles(s in soup(), v in view(), l in parallelogram(), seed: u64) {
        holds!(area::triangle_order_does_not_matter(&s, v, &outline(l), seed));
    }

    #[test]
    fn what_is_seen_is_what_rays_find(s in soup(), v in view(), l in parallelogram()) {
        // An edge across the light misplaces half a cell of each row or column at most; a dozen edges may.
        holds!(area::agrees_with_rays(&s, v, l, 40, 0.1));
    }
}
