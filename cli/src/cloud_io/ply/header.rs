//! The header of a PLY.

use super::super::number::{Word, Words};
use super::super::source::{Line, Source};
use crate::input_error::InputError;
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{Encoding, PropertyAccess, PropertyDef, PropertyType, ScalarType};

/// Most bytes of a header. Scanners write some kilobytes of notes; megabytes are a payload whose `end_header` is missing.
const MAX_BYTES: u64 = 1 << 20;

/// Most elements and properties together: they are compared with each other, and no cloud has a hundred.
const MAX_NAMES: usize = 1000;

/// Words for the types of PLY.
const TYPES: [&str; 16] = [
    "char", "int8", "uchar", "uint8", "short", "int16", "ushort", "uint16", "int", "int32", "uint", "uint32",
    "float", "float32", "double", "float64",
];

/// What the header says.
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// `obj_info num_cols`, the width of a range grid.
    pub(super) cols: Option<u64>,
    /// `obj_info num_rows`.
    pub(super) rows: Option<u64>,
}

/// A kind of things and how many there are of it.
pub(super) struct Element {
    pub(super) name: String,
    /// As the header says; never used as the size of an allocation.
    pub(super) count: u64,
    pub(super) properties: Vec<PropertyDef>,
    /// Its line in the header.
    line: (u64, Vec<u8>),
}

/// The type of elements that the library's parser asks for; it creates none while it reads a header.
struct Unread;

impl PropertyAccess for Unread {
    fn new() -> Self {
        Self
    }
}

impl Element {
    /// An error about its line in the header.
    pub(super) fn error(&self, name: &str, message: impl Into<String>) -> InputError {
        let (number, text) = &self.line;
        Line { number: *number, text }.error(name, None, message)
    }
}

impl Header {
    /// Reads up to and with `end_header`.
    pub(super) fn read(source: &mut Source<'_>) -> Result<Self, InputError> {
        let name = source.name();
        let mut text = Text::default();
        while text.lines.last().is_none_or(|line| line.trim_ascii_end() != b"end_header") {
            if !source.next_line()? || source.offset() > MAX_BYTES {
                let message =
                    format!("the header has no line `end_header` up to line {}", source.line_number());
                return Err(InputError::of_file(name, message)
                    .with_help("it was cut off, or it is no PLY; get or write it again"));
            }
            text.add(name, &source.line())?;
        }
        let parsed = Parser::<Unread>::new().read_header(&mut Reader::new(text.checked.as_bytes()));
        let parsed = parsed.map_err(|error| text.fault(name, &error))?;
        // No two have the same name, so the library's map has as many elements as we saw, in the same order.
        let elements = parsed.elements.into_values().zip(&text.elements);
        let elements = elements.map(|(element, &line)| Element {
            name: element.name,
            count: element.count as u64,
            properties: element.properties.into_values().collect(),
            line: (line as u64 + 1, text.lines[line].clone()),
        });
        let note = |key: &str| {
            let mut values = parsed.obj_infos.iter().filter_map(|info| info.strip_prefix(key));
            values.next().and_then(|value| value.trim().parse().ok())
        };
        Ok(Self {
            encoding: parsed.encoding,
            elements: elements.collect(),
            cols: note("num_cols "),
            rows: note("num_rows "),
        })
    }

    /// The element with the points.
    pub(super) fn vertex(&self, name: &str) -> Result<&Element, InputError> {
        self.elements.iter().find(|element| element.name == "vertex").ok_or_else(|| {
            InputError::of_file(name, "the header has no line `element vertex`")
                .with_help("points are the element `vertex` with the properties x, y and z")
        })
    }
}

/// The lines of a header, each looked at for what the library accepts and we must not: its maps keep one of two equal
/// names, and then all numbers behind the second would be off by a column.
#[derive(Default)]
struct Text {
    /// As in the file.
    lines: Vec<Vec<u8>>,
    /// As the library gets them.
    checked: String,
    /// Names of elements, and `element property` for the properties.
    names: Vec<String>,
    /// Numbers of the lines of elements, from 0.
    elements: Vec<usize>,
    /// The element that properties belong to.
    current: String,
}

