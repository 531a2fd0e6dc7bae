//! Pictures of a range of depths.

use glam::{DVec3, dvec3};
use pointillist_micropoint::{
    DepthRange, Geometry, MicropointError, MicropointOptions, PlainOpacity, Projection, Renderer,
    SurfaceOpacity, Tile, View,
};
use proptest::prelude::*;

const SIDE: u32 = 12;

fn view(perspective: bool) -> View {
    let projection = if perspective {
        Projection::Perspective { fov_y_rad: 1.3 }
    } else {
        Projection::Orthographic { height: 4.0 }
    };
    View::look_at(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y, projection, SIDE, SIDE).unwrap()
}

/// Share of each pixel that the triangles cover, and the depths of what covers it.
fn coverage(
    geometry: &Geometry,
    perspective: bool,
    depths: DepthRange,
) -> Result<(Vec<f64>, Vec<f64>), MicropointError> {
    let options = MicropointOptions::DEFAULT.with_depths(depths);
    let renderer = Renderer::new(geometry, &PlainOpacity, view(perspective), options)?;
    let mut tile = Tile::default();
    renderer.render(renderer.picture(), &mut tile);
    let (mut shares, mut found) = (vec![0.0; (SIDE * SIDE) as usize], vec![]);
    for m in tile.points() {
        shares[(m.y * SIDE + m.x) as usize] += m.weight;
        let face = &tile.faces()[m.face as usize];
        let at = face.point(tile.lens(), m.grid);
        found.push(-tile.position(m.grid, at.nearness).z);
    }
    Ok((shares, found))
}

fn triangle(corners: [DVec3; 3]) -> Geometry {
    Geometry::new(&corners, &[[0, 1, 2]], &[0], &[SurfaceOpacity::default()]).unwrap()
}

fn corner() -> impl Strategy<Value = DVec3> {
    (-6.0..6.0, -6.0..6.0, -9.0..2.0).prop_map(|(x, y, z)| dvec3(x, y, z))
}

proptest! {
    #![proptest_config(testkit::config(256))]

    #[test]
    fn slabs_of_a_triangle_cover_what_all_of_it_covers(
        corners in [corner(), corner(), corner()],
        cuts in [0.1..8.0_f64, 0.1..8.0],
        perspective: bool,
    ) {
        let [a, b] = [cuts[0].min(cuts[1]), cuts[0].max(cuts[1]) + 0.01];
        let geometry = triangle(corners);
        let (whole, _) = coverage(&geometry, perspective, DepthRange::ALL).unwrap();
        let mut sums = vec![0.0; whole.len()];
        for (near, far) in [(0.0, a), (a, b), (b, f64::INFINITY)] {
            let (shares, depths) = coverage(&geometry, perspective, DepthRange { near, far }).unwrap();
            sums.iter_mut().zip(shares).for_each(|(sum, share)| *sum += share);
            for depth in depths {
                prop_assert!(depth > near - 1e-6 && depth < far + 1e-6, "{depth} in {near} to {far}");
            }
        }
        for (sum, whole) in sums.iter().zip(&whole) {
            prop_assert!((sum - whole).abs() < 1e-6, "{sum} {whole}");
        }
    }
}

#[test]
fn what_is_before_the_range_hides_nothing() {
    let wall = |z: f64| [dvec3(-50.0, -50.0, z), dvec3(50.0, -50.0, z), dvec3(0.0, 90.0, z)];
    let corners = [wall(-1.0), wall(-3.0)].concat();
    let surface = [SurfaceOpacity::default()];
    let geometry = Geometry::new(&corners, &[[0, 1, 2], [3, 4, 5]], &[0, 0], &surface).unwrap();
    for perspective in [true, false] {
        for (near, far, wanted) in
            [(0.0, 9.0, Some(1.0)), (2.0, 9.0, Some(3.0)), (3.5, 9.0, None), (0.0, 0.5, None)]
        {
            let (shares, depths) = coverage(&geometry, perspective, DepthRange { near, far }).unwrap();
            let full = if wanted.is_some() { 1.0 } else { 0.0 };
            assert!(shares.iter().all(|s| (s - full).abs() < 1e-9), "{near} {far}");
            assert!(depths.iter().all(|d| Some((d * 1e6).round() / 1e6) == wanted), "{near} {far}");
        }
    }
}

#[test]
fn what_is_no_range_is_refused() {
    let geometry = triangle([DVec3::ZERO, DVec3::X, DVec3::Y]);
    for (near, far) in [(1.0, 1.0), (2.0, 1.0), (-1.0, 1.0), (f64::NAN, 1.0), (0.0, f64::NAN)] {
        let refused = coverage(&geometry, true, DepthRange { near, far });
        assert!(matches!(refused, Err(MicropointError::BadDepths { .. })), "{near} {far}");
    }
}
