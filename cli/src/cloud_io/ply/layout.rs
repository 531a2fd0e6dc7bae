//! Maps the properties of a PLY vertex to the coordinates, normal and colour of a point.

use super::super::block::Point;
use super::super::colour::ColourCode;
use super::header::Element;
use crate::input_error::InputError;
use glam::{DVec3, Vec3};
use ply_rs_bw::ply::{PropertyDef, PropertyType, ScalarType};

/// Numbers of a vertex by their meaning, and a place for those without.
pub(super) type Values = [f64; UNUSED + 1];

/// Where a number without meaning goes.
pub(super) const UNUSED: usize = 10;

const POSITION: [&str; 3] = ["x", "y", "z"];
const NORMAL: [&str; 3] = ["nx", "ny", "nz"];

/// Names of colours; the first that are complete are taken.
const COLOURS: [[&str; 3]; 3] =
    [["red", "green", "blue"], ["diffuse_red", "diffuse_green", "diffuse_blue"], ["r", "g", "b"]];

/// The meaning of each property of a vertex.
pub(super) struct Layout {
    /// For each property an index into [`Values`]: 0–2 position, 3–5 normal, 6–8 colour, 9 radius.
    pub(super) slots: Vec<usize>,
    colour: Option<([&'static str; 3], [ColourCode; 3])>,
    has_normals: bool,
    has_radii: bool,
}

impl Layout {
    /// Of the element `vertex`.
    ///
    /// # Errors
    ///
    /// No x, y or z.
    pub(super) fn of(vertex: &Element, name: &str) -> Result<Self, InputError> {
        let scalar = |wanted: &str| vertex.properties.iter().position(|p| p.name == wanted && is_scalar(p));
        let three = |names: [&str; 3]| Some([scalar(names[0])?, scalar(names[1])?, scalar(names[2])?]);
        let Some(position) = three(POSITION) else {
            let missing: Vec<&str> = POSITION.into_iter().filter(|name| scalar(name).is_none()).collect();
            let message = format!("`vertex` has no property {}", missing.join(", "));
            return Err(vertex.error(name, message).with_help("a point needs the properties x, y and z"));
        };
        let normal = three(NORMAL);
        let colour = COLOURS.into_iter().find_map(|names| Some((names, three(names)?)));
        let radius = scalar("radius");
        let mut slots = vec![UNUSED; vertex.properties.len()];
        let wanted = position
            .into_iter()
            .map(Some)
            .chain(normal.map_or([None; 3], |n| n.map(Some)))
            .chain(colour.map_or([None; 3], |(_, c)| c.map(Some)))
            .chain([radius]);
        for (slot, property) in wanted.enumerate() {
            if let Some(property) = property {
                slots[property] = slot;
            }
        }
        let code = |property: usize| colour_code(&vertex.properties[property]);
        let colour = colour.map(|(names, properties)| (names, properties.map(code)));
        Ok(Self { slots, colour, has_normals: normal.is_some(), has_radii: radius.is_some() })
    }

    pub(super) fn has_colours(&self) -> bool {
        self.colour.is_some()
    }

    pub(super) fn has_normals(&self) -> bool {
        self.has_normals
    }

    pub(super) fn has_radii(&self) -> bool {
        self.has_radii
    }

    /// The point with these numbers, or what is wrong with them.
    pub(super) fn point(&self, values: &Values) -> Result<Point, String> {
        let [x, y, z, nx, ny, nz, r, g, b, radius, _] = *values;
        let colour = match &self.colour {
            None => [0.0; 3],
            Some((names, codes)) => {
                let mut linear = [0.0; 3];
                for (i, stored) in [r, g, b].into_iter().enumerate() {
                    linear[i] = codes[i].linear(stored).ok_or_else(|| {
                        format!("`{}` is {stored}, not from 0 to {}", names[i], codes[i].highest())
                    })?;
                }
                linear
            }
        };
        Ok(Point {
            position: DVec3::new(x, y, z),
            normal: Vec3::new(nx as f32, ny as f32, nz as f32),
            colour,
            radius: radius as f32,
        })
    }
}

fn is_scalar(property: &PropertyDef) -> bool {
    matches!(property.data_type, PropertyType::Scalar(_))
}

/// Colours stored as 32-bit integers hold values of 8 bits: some programs write bytes that way.
fn colour_code(property: &PropertyDef) -> ColourCode {
    match property.data_type {
        PropertyType::Scalar(ScalarType::Float | ScalarType::Double) => ColourCode::Unit,
        PropertyType::Scalar(ScalarType::Short | ScalarType::UShort) => ColourCode::Short,
        _ => ColourCode::Byte,
    }
}
