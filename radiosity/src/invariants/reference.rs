//! A slow form factor that shares no code with the fast one: the double contour integral by tanh–sinh quadrature, which
//! does not mind what happens at the ends of an interval.

use glam::DVec3;

/// Points and weights of tanh–sinh quadrature on [0, 1]: distance from the nearer end, whether that is the upper, weight.
fn tanh_sinh() -> Vec<(f64, bool, f64)> {
    let step = 1.0 / 16.0;
    (-56..=56)
        .map(|k: i32| {
            let t = f64::from(k) * step;
            let u = std::f64::consts::FRAC_PI_2 * t.sinh();
            let from_end = 1.0 / (1.0 + (2.0 * u.abs()).exp());
            let weight = step * std::f64::consts::FRAC_PI_4 * t.cosh() / u.cosh().powi(2);
            (from_end, k > 0, weight)
        })
        .collect()
}

/// ∫ f over [0, length], cut where `f` may be singular.
fn integral(rule: &[(f64, bool, f64)], mut cuts: Vec<f64>, length: f64, f: impl Fn(f64) -> f64) -> f64 {
    cuts.retain(|&at| at > 0.0 && at < length);
    cuts.extend([0.0, length]);
    cuts.sort_by(f64::total_cmp);
    let mut sum = 0.0;
    for pair in cuts.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let inner = |&(end, upper, w): &(f64, bool, f64)| {
            let x = if upper { to - (to - from) * end } else { from + (to - from) * end };
            w * f(x)
        };
        sum += (to - from) * rule.iter().map(inner).sum::<f64>();
    }
    sum
}

/// ∬ ln r dx·dy over two edges.
fn edge_pair(rule: &[(f64, bool, f64)], (a, b): (DVec3, DVec3), (c, d): (DVec3, DVec3)) -> f64 {
    let (length_a, length_b) = ((b - a).length(), (d - c).length());
    let (u, v) = ((b - a) / length_a, (d - c) / length_b);
    let cosine = u.dot(v);
    if cosine.abs() < 1e-16 {
        return 0.0;
    }
    let w = a - c;
    let sine2 = 1.0 - cosine * cosine;
    let nearest = if sine2 > 1e-9 { (cosine * v.dot(w) - u.dot(w)) / sine2 } else { 0.0 };
    let outer = |s: f64| {
        let p = a + u * s;
        let foot = v.dot(p - c);
        let inner = |t: f64| {
            let r2 = (p - (c + v * t)).length_squared();
            if r2 > 0.0 { 0.5 * r2.ln() } else { 0.0 }
        };
        integral(rule, vec![foot], length_b, inner)
    };
    let cuts = vec![nearest, (c - a).dot(u), (d - a).dot(u)];
    cosine * integral(rule, cuts, length_a, outer)
}

/// A₁F₁₂ of two polygons in front of each other with nothing between, to about 1e-13 of the product of their sizes;
/// some milliseconds.
#[must_use]
pub fn mutual(a: &[DVec3], b: &[DVec3]) -> f64 {
    let rule = tanh_sinh();
    let mut sum = 0.0;
    for i in 0..a.len() {
        for j in 0..b.len() {
            let (next_i, next_j) = ((i + 1) % a.len(), (j + 1) % b.len());
            sum += edge_pair(&rule, (a[i], a[next_i]), (b[j], b[next_j]));
        }
    }
    sum * 0.5 / std::f64::consts::PI
}

/// The same for polygons of three or four vertices that are far apart, where contours cancel: Romberg's
/// rule over both areas, good to (size/distance)⁸.
#[must_use]
pub fn mutual_far(a: &[DVec3], b: &[DVec3]) -> f64 {
    let (coarse, middle, fine) = (over_areas(a, b, 4), over_areas(a, b, 8), over_areas(a, b, 16));
    let (first, second) = ((4.0 * middle - coarse) / 3.0, (4.0 * fine - middle) / 3.0);
    (16.0 * second - first) / 15.0
}

/// Midpoint rule with `n`⁴ points.
fn over_areas(a: &[DVec3], b: &[DVec3], n: usize) -> f64 {
    let points = |ring: &[DVec3]| -> Vec<(DVec3, DVec3)> {
        let corner = |i: usize| ring[i.min(ring.len() - 1)];
        let mut list = vec![];
        for k in 0..n * n {
            let [u, v] = [k / n, k % n].map(|i| (i as f64 + 0.5) / n as f64);
            let along = (corner(1) - corner(0)) * (1.0 - v) + (corner(2) - corner(3)) * v;
            let across = (corner(3) - corner(0)) * (1.0 - u) + (corner(2) - corner(1)) * u;
            let low = corner(0) + (corner(1) - corner(0)) * u;
            list.push((low + across * v, along.cross(across) / (n * n) as f64));
        }
        list
    };
    let (of_a, of_b) = (points(a), points(b));
    let mut sum = 0.0;
    for (p, area_p) in &of_a {
        for (q, area_q) in &of_b {
            let r = *q - *p;
            sum -= area_p.dot(r) * area_q.dot(r) / r.length_squared().powi(2);
        }
    }
    sum / std::f64::consts::PI
}
