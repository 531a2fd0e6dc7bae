//! A disk that is full, wherever that is noticed.

use glam::DVec3;
use pointillist_octree::{Builder, Cube, OctreeError, TreeHeader, TreeReader, TreeWriter};
use std::io::{self, Cursor, Read, Seek, SeekFrom, Write};

/// A file that has room for so many bytes.
struct Disk {
    file: Cursor<Vec<u8>>,
    room: usize,
}

impl Disk {
    fn new(room: usize) -> Self {
        Self { file: Cursor::new(vec![]), room }
    }
}

impl Write for Disk {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let left = self.room.saturating_sub(self.file.position() as usize);
        if left == 0 && !bytes.is_empty() {
            return Err(io::ErrorKind::StorageFull.into());
        }
        self.file.write(&bytes[..left.min(bytes.len())])
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Read for Disk {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        self.file.read(bytes)
    }
}

impl Seek for Disk {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

const POINTS: u32 = 30_000;

/// Builds a tree with these bytes of room for the temporary file and for the tree.
fn build(spill: usize, output: usize) -> Result<Vec<u8>, OctreeError> {
    let cube = Cube::around(DVec3::ZERO, DVec3::ONE)?;
    let mut builder = Builder::new(cube, 4, 0, Disk::new(spill)).with_most_in_memory(1000);
    for i in 0..POINTS {
        // In one bucket of the first 512, so that its blocks go to the temporary file.
        let place = |factor: u32| 0.1 * f64::from(i.wrapping_mul(factor) >> 16) / 65_536.0;
        let position = DVec3::new(place(2_654_435_769), place(2_246_822_507), place(3_266_489_909));
        builder.push(position, &i.to_le_bytes())?;
    }
    let header = TreeHeader { fingerprint: 7, cube, payload: 4, layout: 0 };
    let mut writer = TreeWriter::new(Disk::new(output), &header)?;
    builder.finish(&mut |key, records| writer.node(key, records), &mut |_| ())?;
    Ok(writer.finish()?.file.into_inner())
}

fn is_full(result: &Result<Vec<u8>, OctreeError>) -> bool {
    matches!(result, Err(OctreeError::Io(error)) if error.kind() == io::ErrorKind::StorageFull)
}

#[test]
fn a_full_disk_is_an_error_wherever_it_is_noticed() {
    let whole = build(usize::MAX, usize::MAX).unwrap();
    assert_eq!(TreeReader::new(Cursor::new(whole.clone())).unwrap().tree().points(), POINTS.into());
    // Header, nodes, table and trailer: the last byte counts.
    for room in [0, 1, 55, 56, 5000, whole.len() / 2, whole.len() - 40, whole.len() - 32, whole.len() - 1] {
        assert!(is_full(&build(usize::MAX, room)), "{room} of {}", whole.len());
    }
    assert_eq!(build(usize::MAX, whole.len()).unwrap(), whole);
    for room in [0, 1, 100_000, 400_000] {
        assert!(is_full(&build(room, usize::MAX)), "{room} for the temporary file");
    }
}

#[test]
fn what_was_written_before_the_disk_was_full_is_no_tree() {
    let whole = build(usize::MAX, usize::MAX).unwrap();
    for room in (0..whole.len()).step_by(977).chain([whole.len() - 1]) {
        assert!(TreeReader::new(Cursor::new(whole[..room].to_vec())).is_err(), "{room}");
    }
}
