//! Clouds larger than memory: an octree of each, its own or one that is made, of which a view reads the nodes that it needs.

mod make;
mod nodes;
mod parts;
mod record;

use super::PointSet;
use super::colouring::{Colouring, Legend};
use super::reading::{PointOptions, Taker};
use crate::input;
use crate::input_error::InputError;
use crate::job::Progress;
use crate::memory;
use glam::{DVec3, Vec3};
pub use make::write_octree;
use nodes::{Making, NodeFile};
use parts::Part;
use pointillist_ibpr as ibpr;
use pointillist_octree::{Cut, CutOptions, Neighbourhood, NodeCache, Region, Tree, cut, regions};
use pointillist_view::{Projection, View};
use std::fs::File;
use std::hash::Hasher as _;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use twox_hash::XxHash3_64;

/// Bytes of a point of a cloud that is read into memory as a whole: see `PointSet`; and what is kept of it besides.
const WHOLE_BYTES: u64 = 560;

/// Bytes of a point that is drawn by nodes: in its part, and again where parts are joined.
const DRAWN_BYTES: u64 = 160;

/// Shares of the memory: for points that are drawn; for parts that are ready, so that all of a view can stay for the next; and for nodes that were read.
const DRAWN_SHARE: f64 = 0.5;
const PARTS_SHARE: f64 = 0.35;
const NODES_SHARE: f64 = 0.1;

/// Points that are looked at for the range of a scale, if there are so many.
const SAMPLE: usize = 10_000;

/// Nodes that are read for that at most.
const SAMPLE_NODES: usize = 200;

/// Points of a picture that is there at once.
const COARSE_POINTS: u64 = 150_000;

/// Nodes in which the distance of points is measured, and points of an octant that say something about it.
const MEASURED_NODES: usize = 100;
const MEASURED_POINTS: usize = 100;

/// Share of the points that may be closer together than the finest that count.
const FINEST_SHARE: f64 = 0.1;

/// How far apart the points of a cut are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Density {
    /// Where they are close together, world units.
    pub spacing: f64,
    /// In the picture, pixels: the median over all points.
    pub spacing_px: f64,
}

/// The clouds of a picture, as trees.
#[derive(Debug)]
pub struct Trees {
    clouds: Vec<NodeFile>,
    cache: NodeCache<NodePoints>,
    parts: NodeCache<Part>,
    most_points: u64,
    options: PointOptions,
    colouring: Colouring,
    /// Bytes read from files so far, of nodes.
    pub bytes_read: u64,
    /// Nodes that were read, and that were kept from earlier views.
    pub nodes_read: u64,
    /// See [`Self::nodes_read`].
    pub nodes_kept: u64,
    /// Octants of nodes whose points were made ready to be drawn, and those that had been for earlier views.
    pub parts_made: u64,
    /// See [`Self::parts_made`].
    pub parts_kept: u64,
}

/// The points of a node that are selected, in their colours.
#[derive(Debug)]
struct NodePoints {
    set: PointSet,
    legend: Option<Legend>,
}

/// Whether clouds are drawn by nodes: it is asked for, the points of one do not fit into memory, or all of them have nodes, so that no octree has to be
/// made.
pub fn are_drawn_by_nodes(paths: &[PathBuf], wanted: bool) -> bool {
    let files: Vec<_> = paths.iter().filter(|path| !input::is_standard(path)).collect();
    let all_have = files.len() == paths.len() && paths.iter().all(|path| nodes::has_nodes(path));
    // An octree of ours has no other reader.
    all_have || files.iter().any(|path| wanted || nodes::is_tree(path) || is_large(path))
}

/// Whether a file has nodes of its own, so that nothing has to be made beside it.
pub fn has_nodes(path: &Path) -> bool {
    nodes::has_nodes(path)
}

/// Whether a file is a mesh that a reader of clouds takes for its vertices.
pub fn has_faces(path: &Path) -> bool {
    nodes::has_faces(path)
}

