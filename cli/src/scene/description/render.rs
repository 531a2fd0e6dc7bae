//! `[render]`.

use crate::input_error::InputError;
use crate::scene::Occlusion;
use crate::scene::text::Table;
use pointillist_shade::{Interpolation, Weighting};

/// How to draw.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RenderDescription {
    /// Cells per pixel side.
    pub subpixel: Option<u32>,
    /// How pieces hide one another.
    pub occlusion: Option<Occlusion>,
    /// What is interpolated; `None`: the file's normals where there are any, else flat.
    pub shading: Option<Interpolation>,
    /// How faces count in the normals of meshes that have none.
    pub normals: Weighting,
    /// Edges of such meshes that are folded by more than this stay sharp.
    pub crease_rad: Option<f64>,
}

impl RenderDescription {
    pub(super) fn read(root: &mut Table<'_>) -> Result<Self, InputError> {
        let Some(mut table) = root.table("render")? else { return Ok(Self::default()) };
        let allowed = |n: f64| [1.0, 2.0, 4.0].contains(&n);
        let subpixel = table.number_where("subpixel", "1, 2 or 4", allowed)?.map(|n| n as u32);
        let occlusion = table
            .choice("occlusion", &[("correlated", Occlusion::Correlated), ("paper", Occlusion::Paper)])?;
        let kinds = [
            ("flat", Interpolation::Flat),
            ("gouraud", Interpolation::Gouraud),
            ("phong", Interpolation::Phong),
        ];
        let mut shading = table.choice("shading", &kinds)?;
        let weights = [("area", Weighting::Area), ("angle", Weighting::Angle), ("plain", Weighting::Plain)];
        let normals = table.choice("normals", &weights)?;
        let crease =
            table.number_where("crease", "from 0 to 180 (degrees)", |n| (0.0..=180.0).contains(&n))?;
        for (key, given) in [("normals", normals.is_some()), ("crease", crease.is_some())] {
            if given && shading == Some(Interpolation::Flat) {
                let message = format!("`render.{key}` is about vertex normals, and flat shading has none");
                return Err(table.error(key, message).with_help("remove it, or set `shading` to \"phong\""));
            }
            if given {
                // A file that sets how normals are made asks for them to be made.
                shading = shading.or(Some(Interpolation::Phong));
            }
        }
        table.finish()?;
        let crease_rad = crease.map(f64::to_radians);
        Ok(Self { subpixel, occlusion, shading, normals: normals.unwrap_or_default(), crease_rad })
    }
}
