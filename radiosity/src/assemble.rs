//! From a scene to its transport: links, rows, direct light.

use crate::error::RadiosityError;
use crate::kept::Kept;
use crate::link::Link;
use crate::refine::{Found, Given, refine};
use crate::rgb::{Rgb, check_direct};
use crate::scene::Scene;
use crate::solve::check_importance;
use crate::transport::{Entry, Transport};
use crate::visible::shaft::Shaft;

/// Row sums above 1 by at most this are not corrected: they are errors of single form factors, and correcting them would break the
/// reciprocity on which the balance of energy rests.
const LEAST_EXCESS: f64 = 1e-3;

impl Scene {
    /// Finds the links between patches. `direct` is the irradiance of each patch by lamps, as [`Scene::direct`] gives it, or empty for none;
    /// links are finer where it is high.
    ///
    /// Without a tolerance ([`SceneOptions::tolerance`](crate::SceneOptions::tolerance)) every pair of patches gets its link. With one, patches are
    /// linked as large as it permits (\[3\]), and divided down to the smallest size where it asks for that.
    ///
    /// # Errors
    /// [`RadiosityError::CountMismatch`] and [`RadiosityError::DirectIrradiance`] for `direct`, [`RadiosityError::TooManyPatches`].
    pub fn transport(self, direct: &[Rgb]) -> Result<Transport, RadiosityError> {
        self.transport_with(direct, &|_| ())
    }

    /// As [`Scene::transport`]; `done` is told the share of the work that is done (0 to 1), from any thread.
    ///
    /// # Errors
    /// As [`Scene::transport`].
    pub fn transport_with(
        self,
        direct: &[Rgb],
        done: &(dyn Fn(f64) + Sync),
    ) -> Result<Transport, RadiosityError> {
        self.linked(direct, &[], None, done)
    }

    /// As [`Scene::transport`], for a scene that is nearly that of a transport that is there already: pairs that are partly hidden by the same surfaces
    /// as before keep their form factors, so that one moved object pays for its own links and for those that it hides or hid. What was moved need not be said.
    ///
    /// Between single patches ([`SceneOptions::tolerance`](crate::SceneOptions::tolerance) is `None`) the result is that of [`Scene::transport`], bit for bit. Between
    /// groups, form factors that are kept are as accurate as direct light asked for then. Nothing can be kept if the box around
    /// all surfaces or [`SceneOptions::factors`](crate::SceneOptions::factors) changes; [`LinkCounts::kept`](crate::LinkCounts::kept) says how many were.
    ///
    /// # Errors
    /// As [`Scene::transport`].
    pub fn transport_after(
        self,
        before: &Transport,
        direct: &[Rgb],
        done: &(dyn Fn(f64) + Sync),
    ) -> Result<Transport, RadiosityError> {
        let kept = Kept::new(before, &self);
        self.linked(direct, &[], kept.as_ref(), done)
    }

    /// As [`Scene::transport_with`], where errors of light count in proportion to the `importance` of each patch, in their order: 1 (and more) as much as the tolerance
    /// says, less so much less, down to a thousandth. [`Scene::importance`] finds one for a camera. Without a tolerance it changes nothing.
    ///
    /// # Errors
    /// As [`Scene::transport`], [`RadiosityError::CountMismatch`] and [`RadiosityError::Importance`] for `importance`.
    pub fn transport_for(
        self,
        direct: &[Rgb],
        importance: &[f64],
        done: &(dyn Fn(f64) + Sync),
    ) -> Result<Transport, RadiosityError> {
        check_importance(self.tree.leaves().len(), importance)?;
        let weights = self.weights(importance);
        self.linked(direct, &weights, None, done)
    }

    fn linked(
        mut self,
        direct: &[Rgb],
        weights: &[f64],
        kept: Option<&Kept<'_>>,
        done: &(dyn Fn(f64) + Sync),
    ) -> Result<Transport, RadiosityError> {
        check_direct(self.tree.leaves().len(), direct)?;
        let mut given = Given { direct: of_elements(&self, direct), weights: weights.to_vec() };
        let found = refine(&mut self, &mut given, kept, done)?;
        Ok(Transport::assemble(self, found, &given.direct))
    }
}

