//! All links of a cloud in little memory.

use crate::links::Link;
use crate::node::Node;
use crate::packed;

/// The links of all cubes, packed: 18 bytes each, 22 with color.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct PackedLinks {
    pub(crate) points: Vec<u32>,
    /// Where they are drawn in the boxes of their nodes, see [`Node::offset`].
    pub(crate) places: [Vec<i16>; 3],
    pub(crate) areas: Vec<f32>,
    pub(crate) normals: Vec<u32>,
    pub(crate) colors: Option<Vec<u32>>,
}

impl PackedLinks {
    /// `nodes` are those of the cubes.
    pub(crate) fn new(links: &[Vec<Link>], nodes: &[Node], colored: bool) -> Self {
        let all = || links.iter().flatten();
        let with_nodes =
            || nodes.iter().zip(links).flat_map(|(node, list)| list.iter().map(move |l| (node, l)));
        let place = |axis: usize| {
            with_nodes()
                .map(|(node, link): (&Node, &Link)| node.relative_cell(axis, link.cell[axis]))
                .collect()
        };
        Self {
            points: all().map(|l| l.point).collect(),
            places: [0, 1, 2].map(place),
            areas: all().map(|l| l.area).collect(),
            normals: all().map(|l| packed::pack_direction(l.normal)).collect(),
            colors: colored.then(|| all().map(|l| packed::pack_color(l.color.to_array())).collect()),
        }
    }

    /// Memory of all links.
    pub(crate) fn bytes(&self) -> usize {
        4 * (self.points.len() + self.areas.len() + self.normals.len())
            + 2 * 3 * self.points.len()
            + 4 * self.colors.as_ref().map_or(0, Vec::len)
    }
}
