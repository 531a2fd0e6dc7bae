//! Which patches see which, and how well: links, on all levels of the tree.

use glam::DVec3;

use crate::error::RadiosityError;
use crate::factor::{FactorOptions, of_mutual};
use crate::kernel::lambert;
use crate::kernel::pair::{self, Rule, facing_parts};
use crate::lamp::check_direct;
use crate::polygon::Polygon;
use crate::scene::Scene;
use crate::solve::{Solution, add};
use crate::surface::Rgb;
use crate::tree::{Element, ElementId};
use crate::visible::boxes::Boxes;
use crate::visible::cubature;
use crate::visible::parts::{Eye, Pieces, Source};
use crate::visible::shaft::Shaft;
use pointillist_parallel as parallel;

/// How far towards the centre corners are moved when the light on them is compared: on an edge that two walls share, the share of
/// the other wall jumps.
const INWARD: f64 = 0.1;
/// Of what a link is allowed to be off, the share that its form factor may be.
const FACTOR_SHARE: f64 = 0.1;
/// How uneven a source's radiosity is taken to be, as a share of it.
const UNEVEN: f64 = 0.05;
/// Where the share of the other varies by more than this, light or no light, a link is too rough: rows would add up to too much.
const ROUGHEST: f64 = 0.15;

/// An exchange between two elements.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Link {
    pub(crate) a: ElementId,
    pub(crate) b: ElementId,
    /// Area of `a` times form factor from it to `b`, and the same the other way; in scene units.
    pub(crate) mutual: f64,
    /// Absolute error of `mutual`.
    pub(crate) error: f64,
    /// Range of the list of occluders; empty where nothing is between.
    pub(crate) between: (u32, u32),
}

/// Rows above 1 by no more than this stay as they are: errors of single factors, which keep the balance of energy exact.
const LEAST_EXCESS: f64 = 1e-3;

/// What was skipped and why, and what was done.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct LinkCounts {
    /// Links: pairs of patches, or of groups of them, that exchange light.
    pub links: usize,
    /// Of them, with something between.
    pub partly_hidden: usize,
    /// Unoccluded links by quadrature over both areas, by Lambert's formula at points of one, and by contours.
    pub by_rule: [usize; 3],
    /// Pairs that face apart.
    pub facing_apart: usize,
    /// Pairs of which one neither emits nor reflects.
    pub black: usize,
    /// Pairs hidden from each other by a single surface.
    pub hidden: usize,
    /// Pairs whose form factors are below the bound.
    pub below_bound: usize,
    /// The largest sum of form factors that any patch lost to that bound.
    pub left_out: f64,
    /// The largest amount by which the form factors of any patch add up to more than 1, before any scaling.
    pub row_excess: f64,
    /// The largest relative amount by which a row was scaled so that none adds up to more than 1.
    pub row_change: f64,
    /// Cells that were sampled to find what partly hidden pairs exchange.
    pub cells: usize,
}

impl std::ops::AddAssign for LinkCounts {
    fn add_assign(&mut self, o: Self) {
        self.links += o.links;
        self.partly_hidden += o.partly_hidden;
        for (rule, more) in self.by_rule.iter_mut().zip(o.by_rule) {
            *rule += more;
        }
        self.facing_apart += o.facing_apart;
        self.black += o.black;
        self.hidden += o.hidden;
        self.below_bound += o.below_bound;
        self.cells += o.cells;
    }
}

/// A scene with its links.
#[derive(Clone, Debug)]
pub struct Transport {
    pub(crate) scene: Scene,
    pub(crate) links: Vec<Link>,
    pub(crate) between: Vec<u32>,
    /// Where each element's row starts.
    pub(crate) starts: Vec<usize>,
    /// Link and form factor from the row's element to the other.
    pub(crate) entries: Vec<Entry>,
    pub(crate) leaves: Vec<ElementId>,
    pub(crate) boxes: Boxes,
    /// What each element is a quarter of.
    pub(crate) parents: Vec<Option<ElementId>>,
    /// What the row of each patch is multiplied by.
    pub(crate) scale: Vec<f64>,
    counts: LinkCounts,
}

/// What one patch is.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Patch {
    /// Its place in all lists about patches.
    pub index: usize,
    /// Which surface it is a part of.
    pub surface: usize,
    /// Whether it is on the surface's back.
    pub back: bool,
    /// Mean of its corners, in the scene's coordinates.
    pub centre: DVec3,
    /// In squared units of the scene.
    pub area: f64,
    /// Of its surface.
    pub reflectance: Rgb,
    /// Of its surface.
    pub emission: Rgb,
}

