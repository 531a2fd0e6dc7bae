//! Writes COPC 1.0 and plain LAS 1.4 of the same records, byte for byte as the specifications have them.

use laz::{LasZipCompressor, LazItemRecordBuilder, LazItemType, LazVlrBuilder};
use std::collections::BTreeSet;
use std::io::{Cursor, Seek, Write};

/// Units of coordinates in a file.
pub(crate) const SCALE: f64 = 1e-4;

/// A point of format 7.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CopcPoint {
    pub(crate) place: [i32; 3],
    pub(crate) colour: [u16; 3],
    pub(crate) class: u8,
}

impl CopcPoint {
    const BYTES: usize = 36;

    fn record(self) -> [u8; Self::BYTES] {
        let mut record = [0; Self::BYTES];
        for (axis, place) in self.place.into_iter().enumerate() {
            record[4 * axis..4 * axis + 4].copy_from_slice(&place.to_le_bytes());
        }
        // The first of one return.
        record[14] = 0x11;
        record[16] = self.class;
        for (channel, code) in self.colour.into_iter().enumerate() {
            record[30 + 2 * channel..32 + 2 * channel].copy_from_slice(&code.to_le_bytes());
        }
        record
    }
}

/// A node: its key, and its points.
pub(crate) type CopcNode = ([i32; 4], Vec<CopcPoint>);

/// The cube of a file's octree.
pub(crate) struct CopcCube {
    pub(crate) centre: [f64; 3],
    pub(crate) half_size: f64,
    pub(crate) spacing: f64,
}

/// A COPC file.
pub(crate) struct Copc {
    pub(crate) bytes: Vec<u8>,
    /// Where its first page is.
    pub(crate) page: usize,
    /// Entries of that page.
    pub(crate) entries: usize,
}

impl Copc {
    /// Writes nodes, the root first; with `paged`, all below the root are in a page for each node of level 1.
    pub(crate) fn of(cube: &CopcCube, nodes: &[CopcNode], paged: bool) -> Self {
        let items =
            LazItemRecordBuilder::new().add_item(LazItemType::Point14).add_item(LazItemType::RGB14).build();
        let laz = LazVlrBuilder::new(items).with_variable_chunk_size().build();
        let mut laz_bytes = vec![];
        laz.write_to(&mut laz_bytes).unwrap();
        let points = 589 + 54 + laz_bytes.len();
        let count: usize = nodes.iter().map(|(_, points)| points.len()).sum();
        let mut head = header(0x80 | 7, points, 2, count);
        head.extend(record_header("copc", 1, 160));
        head.resize(589, 0);
        head.extend(record_header("laszip encoded", 22204, laz_bytes.len() as u16));
        head.extend(laz_bytes);

        let mut file = Cursor::new(head);
        file.set_position(points as u64);
        let mut compressor = LasZipCompressor::new(file, laz).unwrap();
        compressor.reserve_offset_to_chunk_table().unwrap();
        let mut entries = vec![];
        for (key, points) in nodes {
            let begin = compressor.get_mut().stream_position().unwrap();
            if !points.is_empty() {
                let records: Vec<u8> = points.iter().flat_map(|point| point.record()).collect();
                compressor.compress_many(&records).unwrap();
                compressor.finish_current_chunk().unwrap();
            }
            let end = compressor.get_mut().stream_position().unwrap();
            let offset = if points.is_empty() { 0 } else { begin };
            entries.push(entry(*key, offset, (end - begin) as i32, points.len() as i32));
        }
        compressor.done().unwrap();
        let mut bytes = compressor.into_inner().into_inner();
        let (page, hierarchy_at) = append_hierarchy(&mut bytes, nodes, &entries, paged);
        let info = [cube.centre[0], cube.centre[1], cube.centre[2], cube.half_size, cube.spacing];
        for (i, value) in info.into_iter().enumerate() {
            bytes[429 + 8 * i..437 + 8 * i].copy_from_slice(&value.to_le_bytes());
        }
        bytes[469..477].copy_from_slice(&(page.0 as u64).to_le_bytes());
        bytes[477..485].copy_from_slice(&(page.1 as u64).to_le_bytes());
        bytes[235..243].copy_from_slice(&(hierarchy_at as u64).to_le_bytes());
        bytes[243..247].copy_from_slice(&1u32.to_le_bytes());
        Self { bytes, page: page.0, entries: page.1 / 32 }
    }