/// Whether the points of a file do not fit into memory.
fn is_large(path: &Path) -> bool {
    let Ok(mut file) = File::open(path) else { return false };
    let mut head = vec![];
    if (&mut file).take(256).read_to_end(&mut head).is_err() {
        return false;
    }
    let length = file.seek(SeekFrom::End(0)).unwrap_or(0);
    let available = memory::available_bytes().unwrap_or(u64::MAX);
    expected_points(&head, length).saturating_mul(WHOLE_BYTES) > available
}

/// Points of a file: those that a LAS announces, or what would fit into as many bytes.
fn expected_points(head: &[u8], length: u64) -> u64 {
    /// Bytes of a point of other files, at least.
    const LEAST: u64 = 15;
    let number =
        |at: usize| head.get(at..at + 8).map_or(0, |b| u64::from_le_bytes(b.try_into().unwrap_or_default()));
    if head.starts_with(b"LASF") {
        // The number of points is in two places: an old one with 32 bits, which are 0 if they do not suffice.
        let old = number(107) & 0xffff_ffff;
        return if old > 0 { old } else { number(247) }.min(length);
    }
    length / LEAST
}

impl Trees {
    /// Opens the octrees of clouds; makes those that are not there, or not of these files. `tell` gets a line before each that is made.
    ///
    /// # Errors
    ///
    /// [`InputError`] for the first that cannot be used.
    pub fn open(
        paths: &[PathBuf],
        options: PointOptions,
        colouring: Colouring,
        progress: &Progress,
        tell: &dyn Fn(&str),
    ) -> Result<Self, InputError> {
        let memory = memory::available_bytes().unwrap_or(8 << 30);
        let share = |share: f64| (memory as f64 * share) as u64;
        let making = Making { options: &options, memory, progress, tell };
        let clouds = paths.iter().map(|path| NodeFile::open(path, &making));
        let mut trees = Self {
            clouds: clouds.collect::<Result<_, _>>()?,
            cache: NodeCache::new(share(NODES_SHARE)),
            parts: NodeCache::new(share(PARTS_SHARE)),
            most_points: share(DRAWN_SHARE) / DRAWN_BYTES,
            options,
            colouring,
            bytes_read: 0,
            nodes_read: 0,
            nodes_kept: 0,
            parts_made: 0,
            parts_kept: 0,
        };
        if colouring.by.has_range() && colouring.range.is_none() {
            let legend = trees.legend()?;
            trees.colouring = colouring.as_in(legend.as_ref());
        }
        Ok(trees)
    }

    /// Points of all clouds.
    pub fn points(&self) -> u64 {
        self.clouds.iter().map(|cloud| cloud.tree().points()).sum()
    }

    /// The nodes that a view needs.
    pub fn cut(&self, view: &View, spacing_px: f64, margin_px: f64) -> Cut {
        let options = CutOptions::default().with_spacing_px(spacing_px).with_margin_px(margin_px);
        cut(&self.shapes(), view, &options.with_most_points(self.most_points))
    }

    /// What nodes of a cut are drawn for.
    pub fn regions(&self, cut: &Cut, view: &View, margin_px: f64) -> Vec<Region> {
        regions(&self.shapes(), view, &CutOptions::default().with_margin_px(margin_px), cut)
    }

    /// The beginning of a cut: a picture that is there at once. Nothing if the cut is not much larger.
    pub fn coarse(&self, cut: &Cut) -> Option<Cut> {
        if cut.points < 4 * COARSE_POINTS {
            return None;
        }
        let mut coarse = Cut { spacing_px: f64::INFINITY, is_limited: true, ..Cut::default() };
        for &(tree, node) in &cut.nodes {
            coarse.points += self.clouds[tree].tree().nodes()[node as usize].count;
            if coarse.points > COARSE_POINTS && !coarse.nodes.is_empty() {
                coarse.points -= self.clouds[tree].tree().nodes()[node as usize].count;
                break;
            }
            coarse.nodes.push((tree, node));
        }
        Some(coarse)
    }

    /// The coarsest selected points: for a camera that has everything in view.
    ///
    /// # Errors
    ///
    /// As [`Self::load`].
    pub fn outline(&mut self) -> Result<PointSet, InputError> {
        self.sample(1, |trees, tree, node, set| {
            set.add_all(&trees.node(tree, node)?.set);
            Ok(())
        })
    }

