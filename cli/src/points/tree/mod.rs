//! Clouds larger than memory: an octree of each, of which a view reads the nodes that it needs.

mod make;
mod record;

use super::PointSet;
use super::reading::{PointOptions, Taker};
use crate::input;
use crate::input_error::InputError;
use crate::job::Progress;
use crate::memory;
use pointillist_octree::{Cut, CutOptions, NodeCache, TREE_MARK, Tree, TreeReader, cut};
use pointillist_view::View;
use record::{Columns, Fields};
use std::fs::File;
use std::hash::Hasher as _;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use twox_hash::XxHash3_64;

/// Bytes of a point that is drawn: see `PointSet`; and what is kept of it besides.
const DRAWN_BYTES: u64 = 560;

/// Shares of the memory: for points that are drawn, and for nodes that are kept for the next view.
const DRAWN_SHARE: f64 = 0.65;
const KEPT_SHARE: f64 = 0.15;

/// Points of a picture that is there at once.
const COARSE_POINTS: u64 = 150_000;

/// The clouds of a picture, as trees.
#[derive(Debug)]
pub struct Trees {
    clouds: Vec<TreeCloud>,
    cache: NodeCache<Vec<u8>>,
    most_points: u64,
    options: PointOptions,
    /// Bytes read from files so far, of nodes.
    pub bytes_read: u64,
    /// Nodes that were read, and that were kept from earlier views.
    pub nodes_read: u64,
    /// See [`Self::nodes_read`].
    pub nodes_kept: u64,
}

#[derive(Debug)]
struct TreeCloud {
    path: PathBuf,
    name: String,
    reader: TreeReader<File>,
    fields: Fields,
}

/// Whether a cloud is drawn from an octree: it is one, it is asked for, or its points do not fit into memory.
pub fn is_large(path: &Path, wanted: bool) -> bool {
    if input::is_standard(path) {
        return false;
    }
    let Ok(mut file) = File::open(path) else { return false };
    let mut head = vec![];
    if (&mut file).take(256).read_to_end(&mut head).is_err() {
        return false;
    }
    let length = file.seek(SeekFrom::End(0)).unwrap_or(0);
    let available = memory::available_bytes().unwrap_or(u64::MAX);
    head.starts_with(TREE_MARK)
        || wanted
        || expected_points(&head, length).saturating_mul(DRAWN_BYTES) > available
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
        progress: &Progress,
        tell: &dyn Fn(&str),
    ) -> Result<Self, InputError> {
        let memory = memory::available_bytes().unwrap_or(8 << 30);
        let share = |share: f64| (memory as f64 * share) as u64;
        let clouds = paths.iter().map(|path| TreeCloud::open(path, &options, memory, progress, tell));
        Ok(Self {
            clouds: clouds.collect::<Result<_, _>>()?,
            cache: NodeCache::new(share(KEPT_SHARE)),
            most_points: share(DRAWN_SHARE) / DRAWN_BYTES,
            options,
            bytes_read: 0,
            nodes_read: 0,
            nodes_kept: 0,
        })
    }

    /// Points of all clouds.
    pub fn points(&self) -> u64 {
        self.clouds.iter().map(|cloud| cloud.reader.tree().points()).sum()
    }

    /// The nodes that a view needs.
    pub fn cut(&self, view: &View, spacing_px: f64, margin_px: f64) -> Cut {
        let options = CutOptions::default().with_spacing_px(spacing_px).with_margin_px(margin_px);
        cut(&self.shapes(), view, &options.with_most_points(self.most_points))
    }

    /// The beginning of a cut: a picture that is there at once. Nothing if the cut is not much larger.
    pub fn coarse(&self, cut: &Cut) -> Option<Cut> {
        if cut.points < 4 * COARSE_POINTS {
            return None;
        }
        let mut coarse = Cut { spacing_px: f64::INFINITY, is_limited: true, ..Cut::default() };
        for &(tree, node) in &cut.nodes {
            coarse.points += self.clouds[tree].reader.tree().nodes()[node as usize].count;
            if coarse.points > COARSE_POINTS && !coarse.nodes.is_empty() {
                coarse.points -= self.clouds[tree].reader.tree().nodes()[node as usize].count;
                break;
            }
            coarse.nodes.push((tree, node));
        }
        Some(coarse)
    }

    /// The roots: for a camera that has everything in view.
    pub fn roots(&self) -> Cut {
        let roots = self.shapes().into_iter().enumerate().filter_map(|(tree, t)| Some((tree, t.root()?)));
        Cut { nodes: roots.collect(), ..Cut::default() }
    }

    fn shapes(&self) -> Vec<&Tree> {
        self.clouds.iter().map(|cloud| cloud.reader.tree()).collect()
    }

    /// The points of a cut; `done` is told after each node.
    ///
    /// # Errors
    ///
    /// [`InputError`] for a node that is damaged, or points without what is asked for.
    pub fn load(&mut self, cut: &Cut, done: &mut dyn FnMut()) -> Result<PointSet, InputError> {
        let mut nodes = cut.nodes.clone();
        // By file and place in it; the picture does not depend on the order.
        nodes.sort_unstable();
        let mut set = PointSet::empty();
        let mut last = None;
        for (tree, node) in nodes {
            let records = self.node(tree, node)?;
            let cloud = &self.clouds[tree];
            if last.replace(tree) != Some(tree) {
                set.begin(&cloud.path);
            }
            let columns = Columns::decode(&records, cloud.fields, &cloud.reader.tree().cube());
            Taker::new(&self.options, &cloud.name).take(columns.block(), &mut |block, values| {
                set.add(&block, values);
                Ok(())
            })?;
            done();
        }
        Ok(set)
    }

    fn node(&mut self, tree: usize, node: u32) -> Result<Arc<Vec<u8>>, InputError> {
        if let Some(records) = self.cache.get((tree, node)) {
            self.nodes_kept += 1;
            return Ok(records);
        }
        let cloud = &mut self.clouds[tree];
        let records = cloud.reader.read(node).map_err(|error| {
            let tree = make::path_of(&cloud.path);
            let file = if tree.exists() { tree } else { cloud.path.clone() };
            InputError::of_file(file.display().to_string(), format!("the octree is damaged: {error}"))
                .with_help("remove this file; it is made again from the cloud")
        })?;
        self.bytes_read += records.len() as u64;
        self.nodes_read += 1;
        let records = Arc::new(records);
        self.cache.insert((tree, node), Arc::clone(&records), records.len() as u64);
        Ok(records)
    }

    /// Hash of what the clouds are, and how they are read.
    pub fn fingerprint(&self) -> u64 {
        let mut hash = XxHash3_64::default();
        for cloud in &self.clouds {
            hash.write(&cloud.reader.header().fingerprint.to_le_bytes());
        }
        hash.write(format!("{:?} {}", self.options, self.most_points).as_bytes());
        hash.finish()
    }
}

