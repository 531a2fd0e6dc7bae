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
    /// Where it is put as a whole, more than once.
    pub copies: Option<Copies>,
    /// Name of the material that replaces those of the file, and where it is named.
    pub material: Option<(String, Span)>,
    /// Whether the back is drawn, too.
    pub two_sided: bool,
}

/// Places of an object that stands in several: each moves all that its own transform or path places.
#[derive(Clone, Debug, PartialEq)]
pub enum Copies {
    /// As the scene file lists them.
    Listed(Vec<DAffine3>),
    /// A text file with one on each line.
    File(FileReference),
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
    let transform = Transform::read(&mut table)?;
    let path = transform.path(&mut table)?;
    let world_from_mesh = path.as_ref().map_or(transform.affine(), |path| path.world_from_mesh(0));
    let copies = read_copies(&mut table)?;
    let material = table.text("material")?.map(|name| (name.to_owned(), table.span_of("material")));
    let two_sided = table.boolean("two_sided")?.unwrap_or(true);
    table.finish()?;
    Ok(ObjectDescription { name, mesh, world_from_mesh, path, copies, material, two_sided })
}

/// `copies`: a file, or a list of transforms.
fn read_copies(table: &mut Table<'_>) -> Result<Option<Copies>, InputError> {
    if table.is_text("copies") {
        return Ok(file(table, "copies")?.map(Copies::File));
    }
    let (given, tables) = (table.get("copies").is_some(), table.tables("copies")?);
    if given && tables.is_empty() {
        let message = format!("`{}` is empty: nothing of the object would be left", table.name_of("copies"));
        let help = "add copies = [{ translate = [0, 0, 0] }], or leave the key out for one object";
        return Err(table.error("copies", message).with_help(help));
    }
    let one = |mut copy: Table<'_>| {
        let transform = Transform::read(&mut copy)?;
        copy.finish()?;
        Ok(transform.affine())
    };
    let listed: Vec<DAffine3> = tables.into_iter().map(one).collect::<Result<_, InputError>>()?;
    Ok(given.then_some(Copies::Listed(listed)))
}

/// The keys that place something: `translate`, `rotate` and `scale`, or `matrix`.
enum Transform {
    Parts { translate: DVec3, rotate: DVec3, scale: DVec3 },
    Matrix(DAffine3),
}

impl Transform {
    fn read(table: &mut Table<'_>) -> Result<Self, InputError> {
        let translate = table.vector("translate")?;
        let rotate = table.vector("rotate")?;
        let scale = read_scale(table)?;
        let Some(numbers) = table.numbers::<16>("matrix")? else {
            return Ok(Self::Parts {
                translate: translate.unwrap_or(DVec3::ZERO),
                rotate: rotate.unwrap_or(DVec3::ZERO),
                scale: scale.unwrap_or(DVec3::ONE),
            });
        };
        if translate.is_some() || rotate.is_some() || scale.is_some() {
            let message = "`matrix` is given together with `translate`, `rotate` or `scale`";
            return Err(table.error("matrix", message).with_help("keep the matrix or the others"));
        }
        match affine_of(&numbers) {
            Ok(affine) => Ok(Self::Matrix(affine)),
            Err((message, help)) => {
                let error = table.error("matrix", format!("`matrix`: {message}"));
                Err(error.with_help(help))
            }
        }
    }

    fn affine(&self) -> DAffine3 {
        match *self {
            Self::Parts { translate, rotate, scale } => placed(translate, rotate, scale),
            Self::Matrix(affine) => affine,
        }
    }

    /// `path` of the object that this is the transform of.
    fn path(&self, table: &mut Table<'_>) -> Result<Option<ObjectPath>, InputError> {
        match *self {
            Self::Parts { translate, rotate, scale } => {
                let base = DAffine3::from_mat3(DMat3::from_diagonal(scale));
                ObjectPath::read(table, translate, rotation(rotate), base)
            }
            Self::Matrix(affine) => ObjectPath::read(table, DVec3::ZERO, DQuat::IDENTITY, affine),
        }
    }
}

/// Scaled, then turned by degrees about x, y and z, in this order, then moved.
pub(in crate::scene) fn placed(translate: DVec3, rotate: DVec3, scale: DVec3) -> DAffine3 {
    let radians = rotate * (std::f64::consts::PI / 180.0);
    let turn = DMat3::from_rotation_z(radians.z)
        * DMat3::from_rotation_y(radians.y)
        * DMat3::from_rotation_x(radians.x);
    DAffine3 { matrix3: turn * DMat3::from_diagonal(scale), translation: translate }
}

/// An affine map from 16 numbers, column by column; or what is wrong with them, and the way out.
pub(in crate::scene) fn affine_of(numbers: &[f64; 16]) -> Result<DAffine3, (&'static str, &'static str)> {
    let matrix = DMat4::from_cols_array(numbers);
    if matrix.row(3) != glam::DVec4::W {
        return Err(("the last row must be 0, 0, 0, 1", "the 16 numbers go column by column"));
    }
    let affine = DAffine3::from_mat4(matrix);
    if affine.matrix3.determinant() == 0.0 {
        return Err((
            "it flattens the object: its determinant is 0",
            "the first three columns are three directions",
        ));
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
