//! Errors, one by one, and bugs that were fixed, each with the smallest input that showed it.

use glam::{DAffine3, DVec3, Vec3, dvec3};
use pointillist_ibpr::invariants::{OwnedScan, frame, frame_is_sound, frames_are_identical};
use pointillist_ibpr::{
    Cloud, Culling, EyeDome, Frame, IbprError, Light, Options, Passes, Projection, Renderer, Scale, Scan,
    Translucency, View, ViewError,
};

const PERSPECTIVE: Projection = Projection::Perspective { fov_y_rad: 0.7 };

fn refused(scans: &[Scan<'_>]) -> IbprError {
    Cloud::new(scans, Vec3::ONE).expect_err("the scans are bad")
}

fn view(projection: Projection) -> View {
    View::look_at(DVec3::Z * 5.0, DVec3::ZERO, DVec3::Y, projection, 32, 32).unwrap()
}

#[test]
fn scans_without_points_are_refused() {
    assert_eq!(refused(&[]), IbprError::NoPoints);
    assert_eq!(refused(&[Scan::new(&[]), Scan::new(&[])]), IbprError::NoPoints);
}

#[test]
fn a_point_that_is_not_finite_is_named() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let points = [DVec3::ZERO, dvec3(1.0, bad, 2.0)];
        match refused(&[Scan::new(&points[..1]), Scan::new(&points)]) {
            IbprError::PointNotFinite { scan: 1, index: 1, value } => {
                assert_eq!(value.map(f64::to_bits), [1.0, bad, 2.0].map(f64::to_bits));
            }
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn colors_are_checked() {
    let points = [DVec3::ZERO, DVec3::ONE];
    let one = [[0.5; 3]];
    let error = refused(&[Scan::new(&points).with_colors(&one)]);
    assert_eq!(error, IbprError::LengthMismatch { scan: 0, colors: 1, points: 2 });
    for bad in [f32::NAN, f32::INFINITY, -0.1] {
        let colors = [[0.5; 3], [0.1, bad, 0.2]];
        let error = refused(&[Scan::new(&points).with_colors(&colors)]);
        assert!(matches!(error, IbprError::BadColor { scan: 0, index: 1, .. }), "{error:?}");
    }
}

#[test]
fn spacings_and_directions_are_checked() {
    let points = [DVec3::ZERO];
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = refused(&[Scan::new(&points).with_spacing(bad)]);
        assert!(matches!(error, IbprError::BadSpacing { scan: 0, .. }), "{error:?}");
    }
    for bad in [DVec3::ZERO, DVec3::NAN, DVec3::INFINITY] {
        let error = refused(&[Scan::new(&points), Scan::new(&points).with_scanner(bad)]);
        assert!(matches!(error, IbprError::BadDirection { scan: 1, .. }), "{error:?}");
    }
}

/// The first scan was named, whichever point was too far away.
#[test]
fn a_point_that_is_too_far_away_is_named() {
    let (near, far) = ([DVec3::ONE], [DVec3::ZERO, dvec3(0.0, -1e308, 0.0)]);
    let error = refused(&[Scan::new(&near), Scan::new(&far)]);
    assert_eq!(error, IbprError::PointTooFar { scan: 1, index: 1, value: far[1].to_array() });
    let apart = [DVec3::splat(-Scan::FARTHEST), DVec3::splat(Scan::FARTHEST)];
    assert!(Cloud::new(&[Scan::new(&apart)], Vec3::ONE).is_ok());
}

/// Directions whose squared length is no number were refused as zero.
#[test]
fn directions_of_any_length_are_taken() {
    let points = [DVec3::ZERO, DVec3::X, DVec3::Y];
    for length in [5e-324, 1e-200, 1e-5, 1e200, f64::MAX] {
        let scan = Scan::new(&points).with_scanner(dvec3(0.0, 0.0, length));
        assert!(Cloud::new(&[scan], Vec3::ONE).is_ok(), "{length:e}");
    }
}

/// A mirrored matrix was un-mirrored without a word, and drew the scene from another camera than the one asked for.
#[test]
fn a_mirrored_matrix_is_refused() {
    let camera = |matrix: DAffine3| View::from_matrix(matrix, PERSPECTIVE, 8, 8);
    assert!(camera(DAffine3::IDENTITY).is_ok());
    for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
        let refused = camera(DAffine3::from_scale(DVec3::ONE - 2.0 * axis));
        assert!(matches!(refused, Err(ViewError::Mirrored { .. })), "{refused:?}");
    }
}

