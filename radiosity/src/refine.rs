//! Which elements exchange light, and how finely they must be divided for it (\[3\]).

use std::sync::atomic::{AtomicUsize, Ordering};

use crate::error::RadiosityError;
use crate::estimate::Estimate;
use crate::factor::FactorOptions;
use crate::kept::Kept;
use crate::kernel::pair::{self, Rule, facing_parts};
use crate::link::{Link, LinkCounts};
use crate::polygon::Polygon;
use crate::rgb::Rgb;
use crate::scene::Scene;
use crate::tree::{Element, ElementId};
use crate::visible::cubature;
use crate::visible::parts::{Eye, Pieces, Source};
use crate::visible::shaft::Shaft;
use pointillist_dice::lambert;
use pointillist_parallel as parallel;

/// The irradiance at corners is evaluated at points moved towards the centre by this share of the way: on an edge that two walls share,
/// the share of the other wall is discontinuous.
const INWARD: f64 = 0.1;
/// Share of a link's tolerance that the error of its form factor may use up.
const FACTOR_SHARE: f64 = 0.3;
/// Assumed variation of the radiosity over a source, as a share of its mean.
const UNEVEN: f64 = 0.05;
/// A link is too coarse, whatever its radiosity, if the share of the hemisphere that one element takes varies over the other by more than
/// this: sums of rows would exceed 1 by too much.
const ROUGHEST: f64 = 0.15;

/// The result of refinement: all links.
#[derive(Debug, Default)]
pub(crate) struct Found {
    pub(crate) links: Vec<Link>,
    /// Lists of occluders, into which [`Link::between`] points.
    pub(crate) between: Vec<u32>,
    /// Sum of the form factors of each element that were below the bound.
    pub(crate) lost: Vec<f64>,
    pub(crate) counts: LinkCounts,
}

/// A pair that needs one of its elements divided first.
#[derive(Debug)]
struct Wanted {
    pair: (ElementId, ElementId),
    which: ElementId,
    /// Occluders that may be between the two.
    between: Vec<u32>,
}

/// What is known of each element before there are links; it grows with the tree.
#[derive(Debug)]
pub(crate) struct Given {
    /// Irradiance that does not come from patches.
    pub(crate) direct: Vec<Rgb>,
    /// How much errors of the light there count, above 0 to 1; empty if they count the same everywhere.
    pub(crate) weights: Vec<f64>,
}

/// What one task finds.
#[derive(Debug, Default)]
struct Task {
    links: Vec<Link>,
    between: Vec<u32>,
    wanted: Vec<Wanted>,
    left_out: Vec<(ElementId, f64)>,
    counts: LinkCounts,
}

impl Found {
    /// Appends the links and counts of a task; returns the pairs that it put aside.
    fn take(&mut self, task: Task) -> Vec<Wanted> {
        let shift = self.between.len() as u32;
        let moved = |l: Link| Link { between: (l.between.0 + shift, l.between.1 + shift), ..l };
        self.links.extend(task.links.into_iter().map(moved));
        self.between.extend(task.between);
        self.counts += task.counts;
        for (element, share) in task.left_out {
            self.lost[element as usize] += share;
        }
        task.wanted
    }
}

