//! From cube maps to coefficients: time against error.

use std::f64::consts::PI;
use std::fmt::Write as _;

use glam::{DVec3, dvec3};
use pointillist_sh::{
    CubeMap, CubeProjector, Sh, ShError, SphereQuadrature, Weights, basis, coefficient_count, gauss_legendre,
};

use crate::common::report::{Row, on_one_thread};
use crate::common::timing::{Clock, timed_by};

const SIZES: [usize; 6] = [8, 16, 32, 64, 128, 256];
const ORDERS: [usize; 4] = [1, 2, 3, 4];
const RULES: [(Weights, &str); 3] =
    [(Weights::Paper, "paper"), (Weights::Exact, "solid angle"), (Weights::Gregory, "Gregory")];

/// The sky with an edge is bright within a cap about this axis, of this cosine.
const CAP_AXIS: DVec3 = dvec3(0.36, 0.80, 0.48);
const CAP_COSINE: f64 = 0.3;
const SKIES: [&str; 2] = ["smooth sky", "sky with an edge"];

/// Most seconds for L2 of 128² texels.
pub(crate) const LIMIT_MS: f64 = 0.3;
/// Largest error of the smooth sky at 128², in L00.
pub(crate) const LIMIT_ERROR: f64 = 1e-8;

/// Quadratic in the direction.
fn smooth(d: DVec3) -> DVec3 {
    let red = 1.0 + 0.5 * d.y + 0.3 * d.x * d.z;
    let green = 2.0 - 0.7 * d.x + 0.4 * d.z * d.z - 0.2 * d.x * d.y;
    dvec3(red, green, 1.5 + 0.6 * (d.y * d.y - d.x * d.x) + 0.25 * d.z)
}

fn with_edge(d: DVec3) -> DVec3 {
    if d.dot(CAP_AXIS) > CAP_COSINE { dvec3(3.0, 2.5, 2.0) } else { dvec3(0.5, 0.4, 0.3) }
}

/// The exact coefficients of [`with_edge`], by Funk and Hecke: λ_l·Y_lm(axis), λ_l = 2π ∫ P_l over the cap.
fn of_edge(order: usize) -> Result<Sh, ShError> {
    let legendre = |l: usize, x: f64| {
        let step = |(a, b): (f64, f64), k: usize| {
            let k = k as f64;
            (b, ((2.0 * k + 1.0) * x * b - k * a) / (k + 1.0))
        };
        (0..l).fold((0.0, 1.0), step).1
    };
    let half = 0.5 * (1.0 - CAP_COSINE);
    let at = |t: f64| CAP_COSINE + half * (t + 1.0);
    let lambda = |l: usize| {
        2.0 * PI * gauss_legendre(8).iter().map(|&(t, w)| w * half * legendre(l, at(t))).sum::<f64>()
    };
    let (bright, dark) = (with_edge(CAP_AXIS), with_edge(-CAP_AXIS));
    let values = basis(order, CAP_AXIS.normalize());
    let band = |i: usize| i.isqrt();
    let cap = |i: usize| (bright - dark) * (lambda(band(i)) * values[i]);
    let mut all: Vec<DVec3> = (0..coefficient_count(order)).map(cap).collect();
    all[0] += dark * (4.0 * PI).sqrt();
    Sh::new(all)
}

/// Rows: the sky, the rule, the setting; the error is that of the worst coefficient over L00 of its colour.
pub(crate) fn rows() -> Result<Vec<Row>, ShError> {
    let mut rows = vec![];
    for (sky, name) in [smooth, with_edge].into_iter().zip(SKIES) {
        for size in SIZES {
            let map = CubeMap::from_fn(size, sky)?;
            for order in ORDERS {
                let truth = if name == SKIES[0] {
                    SphereQuadrature::new(order + 2).project(order, sky)?
                } else {
                    of_edge(order)?
                };
                for (rule, series) in RULES {
                    let setting = format!("{size} px, order {order}");
                    let row = row(&map, &truth, rule)?;
                    rows.push(Row { scene: name.to_owned(), series: series.to_owned(), setting, ..row });
                }
            }
        }
    }
    Ok(rows)
}

fn row(map: &CubeMap, truth: &Sh, rule: Weights) -> Result<Row, ShError> {
    let projector = CubeProjector::new(map.size(), truth.order(), rule)?;
    let found = projector.project(map)?;
    let (time, projected) = on_one_thread(|| timed_by(Clock::Processor, || projector.project(map)));
    projected?;
    let l00 = truth.coefficients()[0];
    let pairs = found.coefficients().iter().zip(truth.coefficients());
    let worst = pairs.map(|(a, b)| ((*a - *b) / l00).abs().max_element()).fold(0.0, f64::max);
    let (scene, series, setting) = Default::default();
    Ok(Row { scene, series, setting, time, rmse: worst, largest: worst, more: vec![] })
}

/// Sizes at order 2, and orders at 128 pixels.
pub(crate) fn table(rows: &[Row]) -> String {
    let mut text = "| cube map | µs | smooth sky: paper | solid angle | Gregory | edge: paper | solid angle | Gregory |\n\
                    | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n"
        .to_owned();
    let sizes = SIZES.iter().map(|s| format!("{s} px, order 2"));
    let orders = ORDERS.iter().filter(|o| **o != 2).map(|o| format!("128 px, order {o}"));
    for setting in sizes.chain(orders) {
        let of = |sky: &str, rule: &str| {
            rows.iter().find(|r| r.scene == sky && r.series == rule && r.setting == setting)
        };
        let least = rows
            .iter()
            .filter(|r| r.setting == setting)
            .map(|r| r.time.seconds)
            .fold(f64::INFINITY, f64::min);
        let _ = write!(text, "| {setting} | {:.1} |", 1e6 * least);
        for (sky, (_, rule)) in SKIES.iter().flat_map(|s| RULES.iter().map(move |r| (s, r))) {
            let _ = write!(text, " {:.1e} |", of(sky, rule).map_or(f64::NAN, |r| r.rmse));
        }
        text.push('\n');
    }
    text
}

/// Milliseconds and error of the best rule at 128², order 2, of the smooth sky.
pub(crate) fn at_128(rows: &[Row]) -> Option<(f64, f64)> {
    let row = rows
        .iter()
        .find(|r| r.scene == SKIES[0] && r.series == "Gregory" && r.setting == "128 px, order 2")?;
    Some((1e3 * row.time.seconds, row.rmse))
}