#[test]
fn a_picture_too_large_to_be_kept_is_refused() {
    let cloud = Cloud::new(&[Scan::new(&[DVec3::ZERO])], Vec3::ONE).unwrap();
    let (most, mut frame) = (Renderer::LARGEST_SIDE, Frame::default());
    for (width, height, fits) in
        [(most, 1, true), (1, most, true), (most + 1, 1, false), (1, most + 1, false)]
    {
        let view = view(PERSPECTIVE).with_size(width, height).unwrap();
        let drawn = Renderer::new().draw(&cloud, &view, &Options::default(), &mut frame);
        let expected = if fits { Ok(()) } else { Err(IbprError::TooLarge { width, height }) };
        assert_eq!(drawn, expected);
    }
    let beyond = view(PERSPECTIVE).with_size(8, u32::MAX);
    assert_eq!(beyond, Err(ViewError::BadSize { width: 8, height: u32::MAX }));
}

#[test]
fn options_are_checked_by_name() {
    type Change = fn(&mut Options);
    let changes: [(&str, Change); 17] = [
        ("scale factor", |o| o.scale = Scale::Auto(0.0)),
        ("scale factor", |o| o.scale = Scale::Spaced { factor: -1.0, spacing_px: 2.0 }),
        ("spacing in pixels", |o| o.scale = Scale::Spaced { factor: 2.0, spacing_px: f32::NAN }),
        ("scale", |o| o.scale = Scale::Fixed(0.99)),
        ("scale", |o| o.scale = Scale::Fixed(f32::NAN)),
        ("gamma", |o| o.gamma = -1.0),
        ("outline", |o| o.outline = 1.5),
        ("fill", |o| o.fill = Options::MOST_FILL + 1),
        ("ambient", |o| o.ambient = f32::NAN),
        ("finer", |o| o.passes = Passes::Two { finer: 0.0 }),
        ("alpha", |o| o.translucency = Some(Translucency::new(1.1))),
        ("layers", |o| o.translucency = Some(Translucency::new(0.5).with_layers(9))),
        ("threshold", |o| o.translucency = Some(Translucency::new(0.5).with_threshold(0.0))),
        ("strength", |o| o.eye_dome = Some(EyeDome::new(-1.0, 1))),
        ("radius", |o| o.eye_dome = Some(EyeDome::new(1.0, 65))),
        ("base", |o| o.base = Vec3::NAN),
        ("light", |o| o.light = Light::Towards(DVec3::ZERO)),
    ];
    let cloud = Cloud::new(&[Scan::new(&[DVec3::ZERO])], Vec3::ONE).unwrap();
    for (wanted, change) in changes {
        let mut options = Options::default();
        change(&mut options);
        let result = Renderer::new().draw(&cloud, &view(PERSPECTIVE), &options, &mut Frame::default());
        assert!(
            matches!(result, Err(IbprError::BadOption { name, .. }) if name == wanted),
            "{wanted}: {result:?}"
        );
    }
}

#[test]
fn a_cloud_behind_the_eye_gives_an_empty_frame() {
    let behind = OwnedScan::plane(DVec3::Z * 9.0, DVec3::X * 0.1, DVec3::Y * 0.1, 20, 20);
    let mut options = Options::default();
    options.surface_layers = true;
    for projection in [PERSPECTIVE, Projection::Orthographic { height: 4.0 }] {
        let frame = frame(std::slice::from_ref(&behind), &view(projection), &options).unwrap();
        frame_is_sound(&frame).unwrap();
        assert!(
            frame.depth().iter().all(|d| *d == f32::INFINITY) && frame.color().iter().all(|c| *c == [0.0; 4])
        );
        assert_eq!(frame.counts().points, 0);
    }
}