/// Pairs of elements that exchange light, found level by level.
///
/// 1. Each pair of roots is visited: pairs that face apart, are black or hidden are skipped, good ones are linked, rough ones are divided.
/// 2. Where that needs an element divided that is still a leaf, the pair is put aside.
/// 3. Those leaves are divided, and the pairs put aside are visited again, until none is left.
///
/// Tasks run in parallel and are taken together in their order, so that links do not depend on threads.
/// Form factors that are `kept` are not computed again; `done` is told the share of the work that is done.
pub(crate) fn refine(
    scene: &mut Scene,
    given: &mut Given,
    kept: Option<&Kept<'_>>,
    done: &(dyn Fn(f64) + Sync),
) -> Result<Found, RadiosityError> {
    let estimate = Estimate::new(scene, &given.direct);
    let mut all = Found::default();
    all.lost.resize(scene.tree.elements.len(), 0.0);
    let roots = scene.tree.roots.clone();
    let refiner = Refiner { scene, estimate: &estimate, weights: &given.weights, kept };
    let told = Rounds::new(done, roots.len());
    let mut round: Vec<Task> = parallel::map_with(roots.len(), Pieces::default, |pieces, i| {
        let mut task = Task::default();
        for &q in &roots[i + 1..] {
            refiner.roots(roots[i], q, &mut task, pieces);
        }
        told.one_more();
        task
    });
    let mut number = 0;
    loop {
        let mut wanted = vec![];
        for task in round {
            wanted.extend(all.take(task));
        }
        let divided = divide_wanted(scene, &wanted, given)?;
        if wanted.is_empty() {
            return Ok(all);
        }
        all.lost.resize(scene.tree.elements.len(), 0.0);
        let refiner = Refiner { scene, estimate: &estimate, weights: &given.weights, kept };
        number += 1;
        let told = Rounds { number, ..Rounds::new(done, wanted.len()) };
        round = parallel::map_with(wanted.len(), Pieces::default, |pieces, i| {
            let mut task = Task::default();
            let Wanted { pair, which, between } = &wanted[i];
            // Elements that cannot be divided any further are linked as they are.
            let last = !divided || scene.tree.elements[*which as usize].is_leaf();
            refiner.visit(*pair, between, last, &mut task, pieces);
            told.one_more();
            task
        });
    }
}

/// Progress of a round. How many there will be nobody knows: each is taken for half of what is left.
struct Rounds<'d> {
    done: &'d (dyn Fn(f64) + Sync),
    number: i32,
    tasks: usize,
    ended: AtomicUsize,
}

impl<'d> Rounds<'d> {
    fn new(done: &'d (dyn Fn(f64) + Sync), tasks: usize) -> Self {
        Self { done, number: 0, tasks, ended: AtomicUsize::new(0) }
    }

    fn one_more(&self) {
        let share = (self.ended.fetch_add(1, Ordering::Relaxed) + 1) as f64 / self.tasks as f64;
        let left = 0.5_f64.powi(self.number);
        (self.done)(1.0 - left + 0.5 * left * share);
    }
}

/// Divides the elements that pairs wait for; returns whether any of them has parts now.
fn divide_wanted(scene: &mut Scene, wanted: &[Wanted], given: &mut Given) -> Result<bool, RadiosityError> {
    let mut any = false;
    for &Wanted { which, .. } in wanted {
        if scene.tree.elements[which as usize].is_leaf() && scene.tree.divide(which) {
            any = true;
            let (count, which) = (scene.tree.elements.len(), which as usize);
            given.direct.resize(count, given.direct[which]);
            if let Some(&weight) = given.weights.get(which) {
                given.weights.resize(count, weight);
            }
        }
        any |= !scene.tree.elements[which as usize].is_leaf();
    }
    if scene.tree.elements.len() > scene.options.max_elements {
        return Err(RadiosityError::TooManyPatches { limit: scene.options.max_elements });
    }
    Ok(any)
}

/// Visits pairs of elements.
struct Refiner<'s> {
    scene: &'s Scene,
    estimate: &'s Estimate,
    weights: &'s [f64],
    kept: Option<&'s Kept<'s>>,
}

