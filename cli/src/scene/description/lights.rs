//! `[[light]]`.

use crate::input_error::InputError;
use crate::scene::Resolution;
use crate::scene::text::Table;
use glam::{DVec3, Vec3};
use pointillist_render::check_outline;
use pointillist_shade::{Falloff, Light, LightOutline};
use std::num::NonZeroU32;

/// More points than this for one light are a mistake: each is a shadow pass.
const LARGEST_SAMPLES: u32 = 4096;
/// More light cells per side than this cannot be numbered in a 32-bit grid with room to spare.
const LARGEST_RESOLUTION: u32 = 1 << 20;

/// A light and how its shadow is made.
#[derive(Clone, Debug, PartialEq)]
pub struct LightDescription {
    /// `name`, or `light0`, `light1`…
    pub name: String,
    /// What it sends out.
    pub light: Light,
    /// OpenGL's ambient light of a light.
    pub ambient: Vec3,
    /// OpenGL's specular light of a light, if it is not as its diffuse light.
    pub specular: Option<Vec3>,
    /// Whether it casts shadows.
    pub shadow: bool,
    /// Cells of the shadow grid.
    pub resolution: Resolution,
}

#[derive(Clone, Copy)]
enum Kind {
    Point,
    Directional,
    Spot,
    Rect,
    Polygon,
    Line,
}

pub(super) fn read_all(root: &mut Table<'_>) -> Result<Vec<LightDescription>, InputError> {
    let mut lights: Vec<LightDescription> = Vec::new();
    for (index, mut table) in root.tables("light")?.into_iter().enumerate() {
        let name = read_name(&mut table, index)?;
        if lights.iter().any(|light| light.name == name) {
            return Err(table.error("name", format!("there are two lights called \"{name}\"")));
        }
        lights.push(read(table, name)?);
    }
    Ok(lights)
}

fn read_name(table: &mut Table<'_>, index: usize) -> Result<String, InputError> {
    let Some(name) = table.text("name")? else { return Ok(format!("light{index}")) };
    let allowed = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if name.is_empty() || !name.chars().all(allowed) {
        let message =
            format!("`{}` names an image layer; use letters, digits, _ and -", table.name_of("name"));
        return Err(table.error("name", message));
    }
    Ok(name.to_owned())
}

fn read(mut table: Table<'_>, name: String) -> Result<LightDescription, InputError> {
    let kinds = [
        ("point", Kind::Point),
        ("directional", Kind::Directional),
        ("spot", Kind::Spot),
        ("rect", Kind::Rect),
        ("polygon", Kind::Polygon),
        ("line", Kind::Line),
    ];
    let Some(kind) = table.choice("type", &kinds)? else { return Err(table.missing("type", "\"point\"")) };
    let light = match kind {
        Kind::Point => Light::Point {
            position: needed_vector(&mut table, "position")?,
            intensity: needed_color(&mut table, "intensity")?,
            falloff: read_falloff(&mut table)?,
        },
        Kind::Directional => Light::Directional {
            direction: needed_direction(&mut table)?,
            irradiance: needed_color(&mut table, "irradiance")?,
        },
        Kind::Spot => read_spot(&mut table)?,
        Kind::Rect => read_rect(&mut table)?,
        Kind::Polygon => read_polygon(&mut table)?,
        Kind::Line => read_line(&mut table)?,
    };
    let (ambient, specular) = if matches!(kind, Kind::Point | Kind::Spot | Kind::Directional) {
        (table.color("ambient")?.unwrap_or(Vec3::ZERO), table.color("specular")?)
    } else {
        (Vec3::ZERO, None)
    };
    let shadow = table.boolean("shadow")?.unwrap_or(true);
    let resolution = read_resolution(&mut table)?;
    table.finish()?;
    Ok(LightDescription { name, light, ambient, specular, shadow, resolution })
}

fn read_spot(table: &mut Table<'_>) -> Result<Light, InputError> {
    let angle = |n: f64| (0.0..=180.0).contains(&n);
    let cutoff = table.number_where("cutoff", "from 0 to 180 (degrees from the axis)", angle)?;
    let Some(cutoff) = cutoff else { return Err(table.missing("cutoff", "30")) };
    let beam = table.number_where("beam", "from 0 to 180 (degrees from the axis)", angle)?.unwrap_or(cutoff);
    if beam > cutoff {
        let message = format!("`{}` is {beam}, beyond the cutoff of {cutoff}", table.name_of("beam"));
        return Err(table.error("beam", message));
    }
    let exponent = table.number_where("exponent", "0 or more", |n| n >= 0.0)?.unwrap_or(0.0);
    Ok(Light::Spot {
        position: needed_vector(table, "position")?,
        direction: needed_direction(table)?,
        intensity: needed_color(table, "intensity")?,
        beam_rad: beam.to_radians(),
        cutoff_rad: cutoff.to_radians(),
        exponent,
        falloff: read_falloff(table)?,
    })
}

