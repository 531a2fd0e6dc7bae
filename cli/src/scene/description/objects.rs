//! `[[object]]`.

use super::path::{ObjectPath, rotation};
use super::{FileReference, file};
use crate::input_error::InputError;
use crate::scene::text::{Span, Table};
use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3};

/// A mesh, placed.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectDescription {
    /// `name`, if given.
    pub name: Option<String>,
    /// The mesh's file.
    pub mesh: FileReference,
    /// World from mesh; invertible. On a path, that of frame 0.
    pub world_from_mesh: DAffine3,
    /// Where it moves, if it does.
    pub path: Option<ObjectPath>,
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
    let (world_from_mesh, path) = read_transform(&mut table)?;
    let material = table.text("material")?.map(|name| (name.to_owned(), table.span_of("material")));
    let two_sided = table.boolean("two_sided")?.unwrap_or(true);
    table.finish()?;
    Ok(ObjectDescription { name, mesh, world_from_mesh, path, material, two_sided })
}

fn read_transform(table: &mut Table<'_>) -> Result<(DAffine3, Option<ObjectPath>), InputError> {
    let translate = table.vector("translate")?;
    let rotate = table.vector("rotate")?;
    let scale = read_scale(table)?;
    let at = |path: Option<ObjectPath>, still: DAffine3| {
        (path.as_ref().map_or(still, |path| path.world_from_mesh(0)), path)
    };
    let Some(numbers) = table.numbers::<16>("matrix")? else {
        let (translate, rotate) = (translate.unwrap_or(DVec3::ZERO), rotate.unwrap_or(DVec3::ZERO));
        let radians = rotate * (std::f64::consts::PI / 180.0);
        // Applied x, then y, then z.
        let turn = DMat3::from_rotation_z(radians.z)
            * DMat3::from_rotation_y(radians.y)
            * DMat3::from_rotation_x(radians.x);
        let scale = DMat3::from_diagonal(scale.unwrap_or(DVec3::ONE));
        let path = ObjectPath::read(table, translate, rotation(rotate), DAffine3::from_mat3(scale))?;
        return Ok(at(path, DAffine3 { matrix3: turn * scale, translation: translate }));
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
    let path = ObjectPath::read(table, DVec3::ZERO, DQuat::IDENTITY, affine)?;
    Ok(at(path, affine))
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
