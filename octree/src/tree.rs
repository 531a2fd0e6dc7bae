//! The shape of a tree: which nodes there are, and what is in which.

use crate::cube::Cube;
use crate::error::OctreeError;
use crate::key::NodeKey;
use std::collections::HashMap;

/// A node, without its points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Node {
    /// Its cube.
    pub key: NodeKey,
    /// Points that are in it and in none of its children; may be 0.
    pub count: u64,
}

/// Stands for no node.
const NONE: u32 = u32::MAX;

/// Which nodes there are. Each point of the cloud is in one of them; a node together with all nodes around it is a picture of its cube.
#[derive(Clone, Debug)]
pub struct Tree {
    cube: Cube,
    spacing: f64,
    nodes: Vec<Node>,
    children: Vec<[u32; 8]>,
    root: Option<u32>,
}

impl Tree {
    /// Puts nodes together; `spacing` is the distance of neighbouring points in the root, world units, and half of that on each further level.
    ///
    /// # Errors
    /// [`OctreeError::BadBounds`] for a cube or a spacing that is not finite and above 0; [`OctreeError::BadKey`], [`OctreeError::TwiceThere`],
    /// [`OctreeError::NoParent`] for nodes that are no tree.
    pub fn new(cube: Cube, spacing: f64, nodes: Vec<Node>) -> Result<Self, OctreeError> {
        if !(cube.is_valid() && spacing > 0.0 && spacing.is_finite()) {
            return Err(OctreeError::BadBounds { low: cube.low, high: cube.low + cube.side });
        }
        let mut places = HashMap::with_capacity(nodes.len());
        for (index, node) in nodes.iter().enumerate() {
            let key = node.key;
            if !key.is_valid() || index >= NONE as usize {
                return Err(OctreeError::BadKey { index, key });
            }
            if places.insert(key, index as u32).is_some() {
                return Err(OctreeError::TwiceThere { index, key });
            }
        }
        let mut children = vec![[NONE; 8]; nodes.len()];
        for (index, node) in nodes.iter().enumerate() {
            let Some(parent) = node.key.parent() else { continue };
            let around = *places.get(&parent).ok_or(OctreeError::NoParent { index, key: node.key })?;
            children[around as usize][node.key.octant()] = index as u32;
        }
        let root = places.get(&NodeKey::ROOT).copied();
        Ok(Self { cube, spacing, nodes, children, root })
    }

    /// The nodes, in the order in which they were given.
    #[must_use]
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// The root; nothing for a tree without nodes.
    #[must_use]
    pub fn root(&self) -> Option<u32> {
        self.root
    }

    /// The nodes in a node, as numbers of [`Tree::nodes`].
    pub fn children(&self, node: u32) -> impl Iterator<Item = u32> {
        self.children[node as usize].into_iter().filter(|&child| child != NONE)
    }

    /// The node in one octant of a node, if there is any.
    #[must_use]
    pub fn child(&self, node: u32, octant: usize) -> Option<u32> {
        self.children[node as usize].get(octant).copied().filter(|&child| child != NONE)
    }

    /// The cube of the whole tree.
    #[must_use]
    pub fn cube(&self) -> Cube {
        self.cube
    }

    /// Distance of neighbouring points once a node and all around it are there, world units.
    #[must_use]
    pub fn spacing(&self, node: u32) -> f64 {
        self.spacing / (f64::from(self.nodes[node as usize].key.level)).exp2()
    }

    /// Points in all nodes.
    #[must_use]
    pub fn points(&self) -> u64 {
        self.nodes.iter().fold(0, |sum, node| sum.saturating_add(node.count))
    }
}
