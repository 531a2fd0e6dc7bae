//! A scene with the links between its patches: the matrix that solvers work with.

use crate::error::RadiosityError;
use crate::link::{Link, LinkCounts};
use crate::rgb::{Rgb, replace_direct};
use crate::scene::Scene;
use crate::tree::ElementId;

/// A scene with its links and its direct light.
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
    /// Parent of each element; `None` for roots.
    pub(crate) parents: Vec<Option<ElementId>>,
    /// Of each element: what it gets of the mean that arrives along its parent's links, and its weight in the mean that these see of its parent,
    /// by `share_links`. 1 for roots.
    pub(crate) shares: Vec<f64>,
    /// Factor on the row of each patch, by `even_rows`.
    pub(crate) scale: Vec<f64>,
    /// Irradiance of each patch that does not come from patches.
    pub(crate) direct: Vec<Rgb>,
    pub(crate) counts: LinkCounts,
}

/// One form factor of a row.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    pub(crate) to: ElementId,
    pub(crate) link: u32,
    pub(crate) factor: f64,
}

impl Transport {
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

    /// Irradiance of each patch that does not come from patches, in their order.
    #[must_use]
    pub fn direct(&self) -> &[Rgb] {
        &self.direct
    }

    /// Replaces the direct light: the irradiance of each patch, in their order, or empty for none. Links stay as they are, refined
    /// for the direct light that they were made with. Solutions borrow the transport, so none can be left over from before:
    ///
    /// ```compile_fail,E0502
    /// # use pointillist_radiosity::{SolveOptions, Transport};
    /// # fn relight(mut transport: Transport) {
    /// let solution = transport.gauss_seidel(&SolveOptions::DEFAULT).unwrap();
    /// transport.set_direct(&[]).unwrap();
    /// solution.bake();
    /// # }
    /// ```
    ///
    /// # Errors
    /// [`RadiosityError::CountMismatch`] and [`RadiosityError::DirectIrradiance`]; then nothing is changed.
    pub fn set_direct(&mut self, direct: &[Rgb]) -> Result<(), RadiosityError> {
        replace_direct(&mut self.direct, direct)
    }

    /// Gives a surface another reflectance and emission. Links stay as they are, refined for the materials that they were made with.
    ///
    /// # Errors
    /// As [`Scene::set_material`]; then nothing is changed. [`RadiosityError::Option`] if the surface was black when links were made: it has none.
    pub fn set_material(
        &mut self,
        surface: usize,
        reflectance: Rgb,
        emission: Rgb,
    ) -> Result<(), RadiosityError> {
        let was_black = |scene: &Scene| scene.sides.iter().any(|s| s.surface == surface && s.is_black());
        if was_black(&self.scene) && (reflectance != [0.0; 3] || emission != [0.0; 3]) {
            let (name, expected) = ("reflectance", "0, since no links were made for a black surface");
            let value = reflectance.into_iter().chain(emission).fold(0.0, f64::max);
            return Err(RadiosityError::Option { name, value, expected });
        }
        self.scene.set_material(surface, reflectance, emission)?;
        Ok(())
    }

    pub(crate) fn row(&self, element: ElementId) -> &[Entry] {
        &self.entries[self.starts[element as usize]..self.starts[element as usize + 1]]
    }

    /// Calls `f` with patch, other patch and form factor from the first to the second. A link of groups is distributed over their patches in
    /// proportion to area, and less to those that their own links leave no room for more.
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
                    let received = self.share_below(element, from);
                    let from = number[from as usize];
                    tree.leaves_below(entry.to, &mut |to| {
                        let sent =
                            tree.elements[to as usize].polygon.area() / area * self.share_below(entry.to, to);
                        f(from, number[to as usize], entry.factor * sent * received * self.scale[from]);
                    });
                });
            }
        }
    }

    /// What a leaf gets of the mean that arrives along the links of an element above it, or of itself.
    fn share_below(&self, element: ElementId, leaf: ElementId) -> f64 {
        let (mut share, mut at) = (1.0, leaf);
        while at != element {
            share *= self.shares[at as usize];
            match self.parents[at as usize] {
                Some(parent) => at = parent,
                None => break,
            }
        }
        share
    }

    /// Largest relative error bound of the form factors' own.
    #[must_use]
    pub fn factor_error(&self) -> f64 {
        self.links.iter().map(|l| l.error / l.mutual).fold(0.0, f64::max)
    }
}
