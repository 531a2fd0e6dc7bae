//! `probe project`.

use super::photographs::{Exposed, Image, merged, overexposed, project_faces, project_one, response};
use crate::commands::Report;
use crate::commands::report::write_text;
use crate::error::CliError;
use crate::image_io::face_fault;
use crate::input_error::InputError;
use crate::options::ProjectOptions;
use pointillist_sh::{Brackets, Response, Sh, ShError};
use std::path::Path;

pub(super) fn run(options: &ProjectOptions) -> Result<(), CliError> {
    let report = Report::new(&options.common)?.reading(&options.images)?.writing([&options.output.path])?;
    let response = response(&options.response)?;
    let images = options.images.iter().map(|path| read(path, &response, options.exposure, &report));
    let images = report.stats.stage("load", || images.collect::<Result<Vec<_>, _>>())?;
    let name = options.images[0].display().to_string();
    let refused = |error: ShError| CliError::Input(InputError::of_file(&name, error.to_string()));
    let sh = report.stats.stage("project", || project(&images, &name, options, &refused))?;
    let sh = if options.dering { sh.deringed() } else { sh };
    let rows: Vec<[f64; 3]> = sh.coefficients().iter().map(|c| c.to_array()).collect();
    write_text(&options.output.path, |output| {
        serde_json::to_writer(&mut *output, &serde_json::json!({ "order": options.order, "sh": rows }))?;
        writeln!(output)
    })?;
    report.finish()
}

/// A picture as linear radiance.
fn read(path: &Path, response: &Response, exposure: f32, report: &Report<'_>) -> Result<Image, CliError> {
    let picture = Exposed::read(path)?;
    let mut one = Brackets::new();
    let failed = |error: ShError| CliError::Usage(format!("--exposure: {error}"));
    picture.add_to(&mut one, response, exposure).map_err(failed)?;
    let (image, clipping) = merged(&one, picture.size());
    if let Some(warning) = overexposed(&path.display().to_string(), clipping) {
        report.warn(&warning);
    }
    Ok(image)
}

fn project(
    images: &[Image],
    name: &str,
    options: &ProjectOptions,
    refused: &dyn Fn(ShError) -> CliError,
) -> Result<Sh, CliError> {
    let (order, weights) = (options.order.into(), options.weights.weights());
    match images {
        [one] => project_one(one, order, weights).map_err(refused),
        [_, _, _, _, _, _] => project_faces(&six(images, options)?, order, weights).map_err(refused),
        _ => {
            let message =
                format!("{} pictures; one of all directions or six of a cube are needed", images.len());
            Err(InputError::of_file(name, message).into())
        }
    }
}

fn six(images: &[Image], options: &ProjectOptions) -> Result<Vec<[f32; 3]>, CliError> {
    let size = |image: &Image| [image.width, image.height];
    for (image, path) in images.iter().zip(&options.images) {
        if let Some(message) = face_fault(size(image), size(&images[0])) {
            return Err(InputError::of_file(path.display().to_string(), message).into());
        }
    }
    Ok(images.iter().flat_map(|image| image.pixels.iter().copied()).collect())
}
