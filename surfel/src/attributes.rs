//! Attributes of the points of a cloud, in the cloud's order.

use crate::lattice::{Lattice, morton};
use crate::neighbours::Places;
use crate::packed;
use crate::points::Points;
use crate::{areas, normals, radius};
use glam::{DVec3, Vec3};
use pointillist_parallel as parallel;
use std::cmp::Ordering;

/// Radii and areas are at least this many units: 2⁻³³, half a cell of the lattice.
pub(crate) const SMALLEST: f32 = 1.164_153_2e-10;

/// Attributes of all points, leaf by leaf.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Attributes {
    pub(crate) cells: [Vec<u32>; 3],
    /// Unit vectors.
    pub(crate) normals: [Vec<f32>; 3],
    /// What light sees in their place, packed; none if it sees the normals.
    pub(crate) shading_normals: Option<Vec<u32>>,
    /// Units.
    pub(crate) radii: Vec<f32>,
    /// Share of the surface, square units.
    pub(crate) areas: Vec<f32>,
    pub(crate) colors: Option<Vec<[f32; 3]>>,
    /// None if all points are opaque.
    pub(crate) opacities: Option<Vec<f32>>,
}

impl Attributes {
    pub(crate) fn cell(&self, point: usize) -> [u32; 3] {
        [0, 1, 2].map(|axis| self.cells[axis][point])
    }

    pub(crate) fn normal(&self, point: usize) -> Vec3 {
        Vec3::from_array([0, 1, 2].map(|axis| self.normals[axis][point]))
    }

    /// What light sees in the place of a normal, if that is another one.
    pub(crate) fn shading_normal(&self, point: usize) -> Option<Vec3> {
        self.shading_normals.as_ref().map(|all| packed::unpack_way(all[point]).normalize())
    }

    pub(crate) fn opacity(&self, point: usize) -> f32 {
        self.opacities.as_ref().map_or(1.0, |all| all[point])
    }

    /// The values at these places, in this order.
    pub(crate) fn at(&self, places: &[u32]) -> Self {
        fn taken<T: Copy>(list: &[T], places: &[u32]) -> Vec<T> {
            places.iter().map(|&place| list[place as usize]).collect()
        }
        Self {
            cells: self.cells.each_ref().map(|list| taken(list, places)),
            normals: self.normals.each_ref().map(|list| taken(list, places)),
            shading_normals: self.shading_normals.as_ref().map(|list| taken(list, places)),
            radii: taken(&self.radii, places),
            areas: taken(&self.areas, places),
            colors: self.colors.as_ref().map(|list| taken(list, places)),
            opacities: self.opacities.as_ref().map(|list| taken(list, places)),
        }
    }
}

/// All points of a cloud, sorted.
pub(crate) struct Sorted {
    pub(crate) attributes: Attributes,
    /// Their Morton codes, ascending.
    pub(crate) codes: Vec<u64>,
    /// The caller's number of each.
    pub(crate) numbers: Vec<u32>,
    /// Which of them are seen from both sides: those without given normals whose surface has no outside.
    pub(crate) two_sided: Vec<bool>,
}

/// Estimates missing attributes and sorts points by Morton code, then by attributes, so that the order of input does
/// not matter. `usual` is the typical spacing in units, where it is known: see [`radius::of_cloud`].
pub(crate) fn in_order(points: &Points<'_>, lattice: &Lattice, usual: Option<f64>) -> Sorted {
    let count = points.positions.len();
    let cells = parallel::map(count, |i| lattice.cell(points.positions[i]));
    let mut keys = parallel::map(count, |i| (morton(cells[i]), i as u32));
    parallel::sort_by(&mut keys, |a, b| {
        a.0.cmp(&b.0).then_with(|| compare(points, &cells, a.1 as usize, b.1 as usize))
    });
    // In units about the cube's corner, so that estimates do not depend on where the cloud lies.
    let at = |i: u32| (points.positions[i as usize] - lattice.low) / lattice.side;
    let positions: Vec<DVec3> = keys.iter().map(|&(_, i)| at(i)).collect();
    let places = Places::new(&positions);
    let unit = |n: Vec3| (n / n.abs().max_element()).normalize();
    let (normals, two_sided): (Vec<Vec3>, Vec<bool>) = match points.normals {
        Some(given) => keys.iter().map(|&(_, i)| (unit(given[i as usize]), false)).unzip(),
        None => normals::estimate(&places).into_iter().map(|n| (n.way, !n.has_outside)).unzip(),
    };
    let is_estimated = points.normals.is_none();
    let radii: Vec<f32> = match points.radii {
        Some(given) => {
            keys.iter().map(|&(_, i)| (f64::from(given[i as usize]) / lattice.side) as f32).collect()
        }
        None => radius::of_cloud(&places, &normals, is_estimated, usual),
    };
    let radii: Vec<f32> = radii.into_iter().map(|r| r.clamp(SMALLEST, 1e6)).collect();
    let areas = areas::of_cloud(&places, &normals, &radii, is_estimated);
    let opacities = points.opacities.filter(|all| all.iter().any(|&opacity| opacity < 1.0));
    let attributes = Attributes {
        cells: [0, 1, 2].map(|axis| keys.iter().map(|&(_, i)| cells[i as usize][axis]).collect()),
        normals: [0, 1, 2].map(|axis| normals.iter().map(|n| n[axis]).collect()),
        shading_normals: points.shading_normals.map(|given| {
            keys.iter().map(|&(_, i)| packed::pack_direction(unit(given[i as usize]))).collect()
        }),
        radii,
        areas: areas.into_iter().map(|a| a.clamp(SMALLEST * SMALLEST, 1e12)).collect(),
        colors: points.colors.map(|given| keys.iter().map(|&(_, i)| given[i as usize]).collect()),
        opacities: opacities.map(|given| keys.iter().map(|&(_, i)| given[i as usize]).collect()),
    };
    let (codes, numbers) = keys.into_iter().unzip();
    Sorted { attributes, codes, numbers, two_sided }
}

/// Order of points of one Morton code: by all attributes. Points that are equal in all of them are interchangeable.
fn compare(points: &Points<'_>, cells: &[[u32; 3]], a: usize, b: usize) -> Ordering {
    let exact = |i: usize| points.positions[i].to_array();
    let normal = |i: usize| points.normals.map_or([0.0; 3], |all| all[i].to_array());
    let shading = |i: usize| points.shading_normals.map_or([0.0; 3], |all| all[i].to_array());
    let color = |i: usize| points.colors.map_or([0.0; 3], |all| all[i]);
    let radius = |i: usize| points.radii.map_or(0.0, |all| all[i]);
    let opacity = |i: usize| points.opacities.map_or(1.0, |all| all[i]);
    let by = |p: [f32; 3], q: [f32; 3]| {
        p.iter().zip(&q).map(|(p, q)| p.total_cmp(q)).find(|o| o.is_ne()).unwrap_or(Ordering::Equal)
    };
    let by_position = || {
        exact(a)
            .iter()
            .zip(&exact(b))
            .map(|(p, q)| p.total_cmp(q))
            .find(|o| o.is_ne())
            .unwrap_or(Ordering::Equal)
    };
    cells[a]
        .cmp(&cells[b])
        .then_with(by_position)
        .then_with(|| by(normal(a), normal(b)))
        .then_with(|| by(color(a), color(b)))
        .then_with(|| radius(a).total_cmp(&radius(b)))
        .then_with(|| opacity(a).total_cmp(&opacity(b)))
        // Last, so that they change the order of none that differ otherwise.
        .then_with(|| by(shading(a), shading(b)))
}
