//! Polygons of any kind: form factors are shares, reciprocal, the same when moved, and scenes are refused or solved.
#![no_main]

use arbitrary::Arbitrary;
use glam::{DQuat, DVec3, dvec3};
use libfuzzer_sys::fuzz_target;
use pointillist_radiosity::invariants::{factors, scenes};
use pointillist_radiosity::{Polygon, SceneOptions, Surface};

#[derive(Arbitrary, Debug)]
enum Ring {
    /// Of a small lattice: touching, coplanar and crossing polygons come often.
    Lattice(Vec<[i8; 3]>),
    Raw(Vec<[f64; 3]>),
}

impl Ring {
    fn polygon(&self) -> Option<Polygon> {
        let vertices: Vec<DVec3> = match self {
            Self::Lattice(list) => {
                list.iter().take(6).map(|v| DVec3::from_array(v.map(|c| f64::from(c / 32)))).collect()
            }
            Self::Raw(list) => list.iter().take(6).map(|&v| DVec3::from_array(v)).collect(),
        };
        Polygon::new(&vertices).ok()
    }
}

#[derive(Arbitrary, Debug)]
struct Input {
    from: Ring,
    to: Ring,
    others: Vec<Ring>,
    turn: [i8; 4],
    looks: Vec<(u8, u8, bool)>,
}

fuzz_target!(|input: Input| {
    let (Some(a), Some(b)) = (input.from.polygon(), input.to.polygon()) else { return };
    let others: Vec<Polygon> = input.others.iter().take(3).filter_map(Ring::polygon).collect();
    factors::is_a_share(&a, &b, &others).unwrap();
    let lattice = matches!((&input.from, &input.to), (Ring::Lattice(_), Ring::Lattice(_)));
    if !lattice {
        return;
    }
    let [x, y, z, w] = input.turn.map(f64::from);
    if x != 0.0 || y != 0.0 || z != 0.0 || w != 0.0 {
        let turn = DQuat::from_xyzw(x, y, z, w).normalize();
        factors::does_not_depend_on_place(&a, &b, turn, dvec3(1.0, 2.0, 3.0), 1e-3).unwrap();
    }
    let surface = |(i, p): (usize, &Polygon)| {
        let (reflectance, emission, both) = input.looks.get(i).copied().unwrap_or((128, 1, false));
        let one = Surface::new(p.vertices(), [f64::from(reflectance) / 256.0; 3]);
        let one = one.emitting([f64::from(emission); 3]);
        if both { one.two_sided() } else { one }
    };
    let surfaces: Vec<Surface> = [&a, &b].into_iter().chain(&others).enumerate().map(surface).collect();
    let options = SceneOptions::DEFAULT.with_patch(4.0).with_tolerance(Some(0.2)).with_max_elements(1000);
    scenes::is_refused_or_solved(&surfaces, &options).unwrap();
    scenes::is_refused_or_solved_by_rays(&surfaces, &options).unwrap();
});
