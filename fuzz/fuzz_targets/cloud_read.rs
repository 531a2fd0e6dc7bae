//! Any bytes as a cloud or a .conf: finite points in blocks of equal slices, or an error that can be shown.
//!
//! The first byte picks the format, so that mutations of the rest stay within it. For the packed formats the rest is
//! packed here: the fuzzer would never find a checksum.
#![no_main]

use libfuzzer_sys::fuzz_target;
use pointillist_cli::InputError;
use pointillist_cli::cloud_io::{CloudBlock, CloudOptions, read_cloud_bytes, read_conf_bytes};
use std::path::Path;

/// A gzip of stored blocks (RFC 1951, 3.2.4) with a checksum of zero, which is found wrong after the last byte.
fn stored(bytes: &[u8]) -> Vec<u8> {
    let mut file = vec![0x1f, 0x8b, 8, 0, 0, 0, 0, 0, 0, 255];
    for block in bytes.chunks(usize::from(u16::MAX)) {
        let length = block.len() as u16;
        file.push(0);
        file.extend(length.to_le_bytes());
        file.extend((!length).to_le_bytes());
        file.extend(block);
    }
    file.extend([1, 0, 0, 255, 255, 0, 0, 0, 0, 0, 0, 0, 0]);
    file
}

fn check(block: CloudBlock<'_>) {
    let count = block.positions.len();
    assert!(count > 0 && block.positions.iter().all(|p| p.is_finite()));
    assert!(block.colours.is_none_or(|list| {
        list.len() == count && list.iter().flatten().all(|c| (0.0..=1.0).contains(c))
    }));
    assert!(block.normals.is_none_or(|list| list.len() == count && list.iter().all(|n| n.is_finite())));
    assert!(block.radii.is_none_or(|list| list.len() == count && list.iter().all(|r| r.is_finite())));
    // Measured values may be missing, that is, NaN.
    assert!(block.scalars.iter().flatten().all(|list| list.len() == count));
}

fuzz_target!(|bytes: &[u8]| {
    let Some((&choice, rest)) = bytes.split_first() else { return };
    let header = |encoding: &str| [format!("ply\nformat {encoding} 1.0\n").as_bytes(), rest].concat();
    let (name, file) = match choice % 8 {
        0 => ("a.ply", rest.to_vec()),
        1 => ("a.ply", header("ascii")),
        2 => ("a.ply", header("binary_little_endian")),
        3 => ("a.ply", header("binary_big_endian")),
        4 => ("a.ply.gz", stored(&header("ascii"))),
        5 => ("a.gz", [&[0x1f, 0x8b], rest].concat()),
        6 => ("a.xyz", rest.to_vec()),
        _ => {
            let conf =
                read_conf_bytes("a.conf", rest, Path::new("scans"), &|path| path.ends_with("there.ply"));
            match conf {
                Ok(conf) => assert!(conf.scans.iter().all(|scan| scan.pose.rotation.is_normalized())),
                Err(error) => assert!(!error.to_string().is_empty()),
            }
            return;
        }
    };
    let options =
        CloudOptions::default().with_scalars(true).with_drop_invalid(choice & 8 != 0).with_block_points(5);
    let mut points = 0;
    let result = read_cloud_bytes::<InputError>(name, &file, &options, &mut |block| {
        points += block.positions.len() as u64;
        check(block);
        Ok(())
    });
    match result {
        Ok(summary) => assert_eq!(summary.points, points),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
