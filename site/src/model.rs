//! Models: the rabbit of the examples, or a file of the visitor.
//!
//! `model rabbit`, or `model NAME` and the file's bytes after the line. The facts are `points`, `triangles`, `low` and `high`, the corners of the
//! box around all.

use crate::SiteError;
use crate::ply_records::{Face, PlyRecords};
use crate::reply::Reply;
use crate::request::Request;
use glam::DVec3;
use std::io::Cursor;

const RABBIT: &[u8] = include_bytes!("../../examples/rabbit.obj");

/// Triangles, or points alone.
pub(crate) struct Model {
    pub(crate) positions: Vec<DVec3>,
    /// Empty for a cloud of points.
    pub(crate) triangles: Vec<[u32; 3]>,
}

impl Model {
    pub(crate) fn read(request: &mut Request<'_>) -> Result<Self, SiteError> {
        let (name, bytes) = match request.word() {
            "rabbit" if request.body.is_empty() => ("rabbit.obj", RABBIT),
            name => (name, request.body),
        };
        let read = if bytes.starts_with(b"ply") { read_ply(bytes) } else { read_obj(bytes) };
        read.and_then(Self::checked).map_err(|problem| SiteError::File { name: name.to_string(), problem })
    }

    /// Refuses numbers and indices that nothing can be drawn of.
    fn checked(self) -> Result<Self, String> {
        let count = self.positions.len();
        if count == 0 {
            return Err(
                "no surface was found: it must be PLY, or OBJ with lines `v x y z` and `f 1 2 3`".to_string()
            );
        }
        // Far enough for every unit, near enough that cameras around it are within their own range.
        let is_usable = |p: &DVec3| p.abs().cmple(DVec3::splat(1e9)).all();
        if let Some(vertex) = self.positions.iter().position(|p| !is_usable(p)) {
            return Err(format!("vertex {vertex} (from 0) is not within ±1e9"));
        }
        if self.extent() == 0.0 {
            return Err("all vertices are in one place".to_string());
        }
        let is_bad = |corners: &[u32; 3]| corners.iter().any(|&corner| corner as usize >= count);
        match self.triangles.iter().position(is_bad) {
            Some(face) => Err(format!("triangle {face} (from 0) names a vertex that is not there")),
            None => Ok(self),
        }
    }

    /// The corners of the box around all.
    pub(crate) fn bounds(&self) -> [DVec3; 2] {
        let start = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        self.positions.iter().fold(start, |[low, high], &p| [low.min(p), high.max(p)])
    }

    /// The largest side of that box.
    pub(crate) fn extent(&self) -> f64 {
        let [low, high] = self.bounds();
        (high - low).max_element()
    }

    pub(crate) fn describe(&self) -> Reply {
        let [low, high] = self.bounds();
        Reply::default()
            .with("points", [self.positions.len()])
            .with("triangles", [self.triangles.len()])
            .with("low", low.to_array())
            .with("high", high.to_array())
    }
}

fn read_obj(bytes: &[u8]) -> Result<Model, String> {
    let options = tobj::LoadOptions { triangulate: true, ..Default::default() };
    // Materials are not looked at, and there is no folder to find them in.
    let no_materials = |_: &std::path::Path| Ok(Default::default());
    let (objects, _) = tobj::load_obj_buf(&mut Cursor::new(bytes), &options, no_materials)
        .map_err(|error| format!("it is not PLY, and as OBJ: {error}"))?;
    let mut model = Model { positions: vec![], triangles: vec![] };
    for object in objects {
        let first = model.positions.len() as u32;
        model.positions.extend(object.mesh.positions.chunks_exact(3).map(DVec3::from_slice));
        let corners = object.mesh.indices.chunks_exact(3);
        model.triangles.extend(corners.map(|c| [c[0], c[1], c[2]].map(|corner| first + corner)));
    }
    Ok(model)
}

fn read_ply(bytes: &[u8]) -> Result<Model, String> {
    let records = PlyRecords::read(bytes).map_err(|fault| fault.to_string())?;
    // Negative corners become larger than any file has vertices, and are refused as those.
    let corner = |index: i64| u32::try_from(index).unwrap_or(u32::MAX);
    let fan = |Face(corners): &Face| -> Vec<[u32; 3]> {
        (2..corners.len()).map(|i| [corners[0], corners[i - 1], corners[i]].map(corner)).collect()
    };
    Ok(Model {
        positions: records.vertices.iter().map(|vertex| vertex.position).collect(),
        triangles: records.faces.iter().flat_map(fan).collect(),
    })
}
