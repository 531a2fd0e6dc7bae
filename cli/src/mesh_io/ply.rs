//! PLY: ascii and binary, vertices with x y z (and nx ny nz, u v or s t), faces of any size.

use super::ply_records::{Face, PlyFault, PlyRecords, Vertex};
use super::{FileMesh, triangulate};
use crate::coordinate::{LARGEST, is_usable};
use crate::input;
use crate::input_error::InputError;
use ply_rs_bw::parser::ParseError;
use ply_rs_bw::ply::{Encoding, Header};
use pointillist_render::NONE;

/// Reads a PLY; `name` is how messages call it.
///
/// # Errors
///
/// Not a PLY, no vertices with x y z, an index out of range, a number that is not finite.
pub fn read_ply(name: &str, bytes: &[u8]) -> Result<FileMesh, InputError> {
    input::not_empty(name, bytes)?;
    let records = PlyRecords::read(bytes).map_err(|problem| match problem {
        PlyFault::Parse(error) => fault(name, bytes, &error),
        _ => InputError::of_file(name, problem.to_string()),
    })?;
    check_numbers(name, bytes, &records.header, &records.vertices)?;
    let has_all = |properties: &[&str]| properties.iter().all(|property| records.has(property));
    let has_normals = has_all(&["nx", "ny", "nz"]);
    let has_uvs = [["u", "v"], ["s", "t"], ["texture_u", "texture_v"]].iter().any(|pair| has_all(pair));
    build(name, &records.vertices, &records.faces, has_normals, has_uvs)
}

/// Refuses numbers that are not finite or too large, with the line if they stand in text.
fn check_numbers(name: &str, bytes: &[u8], header: &Header, vertices: &[Vertex]) -> Result<(), InputError> {
    let is_bad = |v: &Vertex| !is_usable(v.position) || !v.normal.is_finite() || !is_usable(v.uv.extend(0.0));
    let Some(index) = vertices.iter().position(is_bad) else { return Ok(()) };
    let message = format!("vertex {index} (from 0) has a number that is not finite, or beyond ±{LARGEST:e}");
    // One line for each vertex, if nothing else comes before them.
    let is_text = header.encoding == Encoding::Ascii
        && header.elements.keys().next().is_some_and(|first| first == "vertex");
    let is_end = |line: &[u8]| line.trim_ascii_end() == b"end_header";
    let end = bytes.split(|&b| b == b'\n').position(is_end).filter(|_| is_text);
    Err(match end {
        Some(end) => InputError::in_line(name, bytes, end + 2 + index, message),
        None => InputError::of_file(name, message),
    })
}

fn fault(name: &str, bytes: &[u8], error: &ParseError) -> InputError {
    let is_text = bytes.windows(12).take(200).any(|window| window == b"format ascii");
    match error.line() {
        Some(line) if is_text => InputError::in_line(name, bytes, line, "this line is not what the header says")
            .with_help("a vertex is the numbers of its properties; a face is how many corners it has, and these: 3 0 1 2"),
        _ => {
            let message = error.to_string();
            let first = message.lines().next().unwrap_or_default().trim_end_matches('.');
            InputError::of_file(name, format!("not PLY: {first}"))
                .with_help("the file was cut off, or its header is wrong; get or write it again")
        }
    }
}

fn build(
    name: &str,
    vertices: &[Vertex],
    faces: &[Face],
    has_normals: bool,
    has_uvs: bool,
) -> Result<FileMesh, InputError> {
    let mut mesh = FileMesh {
        positions: vertices.iter().map(|v| v.position).collect(),
        normals: if has_normals { vertices.iter().map(|v| v.normal).collect() } else { Vec::new() },
        uvs: if has_uvs { vertices.iter().map(|v| v.uv).collect() } else { Vec::new() },
        material_names: vec![String::new()],
        ..FileMesh::default()
    };
    let mut corners = Vec::new();
    for (face, Face(indices)) in faces.iter().enumerate() {
        if let Some(&index) = indices.iter().find(|&&i| i < 0 || i >= vertices.len() as i64) {
            let message =
                format!("face {face} (from 0) names vertex {index}, but there are {}", vertices.len());
            return Err(InputError::of_file(name, message));
        }
        if indices.len() < 3 {
            continue;
        }
        corners.clear();
        corners.extend(indices.iter().map(|&i| mesh.positions[i as usize]));
        triangulate(&corners, |triangle| {
            let corners = triangle.map(|corner| indices[corner] as u32);
            mesh.triangles.push(corners);
            mesh.normal_of.push(if has_normals { corners } else { [NONE; 3] });
            mesh.uv_of.push(if has_uvs { corners } else { [NONE; 3] });
            mesh.material_of.push(0);
        });
    }
    Ok(mesh)
}
