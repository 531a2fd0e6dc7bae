//! COPC drawn by its nodes, and COPC that cannot be.

use crate::common::Folder;
use crate::common::copc::{Copc, CopcCube, CopcNode, CopcPoint, las_of};
use pointillist_cli::cloud_io::{CloudOptions, CopcFile};
use pointillist_cli::{InputError, cloud_io::CopcHierarchy};
use predicates::prelude::*;
use predicates::str::contains;
use std::io::Cursor;

const VIEW: [&str; 8] = ["--eye", "1.2,1.2,4", "--target", "1.2,1.2,0", "--fov", "40", "--size", "160x120"];

const CUBE: CopcCube = CopcCube { centre: [1.28, 1.28, 0.0], half_size: 1.28, spacing: 0.08 };

/// A wavy square: every fourth point of each row and column in the root, of the others every second on level 1, and the rest on level 2.
fn wave(side: i32) -> Vec<CopcNode> {
    let mut nodes = std::collections::BTreeMap::<[i32; 4], Vec<CopcPoint>>::new();
    for (i, j) in (0..side).flat_map(|j| (0..side).map(move |i| (i, j))) {
        let z = (2000.0 * (f64::from(3 * i) / 100.0).sin()) as i32;
        let level = (0..2).find(|level| (i | j) % (4 >> level) == 0).unwrap_or(2);
        // Not a lattice: which of its equally near points count as neighbours would depend on how positions are rounded.
        let off = |seed: u32| {
            let hash = (i as u32 * 1000 + j as u32 + seed).wrapping_mul(0x9e37_79b1);
            ((hash ^ hash >> 15).wrapping_mul(0x85eb_ca6b) >> 16) as i32 % 61
        };
        let place = [100 * i + off(0), 100 * j + off(1_000_000), z + off(2_000_000)];
        let low = [0, 0, -12_800];
        let [x, y, z] = std::array::from_fn(|axis| (place[axis] - low[axis]) / (25_600 >> level));
        let colour = [(i % 256) as u16 * 257, 30_000, (j % 256) as u16 * 257];
        let class = if i < side / 2 { 2 } else { 6 };
        nodes.entry([level, x, y, z]).or_default().push(CopcPoint { place, colour, class });
    }
    // Nodes without points of their own, around others.
    for key in nodes.keys().copied().collect::<Vec<_>>() {
        let [level, x, y, z] = key;
        for up in 1..=level {
            nodes.entry([level - up, x >> up, y >> up, z >> up]).or_default();
        }
    }
    nodes.into_iter().collect()
}

fn folder() -> Folder {
    let folder = Folder::new();
    let nodes = wave(250);
    folder.write("wave.copc.laz", Copc::of(&CUBE, &nodes, true).bytes);
    folder.write("flat.copc.laz", Copc::of(&CUBE, &nodes, false).bytes);
    folder.write("wave.las", las_of(&nodes));
    folder
}

fn pixels(folder: &Folder, name: &str) -> Vec<u8> {
    image::open(folder.path(name)).unwrap().into_rgba8().into_raw()
}

/// The mean difference of two pictures, in steps of 8 bits.
fn apart(one: &[u8], other: &[u8]) -> f64 {
    let sum: u64 = one.iter().zip(other).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
    sum as f64 / one.len() as f64
}

/// Draws the wave from memory, by the nodes of COPC, and from an octree of ours.
fn nearly_the_same(command: &str, look: &[&str], most: f64) {
    let folder = folder();
    let draw = |cloud: &str, more: &[&str]| {
        let line = [command, cloud, "-o", "a.png", "--overwrite"];
        folder.command(&[&line[..], &VIEW, look, more].concat()).assert().success();
        pixels(&folder, "a.png")
    };
    let memory = draw("wave.las", &[]);
    assert!(memory.chunks_exact(4).filter(|pixel| pixel[3] == 255).count() > 3000);
    let nodes = draw("wave.copc.laz", &[]);
    assert!(draw("flat.copc.laz", &["--octree"]) == nodes, "pages or not: {command} {look:?}");
    let far = apart(&nodes, &memory);
    assert!(far < most, "COPC, {command} {look:?}: {far}");
    // Colours of an octree are rounded, and positions to 2⁻³² of its side.
    let far = apart(&draw("wave.las", &["--octree"]), &memory);
    assert!(far < most, "octree, {command} {look:?}: {far}");
    assert!(folder.names().iter().all(|name| !name.ends_with("laz.octree")), "{:?}", folder.names());
}

#[test]
fn discs_by_nodes_are_nearly_those_of_the_points_in_memory() {
    // Radii at the rim of the wave differ, with their limits.
    for look in [&[][..], &["--color-by", "class"], &["--classes", "2"], &["--color-by", "elevation"]] {
        nearly_the_same("surfel", look, 0.5);
    }
}

#[test]
fn scans_by_nodes_are_nearly_those_of_the_points_in_memory() {
    // The size of the buffer's pixels is measured in parts, and not over all.
    for look in [&[][..], &["--color-by", "class"], &["--box", "0,0,-1,1,2,1"]] {
        nearly_the_same("scan", look, 1.5);
    }
}

