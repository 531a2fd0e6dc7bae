//! How far the outline of a picture is from the true one.

/// Farther apart than this many pixels, a point of one outline has nothing to do with the other.
const FARTHEST: f64 = 5.0;

/// Where the coverage of a square picture passes 1/2 between neighbouring pixels, in pixels.
pub(crate) struct Contour {
    size: usize,
    /// By pixel.
    points: Vec<Vec<[f64; 2]>>,
}

impl Contour {
    pub(crate) fn new(coverage: &[f64], size: usize) -> Self {
        let mut points = vec![vec![]; size * size];
        for i in 0..size * size {
            let (x, y) = (i % size, i / size);
            let place = [x as f64 + 0.5, y as f64 + 0.5];
            let next = [(x + 1 < size).then_some(i + 1), (y + 1 < size).then_some(i + size)];
            for (axis, n) in next.into_iter().enumerate() {
                let Some(n) = n else { continue };
                let (a, b) = (coverage[i] - 0.5, coverage[n] - 0.5);
                if (a < 0.0) != (b < 0.0) {
                    let mut point = place;
                    point[axis] += a / (a - b);
                    points[i].push(point);
                }
            }
        }
        Self { size, points }
    }

    /// Root mean square distance of these points from the nearest one of `other`; distances count up to [`FARTHEST`].
    pub(crate) fn rms_distance(&self, other: &Self) -> f64 {
        let all = || self.points.iter().flatten();
        let sum: f64 = all().map(|p| other.distance(*p).powi(2)).sum();
        (sum / all().count().max(1) as f64).sqrt()
    }

    fn distance(&self, p: [f64; 2]) -> f64 {
        let reach = FARTHEST as usize + 1;
        let range = |v: f64| (v as usize).saturating_sub(reach)..(v as usize + reach + 1).min(self.size);
        let near = range(p[1]).flat_map(|y| range(p[0]).map(move |x| y * self.size + x));
        let distances = near.flat_map(|i| &self.points[i]).map(|q| (p[0] - q[0]).hypot(p[1] - q[1]));
        distances.fold(FARTHEST, f64::min)
    }
}
