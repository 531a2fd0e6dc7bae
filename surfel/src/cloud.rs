//! A cloud, prepared for drawing.

use crate::attributes::{Attributes, Sorted, in_order};
use crate::error::SurfelError;
use crate::lattice::Lattice;
use crate::node::{Node, nodes};
use crate::packed_links::PackedLinks;
use crate::points::Points;
use crate::{links, octree, pairs, sharpen};
use glam::DVec3;

/// A cloud of surfels in an octree: points at the leaves, links to them above.
///
/// The same for every order of the points. Positions are kept to 2⁻³² of the cloud's extent.
#[derive(Clone, Debug, PartialEq)]
pub struct Cloud {
    pub(crate) lattice: Lattice,
    pub(crate) points: Attributes,
    pub(crate) nodes: Vec<Node>,
    pub(crate) links: PackedLinks,
    /// Whether normals were estimated.
    pub(crate) is_estimated: bool,
}

impl Cloud {
    /// Sorts points into an octree and estimates the attributes that are missing.
    ///
    /// # Errors
    /// [`SurfelError::NoPoints`], [`SurfelError::TooManyPoints`], [`SurfelError::LengthMismatch`],
    /// [`SurfelError::PointNotFinite`], [`SurfelError::PointTooFar`], [`SurfelError::BadNormal`],
    /// [`SurfelError::OnlyShadingNormals`], [`SurfelError::BadColor`], [`SurfelError::BadRadius`], [`SurfelError::BadOpacity`].
    pub fn new(points: &Points<'_>) -> Result<Self, SurfelError> {
        points.check()?;
        let lattice = Lattice::around(points.positions);
        let Sorted { attributes, codes, two_sided, .. } = in_order(points, &lattice, None);
        let mut cloud = Self::of_sorted(lattice, attributes, &codes, &two_sided);
        cloud.is_estimated = points.normals.is_none();
        Ok(cloud)
    }

    /// Makes the tree of points that are sorted; their normals count as given. `two_sided`: which of them are seen from both sides.
    pub(crate) fn of_sorted(
        lattice: Lattice,
        mut attributes: Attributes,
        codes: &[u64],
        two_sided: &[bool],
    ) -> Self {
        let (cubes, generations) = octree::divide(codes);
        let mut links = links::make(&cubes, &generations, &attributes);
        if let (Some(colors), None) = (&attributes.colors, &attributes.opacities) {
            sharpen::sharpen(&cubes, &mut links, colors);
        }
        let pairs = pairs::arrange(&cubes, &mut attributes, &mut links);
        let mut nodes = nodes(&cubes, &generations, &links, &attributes, two_sided);
        nodes.iter_mut().zip(pairs).for_each(|(node, pairs)| node.pairs = pairs);
        let links = PackedLinks::new(&links, &nodes, &attributes);
        Self { lattice, points: attributes, nodes, links, is_estimated: false }
    }

    /// Number of points.
    #[must_use]
    #[expect(clippy::len_without_is_empty, reason = "a cloud has at least one point")]
    pub fn len(&self) -> usize {
        self.points.radii.len()
    }

    /// Whether points have colors of their own.
    #[must_use]
    pub fn has_colors(&self) -> bool {
        self.points.colors.is_some()
    }

    /// Whether any point is less than opaque.
    #[must_use]
    pub fn has_opacities(&self) -> bool {
        self.points.opacities.is_some()
    }

    /// Whether light sees other normals than those of the discs.
    #[must_use]
    pub fn has_shading_normals(&self) -> bool {
        self.points.shading_normals.is_some()
    }

    /// Whether normals were estimated. Closed surfaces are then seen from their outside, if the eye is beside all of them (the box around the
    /// cloud); others, those of [`Cloud::parts`], and all of them from among them are seen from both sides.
    #[must_use]
    pub fn has_estimated_normals(&self) -> bool {
        self.is_estimated
    }

    /// All positions, in an order of the cloud's own, to 2⁻³² of its extent.
    pub fn positions(&self) -> impl Iterator<Item = DVec3> {
        (0..self.len()).map(|i| self.lattice.position(self.points.cell(i)))
    }

    /// Typical distance of neighbouring points, world units: the square root of the mean area of a point.
    #[must_use]
    pub fn spacing(&self) -> f64 {
        let area: f64 = self.points.areas.iter().map(|&a| f64::from(a)).sum();
        (area / self.len() as f64).sqrt() * self.lattice.side
    }

    /// Bytes that it takes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let of_point = 8 * size_of::<f32>()
            + if self.has_colors() { size_of::<[f32; 3]>() } else { 0 }
            + if self.has_opacities() { size_of::<f32>() } else { 0 }
            + if self.has_shading_normals() { size_of::<u32>() } else { 0 };
        self.links.bytes() + size_of::<Node>() * self.nodes.len() + of_point * self.len()
    }

    /// Bytes per point besides position, normal, color, radius and opacity: octree, links and areas.
    #[must_use]
    pub fn overhead_per_point(&self) -> f64 {
        let bytes = self.links.bytes()
            + size_of::<Node>() * self.nodes.len()
            + size_of::<f32>() * self.points.areas.len();
        bytes as f64 / self.len() as f64
    }
}
