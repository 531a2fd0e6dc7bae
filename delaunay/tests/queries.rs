//! What is asked of cells, edges, facets and vertices: the facts of `invariants::queries`, and closed forms.

use glam::{DVec3, dvec3};
use pointillist_delaunay::invariants::queries as facts;
use pointillist_delaunay::{
    Delaunay, DelaunayError, NearestVertex, OUTSIDE, Partition, Tetrahedra, Triangles, circumcentre,
};
use proptest::prelude::*;
use testkit::points::{lattice_points, points, query};

fn hold(fact: Result<(), String>) -> Result<(), TestCaseError> {
    fact.map_err(TestCaseError::fail)
}

proptest! {
    #![proptest_config(testkit::config(64))]

    #[test]
    fn neighbours_are_mutual(points in points(40)) {
        hold(facts::neighbours_are_mutual(&points))?;
    }

    #[test]
    fn edges_are_those_of_the_cells(points in points(40)) {
        hold(facts::edges_are_those_of_cells(&points))?;
    }

    #[test]
    fn no_point_lies_beyond_a_facet_of_the_hull(points in points(30)) {
        hold(facts::hull_facets_have_all_points_on_one_side(&points))?;
    }

    #[test]
    fn circumcentres_are_equidistant(points in points(40)) {
        hold(facts::circumcentres_are_equidistant(&points))?;
    }

    #[test]
    fn the_nearest_vertex_is_that_of_a_search(points in points(24), queries in prop::collection::vec(query(), 1..6)) {
        hold(facts::nearest_is_that_of_a_search(&points, &queries))?;
    }

    /// Queries on a lattice have several vertices that are equally near.
    #[test]
    fn the_first_of_equally_near_vertices_is_found(
        points in lattice_points(), queries in prop::collection::vec(query(), 1..6)
    ) {
        hold(facts::nearest_is_that_of_a_search(&points, &queries))?;
    }

    #[test]
    fn what_is_built_is_valid_and_damage_is_named(points in points(30), which in any::<usize>()) {
        hold(facts::damage_is_found(&points, which))?;
    }

    #[test]
    fn compacting_is_building_from_what_is_left(
        points in points(24), removed in prop::collection::vec(0..64usize, 0..24)
    ) {
        hold(facts::compaction_is_building(&points, &removed))?;
    }
}

/// Corners of a unit cube and its middle.
fn cube() -> Vec<DVec3> {
    let corner = |i: u32| dvec3(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2));
    (0..8).map(corner).chain([DVec3::splat(0.5)]).collect()
}

#[test]
fn a_cube_and_its_middle_have_the_numbers_that_euler_gives() {
    let delaunay = Delaunay::new(&cube()).unwrap();
    let partition = delaunay.partition();
    // Each face is two triangles, each the base of a tetrahedron to the middle.
    assert_eq!((partition.cell_count(), partition.hull().len()), (12, 12));
    let graph = partition.graph(9).unwrap();
    // Sides of the cube, a diagonal of each face, spokes.
    assert_eq!(graph.edges().count(), 12 + 6 + 8);
    assert_eq!(graph.around(8), [0, 1, 2, 3, 4, 5, 6, 7]);
    assert!(graph.around(9).is_empty());
    assert!(partition.cell(12).is_none() && partition.cell(0).unwrap().neighbour(4).is_none());
}

#[test]
fn triples_and_vectors_are_the_same_points() {
    let arrays: Vec<[f64; 3]> = cube().iter().map(|p| p.to_array()).collect();
    let mut of_arrays = Delaunay::new(&arrays[..8]).unwrap();
    assert_eq!(of_arrays.insert([0.5, 0.5, 0.5]), Ok(8));
    assert_eq!(of_arrays.insert((0.25, 0.5, 0.5)), Ok(9));
    of_arrays.remove(9).unwrap();
    assert_eq!(of_arrays.partition(), Delaunay::new(&cube()).unwrap().partition());
}

#[test]
fn centres_have_closed_forms_in_every_dimension() {
    let (x, y, z) = (DVec3::X * 2.0, DVec3::Y * 4.0, DVec3::Z * 6.0);
    assert_eq!(circumcentre(&[x]), Some(x));
    assert_eq!(circumcentre(&[x, y]), Some(dvec3(1.0, 2.0, 0.0)));
    let near = |a: Option<DVec3>, b: DVec3| a.is_some_and(|a| a.distance(b) < 1e-14);
    assert!(near(circumcentre(&[DVec3::ZERO, x, y]), dvec3(1.0, 2.0, 0.0)));
    assert!(near(circumcentre(&[DVec3::ZERO, x, y, z]), dvec3(1.0, 2.0, 3.0)));
    for bad in
        [&[][..], &[x, x], &[x, x, y], &[DVec3::ZERO, x, y, x + y], &[x; 5], &[x, dvec3(f64::NAN, 0.0, 0.0)]]
    {
        assert_eq!(circumcentre(bad), None, "{bad:?}");
    }
}

/// A triangle flat to the last bit: its centre is 1e15 away, and rounding once gave another one.
#[test]
fn centres_of_slivers_are_those_of_exact_arithmetic() {
    let height = 2.0_f64.powi(-50);
    let flat = [DVec3::ZERO, dvec3(2.0, 0.0, 0.0), dvec3(1.0, height, 0.0)];
    let centre = circumcentre(&flat).unwrap();
    // On x = 1, where (1 + y²) = (height − y)²: y = (height² − 1) / (2 height), rounded.
    assert_eq!(centre, dvec3(1.0, -0.5 / height, 0.0));
    let apex = dvec3(1.0, 0.0, 2.0);
    let centre = circumcentre(&[flat[0], flat[1], flat[2], apex]).unwrap();
    assert!((centre.distance(apex) / centre.distance(flat[0]) - 1.0).abs() < 1e-15, "{centre}");
    // No `f64` is so far away.
    let needle = [DVec3::ZERO, dvec3(1e200, 0.0, 0.0), dvec3(5e199, 1e-200, 0.0)];
    assert_eq!(circumcentre(&needle), None);
}

