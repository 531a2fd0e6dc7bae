//! Irradiance at a point by rays, to which more can be added.

use glam::DVec3;

use super::links::NONE;
use super::parts::{PARTS, Parts, Plan, Variances, within};
use super::solution::RaySolution;
use crate::rays::sequence::{Hemisphere, Sequence, mix, shift_of};
use crate::rgb::{Rgb, add};

/// Rays of a place at first.
pub(crate) const FIRST: u32 = 32;
/// Places that have seen less than this share of [`Gatherer::floor`] by their first rays stay dark.
pub(crate) const BLACK: f64 = 0.1;
/// Places darker than this share of what a mean part of the light meets need no smaller error than one of that brightness.
const DARK: f64 = 0.1;
/// Rays shorter than this share of the scene's size count as so long, when distances are averaged.
const SHORT: f64 = 1e-5;
/// Standard errors below this share of [`Gatherer::floor`] count as so large.
const LEAST: f64 = 1e-4;
/// Rays are spread evenly within their parts, and many err less than as many independent ones, which variances are of: in the room of the tests below by .75, .67, .54, .55 and .45 for 128 to 2,048
/// rays. Where bright spots are small it is less. The variance of the mean is taken to fall with the power 1.2 of the number of rays above 64: .93, .87, .81, .76 and .71.
const SPREAD: f64 = 0.2;
const SPREAD_FROM: f64 = 64.0;
/// The least floor, also of scenes in which no light arrives anywhere: its square is far from the smallest number, so that every variance has a reciprocal.
const FAINTEST: f64 = 1e-100;

/// Gathers for one solution.
pub(crate) struct Gatherer<'s> {
    solution: &'s RaySolution<'s>,
    /// Irradiance below which errors are judged as if it were this.
    pub(crate) floor: f64,
}

/// What arrives at a point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Gathered {
    /// From emitters that are looked at one by one.
    emitted: Rgb,
    /// From all others: the mean of rounds of rays, each by its precision.
    light: Rgb,
    /// Mean of the reciprocals of distances.
    near: f64,
    /// Sum over rounds of the reciprocals of their variances; 0 as long as that of the first is not known.
    precision: f64,
    rays: u32,
    pub(crate) parts: Parts,
}

pub(crate) fn mean(v: Rgb) -> f64 {
    v.iter().sum::<f64>() / 3.0
}

impl Gathered {
    pub(crate) const fn rays(&self) -> u32 {
        self.rays
    }

    pub(crate) fn light(&self) -> Rgb {
        add(self.emitted, 1.0, self.light)
    }

    /// Squared standard error of the mean of the bands, once the precision is known.
    pub(crate) fn variance(&self) -> f64 {
        (f64::from(self.rays) / SPREAD_FROM).max(1.0).powf(-SPREAD) / self.precision
    }

    /// Harmonic mean of the distances of what rays meet.
    pub(crate) fn reach(&self) -> f64 {
        if self.near > 0.0 { 1.0 / self.near } else { 1.0 }
    }

    /// What this many rays brought, all of the same light from the same distance.
    #[cfg(test)]
    pub(crate) fn of(rays: u32, light: Rgb, distance: f64) -> Self {
        Self { light, near: 1.0 / distance, precision: 1.0, rays, ..Self::default() }
    }

    /// Whether the place is behind or inside of something: surfaces are around it, and all of them are black, as nothing is where light is reflected.
    pub(crate) fn is_covered(&self) -> bool {
        self.near > 0.0 && self.light() == [0.0; 3]
    }

    /// Sets the precision of the first round of rays, which were spread evenly.
    pub(crate) fn weigh_first(&mut self, precision: f64) {
        if self.precision == 0.0 {
            self.precision = precision;
        }
    }

    /// Adds a round.
    fn take(&mut self, light: Rgb, near: f64, precision: f64) {
        self.precision += precision;
        // The first round has no weight yet, nor anything to be weighed against.
        let share = if self.precision > 0.0 { precision / self.precision } else { 1.0 };
        self.light = add(self.light.map(|l| l * (1.0 - share)), share, light);
        self.near += share * (near - self.near);
    }
}

impl<'s> Gatherer<'s> {
    pub(crate) fn new(solution: &'s RaySolution<'s>) -> Self {
        let transport = solution.transport;
        let (mut squares, mut light) = (0.0, 0.0);
        for (patch, &leaf) in transport.leaves.iter().enumerate() {
            let area = transport.scene.tree.elements[leaf as usize].polygon.area();
            let gathered = solution.gathered[patch];
            let own = mean(gathered) + mean(transport.emitted[patch]);
            squares += area * own * own;
            light += area * own;
        }
        let floor = if light > 0.0 { DARK * squares / light } else { 0.0 };
        Self { solution, floor: floor.max(FAINTEST) }
    }

    /// Irradiance at a point, in internal coordinates, that lies in front of its surface. `place` chooses the rays.
    pub(crate) fn start(&self, point: DVec3, normal: DVec3, place: u64) -> Gathered {
        let transport = self.solution.transport;
        let emitted = transport.emitters.at(&transport.around, point, normal, shift_of(place ^ 0x1a39));
        Gathered { emitted, ..Gathered::default() }
    }

