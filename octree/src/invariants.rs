//! Facts that hold for every cloud and every file, as functions `fn fact(…) -> Result<(), String>`: `Err` says what was found instead.

use crate::{
    Builder, Cube, CutOptions, Neighbourhood, OctreeError, Region, Tree, TreeHeader, TreeReader, TreeWriter,
    cut, regions,
};
use glam::DVec3;
use pointillist_view::View;
use std::io::Cursor;

fn check(holds: bool, message: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(message()) }
}

/// The file of a tree of points, each with the first bytes of its number among `names`; `in_memory` points are divided in memory at most.
///
/// # Errors
/// What the builder refuses.
pub fn file_of(points: &[DVec3], names: &[u32], in_memory: u64) -> Result<Vec<u8>, OctreeError> {
    let low = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let high = points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    let cube = Cube::around(low, high)?;
    let mut builder = Builder::new(cube, 4, 0, Cursor::new(vec![])).with_most_in_memory(in_memory);
    for (point, name) in points.iter().zip(names) {
        builder.push(*point, &name.to_le_bytes())?;
    }
    let mut writer = TreeWriter::new(vec![], &TreeHeader { fingerprint: 1, cube, payload: 4, layout: 0 })?;
    builder.finish(&mut |key, records| writer.node(key, records), &mut |_| ())?;
    Ok(writer.finish()?)
}

/// Every point is in the tree once, in a node that it lies in, at its place; and no cell of an inner node has two points.
///
/// # Errors
/// The first point that is not.
pub fn every_point_is_there_once(points: &[DVec3], in_memory: u64) -> Result<(), String> {
    let names: Vec<u32> = (0..points.len() as u32).collect();
    let Ok(file) = file_of(points, &names, in_memory) else { return Ok(()) };
    let mut reader = TreeReader::new(Cursor::new(file)).map_err(|error| error.to_string())?;
    let tree = reader.tree().clone();
    let mut seen = vec![false; points.len()];
    for (node, data) in tree.nodes().iter().enumerate() {
        let records = reader.read(node as u32).map_err(|error| error.to_string())?;
        let is_inner = tree.children(node as u32).next().is_some();
        let mut taken = std::collections::HashSet::new();
        for record in records.chunks_exact(16) {
            let [x, y, z, name] =
                [0, 4, 8, 12].map(|at| u32::from_le_bytes(std::array::from_fn(|i| record[at + i])));
            let shift = 32 - u32::from(data.key.level);
            let place = [x, y, z].map(|c| (u64::from(c) >> shift) as u32);
            check(place == data.key.place, || format!("point {name} is in {:?}, where it is not", data.key))?;
            let fine = [x, y, z].map(|c| u64::from(c) >> (shift - 7));
            check(!is_inner || taken.insert(fine), || format!("{:?} has two points in a cell", data.key))?;
            let seen = seen.get_mut(name as usize).ok_or("a point that nobody gave")?;
            check(!std::mem::replace(seen, true), || format!("point {name} is there twice"))?;
            let (there, given) = (tree.cube().position([x, y, z]), points[name as usize]);
            let allowed = tree.cube().side / 4_294_967_296.0 + 4.0 * f64::EPSILON * given.abs().max_element();
            check((there - given).abs().max_element() <= allowed, || {
                format!("point {name}: {there}, not {given}")
            })?;
        }
    }
    check(seen.iter().all(|&seen| seen), || "a point is missing".to_owned())
}

/// The tree is the same for points in another order, and for less memory.
///
/// # Errors
/// It is not.
pub fn order_and_memory_do_not_matter(points: &[DVec3], in_memory: u64) -> Result<(), String> {
    let names: Vec<u32> = (0..points.len() as u32).collect();
    let backwards = |all: Vec<_>| all.into_iter().rev().collect::<Vec<_>>();
    let turned: Vec<DVec3> = points.iter().rev().copied().collect();
    let one = file_of(points, &names, in_memory).map_err(|error| error.to_string());
    let other = file_of(&turned, &backwards(names), u64::MAX).map_err(|error| error.to_string());
    match (one, other) {
        // Only as much as fits into memory is looked at together.
        (Err(_), _) | (_, Err(_)) => Ok(()),
        (one, other) => check(one == other, || "two files of one cloud differ".to_owned()),
    }
}

/// Reading a file of any bytes ends with points or an error; a file that is read as a whole has sound nodes.
///
/// # Errors
/// A node without the points that it announces.
pub fn any_file_can_be_read(bytes: &[u8]) -> Result<(), String> {
    let Ok(mut reader) = TreeReader::new(Cursor::new(bytes)) else { return Ok(()) };
    let stride = crate::POSITION_BYTES + reader.header().payload as usize;
    for node in 0..reader.tree().nodes().len() as u32 {
        let count = reader.tree().nodes()[node as usize].count;
        if let Ok(records) = reader.read(node) {
            check(records.len() as u64 == count * stride as u64, || format!("node {node} is too short"))?;
        }
    }
    Ok(())
}

