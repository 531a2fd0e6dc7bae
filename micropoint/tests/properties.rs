//! The facts of `invariants`, on scenes that aim at trouble.

use glam::{DAffine3, DMat3, DQuat, DVec3, dvec2, dvec3};
use pointillist_micropoint::invariants::{
    self, CULLED_TOLERANCE, CUT_TOLERANCE, Picture, Soup, picture, shares,
};
use pointillist_micropoint::{
    Geometry, MicropointOptions, Occlusion, PixelRect, PlainOpacity, Projection, Renderer, Tile, View,
};
use proptest::prelude::*;
use testkit::holds;

const EXACT: MicropointOptions = MicropointOptions::DEFAULT;
const PAPER: MicropointOptions = MicropointOptions::DEFAULT.with_occlusion(Occlusion::Paper);

/// Seen along −Z, 8 pixels high: a pixel is a unit square, (0, 0) the middle of the picture.
fn flat_view(width: u32, height: u32) -> View {
    let camera = Projection::Orthographic { height: f64::from(height) };
    View::look_at(DVec3::Z * 100.0, DVec3::ZERO, DVec3::Y, camera, width, height).unwrap()
}

fn perspective(eye: DVec3, target: DVec3, fov_y_rad: f64, width: u32, height: u32) -> View {
    View::look_at(eye, target, DVec3::Y, Projection::Perspective { fov_y_rad }, width, height).unwrap()
}

/// Any number, or one on a coarse grid.
fn coordinate() -> BoxedStrategy<f64> {
    prop_oneof![3 => -1.0..1.0, 1 => (-4..=4).prop_map(|i| 0.25 * f64::from(i))].boxed()
}

fn point() -> BoxedStrategy<DVec3> {
    (coordinate(), coordinate(), coordinate()).prop_map(|(x, y, z)| dvec3(x, y, z)).boxed()
}

fn generic_point() -> BoxedStrategy<DVec3> {
    (-1.0..1.0, -1.0..1.0, -1.0..1.0).prop_map(|(x, y, z)| dvec3(x, y, z)).boxed()
}

/// Views from outside and from among the triangles.
fn view() -> BoxedStrategy<View> {
    let perspective = (generic_point(), 0.2..4.0, generic_point(), 0.2..2.2f64, 1..12u32, 1..12u32)
        .prop_filter_map("eye and target differ", |(direction, distance, target, fov_y_rad, w, h)| {
            let eye = direction.try_normalize()? * distance;
            View::look_at(eye, target, DVec3::Y, Projection::Perspective { fov_y_rad }, w, h).ok()
        });
    let orthographic = (generic_point(), 0.5..4.0f64, 1..12u32, 1..12u32).prop_filter_map(
        "there is a direction",
        |(direction, height, w, h)| {
            let eye = direction.try_normalize()? * 5.0;
            View::look_at(eye, DVec3::ZERO, DVec3::Y, Projection::Orthographic { height }, w, h).ok()
        },
    );
    prop_oneof![3 => perspective, 1 => orthographic].boxed()
}

fn opacity() -> impl Strategy<Value = f32> {
    prop_oneof![3 => Just(1.0f32), 1 => 0.0..1.0f32]
}

/// Loose triangles: of any kind, slivers, huge, repeated.
fn triangle() -> BoxedStrategy<[DVec3; 3]> {
    prop_oneof![
        5 => [point(), point(), point()],
        1 => (point(), point(), -14..-1).prop_map(|(a, b, e)| [a, b, a.midpoint(b) + dvec3(0.3, 0.5, 0.7) * 10f64.powi(e)]),
        1 => (point(), point(), point()).prop_map(|(a, b, c)| [a, b * 100.0, c * 100.0]),
        1 => (point(), point()).prop_map(|(a, b)| [a, b, a]),
    ]
    .boxed()
}