/// One form factor of a row.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    pub(crate) to: ElementId,
    pub(crate) link: u32,
    pub(crate) factor: f64,
}

/// What one task finds.
#[derive(Debug, Default)]
struct Found {
    links: Vec<Link>,
    between: Vec<u32>,
    /// Pairs that need `.2` divided first.
    wanted: Vec<(ElementId, ElementId, ElementId, Vec<u32>)>,
    left_out: Vec<(ElementId, f64)>,
    counts: LinkCounts,
}

impl Scene {
    /// Links what exchanges light. `direct` is the irradiance of each patch that does not come from patches, as
    /// [`Scene::direct`] gives it, or empty for none; it tells where light will be and so where links must be fine.
    ///
    /// Without a tolerance ([`SceneOptions::tolerance`](crate::SceneOptions::tolerance)) every pair of patches gets its link. With one, patches are
    /// linked as large as it permits (\[3\]), and divided down to the smallest size where it asks for that.
    ///
    /// # Errors
    /// [`RadiosityError::CountMismatch`] and [`RadiosityError::DirectIrradiance`] for `direct`, [`RadiosityError::TooManyPatches`].
    pub fn transport(mut self, direct: &[Rgb]) -> Result<(Transport, Vec<Rgb>), RadiosityError> {
        let leaves = self.tree.leaves();
        check_direct(leaves.len(), direct)?;
        let mut of_element = vec![[0.0; 3]; self.tree.elements.len()];
        for (&leaf, light) in leaves.iter().zip(direct) {
            of_element[leaf as usize] = *light;
        }
        let boxes = Boxes::new(&self.occluders);
        let radiosity = Estimate::new(&self, &of_element);
        let mut all = Found::default();
        let mut lost = vec![0.0; self.tree.elements.len()];
        let roots = self.tree.roots.clone();
        let refiner = Refiner { scene: &self, estimate: &radiosity, boxes: &boxes };
        let mut round: Vec<Found> = parallel::map_with(roots.len(), Pieces::default, |pieces, i| {
            let mut found = Found::default();
            for &q in &roots[i + 1..] {
                refiner.roots(roots[i], q, &mut found, pieces);
            }
            found
        });
        loop {
            let mut wanted = vec![];
            for found in round {
                wanted.extend(all.take(found, &mut lost));
            }
            let divided = self.divide_wanted(&wanted, &mut of_element)?;
            if wanted.is_empty() {
                break;
            }
            lost.resize(self.tree.elements.len(), 0.0);
            let refiner = Refiner { scene: &self, estimate: &radiosity, boxes: &boxes };
            round = parallel::map_with(wanted.len(), Pieces::default, |pieces, i| {
                let mut found = Found::default();
                let (p, q, which, list) = &wanted[i];
                // What cannot be divided any further is linked as it is.
                let last = !divided || self.tree.elements[*which as usize].is_leaf();
                refiner.visit((*p, *q), list, last, &mut found, pieces);
                found
            });
        }
        Ok(Transport::assemble(self, all, boxes, (&lost, &of_element)))
    }

    fn divide_wanted(
        &mut self,
        wanted: &[(ElementId, ElementId, ElementId, Vec<u32>)],
        direct: &mut Vec<Rgb>,
    ) -> Result<bool, RadiosityError> {
        let mut any = false;
        for &(_, _, which, _) in wanted {
            if self.tree.elements[which as usize].is_leaf() && self.tree.divide(which) {
                any = true;
                direct.resize(self.tree.elements.len(), direct[which as usize]);
            }
            any |= !self.tree.elements[which as usize].is_leaf();
        }
        if self.tree.elements.len() > self.options.max_elements {
            return Err(RadiosityError::TooManyPatches { limit: self.options.max_elements });
        }
        Ok(any)
    }
}

impl Found {
    /// Appends another task's; gives back what that wants divided.
    fn take(&mut self, other: Self, lost: &mut [f64]) -> Vec<(ElementId, ElementId, ElementId, Vec<u32>)> {
        let shift = self.between.len() as u32;
        self.links.extend(
            other.links.iter().map(|l| Link { between: (l.between.0 + shift, l.between.1 + shift), ..*l }),
        );
        self.between.extend(other.between);
        self.counts += other.counts;
        for (element, share) in other.left_out {
            lost[element as usize] += share;
        }
        other.wanted
    }
}

