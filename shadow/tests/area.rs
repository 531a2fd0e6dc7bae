//! Lights with an area: facts of `invariants::area`, closed forms and limits.

use glam::{DVec3, dvec3};
use pointillist_micropoint::invariants::{self as micropoint, Soup};
use pointillist_micropoint::{MicropointOptions, PlainOpacity, Projection, SurfaceOpacity, View};
use pointillist_shadow::invariants::area::{self, seen_picture, seen_picture_with, shares_on};
use pointillist_shadow::invariants::line;
use pointillist_shadow::{AreaLight, AreaOptions, LineLight, ShadowError, check_outline};
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
    let solids = prop::collection::vec((point(), 0.1..0.6f64, 3..5u32, any::<bool>(), opacity()), 0..3);
    (loose, solids)
        .prop_map(|(loose, solids)| {
            let mut soup = ground().moved(|p| p - DVec3::Y);
            for (corners, opacity) in loose {
                let surface = soup.surface(opacity);
                soup.polygon(&corners, surface);
            }
            for (centre, size, rows, is_box, opacity) in solids {
                let surface = soup.surface(opacity);
                match is_box {
                    true => soup.cuboid(centre - size, centre + size * 0.5, surface),
                    false => soup.sphere(centre, size, rows, rows + 1, surface),
                }
            }
            soup
        })
        .boxed()
}

/// Balls by the dozen between the ground and a lamp: hundreds of outlines before it, which are then asked for cell by cell.
fn thicket() -> BoxedStrategy<Soup> {
    let ball = (point(), 0.05..0.4f64, prop_oneof![7 => Just(1.0f32), 1 => 0.0..1.0f32]);
    prop::collection::vec(ball, 40..70)
        .prop_map(|balls| {
            let mut soup = ground().moved(|p| p - DVec3::Y);
            for (centre, radius, opacity) in balls {
                let surface = soup.surface(opacity);
                soup.sphere(centre * dvec3(1.5, 0.6, 1.5), radius, 5, 9, surface);
            }
            soup
        })
        .boxed()
}

/// [`soup`] with masks on all surfaces but the ground; they are even, but only asking them tells.
fn masked_soup() -> BoxedStrategy<Soup> {
    let mask = |mut soup: Soup| {
        soup.surfaces[1..].iter_mut().for_each(|s| s.textured_opacity = true);
        soup
    };
    soup().prop_map(mask).boxed()
}

/// Of a line that shines.
fn ends() -> BoxedStrategy<[DVec3; 2]> {
    (point(), direction(), 0.5..3.0f64).prop_map(|(p, d, far)| [p * far, p * far + d]).boxed()
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
    fn what_is_seen_through_masks_does_not_depend_on_tiles(s in masked_soup(), v in view(), l in parallelogram()) {
        holds!(area::tiles_do_not_matter(&s, v, &outline(l)));
    }

    #[test]
    fn what_is_seen_through_masks_does_not_depend_on_the_order_of_triangles(s in masked_soup(), v in view(), l in parallelogram(), seed: u64) {
        holds!(area::triangle_order_does_not_matter(&s, v, &outline(l), seed));
    }

    #[test]
    fn pieces_behind_translucent_sheets_are_one_receiver(s in soup(), v in view(), half in 0.1..1.0f64) {
        // Each of a few outlines moves by a tenth of the light.
        holds!(area::pieces_may_be_asked_together(&s, v, &lamp(half, 6.0), 0.3));
    }

    #[test]
    fn what_is_seen_is_what_rays_find(s in soup(), v in view(), l in parallelogram()) {
        // An edge across the light misplaces half a cell of each row or column at most; a dozen edges may.
        holds!(area::agrees_with_rays(&s, v, l, 40, 0.1));
    }

    #[test]
    fn what_is_seen_of_a_line_does_not_depend_on_tiles(s in soup(), v in view(), l in ends()) {
        holds!(line::tiles_do_not_matter(&s, v, l));
    }

    #[test]
    fn what_is_seen_of_a_line_does_not_depend_on_the_order_of_triangles(s in soup(), v in view(), l in ends(), seed: u64) {
        holds!(line::triangle_order_does_not_matter(&s, v, l, seed));
    }

    #[test]
    fn what_is_seen_of_a_line_is_what_rays_find(s in soup(), v in view(), l in ends()) {
        // A caster misplaces half a place at each end.
        holds!(line::agrees_with_rays(&s, v, l, 200, 0.1));
    }
}

