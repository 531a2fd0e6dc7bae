//! Bugs that were fixed, each with the smallest input that showed it.

use glam::{DAffine3, DMat3, DVec3, Vec3, dvec2, dvec3};
use pointillist_surfel::invariants::{
    OwnedPoints, cloud, culling_changes_nothing, frame, frame_is_sound, frames_are_identical, look_at,
    one_color_stays_one_color, use_before_does_not_matter,
};
use pointillist_surfel::{
    Focus, Light, Options, Projection, SampleOptions, SurfelError, View, field_of_view_rad, sample,
};

const PERSPECTIVE: Projection = Projection::Perspective { fov_y_rad: 0.7 };

fn disc(at: DVec3, normal: Vec3, radius: f32) -> OwnedPoints {
    OwnedPoints { normals: Some(vec![normal]), radii: Some(vec![radius]), ..OwnedPoints::loose(vec![at]) }
}

/// `max_element` ignores NaN, and so did the check of positions.
#[test]
fn one_coordinate_that_is_nan_is_refused() {
    let points = OwnedPoints::loose(vec![DVec3::ZERO, dvec3(0.0, f64::NAN, 0.0)]);
    let error = cloud(&points).unwrap_err();
    assert!(matches!(error, SurfelError::PointNotFinite { index: 1, .. }), "{error:?}");
}

/// Runs of eight pixels added up what lay beyond a disc's columns; it was not cleared, and appeared in the next tile.
#[test]
fn a_disc_leaves_nothing_beyond_its_columns() {
    let point = disc(dvec3(0.0, 0.0, -0.887_584_319_129_471_8), Vec3::Z, 0.007_071_067_6);
    let look = |width| {
        look_at(DVec3::Z * 0.1, DVec3::ZERO, Projection::Perspective { fov_y_rad: 0.2 }, width, 65).unwrap()
    };
    let mut blurred = Options::default();
    blurred.focus = Focus::Depth { depth: 0.093_650_515_018_749_38, focus: 5.634_840_340_433_71 };
    use_before_does_not_matter(&point, (&look(129), &blurred), (&look(129), &blurred)).unwrap();
    use_before_does_not_matter(&point, (&look(121), &blurred), (&look(129), &Options::default())).unwrap();
}

/// The plane of a disc beside the eye was followed to behind it.
#[test]
fn no_depth_is_behind_the_eye() {
    let (eye, target) = (DVec3::ZERO, dvec3(0.147_988_420_035_264_77, 0.0, 1.098_836_798_271_553));
    let points = OwnedPoints::loose(vec![
        dvec3(1.167_266_769_150_518_7, 0.0, 0.0),
        dvec3(0.0, 1.484_223_487_486_215_2, 0.0),
    ]);
    let view = look_at(eye, target, Projection::Orthographic { height: 2.0 }, 24, 17).unwrap();
    let drawn = frame(&points, &view, &Options::default()).unwrap();
    frame_is_sound(&drawn, 1.0).unwrap();
}

/// The square of a short direction underflowed to 0.
#[test]
fn light_may_come_along_a_short_direction() {
    let point = disc(DVec3::ZERO, Vec3::Z, 0.5);
    let view = look_at(DVec3::Z * 3.0, DVec3::ZERO, PERSPECTIVE, 16, 16).unwrap();
    let by = |length: f64| {
        let mut options = Options::default();
        options.light = Light::Towards(DVec3::Z * length);
        frame(&point, &view, &options).unwrap()
    };
    frames_are_identical(&by(1.0), &by(1e-200)).unwrap();
}

/// An infinite focus gave a field of view that was not a number.
#[test]
fn a_lens_can_be_focused_on_infinity() {
    assert_eq!(field_of_view_rad(1.0, 2.0, f64::INFINITY), Some(std::f64::consts::FRAC_PI_2));
}

/// Positions in the cloud were rounded in world coordinates before the eye was subtracted.
#[test]
fn a_scene_far_from_the_origin_gives_the_same_frame() {
    let near = OwnedPoints::sphere(DVec3::ZERO, 0.5, 200).moved(|p| (p * 1_048_576.0).round() / 1_048_576.0);
    let look = |shift: DVec3| {
        let map = DAffine3::from_mat3_translation(DMat3::IDENTITY, -(DVec3::Z * 2.0 + shift));
        View::from_matrix(map, PERSPECTIVE, 20, 20).unwrap()
    };
    let far = DVec3::splat(1_048_576.0);
    let a = frame(&near, &look(DVec3::ZERO), &Options::default()).unwrap();
    let b = frame(&near.moved(|p| p + far), &look(far), &Options::default()).unwrap();
    frames_are_identical(&a, &b).unwrap();
}

/// Points with neither extent nor blur on the picture were thinned by a factor of 0/0, and then weighted by it.
#[test]
fn points_without_extent_on_the_picture_are_drawn() {
    let camera = Projection::Orthographic { height: 1e300 };
    let view = look_at(DVec3::Z, DVec3::ZERO, camera, 8, 8).unwrap();
    let drawn = frame(&disc(DVec3::ZERO, Vec3::Z, 0.5), &view, &Options::default()).unwrap();
    frame_is_sound(&drawn, 1.0).unwrap();
}

/// Found by `surfel_sample`: a triangle longer than the largest number of `f32` had discs without end.
#[test]
fn radii_of_huge_triangles_are_numbers() {
    let corners = [DVec3::Z * 5.1e115, dvec3(1.6, 0.0, 1.6), DVec3::Z * 0.5];
    let points = sample(&corners, &[[0, 1, 2]], &SampleOptions::DEFAULT.with_count(183)).unwrap();
    assert!(points.iter().all(|p| p.radius.is_finite()));
}