/// A file of which a byte was changed is refused, or a node of it; or the byte is of no meaning: none is.
///
/// # Errors
/// The change was not found.
pub fn changes_are_found(file: &[u8], at: usize, change: u8) -> Result<(), String> {
    let mut changed = file.to_vec();
    let at = at % file.len().max(1);
    changed[at] ^= change.max(1);
    let Ok(mut reader) = TreeReader::new(Cursor::new(&changed[..])) else { return Ok(()) };
    let nodes = reader.tree().nodes().len() as u32;
    check((0..nodes).any(|node| reader.read(node).is_err()), || {
        format!("byte {at} was changed and nobody noticed")
    })
}

/// A position as something that can be sorted and compared to the bit.
type Bits = [u64; 3];

fn bits(p: &DVec3) -> Bits {
    p.to_array().map(f64::to_bits)
}

/// The octants of the regions of a cut hold, with those around them, each point of the cut that is in the picture as often as it is there, and
/// no other; no node that has points in them is left out.
///
/// # Errors
/// What is not so.
pub fn regions_have_every_point_once(
    points: &[DVec3],
    view: &View,
    options: &CutOptions,
) -> Result<(), String> {
    let names: Vec<u32> = (0..points.len() as u32).collect();
    let Ok(file) = file_of(points, &names, 1 << 30) else { return Ok(()) };
    let mut reader = TreeReader::new(Cursor::new(file)).map_err(|error| error.to_string())?;
    let tree = reader.tree().clone();
    // By position: the records of a node are those of its points.
    let mut stored: Vec<Vec<DVec3>> = vec![];
    for node in 0..tree.nodes().len() as u32 {
        let records = reader.read(node).map_err(|error| error.to_string())?;
        let cell = |r: &[u8]| [0, 4, 8].map(|at| u32::from_le_bytes(std::array::from_fn(|i| r[at + i])));
        stored.push(records.chunks_exact(16).map(|record| tree.cube().position(cell(record))).collect());
    }
    let cut = cut(&[&tree], view, options);
    let mut drawn: Vec<Bits> = vec![];
    for region in regions(&[&tree], view, options, &cut) {
        check(cut.nodes.contains(&(0, region.node)), || "a node that is not in the cut".to_owned())?;
        points_of(&tree, &stored, region, &mut drawn)?;
    }
    let in_cut = || cut.nodes.iter().flat_map(|&(_, node)| &stored[node as usize]);
    let (width, height) = (f64::from(view.width()), f64::from(view.height()));
    let is_seen = |p: &&DVec3| {
        view.project(**p).is_some_and(|at| {
            let [x, y] = at.pixel.to_array();
            (0.0..width).contains(&x) && (0.0..height).contains(&y)
        })
    };
    let mut wanted: Vec<Bits> = in_cut().filter(is_seen).map(bits).collect();
    let mut there: Vec<Bits> = in_cut().map(bits).collect();
    [&mut drawn, &mut wanted, &mut there].into_iter().for_each(|list| list.sort_unstable());
    check(are_among(&wanted, &drawn), || "a point in view is not drawn, or not often enough".to_owned())?;
    check(are_among(&drawn, &there), || "a point is drawn that is not in the cut, or twice".to_owned())
}

/// Whether all of a sorted list are in another one, each as often as there.
fn are_among(some: &[Bits], all: &[Bits]) -> bool {
    let mut rest = all.iter();
    some.iter().all(|point| rest.any(|other| other == point))
}

/// Adds the points that the octants of a region hold themselves.
fn points_of(
    tree: &Tree,
    stored: &[Vec<DVec3>],
    region: Region,
    drawn: &mut Vec<Bits>,
) -> Result<(), String> {
    let level = tree.nodes()[region.node as usize].key.level;
    for octant in (0..8).filter(|octant| region.octants >> octant & 1 == 1) {
        let near = Neighbourhood::of(tree, region.node, octant, 6.0);
        let nodes = near.nodes(tree);
        for &node in &nodes {
            drawn.extend(stored[node as usize].iter().filter(|p| near.holds(**p) == Some(true)).map(bits));
        }
        // No other node of these levels has a point that it holds.
        let is_other = |node: usize| tree.nodes()[node].key.level <= level && !nodes.contains(&(node as u32));
        for node in (0..stored.len()).filter(|&node| is_other(node)) {
            let holds_none = stored[node].iter().all(|p| near.holds(*p).is_none());
            check(holds_none, || format!("node {node} was forgotten"))?;
        }
    }
    Ok(())
}
