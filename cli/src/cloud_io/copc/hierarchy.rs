//! The octree of a COPC file: what its head and its hierarchy say, checked before anything is allocated on their word.
//!
//! Positions are those of the COPC specification 1.0 (<https://copc.io>) and of LAS 1.4, table 3.
//!
//! 1. The head: a record of 160 bytes at byte 375 has the cube and where the first page of the hierarchy is.
//! 2. Pages: entries of 32 bytes, each for a node with points, an empty one, or another page. All pages together have no more bytes than the file, so
//!    that the walk ends even if they lead in circles.
//! 3. No two of pages and nodes share a byte, and nodes have no more points than the file.

use super::error::{CopcError, CopcKey};
use pointillist_octree::{Cube, Node, NodeKey, Tree};
use std::collections::HashSet;
use std::io::{Read, Seek, SeekFrom};

/// Bytes that tell a COPC file.
pub const COPC_HEAD_BYTES: usize = 589;

/// Where the data of the first record is, and its length.
const INFO: usize = 375 + 54;
const INFO_BYTES: u16 = 160;

/// Bytes of an entry.
const ENTRY_BYTES: u64 = 32;

/// Where the points of a node are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CopcChunk {
    /// First byte.
    pub offset: u64,
    /// Compressed bytes; 0 for a node without points.
    pub bytes: u32,
}

/// The octree of a COPC file, its nodes in the order of their points in the file.
#[derive(Clone, Debug)]
pub struct CopcHierarchy {
    /// Which nodes there are.
    pub tree: Tree,
    /// Where the points of each are.
    pub chunks: Vec<CopcChunk>,
    /// Points of the file by its header: at least those of the nodes.
    pub announced: u64,
}

/// Whether these are the first bytes of a COPC file: LAS whose first record is that of COPC.
#[must_use]
pub fn is_copc(head: &[u8]) -> bool {
    head.starts_with(b"LASF") && head.get(377..382) == Some(b"copc\0") && head.get(393..395) == Some(&[1, 0])
}

impl CopcHierarchy {
    /// Reads the head and the pages of a file.
    ///
    /// # Errors
    /// [`CopcError`] for the first thing that is wrong.
    pub fn read(input: &mut (impl Read + Seek)) -> Result<Self, CopcError> {
        let length = input.seek(SeekFrom::End(0))?;
        let mut head = vec![];
        input.rewind()?;
        input.by_ref().take(COPC_HEAD_BYTES as u64).read_to_end(&mut head)?;
        let info = Info::of(&head)?;
        let mut walk = Walk {
            input,
            length,
            announced: info.announced,
            points: 0,
            page_bytes: 0,
            seen: HashSet::new(),
            taken: vec![],
            found: vec![],
        };
        walk.pages(&info)?;
        let Walk { mut taken, mut found, .. } = walk;
        refuse_overlap(&mut taken)?;
        found.sort_by_key(|(node, chunk)| (chunk.offset, node.key));
        let (nodes, chunks) = found.into_iter().unzip();
        let tree = Tree::new(info.cube, info.spacing, nodes)?;
        Ok(Self { tree, chunks, announced: info.announced })
    }
}

/// What the head says.
struct Info {
    cube: Cube,
    spacing: f64,
    root_page: (u64, u64),
    announced: u64,
}

impl Info {
    fn of(head: &[u8]) -> Result<Self, CopcError> {
        if !is_copc(head) {
            return Err(CopcError::NotCopc("the first record is not that of COPC"));
        }
        if head.len() < COPC_HEAD_BYTES {
            return Err(CopcError::NotCopc("the file ends within its head"));
        }
        if head[24..26] != [1, 4] || head[94..96] != 375u16.to_le_bytes() {
            return Err(CopcError::NotCopc("the header is not that of LAS 1.4"));
        }
        // The two highest bits say that points are compressed.
        if !(head[104] & 0xc0 != 0 && (6..=8).contains(&(head[104] & 0x3f))) {
            return Err(CopcError::NotCopc("points are not compressed ones of format 6, 7 or 8"));
        }
        if head[395..397] != INFO_BYTES.to_le_bytes() {
            return Err(CopcError::NotCopc("the record of COPC has not 160 bytes"));
        }
        let word = |at: usize| u64::from_le_bytes(std::array::from_fn(|i| head[at + i]));
        let [x, y, z, half_size, spacing] = std::array::from_fn(|i| f64::from_bits(word(INFO + 8 * i)));
        let cube = Cube { low: glam::DVec3::new(x, y, z) - half_size, side: 2.0 * half_size };
        // Not `<=`, which NaN passes.
        if !(cube.is_valid() && spacing > 0.0 && spacing.is_finite()) {
            return Err(CopcError::BadCube { centre: [x, y, z], half_size, spacing });
        }
        Ok(Self { cube, spacing, root_page: (word(INFO + 40), word(INFO + 48)), announced: word(247) })
    }
}

/// A stretch of the file, and what is there.
struct Stretch {
    offset: u64,
    end: u64,
    key: CopcKey,
    is_page: bool,
}

impl Stretch {
    fn name(&self) -> String {
        name_of(self.key, self.is_page)
    }
}

fn name_of(key: CopcKey, is_page: bool) -> String {
    if is_page { format!("the page of node {key}") } else { format!("node {key}") }
}

/// A page that is still to be read.
struct Page {
    key: CopcKey,
    offset: u64,
    bytes: u64,
}

