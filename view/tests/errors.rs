//! What is refused, one error at a time, at the very edge of what is accepted.

use glam::{DAffine3, DVec3, dvec3};
use pointillist_view::{PixelRect, Projection, View, ViewError};
use std::f64::consts::PI;

const CAMERA: Projection = Projection::Perspective { fov_y_rad: 0.7 };

fn look(eye: DVec3, target: DVec3, up: DVec3) -> Result<View, ViewError> {
    View::look_at(eye, target, up, CAMERA, 8, 8)
}

fn with(projection: Projection) -> Result<View, ViewError> {
    View::look_at(DVec3::Z, DVec3::ZERO, DVec3::Y, projection, 8, 8)
}

#[test]
fn eye_and_target_must_be_in_range_and_apart() {
    let largest = View::LARGEST_COORDINATE;
    for bad in [f64::NAN, f64::INFINITY, -1.001 * largest, f64::MAX] {
        let point = dvec3(0.0, bad, 1.0);
        assert!(matches!(look(point, DVec3::ZERO, DVec3::Y), Err(ViewError::BadEye { .. })), "{bad}");
        assert!(matches!(look(DVec3::ZERO, point, DVec3::Y), Err(ViewError::BadTarget { .. })), "{bad}");
    }
    let eye = dvec3(3.0, 1.0, 2.0);
    assert_eq!(look(eye, eye, DVec3::Y), Err(ViewError::EyeIsTarget { eye }));
    assert_eq!(look(DVec3::X * largest, DVec3::X * -largest, DVec3::Y).unwrap().forward(), DVec3::NEG_X);
    let least = f64::from_bits(1);
    assert_eq!(look(DVec3::X * least, DVec3::ZERO, DVec3::Y).unwrap().forward(), DVec3::NEG_X);
}

#[test]
fn up_must_point_somewhere_else() {
    let forward = DVec3::NEG_Z;
    for up in [DVec3::ZERO, DVec3::Z, DVec3::NEG_Z * 1e-320, DVec3::Z * 1e300, dvec3(1e-15, 0.0, -1.0)] {
        assert_eq!(look(DVec3::Z, DVec3::ZERO, up), Err(ViewError::BadUp { up, forward }), "{up}");
    }
    for up in [DVec3::NAN, DVec3::INFINITY] {
        assert!(matches!(look(DVec3::Z, DVec3::ZERO, up), Err(ViewError::BadUp { .. })));
    }
    // A diagonal whose cross product with itself is not zero but rounding.
    let askew = dvec3(0.1, 0.2, 0.3);
    assert!(matches!(look(DVec3::ZERO, askew, askew * 1.7), Err(ViewError::BadUp { .. })));
    assert!(look(DVec3::Z, DVec3::ZERO, dvec3(1e-13, 0.0, -1.0)).is_ok());
}

#[test]
fn a_projection_must_be_in_its_range() {
    for fov_y_rad in [0.0, -1.0, PI, 4.0, 1e-301, f64::NAN, f64::INFINITY] {
        let error = with(Projection::Perspective { fov_y_rad }).unwrap_err();
        assert!(matches!(error, ViewError::BadFieldOfView { .. }), "{fov_y_rad}: {error}");
    }
    for height in [0.0, -1.0, 1e-301, 1.1e300, f64::NAN, f64::INFINITY] {
        let error = with(Projection::Orthographic { height }).unwrap_err();
        assert!(matches!(error, ViewError::BadHeight { .. }), "{height}: {error}");
    }
    let largest = View::LARGEST_SIDE;
    let edges = [1e-300, PI.next_down()].map(|fov_y_rad| Projection::Perspective { fov_y_rad });
    let parallel = [1e-300, 1e300].map(|height| Projection::Orthographic { height });
    for projection in edges.into_iter().chain(parallel) {
        for (width, height) in [(1, 1), (largest, largest)] {
            let view = with(projection).unwrap().with_size(width, height).unwrap();
            assert!(view.focal_px().is_normal(), "{view:?}");
        }
    }
}

#[test]
fn a_picture_must_have_pixels_and_not_too_many() {
    let largest = View::LARGEST_SIDE;
    let view = with(CAMERA).unwrap();
    for (width, height) in [(0, 8), (8, 0), (largest + 1, 8), (8, u32::MAX)] {
        let refused = Err(ViewError::BadSize { width, height });
        assert_eq!(view.with_size(width, height), refused);
        assert_eq!(View::look_at(DVec3::Z, DVec3::ZERO, DVec3::Y, CAMERA, width, height), refused);
        assert_eq!(View::from_matrix(DAffine3::IDENTITY, CAMERA, width, height), refused);
    }
    let large = view.with_size(largest, 3).unwrap();
    assert_eq!((large.width(), large.height()), (largest, 3));
    assert_eq!(large.picture(), PixelRect { x0: 0, y0: 0, x1: largest, y1: 3 });
    assert_eq!(large.picture().to_string(), "0,0,1048576,3");
    assert_eq!((large.eye(), large.projection()), (view.eye(), view.projection()));
}

#[test]
fn a_matrix_must_be_a_rotation_and_a_shift() {
    let from = |m: DAffine3| View::from_matrix(m, CAMERA, 8, 8);
    assert!(from(DAffine3::IDENTITY).is_ok());
    assert_eq!(
        from(DAffine3::from_scale(DVec3::splat(-1.0))),
        Err(ViewError::Mirrored { determinant: -1.0 })
    );
    assert_eq!(from(DAffine3::from_scale(DVec3::splat(2.0))), Err(ViewError::NotRigid { deviation: 3.0 }));
    assert_eq!(from(DAffine3::ZERO), Err(ViewError::NotRigid { deviation: 1.0 }));
    for deviation in [0.9e-6_f64, -0.9e-6, 1.1e-6, -1.1e-6] {
        let scaled = DAffine3::from_scale(dvec3(1.0, (1.0 + deviation).sqrt(), 1.0));
        assert_eq!(from(scaled).is_ok(), deviation.abs() < 1e-6, "{deviation}");
    }
    let Err(ViewError::NotRigid { deviation }) = from(DAffine3::from_scale(DVec3::splat(1e200))) else {
        panic!("a matrix whose products overflow is no camera");
    };
    assert!(deviation.is_nan());
    let far = DAffine3::from_translation(DVec3::X * 1.5e300);
    assert_eq!(from(far), Err(ViewError::BadEye { eye: DVec3::X * -1.5e300 }));
    assert!(matches!(from(DAffine3::from_translation(DVec3::NAN)), Err(ViewError::BadEye { .. })));
}

#[test]
fn messages_name_the_value() {
    let message = |result: Result<View, ViewError>| result.unwrap_err().to_string();
    assert!(message(with(Projection::Perspective { fov_y_rad: 4.5 })).contains("4.5"));
    assert!(message(with(Projection::Orthographic { height: -2.5 })).contains("-2.5"));
    assert!(message(with(CAMERA).unwrap().with_size(7, 0)).contains("7×0"));
    assert!(message(look(DVec3::Z, DVec3::ZERO, DVec3::Z * 3.0)).contains("[0, 0, 3]"));
}