/// The automatic scale was that of the blocks left over by culling, and so culling changed the picture.
#[test]
fn the_automatic_scale_does_not_depend_on_culling() {
    let scans = [DVec3::Z, -DVec3::Z].map(|d| OwnedScan::sphere(DVec3::ZERO, 1.0, 0.02, d));
    let scale = |culling| {
        let mut options = Options::default();
        (options.culling, options.scale) = (culling, Scale::Auto(4.0));
        let frame = frame(&scans, &view(PERSPECTIVE), &options).unwrap();
        assert!(culling == Culling::None || frame.counts().points_skipped > 0, "{:?}", frame.counts());
        frame.counts().scale
    };
    assert_eq!(scale(Culling::None), scale(Culling::Blocks));
}

/// A block without a cone went by its scan, whose steepest points touch the rim from behind at 165°.
#[test]
fn blocks_without_a_cone_are_kept() {
    // One row of points spans no plane, and so has no cone.
    let row = OwnedScan::plane(DVec3::ZERO, DVec3::X * 0.1, DVec3::ZERO, 30, 1);
    let row = OwnedScan { towards_scanner: Some(-DVec3::Z), ..row };
    let drawn = frame(&[row], &view(PERSPECTIVE), &Options::default()).unwrap();
    assert_eq!(drawn.counts().points, 30);
}

/// Squares of distances near 1e300 made the spacing of all scans infinite.
#[test]
fn spacings_of_huge_clouds_are_finite() {
    let points = [DVec3::ZERO, DVec3::ZERO, DVec3::Z * 1e300];
    let cloud = Cloud::new(&[Scan::new(&points)], Vec3::ONE).unwrap();
    assert!(cloud.density_spacing().is_finite(), "{}", cloud.density_spacing());
}

/// The outline of a surface that cuts the eye's plane reached behind it.
#[test]
fn no_depth_is_behind_the_eye() {
    let steep = OwnedScan::plane(DVec3::Z * 4.8, dvec3(0.2, 0.0, 0.19), DVec3::Y * 0.2, 3, 9);
    let mut options = Options::default();
    (options.scale, options.outline) = (Scale::Fixed(3.0), 1.0);
    let frame = frame(&[steep], &view(Projection::Orthographic { height: 2.0 }), &options).unwrap();
    frame_is_sound(&frame).unwrap();
    let touches = |d: &f32| *d < 0.02;
    assert!(frame.depth().iter().any(touches), "the surface comes near the eye");
}

/// A strength near f32's largest number overflowed before it was multiplied by a step of 0.
#[test]
fn eye_dome_lighting_of_any_strength_gives_numbers() {
    let plane = OwnedScan::plane(DVec3::ZERO, DVec3::X * 0.1, DVec3::Y * 0.1, 20, 20);
    for strength in [0.0, 1.0, 1e38] {
        let mut options = Options::default();
        options.eye_dome = Some(EyeDome::new(strength, 1));
        let drawn = frame(std::slice::from_ref(&plane), &view(PERSPECTIVE), &options).unwrap();
        frame_is_sound(&drawn).unwrap();
        assert!(drawn.color()[16 * 32 + 16][0] > 0.5, "a flat surface stays bright");
    }
}

/// The square of a tiny distance from eye to target has few digits, and so the view had no unit axes.
#[test]
fn views_of_tiny_and_huge_scenes_have_unit_axes() {
    for k in [1e-300, 1e-160, 1.0, 1e160, 1e300] {
        let view = View::look_at(DVec3::Z * k, dvec3(0.3 * k, 0.2 * k, 0.0), DVec3::Y * k, PERSPECTIVE, 8, 8)
            .unwrap();
        assert!((view.forward().length() - 1.0).abs() < 1e-12, "{k}: {view:?}");
    }
}

