//! Where the copies of an object stand, and how much they may take.

use super::description::{Copies, Description, ObjectDescription, affine_of, placed};
use super::weight::{INSTANCE_BYTES, INSTANCE_TRIANGLE_BYTES, TRIANGLE_BYTES};
use crate::input;
use crate::input_error::InputError;
use crate::{memory, number_lines};
use glam::{DAffine3, DVec3};
use std::path::Path;

const LINE: &str = "each line is `x y z`, and then nothing, `rx ry rz` (degrees), `rx ry rz s` or `rx ry rz sx sy sz`; or it has the \
                    16 numbers of a matrix, column by column";

/// The placements of an object; one that changes nothing if there are no copies.
pub(super) fn placements(
    object: &ObjectDescription,
    description: &Description,
    folder: &Path,
) -> Result<Vec<DAffine3>, InputError> {
    let file = match &object.copies {
        None => return Ok(vec![DAffine3::IDENTITY]),
        Some(Copies::Listed(listed)) => return Ok(listed.clone()),
        Some(Copies::File(file)) => file,
    };
    let path = file.path_from(folder);
    let name = input::name_of(&path);
    if !input::is_standard(&path) && !path.is_file() {
        let message = format!("`{name}` is not there");
        return Err(description.document.error(file.span, message).with_help(file.relative_to()));
    }
    let found = number_lines::read(&path, LINE, placement)?;
    if found.is_empty() {
        return Err(
            InputError::of_file(name, "has no copies: nothing of the object would be left").with_help(LINE)
        );
    }
    Ok(found)
}

fn placement(numbers: &[f64]) -> Result<DAffine3, String> {
    let vector = |at: usize| DVec3::new(numbers[at], numbers[at + 1], numbers[at + 2]);
    let scaled = |scale: DVec3| match scale.to_array().contains(&0.0) {
        true => Err("the scale is 0: it would flatten the object".to_owned()),
        false => Ok(placed(vector(0), vector(3), scale)),
    };
    match numbers.len() {
        3 => Ok(placed(vector(0), DVec3::ZERO, DVec3::ONE)),
        6 => Ok(placed(vector(0), vector(3), DVec3::ONE)),
        7 => scaled(DVec3::splat(numbers[6])),
        9 => scaled(vector(6)),
        16 => {
            let matrix = <&[f64; 16]>::try_from(numbers).map_err(|_| "16 numbers are a matrix".to_owned())?;
            affine_of(matrix).map_err(|(message, _)| message.to_owned())
        }
        count => Err(format!("{count} numbers, where 3, 6, 7, 9 or 16 can be understood")),
    }
}

/// Whether so many copies of a mesh fit into memory: some with triangles of their own, the others stored once.
pub(super) fn check_memory(
    object: &ObjectDescription,
    description: &Description,
    triangles: usize,
    [by_themselves, instances]: [usize; 2],
) -> Result<(), InputError> {
    let copies = by_themselves + instances;
    let triangles_of = |places: usize, bytes: u64| triangles as u128 * places as u128 * u128::from(bytes);
    let needed = triangles_of(by_themselves, TRIANGLE_BYTES)
        + triangles_of(instances, INSTANCE_TRIANGLE_BYTES)
        + instances as u128 * u128::from(INSTANCE_BYTES);
    // One object is looked at where its file is read.
    if copies < 2 {
        return Ok(());
    }
    memory::check(needed, || format!("{copies} copies of {triangles} triangles take")).map_err(|error| {
        let Some(copies) = &object.copies else { return error.in_file(description.document.name()) };
        match copies {
            Copies::File(file) => description.document.error(file.span, error.with_help()),
            Copies::Listed(_) => description.document.error(object.mesh.span, error.with_help()),
        }
    })
}
