//! `[[object]]`.

use super::{FileReference, file};
use crate::input_error::InputError;
use crate::scene::text::{Span, Table};
use glam::{DAffine3, DMat3, DMat4, DVec3};

/// A mesh, placed.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectDescription {
    /// `name`, if given.
    pub name: Option<String>,
    /// The mesh's file.
    pub mesh: FileReference,
    /// World from mesh; invertible.
    pub world_from_mesh: DAffine3,
    /// Name of the material that replaces those of the file, and where it is named.
    pub material: Option<(String, Span)>,
    /// Whether the back is drawn, too.
    pub two_sided: bool,
}

pub(super) fn read_all(root: &mut Table<'_>) -> Result<Vec<ObjectDescription>, InputError> {
    let tables = root.tables("object")?;
    if tables.is_empty() {
        return Err(root.missing("object", "[{ mesh = \"model.obj\" }], or a section [[object]]"));
    }
    tables.into_iter().map(read).collect()
}

fn read(mut table: Table<'_>) -> Result<ObjectDescription, InputError> {
    let name = table.text("name")?.map(str::to_owned);
    let Some(mesh) = file(&mut table, "mesh")? else { return Err(table.missing("mesh", "\"model.obj\"")) };
    let world_from_mesh = read_transform(&mut table)?;
    let material = table.text("material")?.map(|name| (name.to_owned(), table.span_of("material")));
    let two_sided = table.boolean("two_sided")?.unwrap_or(true);
    table.finish()?;
    Ok(ObjectDescription { name, mesh, world_from_mesh, material, two_sided })
}

fn read_transform(table: &mut Table<'_>) -> Result<DAffine3, InputError> {
    let translate = table.vector("translate")?;
    let rotate = table.vector("rotate")?;
    let scale = read_scale(table)?;
    let Some(numbers) = table.numbers::<16>("matrix")? else {
        let radians = rotate.unwrap_or(DVec3::ZERO) * (std::f64::consts::PI / 180.0);
        // Applied x, then y, then z.
        let turn = DMat3::from_rotation_z(radians.z)
            * DMat3::from_rotation_y(radians.y)
            * DMat3::from_rotation_x(radians.x);
        let linear = turn * DMat3::from_diagonal(scale.unwrap_or(DVec3::ONE));
        return Ok(DAffine3 { matrix3: linear, translation: translate.unwrap_or(DVec3::ZERO) });
    };
    if translate.is_some() || rotate.is_some() || scale.is_some() {
        let message = "`matrix` is given together with `translate`, `rotate` or `scale`";
        return Err(table.error("matrix", message).with_help("keep the matrix or the others"));
    }
    let matrix = DMat4::from_cols_array(&numbers);
    if matrix.row(3) != glam::DVec4::W {
        let message = "the last row of `matrix` must be 0, 0, 0, 1";
        return Err(table.error("matrix", message).with_help("the 16 numbers go column by column"));
    }
    let affine = DAffine3::from_mat4(matrix);
    if affine.matrix3.determinant() == 0.0 {
        return Err(table.error("matrix", "`matrix` flattens the object: its determinant is 0"));
    }
    Ok(affine)
}

/// A number or three; none of them 0.
fn read_scale(table: &mut Table<'_>) -> Result<Option<DVec3>, InputError> {
    let scale = if table.is_number("scale") {
        table.number("scale")?.map(DVec3::splat)
    } else {
        table.vector("scale")?
    };
    match scale {
        Some(scale) if scale.to_array().contains(&0.0) => {
            Err(table.error("scale", "`scale` must not be 0: it would flatten the object"))
        }
        scale => Ok(scale),
    }
}