fn read_rect(table: &mut Table<'_>) -> Result<Light, InputError> {
    let corner = needed_vector(table, "position")?;
    let edge_u = needed_vector(table, "edge_u")?;
    let edge_v = needed_vector(table, "edge_v")?;
    if edge_u.cross(edge_v) == DVec3::ZERO {
        let message = format!("`{}`: edge_u and edge_v span no area", table.name_of("edge_v"));
        return Err(table.error("edge_v", message));
    }
    Ok(Light::Rect {
        corner,
        edge_u,
        edge_v,
        radiance: needed_color(table, "radiance")?,
        samples: read_samples(table)?,
        falloff: read_falloff(table)?,
    })
}

fn read_polygon(table: &mut Table<'_>) -> Result<Light, InputError> {
    let Some(vertices) = table.vectors("vertices")? else {
        return Err(table.missing("vertices", "[[0, 2, 0], [1, 2, 0], [0, 2, 1]]"));
    };
    let wrong = |table: &Table<'_>, what: &dyn std::fmt::Display| {
        table.error("vertices", format!("`{}`: {what}", table.name_of("vertices")))
    };
    let outline = LightOutline::new(&vertices).map_err(|e| wrong(table, &e))?;
    check_outline(&vertices).map_err(|e| wrong(table, &e))?;
    Ok(Light::Polygon {
        outline,
        radiance: needed_color(table, "radiance")?,
        two_sided: table.boolean("two_sided")?.unwrap_or(false),
        samples: read_samples(table)?,
        falloff: read_falloff(table)?,
    })
}

fn read_line(table: &mut Table<'_>) -> Result<Light, InputError> {
    let from = needed_vector(table, "from")?;
    let to = needed_vector(table, "to")?;
    if from == to {
        let message = format!("`{}` is `from`, too: the line has no length", table.name_of("to"));
        return Err(table.error("to", message));
    }
    Ok(Light::Line {
        from,
        to,
        radiance: needed_color(table, "radiance")?,
        samples: read_samples(table)?,
        falloff: read_falloff(table)?,
    })
}

/// Nothing for a light that is taken as a whole.
fn read_samples(table: &mut Table<'_>) -> Result<Option<NonZeroU32>, InputError> {
    Ok(table.count("samples", 1, LARGEST_SAMPLES)?.and_then(NonZeroU32::new))
}

fn read_falloff(table: &mut Table<'_>) -> Result<Falloff, InputError> {
    let Some(terms) = table.numbers::<3>("attenuation")? else { return Ok(Falloff::InverseSquare) };
    if terms.iter().any(|&n| n < 0.0) || terms == [0.0; 3] {
        let message = format!(
            "`{}` must be [constant, linear, quadratic], none negative and not all 0",
            table.name_of("attenuation")
        );
        return Err(table.error("attenuation", message));
    }
    Ok(Falloff::Polynomial(terms.map(|n| n as f32)))
}

fn read_resolution(table: &mut Table<'_>) -> Result<Resolution, InputError> {
    if table.is_number("resolution") {
        return Ok(table
            .count("resolution", 1, LARGEST_RESOLUTION)?
            .map_or(Resolution::Auto, Resolution::Cells));
    }
    Ok(table.choice("resolution", &[("auto", Resolution::Auto)])?.unwrap_or_default())
}

fn needed_vector(table: &mut Table<'_>, key: &'static str) -> Result<DVec3, InputError> {
    table.vector(key)?.ok_or_else(|| table.missing(key, "[0, 1, 0]"))
}

fn needed_direction(table: &mut Table<'_>) -> Result<DVec3, InputError> {
    table.direction("direction")?.ok_or_else(|| table.missing("direction", "[0, -1, 0]"))
}

fn needed_color(table: &mut Table<'_>, key: &'static str) -> Result<Vec3, InputError> {
    table.color(key)?.ok_or_else(|| table.missing(key, "[10, 10, 10]"))
}