impl Text {
    fn add(&mut self, name: &str, line: &Line<'_>) -> Result<(), InputError> {
        let words: Vec<Word<'_>> = Words::<false>::of(line.text).collect();
        let mut checked = String::from_utf8_lossy(line.text).into_owned();
        match words.as_slice() {
            [keyword, element, _] if keyword.bytes == b"element" => {
                self.current = String::from_utf8_lossy(element.bytes).into_owned();
                self.elements.push(self.lines.len());
                self.know(name, line, *element, self.current.clone())?;
            }
            [keyword, types @ .., property] if keyword.bytes == b"property" => {
                check_types(name, line, types)?;
                self.know(
                    name,
                    line,
                    *property,
                    format!("{} {}", self.current, String::from_utf8_lossy(property.bytes)),
                )?;
                if !is_identifier(property.bytes) {
                    // Scanners put brackets and percents into names; the library wants letters. We want x, y and z.
                    checked.truncate(property.start);
                    checked += &format!("column_{}", line.number);
                }
            }
            _ => {}
        }
        self.lines.push(line.text.to_vec());
        self.checked += &checked;
        self.checked.push('\n');
        Ok(())
    }

    fn know(&mut self, name: &str, line: &Line<'_>, word: Word<'_>, new: String) -> Result<(), InputError> {
        if self.names.contains(&new) {
            let message = format!("`{}` is there a second time", word.shown());
            return Err(line.error(name, Some(word), message).with_help("remove or rename one of the two"));
        }
        if self.names.len() == MAX_NAMES {
            let message = format!("more than {MAX_NAMES} elements and properties");
            return Err(line.error(name, None, message).with_help("write a cloud with fewer properties"));
        }
        self.names.push(new);
        Ok(())
    }

    fn fault(&self, name: &str, error: &ParseError) -> InputError {
        let text = error.to_string();
        let first = text.lines().next().unwrap_or_default();
        let Some(number) = error.line() else {
            return InputError::of_file(name, format!("not PLY: {first}")).with_help(
                "line 2 of a PLY is `format ascii 1.0`, or binary_little_endian or binary_big_endian",
            );
        };
        let first = first.trim_start_matches(&format!("Line {number}: "));
        let text = number.checked_sub(1).and_then(|at| self.lines.get(at)).map_or(&[][..], Vec::as_slice);
        Line { number: number as u64, text }
            .error(name, None, format!("not PLY: {first}"))
            .with_help("a header has lines `format`, `comment`, `obj_info`, `element NAME COUNT` and `property TYPE NAME`")
    }
}

/// Refuses types that PLY does not have, and lists with lengths that are no integers.
fn check_types(name: &str, line: &Line<'_>, types: &[Word<'_>]) -> Result<(), InputError> {
    let (is_list, types) = match types {
        [list, rest @ ..] if list.bytes == b"list" => (true, rest),
        _ => (false, types),
    };
    let known = |word: &&Word<'_>| TYPES.iter().any(|known| known.as_bytes() == word.bytes);
    if let Some(word) = types.iter().find(|word| !known(word)) {
        let message = format!("`{}` is no type of PLY", word.shown());
        let help = "known are char, uchar, short, ushort, int, uint, float, double, and int8 to float64";
        return Err(line.error(name, Some(*word), message).with_help(help));
    }
    match types.first() {
        Some(length) if is_list && matches!(length.bytes[0], b'f' | b'd') => Err(line
            .error(name, Some(*length), "the length of a list must be an integer")
            .with_help("write `property list uchar int NAME`")),
        _ => Ok(()),
    }
}

fn is_identifier(name: &[u8]) -> bool {
    let is_letter = |byte: u8| byte.is_ascii_alphabetic() || byte == b'_';
    name.first().is_some_and(|&first| is_letter(first))
        && name.iter().all(|&byte| is_letter(byte) || byte.is_ascii_digit() || byte == b'-')
}

/// Bytes of a number in a binary file.
pub(super) const fn size_of(kind: &ScalarType) -> usize {
    match kind {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    }
}

/// The type of a list's length and of its items, if it is a list.
pub(super) const fn list_of(property: &PropertyDef) -> Option<(&ScalarType, &ScalarType)> {
    match &property.data_type {
        PropertyType::Scalar(_) => None,
        PropertyType::List(length, item) => Some((length, item)),
    }
}
