//! PLY: ascii and binary, vertices with x y z (and nx ny nz, u v or s t), faces of any size.

use super::{FileMesh, triangulate};
use crate::coordinate::{LARGEST, is_usable};
use crate::input_error::InputError;
use glam::{DVec2, DVec3, Vec3};
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{Encoding, Header, Property, PropertyAccess, PropertyAccessResult};
use pointillist_render::NONE;
use std::io::Cursor;

#[derive(Debug, Default)]
struct Vertex {
    position: DVec3,
    normal: Vec3,
    uv: DVec2,
}

#[derive(Debug, Default)]
struct Face(Vec<i64>);

impl Vertex {
    fn set(&mut self, name: &str, value: f64) -> PropertyAccessResult {
        match name {
            "x" => self.position.x = value,
            "y" => self.position.y = value,
            "z" => self.position.z = value,
            "nx" => self.normal.x = value as f32,
            "ny" => self.normal.y = value as f32,
            "nz" => self.normal.z = value as f32,
            "u" | "s" | "texture_u" => self.uv.x = value,
            "v" | "t" | "texture_v" => self.uv.y = value,
            _ => return PropertyAccessResult::Ignored,
        }
        PropertyAccessResult::Set
    }
}

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self::default()
    }
    fn set_float(&mut self, name: &str, value: f32) -> PropertyAccessResult {
        self.set(name, f64::from(value))
    }
    fn set_double(&mut self, name: &str, value: f64) -> PropertyAccessResult {
        self.set(name, value)
    }
    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        match value {
            Property::Char(n) => self.set(name, f64::from(n)),
            Property::UChar(n) => self.set(name, f64::from(n)),
            Property::Short(n) => self.set(name, f64::from(n)),
            Property::UShort(n) => self.set(name, f64::from(n)),
            Property::Int(n) => self.set(name, f64::from(n)),
            Property::UInt(n) => self.set(name, f64::from(n)),
            _ => PropertyAccessResult::Ignored,
        }
    }
}

impl PropertyAccess for Face {
    fn new() -> Self {
        Self::default()
    }
    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        if name != "vertex_indices" && name != "vertex_index" {
            return PropertyAccessResult::Ignored;
        }
        self.0 = match value {
            Property::ListChar(list) => list.into_iter().map(i64::from).collect(),
            Property::ListUChar(list) => list.into_iter().map(i64::from).collect(),
            Property::ListShort(list) => list.into_iter().map(i64::from).collect(),
            Property::ListUShort(list) => list.into_iter().map(i64::from).collect(),
            Property::ListInt(list) => list.into_iter().map(i64::from).collect(),
            Property::ListUInt(list) => list.into_iter().map(i64::from).collect(),
            _ => return PropertyAccessResult::UnsupportedType,
        };
        PropertyAccessResult::Set
    }
}

/// Something that is read and thrown away.
#[derive(Debug)]
struct Other;

impl PropertyAccess for Other {
    fn new() -> Self {
        Self
    }
}

/// Reads a PLY; `name` is how messages call it.
///
/// # Errors
///
/// Not a PLY, no vertices with x y z, an index out of range, a number that is not finite.
pub fn read_ply(name: &str, bytes: &[u8]) -> Result<FileMesh, InputError> {
    let mut reader = Reader::new(Cursor::new(bytes));
    let header = Parser::<Other>::new().read_header(&mut reader).map_err(|e| fault(name, bytes, &e))?;
    let has = |property: &str| {
        header.elements.get("vertex").is_some_and(|vertex| vertex.properties.contains_key(property))
    };
    if !["x", "y", "z"].into_iter().all(has) {
        return Err(InputError::of_file(name, "the PLY file has no element `vertex` with x, y and z"));
    }
    let has_normals = ["nx", "ny", "nz"].into_iter().all(has);
    let has_uvs =
        [["u", "v"], ["s", "t"], ["texture_u", "texture_v"]].iter().any(|pair| pair.iter().all(|p| has(p)));
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    for (element_name, element) in &header.elements {
        check_count(name, element_name, element.count, bytes.len())?;
        let result = match element_name.as_str() {
            "vertex" => Parser::<Vertex>::new()
                .read_payload_for_element(&mut reader, element, &header)
                .map(|read| vertices = read),
            "face" => Parser::<Face>::new()
                .read_payload_for_element(&mut reader, element, &header)
                .map(|read| faces = read),
            _ => Parser::<Other>::new().read_payload_for_element(&mut reader, element, &header).map(|_| ()),
        };
        result.map_err(|error| fault(name, bytes, &error))?;
    }
    check_numbers(name, bytes, &header, &vertices)?;
    build(name, &vertices, &faces, has_normals, has_uvs)
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

/// A header that promises more than the file can hold is refused before memory is asked for.
fn check_count(name: &str, element: &str, count: usize, bytes: usize) -> Result<(), InputError> {
    if count > bytes || u32::try_from(count).is_err() {
        let message = format!("{count} of `{element}` are announced, but the file has only {bytes} bytes");
        return Err(InputError::of_file(name, message));
    }
    Ok(())
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
