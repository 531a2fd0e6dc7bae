//! PLY: the element `vertex` in blocks, the `range_grid` for its spacing, everything else passed over.
//!
//! The header goes through `ply-rs-bw`, line by line. The payload does not, though its functions for single elements are
//! fast enough (measured on one core: 5.4 million ascii and 44 million binary points a second): its ascii grammar
//! refuses `nan`, `.5` and `1.`, so that broken points could not be counted nor many sound files read, it ignores surplus
//! words, and it stores every list whole, for as long as the file says. What is left of the binary payload is one
//! function from bytes to a number, which the lists need as well.

mod ascii;
mod binary;
mod header;
mod layout;
mod range_grid;

use super::block::{CloudSummary, Gather, Stop};
use super::format::CloudFormat;
use super::source::Source;
use crate::input_error::InputError;
use header::{Element, Header};
use layout::Layout;
use ply_rs_bw::ply::Encoding;
use range_grid::GridReader;

/// Reads a PLY from its first byte.
pub(super) fn read(mut source: Source<'_>, gather: &mut Gather<'_>) -> Result<CloudSummary, Stop> {
    let header = Header::read(&mut source)?;
    let layout = Layout::of(header.vertex(source.name())?, source.name())?;
    gather.expect(layout.has);
    let mut warnings = Vec::new();
    let mut grid = GridReader::of(&header, &mut warnings);
    for element in &header.elements {
        let is_grid = element.name == "range_grid";
        match (&mut grid, header.encoding) {
            (grid, Encoding::Ascii) if element.name == "vertex" => {
                ascii::vertices(&mut source, element, &layout, grid.as_mut(), gather)?;
            }
            (grid, encoding) if element.name == "vertex" => {
                binary::vertices(&mut source, element, encoding, &layout, grid.as_mut(), gather)?;
            }
            (Some(grid), Encoding::Ascii) if is_grid => ascii::cells(&mut source, element, grid)?,
            (Some(grid), encoding) if is_grid => binary::cells(&mut source, element, encoding, grid)?,
            (_, Encoding::Ascii) => ascii::skip(&mut source, element)?,
            (_, encoding) => binary::skip(&mut source, element, encoding)?,
        }
    }
    if let Some(byte) = source.drain()? {
        warnings.push(format!("what follows the last element, from byte {byte} on, was not read"));
    }
    let mut summary = gather.finish(source.name(), format_of(header.encoding))?;
    summary.faces = header.elements.iter().filter(|e| e.name == "face").map(|e| e.count).sum();
    summary.grid = grid.map(GridReader::finish);
    summary.warnings = warnings;
    Ok(summary)
}

fn format_of(encoding: Encoding) -> CloudFormat {
    match encoding {
        Encoding::Ascii => CloudFormat::PlyAscii,
        Encoding::BinaryLittleEndian => CloudFormat::PlyLittleEndian,
        Encoding::BinaryBigEndian => CloudFormat::PlyBigEndian,
    }
}

/// How messages say where a payload ends.
#[derive(Clone, Copy)]
enum Place {
    Line,
    Byte,
}

/// The file ended within an element of which `read` were read.
fn cut_short(source: &Source<'_>, element: &Element, read: u64, place: Place) -> InputError {
    let Element { name, count, .. } = element;
    let place = match place {
        Place::Line => format!("after line {}", source.line_number()),
        Place::Byte => format!("at byte {}", source.offset()),
    };
    InputError::of_file(source.name(), format!("the file ends {place}, with {read} of {count} `{name}` read"))
        .with_help("it was cut off, or the header counts too many; get or write it again")
}