    /// The reciprocal of the variance of a round of rays. No error is smaller than what no picture shows.
    pub(crate) fn precision(&self, variances: &Variances, plan: &Plan) -> f64 {
        1.0 / (variances.of_mean(plan) + (LEAST * self.floor).powi(2))
    }

    /// Adds a round of rays, which has this precision (0 for a first one). `start` gives the point, the normal and the place as before.
    pub(crate) fn go_on(
        &self,
        (point, normal, place): (DVec3, DVec3, u64),
        (plan, precision): (&Plan, f64),
        gathered: &mut Gathered,
    ) {
        let transport = self.solution.transport;
        let hemisphere = Hemisphere::new(normal);
        let (mut light, mut near) = ([0.0; 3], 0.0);
        for (part, &rays) in plan.iter().enumerate() {
            let sequence = Sequence::new(place ^ mix(part as u64));
            let first = gathered.parts.rays(part);
            let weight = 1.0 / (PARTS as f64 * f64::from(rays));
            for k in first..first + rays {
                let direction = hemisphere.direction(within(part, sequence.pair(k)));
                let met = transport.around.patch(point, direction);
                let seen = match met {
                    Some((patch, _)) if patch != NONE => self.solution.seen[patch as usize],
                    _ => [0.0; 3],
                };
                near += met.map_or(0.0, |(_, distance)| weight / distance.max(SHORT));
                gathered.parts.add(part, mean(seen));
                light = add(light, weight, seen);
            }
            gathered.rays += rays;
        }
        gathered.take(light, near, precision);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::by_rays::RayTransport;
    use crate::by_rays::parts::even;
    use crate::{RadiosityError, RayOptions, Scene, SceneOptions, SolveOptions, Surface};
    use glam::dvec3;

    /// A room with a screen in it, whose floor is in the sun in one place.
    fn room() -> Result<RayTransport, RadiosityError> {
        let [a, b, c, d] = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(x, y)| dvec3(x, y, 0.0));
        let up = |p: DVec3, height: f64| p + DVec3::Z * height;
        let wall = |p: DVec3, q: DVec3, height: f64| [q, p, up(p, height), up(q, height)];
        let whole = |p: DVec3, q: DVec3| wall(p, q, 0.7);
        let ceiling = [d, c, b, a].map(|p| up(p, 0.7));
        let screen = wall(dvec3(0.45, 0.2, 0.0), dvec3(0.55, 0.8, 0.0), 0.4);
        let faces = [[a, b, c, d], ceiling, whole(a, b), whole(b, c), whole(c, d), whole(d, a), screen];
        let surfaces = faces.map(|ring| Surface::new(&ring, [0.5; 3]).two_sided());
        let scene = Scene::new(&surfaces, &SceneOptions::for_rays(0.1))?;
        let mut transport = scene.transport_by_rays(&[], &RayOptions::DEFAULT, &|_| ())?;
        let sunny = |p: DVec3| p.z == 0.0 && (0.6..0.8).contains(&p.x) && (0.1..0.4).contains(&p.y);
        let lit: Vec<Rgb> =
            transport.patches().map(|p| [f64::from(u8::from(sunny(p.centre))) * 10.0; 3]).collect();
        assert!(lit.iter().filter(|l| l[0] > 0.0).count() > 2);
        transport.set_direct(&lit)?;
        Ok(transport)
    }

    /// The error that places are believed to have after doublings of the first rays, and the one they have against many more: root mean squares.
    fn believed_and_true(doublings: u32) -> Result<[f64; 2], RadiosityError> {
        let transport = room()?;
        let solution = transport.solve(&SolveOptions::DEFAULT)?;
        let gatherer = Gatherer::new(&solution);
        let mut squares = [0.0; 2];
        for (i, &leaf) in transport.leaves.iter().enumerate().step_by(7) {
            let polygon = &transport.scene.tree.elements[leaf as usize].polygon;
            let place = |number: usize| {
                (polygon.centre() + 1e-6 * polygon.normal(), polygon.normal(), mix(number as u64))
            };
            let even_ones = |place: (DVec3, DVec3, u64), rays: u32| {
                let mut own = gatherer.start(place.0, place.1, place.2);
                gatherer.go_on(place, (&even(rays), 0.0), &mut own);
                own
            };
            // In the place of neighbours.
            let seen = even_ones(place(i + 50_000), 8 * FIRST).parts.variances();
            let truth = even_ones(place(i + 100_000), 1 << 14);
            let mut own = even_ones(place(i), FIRST);
            own.weigh_first(gatherer.precision(&seen, &even(FIRST)));
            for _ in 0..doublings {
                let plan = seen.plan(own.rays());
                gatherer.go_on(place(i), (&plan, gatherer.precision(&seen, &plan)), &mut own);
            }
            squares[0] += own.variance();
            squares[1] += (mean(own.light()) - mean(truth.light())).powi(2);
        }
        Ok(squares.map(f64::sqrt))
    }

    #[test]
    fn errors_are_as_they_are_believed_to_be() -> Result<(), RadiosityError> {
        for doublings in 2..=6 {
            let [believed, error] = believed_and_true(doublings)?;
            assert!((0.5..=1.2).contains(&(error / believed)), "{error} for {believed}");
        }
        Ok(())
    }
}
