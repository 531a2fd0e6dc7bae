//! Reads the ascii payload of a PLY, one element a line.

use super::super::block::{At, Gather, Stop};
use super::super::number::{Words, parse_f32, parse_f64};
use super::super::source::{Line, Source};
use super::header::{Element, list_of};
use super::layout::{COLOUR_HELP, Layout, UNUSED, Values};
use super::range_grid::GridReader;
use super::{Place, cut_short};
use crate::input_error::InputError;
use ply_rs_bw::ply::{PropertyDef, PropertyType, ScalarType};

/// Reads the points.
pub(super) fn vertices(
    source: &mut Source<'_>,
    element: &Element,
    layout: &Layout,
    mut grid: Option<&mut GridReader>,
    gather: &mut Gather<'_>,
) -> Result<(), Stop> {
    let name = source.name();
    for index in 0..element.count {
        next_line(source, element, index)?;
        let line = source.line();
        let values = numbers(name, &line, element, layout)?;
        let point = layout
            .point(&values)
            .map_err(|message| line.error(name, None, message).with_help(COLOUR_HELP))?;
        if let Some(grid) = &mut grid {
            grid.keep(point.position).map_err(|error| error.in_file(name))?;
        }
        gather.push(&point, At::Line(line.number))?;
    }
    Ok(())
}

/// Goes to the next line that is not blank.
fn next_line(source: &mut Source<'_>, element: &Element, read: u64) -> Result<(), InputError> {
    loop {
        if !source.next_line()? {
            return Err(cut_short(source, element, read, Place::Line));
        }
        if !source.line().is_blank() {
            return Ok(());
        }
    }
}

/// The numbers of a line by their meaning.
fn numbers(name: &str, line: &Line<'_>, element: &Element, layout: &Layout) -> Result<Values, InputError> {
    let mut values = [0.0; UNUSED + 1];
    let mut words = Words::<false>::of(line.text);
    for (property, &slot) in element.properties.iter().zip(&layout.slots) {
        if list_of(property).is_some() {
            skip_list(name, line, property, &mut words)?;
            continue;
        }
        let word = words.next().ok_or_else(|| too_few(name, line, property))?;
        if slot != UNUSED {
            values[slot] = number(property, word.bytes).ok_or_else(|| {
                let message = format!("`{}` is no number for the property `{}`", word.shown(), property.name);
                line.error(name, Some(word), message)
                    .with_help("each line is one vertex, with the numbers that the header names")
            })?;
        }
    }
    match words.next() {
        None => Ok(values),
        Some(word) => {
            let message =
                format!("`{}` is more than the header announces for `{}`", word.shown(), element.name);
            Err(line
                .error(name, Some(word), message)
                .with_help("the header and the lines must have the same properties"))
        }
    }
}

/// A number rounded to the type of its property, so that ascii and binary files give the same points.
fn number(property: &PropertyDef, word: &[u8]) -> Option<f64> {
    match property.data_type {
        PropertyType::Scalar(ScalarType::Float) => parse_f32(word).map(f64::from),
        _ => parse_f64(word),
    }
}

fn too_few(name: &str, line: &Line<'_>, property: &PropertyDef) -> InputError {
    line.error(name, None, format!("the line ends before the property `{}`", property.name))
        .with_help("the header and the lines must have the same properties")
}

fn length(
    name: &str,
    line: &Line<'_>,
    property: &PropertyDef,
    words: &mut Words<'_, false>,
) -> Result<u64, InputError> {
    let word = words.next().ok_or_else(|| too_few(name, line, property))?;
    let length = std::str::from_utf8(word.bytes).ok().and_then(|text| text.parse().ok());
    length.ok_or_else(|| {
        line.error(
            name,
            Some(word),
            format!("`{}` is no length of the list `{}`", word.shown(), property.name),
        )
        .with_help("a list begins with the number of its items")
    })
}

/// Passes over a list; one that is longer than its line ends at once.
fn skip_list(
    name: &str,
    line: &Line<'_>,
    property: &PropertyDef,
    words: &mut Words<'_, false>,
) -> Result<(), InputError> {
    let length = length(name, line, property, words)?;
    for index in 0..length {
        words.next().ok_or_else(|| short_list(name, line, property, length, index))?;
    }
    Ok(())
}

fn short_list(name: &str, line: &Line<'_>, property: &PropertyDef, length: u64, found: u64) -> InputError {
    let message = format!("the list `{}` announces {length} items, but has {found}", property.name);
    line.error(name, None, message).with_help("a list begins with the number of its items")
}

/// Reads the cells of a range grid.
pub(super) fn cells(source: &mut Source<'_>, element: &Element, grid: &mut GridReader) -> Result<(), Stop> {
    let name = source.name();
    for index in 0..element.count {
        next_line(source, element, index)?;
        let line = source.line();
        let mut words = Words::of(line.text);
        for property in &element.properties {
            if list_of(property).is_none() {
                words.next().ok_or_else(|| too_few(name, &line, property))?;
                continue;
            }
            let length = length(name, &line, property, &mut words)?;
            let mut first = None;
            for item in 0..length {
                let word = words.next().ok_or_else(|| short_list(name, &line, property, length, item))?;
                first = first.or(parse_f64(word.bytes));
            }
            grid.cell(first).map_err(|message| {
                line.error(name, None, message)
                    .with_help("a cell is `0` for a hole or `1 i` for vertex i, from 0")
            })?;
        }
    }
    Ok(())
}

/// Passes over an element.
pub(super) fn skip(source: &mut Source<'_>, element: &Element) -> Result<(), Stop> {
    if element.properties.is_empty() {
        return Ok(());
    }
    for index in 0..element.count {
        if !source.skip_line()? {
            return Err(cut_short(source, element, index, Place::Line).into());
        }
    }
    Ok(())
}
