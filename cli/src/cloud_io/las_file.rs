//! LAS and LAZ through the crate `las`.
//!
//! Coordinates come out with scale and offset applied, exact to the last digit ([`Axis`]). Colours have 16 bits by the standard, but many programs write 8
//! into them: if the largest of the first block is from 1 to 255, they are taken as 8 bits.

use super::ReadSeek;
use super::block::{At, CloudSummary, Gather, Has, MAX_BLOCK_POINTS, Point, Stop};
use super::colour::ColourCode;
use super::format::CloudFormat;
use super::las_axis::Axis;
use super::las_check;
use super::scalar::SCALARS;
use crate::input_error::InputError;
use glam::DVec3;
use las::{PointData, PointDataBuilder, Reader};

/// Bytes of decoded records at once. The header says how long a record is, up to 64 KiB, so that 65,536 of them would be
/// 4 GiB on its word.
const CHUNK_BYTES: usize = 4 << 20;

/// Reads a LAS or LAZ.
pub(super) fn read<R: ReadSeek>(
    name: &str,
    mut input: R,
    gather: &mut Gather<'_>,
) -> Result<CloudSummary, Stop> {
    las_check::check(name, &mut input)?;
    las_check::check_items(name, &mut input)?;
    let mut reader = Reader::new(input).map_err(|error| fault(name, &error, 0))?;
    let mut chunk = PointDataBuilder::new().for_header(reader.header()).build();
    let announced = reader.header().number_of_points();
    let points_at_once = (CHUNK_BYTES / chunk.record_len().max(1)).clamp(1, MAX_BLOCK_POINTS);
    gather.expect(Has {
        colours: reader.header().point_format().has_color,
        scalars: [true; SCALARS],
        ..Has::default()
    });
    let transforms = reader.header().transforms();
    let axes = [transforms.x, transforms.y, transforms.z].map(|axis| Axis::new(axis.scale, axis.offset));
    let mut code = None;
    let mut read = 0;
    while read < announced {
        let count = reader
            .fill_points(points_at_once as u64, &mut chunk)
            .map_err(|error| fault(name, &error, read))?;
        if count == 0 {
            break;
        }
        let code = *code.get_or_insert_with(|| colour_code(&chunk));
        push(name, &chunk, code, &axes, read, gather)?;
        read += count;
    }
    gather.finish(name, CloudFormat::Las)
}

fn fault(name: &str, error: &las::Error, read: u64) -> InputError {
    InputError::of_file(name, format!("not LAS, after {read} points: {error}"))
        .with_help("the file is damaged or was cut off; get it again, or convert it to PLY")
}

pub(super) fn colour_code(chunk: &PointData) -> ColourCode {
    let highest = chunk.rgb().into_iter().flatten().map(|(r, g, b)| r.max(g).max(b)).max();
    if highest.is_some_and(|highest| (1..=255).contains(&highest)) {
        ColourCode::Byte
    } else {
        ColourCode::Short
    }
}

/// Hands on points; `before` is the number of the first.
pub(super) fn push(
    name: &str,
    chunk: &PointData,
    code: ColourCode,
    [x, y, z]: &[Axis; 3],
    before: u64,
    gather: &mut Gather<'_>,
) -> Result<(), Stop> {
    let mut colours = chunk.rgb();
    let stored = chunk.x_raw().zip(chunk.y_raw()).zip(chunk.z_raw());
    let measured = chunk.intensity().zip(chunk.classification()).zip(chunk.return_number());
    for (index, (((i, j), k), ((intensity, class), return_number))) in stored.zip(measured).enumerate() {
        let number = before + index as u64;
        let mut point = Point {
            position: DVec3::new(x.coordinate(i), y.coordinate(j), z.coordinate(k)),
            // In the order of `Scalar`.
            scalars: [f32::from(intensity), f32::from(class), f32::from(return_number)],
            ..Point::default()
        };
        if let Some((r, g, b)) = colours.as_mut().and_then(Iterator::next) {
            for (linear, stored) in point.colour.iter_mut().zip([r, g, b]) {
                *linear = code.linear(f64::from(stored)).ok_or_else(|| {
                    let message = format!(
                        "point {number} (from 0) has a colour of {stored}, but those before have 8 bits"
                    );
                    InputError::of_file(name, message).with_help("write all colours with 16 bits")
                })?;
            }
        }
        gather.push(&point, At::Point(number))?;
    }
    Ok(())
}
