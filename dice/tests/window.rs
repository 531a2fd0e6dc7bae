//! A window of the grid has what the endless grid has there.

use glam::{DVec2, IVec2, dvec2};
use pointillist_dice::{
    Accumulator, CellWindow, FillRule, Grid, MAX_COORDINATE, accumulate, accumulate_filled, split,
};
use proptest::prelude::*;

type Cells = Vec<(IVec2, f64)>;

fn within(window: CellWindow, cells: &Cells) -> Cells {
    let inside = |c: IVec2| (window.x0..window.x1).contains(&c.x) && (window.y0..window.y1).contains(&c.y);
    cells.iter().copied().filter(|&(cell, _)| inside(cell)).collect()
}

fn areas(rings: &[&[DVec2]], grid: &Grid) -> Cells {
    let mut cells = vec![];
    accumulate_filled(rings, FillRule::EvenOdd, grid, &mut Accumulator::new(), |run| {
        cells.extend(run.cells(grid).map(|(cell, centroid)| {
            let corner = grid.corner(cell);
            assert!(centroid.cmpge(corner).all() && centroid.cmple(corner + grid.cell()).all(), "{run:?}");
            (cell, run.area)
        }));
    })
    .expect("the rings are small");
    cells
}

fn pieces(polygon: &[DVec2], grid: &Grid) -> Vec<(IVec2, f64, Vec<DVec2>)> {
    let mut pieces = vec![];
    split(polygon, grid, |p| pieces.push((p.cell, p.area, p.vertices.to_vec())))
        .expect("triangles are convex");
    pieces
}

fn place() -> impl Strategy<Value = DVec2> {
    let coordinate = || prop_oneof![(-12i32..12).prop_map(f64::from), -12.0..12.0];
    (coordinate(), coordinate()).prop_map(|(x, y)| dvec2(x, y))
}

fn window() -> impl Strategy<Value = CellWindow> {
    (-8i32..8, -8i32..8, 0i32..9, 0i32..9).prop_map(|(x0, y0, nx, ny)| CellWindow {
        x0,
        y0,
        x1: x0 + nx,
        y1: y0 + ny,
    })
}

proptest! {
    #![proptest_config(testkit::config(256))]

    #[test]
    fn areas_in_a_window_are_those_of_the_whole(
        ring in prop::collection::vec(place(), 3..9), hole in prop::collection::vec(place(), 3..5), window in window(),
    ) {
        let limited = Grid::UNIT.with_window(window);
        for rings in [&[&ring[..]][..], &[&ring[..], &hole[..]]] {
            prop_assert_eq!(areas(rings, &limited), within(window, &areas(rings, &Grid::UNIT)));
        }
    }

    #[test]
    fn pieces_in_a_window_are_those_of_the_whole(triangle in prop::array::uniform3(place()), window in window()) {
        let limited = pieces(&triangle, &Grid::UNIT.with_window(window));
        let mut whole = pieces(&triangle, &Grid::UNIT);
        whole.retain(|p| !within(window, &vec![(p.0, p.1)]).is_empty());
        prop_assert_eq!(limited, whole);
    }
}

/// The largest polygon that there can be, far more cells than are visited at all, costs what its window costs.
#[test]
fn a_polygon_of_any_size_is_cut_in_a_window() {
    let [a, b] = [-MAX_COORDINATE, MAX_COORDINATE];
    let diamond = [dvec2(a, 0.25), dvec2(0.0, a), dvec2(b, 0.25), dvec2(0.0, b)];
    let grid = Grid::UNIT.with_window(CellWindow { x0: -5, y0: -5, x1: 5, y1: 5 });
    assert_eq!(areas(&[&diamond], &grid).iter().map(|c| c.1).sum::<f64>(), 100.0);
    assert_eq!(pieces(&diamond, &grid).iter().map(|p| p.1).sum::<f64>(), 100.0);
    let corner = Grid::UNIT.with_window(CellWindow { x0: -2, y0: a as i32, x1: 2, y1: a as i32 + 2 });
    let areas = areas(&[&diamond], &corner);
    let pieces = pieces(&diamond, &corner).iter().map(|p| p.1).sum::<f64>();
    assert!(
        (areas.iter().map(|c| c.1).sum::<f64>() - 4.0).abs() < 1e-8 && (pieces - 4.0).abs() < 1e-8,
        "{areas:?}"
    );
}

#[test]
fn an_empty_window_has_nothing() {
    let square = [dvec2(0.0, 0.0), dvec2(3.0, 0.0), dvec2(3.0, 3.0), dvec2(0.0, 3.0)];
    let grid = Grid::UNIT.with_window(CellWindow { x0: 1, y0: 1, x1: 1, y1: 3 });
    accumulate(&square, &grid, &mut Accumulator::new(), |run| panic!("{run:?}")).unwrap();
    split(&square, &grid, |piece| panic!("{piece:?}")).unwrap();
}
