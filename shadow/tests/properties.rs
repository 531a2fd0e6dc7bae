//! The facts of `invariants`, on scenes that aim at trouble.

use glam::{DVec3, dvec3};
use pointillist_micropoint::invariants::Soup;
use pointillist_micropoint::{
    MicropointOptions, Occlusion, PixelRect, PlainOpacity, Projection, Renderer, Tile, View,
};
use pointillist_shadow::invariants::{self, LitPicture, light_on, lit_picture};
use pointillist_shadow::{Emitter, Resolution, ShadowLight, ShadowOptions, ShadowScratch};
use proptest::prelude::*;
use testkit::holds;

fn exact() -> ShadowOptions {
    ShadowOptions::default()
}

fn paper(resolution: Resolution) -> ShadowOptions {
    ShadowOptions::default().with_occlusion(Occlusion::Paper).with_resolution(resolution)
}

fn lamp(position: DVec3) -> Emitter {
    Emitter::Point { position, axis: DVec3::NEG_Y }
}

fn sun(direction: DVec3) -> Emitter {
    Emitter::Directional { direction }
}

/// Looks down on the ground from just above it: what casts shadow there is out of view.
fn down(height: f64, pixels: u32) -> View {
    let camera = Projection::Orthographic { height };
    View::look_at(DVec3::Y * 0.5, DVec3::ZERO, DVec3::NEG_Z, camera, pixels, pixels).unwrap()
}

fn square(half: f64, y: f64) -> [DVec3; 4] {
    [dvec3(-half, y, half), dvec3(half, y, half), dvec3(half, y, -half), dvec3(-half, y, -half)]
}

/// A ground of two triangles with surface 0.
fn ground() -> Soup {
    let mut soup = Soup::default();
    let surface = soup.surface(1.0);
    soup.polygon(&square(20.0, 0.0), surface);
    soup
}

/// A cloth of 8 × 8 squares above the ground, two triangles each, with corners at these heights and without the triangles where `torn` says so. Each
/// triangle is larger by a part of it: none shares an edge with another unless that is 0.
fn cloth(heights: &[f64], torn: &[bool], larger: f64) -> Soup {
    let mut soup = ground();
    let surface = soup.surface(1.0);
    let corner = |i: usize, j: usize| {
        dvec3(0.25 * i as f64 - 1.0, 1.0 + heights[(9 * j + i) % heights.len()], 0.25 * j as f64 - 1.0)
    };
    for (k, torn) in torn.iter().enumerate() {
        let (i, j) = (k / 2 % 8, k / 16 % 8);
        let [a, b, c, d] = [corner(i, j), corner(i, j + 1), corner(i + 1, j + 1), corner(i + 1, j)];
        if !torn {
            let triangle = if k % 2 == 0 { [a, b, c] } else { [a, c, d] };
            let middle = triangle.iter().sum::<DVec3>() / 3.0;
            soup.polygon(&triangle.map(|p| p + larger * (p - middle)), surface);
        }
    }
    soup
}

fn point() -> BoxedStrategy<DVec3> {
    (-1.0..1.0, -1.0..1.0, -1.0..1.0).prop_map(|(x, y, z)| dvec3(x, y, z)).boxed()
}

fn direction() -> BoxedStrategy<DVec3> {
    point().prop_filter("not zero", |d| d.length() > 1e-2).boxed()
}

fn emitter() -> BoxedStrategy<Emitter> {
    prop_oneof![
        (point(), 0.1..4.0f64, direction()).prop_map(|(p, s, axis)| Emitter::Point { position: p * s, axis }),
        direction().prop_map(sun),
    ]
    .boxed()
}