proptest! {
    #![proptest_config(testkit::config(8))]

    #[test]
    fn what_is_seen_through_a_thicket_does_not_depend_on_tiles(s in thicket(), v in view(), half in 1.0..3.0f64) {
        holds!(area::tiles_do_not_matter(&s, v, &lamp(half, 2.0)));
    }

    #[test]
    fn what_is_seen_through_a_thicket_does_not_depend_on_the_order_of_triangles(s in thicket(), v in view(), half in 1.0..3.0f64, seed: u64) {
        holds!(area::triangle_order_does_not_matter(&s, v, &lamp(half, 2.0), seed));
    }
}

#[test]
fn a_line_over_a_plane_gives_the_closed_form_and_its_shadow_its_limits() {
    // From −1 to 1 at height 1, over the ground's origin: ∫ h / (h² + x²)^(3/2) dx = 2 / √2 straight below its middle.
    let light = [dvec3(-1.0, 1.0, 0.0), dvec3(1.0, 1.0, 0.0)];
    let picture = line::seen_picture(&ground(), down(0.001, 1), light).unwrap();
    let expected = std::f64::consts::SQRT_2 / std::f64::consts::PI;
    assert!((picture[0][0].share - expected).abs() < 1e-6, "{picture:?}");
    // A wall that hides all places beyond 0 from the origin's right.
    let mut soup = ground();
    let wall = soup.surface(1.0);
    let corners = [dvec3(0.1, 0.0, -1.0), dvec3(0.1, 0.0, 1.0), dvec3(0.1, 2.0, 1.0), dvec3(0.1, 2.0, -1.0)];
    soup.polygon(&corners, wall);
    let picture = line::seen_picture(&soup, down(0.001, 1), light).unwrap();
    // From x = 0 the wall hides what is beyond 0.1; the pixel is 0.001 wide.
    let seen = picture[0][0].area;
    assert!((seen - 0.55).abs() < 1e-3, "{seen}");
}

#[test]
fn what_crosses_the_plane_of_a_light_of_two_sides_is_on_one_of_them() {
    // A light that stands on the ground, tilted, and the pixels under its foot.
    let front = [dvec3(-1.0, 0.0, 0.03), dvec3(1.0, 0.0, 0.03), dvec3(1.0, 1.0, 0.5), dvec3(-1.0, 1.0, 0.5)];
    let mut back = front;
    back.reverse();
    // One triangle: one receiver in each pixel.
    let mut soup = Soup::default();
    let surface = soup.surface(1.0);
    soup.polygon(&[dvec3(-9.0, 0.0, 9.0), dvec3(9.0, 0.0, 9.0), dvec3(0.0, 0.0, -9.0)], surface);
    let areas = |outline: &[DVec3]| -> Vec<f64> {
        let picture = seen_picture(&soup, down(0.5, 3), outline).unwrap();
        picture.iter().map(|pixel| pixel.iter().map(|p| p.weight * p.area).sum()).collect()
    };
    let both: Vec<f64> = areas(&front).into_iter().zip(areas(&back)).map(|(a, b)| a + b).collect();
    assert!(both.iter().all(|&sum| sum <= 1.0 + 1e-9 && sum > 0.9), "{both:?}");
}

#[test]
fn a_line_in_the_plane_of_a_receiver_does_not_light_it() {
    // A tilted square, whose plane is met by the line's ends up to rounding.
    let mut soup = Soup::default();
    let surface = soup.surface(1.0);
    let tilted = |p: DVec3| glam::DQuat::from_rotation_x(0.3) * p;
    soup.polygon(&square(1.0, 0.0).map(tilted), surface);
    let light = [dvec3(-0.3, 0.0, 0.7), dvec3(0.9, 0.0, -0.1)].map(tilted);
    let picture = line::seen_picture(&soup, down(0.5, 3), light).unwrap();
    assert!(picture.iter().all(Vec::is_empty), "{picture:?}");
}

#[test]
fn lines_that_are_none_are_refused() {
    let geometry = ground().geometry().unwrap();
    let refused = |ends| LineLight::new(&geometry, &PlainOpacity, ends, AreaOptions::DEFAULT).err();
    assert_eq!(refused([DVec3::X; 2]), Some(ShadowError::LineWithoutLength));
    assert_eq!(refused([DVec3::X, DVec3::NAN]), Some(ShadowError::NotFinite { what: "line" }));
}

