//! Parts of a cloud that are drawn together.

use crate::attributes::Attributes;
use crate::cloud::Cloud;
use crate::error::SurfelError;
use crate::node::{self, Node};
use crate::packed;
use crate::packed_links::PackedLinks;
use crate::points::Points;
use std::borrow::Cow;
use std::ops::Range;

impl Cloud {
    /// Puts parts together that [`Cloud::parts`] made within one cube. Costs a copy of them.
    ///
    /// Colors are there if all parts have some; parts without opacities are opaque, and those without normals for light show it their own.
    ///
    /// # Errors
    /// [`SurfelError::NoPoints`] without parts, [`SurfelError::NotOfOneKind`], [`SurfelError::TooManyPoints`].
    pub fn join(parts: &[&Self]) -> Result<Self, SurfelError> {
        let first = parts.first().ok_or(SurfelError::NoPoints)?;
        let is_other =
            |part: &&Self| part.lattice != first.lattice || part.is_estimated != first.is_estimated;
        if let Some(index) = parts.iter().position(is_other) {
            return Err(SurfelError::NotOfOneKind { index });
        }
        let count: usize = parts.iter().map(|part| part.len()).sum();
        if count > Points::MOST {
            return Err(SurfelError::TooManyPoints { count: count as f64, limit: Points::MOST });
        }
        let of_points: Vec<&Attributes> = parts.iter().map(|part| &part.points).collect();
        let of_links: Vec<&PackedLinks> = parts.iter().map(|part| &part.links).collect();
        Ok(Self {
            lattice: first.lattice,
            points: Attributes::joined(&of_points),
            nodes: nodes(parts),
            links: PackedLinks::joined(&of_links),
            is_estimated: first.is_estimated,
        })
    }
}

/// One list of all.
fn concat<'a, S: 'a, T: Copy + 'a>(parts: &[&'a S], list: impl Fn(&'a S) -> &'a [T]) -> Vec<T> {
    let mut all = Vec::with_capacity(parts.iter().map(|part| list(part).len()).sum());
    parts.iter().for_each(|part| all.extend_from_slice(list(part)));
    all
}

/// One list, if all have one.
fn concat_all<'a, S, T: Copy + 'a>(
    parts: &[&'a S],
    list: impl Fn(&'a S) -> Option<&'a Vec<T>>,
) -> Option<Vec<T>> {
    let lists: Vec<&Vec<T>> = parts.iter().map(|part| list(part)).collect::<Option<_>>()?;
    Some(concat(&lists, |list| list))
}

/// One list, if any has one; the others have this value, so many times.
fn concat_any<'a, S, T: Copy + 'a>(
    parts: &[&'a S],
    list: impl Fn(&'a S) -> Option<&'a Vec<T>>,
    (value, len): (T, impl Fn(&'a S) -> usize),
) -> Option<Vec<T>> {
    parts.iter().find_map(|part| list(part))?;
    let mut all = Vec::with_capacity(parts.iter().map(|part| len(part)).sum());
    for part in parts {
        match list(part) {
            Some(list) => all.extend_from_slice(list),
            None => all.resize(all.len() + len(part), value),
        }
    }
    Some(all)
}

impl Attributes {
    /// Normals for light, packed: the points' own where there are no others.
    fn seen_by_light(&self) -> Cow<'_, [u32]> {
        let own = || (0..self.radii.len()).map(|i| packed::pack_direction(self.normal(i))).collect();
        self.shading_normals.as_deref().map_or_else(|| Cow::Owned(own()), Cow::Borrowed)
    }

    fn joined(parts: &[&Self]) -> Self {
        Self {
            cells: [0, 1, 2].map(|axis| concat(parts, |part| &part.cells[axis])),
            normals: [0, 1, 2].map(|axis| concat(parts, |part| &part.normals[axis])),
            shading_normals: parts
                .iter()
                .any(|part| part.shading_normals.is_some())
                .then(|| parts.iter().flat_map(|part| part.seen_by_light().into_owned()).collect()),
            radii: concat(parts, |part| &part.radii),
            areas: concat(parts, |part| &part.areas),
            colors: concat_all(parts, |part| part.colors.as_ref()),
            opacities: concat_any(
                parts,
                |part| part.opacities.as_ref(),
                (1.0, |part: &Self| part.radii.len()),
            ),
        }
    }
}

impl PackedLinks {
    fn joined(parts: &[&Self]) -> Self {
        let opaque = (packed::pack_share(1.0), |part: &Self| part.len());
        Self {
            places: [0, 1, 2].map(|axis| concat(parts, |part| &part.places[axis])),
            areas: concat(parts, |part| &part.areas),
            normals: concat(parts, |part| &part.normals),
            shading_normals: parts.iter().any(|part| part.shading_normals.is_some()).then(|| {
                let of = |part: &&Self| part.shading_normals.clone().unwrap_or_else(|| part.normals.clone());
                parts.iter().flat_map(of).collect()
            }),
            colors: concat_all(parts, |part| part.colors.as_ref()),
            opacities: concat_any(parts, |part| part.opacities.as_ref(), opaque),
        }
    }
}

/// The nodes of all parts: one around the roots, the roots, and then those of each part.
fn nodes(parts: &[&Cloud]) -> Vec<Node> {
    let (mut roots, mut others) = (vec![], vec![]);
    let first_other = 1 + parts.len();
    let (mut points, mut links) = (0, 0);
    for part in parts {
        // A part's second node comes here.
        let below = (first_other + others.len()) as u32;
        let moved = |node: &Node| {
            let by = |range: &Range<u32>, start: u32| range.start + start..range.end + start;
            let children = if node.is_leaf() { 0..0 } else { by(&node.children, below - 1) };
            let items = by(&node.items, if node.is_leaf() { points } else { links });
            Node { items, children, ..node.clone() }
        };
        let mut own = part.nodes.iter().map(moved);
        roots.extend(own.next());
        others.extend(own);
        points += part.len() as u32;
        links += part.links.len() as u32;
    }
    let around = node::around(&roots.iter().collect::<Vec<_>>(), 1..first_other as u32);
    [vec![around], roots, others].concat()
}