fn soup() -> BoxedStrategy<Soup> {
    let opacity = || prop_oneof![2 => Just(1.0f32), 1 => 0.0..1.0f32];
    let loose = prop::collection::vec(([point(), point(), point()], opacity()), 0..6);
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

fn options() -> BoxedStrategy<ShadowOptions> {
    prop_oneof![3 => Just(exact()), 1 => Just(paper(Resolution::Auto)), 1 => Just(paper(Resolution::Cells(256)))].boxed()
}

/// Area of a convex polygon of the plane y = 0 inside each pixel of `down(height, pixels)`.
fn areas(polygon: &[DVec3], height: f64, pixels: u32) -> Vec<f64> {
    let scale = f64::from(pixels) / height;
    let middle = 0.5 * f64::from(pixels);
    let ring: Vec<_> =
        polygon.iter().map(|p| glam::dvec2(p.x * scale + middle, p.z * scale + middle)).collect();
    let mut areas = vec![0.0; (pixels * pixels) as usize];
    let mut scratch = pointillist_dice::Accumulator::new();
    let grid = pointillist_dice::Grid::UNIT;
    pointillist_dice::accumulate(&ring, &grid, &mut scratch, |run| {
        for (cell, _) in run.cells(&grid) {
            if cell.min_element() >= 0 && cell.max_element() < pixels as i32 {
                areas[cell.y as usize * pixels as usize + cell.x as usize] = run.area;
            }
        }
    })
    .unwrap();
    areas
}

proptest! {
    #![proptest_config(testkit::config(64))]

    #[test]
    fn fractions_are_between_zero_and_one(s in soup(), v in view(), e in emitter(), o in options()) {
        holds!(invariants::fractions_are_fractions(&s, v, e, o));
    }

    #[test]
    fn shadows_do_not_depend_on_tiles(s in soup(), v in view(), e in emitter(), o in options()) {
        holds!(invariants::tiles_do_not_matter(&s, v, e, o));
    }

    #[test]
    fn shadows_do_not_depend_on_the_order_of_triangles(s in soup(), v in view(), e in emitter(), o in options(), seed: u64) {
        holds!(invariants::triangle_order_does_not_matter(&s, v, e, o, seed));
    }

    #[test]
    fn lit_regions_are_what_is_lit(s in soup(), v in view(), e in emitter()) {
        holds!(invariants::lit_regions_make_up_the_fraction(&s, v, e, 1e-7));
    }

    #[test]
    fn what_is_dark_behind_a_cloth_is_dark_when_it_is_cut(
        heights in prop::collection::vec(0.0..0.6f64, 81),
        torn in prop::collection::vec(prop::bool::weighted(0.04), 128),
        (x, z) in (-0.7..0.7f64, -0.7..0.7f64),
        pixels in 3..9u32,
    ) {
        let lit = |larger: f64| {
            let s = cloth(&heights, &torn, larger);
            light_on(&lit_picture(&s, down(2.0, pixels), sun(dvec3(x, -1.0, z)), exact()).unwrap(), 0)
        };
        for (i, (joined, cut)) in lit(0.0).iter().zip(&lit(1e-9)).enumerate() {
            prop_assert!((joined - cut).abs() < 1e-7, "pixel {i}: {joined} {cut}");
        }
    }

    #[test]
    fn adding_a_caster_never_brightens(s in soup(), c in [point(), point(), point()], shift in 3.0..6.0f64, v in view(), e in emitter()) {
        let caster = c.map(|p| p * 3.0 + DVec3::Y * shift);
        holds!(invariants::a_caster_never_brightens(&s, &caster, v, e, exact(), 1e-7));
    }

    #[test]
    fn a_convex_solid_never_shades_its_own_lit_side(
        rows in 3..14u32, columns in 3..16u32, squash in 0.02..1.0f64, v in view(), d in direction(), far in 1.0..100.0f64, at_infinity: bool,
    ) {
        let mut s = Soup::default();
        let surface = s.surface(1.0);
        s.sphere(DVec3::ZERO, 0.45, rows, columns, surface);
        let s = s.moved(|p| p * dvec3(1.0, squash, 1.0));
        let e = if at_infinity { sun(-d) } else { lamp(d.normalize() * far) };
        for p in lit_picture(&s, v, e, exact()).unwrap().iter().flatten() {
            prop_assert!(p.lit == 1.0 || p.lit == 0.0, "{p:?}");
        }
    }

    #[test]
    fn an_open_convex_surface_never_shades_itself(columns in 2..20u32, bend in 0.0..1.4f64, v in view(), d in direction()) {
        // A strip of a cylinder, open: no culling of solids can help.
        let mut s = Soup::default();
        let surface = s.surface(1.0);
        let at = |i: u32, z: f64| {
            let a = bend * (2.0 * f64::from(i) / f64::from(columns) - 1.0);
            let r = 1.0 / bend.max(1e-3);
            dvec3(r * a.sin(), r * (a.cos() - 1.0), z)
        };
        let positions: Vec<_> = (0..=columns).flat_map(|i| [at(i, -1.0), at(i, 1.0)]).collect();
        let triangles: Vec<_> = (0..columns).flat_map(|i| [[2 * i, 2 * i + 1, 2 * i + 3], [2 * i, 2 * i + 3, 2 * i + 2]]).collect();
        s.mesh(&positions, &triangles, surface);
        // Seen from its outer side only: its hollow side may well lie in its own shadow.
        s.surfaces[0].two_sided = false;
        // On the convex side nothing stands in the light, at grazing angles too.
        let up = dvec3(d.x, d.y.abs().max(1e-3), d.z);
        for e in [sun(-up), lamp(up * 50.0)] {
            for p in lit_picture(&s, v, e, exact()).unwrap().iter().flatten() {
                let lit_side = p.lit == 1.0 || p.lit == 0.0;
                prop_assert!(lit_side, "{p:?}");
            }
        }
    }

    #[test]
    fn a_translucent_sheet_leaves_what_it_does_not_take(alphas in prop::collection::vec(0.0..=1.0f32, 1..5), e in (point(), 5.0..9.0f64)) {
        let mut s = ground();
        let mut passed = 1.0;
        for (i, &alpha) in alphas.iter().enumerate() {
            let surface = s.surface(alpha);
            s.polygon(&square(100.0, 1.0 + i as f64 * 0.5), surface);
            passed *= 1.0 - f64::from(alpha);
        }
        let (p, height) = e;
        for light in [lamp(dvec3(p.x, height, p.z)), sun(dvec3(p.x, -1.0, p.z))] {
            for lit in light_on(&lit_picture(&s, down(2.0, 4), light, exact()).unwrap(), 0) {
                prop_assert!((lit - passed).abs() < 1e-12, "{lit} for {passed}");
            }
        }
    }

    #[test]
    fn the_shadow_of_a_triangle_on_a_plane_has_the_analytic_area(c in [point(), point(), point()], l in (point(), 3.0..9.0f64), at_infinity: bool) {
        // Off-screen casters: the viewer looks down from below them.
        let corners = c.map(|p| dvec3(p.x, 1.5 + 0.5 * p.y, p.z));
        let mut s = ground();
        let surface = s.surface(1.0);
        s.polygon(&corners, surface);
        let position = dvec3(l.0.x, l.1, l.0.z);
        let (emitter, shadow) = if at_infinity {
            let d = dvec3(0.3 * l.0.x, -1.0, 0.3 * l.0.z);
            (sun(d), corners.map(|p| p + d * p.y))
        } else {
            (lamp(position), corners.map(|p| position + (p - position) * (position.y / (position.y - p.y))))
        };
        let (height, pixels) = (3.0, 6);
        let lit = light_on(&lit_picture(&s, down(height, pixels), emitter, exact()).unwrap(), 0);
        for (i, (l, dark)) in lit.iter().zip(areas(&shadow, height, pixels)).enumerate() {
            prop_assert!((l - (1.0 - dark)).abs() < 1e-7, "pixel {i}: {l} and {}", 1.0 - dark);
        }
    }

    #[test]
    fn receivers_across_the_borders_of_cube_screens_get_right_values(axis in direction(), position in point(), caster in 0.05..0.6f64) {
        // Whatever the screens' orientation, the shadow of a square is the same.
        let position = dvec3(position.x, 1.5 + 0.4 * position.y, position.z);
        let mut s = ground();
        let surface = s.surface(1.0);
        s.polygon(&square(caster, 0.6), surface);
        let shadow = square(caster, 0.6).map(|p| position + (p - position) * (position.y / (position.y - p.y)));
        let lit = light_on(&lit_picture(&s, down(5.0, 5), Emitter::Point { position, axis }, exact()).unwrap(), 0);
        for (i, (l, dark)) in lit.iter().zip(areas(&shadow, 5.0, 5)).enumerate() {
            prop_assert!((l - (1.0 - dark)).abs() < 1e-7, "pixel {i}: {l} and {}", 1.0 - dark);
        }
    }

    #[test]
    fn light_that_sheets_do_not_take_reaches_the_ground(corners in prop::collection::vec(([point(), point(), point()], 0.0..=1.0f32), 1..4)) {
        // The light looks where the viewer looks, along parallel rays: what each surface receives, seen from the light, adds up
        // to what came in. Here surfaces are seen from the light, so all that is seen is lit by what nearer ones let through:
        // Σ weight = 1 for an opaque ground, and every visible fragment of weight T·α has lit fraction T.
        let mut s = ground();
        for (c, alpha) in corners {
            let surface = s.surface(alpha);
            s.polygon(&c.map(|p| p + DVec3::Y * 1.5), surface);
        }
        let camera = Projection::Orthographic { height: 2.0 };
        let v = View::look_at(DVec3::Y * 9.0, DVec3::ZERO, DVec3::NEG_Z, camera, 3, 3).unwrap();
        let picture = lit_picture(&s, v, sun(DVec3::NEG_Y), exact()).unwrap();
        for pixel in &picture {
            for p in pixel {
                let alpha = f64::from(s.surfaces[p.surface as usize].opacity);
                // A fragment's area is at most 1, so its weight is at most T·α.
                prop_assert!(p.weight <= p.lit * alpha + 1e-7, "{p:?}");
            }
            let sum: f64 = pixel.iter().map(|p| p.weight).sum();
            prop_assert!((sum - 1.0).abs() < 1e-8);
        }
    }

    #[test]
    fn a_light_in_a_closed_box_lights_its_inside_and_nothing_else(p in point(), d in direction()) {
        let mut s = ground().moved(|q| q - DVec3::Y * 3.0);
        let surface = s.surface(1.0);
        s.cuboid(DVec3::splat(-1.1), DVec3::splat(1.1), surface);
        let camera = Projection::Perspective { fov_y_rad: 1.5 };
        let inside = View::look_at(p * 0.9, p * 0.9 + d, DVec3::Y, camera, 4, 4);
        if let Ok(v) = inside {
            for piece in lit_picture(&s, v, lamp(p), exact()).unwrap().iter().flatten() {
                prop_assert_eq!(piece.lit, 1.0);
            }
        }
        let outside = View::look_at(dvec3(4.0, 4.0, 5.0), DVec3::ZERO, DVec3::Y, camera, 6, 6).unwrap();
        for piece in lit_picture(&s, outside, lamp(p), exact()).unwrap().iter().flatten() {
            prop_assert!(piece.lit < 1e-12, "{piece:?}");
        }
    }
}

#[test]
fn a_box_on_the_ground_leaks_no_light_at_its_foot() {
    // The foot of the shadow starts exactly at the foot of the box.
    for elevation in [0.05, 0.3, 1.0, 3.0] {
        for is_closed in [true, false] {
            let mut s = ground();
            let surface = s.surface(1.0);
            if is_closed {
                s.cuboid(dvec3(-1.0, 0.0, -1.0), dvec3(0.0, 1.0, 1.0), surface);
            } else {
                s.polygon(
                    &[
                        dvec3(0.0, 0.0, -1.0),
                        dvec3(0.0, 0.0, 1.0),
                        dvec3(0.0, 1.0, 1.0),
                        dvec3(0.0, 1.0, -1.0),
                    ],
                    surface,
                );
            }
            let camera = Projection::Orthographic { height: 0.2 };
            let v = View::look_at(dvec3(0.1, 5.0, 0.0), dvec3(0.1, 0.0, 0.0), DVec3::NEG_Z, camera, 4, 4)
                .unwrap();
            let picture = lit_picture(&s, v, sun(dvec3(1.0, -elevation * 0.5, 0.0)), exact()).unwrap();
            let total: f64 = light_on(&picture, 0).iter().sum();
            assert!(total < 1e-9, "elevation {elevation}, closed {is_closed}: {total}");
        }
    }
}

#[test]
fn what_faces_away_from_the_light_gets_nothing() {
    let s = ground();
    let camera = Projection::Orthographic { height: 2.0 };
    let below = View::look_at(DVec3::NEG_Y, DVec3::ZERO, DVec3::X, camera, 2, 2).unwrap();
    for e in [lamp(DVec3::Y * 2.0), sun(dvec3(0.1, -1.0, 0.0))] {
        assert!(lit_picture(&s, below, e, exact()).unwrap().iter().flatten().all(|p| p.lit == 0.0));
        assert!(lit_picture(&s, down(2.0, 2), e, exact()).unwrap().iter().flatten().all(|p| p.lit == 1.0));
    }
}

#[test]
fn a_lamp_far_away_is_a_sun() {
    let mut s = ground();
    let surface = s.surface(1.0);
    s.sphere(dvec3(0.2, 1.5, 0.1), 0.7, 8, 9, surface);
    let d = dvec3(0.3, -1.0, 0.2).normalize();
    let v = down(4.0, 8);
    let near = light_on(&lit_picture(&s, v, lamp(-d * 1e7), exact()).unwrap(), 0);
    let sun = light_on(&lit_picture(&s, v, sun(d), exact()).unwrap(), 0);
    for (a, b) in near.iter().zip(&sun) {
        assert!((a - b).abs() < 1e-5, "{a} {b}");
    }
}

#[test]
fn the_error_of_the_papers_rule_falls_with_the_light_grid() {
    // A half-plane at an angle over the ground.
    let half =
        [dvec3(-0.13, 1.0, 30.0), dvec3(30.0, 1.0, 30.0), dvec3(30.0, 1.0, -30.0), dvec3(0.37, 1.0, -30.0)];
    let mut s = ground();
    let surface = s.surface(1.0);
    s.polygon(&half, surface);
    let (v, d) = (down(2.0, 8), dvec3(0.1, -1.0, 0.05));
    let expected = areas(&half.map(|p| p + d * p.y), 2.0, 8);
    let error = |o: ShadowOptions| {
        let lit = light_on(&lit_picture(&s, v, sun(d), o).unwrap(), 0);
        lit.iter().zip(&expected).map(|(l, dark)| (l - (1.0 - dark)).abs()).fold(0.0, f64::max)
    };
    assert!(error(exact()) < 1e-9, "{}", error(exact()));
    let errors = [512, 2048, 8192].map(|n| error(paper(Resolution::Cells(n))));
    assert!(errors[0] > errors[1] && errors[1] > errors[2] && errors[2] < 0.1, "{errors:?}");
}

#[test]
#[cfg_attr(target_family = "wasm", ignore = "one thread is all there is")]
fn one_two_and_eight_threads_give_the_same_shadows() {
    use rayon::prelude::*;
    let mut s = ground();
    let (ball, glass) = (s.surface(1.0), s.surface(0.4));
    s.sphere(dvec3(0.2, 1.0, 0.1), 0.7, 10, 14, ball);
    s.polygon(&square(1.5, 2.0), glass);
    let camera = Projection::Perspective { fov_y_rad: 0.8 };
    let v = View::look_at(dvec3(2.0, 3.0, 6.0), DVec3::ZERO, DVec3::Y, camera, 40, 32).unwrap();
    let geometry = s.geometry().unwrap();
    let renderer = Renderer::new(&geometry, &PlainOpacity, v, MicropointOptions::DEFAULT).unwrap();
    for emitter in [lamp(dvec3(1.0, 5.0, 2.0)), sun(dvec3(0.3, -1.0, 0.2))] {
        let light = ShadowLight::new(&geometry, &PlainOpacity, emitter, exact()).unwrap();
        let expected = invariants::lit_picture_of(&renderer, &light, [renderer.picture()]);
        for threads in [1, 2, 8] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let tiles: Vec<PixelRect> = renderer.picture().tiles(8).collect();
            let picture: std::sync::Mutex<LitPicture> = std::sync::Mutex::new(vec![vec![]; 40 * 32]);
            pool.install(|| {
                tiles.par_iter().for_each_init(<(Tile, ShadowScratch)>::default, |(tile, scratch), &rect| {
                    renderer.render(rect, tile);
                    invariants::put_lit_tile(&mut picture.lock().unwrap(), 40, tile, &light, scratch);
                });
            });
            assert!(picture.into_inner().unwrap() == expected, "{threads} threads");
        }
    }
}