/// What radiosity to expect, before any is known.
#[derive(Debug)]
struct Estimate {
    /// Of each side, the largest band.
    of_side: Vec<f64>,
    /// What a link may be off.
    allowed: f64,
}

impl Estimate {
    /// Emission, reflected direct light, and an even ambient of all that was reflected before (\[2\], eq. 8).
    fn new(scene: &Scene, direct: &[Rgb]) -> Self {
        let largest = |v: Rgb| v.into_iter().fold(0.0, f64::max);
        let mut first = vec![0.0_f64; scene.sides.len()];
        let (mut area, mut power, mut reflected) = (0.0, 0.0, 0.0);
        for leaf in scene.tree.leaves() {
            let element = &scene.tree.elements[leaf as usize];
            let side = &scene.sides[element.side as usize];
            let reflectance = largest(side.reflectance);
            let radiosity = largest(side.emission) + reflectance * largest(direct[leaf as usize]);
            let of_side = &mut first[element.side as usize];
            *of_side = of_side.max(radiosity);
            area += element.polygon.area();
            power += element.polygon.area() * radiosity;
            reflected += element.polygon.area() * reflectance;
        }
        let mean_reflectance = (reflected / area).min(0.95);
        let ambient = power / area / (1.0 - mean_reflectance);
        let of_side = first
            .iter()
            .zip(&scene.sides)
            .map(|(radiosity, side)| radiosity + largest(side.reflectance) * ambient)
            .collect();
        let allowed = scene.options.tolerance.unwrap_or(0.0) * (power / area).max(ambient * mean_reflectance);
        Self { of_side, allowed }
    }
}

struct Refiner<'s> {
    scene: &'s Scene,
    estimate: &'s Estimate,
    boxes: &'s Boxes,
}

