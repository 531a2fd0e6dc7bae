//! Records of many buckets in one temporary file, in blocks, so that the file needs few seeks and blocks that are free are used again.

use std::io::{self, Read, Seek, SeekFrom, Write};

/// Bytes of a block of the file, about. Eight thousand buckets' last blocks would be in memory at once; there are at most 512 and those of the levels above.
pub(crate) const BLOCK_BYTES: usize = 1 << 16;

/// What was put into a bucket and is not yet taken out.
#[derive(Clone, Debug, Default)]
pub(crate) struct Bucket {
    /// Blocks of the file, all of them full.
    blocks: Vec<u64>,
    /// What does not fill a block yet.
    rest: Vec<u8>,
    pub(crate) records: u64,
}

/// The temporary file.
#[derive(Debug)]
pub(crate) struct Spill<F> {
    file: F,
    /// Bytes of a record.
    stride: usize,
    block_bytes: usize,
    /// Blocks that the file has.
    end: u64,
    free: Vec<u64>,
}

impl<F: Read + Write + Seek> Spill<F> {
    pub(crate) fn new(file: F, stride: usize) -> Self {
        let block_bytes = (BLOCK_BYTES / stride).max(1) * stride;
        Self { file, stride, block_bytes, end: 0, free: vec![] }
    }

    /// Adds a record.
    pub(crate) fn put(&mut self, bucket: &mut Bucket, record: &[u8]) -> io::Result<()> {
        debug_assert_eq!(record.len(), self.stride, "records are of one length");
        if bucket.rest.capacity() == 0 {
            bucket.rest.reserve_exact(self.block_bytes);
        }
        bucket.rest.extend_from_slice(record);
        bucket.records += 1;
        if bucket.rest.len() == self.block_bytes {
            let block = self.free.pop().unwrap_or_else(|| {
                self.end += 1;
                self.end - 1
            });
            self.file.seek(SeekFrom::Start(block * self.block_bytes as u64))?;
            self.file.write_all(&bucket.rest)?;
            bucket.blocks.push(block);
            bucket.rest.clear();
        }
        Ok(())
    }

    /// Takes all records out, block by block; the bucket is empty after that.
    pub(crate) fn take(
        &mut self,
        bucket: &mut Bucket,
        mut sink: impl FnMut(&mut Self, &[u8]) -> io::Result<()>,
    ) -> io::Result<()> {
        let taken = std::mem::take(bucket);
        let mut bytes = vec![0; self.block_bytes];
        for block in taken.blocks {
            self.file.seek(SeekFrom::Start(block * self.block_bytes as u64))?;
            self.file.read_exact(&mut bytes)?;
            self.free.push(block);
            sink(self, &bytes)?;
        }
        sink(self, &taken.rest)
    }
}