/// Hidden nodes were skipped, and the count of them said 0.
#[test]
fn nodes_behind_a_wall_are_counted_as_hidden() {
    let wall = |z: f64| OwnedPoints::plane(DVec3::Z * z, DVec3::X * 0.01, DVec3::Y * 0.01, 150, 150);
    let points = wall(0.0).and(&wall(-1.0));
    let view = look_at(DVec3::Z * 2.0, DVec3::ZERO, PERSPECTIVE, 90, 90).unwrap();
    let hidden = |culling| {
        let mut options = Options::default();
        options.culling = culling;
        frame(&points, &view, &options).unwrap().counts().nodes_hidden
    };
    assert!(hidden(true) > 10, "{}", hidden(true));
    assert_eq!(hidden(false), 0);
}

/// In a cloud that is one leaf, the last point of the longest side was drawn at the other end.
#[test]
fn the_ends_of_a_small_cloud_are_where_they_are() {
    let (left, right) = (disc(-DVec3::X, Vec3::Z, 0.2), disc(DVec3::X, Vec3::Z, 0.2));
    let points = left.painted(|_| [1.0, 0.0, 0.0]).and(&right.painted(|_| [0.0, 1.0, 0.0]));
    let view =
        look_at(DVec3::Z * 2.0, DVec3::ZERO, Projection::Orthographic { height: 4.0 }, 40, 40).unwrap();
    let drawn = frame(&points, &view, &Options::default()).unwrap();
    let [red, green] = [drawn.color()[40 * 20 + 10], drawn.color()[40 * 20 + 30]];
    assert!(red[0] > 0.5 && red[1] == 0.0 && green[1] > 0.5 && green[0] == 0.0, "{red:?} and {green:?}");
}

/// What hidden nodes show through a translucent surface was added up after all else: a bit of the sum changed.
#[test]
fn hidden_nodes_are_added_up_in_their_order() {
    // A blurred wall before the left part of a slanted one, of which the left side is nearer: nodes that the first wall
    // hides wholly are nearer than those that it hides in part.
    let before = OwnedPoints::plane(dvec3(-0.3, 0.0, 2.0), DVec3::X * 0.02, DVec3::Y * 0.02, 20, 60);
    let slanted = OwnedPoints::plane(DVec3::ZERO, dvec3(0.01, 0.0, -0.01), DVec3::Y * 0.01, 150, 90);
    let points = before.and(&slanted).painted(|p| (p * 100.0).as_vec3().to_array().map(|c| c.sin().abs()));
    let view = look_at(DVec3::Z * 4.0, DVec3::ZERO, PERSPECTIVE, 90, 90).unwrap();
    let mut options = Options::default();
    options.focus = Focus::Depth { depth: 0.3, focus: 4.0 };
    culling_changes_nothing(&points, &view, &options).unwrap();
}

/// Points far beside the eye, at next to no depth, had ellipses all over the picture.
#[test]
fn ground_below_the_eye_is_seen_where_it_is() {
    let ground = OwnedPoints {
        normals: None,
        radii: None,
        ..OwnedPoints::plane(DVec3::ZERO, 0.5 * DVec3::X, 0.5 * DVec3::Y, 200, 200)
    };
    let (eye, target) = (dvec3(0.1, -0.2, 6.0), dvec3(20.1, 1.3, 0.0));
    let camera = Projection::Perspective { fov_y_rad: 0.9 };
    let view = View::look_at(eye, target, DVec3::Z, camera, 300, 200).unwrap();
    let drawn = frame(&ground, &view, &Options::default()).unwrap();
    let mut seen = 0;
    for (index, (depth, color)) in drawn.depth().iter().zip(drawn.color()).enumerate() {
        let pixel = dvec2((index % 300) as f64 + 0.5, (index / 300) as f64 + 0.5);
        let ray = view.ray(pixel);
        let way = ray.direction.z;
        let place = ray.origin - ray.direction * (ray.origin.z / way);
        let is_ahead = way < 0.0;
        if is_ahead && place.abs().max_element() < 45.0 {
            let truth = (place - eye).dot(view.forward());
            let off = (f64::from(*depth) / truth - 1.0).abs();
            assert!(off < 0.02 && color[3] > 0.95, "{pixel}: {depth}, not {truth}; {color:?}");
            seen += 1;
        } else if !is_ahead || place.abs().max_element() > 60.0 {
            assert_eq!(color[3], 0.0, "{pixel}: nothing is there");
        }
    }
    assert!(seen > 20_000, "{seen}");
}

/// The mean color of links so far away that their weights were subnormal had three digits.
#[test]
fn what_is_far_away_does_not_color_a_lone_point() {
    let sheet = OwnedPoints::plane(DVec3::Z * -0.324, DVec3::X * 0.01, DVec3::Y * 0.01, 9, 29);
    let points =
        OwnedPoints { normals: None, radii: None, ..OwnedPoints::loose(vec![DVec3::ZERO]).and(&sheet) };
    let camera = Projection::Perspective { fov_y_rad: 0.2 };
    let view = look_at(dvec3(-0.022, 0.0, 3.92), dvec3(-0.022, 0.0, 0.0), camera, 1, 1).unwrap();
    one_color_stays_one_color(&points, &view, &Options::default(), [0.0, 0.0, 23.0 / 64.0]).unwrap();
}