    /// What colours mean in points from all over: for the range of a scale, which is then that of all views.
    fn legend(&mut self) -> Result<Option<Legend>, InputError> {
        let mut set = self.sample(SAMPLE, |trees, tree, node, set| {
            set.add_measured(&trees.measured(tree, node)?);
            Ok(())
        })?;
        Ok(set.colour(&self.colouring))
    }

    /// Selected points, level by level from the roots until there are at least so many.
    fn sample(
        &mut self,
        least: usize,
        add: impl Fn(&mut Self, usize, u32, &mut PointSet) -> Result<(), InputError>,
    ) -> Result<PointSet, InputError> {
        let roots = self.shapes().into_iter().enumerate().map(|(number, tree)| Some((number, tree.root()?)));
        let mut level: Vec<(usize, u32)> = roots.flatten().collect();
        let mut set = PointSet::empty();
        let mut read = 0;
        while !level.is_empty() && set.count() < least && read < SAMPLE_NODES {
            level.truncate(SAMPLE_NODES - read);
            read += level.len();
            for &(tree, node) in &level {
                add(self, tree, node, &mut set)?;
            }
            level = level.iter().flat_map(|&id| self.children(id)).collect();
        }
        Ok(set)
    }

    /// The nodes in a node that may have selected points.
    fn children(&self, (number, node): (usize, u32)) -> Vec<(usize, u32)> {
        let tree = self.clouds[number].tree();
        let is_wanted = |child: &u32| {
            let cube = tree.cube().of(tree.nodes()[*child as usize].key);
            self.options.selection.may_take_of(cube.low, cube.low + cube.side)
        };
        tree.children(node).filter(is_wanted).map(|child| (number, child)).collect()
    }

    fn shapes(&self) -> Vec<&Tree> {
        self.clouds.iter().map(|cloud| cloud.tree()).collect()
    }