/// Values of leaves, by element; empty stands for zeros.
fn of_elements(scene: &Scene, of_leaves: &[Rgb]) -> Vec<Rgb> {
    let mut of_element = vec![[0.0; 3]; scene.tree.elements.len()];
    for (&leaf, value) in scene.tree.leaves().iter().zip(of_leaves) {
        of_element[leaf as usize] = *value;
    }
    of_element
}

/// Where the row of each element starts, and the entries of all rows, each in the order of links.
fn rows_of(scene: &Scene, links: &[Link]) -> (Vec<usize>, Vec<Entry>) {
    let count = scene.tree.elements.len();
    let mut starts = vec![0; count + 1];
    for link in links {
        starts[link.a as usize + 1] += 1;
        starts[link.b as usize + 1] += 1;
    }
    for i in 0..count {
        starts[i + 1] += starts[i];
    }
    let mut next = starts.clone();
    let mut entries = vec![Entry { to: 0, link: 0, factor: 0.0 }; links.len() * 2];
    for (number, link) in links.iter().enumerate() {
        for (from, to) in [(link.a, link.b), (link.b, link.a)] {
            let factor = link.mutual / scene.tree.elements[from as usize].polygon.area();
            entries[next[from as usize]] = Entry { to, link: number as u32, factor };
            next[from as usize] += 1;
        }
    }
    (starts, entries)
}

impl Transport {
    /// The transport of given links between leaves and the direct irradiance of each leaf. The occluders between the ends
    /// of each link are looked up here.
    pub(crate) fn of_links(scene: Scene, links: Vec<Link>, direct: &[Rgb]) -> Self {
        let mut found = Found { links, ..Found::default() };
        found.counts.links = found.links.len();
        for link in &mut found.links {
            let [a, b] = [link.a, link.b].map(|e| &scene.tree.elements[e as usize].polygon);
            let list = scene.boxes.in_shaft(&Shaft::new(a, b).with_planes(), &scene.occluders);
            let start = found.between.len() as u32;
            found.between.extend(list);
            link.between = (start, found.between.len() as u32);
            found.counts.partly_hidden += usize::from(link.between.1 > start);
        }
        let direct = of_elements(&scene, direct);
        Self::assemble(scene, found, &direct)
    }

    /// Lets no row add up to more than 1.
    fn correct_rows(&mut self) {
        let before = self.row_sums();
        let excess = |sums: &[f64]| sums.iter().fold(0.0, |m: f64, s| m.max(s - 1.0));
        self.counts.row_excess = excess(&before);
        if self.counts.row_excess <= LEAST_EXCESS {
            return;
        }
        self.share_links();
        if excess(&self.row_sums()) > LEAST_EXCESS {
            self.even_rows();
        }
        let changes = self.row_sums().into_iter().zip(before).filter(|(_, before)| *before > 0.0);
        self.counts.row_change = changes.fold(0.0, |m, (after, before)| m.max((after / before - 1.0).abs()));
    }

    /// The matrix of the links; `direct` is the direct irradiance of each element.
    fn assemble(scene: Scene, found: Found, direct: &[Rgb]) -> Self {
        let count = scene.tree.elements.len();
        let (starts, entries) = rows_of(&scene, &found.links);
        let leaves = scene.tree.leaves();
        let mut counts = found.counts;
        counts.left_out = found.lost.iter().copied().fold(0.0, f64::max);
        let direct = leaves.iter().map(|&leaf| direct[leaf as usize]).collect();
        let mut parents = vec![None; count];
        for (i, element) in scene.tree.elements.iter().enumerate() {
            element.children().for_each(|child| parents[child as usize] = Some(i as u32));
        }
        let Found { links, between, .. } = found;
        let (shares, scale) = (vec![1.0; count], vec![1.0; leaves.len()]);
        let mut transport =
            Self { scene, links, between, starts, entries, leaves, parents, shares, scale, direct, counts };
        transport.correct_rows();
        transport
    }
}
