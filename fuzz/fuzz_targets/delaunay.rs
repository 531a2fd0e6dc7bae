//! Points of any kind: cells are Delaunay and fill the hull, however they came about; weights find the nearest point; centres, edges, facets
//! and nearest vertices are those of a slow search; and nothing panics.
#![no_main]

use arbitrary::Arbitrary;
use glam::{DQuat, DVec3, EulerRot, dvec3};
use libfuzzer_sys::fuzz_target;
use pointillist_delaunay::invariants::{queries as facts, triangulation, weights};
use pointillist_delaunay::{Delaunay, Locator};

#[derive(Arbitrary, Debug)]
enum Points {
    /// Of a small lattice: grids, planes, lines and repeats come often.
    Lattice(Vec<[i8; 3]>, i8),
    /// Of a turned one, by angles in 1/16: whatever was flat is rounded.
    Turned(Vec<[i8; 3]>, [i8; 3]),
    Raw(Vec<[f64; 3]>),
}

#[derive(Arbitrary, Debug)]
struct Input {
    points: Points,
    queries: Vec<[f32; 3]>,
    taken_out: Vec<u8>,
}

fuzz_target!(|input: Input| {
    let on_lattice = |list: &[[i8; 3]]| -> Vec<DVec3> {
        list.iter().take(40).map(|p| DVec3::from_array(p.map(|c| f64::from(c / 16)))).collect()
    };
    let points: Vec<DVec3> = match &input.points {
        Points::Lattice(list, power) => {
            let scale = 2.0_f64.powi((*power).into());
            on_lattice(list).into_iter().map(|p| p * scale).collect()
        }
        Points::Turned(list, angles) => {
            let [x, y, z] = angles.map(|angle| f64::from(angle) / 16.0);
            let turn = DQuat::from_euler(EulerRot::XYZ, x, y, z);
            on_lattice(list).into_iter().map(|p| turn * p).collect()
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
    let tolerance = match input.points {
        Points::Lattice(..) => Some(1e-9),
        Points::Turned(..) => Some(1e-7),
        Points::Raw(_) => None,
    };
    if let Some(tolerance) = tolerance {
        let finite = queries.into_iter().filter(|q| q.is_finite() && q.length() < 1e6);
        let halfway = points.windows(2).take(8).map(|pair| pair[0].midpoint(pair[1]));
        let asked: Vec<DVec3> = finite.chain(halfway).collect();
        weights::weights_find_the_nearest_point(&points, &asked, tolerance).unwrap();
    }
    let few = &points[..points.len().min(16)];
    triangulation::insertion_is_building(few).unwrap();
    let removed: Vec<usize> = input.taken_out.iter().take(4).map(|&i| i.into()).collect();
    triangulation::removal_is_building(few, &removed).unwrap();
    for &index in input.taken_out.iter().take(8) {
        let _ = delaunay.remove(index.into());
        let _ = delaunay.partition();
    }
    delaunay.compact().unwrap();
});