/// Loose triangles, closed meshes, coincident copies.
fn soup() -> BoxedStrategy<Soup> {
    let loose = prop::collection::vec((triangle(), opacity(), any::<bool>()), 0..10);
    let solids = prop::collection::vec((point(), 0.1..0.8f64, 3..6u32, any::<bool>()), 0..3);
    (loose, solids)
        .prop_map(|(loose, solids)| {
            let mut soup = Soup::default();
            for (corners, opacity, repeat) in loose {
                let surface = soup.surface(opacity);
                soup.polygon(&corners, surface);
                if repeat && opacity < 0.5 {
                    let [a, b, c] = corners;
                    soup.polygon(&[b, c, a], surface);
                }
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

/// Few triangles without coincidences, for comparison with the arrangement.
fn few_triangles() -> BoxedStrategy<Soup> {
    let triangle = prop_oneof![
        4 => [generic_point(), generic_point(), generic_point()],
        1 => (generic_point(), generic_point(), generic_point()).prop_map(|(a, b, c)| [a, b * 40.0, c * 40.0]),
    ];
    prop::collection::vec((triangle, opacity()), 1..6)
        .prop_map(|triangles| {
            let mut soup = Soup::default();
            for (corners, opacity) in triangles {
                let surface = soup.surface(opacity);
                soup.polygon(&corners, surface);
            }
            soup
        })
        .boxed()
}

/// Dozens of opaque triangles and thin stripes in a few pixels.
fn crowd() -> BoxedStrategy<Soup> {
    let triangle = [generic_point(), generic_point(), generic_point()];
    let stripes = (generic_point(), 0.0..3.2f64, 0.001..0.05f64, 0..80u32);
    (prop::collection::vec((triangle, 0.05..1.0f64), 10..60), stripes)
        .prop_map(|(triangles, (at, angle, width, count))| {
            let mut soup = Soup::default();
            for (corners, size) in triangles {
                let surface = soup.surface(1.0);
                soup.polygon(&corners.map(|c| corners[0] + (c - corners[0]) * size), surface);
            }
            let (along, across) =
                (dvec3(angle.cos(), angle.sin(), 0.1), dvec3(-angle.sin(), angle.cos(), 0.05));
            for i in 0..count {
                let surface = soup.surface(1.0);
                let from = at + across * (f64::from(i) * width) - along;
                let to = from + across * width;
                soup.polygon(&[from, from + 2.0 * along, to + 2.0 * along, to], surface);
            }
            soup
        })
        .boxed()
}

/// Hundreds of stripes side by side over the whole picture, slanted, before a wall; one in so many is missing.
fn stripes_before_a_wall() -> BoxedStrategy<Soup> {
    (0.0..3.2f64, generic_point(), 40..500u32, 7..900u32)
        .prop_map(|(angle, slant, count, missing)| {
            let mut soup = Soup::default();
            let (wall, surfaces) = (soup.surface(1.0), [soup.surface(1.0), soup.surface(1.0)]);
            let corner = |x: f64, y: f64| dvec3(x, y, -9.0);
            soup.polygon(
                &[corner(-40.0, -40.0), corner(40.0, -40.0), corner(40.0, 40.0), corner(-40.0, 40.0)],
                wall,
            );
            let (along, across) = (
                dvec3(angle.cos(), angle.sin(), 0.1 * slant.x),
                dvec3(-angle.sin(), angle.cos(), 0.1 * slant.y),
            );
            let line = |i: u32| across * (16.0 * f64::from(i) / f64::from(count) - 8.0);
            for i in (0..count).filter(|i| i % missing != 3) {
                let (from, to) = (line(i), line(i + 1));
                let ends = [from - along * 9.0, from + along * 9.0, to + along * 9.0, to - along * 9.0];
                soup.polygon(&ends, surfaces[i as usize % 2]);
            }
            soup
        })
        .boxed()
}

/// A few balls of hundreds of triangles in a few pixels, through one another or behind one another.
fn small_balls(opacity: impl Strategy<Value = f32> + 'static) -> BoxedStrategy<Soup> {
    let ball = (generic_point(), 0.3..2.0f64, 6..14u32, 8..24u32, opacity);
    prop::collection::vec(ball, 2..7)
        .prop_map(|balls| {
            let mut soup = Soup::default();
            for (centre, radius, rows, columns, opacity) in balls {
                let surface = soup.surface(opacity);
                soup.sphere(centre, radius, rows, columns, surface);
            }
            soup
        })
        .boxed()
}

/// Moved, turned, scaled, mirrored, flattened, or as it was.
fn placement() -> BoxedStrategy<DAffine3> {
    let factor = prop_oneof![4 => 0.2..1.5f64, 1 => -1.5..-0.2f64, 1 => Just(1.0), 1 => Just(0.0)];
    let scale = prop_oneof![
        factor.clone().prop_map(DVec3::splat),
        (factor.clone(), factor.clone(), factor).prop_map(|(x, y, z)| dvec3(x, y, z)),
    ];
    let moved = (scale, generic_point(), 0.0..6.0f64, point()).prop_map(|(scale, axis, angle, to)| {
        let turn = DQuat::from_axis_angle(axis.try_normalize().unwrap_or(DVec3::X), angle);
        DAffine3::from_scale_rotation_translation(scale, turn, to)
    });
    prop_oneof![4 => moved, 1 => Just(DAffine3::IDENTITY)].boxed()
}

fn options() -> impl Strategy<Value = MicropointOptions> {
    (prop_oneof![Just(1u32), Just(2), Just(4)], any::<bool>(), any::<bool>()).prop_map(
        |(cells, paper, cull)| {
            (if paper { PAPER } else { EXACT }).with_cells_per_pixel(cells).with_cull_solids(cull)
        },
    )
}

proptest! {
    #![proptest_config(testkit::config(96))]

    #[test]
    fn weights_and_transmittance_sum_to_one(s in soup(), v in view(), o in options()) {
        holds!(invariants::weights_are_shares(&s, v, o));
    }

    #[test]
    fn a_picture_does_not_depend_on_its_tiles(s in soup(), v in view(), o in options()) {
        holds!(invariants::tiles_do_not_matter(&s, v, o));
    }

    #[test]
    fn a_picture_does_not_depend_on_the_order_of_triangles(s in soup(), v in view(), o in options(), seed: u64) {
        holds!(invariants::triangle_order_does_not_matter(&s, v, o, seed));
    }

    #[test]
    fn culling_the_back_faces_of_solids_never_changes_a_correlated_picture(s in soup(), v in view()) {
        let pictures = [true, false].map(|c| picture(&s, v, EXACT.with_cull_solids(c)).unwrap());
        let [a, b] = pictures.map(|p| shares(&p, s.surfaces.len()));
        holds!(invariants::shares_agree(&a, &b, CULLED_TOLERANCE));
    }

    #[test]
    fn a_shape_in_many_places_is_drawn_as_its_triangles(
        s in soup(), places in prop::collection::vec(placement(), 0..5), v in view(),
    ) {
        holds!(invariants::instances_are_their_triangles(&s, &places, v));
    }
}

proptest! {
    #![proptest_config(testkit::config(64))]

    #[test]
    fn every_pixel_shows_the_exact_share_of_every_surface(s in few_triangles(), v in view()) {
        holds!(invariants::shares_are_exact(&s, v, 2e-8));
    }

    #[test]
    fn cells_of_many_parts_show_what_many_cells_of_few_parts_show(s in crowd(), height in 2.0..6.0f64) {
        let camera = Projection::Orthographic { height };
        let view = View::look_at(dvec3(1.0, 0.5, 5.0), DVec3::ZERO, DVec3::Y, camera, 3, 2).unwrap();
        holds!(invariants::pixels_are_means_of_finer_ones(&s, view, 8, 1e-9));
    }

    #[test]
    fn stripes_that_tile_cells_show_what_finer_cells_show(s in stripes_before_a_wall(), height in 2.0..6.0f64, seed: u64) {
        let camera = Projection::Orthographic { height };
        let view = View::look_at(dvec3(1.0, 0.5, 5.0), DVec3::ZERO, DVec3::Y, camera, 3, 2).unwrap();
        holds!(invariants::pixels_are_means_of_finer_ones(&s, view, 8, 1e-9));
        holds!(invariants::nothing_shows_through(&s, view, EXACT, 1e-9));
        holds!(invariants::triangle_order_does_not_matter(&s, view, EXACT, seed));
    }

    #[test]
    fn cells_of_small_meshes_show_what_finer_cells_show(s in small_balls(Just(1.0)), height in 2.0..8.0f64) {
        let camera = Projection::Orthographic { height };
        let view = View::look_at(dvec3(1.0, 0.5, 5.0), DVec3::ZERO, DVec3::Y, camera, 3, 2).unwrap();
        holds!(invariants::pixels_are_means_of_finer_ones(&s, view, 8, 1e-9));
    }

    #[test]
    fn cells_of_small_meshes_are_shared_out_in_any_order(
        s in small_balls(prop_oneof![3 => Just(1.0f32), 1 => 0.1..0.9f32]),
        height in 2.0..8.0f64,
        seed: u64,
    ) {
        let camera = Projection::Orthographic { height };
        let view = View::look_at(dvec3(1.0, 0.5, 5.0), DVec3::ZERO, DVec3::Y, camera, 3, 2).unwrap();
        holds!(invariants::weights_are_shares(&s, view, EXACT));
        holds!(invariants::triangle_order_does_not_matter(&s, view, EXACT, seed));
    }

    #[test]
    fn cells_per_pixel_do_not_change_shares(s in few_triangles(), v in view()) {
        let [a, b, c] = [1, 2, 4].map(|n| shares(&picture(&s, v, EXACT.with_cells_per_pixel(n)).unwrap(), s.surfaces.len()));
        holds!(invariants::shares_agree(&a, &b, 2e-8));
        holds!(invariants::shares_agree(&a, &c, 2e-8));
    }

    #[test]
    fn a_planar_patch_has_no_seams(
        inner in prop::collection::vec((0.0..8.0f64, 0.0..8.0f64), 0..6), turn in 0.0..3.0f64, tilt in -0.9..0.9f64,
        paper: bool, flat: bool,
    ) {
        // A fan about each inner point, recursively: triangles of every size that share edges exactly.
        let mut corners = vec![dvec2(0.0, 0.0), dvec2(8.0, 0.0), dvec2(8.0, 8.0), dvec2(0.0, 8.0)];
        let mut triangles = vec![[0u32, 1, 2], [0, 2, 3]];
        for (x, y) in inner {
            let p = dvec2(x, y);
            let inside = |t: &[u32; 3]| (0..3).all(|i| {
                let (a, b) = (corners[t[i] as usize], corners[t[(i + 1) % 3] as usize]);
                (b - a).perp_dot(p - a) > 1e-3
            });
            if let Some(k) = triangles.iter().position(inside) {
                let [a, b, c] = triangles.swap_remove(k);
                let n = corners.len() as u32;
                corners.push(p);
                triangles.extend([[a, b, n], [b, c, n], [c, a, n]]);
            }
        }
        let rotation = DMat3::from_rotation_z(turn) * DMat3::from_rotation_x(tilt);
        let positions: Vec<_> = corners.iter().map(|c| rotation * ((*c - 4.0) * 3.0).extend(0.0)).collect();
        let mut s = Soup::default();
        let surface = s.surface(1.0);
        s.mesh(&positions, &triangles, surface);
        let v = if flat { flat_view(4, 4) } else { perspective(DVec3::Z * 5.0, DVec3::ZERO, 0.5, 9, 7) };
        // Where a triangle is clipped and its neighbour is not, their edge is apart by the rounding of where the neighbour's corner lands.
        let landing = |p: &DVec3| {
            let from_eye = *p - v.eye();
            let depth = from_eye.dot(v.forward());
            if depth > 0.0 { from_eye.length() / depth * 3.5 / 0.25f64.tan() } else { f64::INFINITY }
        };
        let (near, clipped): (Vec<f64>, _) = positions.iter().map(landing).partition(|&l| l < f64::from(1 << 18));
        let is_mixed = !flat && !Vec::is_empty(&clipped);
        let rounding = if is_mixed { 4.0 * f64::EPSILON * near.into_iter().fold(0.0, f64::max) } else { 0.0 };
        let tolerance = 1e-12 + rounding;
        holds!(invariants::nothing_shows_through(&s, v, if paper { PAPER } else { EXACT }, tolerance));
    }

    #[test]
    fn an_edge_cell_shows_the_exact_area(a in generic_point(), b in generic_point(), c in generic_point(), v in view(), o in options()) {
        let mut s = Soup::default();
        let surface = s.surface(1.0);
        s.polygon(&[a, b, c], surface);
        let got = shares(&picture(&s, v, o).unwrap(), 1);
        holds!(invariants::shares_agree(&got, &invariants::shares_by_arrangement(&s, &v), 1e-11));
    }

    #[test]
    fn transparent_layers_composite_to_the_closed_form(alphas in prop::collection::vec(0.0..=1.0f32, 1..9), paper: bool, v in view()) {
        let mut s = Soup::default();
        let axis = v.forward();
        let (x, y) = axis.any_orthonormal_pair();
        for (i, &alpha) in alphas.iter().enumerate() {
            let surface = s.surface(alpha);
            let centre = v.eye() + axis * (1.0 + i as f64);
            s.polygon(&[(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(a, b)| centre + (x * a + y * b) * 200.0), surface);
        }
        let mut transmittance = 1.0;
        let mut expected = vec![];
        for &alpha in &alphas {
            expected.push(transmittance * f64::from(alpha));
            transmittance *= 1.0 - f64::from(alpha);
        }
        let got = shares(&picture(&s, v, if paper { PAPER } else { EXACT }).unwrap(), alphas.len());
        let expected = vec![expected; got.len()];
        holds!(invariants::shares_agree(&got, &expected, 1e-11));
    }

    #[test]
    fn background_never_leaks_through_a_closed_mesh(
        centre in generic_point(), rows in 3..12u32, columns in 3..12u32, squash in 0.05..1.0f64, v in view(), cull: bool,
    ) {
        // Each pixel of a convex solid shows as much of it as its outline covers; nothing behind it is seen there.
        let mut s = Soup::default();
        let (solid, wall) = (s.surface(1.0), s.surface(1.0));
        s.sphere(DVec3::ZERO, 0.6, rows, columns, solid);
        let s = s.moved(|p| p * dvec3(1.0, squash, 1.0) + centre);
        let alone = shares(&picture(&s, v, EXACT).unwrap(), 2);
        let mut both = s.clone();
        let far = v.eye() + v.forward() * 50.0;
        let (x, y) = v.forward().any_orthonormal_pair();
        both.polygon(&[(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(a, b)| far + (x * a + y * b) * 1e4), wall);
        let o = EXACT.with_cull_solids(cull);
        let got = shares(&picture(&both, v, o).unwrap(), 2);
        holds!(invariants::nothing_shows_through(&both, v, o, CUT_TOLERANCE));
        let expected: Vec<_> = alone.iter().map(|p| vec![p[0], 1.0 - p[0]]).collect();
        holds!(invariants::shares_agree(&got, &expected, CUT_TOLERANCE * 10.0));
    }

    #[test]
    fn a_closed_box_is_seen_from_inside(eye in generic_point(), target in generic_point(), fov in 0.2..2.5f64, turned: bool) {
        prop_assume!(eye.distance(target) > 1e-3);
        let mut s = Soup::default();
        let surface = s.surface(1.0);
        s.cuboid(DVec3::splat(-1.01), DVec3::splat(1.01), surface);
        if turned {
            s.triangles.iter_mut().for_each(|t| t.swap(0, 1));
        }
        if let Ok(v) = View::look_at(eye, target, DVec3::Y, Projection::Perspective { fov_y_rad: fov }, 7, 5) {
            holds!(invariants::nothing_shows_through(&s, v, EXACT, 1e-9));
        }
    }

    #[test]
    fn the_same_outline_at_two_depths_shows_only_the_nearer(corners in [generic_point(), generic_point(), generic_point()], t in 1.01..4.0f64, v in view()) {
        let mut s = Soup::default();
        let (near, far) = (s.surface(1.0), s.surface(1.0));
        let axis = v.forward();
        let ahead = |p: DVec3| axis.dot(p - v.eye()) > 0.1;
        prop_assume!(corners.iter().all(|&p| ahead(p)));
        s.polygon(&corners, near);
        // Moved along the rays through the eye, or along the axis if they are parallel.
        let behind = |p: DVec3| if v.projection().is_perspective() { v.eye() + (p - v.eye()) * t } else { p + axis * (t - 1.0) };
        s.polygon(&corners.map(behind), far);
        let got = shares(&picture(&s, v, EXACT).unwrap(), 2);
        for (i, p) in got.iter().enumerate() {
            prop_assert!(p[1] <= 1e-9, "pixel {i} shows {} of what is hidden", p[1]);
        }
    }

    #[test]
    fn a_scene_moved_scaled_and_turned_looks_the_same(
        s in few_triangles(), v in view(), which in 0..5usize, angle in 0.0..6.0f64,
    ) {
        let turn = DMat3::from_axis_angle(dvec3(0.48, 0.6, 0.64), angle);
        let (scale, shift) = [(1.0, 1e4), (1.0, 1e6), (1e-4, 0.0), (1e4, 0.0), (1.0, 0.0)][which];
        let map = |p: DVec3| turn * (p * scale) + dvec3(shift, -0.7 * shift, 0.3 * shift);
        let Some((view, moved)) = mapped_view(&v, &map, scale).map(|w| (w, s.moved(map))) else { return Ok(()) };
        let [a, b] = [picture(&s, v, EXACT), picture(&moved, view, EXACT)].map(|p| shares(&p.unwrap(), s.surfaces.len()));
        // Positions are rounded by 1e6 × 2⁻⁵², which moves edges by that many units, and edges seen at grazing angles by more.
        let size = 2f64.powi(-52) * (shift.abs() / scale + 10.0);
        holds!(invariants::shares_agree(&a, &b, 1e-7 + 1e5 * size));
    }

    #[test]
    fn triangles_at_and_around_the_eye_do_no_harm(s in soup(), k in 0..8usize, target in generic_point(), fov in 0.1..3.0f64) {
        // A vertex, a point of an edge and a point of a face of the scene, as the eye.
        prop_assume!(!s.triangles.is_empty());
        let t = s.triangles[k % s.triangles.len()].map(|v| s.positions[v as usize]);
        for eye in [t[0], t[0].midpoint(t[1]), (t[0] + t[1] + t[2]) / 3.0] {
            if let Ok(v) = View::look_at(eye, target, DVec3::Y, Projection::Perspective { fov_y_rad: fov }, 5, 4) {
                holds!(invariants::weights_are_shares(&s, v, EXACT));
                holds!(invariants::tiles_do_not_matter(&s, v, EXACT));
            }
        }
    }
}

/// The view of the mapped scene; `None` if it cannot be told.
fn mapped_view(v: &View, map: &impl Fn(DVec3) -> DVec3, scale: f64) -> Option<View> {
    let projection = match v.projection() {
        Projection::Orthographic { height } => Projection::Orthographic { height: height * scale },
        perspective => perspective,
    };
    let (eye, origin) = (map(v.eye()), map(DVec3::ZERO));
    let direction = |d: DVec3| (map(d) - origin) / scale;
    // Directions of a moved scene are rounded: a target far away keeps more digits.
    let far = direction(v.forward()) * (eye.length() + scale);
    View::look_at(eye, eye + far, direction(v.up()), projection, v.width(), v.height()).ok()
}

/// A picture rendered by a pool of threads, tile by tile.
fn picture_by_threads(soup: &Soup, view: View, options: MicropointOptions, threads: usize) -> Picture {
    use rayon::prelude::*;
    let geometry = soup.geometry().unwrap();
    let renderer = Renderer::new(&geometry, &PlainOpacity, view, options).unwrap();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let tiles: Vec<PixelRect> = renderer.picture().tiles(8).collect();
    let picture = std::sync::Mutex::new(vec![vec![]; (view.width() * view.height()) as usize]);
    pool.install(|| {
        tiles.par_iter().for_each_init(Tile::default, |tile, &rect| {
            renderer.render(rect, tile);
            invariants::put_tile(&mut picture.lock().unwrap(), view.width(), tile);
        });
    });
    picture.into_inner().unwrap()
}

#[test]
#[cfg_attr(target_family = "wasm", ignore = "one thread is all there is")]
fn one_two_and_eight_threads_give_the_same_picture() {
    let mut s = Soup::default();
    let (ball, glass, ground) = (s.surface(1.0), s.surface(0.3), s.surface(1.0));
    s.sphere(dvec3(0.1, 0.2, 0.0), 1.0, 14, 20, ball);
    s.polygon(&[dvec3(-2.0, -1.0, 1.5), dvec3(1.0, -0.5, 1.5), dvec3(0.5, 1.5, 0.0)], glass);
    s.polygon(
        &[dvec3(-9.0, -1.0, 3.0), dvec3(9.0, -1.0, 3.0), dvec3(9.0, -1.0, -40.0), dvec3(-9.0, -1.0, -40.0)],
        ground,
    );
    let v = perspective(dvec3(0.3, 0.5, 4.0), DVec3::ZERO, 0.9, 60, 44);
    for options in [EXACT, PAPER, EXACT.with_cells_per_pixel(2)] {
        let expected = picture(&s, v, options).unwrap();
        for threads in [1, 2, 8] {
            let got = picture_by_threads(&s, v, options, threads);
            invariants::pictures_are_identical(&expected, &got, 60).unwrap();
        }
    }
}

#[test]
fn interpenetrating_planes_split_along_their_line() {
    // z = x and z = −x, seen along −Z: the nearer one is the first for x > 0. The line runs through the middle of a pixel.
    let mut s = Soup::default();
    let (a, b) = (s.surface(1.0), s.surface(1.0));
    let plane =
        |k: f64| [(-9.0, -9.0), (9.0, -9.0), (9.0, 9.0), (-9.0, 9.0)].map(|(x, y)| dvec3(x, y, k * x));
    s.polygon(&plane(1.0), a);
    s.polygon(&plane(-1.0), b);
    let got = shares(&picture(&s, flat_view(5, 3), EXACT).unwrap(), 2);
    for row in got.chunks(5) {
        for (p, expected) in row.iter().zip([0.0, 0.0, 0.5, 1.0, 1.0]) {
            assert!((p[0] - expected).abs() < 1e-12 && (p[1] - (1.0 - expected)).abs() < 1e-12, "{row:?}");
        }
    }
}

#[test]
fn what_lies_behind_an_orthographic_view_is_not_seen() {
    let mut s = Soup::default();
    let surface = s.surface(1.0);
    s.polygon(&[dvec3(-9.0, -9.0, 101.0), dvec3(9.0, -9.0, 101.0), dvec3(0.0, 9.0, 101.0)], surface);
    assert!(picture(&s, flat_view(4, 4), EXACT).unwrap().iter().all(Vec::is_empty));
    // From −Z to 200, through the plane of the eye: the half in front is seen.
    s.polygon(
        &[dvec3(-9.0, -9.0, 50.0), dvec3(9.0, -9.0, 50.0), dvec3(9.0, 9.0, 150.0), dvec3(-9.0, 9.0, 150.0)],
        surface,
    );
    let got = shares(&picture(&s, flat_view(4, 4), EXACT).unwrap(), 1);
    for (i, p) in got.iter().enumerate() {
        assert!((p[0] - f64::from(u8::from(i >= 8))).abs() < 1e-9, "{got:?}");
    }
}

#[test]
fn a_single_sided_surface_is_seen_from_its_front_only() {
    let mut s = Soup::default();
    let surface = s.surface(1.0);
    s.surfaces[0].two_sided = false;
    s.polygon(&[dvec3(-9.0, -9.0, 0.0), dvec3(9.0, -9.0, 0.0), dvec3(0.0, 9.0, 0.0)], surface);
    assert!(!picture(&s, flat_view(2, 2), EXACT).unwrap()[0].is_empty());
    s.triangles[0].swap(0, 1);
    assert!(picture(&s, flat_view(2, 2), EXACT).unwrap()[0].is_empty());
}

#[test]
fn the_nearest_plane_of_a_stack_hides_the_rest_at_every_distance() {
    // Gaps of one part in 10⁶ at distances of 10⁻³ to 10⁶.
    for distance in [1e-3, 1.0, 1e3, 1e6] {
        let mut s = Soup::default();
        for i in 0..4 {
            let surface = s.surface(1.0);
            let z = -distance * (1.0 + 1e-6 * f64::from(i));
            let r = 10.0 * distance;
            s.polygon(&[dvec3(-r, -r, z), dvec3(r, -r, z), dvec3(r, r, z), dvec3(-r, r, z)], surface);
        }
        let v = perspective(DVec3::ZERO, DVec3::NEG_Z, 1.0, 6, 6);
        for p in shares(&picture(&s, v, EXACT).unwrap(), 4) {
            assert!((p[0] - 1.0).abs() < 1e-12, "{distance}: {p:?}");
        }
    }
}

#[test]
fn geometry_that_nobody_sees_is_never_diced() {
    let mut s = Soup::default();
    let surface = s.surface(1.0);
    s.polygon(
        &[dvec3(-99.0, -99.0, 0.0), dvec3(99.0, -99.0, 0.0), dvec3(99.0, 99.0, 0.0), dvec3(-99.0, 99.0, 0.0)],
        surface,
    );
    for i in 0..20 {
        s.sphere(dvec3(f64::from(i % 5) - 2.0, f64::from(i / 5) - 2.0, -3.0), 0.5, 8, 12, surface);
    }
    let geometry: Geometry = s.geometry().unwrap();
    let renderer = Renderer::new(&geometry, &PlainOpacity, flat_view(16, 16), EXACT).unwrap();
    let mut tile = Tile::default();
    renderer.render(renderer.picture(), &mut tile);
    let counts = tile.counts();
    assert!(counts.triangles < 64 + 2 && counts.clusters_skipped > 10, "{counts:?}");
}