/// An entry of a page.
struct Entry {
    key: CopcKey,
    offset: u64,
    bytes: i32,
    points: i32,
}

impl Entry {
    fn of(bytes: &[u8]) -> Self {
        let word = |at: usize| i32::from_le_bytes(std::array::from_fn(|i| bytes[at + i]));
        Self {
            key: CopcKey([word(0), word(4), word(8), word(12)]),
            offset: u64::from_le_bytes(std::array::from_fn(|i| bytes[16 + i])),
            bytes: word(24),
            points: word(28),
        }
    }

    /// Its cube.
    fn node_key(&self) -> Result<NodeKey, CopcError> {
        let bad = CopcError::BadKey { key: self.key };
        let [level, x, y, z] = self.key.0;
        let (Ok(level), Ok(x), Ok(y), Ok(z)) =
            (u8::try_from(level), u32::try_from(x), u32::try_from(y), u32::try_from(z))
        else {
            return Err(bad);
        };
        let key = NodeKey { level, place: [x, y, z] };
        if key.is_valid() { Ok(key) } else { Err(bad) }
    }
}

/// Whether a node is in another one, or is that one.
fn is_within(inner: CopcKey, outer: CopcKey) -> bool {
    let ([level, rest @ ..], [outer_level, outer_rest @ ..]) = (inner.0, outer.0);
    (0..32).contains(&(level - outer_level)) && rest.map(|place| place >> (level - outer_level)) == outer_rest
}

struct Walk<'a, R> {
    input: &'a mut R,
    length: u64,
    announced: u64,
    points: u64,
    page_bytes: u64,
    /// Where pages are that were read.
    seen: HashSet<u64>,
    taken: Vec<Stretch>,
    found: Vec<(Node, CopcChunk)>,
}

impl<R: Read + Seek> Walk<'_, R> {
    fn pages(&mut self, info: &Info) -> Result<(), CopcError> {
        let (offset, bytes) = info.root_page;
        let mut pages = vec![Page { key: CopcKey([0; 4]), offset, bytes }];
        while let Some(page) = pages.pop() {
            let data = self.page(&page)?;
            for bytes in data.chunks_exact(ENTRY_BYTES as usize) {
                let entry = Entry::of(bytes);
                let key = entry.node_key()?;
                if !is_within(entry.key, page.key) {
                    return Err(CopcError::WrongPage { key: entry.key, page: page.key });
                }
                if entry.points == -1 {
                    let bytes = u64::try_from(entry.bytes).unwrap_or(0);
                    pages.push(Page { key: entry.key, offset: entry.offset, bytes });
                } else {
                    self.node(&entry, key)?;
                }
            }
        }
        Ok(())
    }

    /// The bytes of a page.
    fn page(&mut self, page: &Page) -> Result<Vec<u8>, CopcError> {
        let what = || name_of(page.key, true);
        if page.bytes == 0 || !page.bytes.is_multiple_of(ENTRY_BYTES) {
            return Err(CopcError::BadPage { what: what(), bytes: page.bytes });
        }
        self.take(page.key, true, page.offset, page.bytes)?;
        self.page_bytes += page.bytes;
        if !self.seen.insert(page.offset) || self.page_bytes > self.length {
            // The same page again, or more pages than there is room for: some share bytes.
            refuse_overlap(&mut self.taken)?;
        }
        let mut data = vec![0; page.bytes as usize];
        self.input.seek(SeekFrom::Start(page.offset))?;
        self.input.read_exact(&mut data)?;
        Ok(data)
    }

    fn node(&mut self, entry: &Entry, key: NodeKey) -> Result<(), CopcError> {
        let count = u64::try_from(entry.points).ok();
        let bytes = u32::try_from(entry.bytes).ok();
        let (Some(count), Some(bytes)) = (count, bytes.filter(|&bytes| bytes > 0 || entry.points == 0))
        else {
            return Err(CopcError::BadCount { key: entry.key, points: entry.points, bytes: entry.bytes });
        };
        self.points = self.points.saturating_add(count);
        if self.points > self.announced {
            return Err(CopcError::TooManyPoints { nodes: self.points, file: self.announced });
        }
        let chunk = if count == 0 {
            CopcChunk { offset: 0, bytes: 0 }
        } else {
            self.take(entry.key, false, entry.offset, bytes.into())?;
            CopcChunk { offset: entry.offset, bytes }
        };
        self.found.push((Node { key, count }, chunk));
        Ok(())
    }

    /// Keeps a stretch of the file in mind, which must be within it.
    fn take(&mut self, key: CopcKey, is_page: bool, offset: u64, bytes: u64) -> Result<(), CopcError> {
        let end = offset.checked_add(bytes).filter(|&end| end <= self.length).ok_or_else(|| {
            let what = name_of(key, is_page);
            CopcError::OutsideFile { what, offset, bytes, length: self.length }
        })?;
        self.taken.push(Stretch { offset, end, key, is_page });
        Ok(())
    }
}

fn refuse_overlap(taken: &mut [Stretch]) -> Result<(), CopcError> {
    taken.sort_by_key(|stretch| (stretch.offset, stretch.end));
    let pair = taken.windows(2).find(|pair| pair[1].offset < pair[0].end);
    pair.map_or(Ok(()), |pair| {
        Err(CopcError::Overlap { what: pair[1].name(), offset: pair[1].offset, other: pair[0].name() })
    })
}