proptest! {
    #![proptest_config(testkit::config(32))]

    #[test]
    fn a_convex_solid_never_shades_its_own_lit_side(rows in 3..14u32, columns in 3..16u32, squash in 0.05..1.0f64, v in view(), l in parallelogram()) {
        let mut s = Soup::default();
        let surface = s.surface(1.0);
        s.sphere(DVec3::ZERO, 0.45, rows, columns, surface);
        let s = s.moved(|p| p * dvec3(1.0, squash, 1.0));
        // Far enough away that the solid does not reach it.
        let outline = outline(l).map(|p| p + l[0].normalize() * 6.0);
        let alone = |triangle: u32| {
            let mut one = Soup::default();
            let surface = one.surface(1.0);
            let corners = s.triangles[triangle as usize].map(|i| s.positions[i as usize]);
            one.polygon(&corners, surface);
            one
        };
        for p in seen_picture(&s, v, &outline).unwrap().iter().flatten() {
            let one = alone(p.triangle).geometry().unwrap();
            let light = AreaLight::new(&one, &PlainOpacity, &outline, AreaOptions::DEFAULT).unwrap();
            let whole = light.whole(p.position, p.normal);
            // A point near an edge may see a sliver less, by rounding of the edge's ends.
            prop_assert!((p.area - whole.area() / light.area()).abs() < 1e-9, "{p:?}");
            prop_assert!((p.share - whole.share(p.normal)).abs() < 1e-9, "{p:?}");
        }
    }

    #[test]
    fn adding_a_caster_never_brightens(s in soup(), c in [point(), point(), point()], v in view(), half in 0.1..1.0f64) {
        let light = lamp(half, 6.0);
        let mut more = s.clone();
        let surface = more.surface(1.0);
        more.polygon(&c.map(|p| p + DVec3::Y * 4.0), surface);
        // One point for each receiver: others would not be the same before and after.
        let options = AreaOptions::DEFAULT.with_most_halvings(0);
        let picture = |s| seen_picture_with(s, v, &light, options).unwrap();
        let (before, after) = (picture(&s), picture(&more));
        // A caster that is seen changes what is seen of others, also where it turns a dark side to the light.
        let seen = micropoint::picture(&more, v, MicropointOptions::DEFAULT).unwrap();
        if seen.iter().flatten().any(|p| p.surface == surface) {
            return Ok(());
        }
        for s in 0..surface {
            for (a, b) in shares_on(&before, s).iter().zip(shares_on(&after, s)) {
                prop_assert!(b <= a + 1e-9, "{a} became {b}");
            }
        }
    }
}

/// What the middle of a ground sees of a light, looked at from just above.
fn seen_at_origin(soup: &Soup, light: &[DVec3], offset: DVec3) -> (f64, f64) {
    let view = View::look_at(
        offset + DVec3::Y * 0.5,
        offset,
        DVec3::NEG_Z,
        Projection::Orthographic { height: 1e-6 },
        1,
        1,
    );
    let moved = soup.moved(|p| p + offset);
    let light: Vec<DVec3> = light.iter().map(|&p| p + offset).collect();
    let picture = seen_picture(&moved, view.unwrap(), &light).unwrap();
    let mean = |f: &dyn Fn(&area::SeenPoint) -> f64| {
        let points = picture.iter().flatten().filter(|p| p.surface == 0);
        let (sum, weight) = points.fold((0.0, 0.0), |(s, w), p| (s + p.weight * f(p), w + p.weight));
        // Each pixel has four cells, each cut by the ground's diagonal or not.
        if weight > 0.0 { sum / weight } else { 0.0 }
    };
    (mean(&|p| p.area), mean(&|p| p.share))
}

#[test]
fn an_open_light_has_the_form_factor_of_a_square() {
    let (area, share) = seen_at_origin(&ground(), &lamp(1.0, 1.0), DVec3::ZERO);
    // Four unit squares one above a patch below their corner.
    let s = 0.5f64.sqrt();
    let factor = 4.0 * (2.0 * s * s.atan()) / std::f64::consts::TAU;
    assert_eq!(area, 1.0);
    assert!((share - factor).abs() < 1e-6, "{share} for {factor}");
}

