//! The hemisphere over a place in parts of equal weight, so that rays go where light differs most.
//!
//! What neighbours of a place have seen says how much light differs within each part; the next rays are divided in proportion to that (Neyman's allocation, \[10\]).
//! The place's own rays have no say: if those that chanced to see a bright spot brought more rays to it, and those that chanced to miss it did not, spots would
//! count too little on average.

/// Parts of the square that is mapped to the hemisphere, along each side.
const ACROSS: usize = 4;
/// Parts.
pub(crate) const PARTS: usize = ACROSS * ACROSS;
/// Share of rays that are spread evenly whatever neighbours say.
const EVEN: f64 = 0.25;
/// Parts in which neighbours saw no difference are taken to have this share of the mean variance.
const UNSEEN: f64 = 0.02;

/// Rays of each part.
pub(crate) type Plan = [u32; PARTS];

/// As many rays in every part.
pub(crate) const fn even(rays: u32) -> Plan {
    [rays.div_ceil(PARTS as u32); PARTS]
}

/// A point of a part, for a point of the unit square.
pub(crate) fn within(part: usize, [x, y]: [f64; 2]) -> [f64; 2] {
    let side = ACROSS as f64;
    [((part % ACROSS) as f64 + x) / side, ((part / ACROSS) as f64 + y) / side]
}

/// What the rays of a part brought. Single precision: it chooses where rays go, and is in no result.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Part {
    rays: f32,
    sum: f32,
    squares: f32,
}

/// The same of all parts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Parts([Part; PARTS]);

impl Parts {
    pub(crate) fn add(&mut self, part: usize, light: f64) {
        let Part { rays, sum, squares } = &mut self.0[part];
        *rays += 1.0;
        *sum += light as f32;
        *squares += (light * light) as f32;
    }

    pub(crate) fn join(&mut self, other: &Self) {
        for (own, other) in self.0.iter_mut().zip(&other.0) {
            own.rays += other.rays;
            own.sum += other.sum;
            own.squares += other.squares;
        }
    }

    /// Rays that a part has had.
    pub(crate) fn rays(&self, part: usize) -> u32 {
        self.0[part].rays as u32
    }

    /// Variance of what single rays of each part bring.
    pub(crate) fn variances(&self) -> Variances {
        let of = |part: &Part| {
            let count = f64::from(part.rays);
            let mean = f64::from(part.sum) / count.max(1.0);
            let spread = f64::from(part.squares) / count.max(1.0) - mean * mean;
            spread.max(0.0) * count / (count - 1.0).max(1.0)
        };
        let mut all = [0.0; PARTS];
        all.iter_mut().zip(&self.0).for_each(|(variance, part)| *variance = of(part));
        let least = UNSEEN * all.iter().sum::<f64>() / PARTS as f64;
        Variances(all.map(|variance| variance.max(least)))
    }
}

/// How much light differs within each part.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Variances([f64; PARTS]);

impl Variances {
    /// About so many rays where they lessen the error most; never none in a part.
    pub(crate) fn plan(&self, rays: u32) -> Plan {
        let whole: f64 = self.0.iter().map(|v| v.sqrt()).sum();
        if whole <= 0.0 {
            return even(rays);
        }
        let rays = f64::from(rays);
        let least = EVEN * rays / PARTS as f64;
        self.0.map(|v| (least + (1.0 - EVEN) * rays * v.sqrt() / whole).round().max(1.0) as u32)
    }

    /// Variance of the mean over all parts by this many rays in each.
    pub(crate) fn of_mean(&self, plan: &Plan) -> f64 {
        let of = |(variance, &rays): (&f64, &u32)| variance / f64::from(rays.max(1));
        self.0.iter().zip(plan).map(of).sum::<f64>() / (PARTS * PARTS) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_go_where_light_differs() {
        let mut parts = Parts::default();
        for part in 0..PARTS {
            for k in 0..8 {
                parts.add(part, if part == 5 { f64::from(k % 2) } else { 1.0 });
            }
        }
        let variances = parts.variances();
        let plan = variances.plan(256);
        assert!(plan[5] > 60 && plan.iter().all(|&rays| rays >= 4), "{plan:?}");
        let total: u32 = plan.iter().sum();
        assert!(total.abs_diff(256) <= 16, "{total}");
        assert!(variances.of_mean(&plan) < 0.5 * variances.of_mean(&even(256)));
    }

    #[test]
    fn where_all_is_alike_rays_are_spread_evenly() {
        assert_eq!(Parts::default().variances().plan(64), even(64));
        assert_eq!(even(64), [4; PARTS]);
    }
}
