//! Points of any kind: cells are Delaunay and fill the hull, weights find the nearest point, centres, edges, facets and nearest vertices
//! are those of a slow search, and nothing panics.
#![no_main]

use arbitrary::Arbitrary;
use glam::{DVec3, dvec3};
use libfuzzer_sys::fuzz_target;
use pointillist_delaunay::invariants::{queries as facts, weights};
use pointillist_delaunay::{Delaunay, Locator};

#[derive(Arbitrary, Debug)]
enum Points {
    /// Of a small lattice: grids, planes, lines and repeats come often.
    Lattice(Vec<[i8; 3]>, i8),
    Raw(Vec<[f64; 3]>),
}

#[derive(Arbitrary, Debug)]
struct Input {
    points: Points,
    queries: Vec<[f32; 3]>,
    taken_out: Vec<u8>,
}

fuzz_target!(|input: Input| {
    let lattice = matches!(input.points, Points::Lattice(..));
    let points: Vec<DVec3> = match &input.points {
        Points::Lattice(list, power) => {
            let scale = 2.0_f64.powi((*power).into());
            list.iter()
                .take(40)
                .map(|&[x, y, z]| dvec3((x / 16).into(), (y / 16).into(), (z / 16).into()) * scale)
                .collect()
        }
        Points::Raw(list) => list.iter().take(40).map(|&p| DVec3::from_array(p)).collect(),
    };
    let Ok(mut delaunay) = Delaunay::new(&points) else { return };
    delaunay.partition().verify(&points).unwrap();
    let locator = Locator::new(&points, &delaunay.partition()).expect("cells between these points");
    let queries: Vec<DVec3> =
        input.queries.iter().take(8).map(|q| dvec3(q[0].into(), q[1].into(), q[2].into())).collect();
    for &query in &queries {
        if let Ok(blend) = locator.locate_anywhere(query) {
            assert!(blend.weights.iter().all(|w| (0.0..=1.0).contains(w)), "{blend:?}");
        }
    }
    facts::edges_are_those_of_cells(&points).unwrap();
    facts::hull_facets_have_all_points_on_one_side(&points).unwrap();
    facts::circumcentres_are_equidistant(&points).unwrap();
    facts::nearest_is_that_of_a_search(&points, &queries[..queries.len().min(2)]).unwrap();
    if lattice {
        let finite: Vec<DVec3> = queries.into_iter().filter(|q| q.is_finite() && q.length() < 1e6).collect();
        weights::weights_find_the_nearest_point(&points, &finite, 1e-9).unwrap();
    }
    for &index in input.taken_out.iter().take(8) {
        let _ = delaunay.remove(index.into());
        let _ = delaunay.partition();
    }
    delaunay.compact().unwrap();
});