impl Refiner<'_> {
    fn element(&self, id: ElementId) -> &Element {
        &self.scene.tree.elements[id as usize]
    }

    fn roots(&self, p: ElementId, q: ElementId, found: &mut Found, pieces: &mut Pieces) {
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
        let list = self.boxes.in_shaft(&shaft, &self.scene.occluders);
        self.visit((p, q), &list, false, found, pieces);
    }

    /// Links the two, or parts of them. `last`: as they are.
    fn visit(
        &self,
        (p, q): (ElementId, ElementId),
        list: &[u32],
        last: bool,
        found: &mut Found,
        pieces: &mut Pieces,
    ) {
        let (a, b) = (self.element(p), self.element(q));
        if facing_parts(&a.polygon, &b.polygon).is_none() {
            found.counts.facing_apart += 1;
            return;
        }
        let mut shaft = Shaft::new(&a.polygon, &b.polygon);
        let of = |i: u32| &self.scene.occluders[i as usize];
        // Most is told by the box already.
        let mut between: Vec<u32> = list.iter().copied().filter(|&i| shaft.may_hold(of(i))).collect();
        if !between.is_empty() {
            shaft = shaft.with_planes();
            between.retain(|&i| shaft.may_hold(of(i)));
            if between.iter().any(|&i| shaft.is_blocked_by(of(i))) {
                found.counts.hidden += 1;
                return;
            }
        }
        let choice = if last { None } else { self.divide_which(a, b, &between, pieces) };
        match choice {
            None => self.link((p, q), &between, found, pieces),
            Some(first) => {
                let (which, other) = if first { (p, q) } else { (q, p) };
                if self.element(which).is_leaf() {
                    found.wanted.push((p, q, which, between));
                    return;
                }
                for child in self.element(which).children() {
                    self.visit((child, other), &between, false, found, pieces);
                }
            }
        }
    }

    /// Whether to divide the first, the second, or neither.
    fn divide_which(&self, a: &Element, b: &Element, between: &[u32], pieces: &mut Pieces) -> Option<bool> {
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
        if !(can_a || can_b) || !self.is_too_rough(a, b, between, pieces) {
            return None;
        }
        Some(if can_a && can_b { a.size >= b.size } else { can_a })
    }

    /// Whether the light on either varies by more than is allowed.
    fn is_too_rough(&self, a: &Element, b: &Element, between: &[u32], pieces: &mut Pieces) -> bool {
        let allowed = self.estimate.allowed;
        [(a, b), (b, a)].into_iter().any(|(receiver, source)| {
            let radiosity = self.estimate.of_side[source.side as usize];
            let gap = (receiver.polygon.centre() - source.polygon.centre()).length()
                - receiver.polygon.radius()
                - source.polygon.radius();
            // At most this much of the hemisphere.
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

    fn link(&self, (p, q): (ElementId, ElementId), between: &[u32], found: &mut Found, pieces: &mut Pieces) {
        let (a, b) = (self.element(p), self.element(q));
        let smaller = a.polygon.area().min(b.polygon.area());
        let goal = self.accuracy(a, b).goal(smaller, 0);
        let mutual = if between.is_empty() {
            pair::mutual(&a.polygon, &b.polygon, goal.unoccluded)
        } else {
            let list: Vec<&Polygon> = between.iter().map(|&i| &self.scene.occluders[i as usize]).collect();
            let (mutual, work) = cubature::mutual_in_shaft(&a.polygon, &b.polygon, &list, goal, pieces);
            found.counts.cells += work.cells;
            mutual
        };
        if mutual.value <= 0.0 {
            found.counts.hidden += 1;
            return;
        }
        let factors = [a, b].map(|e| of_mutual(mutual, e.polygon.area()).value);
        if factors.iter().all(|&f| f < self.scene.options.least_factor) {
            found.counts.below_bound += 1;
            found.left_out.extend([(p, factors[0]), (q, factors[1])]);
            return;
        }
        found.counts.links += 1;
        if between.is_empty() {
            match mutual.rule {
                Rule::Areas => found.counts.by_rule[0] += 1,
                Rule::Points => found.counts.by_rule[1] += 1,
                Rule::Contours | Rule::Apart => found.counts.by_rule[2] += 1,
            }
        } else {
            found.counts.partly_hidden += 1;
        }
        let start = found.between.len() as u32;
        found.between.extend(between);
        let end = found.between.len() as u32;
        found.links.push(Link {
            a: p,
            b: q,
            mutual: mutual.value,
            error: mutual.error,
            between: (start, end),
        });
    }

    /// In a hierarchy form factors need not be better than links.
    fn accuracy(&self, a: &Element, b: &Element) -> FactorOptions {
        let options = self.scene.options.factors;
        if self.scene.options.tolerance.is_none() {
            return options;
        }
        let radiosity =
            [a, b].map(|e| self.estimate.of_side[e.side as usize]).into_iter().fold(0.0, f64::max);
        let enough = FACTOR_SHARE * self.estimate.allowed / radiosity.max(f64::MIN_POSITIVE);
        options
            .with_absolute(enough.clamp(options.absolute, 1.0))
            .with_unoccluded(options.unoccluded.max(1e-6))
    }
}

impl Transport {
    /// Of links between leaves that were found elsewhere; what is between is looked up where it is needed.
    pub(crate) fn of_links(scene: Scene, links: Vec<Link>, direct: &[Rgb]) -> (Self, Vec<Rgb>) {
        let boxes = Boxes::new(&scene.occluders);
        let mut found = Found { links, ..Found::default() };
        found.counts.links = found.links.len();
        for link in &mut found.links {
            let [a, b] = [link.a, link.b].map(|e| &scene.tree.elements[e as usize].polygon);
            let list = boxes.in_shaft(&Shaft::new(a, b).with_planes(), &scene.occluders);
            let start = found.between.len() as u32;
            found.between.extend(list);
            link.between = (start, found.between.len() as u32);
            found.counts.partly_hidden += usize::from(link.between.1 > start);
        }
        let lost = vec![0.0; scene.tree.elements.len()];
        Self::assemble(scene, found, boxes, (&lost, direct))
    }

    fn assemble(
        scene: Scene,
        found: Found,
        boxes: Boxes,
        (lost, direct): (&[f64], &[Rgb]),
    ) -> (Self, Vec<Rgb>) {
        let count = scene.tree.elements.len();
        let mut starts = vec![0; count + 1];
        for link in &found.links {
            starts[link.a as usize + 1] += 1;
            starts[link.b as usize + 1] += 1;
        }
        for i in 0..count {
            starts[i + 1] += starts[i];
        }
        let mut next = starts.clone();
        let mut entries = vec![Entry { to: 0, link: 0, factor: 0.0 }; found.links.len() * 2];
        for (number, link) in found.links.iter().enumerate() {
            for (from, to) in [(link.a, link.b), (link.b, link.a)] {
                let factor = link.mutual / scene.tree.elements[from as usize].polygon.area();
                entries[next[from as usize]] = Entry { to, link: number as u32, factor };
                next[from as usize] += 1;
            }
        }
        let leaves = scene.tree.leaves();
        let mut counts = found.counts;
        counts.left_out = lost.iter().copied().fold(0.0, f64::max);
        let direct = leaves.iter().map(|&leaf| direct[leaf as usize]).collect();
        let mut parents = vec![None; count];
        for (i, element) in scene.tree.elements.iter().enumerate() {
            element.children().for_each(|child| parents[child as usize] = Some(i as u32));
        }
        let Found { links, between, .. } = found;
        let scale = vec![1.0; leaves.len()];
        let mut transport =
            Self { scene, links, between, starts, entries, leaves, boxes, parents, scale, counts };
        let sums = transport.row_sums();
        transport.counts.row_excess = sums.into_iter().fold(0.0, |m, s| m.max(s - 1.0));
        if transport.counts.row_excess > LEAST_EXCESS {
            transport.counts.row_change = transport.even_rows();
        }
        (transport, direct)
    }

    /// The scene, with what refinement divided.
    #[must_use]
    pub const fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Links and skips.
    #[must_use]
    pub const fn counts(&self) -> LinkCounts {
        self.counts
    }

    /// How many patches there are: leaves of the tree.
    #[must_use]
    pub fn patch_count(&self) -> usize {
        self.leaves.len()
    }

    /// The patches, in the order in which all lists about patches are.
    pub fn patches(&self) -> impl Iterator<Item = Patch> + '_ {
        let unit2 = self.scene.scale * self.scene.scale;
        self.leaves.iter().enumerate().map(move |(index, &leaf)| {
            let element = &self.scene.tree.elements[leaf as usize];
            let side = &self.scene.sides[element.side as usize];
            Patch {
                index,
                surface: side.surface,
                back: side.back,
                centre: self.scene.outward(element.polygon.centre()),
                area: element.polygon.area() / unit2,
                reflectance: side.reflectance,
                emission: side.emission,
            }
        })
    }

    /// Corners of the patches, in their order, in the scene's coordinates.
    pub fn patch_corners(&self) -> impl Iterator<Item = Vec<DVec3>> + '_ {
        let corners = |&leaf: &ElementId| {
            let ring = self.scene.tree.elements[leaf as usize].polygon.vertices();
            ring.iter().map(|&v| self.scene.outward(v)).collect()
        };
        self.leaves.iter().map(corners)
    }

    /// Mean irradiance of one patch from all others, by its links.
    ///
    /// # Panics
    /// If there is no patch of this index.
    #[must_use]
    pub fn gathered_by(&self, solution: &Solution, index: usize) -> Rgb {
        let mut sum = [0.0; 3];
        let mut element = Some(self.leaves[index]);
        while let Some(id) = element {
            for entry in self.row(id) {
                sum = add(sum, entry.factor * self.scale[index], solution.of_element[entry.to as usize]);
            }
            element = self.parents[id as usize];
        }
        sum
    }

    pub(crate) fn row(&self, element: ElementId) -> &[Entry] {
        &self.entries[self.starts[element as usize]..self.starts[element as usize + 1]]
    }

    /// Calls `f` with patch, other patch and form factor between them: what links of groups say is handed to their
    /// parts in proportion to area.
    pub fn factors(&self, mut f: impl FnMut(usize, usize, f64)) {
        let tree = &self.scene.tree;
        let mut number = vec![0; tree.elements.len()];
        for (i, &leaf) in self.leaves.iter().enumerate() {
            number[leaf as usize] = i;
        }
        for element in 0..tree.elements.len() as u32 {
            for entry in self.row(element) {
                let area = tree.elements[entry.to as usize].polygon.area();
                tree.leaves_below(element, &mut |from| {
                    tree.leaves_below(entry.to, &mut |to| {
                        let share = tree.elements[to as usize].polygon.area() / area;
                        let from = number[from as usize];
                        f(from, number[to as usize], entry.factor * share * self.scale[from]);
                    });
                });
            }
        }
    }

    /// Largest relative error bound of the form factors' own.
    #[must_use]
    pub fn factor_error(&self) -> f64 {
        self.links.iter().map(|l| l.error / l.mutual).fold(0.0, f64::max)
    }
}
