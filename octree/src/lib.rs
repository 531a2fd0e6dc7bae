//! Clouds of points larger than memory.
//!
//! Each point is in exactly one node of an octree, and inner nodes hold an evenly spaced sample, so that any part of the tree that has the root is a picture
//! of the whole, more or less dense. A [`Builder`] makes the tree of points that come in any order, in bounded memory; a [`TreeWriter`] keeps it in a
//! file, a [`TreeReader`] finds out whether that was altered and reads single nodes; [`cut`] says which nodes a view needs; a [`NodeCache`] keeps
//! those that were read for the next view; and [`regions`] says which node is the deepest for which place, so that what is made of the points there can
//! be kept as well, with those of its [`Neighbourhood`]. [`Tree`] takes nodes of any origin: those of a COPC file, for example.
//!
//! ```
//! use glam::DVec3;
//! use pointillist_octree::{Builder, Cube, TreeHeader, TreeReader, TreeWriter};
//! use std::io::Cursor;
//!
//! let cube = Cube::around(DVec3::ZERO, DVec3::ONE)?;
//! let mut builder = Builder::new(cube, 1, 64 << 20, Cursor::new(vec![]));
//! for i in 0..1000 {
//!     builder.push(DVec3::splat(f64::from(i) / 1000.0), &[i as u8])?;
//! }
//! let mut writer = TreeWriter::new(vec![], &TreeHeader { fingerprint: 7, cube, payload: 1, layout: 0 })?;
//! builder.finish(&mut |key, records| writer.node(key, records), &mut |_| ())?;
//! let reader = TreeReader::new(Cursor::new(writer.finish()?))?;
//! // Few enough for one node.
//! assert_eq!((reader.tree().points(), reader.tree().nodes().len()), (1000, 1));
//! # Ok::<(), pointillist_octree::OctreeError>(())
//! ```
//!
//! # Accuracy and cost
//!
//! Positions are kept to 2⁻³² of the cube's side. While a tree is built, the temporary file holds each point once, twelve bytes and its payload, and
//! memory is what was asked for. The tree does not depend on that, nor on the order of points. More than [`LEAF`] points in a cube of 2⁻²⁵ of the
//! side are refused ([`OctreeError::TooDense`]). A tree in memory takes about 100 bytes for each node.
//!
//! # Features
//!
//! * `invariants`: facts that hold for every cloud, as functions.
//!
//! # References
//!
//! The shape is that of COPC (<https://copc.io>) and of M. Schütz, S. Ohrhallinger, M. Wimmer, "Fast Out-of-Core Octree Generation for Massive Point
//! Clouds", Computer Graphics Forum 39(7), 2020.
#![forbid(unsafe_code)]

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

mod build;
mod cache;
mod cube;
mod cut;
mod error;
mod file;
#[cfg(feature = "invariants")]
pub mod invariants;
mod key;
mod region;
mod sample;
mod spill;
mod tree;

pub use build::{Builder, LEAF, NodeSink, POSITION_BYTES};
pub use cache::NodeCache;
pub use cube::Cube;
pub use cut::{Cut, CutOptions, cut};
pub use error::OctreeError;
pub use file::{MARK as TREE_MARK, TreeHeader, TreeReader, TreeWriter};
pub use key::NodeKey;
pub use region::{Neighbourhood, Region, regions};
pub use tree::{Node, Tree};