/// Sums of a finite base of 1e38 were infinite, and so were the pixels.
#[test]
fn colors_are_refused_above_what_can_be_summed_up_and_drawn_below() {
    let points: Vec<DVec3> = (0..400)
        .map(|i| dvec3(f64::from(i % 20), f64::from(i / 20), 0.0) * 0.1 - dvec3(1.0, 1.0, 0.0))
        .collect();
    let draw = |base: f32, colors: Option<&[[f32; 3]]>| {
        let mut scan = Scan::new(&points).with_spacing(0.1);
        if let Some(colors) = colors {
            scan = scan.with_colors(colors);
        }
        let cloud = Cloud::new(&[scan], Vec3::ONE)?;
        let mut options = Options::default();
        options.base = Vec3::splat(base);
        let mut frame = Frame::default();
        Renderer::new().draw(&cloud, &view(PERSPECTIVE), &options, &mut frame).map(|_| frame)
    };
    for bad in [1e38, f32::INFINITY, f32::NAN] {
        assert!(matches!(draw(bad, None), Err(IbprError::BadOption { name: "base", .. })));
        let colors = vec![[0.1, bad, 0.1]; points.len()];
        assert!(matches!(draw(0.5, Some(&colors)), Err(IbprError::BadColor { scan: 0, index: 0, .. })));
    }
    let bright = vec![[Scan::BRIGHTEST; 3]; points.len()];
    for frame in [draw(Scan::BRIGHTEST, None).unwrap(), draw(0.5, Some(&bright)).unwrap()] {
        assert!(frame.color().iter().flatten().all(|v| v.is_finite() && *v >= 0.0));
        assert!(frame.color().iter().any(|c| c[0] > 1e27), "nothing was drawn");
    }
}

/// The color of points without one was taken as it came, and NaN reached the picture.
#[test]
fn a_base_that_is_no_color_is_refused() {
    let point = [DVec3::ZERO];
    for bad in [f32::NAN, -0.1, f32::INFINITY] {
        let refused = Cloud::new(&[Scan::new(&point)], Vec3::new(0.5, bad, 0.5)).unwrap_err();
        assert!(matches!(refused, IbprError::BadOption { name: "base", .. }), "{bad}: {refused}");
    }
}

/// A direction whose squared length overflows lit nothing, and one whose squared length underflows was refused as zero.
#[test]
fn light_comes_from_directions_of_any_length() {
    let scan = OwnedScan::plane(DVec3::ZERO, DVec3::X * 0.1, DVec3::Y * 0.1, 20, 20);
    let view = View::look_at(DVec3::Z * 3.0, DVec3::ZERO, DVec3::Y, PERSPECTIVE, 16, 16).unwrap();
    let lit = |length: f64| {
        let options = Options::DEFAULT.with_light(Light::Towards(DVec3::Z * length));
        frame(std::slice::from_ref(&scan), &view, &options).unwrap()
    };
    for length in [1e-200, 1e200] {
        frames_are_identical(&lit(length), &lit(1.0)).unwrap();
    }
}

/// Corners of buffer pixels that are far larger than the picture were out of the range of the rasteriser's integers, and their differences wrapped.
#[test]
fn buffer_pixels_may_be_far_larger_than_the_picture() {
    let scan = [OwnedScan::plane(DVec3::ZERO, DVec3::X, DVec3::Z, 3, 3)];
    let camera = Projection::Orthographic { height: 2.0 };
    let view = View::look_at(DVec3::Y * 1.8, dvec3(-0.4, 0.0, -0.4), DVec3::Y, camera, 24, 17).unwrap();
    for size in [1e4, 1e6, 4.4e7, 1e12] {
        let options = Options::DEFAULT.with_scale(Scale::Fixed(size)).with_outline(0.8);
        let translucent = options.with_translucency(Some(Translucency::new(0.5)));
        for options in [options, translucent] {
            frame_is_sound(&frame(&scan, &view, &options).unwrap()).unwrap();
        }
    }
}