#[test]
fn a_half_plane_halves_a_light() {
    let mut s = ground();
    let board = s.surface(1.0);
    s.polygon(
        &[dvec3(0.0, 1.0, 9.0), dvec3(9.0, 1.0, 9.0), dvec3(9.0, 1.0, -9.0), dvec3(0.0, 1.0, -9.0)],
        board,
    );
    let (area, share) = seen_at_origin(&s, &lamp(1.0, 2.0), DVec3::ZERO);
    let (_, open) = seen_at_origin(&ground(), &lamp(1.0, 2.0), DVec3::ZERO);
    assert!((area - 0.5).abs() < 1e-6, "{area}");
    assert!((share - 0.5 * open).abs() < 1e-6, "{share} of {open}");
}

#[test]
fn nothing_is_seen_in_the_umbra() {
    let mut s = ground();
    let board = s.surface(1.0);
    s.polygon(&square(5.0, 1.0), board);
    assert_eq!(seen_at_origin(&s, &lamp(1.0, 2.0), DVec3::ZERO), (0.0, 0.0));
}

#[test]
fn a_contact_shadow_ends_at_the_contact() {
    // A thin wall that stands on the ground beside the point, before the left half of the light and far above it.
    for gap in [1e-3, 1e-4] {
        let mut s = ground();
        let wall = s.surface(1.0);
        s.polygon(
            &[dvec3(gap, 0.0, -9.0), dvec3(gap, 9.0, -9.0), dvec3(gap, 9.0, 9.0), dvec3(gap, 0.0, 9.0)],
            wall,
        );
        let (area, _) = seen_at_origin(&s, &lamp(1.0, 2.0), DVec3::ZERO);
        // The wall hides what is on its other side.
        assert!((area - 0.5 * (1.0 + gap)).abs() < 1e-5, "{gap}: {area}");
    }
}

#[test]
fn sheets_in_the_receivers_plane_hide_nothing() {
    let mut s = ground();
    let twin = s.surface(1.0);
    // A twin of the ground, and a sheet beside the light in the light's own plane.
    s.polygon(&square(20.0, 0.0), twin);
    s.polygon(&square(3.0, 2.0), twin);
    let view = down(2.0, 4);
    for p in seen_picture(&s, view, &lamp(1.0, 2.0)).unwrap().iter().flatten() {
        assert!((p.area - 1.0).abs() < 1e-12, "{p:?}");
    }
}

#[test]
fn far_from_the_origin_nothing_changes() {
    let mut s = ground();
    let board = s.surface(1.0);
    s.polygon(
        &[dvec3(0.3, 1.0, 9.0), dvec3(9.0, 1.0, 9.0), dvec3(9.0, 1.0, -9.0), dvec3(0.3, 1.0, -9.0)],
        board,
    );
    let (here, _) = seen_at_origin(&s, &lamp(1.0, 2.0), DVec3::ZERO);
    for far in [1e3, 1e6] {
        let (there, _) = seen_at_origin(&s, &lamp(1.0, 2.0), dvec3(far, -far, far));
        assert!((here - there).abs() < 1e-5, "{far}: {here} {there}");
    }
}

#[test]
fn a_light_in_the_plane_of_a_receiver_does_not_light_it() {
    let light = [dvec3(1.0, 0.0, 0.0), dvec3(2.0, 0.0, 0.0), dvec3(2.0, 0.0, 1.0)];
    assert_eq!(seen_at_origin(&ground(), &light, DVec3::ZERO), (0.0, 0.0));
}

#[test]
fn a_tiny_light_is_a_point() {
    let mut s = ground();
    let board = s.surface(1.0);
    s.polygon(
        &[dvec3(0.3, 1.0, 9.0), dvec3(9.0, 1.0, 9.0), dvec3(9.0, 1.0, -9.0), dvec3(0.3, 1.0, -9.0)],
        board,
    );
    // The shadow's edge is twice as far to the side as the board's; the ground is seen from half its height.
    let picture = seen_picture(&s, down(4.0, 32), &lamp(1e-7, 2.0)).unwrap();
    for p in picture.iter().flatten().filter(|p| p.surface == 0) {
        let lit = if p.position.x < 0.6 { 1.0 } else { 0.0 };
        if (p.position.x - 0.6).abs() > 1e-3 {
            assert!((p.area - lit).abs() < 1e-6, "{p:?}");
        }
    }
}

