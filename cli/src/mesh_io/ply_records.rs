//! Vertices and faces of a PLY, ascii or binary, as they stand in the file.
//!
//! `site` compiles this file, too: no other crate is below both, and one reader is enough. So it knows neither our errors nor our meshes.

use glam::{DVec2, DVec3, Vec3};
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{Header, Property, PropertyAccess, PropertyAccessResult};
use std::io::Cursor;

/// A vertex; what the file does not say of it is 0.
#[derive(Debug, Default)]
pub(crate) struct Vertex {
    pub(crate) position: DVec3,
    pub(crate) normal: Vec3,
    pub(crate) uv: DVec2,
}

/// The vertices of a face, as the file has them: they may be too few, negative or too large.
#[derive(Debug, Default)]
pub(crate) struct Face(pub(crate) Vec<i64>);

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

/// Why a PLY cannot be read.
#[derive(Debug, thiserror::Error)]
pub(crate) enum PlyFault {
    /// It is cut off, or not what its header says.
    #[error(transparent)]
    Parse(#[from] ParseError),
    /// There is nothing with x, y and z.
    #[error("the PLY file has no element `vertex` with x, y and z")]
    NoPositions,
    /// Refused before memory is asked for.
    #[error("{count} of `{element}` are announced, but the file has only {bytes} bytes")]
    TooMany { element: String, count: usize, bytes: usize },
}

/// What a PLY holds of a mesh or a cloud.
#[derive(Debug)]
pub(crate) struct PlyRecords {
    pub(crate) header: Header,
    pub(crate) vertices: Vec<Vertex>,
    /// None in a cloud.
    pub(crate) faces: Vec<Face>,
}

impl PlyRecords {
    /// Reads a file from memory.
    ///
    /// # Errors
    ///
    /// [`PlyFault`]. Numbers and indices are not looked at.
    pub(crate) fn read(bytes: &[u8]) -> Result<Self, PlyFault> {
        let mut reader = Reader::new(Cursor::new(bytes));
        let header = Parser::<Other>::new().read_header(&mut reader)?;
        let mut records = Self { header, vertices: Vec::new(), faces: Vec::new() };
        if !["x", "y", "z"].into_iter().all(|property| records.has(property)) {
            return Err(PlyFault::NoPositions);
        }
        let header = &records.header;
        for (name, element) in &header.elements {
            // An entry takes a byte at least.
            if element.count > bytes.len() || u32::try_from(element.count).is_err() {
                let (element, count) = (name.clone(), element.count);
                return Err(PlyFault::TooMany { element, count, bytes: bytes.len() });
            }
            match name.as_str() {
                "vertex" => {
                    let parser = Parser::<Vertex>::new();
                    records.vertices = parser.read_payload_for_element(&mut reader, element, header)?;
                }
                "face" => {
                    let parser = Parser::<Face>::new();
                    records.faces = parser.read_payload_for_element(&mut reader, element, header)?;
                }
                _ => {
                    Parser::<Other>::new().read_payload_for_element(&mut reader, element, header)?;
                }
            }
        }
        Ok(records)
    }

    /// Whether vertices have a property.
    pub(crate) fn has(&self, property: &str) -> bool {
        let vertex = self.header.elements.get("vertex");
        vertex.is_some_and(|vertex| vertex.properties.contains_key(property))
    }
}