impl TreeCloud {
    fn open(
        path: &Path,
        options: &PointOptions,
        memory: u64,
        progress: &Progress,
        tell: &dyn Fn(&str),
    ) -> Result<Self, InputError> {
        let name = input::name_of(path);
        let reader = if is_tree(path) {
            let damaged = |error: pointillist_octree::OctreeError| {
                InputError::of_file(&name, error.to_string())
                    .with_help("remove it, and draw from the cloud that it was made from")
            };
            let file = File::open(path).map_err(|error| input::cannot_read(&name, &error))?;
            TreeReader::new(file).map_err(damaged)?
        } else {
            Self::beside(path, &name, options, memory, progress, tell)?
        };
        let header = *reader.header();
        let fields = Fields::from_layout(header.layout, header.payload).ok_or_else(|| {
            InputError::of_file(&name, "the octree is of another version")
                .with_help("remove it; it is made again from the cloud")
        })?;
        Ok(Self { path: path.to_owned(), name, reader, fields })
    }

    /// The octree beside a cloud, which is made if there is none of this cloud.
    fn beside(
        path: &Path,
        name: &str,
        options: &PointOptions,
        memory: u64,
        progress: &Progress,
        tell: &dyn Fn(&str),
    ) -> Result<TreeReader<File>, InputError> {
        let cannot_read = |error: std::io::Error| input::cannot_read(name, &error);
        let fingerprint = make::fingerprint(path, options.drop_invalid).map_err(cannot_read)?;
        let tree = make::path_of(path);
        if let Some(reader) = make::open(&tree, fingerprint) {
            return Ok(reader);
        }
        let why =
            if tree.exists() { "is damaged or of another file, and is made anew" } else { "is made, once" };
        tell(&format!("{} {why}", tree.display()));
        make::make(path, options.drop_invalid, fingerprint, memory / 2, progress)?;
        make::open(&tree, fingerprint).ok_or_else(|| {
            InputError::of_file(tree.display().to_string(), "the octree that was just written cannot be read")
                .with_help("is something else writing to this folder?")
        })
    }
}

/// Whether a file is an octree of ours.
fn is_tree(path: &Path) -> bool {
    let mut head = [0; TREE_MARK.len()];
    File::open(path).and_then(|mut file| file.read_exact(&mut head)).is_ok() && &head == TREE_MARK
}