#[test]
fn translucent_sheets_leave_what_they_do_not_take() {
    let mut s = ground();
    for (height, alpha) in [(1.0, 0.25), (1.2, 0.5)] {
        let surface = s.surface(alpha);
        s.polygon(&square(9.0, height), surface);
    }
    let (area, _) = seen_at_origin(&s, &lamp(1.0, 2.0), DVec3::ZERO);
    assert!((area - 0.75 * 0.5).abs() < 1e-9, "{area}");
}

/// The ground, and strips beside one another that hide this share of a light of two by two at height 2, from its left to its right; each has a
/// mask that is closed throughout.
fn behind_strips(count: u32, share: f64) -> Soup {
    let mut soup = ground();
    let masked = SurfaceOpacity { textured_opacity: true, ..SurfaceOpacity::default() };
    soup.surfaces.push(masked);
    let surface = soup.surfaces.len() as u32 - 1;
    // Half way, what hides from the origin is half as large.
    let place = |i: u32| -0.5 + share * f64::from(i) / f64::from(count);
    for i in 0..count {
        let corner = |x: f64, z: f64| dvec3(x, 1.0, z);
        let (left, right) = (place(i), place(i + 1));
        soup.polygon(
            &[corner(left, -0.6), corner(left, 0.6), corner(right, 0.6), corner(right, -0.6)],
            surface,
        );
    }
    soup
}

#[test]
fn many_masks_beside_one_another_hide_what_they_cover() {
    for (count, share) in [(3, 1.0), (8, 1.0), (8, 0.75), (11, 1.0), (16, 0.5), (27, 0.9)] {
        let (area, _) = seen_at_origin(&behind_strips(count, share), &lamp(1.0, 2.0), DVec3::ZERO);
        assert!((area - (1.0 - share)).abs() < 1e-3, "{count} strips over {share}: {area}");
    }
}

#[test]
fn what_passes_many_masks_does_not_depend_on_what_else_divides_the_light() {
    let strips = behind_strips(11, 0.8);
    let (area, share) = seen_at_origin(&strips, &lamp(1.0, 2.0), DVec3::ZERO);
    let mut wires = strips;
    let surface = wires.surface(1.0);
    for i in 0..7 {
        let z = -0.45 + 0.14 * f64::from(i);
        let ends = [-0.6, 0.6].map(|x| dvec3(x, 1.1, z + 0.2 * x));
        wires.polygon(&[ends[0], ends[1], ends[1] + DVec3::Z * 1e-7], surface);
    }
    let (area_behind_wires, share_behind_wires) = seen_at_origin(&wires, &lamp(1.0, 2.0), DVec3::ZERO);
    assert!((area - area_behind_wires).abs() < 1e-5, "{area}, {area_behind_wires}");
    assert!((share - share_behind_wires).abs() < 1e-5, "{share}, {share_behind_wires}");
}

#[test]
fn outlines_that_are_no_lights_are_refused() {
    let [a, b, c, d] = square(1.0, 2.0);
    let is = |vertices: &[DVec3]| check_outline(vertices);
    assert_eq!(is(&[a, b, c, d]), Ok(()));
    assert_eq!(is(&[a, b]), Err(ShadowError::OutlineLength { found: 2, most: 12 }));
    assert_eq!(is(&[a, b * f64::NAN, c]), Err(ShadowError::OutlineNotFinite { index: 1 }));
    assert_eq!(is(&[a, 0.5 * (a + b), b]), Err(ShadowError::OutlineWithoutArea));
    assert!(matches!(is(&[a, b, c + DVec3::Y, d]), Err(ShadowError::OutlineNotPlanar { .. })));
    let dent = dvec3(-0.2, 2.0, 0.2);
    assert_eq!(is(&[a, b, dent, d]), Err(ShadowError::OutlineNotConvex { index: 2 }));
    // A pentagram bends one way only, but turns round twice.
    let star = |k: u32| {
        let angle = f64::from(2 * k) * std::f64::consts::TAU / 5.0;
        dvec3(angle.cos(), 0.0, angle.sin())
    };
    let star: Vec<DVec3> = (0..5).map(star).collect();
    assert_eq!(is(&star), Err(ShadowError::OutlineNotConvex { index: 0 }));
}
