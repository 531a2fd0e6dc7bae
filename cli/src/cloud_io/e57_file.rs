//! E57 through the crate of that name.
//!
//! A file may hold several scans; they are handed out one after the other, each moved by its pose. Points that the file
//! marks as invalid are holes of the scanner's grid and are left out with a warning. A point without a colour among others that have one is white.

use super::ReadSeek;
use super::block::{At, CloudSummary, Gather, Has, Point, Stop};
use super::colour::ColourCode;
use super::format::CloudFormat;
use super::scalar::{Scalar, Scalars};
use crate::input_error::InputError;
use e57::{CartesianCoordinate, Color, E57Reader};
use glam::DVec3;

/// Reads an E57.
pub(super) fn read<R: ReadSeek>(
    name: &str,
    mut input: R,
    gather: &mut Gather<'_>,
) -> Result<CloudSummary, Stop> {
    let io = |error: std::io::Error| InputError::of_file(name, format!("cannot be read: {error}"));
    input.rewind().map_err(io)?;
    let mut reader = E57Reader::new(input).map_err(|error| fault(name, &error, 0))?;
    let scans = reader.pointclouds();
    let has_intensities = scans.iter().any(e57::PointCloud::has_intensity);
    gather.expect(Has {
        colours: scans.iter().any(e57::PointCloud::has_color),
        scalars: Scalar::Intensity.alone(has_intensities),
        ..Has::default()
    });
    let mut number = 0;
    let mut holes = 0_u64;
    for scan in &scans {
        let mut points = reader.pointcloud_simple(scan).map_err(|error| fault(name, &error, number))?;
        points.intensity_to_color(false);
        for point in points {
            let point = point.map_err(|error| fault(name, &error, number))?;
            match point.cartesian {
                CartesianCoordinate::Valid { x, y, z } => {
                    let colour = point.color.map_or([1.0; 3], linear);
                    let mut scalars = Scalars::default();
                    scalars[Scalar::Intensity as usize] = point.intensity.unwrap_or(f32::NAN);
                    let point = Point { position: DVec3::new(x, y, z), colour, scalars, ..Point::default() };
                    gather.push(&point, At::Point(number))?;
                }
                _ => holes += 1,
            }
            number += 1;
        }
    }
    let mut summary = gather.finish(name, CloudFormat::E57)?;
    if holes > 0 {
        summary.warnings.push(format!("{holes} of {number} points are marked as invalid and were left out"));
    }
    Ok(summary)
}

/// The library has scaled them to 0 to 1 by the limits that the file gives; rounding beyond is cut off.
fn linear(colour: Color) -> [f32; 3] {
    [colour.red, colour.green, colour.blue]
        .map(|stored| ColourCode::Unit.linear(f64::from(stored).clamp(0.0, 1.0)).unwrap_or(f32::NAN))
}

fn fault(name: &str, error: &e57::Error, read: u64) -> InputError {
    InputError::of_file(name, format!("not E57, after {read} points: {error}"))
        .with_help("the file is damaged or was cut off; get it again, or convert it to PLY")
}
