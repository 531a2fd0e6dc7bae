//! Maps the properties of a PLY vertex to the coordinates, normal and colour of a point.

use super::super::block::{Has, Point};
use super::super::colour::ColourCode;
use super::super::scalar::{SCALARS, Scalar, Scalars};
use super::header::Element;
use crate::input_error::InputError;
use glam::{DVec3, Vec3};
use ply_rs_bw::ply::{PropertyDef, PropertyType, ScalarType};

/// Numbers of a vertex by their meaning, and a place for those without.
pub(super) type Values = [f64; UNUSED + 1];

/// Where a number without meaning goes.
pub(super) const UNUSED: usize = FIRST_SCALAR + SCALARS;

/// Where the first value by [`Scalar`] goes.
const FIRST_SCALAR: usize = 14;

const POSITION: [&str; 3] = ["x", "y", "z"];
const NORMAL: [&str; 3] = ["nx", "ny", "nz"];
/// What `sample` writes beside normals that are interpolated.
const FACE_NORMAL: [&str; 3] = ["face_nx", "face_ny", "face_nz"];

/// The way out for colours and opacities out of range.
pub(super) const COLOUR_HELP: &str =
    "write colours and opacities as uchar from 0 to 255, or as float from 0 to 1";

/// Names of colours; the first that are complete are taken.
const COLOURS: [[&str; 3]; 3] =
    [["red", "green", "blue"], ["diffuse_red", "diffuse_green", "diffuse_blue"], ["r", "g", "b"]];

/// Names of opacities; the first that is there is taken.
const OPACITY: [&str; 2] = ["alpha", "a"];

/// The meaning of each property of a vertex.
pub(super) struct Layout {
    /// For each property an index into [`Values`]: 0–2 position, 3–5 normal, 6–8 colour, 9 radius, 10 opacity, 11–13 normal of the surface, then by [`Scalar`].
    pub(super) slots: Vec<usize>,
    colour: Option<([&'static str; 3], [ColourCode; 3])>,
    opacity: Option<(&'static str, ColourCode)>,
    pub(super) has: Has,
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
        let face_normal = normal.and_then(|_| three(FACE_NORMAL));
        let colour = COLOURS.into_iter().find_map(|names| Some((names, three(names)?)));
        let radius = scalar("radius");
        let opacity = OPACITY.into_iter().find_map(|name| Some((name, scalar(name)?)));
        let scalars = Scalar::ALL.map(|wanted| {
            vertex.properties.iter().position(|p| is_scalar(p) && Scalar::of_name(&p.name) == Some(wanted))
        });
        let mut slots = vec![UNUSED; vertex.properties.len()];
        let wanted = position
            .into_iter()
            .map(Some)
            .chain(normal.map_or([None; 3], |n| n.map(Some)))
            .chain(colour.map_or([None; 3], |(_, c)| c.map(Some)))
            .chain([radius, opacity.map(|(_, property)| property)])
            .chain(face_normal.map_or([None; 3], |n| n.map(Some)))
            .chain(scalars);
        for (slot, property) in wanted.enumerate() {
            if let Some(property) = property {
                slots[property] = slot;
            }
        }
        let code = |property: usize| colour_code(&vertex.properties[property]);
        let colour = colour.map(|(names, properties)| (names, properties.map(code)));
        let opacity = opacity.map(|(name, property)| (name, code(property)));
        let has = Has {
            colours: colour.is_some(),
            opacities: opacity.is_some(),
            normals: normal.is_some(),
            face_normals: face_normal.is_some(),
            radii: radius.is_some(),
            scalars: scalars.map(|property| property.is_some()),
        };
        Ok(Self { slots, colour, opacity, has })
    }

    /// The point with these numbers, or what is wrong with them.
    pub(super) fn point(&self, values: &Values) -> Result<Point, String> {
        let [x, y, z, nx, ny, nz, r, g, b, radius, opacity, fx, fy, fz, ..] = *values;
        let scalars: Scalars<f32> = std::array::from_fn(|i| values[FIRST_SCALAR + i] as f32);
        let out_of_range = |name: &str, stored: f64, code: ColourCode| {
            format!("`{name}` is {stored}, not from 0 to {}", code.highest())
        };
        let colour = match &self.colour {
            None => [0.0; 3],
            Some((names, codes)) => {
                let mut linear = [0.0; 3];
                for (i, stored) in [r, g, b].into_iter().enumerate() {
                    linear[i] =
                        codes[i].linear(stored).ok_or_else(|| out_of_range(names[i], stored, codes[i]))?;
                }
                linear
            }
        };
        let opacity = match self.opacity {
            None => 1.0,
            Some((name, code)) => code.share(opacity).ok_or_else(|| out_of_range(name, opacity, code))?,
        };
        Ok(Point {
            position: DVec3::new(x, y, z),
            normal: Vec3::new(nx as f32, ny as f32, nz as f32),
            face_normal: Vec3::new(fx as f32, fy as f32, fz as f32),
            colour,
            opacity,
            radius: radius as f32,
            scalars,
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
