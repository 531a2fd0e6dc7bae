//! A tree as a file: header, nodes, table of nodes, trailer.
//!
//! Little endian throughout. The header has a mark, a hash of what the tree was made from, the cube and the bytes of a payload. The table has for each node its
//! name, where it is, its points and a hash of them. The trailer says where the table is, with a hash of header and table and a mark, so that a
//! file that was cut off is found to be.

use crate::build::POSITION_BYTES;
use crate::cube::Cube;
use crate::error::OctreeError;
use crate::key::NodeKey;
use crate::sample::GRID_BITS;
use crate::tree::{Node, Tree};
use glam::DVec3;
use std::io::{self, Read, Seek, SeekFrom, Write};
use twox_hash::XxHash3_64;

/// How every file begins.
pub const MARK: &[u8; 8] = b"PTOCTRE1";
const END_MARK: &[u8; 8] = b"1ERTCOTP";
const HEADER_BYTES: usize = 56;
const ENTRY_BYTES: usize = 40;
const TRAILER_BYTES: usize = 32;

/// What a file says about itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TreeHeader {
    /// Of what the tree was made from: two files with one fingerprint have the same points.
    pub fingerprint: u64,
    /// The cube of the whole tree.
    pub cube: Cube,
    /// Bytes of each point behind its position.
    pub payload: u32,
    /// What those bytes are: any number of the caller's.
    pub layout: u32,
}

impl TreeHeader {
    fn to_bytes(self) -> [u8; HEADER_BYTES] {
        let mut bytes = [0; HEADER_BYTES];
        bytes[..8].copy_from_slice(MARK);
        bytes[8..16].copy_from_slice(&self.fingerprint.to_le_bytes());
        let cube = self.cube.low.to_array().into_iter().chain([self.cube.side]);
        bytes[16..48].chunks_exact_mut(8).zip(cube).for_each(|(b, v)| b.copy_from_slice(&v.to_le_bytes()));
        bytes[48..52].copy_from_slice(&self.payload.to_le_bytes());
        bytes[52..].copy_from_slice(&self.layout.to_le_bytes());
        bytes
    }

    fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let number = |at: usize| f64::from_bits(u64_at(bytes, at));
        let cube = Cube { low: DVec3::new(number(16), number(24), number(32)), side: number(40) };
        let (payload, layout) = (u64_at(bytes, 48) as u32, (u64_at(bytes, 48) >> 32) as u32);
        let is_sound = bytes.starts_with(MARK) && cube.is_valid() && payload <= 1 << 16;
        is_sound.then(|| Self { fingerprint: u64_at(bytes, 8), cube, payload, layout })
    }
}

fn u64_at(bytes: &[u8], at: usize) -> u64 {
    let mut number = [0; 8];
    number.copy_from_slice(&bytes[at..at + 8]);
    u64::from_le_bytes(number)
}

#[derive(Clone, Copy, Debug)]
struct Place {
    offset: u64,
    hash: u64,
}

/// Writes a tree, node by node.
#[derive(Debug)]
pub struct TreeWriter<W> {
    output: W,
    header: [u8; HEADER_BYTES],
    stride: usize,
    offset: u64,
    table: Vec<u8>,
}

impl<W: Write> TreeWriter<W> {
    /// Begins a file.
    ///
    /// # Errors
    /// That of `output`.
    pub fn new(mut output: W, header: &TreeHeader) -> io::Result<Self> {
        let stride = POSITION_BYTES + header.payload as usize;
        let header = header.to_bytes();
        output.write_all(&header)?;
        Ok(Self { output, header, stride, offset: HEADER_BYTES as u64, table: vec![] })
    }

    /// Adds a node.
    ///
    /// # Errors
    /// That of the output.
    pub fn node(&mut self, key: NodeKey, records: &[u8]) -> io::Result<()> {
        self.output.write_all(records)?;
        let [x, y, z] = key.place;
        let count = (records.len() / self.stride) as u32;
        for number in [u32::from(key.level), x, y, z, count, 0] {
            self.table.extend_from_slice(&number.to_le_bytes());
        }
        self.table.extend_from_slice(&self.offset.to_le_bytes());
        self.table.extend_from_slice(&XxHash3_64::oneshot(records).to_le_bytes());
        self.offset += records.len() as u64;
        Ok(())
    }

