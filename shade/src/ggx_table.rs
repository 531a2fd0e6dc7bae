//! Directional albedo of a GGX coat, tabulated once by quadrature.
//!
//! With Schlick's Fresnel term the albedo for light from one direction is E = f0·A + f90·B, where A and B depend on
//! the angle and the roughness only (the second sum of the "split sum" \[7\]).

use crate::fresnel::f90;
use glam::{DVec3, Vec2, Vec3, dvec3};
use std::f64::consts::TAU;
use std::sync::LazyLock;

/// Entries along the square root of the cosine: dense near grazing angles, where the values turn.
const COSINES: usize = 48;
/// Entries along the perceptual roughness, from 0 to 1.
const ROUGHNESSES: usize = 32;
/// Half vectors for each entry; the error of the table is then that of linear interpolation (studies).
const STRATA: [usize; 2] = [48, 24];

struct Table {
    /// A and B, row by row of equal roughness.
    terms: Vec<Vec2>,
    /// Their means over the hemisphere, 2∫ E(c) c dc, for each roughness.
    means: Vec<Vec2>,
}

static TABLE: LazyLock<Table> = LazyLock::new(Table::new);

/// The share of light that a GGX coat of this reflectance at normal incidence returns to all directions.
///
/// `cos` is that of the light (or, the coat being reciprocal, of the eye), `roughness` is perceptual; both are cut
/// to [0, 1]. Also the factor on a prefiltered environment \[7\]. Errors are below 1e-3 up to 80° from the normal and
/// below 5e-3 beyond.
#[must_use]
pub fn coat_albedo(f0: Vec3, roughness: f32, cos: f32) -> Vec3 {
    let table = &*TABLE;
    let (row, fr) = entry_below(roughness, ROUGHNESSES);
    let (column, fc) = entry_below(cos.max(0.0).sqrt(), COSINES);
    let at = |row: usize| {
        let first = row * COSINES + column;
        table.terms[first].lerp(table.terms[first + 1], fc)
    };
    combine(f0, at(row).lerp(at(row + 1), fr))
}

/// The mean of [`coat_albedo`] over evenly lit directions, 2∫ E(c) c dc.
pub(crate) fn mean_coat_albedo(f0: Vec3, roughness: f32) -> Vec3 {
    let (row, f) = entry_below(roughness, ROUGHNESSES);
    combine(f0, TABLE.means[row].lerp(TABLE.means[row + 1], f))
}

fn combine(f0: Vec3, terms: Vec2) -> Vec3 {
    f0 * terms.x + f90(f0) * terms.y
}

/// The entry below a coordinate in [0, 1], and how far it is to the next.
fn entry_below(x: f32, count: usize) -> (usize, f32) {
    // Not `clamp`, which lets NaN pass.
    let x = if x > 0.0 { x.min(1.0) } else { 0.0 } * (count - 1) as f32;
    let index = (x as usize).min(count - 2);
    (index, x - index as f32)
}

impl Table {
    fn new() -> Self {
        let cosine = |i: usize| (i as f64 / (COSINES - 1) as f64).powi(2);
        let mut terms = Vec::with_capacity(COSINES * ROUGHNESSES);
        let mut means = Vec::with_capacity(ROUGHNESSES);
        for row in 0..ROUGHNESSES {
            let roughness = row as f64 / (ROUGHNESSES - 1) as f64;
            let alpha = f64::from(crate::roughness::alpha(roughness as f32));
            terms.extend((0..COSINES).map(|i| entry(cosine(i).max(1e-6), alpha)));
            means.push(mean(&terms[row * COSINES..]));
        }
        Self { terms, means }
    }
}

/// 2∫ E(c) c dc over one row, exactly for what linear interpolation in the square root of c makes of it, up to the
/// rounding of a fine sum.
fn mean(row: &[Vec2]) -> Vec2 {
    const STEPS: usize = 1024;
    let mut sum = Vec2::ZERO;
    for i in 0..STEPS {
        let root = (i as f32 + 0.5) / STEPS as f32;
        let (k, f) = entry_below(root, COSINES);
        // c = root², dc = 2 root: 2 E c dc.
        sum += row[k].lerp(row[k + 1], f) * (4.0 * root * root * root / STEPS as f32);
    }
    sum
}

/// A and B by stratified sampling of the visible half vectors \[11\]: each then counts G₂/G₁ alone, which is smooth.
fn entry(cos_v: f64, alpha: f64) -> Vec2 {
    let v = dvec3((1.0 - cos_v * cos_v).sqrt(), 0.0, cos_v);
    let masked = |cos: f64| (alpha * alpha + (1.0 - alpha * alpha) * cos * cos).sqrt();
    let (mut a, mut b) = (0.0, 0.0);
    for i in 0..STRATA[0] {
        for j in 0..STRATA[1] {
            // Packed towards 1, where the lobe's tail meets the horizon: evenly spread, as many are wrong by 1e-2.
            let rest = 1.0 - (i as f64 + 0.5) / STRATA[0] as f64;
            let weight = 3.0 * rest * rest;
            let turn = (j as f64 + 0.5) / STRATA[1] as f64;
            let h = visible_half_vector(v, alpha, [1.0 - rest.powi(3), turn]);
            let cos_h = v.dot(h);
            let cos_l = 2.0 * cos_h * h.z - v.z;
            if cos_l <= 0.0 || cos_h <= 0.0 {
                continue;
            }
            let shadowing = cos_l * (cos_v + masked(cos_v)) / (cos_v * masked(cos_l) + cos_l * masked(cos_v));
            let fresnel = (1.0 - cos_h).clamp(0.0, 1.0).powi(5);
            a += weight * shadowing * (1.0 - fresnel);
            b += weight * shadowing * fresnel;
        }
    }
    let count = (STRATA[0] * STRATA[1]) as f64;
    Vec2::new((a / count) as f32, (b / count) as f32)
}

/// A half vector by the density with which `v` sees them \[11, appendix A\].
fn visible_half_vector(v: DVec3, alpha: f64, [u0, u1]: [f64; 2]) -> DVec3 {
    let stretched = dvec3(alpha * v.x, alpha * v.y, v.z).normalize();
    let t1 = dvec3(-stretched.y, stretched.x, 0.0).normalize_or(DVec3::X);
    let t2 = stretched.cross(t1);
    let (r, phi) = (u0.sqrt(), TAU * u1);
    let p1 = r * phi.cos();
    let s = 0.5 * (1.0 + stretched.z);
    let p2 = (1.0 - s) * (1.0 - p1 * p1).max(0.0).sqrt() + s * r * phi.sin();
    let p3 = (1.0 - p1 * p1 - p2 * p2).max(0.0).sqrt();
    let h = p1 * t1 + p2 * t2 + p3 * stretched;
    dvec3(alpha * h.x, alpha * h.y, h.z.max(0.0)).normalize_or(DVec3::Z)
}
