//! Polygons with any number of corners to triangles.

use glam::{DVec2, DVec3};

/// Cuts a polygon into triangles of corner numbers, with the polygon's orientation: a fan where it is convex, ear
/// clipping where it is not. A polygon of n ≥ 3 corners gives n − 2 triangles, some perhaps without area.
///
/// Corners should lie in a plane; they are projected to the one that fits best. Takes time n² if not convex.
pub fn triangulate(corners: &[DVec3], mut emit: impl FnMut([usize; 3])) {
    let n = corners.len();
    if n == 3 {
        emit([0, 1, 2]);
        return;
    }
    let flat = project(corners);
    if is_convex(&flat) {
        (2..n).for_each(|i| emit([0, i - 1, i]));
        return;
    }
    let mut rest: Vec<usize> = (0..n).collect();
    while rest.len() > 3 {
        let ear = (0..rest.len()).find(|&at| is_ear(&flat, &rest, at));
        // A polygon that crosses itself may have no ear; any corner is as good as another then.
        let at = ear.unwrap_or(0);
        emit(around(&rest, at));
        rest.remove(at);
    }
    if let [a, b, c] = rest[..] {
        emit([a, b, c]);
    }
}

/// Corners along the two axes that see most of the polygon, counter-clockwise.
fn project(corners: &[DVec3]) -> Vec<DVec2> {
    let origin = corners.first().copied().unwrap_or(DVec3::ZERO);
    let next = corners.iter().cycle().skip(1);
    // Newell's normal: right for concave polygons, too.
    let normal: DVec3 = corners.iter().zip(next).map(|(&a, &b)| (a - origin).cross(b - origin)).sum();
    let size = normal.abs();
    let flat = |p: DVec3| {
        if size.x >= size.y && size.x >= size.z {
            DVec2::new(p.y, p.z * normal.x.signum())
        } else if size.y >= size.z {
            DVec2::new(p.z, p.x * normal.y.signum())
        } else {
            DVec2::new(p.x, p.y * normal.z.signum())
        }
    };
    corners.iter().map(|&p| flat(p - origin)).collect()
}

/// Twice the signed area of a triangle.
fn area2(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

fn is_convex(flat: &[DVec2]) -> bool {
    let n = flat.len();
    let corner = |i: usize| area2(flat[i], flat[(i + 1) % n], flat[(i + 2) % n]);
    // Left turns everywhere, and a fan that never turns back: without it a star would pass.
    (0..n).all(|i| corner(i) >= 0.0) && (2..n).all(|i| area2(flat[0], flat[i - 1], flat[i]) >= 0.0)
}

fn around(rest: &[usize], at: usize) -> [usize; 3] {
    let n = rest.len();
    [rest[(at + n - 1) % n], rest[at], rest[(at + 1) % n]]
}

fn is_ear(flat: &[DVec2], rest: &[usize], at: usize) -> bool {
    let [a, b, c] = around(rest, at).map(|i| flat[i]);
    if area2(a, b, c) <= 0.0 {
        return false;
    }
    rest.iter().map(|&i| flat[i]).all(|p| {
        let corner = p == a || p == b || p == c;
        let inside = area2(a, b, p) >= 0.0 && area2(b, c, p) >= 0.0 && area2(c, a, p) >= 0.0;
        corner || !inside
    })
}