    /// Changes a number of 32 bits of an entry of the first page: its key's four, then 6 the bytes and 7 the points.
    pub(crate) fn with_entry(mut self, entry: usize, word: usize, value: i32) -> Self {
        let at = self.page + 32 * entry + 4 * word;
        self.bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        self
    }

    /// Changes where the bytes of an entry of the first page are.
    pub(crate) fn with_offset(mut self, entry: usize, offset: u64) -> Self {
        let at = self.page + 32 * entry + 16;
        self.bytes[at..at + 8].copy_from_slice(&offset.to_le_bytes());
        self
    }
}

/// The same points as LAS, one after the other.
pub(crate) fn las_of(nodes: &[CopcNode]) -> Vec<u8> {
    let points: Vec<&CopcPoint> = nodes.iter().flat_map(|(_, points)| points).collect();
    let mut bytes = header(7, 375, 0, points.len());
    points.iter().for_each(|point| bytes.extend(point.record()));
    bytes
}

fn header(format: u8, points_at: usize, records: u32, count: usize) -> Vec<u8> {
    let mut head = vec![0; 375];
    let mut put = |at: usize, bytes: &[u8]| head[at..at + bytes.len()].copy_from_slice(bytes);
    put(0, b"LASF");
    // Coordinate systems are named by WKT, as for all points of formats from 6 on.
    put(6, &[0x10, 0]);
    put(24, &[1, 4]);
    put(94, &375u16.to_le_bytes());
    put(96, &(points_at as u32).to_le_bytes());
    put(100, &records.to_le_bytes());
    put(104, &[format]);
    put(105, &(CopcPoint::BYTES as u16).to_le_bytes());
    for axis in 0..3 {
        put(131 + 8 * axis, &SCALE.to_le_bytes());
    }
    put(247, &(count as u64).to_le_bytes());
    put(255, &(count as u64).to_le_bytes());
    head
}

fn record_header(user: &str, record: u16, length: u16) -> Vec<u8> {
    let mut bytes = vec![0; 54];
    bytes[2..2 + user.len()].copy_from_slice(user.as_bytes());
    bytes[18..20].copy_from_slice(&record.to_le_bytes());
    bytes[20..22].copy_from_slice(&length.to_le_bytes());
    bytes
}

fn entry(key: [i32; 4], offset: u64, bytes: i32, points: i32) -> Vec<u8> {
    let mut entry = vec![];
    key.iter().for_each(|number| entry.write_all(&number.to_le_bytes()).unwrap());
    entry.extend(offset.to_le_bytes());
    entry.extend(bytes.to_le_bytes());
    entry.extend(points.to_le_bytes());
    entry
}

/// Appends the record of the hierarchy; gives place and length of the first page, and the place of the record.
fn append_hierarchy(
    bytes: &mut Vec<u8>,
    nodes: &[CopcNode],
    entries: &[Vec<u8>],
    paged: bool,
) -> ((usize, usize), usize) {
    let at = bytes.len();
    let first = at + 60;
    // The node of level 1 that another one is in, which has its page.
    let branch = |&[level, x, y, z]: &[i32; 4]| {
        (paged && level > 0).then(|| [1, x >> (level - 1), y >> (level - 1), z >> (level - 1)])
    };
    let branches: BTreeSet<[i32; 4]> = nodes.iter().filter_map(|(key, _)| branch(key)).collect();
    let in_page = |wanted: Option<[i32; 4]>| {
        let own = nodes.iter().zip(entries).filter(move |((key, _), _)| branch(key) == wanted);
        own.flat_map(|(_, entry)| entry.clone())
    };
    let mut page: Vec<u8> = in_page(None).collect();
    let length = page.len() + 32 * branches.len();
    let mut below = vec![];
    for key in branches {
        let own: Vec<u8> = in_page(Some(key)).collect();
        page.extend(entry(key, (first + length + below.len()) as u64, own.len() as i32, -1));
        below.extend(own);
    }
    let mut head = vec![0; 60];
    head[2..6].copy_from_slice(b"copc");
    head[18..20].copy_from_slice(&1000u16.to_le_bytes());
    head[20..28].copy_from_slice(&((length + below.len()) as u64).to_le_bytes());
    bytes.extend(head);
    bytes.extend(page);
    bytes.extend(below);
    ((first, length), at)
}
