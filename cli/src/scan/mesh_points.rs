//! Points all over a triangle.

use glam::DVec3;

/// Most points along an edge: a triangle that is huge against the spacing must not fill the memory.
const MOST_STEPS: f64 = 4096.0;

/// Adds points of a lattice on a triangle, neighbours at most `spacing` apart: the centres of the k²
/// triangles that k cuts along each edge make. None for a triangle without area.
pub(super) fn points_on([a, b, c]: [DVec3; 3], spacing: f64, points: &mut Vec<DVec3>) {
    let (u, v) = (b - a, c - a);
    if u.cross(v) == DVec3::ZERO {
        return;
    }
    let longest = u.length().max(v.length()).max((c - b).length());
    let steps = (longest / spacing).ceil().clamp(1.0, MOST_STEPS);
    let (step, count) = (1.0 / steps, steps as usize);
    for i in 0..count {
        for j in 0..count - i {
            let at = |third: f64| a + (u * (i as f64 + third) + v * (j as f64 + third)) * step;
            points.push(at(1.0 / 3.0));
            // The triangle upside down between this one and the next row.
            if i + j + 1 < count {
                points.push(at(2.0 / 3.0));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_are_as_close_as_asked() {
        let triangle = [DVec3::ZERO, DVec3::X, DVec3::new(0.3, 0.8, 0.1)];
        let mut points = vec![];
        points_on(triangle, 0.1, &mut points);
        // The longest edge, 1.07, is cut into 11.
        assert_eq!(points.len(), 121);
        for p in &points {
            let nearest = points.iter().filter(|q| *q != p).map(|q| q.distance(*p)).fold(f64::MAX, f64::min);
            assert!(nearest <= 0.1, "{p} has its nearest neighbour at {nearest}");
        }
    }

    #[test]
    fn a_triangle_without_area_gets_no_points() {
        let mut points = vec![];
        points_on([DVec3::ZERO, DVec3::X, 2.0 * DVec3::X], 0.1, &mut points);
        assert!(points.is_empty());
    }
}