#[test]
fn a_view_reads_the_nodes_that_it_needs_and_views_of_the_same_nodes_share_them() {
    let folder = folder();
    folder.write("flight.txt", "0.3 0.3 1  0.3 0.3 0  0 1 0\n".repeat(5));
    let line = ["surfel", "wave.copc.laz", "--fov", "20", "--size", "160x120", "--views", "flight.txt"];
    let more = ["-o", "f{frame}.png", "--stats", "s.json", "--memory", "1G"];
    folder.command(&[&line[..], &more].concat()).assert().success();
    let stats: serde_json::Value =
        serde_json::from_slice(&std::fs::read(folder.path("s.json")).unwrap()).unwrap();
    let whole = std::fs::metadata(folder.path("wave.copc.laz")).unwrap().len();
    let bytes = stats["counts"]["bytes_read"].as_u64().unwrap();
    // With the nodes around, as points of this file are 32 to the side of a node.
    assert!(0 < bytes && bytes < whole * 2 / 3, "{bytes} of {whole}");
    assert_eq!(stats["skipped"]["clouds_made_ready"], 4, "{stats}");
    assert_eq!(pixels(&folder, "f1.png"), pixels(&folder, "f5.png"));

    // `scan` reads no more than that.
    let view = ["--eye", "0.3,0.3,1", "--target", "0.3,0.3,0", "--fov", "20", "--size", "160x120"];
    let scan = ["scan", "wave.copc.laz", "-o", "scan.png", "--stats", "scan.json", "--memory", "1G"];
    folder.command(&[&scan[..], &view].concat()).assert().success();
    let stats: serde_json::Value =
        serde_json::from_slice(&std::fs::read(folder.path("scan.json")).unwrap()).unwrap();
    let bytes = stats["counts"]["bytes_read"].as_u64().unwrap();
    assert!(0 < bytes && bytes < whole / 2, "{bytes} of {whole}");

    // A mixture is read into memory as long as it fits, so that nothing is written beside the others.
    let both = ["surfel", "wave.copc.laz", "wave.las", "-o", "both.png", "--size", "40x30"];
    folder.command(&both).assert().success();
    assert!(!folder.path("wave.las.octree").exists());
}

/// Six nodes: the root, then two of level 1 and so on.
fn small() -> Copc {
    Copc::of(&CUBE, &wave(40), false)
}

#[test]
fn copc_that_is_not_as_it_says_is_refused_with_its_name() {
    let folder = Folder::new();
    let refused = |what: &str, copc: Copc, said: &str| {
        folder.write("bad.copc.laz", copc.bytes);
        let line = [&["surfel", "bad.copc.laz", "-o", "bad.png"][..], &VIEW].concat();
        let run = folder.command(&line).timeout(std::time::Duration::from_secs(60)).assert();
        run.code(3).stderr(contains("bad.copc.laz").and(contains(said)));
        assert!(!folder.path("bad.png").exists(), "{what}");
    };
    let length = small().bytes.len() as u64;
    let page = small();
    let (at, bytes) = (page.page as u64, 32 * page.entries as i32);
    refused(
        "a page that is itself",
        page.with_entry(0, 7, -1).with_entry(0, 6, bytes).with_offset(0, at),
        "already",
    );
    let many = small().with_entry(0, 7, 1_000_000);
    refused("more points than the file", many, "1000000 points, but the file has 1600");
    let one_more = small().with_entry(0, 7, 99);
    refused("another number than the chunk", one_more, "it has 100 points, but the hierarchy announces 99");
    refused("negative points", small().with_entry(0, 7, -2), "announces -2 points");
    refused("no bytes", small().with_entry(0, 6, 0), "points in 0 bytes");
    refused("points outside", small().with_offset(0, length - 10), &format!("the file has {length}"));
    refused("points at the end of numbers", small().with_offset(0, u64::MAX), "but the file has");
    refused("level 32", small().with_entry(1, 0, 32), "no cube of an octree");
    refused("beside the cube", small().with_entry(1, 1, 2), "no cube of an octree");
    refused("twice there", small().with_entry(0, 0, 1), "no tree");
    let first = u64::from_le_bytes(small().bytes[small().page + 16..][..8].try_into().unwrap());
    refused("shared bytes", small().with_offset(1, first), "already");
    // In the page of a node of level 1, the first entry is that node.
    let mut stray = Copc::of(&CUBE, &wave(200), true);
    let below = stray.page + 32 * stray.entries;
    stray.bytes[below + 4] ^= 1;
    refused("a node of another page", stray, "of which it is no part");
    let mut cube = small();
    cube.bytes[453..461].copy_from_slice(&f64::NAN.to_le_bytes());
    refused("no cube", cube, "half size NaN");
    let mut cut = small();
    cut.bytes.truncate(cut.page + 40);
    refused("cut off", cut, "but the file has");
}

/// All points of all nodes.
fn read(bytes: Vec<u8>) -> Result<u64, InputError> {
    let mut file = CopcFile::new("a.copc.laz", Cursor::new(bytes))?;
    let mut points = 0;
    for node in 0..file.tree().nodes().len() as u32 {
        let records = file.read(node)?;
        file.blocks(&records, &CloudOptions::default(), &mut |block| {
            points += block.positions.len() as u64;
            Ok(())
        })?;
    }
    Ok(points)
}

#[test]
fn any_changed_byte_and_any_cut_is_an_error_or_a_cloud() {
    let sound = Copc::of(&CUBE, &wave(3), true).bytes;
    assert_eq!(read(sound.clone()).unwrap(), 9);
    for at in 0..sound.len() {
        // Most bytes are zeros that nobody reads.
        let others = if sound[at] == 0 { vec![255] } else { vec![0, 255, sound[at] ^ 1] };
        for byte in others {
            let mut changed = sound.clone();
            changed[at] = byte;
            if let Ok(points) = read(changed) {
                assert!(points <= 9, "byte {at} as {byte}");
            }
        }
        let cut = CopcHierarchy::read(&mut Cursor::new(&sound[..at]));
        // The hierarchy is last.
        assert!(cut.is_err_and(|error| !error.to_string().is_empty()), "{at}");
    }
}