/// A tetrahedron above a square and one below it: a hull with a dent, and spheres that are not empty.
#[test]
fn cells_that_are_not_delaunay_are_named() {
    let square = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.0, 0.0], [0.0, 1.1, 0.0]].map(DVec3::from_array);
    let two = |corners: [[u32; 3]; 2], neighbours: [[u32; 3]; 2]| {
        Partition::Triangles(Triangles { corners: corners.to_vec(), neighbours: neighbours.to_vec() })
    };
    let valid = Delaunay::new(&square).unwrap().partition();
    assert_eq!(valid.verify(&square), Ok(()));
    let problem = |partition: &Partition, points: &[DVec3]| match partition.verify(points) {
        Err(DelaunayError::BadCell { cell, problem }) => (cell, problem),
        other => panic!("{other:?}"),
    };
    // One of the two diagonals is not Delaunay.
    let diagonals = [
        two([[0, 1, 2], [0, 2, 3]], [[OUTSIDE, 1, OUTSIDE], [OUTSIDE, OUTSIDE, 0]]),
        two([[0, 1, 3], [1, 2, 3]], [[1, OUTSIDE, OUTSIDE], [OUTSIDE, 0, OUTSIDE]]),
    ];
    let answers: Vec<_> = diagonals.iter().map(|d| d.verify(&square)).collect();
    assert_eq!(answers.iter().filter(|a| a.is_ok()).count(), 1, "{answers:?}");
    assert!(answers.iter().flatten().count() == 1);
    // One triangle alone is valid; so is not one of an arrow whose other half is missing.
    let dented = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 4.0, 0.0]].map(DVec3::from_array);
    let arrow = two([[0, 1, 2], [0, 2, 3]], [[OUTSIDE, 1, OUTSIDE], [OUTSIDE, OUTSIDE, 0]]);
    assert_eq!(problem(&arrow, &dented).1, "is where the hull bends inward");
    let flat =
        Partition::Tetrahedra(Tetrahedra { corners: vec![[0, 1, 2, 3]], neighbours: vec![[OUTSIDE; 4]] });
    assert_eq!(problem(&flat, &square), (0, "is flat or turned inside out"));
    let back = Partition::Line(vec![0, 2, 1]);
    let along = [0.0, 1.0, 2.0].map(|x| DVec3::X * x);
    assert_eq!(problem(&back, &along), (1, "does not lead on along the line"));
    assert_eq!(
        back.verify(&[DVec3::ZERO, DVec3::X, DVec3::NAN]),
        Err(DelaunayError::PointNotFinite { index: 2 })
    );
}

#[test]
fn bad_queries_and_starts_are_refused() {
    let mut points = cube();
    points.push(points[0]);
    let partition = Delaunay::new(&points).unwrap().partition();
    let nearest = NearestVertex::new(&points, &partition).unwrap();
    assert_eq!(nearest.find(DVec3::NAN), Err(DelaunayError::QueryNotFinite { index: 0 }));
    // Another point stands for the last, and there is none after it.
    for start in [9, 10] {
        assert_eq!(nearest.find_from(DVec3::ZERO, start), Err(DelaunayError::NoSuchPoint { index: start }));
    }
    assert!(matches!(NearestVertex::new(&points[..3], &partition), Err(DelaunayError::BadCell { .. })));
    points[2].y = f64::INFINITY;
    assert_eq!(
        NearestVertex::new(&points, &partition).err(),
        Some(DelaunayError::PointNotFinite { index: 2 })
    );
    let only = NearestVertex::new(&[DVec3::ONE; 3], &Partition::Point(0)).unwrap();
    assert_eq!(only.find(DVec3::ZERO), Ok(0));
}

/// A count of points that memory cannot hold overflowed, or ended the program.
#[test]
fn a_count_of_points_that_nothing_can_hold_is_refused() {
    let partition = Delaunay::new(&[[0.0; 3], [1.0, 0.0, 0.0]]).unwrap().partition();
    for count in [usize::MAX / 4, usize::MAX] {
        let limit = 1 << 27;
        assert_eq!(partition.graph(count), Err(DelaunayError::TooManyPoints { count, limit }));
        assert_eq!(partition.check(count), Err(DelaunayError::TooManyPoints { count, limit }));
    }
}

/// A partition in which no cell has two different corners has no vertex: looking for the nearest one panicked.
#[test]
fn cells_with_a_corner_twice_are_refused() {
    let points = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    let point = Tetrahedra { corners: vec![[0; 4]], neighbours: vec![[OUTSIDE; 4]] };
    let flat = Triangles { corners: vec![[0, 1, 2], [1, 3, 1]], neighbours: vec![[OUTSIDE; 3]; 2] };
    for (partition, cell) in [
        (Partition::Tetrahedra(point), 0),
        (Partition::Triangles(flat), 1),
        (Partition::Line(vec![0, 1, 1]), 1),
    ] {
        let error = Some(DelaunayError::BadCell { cell, problem: "has a corner twice" });
        assert_eq!(partition.check(4).err(), error);
        assert_eq!(NearestVertex::new(&points, &partition).err(), error);
        assert_eq!(pointillist_delaunay::Locator::new(&points, &partition).err(), error);
    }
}
