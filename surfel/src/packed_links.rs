//! All links of a cloud in little memory.

use crate::attributes::Attributes;
use crate::links::Link;
use crate::node::Node;
use crate::packed;

/// The links of all cubes, packed: 12 bytes each, 4 more with color, 4 with normals for light, 2 with opacity.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct PackedLinks {
    /// Where they are drawn in the boxes of their nodes, see [`Node::offset`].
    pub(crate) places: [Vec<i16>; 3],
    /// Shares of the largest area of their nodes, see [`Node::area`].
    pub(crate) areas: Vec<u16>,
    pub(crate) normals: Vec<u32>,
    pub(crate) shading_normals: Option<Vec<u32>>,
    pub(crate) colors: Option<Vec<u32>>,
    pub(crate) opacities: Option<Vec<u16>>,
}

impl PackedLinks {
    /// `nodes` are those of the cubes.
    pub(crate) fn new(links: &[Vec<Link>], nodes: &[Node], points: &Attributes) -> Self {
        let all = || links.iter().flatten();
        let with_nodes =
            || nodes.iter().zip(links).flat_map(|(node, list)| list.iter().map(move |l| (node, l)));
        let place = |axis: usize| {
            with_nodes()
                .map(|(node, link): (&Node, &Link)| node.relative_cell(axis, link.cell[axis]))
                .collect()
        };
        Self {
            places: [0, 1, 2].map(place),
            areas: with_nodes().map(|(node, link)| node.share(link.area)).collect(),
            normals: all().map(|l| packed::pack_direction(l.normal)).collect(),
            shading_normals: points
                .shading_normals
                .as_ref()
                .map(|_| all().filter_map(|l| l.shading_normal).map(packed::pack_direction).collect()),
            colors: points.colors.as_ref().map(|_| all().map(|l| packed::pack_color(color_of(l))).collect()),
            opacities: points
                .opacities
                .as_ref()
                .map(|_| all().map(|l| packed::pack_share(l.opacity)).collect()),
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.areas.len()
    }

    /// Memory of all links.
    pub(crate) fn bytes(&self) -> usize {
        (4 + 2 + 2 * 3) * self.len()
            + 4 * self.colors.as_ref().map_or(0, Vec::len)
            + 4 * self.shading_normals.as_ref().map_or(0, Vec::len)
            + 2 * self.opacities.as_ref().map_or(0, Vec::len)
    }
}

/// The color of what is opaque of a link. Colors and opacities are rounded apart, so that no color exceeds its opacity.
fn color_of(link: &Link) -> [f32; 3] {
    if link.opacity > 0.0 { (link.color / link.opacity).to_array() } else { [0.0; 3] }
}