    /// The nodes with the points of regions, by cloud and place in it.
    pub fn nodes_of(&self, regions: &[Region]) -> Vec<(usize, u32)> {
        let of_region = |region: &Region| {
            let Region { tree, node, octants } = *region;
            let shape = self.clouds[tree].tree();
            let of_octant = move |octant| Neighbourhood::of(shape, node, octant, 0.0).nodes(shape);
            let all = (0..8).filter(move |octant| octants >> octant & 1 == 1).flat_map(of_octant);
            all.map(move |node| (tree, node))
        };
        let mut nodes: Vec<(usize, u32)> = regions.iter().flat_map(of_region).collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    /// The points of nodes in this order, cloud by cloud, and what their colours mean; `done` is told after each node.
    ///
    /// # Errors
    ///
    /// [`InputError`] for a node that is damaged, or points without what is asked for.
    pub fn load(
        &mut self,
        nodes: &[(usize, u32)],
        done: &mut dyn FnMut(),
    ) -> Result<(Vec<PointSet>, Option<Legend>), InputError> {
        let mut sets: Vec<PointSet> = vec![];
        let mut legend = None;
        for of_tree in nodes.chunk_by(|a, b| a.0 == b.0) {
            let mut set = PointSet::empty();
            for &(tree, node) in of_tree {
                let points = self.node(tree, node)?;
                set.add_all(&points.set);
                legend = Legend::merged(legend.iter().chain(&points.legend));
                done();
            }
            sets.push(set);
        }
        sets.retain(|set| set.count() > 0);
        Ok((sets, legend))
    }

    /// How far apart points are where a cut is the finest, world units, and in pixels where half of the points are closer: measured, in some of the
    /// octants that are drawn. Nothing if there are too few points.
    ///
    /// # Errors
    ///
    /// As [`Self::load`].
    pub fn density(&mut self, regions: &[Region], view: &View) -> Result<Option<Density>, InputError> {
        let mut measured = vec![];
        for region in regions.iter().step_by(regions.len().div_ceil(MEASURED_NODES).max(1)) {
            for octant in (0..8).filter(|octant| region.octants >> octant & 1 == 1) {
                measured.extend(self.density_of(region, octant, view)?);
            }
        }
        let count: usize = measured.iter().map(|(_, _, points)| points).sum();
        let at_share =
            |key: fn(&(f64, f64, usize)) -> f64, share: f64, measured: &mut Vec<(f64, f64, usize)>| {
                measured.sort_unstable_by(|a, b| key(a).total_cmp(&key(b)));
                let mut seen = 0;
                let found = measured.iter().find(|(_, _, points)| {
                    seen += points;
                    seen as f64 > share * count as f64
                });
                found.map(key)
            };
        let spacing = at_share(|m| m.0, FINEST_SHARE, &mut measured);
        let spacing_px = at_share(|m| m.1, 0.5, &mut measured);
        Ok(spacing.zip(spacing_px).map(|(spacing, spacing_px)| Density { spacing, spacing_px }))
    }

    /// Distance of points in an octant, the same in pixels, and the number of points.
    fn density_of(
        &mut self,
        region: &Region,
        octant: usize,
        view: &View,
    ) -> Result<Option<(f64, f64, usize)>, InputError> {
        let tree = self.clouds[region.tree].tree();
        let near = Neighbourhood::of(tree, region.node, octant, 0.0);
        let mut positions = vec![];
        for node in near.nodes(tree) {
            let points = self.node(region.tree, node)?;
            positions.extend(points.set.positions().filter(|p| near.holds(*p).is_some()));
        }
        if positions.len() < MEASURED_POINTS {
            return Ok(None);
        }
        let cloud = ibpr::Cloud::new(&[ibpr::Scan::new(&positions)], Vec3::ONE);
        let middle = positions.iter().sum::<DVec3>() / positions.len() as f64;
        let at = view.project(middle);
        Ok(cloud.ok().zip(at).map(|(cloud, at)| {
            let spacing = cloud.density_spacing();
            let per_unit = match view.projection() {
                Projection::Perspective { .. } => view.focal_px() / at.depth,
                Projection::Orthographic { .. } => view.focal_px(),
            };
            (spacing, spacing * per_unit, positions.len())
        }))
    }

    /// The points of a node, from the file or from those that are kept.
    fn node(&mut self, tree: usize, node: u32) -> Result<Arc<NodePoints>, InputError> {
        if let Some(points) = self.cache.get((tree, node)) {
            self.nodes_kept += 1;
            return Ok(points);
        }
        let mut set = self.measured(tree, node)?;
        let legend = set.colour(&self.colouring);
        let points = Arc::new(NodePoints { set, legend });
        self.cache.insert((tree, node), Arc::clone(&points), points.set.bytes());
        Ok(points)
    }

    /// The selected points of a node with what was measured, from the file.
    fn measured(&mut self, tree: usize, node: u32) -> Result<PointSet, InputError> {
        let cloud = &mut self.clouds[tree];
        let (count, most) = (cloud.tree().nodes()[node as usize].count, self.most_points);
        if count > most {
            let message = format!("a node has {count} points, but the memory is enough for {most}");
            return Err(InputError::of_file(&cloud.name, message).with_help("--memory gives more"));
        }
        let (records, bytes) = cloud.read(node)?;
        self.bytes_read += bytes;
        self.nodes_read += 1;
        let cloud = &self.clouds[tree];
        let mut taker = Taker::new(&self.options, &cloud.name);
        let mut set = PointSet::of_file(&cloud.path, tree);
        cloud.blocks(&records, &mut |block| {
            taker.take(block, &mut |block, values| {
                set.add(&block, values);
                Ok(())
            })
        })?;
        Ok(set)
    }

    /// Hash of what the clouds are, how they are read, and which of their nodes are drawn: how many can be depends on the memory.
    pub fn fingerprint(&self, cut: &Cut) -> u64 {
        let mut hash = XxHash3_64::default();
        for cloud in &self.clouds {
            hash.write(&cloud.fingerprint.to_le_bytes());
        }
        hash.write(format!("{:?} {:?}", self.options, self.colouring).as_bytes());
        for &(tree, node) in &cut.nodes {
            hash.write(&tree.to_le_bytes());
            hash.write(&node.to_le_bytes());
        }
        hash.finish()
    }
}