impl Refiner<'_> {
    fn element(&self, id: ElementId) -> &Element {
        &self.scene.tree.elements[id as usize]
    }

    /// Estimated radiosity of an element.
    fn radiosity(&self, id: ElementId) -> f64 {
        self.estimate.of_side[self.element(id).side as usize]
    }

    /// How much an error of the light on an element counts.
    fn weight(&self, id: ElementId) -> f64 {
        self.weights.get(id as usize).copied().unwrap_or(1.0)
    }

    fn roots(&self, p: ElementId, q: ElementId, found: &mut Task, pieces: &mut Pieces) {
        let (a, b) = (self.element(p), self.element(q));
        let sides = [a.side, b.side].map(|s| &self.scene.sides[s as usize]);
        if sides.iter().any(|s| s.is_black()) {
            found.counts.black += 1;
            return;
        }
        if facing_parts(&a.polygon, &b.polygon).is_none() {
            found.counts.facing_apart += 1;
            return;
        }
        let shaft = Shaft::new(&a.polygon, &b.polygon).with_planes();
        let list = self.scene.boxes.in_shaft(&shaft, &self.scene.occluders);
        self.visit((p, q), &list, false, found, pieces);
    }

    /// Links the two, or parts of them. `last`: as they are.
    fn visit(
        &self,
        (p, q): (ElementId, ElementId),
        list: &[u32],
        last: bool,
        found: &mut Task,
        pieces: &mut Pieces,
    ) {
        let (a, b) = (self.element(p), self.element(q));
        if facing_parts(&a.polygon, &b.polygon).is_none() {
            found.counts.facing_apart += 1;
            return;
        }
        let mut shaft = Shaft::new(&a.polygon, &b.polygon);
        let of = |i: u32| &self.scene.occluders[i as usize];
        // The box decides most cases, at less cost than the planes.
        let mut between: Vec<u32> = list.iter().copied().filter(|&i| shaft.may_hold(of(i))).collect();
        if !between.is_empty() {
            shaft = shaft.with_planes();
            between.retain(|&i| shaft.may_hold(of(i)));
            if between.iter().any(|&i| shaft.is_blocked_by(of(i))) {
                found.counts.hidden += 1;
                return;
            }
        }
        let choice = if last { None } else { self.divide_which((p, q), &between, pieces) };
        match choice {
            None => self.link((p, q), &between, found, pieces),
            Some(first) => {
                let (which, other) = if first { (p, q) } else { (q, p) };
                if self.element(which).is_leaf() {
                    found.wanted.push(Wanted { pair: (p, q), which, between });
                    return;
                }
                for child in self.element(which).children() {
                    self.visit((child, other), &between, false, found, pieces);
                }
            }
        }
    }

    /// Whether to divide the first, the second, or neither.
    fn divide_which(
        &self,
        (p, q): (ElementId, ElementId),
        between: &[u32],
        pieces: &mut Pieces,
    ) -> Option<bool> {
        let (a, b) = (self.element(p), self.element(q));
        let smallest = self.scene.options.smallest_patch * self.scene.scale;
        if self.scene.options.tolerance.is_none() {
            return match (a.is_leaf(), b.is_leaf()) {
                (true, true) => None,
                (false, false) => Some(a.size >= b.size),
                (a_is_leaf, _) => Some(!a_is_leaf),
            };
        }
        let can = |e: &Element| !e.is_leaf() || e.size > smallest;
        let (can_a, can_b) = (can(a), can(b));
        if !(can_a || can_b) || !self.is_too_rough((p, q), between, pieces) {
            return None;
        }
        Some(if can_a && can_b { a.size >= b.size } else { can_a })
    }

    /// Whether the light on either varies by more than is allowed.
    fn is_too_rough(&self, (p, q): (ElementId, ElementId), between: &[u32], pieces: &mut Pieces) -> bool {
        let allowed = self.estimate.allowed;
        [(p, q), (q, p)].into_iter().any(|(to, from)| {
            let radiosity = self.weight(to) * self.radiosity(from);
            let (receiver, source) = (self.element(to), self.element(from));
            let gap = (receiver.polygon.centre() - source.polygon.centre()).length()
                - receiver.polygon.radius()
                - source.polygon.radius();
            // Upper bound on the share of the hemisphere.
            let most = source.polygon.area() / (std::f64::consts::PI * gap * gap);
            if gap > 0.0 && radiosity * most < allowed && most < ROUGHEST {
                return false;
            }
            let (least, most) = self.shares(&receiver.polygon, &source.polygon, between, pieces);
            most - least > ROUGHEST
                || radiosity * (most - least) > allowed
                || radiosity * UNEVEN * most > allowed
        })
    }

    /// Smallest and largest share of the source seen from the receiver's corners and centre.
    fn shares(
        &self,
        receiver: &Polygon,
        source: &Polygon,
        between: &[u32],
        pieces: &mut Pieces,
    ) -> (f64, f64) {
        let centre = receiver.centre();
        let points = receiver.vertices().iter().map(|v| v.lerp(centre, INWARD)).chain([centre]);
        let flat = (!between.is_empty()).then(|| Source::new(source));
        let (mut least, mut most) = (f64::MAX, 0.0_f64);
        for p in points {
            let share = if source.height(p) <= 0.0 {
                0.0
            } else if let Some(flat) = &flat {
                let list = between.iter().map(|&i| &self.scene.occluders[i as usize]);
                let (seen, _) = flat.see(Eye::Point(p), list, pieces);
                flat.share(p, receiver.normal(), seen)
            } else {
                lambert::share_above_horizon(p, receiver.normal(), source.vertices())
            };
            least = least.min(share.max(0.0));
            most = most.max(share);
        }
        (least, most)
    }

    fn link(&self, (p, q): (ElementId, ElementId), between: &[u32], found: &mut Task, pieces: &mut Pieces) {
        let (a, b) = (self.element(p), self.element(q));
        let smaller = a.polygon.area().min(b.polygon.area());
        let goal = self.accuracy(p, q).goal(smaller, 0);
        let mutual = if between.is_empty() {
            pair::mutual(&a.polygon, &b.polygon, goal.unoccluded)
        } else {
            if let Some(link) = self.kept.and_then(|kept| kept.link(&a.polygon, &b.polygon, between)) {
                found.counts.kept += 1;
                return self.push((p, q), (link.mutual, link.error), between, found);
            }
            let list: Vec<&Polygon> = between.iter().map(|&i| &self.scene.occluders[i as usize]).collect();
            let (mutual, work) = cubature::mutual_in_shaft(&a.polygon, &b.polygon, &list, goal, pieces);
            found.counts.cells += work.cells;
            mutual
        };
        if mutual.value <= 0.0 {
            found.counts.hidden += 1;
            return;
        }
        if between.is_empty() {
            match mutual.rule {
                Rule::Areas => found.counts.by_rule.areas += 1,
                Rule::Points => found.counts.by_rule.points += 1,
                Rule::Contours | Rule::Apart => found.counts.by_rule.contours += 1,
            }
        }
        self.push((p, q), (mutual.value, mutual.error), between, found);
    }

    /// Adds a link, unless its form factors are below the bound.
    fn push(
        &self,
        (p, q): (ElementId, ElementId),
        (mutual, error): (f64, f64),
        between: &[u32],
        found: &mut Task,
    ) {
        let factors = [p, q].map(|e| (mutual / self.element(e).polygon.area()).min(1.0));
        if factors.iter().all(|&f| f < self.scene.options.least_factor) {
            found.counts.below_bound += 1;
            found.left_out.extend([(p, factors[0]), (q, factors[1])]);
            return;
        }
        found.counts.links += 1;
        found.counts.partly_hidden += usize::from(!between.is_empty());
        let start = found.between.len() as u32;
        found.between.extend(between);
        let end = found.between.len() as u32;
        found.links.push(Link { a: p, b: q, mutual, error, between: (start, end) });
    }

    /// In a hierarchy form factors need no smaller error than the tolerance of links.
    fn accuracy(&self, p: ElementId, q: ElementId) -> FactorOptions {
        let options = self.scene.options.factors;
        if self.scene.options.tolerance.is_none() {
            return options;
        }
        let radiosity = [(p, q), (q, p)]
            .map(|(to, from)| self.weight(to) * self.radiosity(from))
            .into_iter()
            .fold(0.0, f64::max);
        let enough = FACTOR_SHARE * self.estimate.allowed / radiosity.max(f64::MIN_POSITIVE);
        options
            .with_absolute(enough.clamp(options.absolute, 1.0))
            .with_unoccluded(options.unoccluded.max(1e-6))
    }
}
