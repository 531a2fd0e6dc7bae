//! Bugs that were fixed, each with its smallest input.

use glam::{DAffine3, DVec2, DVec3, dvec2, dvec3};
use pointillist_micropoint::invariants::{
    Soup, nothing_shows_through, picture, shares, shares_agree, shares_by_arrangement, weights_are_shares,
};
use pointillist_micropoint::{
    Geometry, MicropointError, MicropointOptions, PixelRect, PlainOpacity, Projection, Renderer,
    SurfaceOpacity, TexelCorner, TexelSums, TexelWrap, Tile, TileCounts, View, ViewError,
};

const EXACT: MicropointOptions = MicropointOptions::DEFAULT;

/// Two vertices that differed by rounding made an edge of random direction, which "separated" what overlapped: 1.25 % of the
/// background showed through.
#[test]
fn a_closed_mesh_does_not_leak_where_cuts_run_through_vertices() {
    let eye = dvec3(0.235_667_761_109_733_67, -0.462_447_325_431_796_2, -0.469_684_125_316_689_74);
    let target = dvec3(0.627_820_529_540_343_4, 0.193_023_312_154_387_84, 0.972_116_876_886_776_5);
    let centre = dvec3(0.736_827_627_991_410_1, 0.188_694_845_025_104_45, 0.346_195_896_770_401_5);
    for squash in 0..32 {
        for fov in 0..8 {
            let camera = Projection::Perspective { fov_y_rad: 0.3 + 0.2 * f64::from(fov) };
            let view = View::look_at(eye, target, DVec3::Y, camera, 2, 2).unwrap();
            let mut soup = Soup::default();
            let (solid, wall) = (soup.surface(1.0), soup.surface(1.0));
            soup.sphere(DVec3::ZERO, 0.6, 3, 7, solid);
            let mut soup = soup.moved(|p| p * dvec3(1.0, 0.3 + 0.02 * f64::from(squash), 1.0) + centre);
            let far = view.eye() + view.forward() * 50.0;
            let (x, y) = view.forward().any_orthonormal_pair();
            soup.polygon(
                &[(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
                    .map(|(a, b)| far + (x * a + y * b) * 1e4),
                wall,
            );
            for cull in [true, false] {
                nothing_shows_through(&soup, view, EXACT.with_cull_solids(cull), 1e-9).unwrap();
            }
        }
    }
}

/// A crop without pixels, and one outside the picture, panicked.
#[test]
fn a_rectangle_without_pixels_sees_nothing() {
    let corners = [dvec3(-9.0, -9.0, 0.0), dvec3(9.0, -9.0, 0.0), dvec3(0.0, 9.0, 0.0)];
    let geometry = Geometry::new(&corners, &[[0, 1, 2]], &[0], &[SurfaceOpacity::default()]).unwrap();
    let view = View::look_at(DVec3::Z, DVec3::ZERO, DVec3::Y, Projection::Orthographic { height: 4.0 }, 4, 4)
        .unwrap();
    let renderer = Renderer::new(&geometry, &PlainOpacity, view, EXACT).unwrap();
    let mut tile = Tile::default();
    for [x0, y0, x1, y1] in [[1, 0, 1, 4], [3, 3, 2, 2], [4, 0, 9, 4], [u32::MAX - 1, 0, u32::MAX, 1]] {
        renderer.render(PixelRect { x0, y0, x1, y1 }, &mut tile);
        assert!(tile.points().is_empty());
    }
}

/// What a picture of 16² pixels, each a unit wide, takes, seen along −z.
fn counts_from_above(soup: &Soup) -> TileCounts {
    let geometry = soup.geometry().unwrap();
    let camera = Projection::Orthographic { height: 16.0 };
    let view = View::look_at(DVec3::Z * 100.0, DVec3::ZERO, DVec3::Y, camera, 16, 16).unwrap();
    let renderer = Renderer::new(&geometry, &PlainOpacity, view, EXACT).unwrap();
    let mut tile = Tile::default();
    renderer.render(renderer.picture(), &mut tile);
    tile.counts()
}

/// A cell behind whose first parts a later one closed it was not looked at again, and the tile stayed open for good.
#[test]
fn a_quad_whose_diagonal_crosses_cells_closes_its_tile() {
    let mut soup = Soup::default();
    let surface = soup.surface(1.0);
    soup.polygon(
        &[dvec3(-99.0, -99.0, 0.0), dvec3(99.0, -99.0, 0.0), dvec3(99.0, 99.0, 0.0), dvec3(-99.0, 99.0, 0.0)],
        surface,
    );
    for i in 0..20 {
        soup.sphere(dvec3(f64::from(i % 5) - 2.0, f64::from(i / 5) - 2.0, -3.0), 0.5, 8, 12, surface);
    }
    let counts = counts_from_above(&soup);
    assert!(counts.clusters_skipped > 40, "{counts:?}");
}

/// Nobody asked what the counts say.
#[test]
fn cells_are_counted_by_how_they_were_resolved() {
    let mut soup = Soup::default();
    let surface = soup.surface(1.0);
    // Two triangles, whose common edge runs through the cells of the picture's diagonal; nothing beside and above them.
    soup.polygon(
        &[dvec3(-99.0, -99.0, 0.0), dvec3(4.0, -99.0, 0.0), dvec3(4.0, 4.0, 0.0), dvec3(-99.0, 4.0, 0.0)],
        surface,
    );
    let counts = counts_from_above(&soup);
    assert_eq!(
        [
            counts.cells_empty,
            counts.cells_single,
            counts.cells_tiled,
            counts.cells_apart,
            counts.cells_compared
        ],
        [16 * 16 - 12 * 12, 12 * 11, 12, 0, 0],
        "{counts:?}"
    );
    assert_eq!(counts.micropoints, 12 * 13);
}

/// Coincident surfaces were ordered by the rounding of their depths: which one was seen changed from cell to cell.
#[test]
fn of_coincident_surfaces_the_same_one_is_seen_everywhere() {
    let plane = |x: f64, y: f64| dvec3(x, y, 0.3 * x - 0.2 * y - 5.0);
    let mut soup = Soup::default();
    let (first, second) = (soup.surface(1.0), soup.surface(1.0));
    soup.polygon(&[plane(-3.0, -3.0), plane(3.0, -3.0), plane(3.0, 3.0), plane(-3.0, 3.0)], first);
    soup.polygon(&[plane(2.7, 0.1), plane(0.3, 2.9), plane(-2.8, 0.2), plane(-0.1, -2.6)], second);
    let view = View::look_at(
        DVec3::ZERO,
        DVec3::NEG_Z,
        DVec3::Y,
        Projection::Perspective { fov_y_rad: 0.5 },
        12,
        12,
    )
    .unwrap();
    let seen = shares(&picture(&soup, view, EXACT).unwrap(), 2);
    // The second covers the whole picture, and the first, of the lower number, is seen.
    let odd = seen.iter().filter(|p| p[1].abs() > 1e-9).count();
    assert_eq!(odd, 0, "of {} pixels", seen.len());
    shares_agree(&seen, &shares_by_arrangement(&soup, &view), 1e-9).unwrap();
}

/// Of two planes that differ by rounding, neither was found to be in front of the other: both were seen whole.
#[test]
fn planes_that_differ_by_rounding_hide_one_another_once() {
    for gap in [0.0, 1e-15, -1e-15, 1e-13] {
        let mut soup = Soup::default();
        for z in [-5.0, -5.0 - gap] {
            let surface = soup.surface(0.5);
            soup.polygon(
                &[dvec3(-9.0, -9.0, z), dvec3(9.0, -9.0, z), dvec3(9.0, 9.0, z), dvec3(-9.0, 9.0, z)],
                surface,
            );
        }
        for camera in [Projection::Perspective { fov_y_rad: 0.5 }, Projection::Orthographic { height: 3.0 }] {
            let view = View::look_at(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y, camera, 3, 3).unwrap();
            for pixel in shares(&picture(&soup, view, EXACT).unwrap(), 2) {
                assert!((pixel[0] + pixel[1] - 0.75).abs() < 1e-12, "gap {gap}: {pixel:?}");
            }
        }
    }
}

/// One vertex far away makes the rounding of a parallel view larger than a box: its sides coincide, and were all seen.
#[test]
fn a_vertex_at_1e21_leaves_weights_that_sum_to_one() {
    let mut soup = Soup::default();
    let surface = soup.surface(1.0);
    soup.cuboid(dvec3(0.0, 0.25, 0.0), dvec3(0.5, 0.75, 0.5), surface);
    soup.positions[0] = dvec3(1.722_388_132_608_684e21, 0.0, 0.0);
    let camera = Projection::Orthographic { height: 0.92 };
    let [eye, target] = [dvec3(7.0, 65.0, 68.0), dvec3(64.0, -8.0, -69.0)].map(|p| p / 64.0);
    let view = View::look_at(eye, target, DVec3::Y, camera, 5, 6).unwrap();
    weights_are_shares(&soup, view, EXACT).unwrap();
}

/// Faces that contain the eye became slivers when their corners were rounded: pixels summed up to 1.0001.
#[test]
fn an_eye_on_a_corner_of_a_cuboid_sees_no_more_than_everything() {
    let corner = DVec3::splat(-31.0 / 64.0);
    let mut soup = Soup::default();
    let surface = soup.surface(1.0);
    soup.cuboid(corner, corner + 0.5, surface);
    let camera = Projection::Perspective { fov_y_rad: 1.0 };
    let view = View::look_at(corner, dvec3(0.0, -4.0, -24.0) / 64.0, DVec3::Y, camera, 5, 4).unwrap();
    weights_are_shares(&soup, view, MicropointOptions::default()).unwrap();
}

/// Where a polygon is cut by depth, a corner may overflow to NaN; bounds forgot what came before it, and the edge to a corner
/// 10¹¹ texels away was followed row by row, for hours.
#[test]
fn a_texel_mean_ends_where_a_cut_overflows() {
    let white = TexelSums::<1>::new(1, 1, TexelWrap::Repeat, |_, _| [1.0]).unwrap();
    let corner =
        |grid: DVec2, rational: f64, row: f64| TexelCorner { grid, rational, texel: dvec2(0.0, row) };
    let corners =
        [corner(DVec2::ZERO, 1e300, 1e11), corner(DVec2::X, 1.0, 0.0), corner(DVec2::Y, 1e300, 0.0)];
    let [mean] = white.mean(&corners);
    assert!((mean - 1.0).abs() < 1e-6, "{mean}");
}

/// A sliver in front of two triangles hid less of each than was worth a cut, and was seen beside both: weights summed up to
/// 1 + 1.5e-11.
#[test]
fn a_sliver_hides_what_little_it_covers() {
    let mut soup = Soup::default();
    let (ground, sliver) = (soup.surface(1.0), soup.surface(1.0));
    soup.polygon(
        &[dvec3(-1.0, -1.0, 0.0), dvec3(1.0, -1.0, 0.0), dvec3(1.0, 1.0, 0.0), dvec3(-1.0, 1.0, 0.0)],
        ground,
    );
    soup.polygon(&[dvec3(-0.5, 0.0, 0.5), dvec3(0.5, 0.0, 0.5), dvec3(0.0, 3e-11, 0.5)], sliver);
    let camera = Projection::Orthographic { height: 1.0 };
    let view = View::look_at(DVec3::Z, DVec3::ZERO, DVec3::Y, camera, 1, 1).unwrap();
    weights_are_shares(&soup, view, EXACT).unwrap();
}

/// The slope of an edge that rises by 1e-308 texels overflowed, and its crossing with a row was looked for column by column up
/// to infinity.
#[test]
fn a_texel_mean_ends_where_an_edge_is_all_but_level() {
    let white = TexelSums::<1>::new(1, 1, TexelWrap::Repeat, |_, _| [1.0]).unwrap();
    let corners = [dvec2(2.0, 1e-308), dvec2(-2.0, -1e-308), dvec2(0.0, -2.0)].map(|p| TexelCorner {
        grid: p,
        rational: 1.0,
        texel: p,
    });
    let [mean] = white.mean(&corners);
    assert!((mean - 1.0).abs() < 1e-6, "{mean}");
}

/// A sliver that passes within 1e-9 of the eye was clipped into an outline that bent inward; what lay behind the bay was seen
/// through it, and so was the sliver.
#[test]
fn a_sliver_right_before_the_eye_is_convex() {
    let mut soup = Soup::default();
    let (sliver, ground) = (soup.surface(1.0), soup.surface(1.0));
    let (a, b) = (
        dvec3(-0.290_566_974_682_869_96, 0.0, 0.0),
        dvec3(0.25, -0.086_298_687_329_217_18, 0.441_316_198_832_317_54),
    );
    soup.polygon(
        &[a, b, dvec3(-0.020_283_484_341_434_982, -0.043_149_338_664_608_59, 0.220_658_106_416_158_77)],
        sliver,
    );
    soup.polygon(
        &[dvec3(0.972_291_401_619_133_1, 0.0, 0.0), DVec3::ZERO, dvec3(-63.033_496_725_250_37, 0.0, 25.0)],
        ground,
    );
    let target = dvec3(-0.016_389_750_169_609_54, 0.935_636_613_323_964_7, 0.858_913_399_902_431_3);
    let camera = Projection::Perspective { fov_y_rad: 1.361_124_739_913_106_8 };
    for eye in [a, a.midpoint(b)] {
        let view = View::look_at(eye, target, DVec3::Y, camera, 5, 4).unwrap();
        weights_are_shares(&soup, view, EXACT).unwrap();
    }
}

/// Few occluders before a triangle cut it into more than 24 regions, whereupon a translucent one dimmed the rest by its mean: the
/// back faces of a solid, all hidden, changed how the triangle was halved and with it a pixel by 1.6e-6.
#[test]
fn a_dozen_translucent_occluders_are_exact() {
    let mut soup = Soup::default();
    let loose = [
        (0.161_428_05, [(0.0, -0.989_741_6, 0.0), (0.0, 0.0, 0.0), (0.0, 0.722_059_9, -0.296_113_8)]),
        (1.0, [(0.0, 0.0, 0.0), (0.0, 0.0, 0.380_205_1), (0.0, 0.532_154, 0.265_476_9)]),
        (0.925_528_5, [(0.821_780_5, -0.25, -0.25), (-0.927_090_5, 0.0, 0.0), (-0.049_655, -0.12, -0.118)]),
        (1.0, [(0.75, 0.388_788_3, 0.0), (0.0, 0.0, -95.414_161_6), (-62.181_048_1, 0.0, 0.0)]),
        (0.895_516_16, [(0.0, 0.0, 0.485_539_3), (0.0, 0.292_456_8, -0.906_468_7), (0.0, -0.102_508_1, 0.0)]),
        (1.0, [(0.0, -0.340_394_3, -0.485_058_3), (0.0, 0.0, 0.0), (0.022_334_4, 0.0, 0.0)]),
    ];
    for (opacity, corners) in loose {
        let surface = soup.surface(opacity);
        soup.polygon(&corners.map(|(x, y, z)| dvec3(x, y, z)), surface);
    }
    let solid = soup.surface(1.0);
    soup.sphere(dvec3(0.765_329_273, 0.0, -0.607_764_001), 0.622_765_187, 3, 4, solid);
    let eye = dvec3(0.404_212_610_616_708_1, -0.853_428_809_456_505_7, 1.496_202_513_536_156_5);
    let forward = dvec3(-0.027_482_429_734_462_26, 0.124_883_676_468_234_45, -0.991_790_695_362_518_4);
    let camera = Projection::Perspective { fov_y_rad: 1.392_295_294_988_434_9 };
    let view = View::look_at(eye, eye + forward, DVec3::Y, camera, 9, 1).unwrap();
    let [culled, whole] = [true, false].map(|cull| {
        shares(&picture(&soup, view, EXACT.with_cull_solids(cull)).unwrap(), soup.surfaces.len())
    });
    shares_agree(&culled, &whole, 1e-11).unwrap();
}

/// Each of n coincident parts of a cell was compared with all others, and cut by them: 1000 triangles took half a minute for 256 pixels.
#[test]
fn a_thousand_copies_of_a_triangle_are_seen_as_one() {
    let corners = [dvec3(-1.0, -1.0, 0.0), dvec3(1.0, -1.0, 0.2), dvec3(0.0, 1.0, 0.1)];
    let view = |pixels| {
        View::look_at(
            dvec3(0.3, 1.0, 5.0),
            DVec3::ZERO,
            DVec3::Y,
            Projection::Perspective { fov_y_rad: 0.6 },
            pixels,
            pixels,
        )
        .unwrap()
    };
    // What shines through each copy, and all copies as one surface.
    for (opacity, copies) in [(1.0_f32, 1000), (0.01, 1000), (0.3, 40)] {
        let through = (1.0 - f64::from(opacity)).powi(copies);
        let mut many = Soup::default();
        let (sheet, ground) = (many.surface(opacity), many.surface(1.0));
        // A triangle before them and one behind cut the copies and are cut by them.
        many.polygon(&corners.map(|c| c * 0.4 + dvec3(0.3, 0.1, 1.0)), ground);
        many.polygon(&corners.map(|c| c * 2.0 - dvec3(0.3, 0.1, 1.0)), ground);
        let mut one = many.clone();
        (0..copies).for_each(|_| many.polygon(&corners, sheet));
        one.polygon(&corners, sheet);
        let (many, one) = (picture(&many, view(16), EXACT).unwrap(), picture(&one, view(16), EXACT).unwrap());
        for (pixel, (m, o)) in shares(&many, 2).iter().zip(&shares(&one, 2)).enumerate() {
            let seen = o[0] / f64::from(opacity) * (1.0 - through);
            assert!((m[0] - seen).abs() < 1e-9, "{opacity}, pixel {pixel}: {} for {seen}", m[0]);
        }
    }
}

/// Over a dozen translucent triangles and a box that all cross one another in one pixel: some dim the rest by their mean, and what was
/// seen of all of them made up 1.000013 of the pixel. Found by fuzzing.
#[test]
fn no_more_is_seen_of_crossing_sheets_than_there_is_room_for() {
    let sheets: [(u8, [[i8; 3]; 3]); 13] = [
        (255, [[-1, -1, 6], [0, 0, 0], [-1, -1, -1]]),
        (51, [[-1, -1, -1], [-1, 5, -1], [-1, -1, 51]]),
        (255, [[-34, -54, -54], [-54, -54, 0], [4, 0, 0]]),
        (255, [[-1, -1, -1], [3, 44, 0], [0, -1, -1]]),
        (51, [[-1, -1, -1], [-1, -1, 16], [10, 39, 45]]),
        (60, [[49, 1, 1], [0, 0, 7], [8, -73, -68]]),
        (196, [[2, 36, 36], [73, 73, -110], [-17, -110, 73]]),
        (41, [[0, 0, 0], [-60, 31, 0], [-1, 54, 41]]),
        (7, [[-1, 58, 18], [-1, 0, -1], [11, 0, 0]]),
        (255, [[-1, -1, -1], [3, 0, 8], [0, 0, -2]]),
        (68, [[-1, 1, 5], [-1, -1, 16], [0, -73, -68]]),
        (207, [[-17, 8, 22], [0, 0, 0], [-33, -49, -49]]),
        (11, [[33, -49, 57], [51, 10, -1], [-85, 0, -1]]),
    ];
    let steps = |[x, y, z]: [i8; 3]| dvec3(x.into(), y.into(), z.into()) / 64.0;
    let mut soup = Soup::default();
    for (opacity, corners) in sheets {
        let surface = soup.surface(f32::from(opacity) / 255.0);
        soup.polygon(&corners.map(steps), surface);
    }
    let (solid, low) = (soup.surface(1.0), steps([-1, -60, -1]));
    soup.cuboid(low, low + 0.5, solid);
    let camera = Projection::Orthographic { height: 2.6 };
    let view = View::look_at(steps([-1, 50, -1]), steps([7, 35, -1]), DVec3::Y, camera, 4, 7).unwrap();
    weights_are_shares(&soup, view, EXACT).unwrap();
}

/// A mirrored matrix was un-mirrored without a word, and drew the scene from another camera than the one asked for.
#[test]
fn a_mirrored_matrix_is_refused() {
    let camera = |matrix: DAffine3| -> Result<View, MicropointError> {
        Ok(View::from_matrix(matrix, Projection::Orthographic { height: 1.0 }, 4, 4)?)
    };
    assert!(camera(DAffine3::IDENTITY).is_ok());
    for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
        let refused = camera(DAffine3::from_scale(DVec3::ONE - 2.0 * axis));
        assert!(matches!(refused, Err(MicropointError::View(ViewError::Mirrored { .. }))), "{refused:?}");
    }
}

/// Tiles of the largest picture are drawn like those of any other; a larger one is refused.
#[test]
fn a_picture_too_large_to_be_numbered_is_refused() {
    let camera = |width: u32, height: u32| -> Result<View, MicropointError> {
        let projection = Projection::Perspective { fov_y_rad: 0.6 };
        Ok(View::look_at(DVec3::Z, DVec3::ZERO, DVec3::Y, projection, width, height)?)
    };
    let most = View::LARGEST_SIDE;
    for (width, height) in [(most + 1, 4), (4, most + 1), (u32::MAX, u32::MAX), (0, 4)] {
        let refused = Err(MicropointError::View(ViewError::BadSize { width, height }));
        assert_eq!(camera(width, height), refused);
    }
    let mut soup = Soup::default();
    let wall = soup.surface(1.0);
    soup.polygon(
        &[dvec3(-9.0, -9.0, 0.0), dvec3(9.0, -9.0, 0.0), dvec3(9.0, 9.0, 0.0), dvec3(-9.0, 9.0, 0.0)],
        wall,
    );
    let geometry = soup.geometry().unwrap();
    let renderer = Renderer::new(&geometry, &PlainOpacity, camera(most, most).unwrap(), EXACT).unwrap();
    let mut tile = Tile::default();
    renderer.render(PixelRect { x0: most - 4, y0: most - 4, x1: u32::MAX, y1: u32::MAX }, &mut tile);
    let weight: f64 = tile.points().iter().map(|p| p.weight).sum();
    assert!((weight - 16.0).abs() < 1e-9, "{weight}");
}
