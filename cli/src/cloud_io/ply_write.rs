//! Writing a cloud of discs as PLY.

use glam::{DVec3, Vec3};
use std::io::{self, Write};

/// A point as the file has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CloudPoint {
    /// World.
    pub position: DVec3,
    /// Of unit length: what light sees.
    pub normal: Vec3,
    /// Of unit length: across the surface on which the point lies, on the same side.
    pub face_normal: Vec3,
    /// sRGB-encoded.
    pub color: [u8; 3],
    /// Of its disc; more than 0.
    pub radius: f32,
}

/// How a cloud is written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PlyEncoding {
    /// `binary_little_endian`.
    #[default]
    Binary,
    /// `ascii`; numbers read back as they were.
    Ascii,
}

/// Share of a radius by which a position may be moved to save four bytes a coordinate.
const MOST_ROUNDING: f64 = 1.0 / 256.0;

/// Writes `x y z nx ny nz red green blue radius` of every point, and `face_nx face_ny face_nz` if these differ from the normals anywhere.
///
/// Positions are `float` if that moves none by more than 1/256 of its radius, else `double`.
///
/// # Errors
/// What the writer says.
pub fn write_ply(output: &mut dyn Write, points: &[CloudPoint], encoding: PlyEncoding) -> io::Result<()> {
    let is_fine = points.iter().any(|p| {
        let moved = (p.position.as_vec3().as_dvec3() - p.position).abs().max_element();
        // Infinite for positions beyond the range of `float`.
        moved > MOST_ROUNDING * f64::from(p.radius)
    });
    let columns = Columns { is_fine, has_face_normals: points.iter().any(|p| p.normal != p.face_normal) };
    header(output, points.len(), columns, encoding)?;
    for p in points {
        match encoding {
            PlyEncoding::Binary => binary(output, p, columns)?,
            PlyEncoding::Ascii => ascii(output, p, columns)?,
        }
    }
    Ok(())
}

/// What the points of a file have.
#[derive(Clone, Copy)]
struct Columns {
    is_fine: bool,
    has_face_normals: bool,
}

fn header(output: &mut dyn Write, count: usize, columns: Columns, encoding: PlyEncoding) -> io::Result<()> {
    let format = match encoding {
        PlyEncoding::Binary => "binary_little_endian",
        PlyEncoding::Ascii => "ascii",
    };
    let position = if columns.is_fine { "double" } else { "float" };
    let face_normals: &[&str] =
        if columns.has_face_normals { &["face_nx", "face_ny", "face_nz"] } else { &[] };
    writeln!(output, "ply\nformat {format} 1.0\nelement vertex {count}")?;
    let properties = [
        (position, ["x", "y", "z"].as_slice()),
        ("float", &["nx", "ny", "nz"]),
        ("uchar", &["red", "green", "blue"]),
        ("float", &["radius"]),
        ("float", face_normals),
    ];
    for (kind, names) in properties {
        names.iter().try_for_each(|name| writeln!(output, "property {kind} {name}"))?;
    }
    writeln!(output, "end_header")
}

fn binary(output: &mut dyn Write, p: &CloudPoint, columns: Columns) -> io::Result<()> {
    // The longest point: three `double`, seven `float`, three bytes.
    let mut bytes = Vec::with_capacity(55);
    for x in p.position.to_array() {
        if columns.is_fine {
            bytes.extend(x.to_le_bytes());
        } else {
            bytes.extend((x as f32).to_le_bytes());
        }
    }
    p.normal.to_array().iter().for_each(|n| bytes.extend(n.to_le_bytes()));
    bytes.extend(p.color);
    bytes.extend(p.radius.to_le_bytes());
    if columns.has_face_normals {
        p.face_normal.to_array().iter().for_each(|n| bytes.extend(n.to_le_bytes()));
    }
    output.write_all(&bytes)
}

fn ascii(output: &mut dyn Write, p: &CloudPoint, columns: Columns) -> io::Result<()> {
    let (n, f, [r, g, b]) = (p.normal, p.face_normal, p.color);
    if columns.is_fine {
        let q = p.position;
        write!(output, "{} {} {}", q.x, q.y, q.z)?;
    } else {
        let q = p.position.as_vec3();
        write!(output, "{} {} {}", q.x, q.y, q.z)?;
    }
    write!(output, " {} {} {} {r} {g} {b} {}", n.x, n.y, n.z, p.radius)?;
    if columns.has_face_normals {
        write!(output, " {} {} {}", f.x, f.y, f.z)?;
    }
    writeln!(output)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(position: DVec3, encoding: PlyEncoding) -> Vec<u8> {
        let point =
            CloudPoint { position, normal: Vec3::Z, face_normal: Vec3::Z, color: [1, 2, 3], radius: 0.5 };
        let mut bytes = vec![];
        write_ply(&mut bytes, &[point], encoding).unwrap();
        bytes
    }

    #[test]
    fn text_is_short_and_exact() {
        let text = String::from_utf8(written(DVec3::new(0.25, -1.0, 3.0), PlyEncoding::Ascii)).unwrap();
        assert!(text.contains("property float x\n"), "{text}");
        assert!(text.ends_with("end_header\n0.25 -1 3 0 0 1 1 2 3 0.5\n"), "{text}");
    }

    #[test]
    fn positions_far_away_are_written_as_double() {
        let bytes = written(DVec3::splat(1e6 + 0.123), PlyEncoding::Binary);
        let head = String::from_utf8_lossy(&bytes);
        assert!(head.contains("property double x\n"), "{head}");
        assert!(bytes.ends_with(&0.5f32.to_le_bytes()));
    }
}
