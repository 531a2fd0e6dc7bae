//! Any bytes as the head and the hierarchy of a COPC file: a tree whose nodes lie in the file, each in bytes of its own, or an error that can be shown.
//!
//! Bytes are tried as they are and, since the fuzzer would never find all marks of the head, once more with those put in.
#![no_main]

use libfuzzer_sys::fuzz_target;
use pointillist_cli::cloud_io::{COPC_HEAD_BYTES, CopcHierarchy, is_copc};
use std::io::Cursor;

/// Writes the marks of LAS 1.4 with compressed points of format 7 and of COPC.
fn with_marks(bytes: &[u8]) -> Vec<u8> {
    let mut file = bytes.to_vec();
    file.resize(file.len().max(COPC_HEAD_BYTES), 0);
    let mut put = |at: usize, mark: &[u8]| file[at..at + mark.len()].copy_from_slice(mark);
    put(0, b"LASF");
    put(24, &[1, 4]);
    put(94, &375u16.to_le_bytes());
    put(104, &[0x87]);
    put(377, b"copc\0");
    put(393, &[1, 0, 160, 0]);
    file
}

fn check(file: &[u8]) {
    let hierarchy = match CopcHierarchy::read(&mut Cursor::new(file)) {
        Ok(hierarchy) => hierarchy,
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    assert!(is_copc(file));
    let nodes = hierarchy.tree.nodes();
    assert_eq!(nodes.len(), hierarchy.chunks.len());
    assert!(nodes.iter().map(|node| node.count).sum::<u64>() <= hierarchy.announced);
    let mut end = 0;
    for (node, chunk) in nodes.iter().zip(&hierarchy.chunks) {
        assert_eq!(node.count > 0, chunk.bytes > 0);
        if node.count > 0 {
            assert!(chunk.offset >= end, "nodes are in the order of the file, and share no byte");
            end = chunk.offset + u64::from(chunk.bytes);
        }
    }
    assert!(end <= file.len() as u64);
}

fuzz_target!(|bytes: &[u8]| {
    check(bytes);
    check(&with_marks(bytes));
});
