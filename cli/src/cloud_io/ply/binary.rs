//! Reads the binary payload of a PLY.

use super::super::block::{At, Gather, Stop};
use super::super::source::Source;
use super::header::{Element, size_of};
use super::layout::{COLOUR_HELP, Layout, UNUSED, Values};
use super::range_grid::GridReader;
use super::{Place, cut_short};
use crate::input_error::InputError;
use ply_rs_bw::ply::{Encoding, PropertyDef, PropertyType, ScalarType};

/// Reads the points.
pub(super) fn vertices(
    source: &mut Source<'_>,
    element: &Element,
    encoding: Encoding,
    layout: &Layout,
    mut grid: Option<&mut GridReader>,
    gather: &mut Gather<'_>,
) -> Result<(), Stop> {
    for index in 0..element.count {
        let start = source.offset();
        let Some(values) = numbers(source, element, encoding, layout)? else {
            return Err(cut_short(source, element, index, Place::Byte).into());
        };
        let point = layout.point(&values).map_err(|message| {
            InputError::of_file(
                source.name(),
                format!("{message}, in vertex {index} (from 0) at byte {start}"),
            )
            .with_help(COLOUR_HELP)
        })?;
        if let Some(grid) = &mut grid {
            grid.keep(point.position).map_err(|error| error.in_file(source.name()))?;
        }
        gather.push(&point, At::Byte(start))?;
    }
    Ok(())
}

/// The numbers of a vertex by their meaning; nothing if the file ends within.
fn numbers(
    source: &mut Source<'_>,
    element: &Element,
    encoding: Encoding,
    layout: &Layout,
) -> Result<Option<Values>, InputError> {
    let mut values = [0.0; UNUSED + 1];
    for (property, &slot) in element.properties.iter().zip(&layout.slots) {
        match &property.data_type {
            PropertyType::Scalar(kind) => {
                let Some(value) = scalar(source, kind, encoding)? else { return Ok(None) };
                values[slot] = value;
            }
            PropertyType::List(length, item) => {
                let Some(length) = list_length(source, property, length, encoding)? else { return Ok(None) };
                skip_items(source, property, length, item)?;
            }
        }
    }
    Ok(Some(values))
}

/// A number of the payload; nothing at the end of the file.
#[inline]
fn scalar(source: &mut Source<'_>, kind: &ScalarType, encoding: Encoding) -> Result<Option<f64>, InputError> {
    let Some(bytes) = source.bytes(size_of(kind))? else { return Ok(None) };
    let is_big = encoding == Encoding::BinaryBigEndian;
    Ok(Some(match kind {
        ScalarType::Char => f64::from(i8::from_le_bytes(array(bytes, is_big))),
        ScalarType::UChar => f64::from(u8::from_le_bytes(array(bytes, is_big))),
        ScalarType::Short => f64::from(i16::from_le_bytes(array(bytes, is_big))),
        ScalarType::UShort => f64::from(u16::from_le_bytes(array(bytes, is_big))),
        ScalarType::Int => f64::from(i32::from_le_bytes(array(bytes, is_big))),
        ScalarType::UInt => f64::from(u32::from_le_bytes(array(bytes, is_big))),
        ScalarType::Float => f64::from(f32::from_le_bytes(array(bytes, is_big))),
        ScalarType::Double => f64::from_le_bytes(array(bytes, is_big)),
    }))
}

/// The bytes, lowest first.
#[inline]
fn array<const N: usize>(bytes: &[u8], is_big: bool) -> [u8; N] {
    let mut array = [0; N];
    array.copy_from_slice(bytes);
    if is_big {
        array.reverse();
    }
    array
}

/// How many items follow; nothing at the end of the file.
fn list_length(
    source: &mut Source<'_>,
    property: &PropertyDef,
    kind: &ScalarType,
    encoding: Encoding,
) -> Result<Option<u64>, InputError> {
    let start = source.offset();
    match scalar(source, kind, encoding)? {
        Some(length) if length < 0.0 => {
            let message = format!("the list `{}` at byte {start} has a length of {length}", property.name);
            Err(InputError::of_file(source.name(), message)
                .with_help("the file is damaged; get or write it again"))
        }
        length => Ok(length.map(|length| length as u64)),
    }
}

/// Passes over the items of a list without keeping them: its length is no reason to ask for memory.
fn skip_items(
    source: &mut Source<'_>,
    property: &PropertyDef,
    length: u64,
    item: &ScalarType,
) -> Result<(), InputError> {
    let start = source.offset();
    let bytes = length.saturating_mul(size_of(item) as u64);
    let skipped = source.skip(bytes)?;
    if skipped == bytes {
        return Ok(());
    }
    let message = format!(
        "the list `{}` announces {length} items, {bytes} bytes from byte {start} on, but only {skipped} bytes are left",
        property.name
    );
    Err(InputError::of_file(source.name(), message)
        .with_help("the file is damaged or was cut off; get it again"))
}

/// Reads the cells of a range grid.
pub(super) fn cells(
    source: &mut Source<'_>,
    element: &Element,
    encoding: Encoding,
    grid: &mut GridReader,
) -> Result<(), Stop> {
    for index in 0..element.count {
        let start = source.offset();
        let mut first = None;
        for property in &element.properties {
            let found = match &property.data_type {
                PropertyType::Scalar(kind) => scalar(source, kind, encoding)?,
                PropertyType::List(length, item) => {
                    let length = list_length(source, property, length, encoding)?;
                    let (length, found) = match length {
                        Some(length) if length > 0 => {
                            first = scalar(source, item, encoding)?;
                            (length - 1, first)
                        }
                        length => (0, length.map(|_| 0.0)),
                    };
                    skip_items(source, property, length, item)?;
                    found
                }
            };
            if found.is_none() {
                return Err(cut_short(source, element, index, Place::Byte).into());
            }
        }
        grid.cell(first).map_err(|message| {
            InputError::of_file(source.name(), format!("{message}, in cell {index} (from 0) at byte {start}"))
                .with_help("a cell is an empty list for a hole, or a list of one vertex, from 0")
        })?;
    }
    Ok(())
}

/// Passes over an element.
pub(super) fn skip(source: &mut Source<'_>, element: &Element, encoding: Encoding) -> Result<(), Stop> {
    let size = |property: &PropertyDef| match &property.data_type {
        PropertyType::Scalar(kind) => Some(size_of(kind) as u64),
        PropertyType::List(..) => None,
    };
    if let Some(stride) = element.properties.iter().map(size).sum::<Option<u64>>() {
        let bytes = element.count.saturating_mul(stride);
        let skipped = source.skip(bytes)?;
        if skipped < bytes {
            return Err(cut_short(source, element, skipped / stride, Place::Byte).into());
        }
        return Ok(());
    }
    for index in 0..element.count {
        for property in &element.properties {
            let is_there = match &property.data_type {
                PropertyType::Scalar(kind) => scalar(source, kind, encoding)?.is_some(),
                PropertyType::List(length, item) => match list_length(source, property, length, encoding)? {
                    Some(length) => skip_items(source, property, length, item).map(|()| true)?,
                    None => false,
                },
            };
            if !is_there {
                return Err(cut_short(source, element, index, Place::Byte).into());
            }
        }
    }
    Ok(())
}