    /// Ends the file; gives the output back.
    ///
    /// # Errors
    /// That of the output.
    pub fn finish(mut self) -> io::Result<W> {
        self.output.write_all(&self.table)?;
        let entries = (self.table.len() / ENTRY_BYTES) as u64;
        let hash = hash_of(&self.header, &self.table);
        for number in [self.offset, entries, hash] {
            self.output.write_all(&number.to_le_bytes())?;
        }
        self.output.write_all(END_MARK)?;
        self.output.flush()?;
        Ok(self.output)
    }
}

fn hash_of(header: &[u8], table: &[u8]) -> u64 {
    XxHash3_64::oneshot_with_seed(XxHash3_64::oneshot(header), table)
}

/// Reads a tree, and nodes of it.
#[derive(Debug)]
pub struct TreeReader<R> {
    input: R,
    header: TreeHeader,
    tree: Tree,
    places: Vec<Place>,
}

impl<R: Read + Seek> TreeReader<R> {
    /// Reads everything but the points. Takes memory for the table of nodes, which is never longer than the file.
    ///
    /// # Errors
    /// [`OctreeError::NotATree`], [`OctreeError::Damaged`] and all that [`Tree::new`] refuses; [`OctreeError::Io`].
    pub fn new(mut input: R) -> Result<Self, OctreeError> {
        let size = input.seek(SeekFrom::End(0))?;
        let least = (HEADER_BYTES + TRAILER_BYTES) as u64;
        if size < least {
            return Err(OctreeError::NotATree);
        }
        let head = bytes_at(&mut input, 0, HEADER_BYTES)?;
        let header = TreeHeader::from_bytes(&head).ok_or(OctreeError::NotATree)?;
        let trailer = bytes_at(&mut input, size - TRAILER_BYTES as u64, TRAILER_BYTES)?;
        let damaged = |what: &str| OctreeError::Damaged { what: what.to_owned() };
        let (table_at, entries) = (u64_at(&trailer, 0), u64_at(&trailer, 8));
        let table_bytes = entries.checked_mul(ENTRY_BYTES as u64);
        let end =
            table_bytes.and_then(|bytes| bytes.checked_add(table_at)?.checked_add(TRAILER_BYTES as u64));
        if &trailer[24..] != END_MARK || table_at < HEADER_BYTES as u64 || end != Some(size) {
            return Err(damaged("the end of the file"));
        }
        let table = bytes_at(&mut input, table_at, table_bytes.unwrap_or(0) as usize)?;
        if hash_of(&head, &table) != u64_at(&trailer, 16) {
            return Err(damaged("the table of nodes"));
        }
        let stride = (POSITION_BYTES + header.payload as usize) as u64;
        let (mut nodes, mut places) = (vec![], vec![]);
        for entry in table.chunks_exact(ENTRY_BYTES) {
            let number = |at: usize| u64_at(entry, at) as u32;
            let level = u8::try_from(number(0)).unwrap_or(u8::MAX);
            let key = NodeKey { level, place: [number(4), number(8), number(12)] };
            let count = u64::from(number(16));
            let offset = u64_at(entry, 24);
            if offset.checked_add(count * stride).is_none_or(|end| end > table_at) {
                return Err(damaged("the place of a node"));
            }
            nodes.push(Node { key, count });
            places.push(Place { offset, hash: u64_at(entry, 32) });
        }
        let tree = Tree::new(header.cube, header.cube.side / f64::from(1u32 << GRID_BITS), nodes)?;
        Ok(Self { input, header, tree, places })
    }

    /// What the file says about itself.
    pub fn header(&self) -> &TreeHeader {
        &self.header
    }

    /// Its nodes.
    pub fn tree(&self) -> &Tree {
        &self.tree
    }

    /// The records of a node: for each point its lattice cell (three whole numbers of 32 bits, lowest byte first) and its payload.
    ///
    /// # Errors
    /// [`OctreeError::Damaged`] if they are not those that were written; [`OctreeError::Io`].
    ///
    /// # Panics
    /// If there is no such node.
    pub fn read(&mut self, node: u32) -> Result<Vec<u8>, OctreeError> {
        let place = self.places[node as usize];
        let stride = POSITION_BYTES + self.header.payload as usize;
        let length = self.tree.nodes()[node as usize].count as usize * stride;
        let records = bytes_at(&mut self.input, place.offset, length)?;
        if XxHash3_64::oneshot(&records) != place.hash {
            return Err(OctreeError::Damaged { what: format!("node {node}") });
        }
        Ok(records)
    }
}

fn bytes_at(input: &mut (impl Read + Seek), at: u64, length: usize) -> io::Result<Vec<u8>> {
    input.seek(SeekFrom::Start(at))?;
    let mut bytes = vec![0; length];
    input.read_exact(&mut bytes)?;
    Ok(bytes)
}
