//! `probe project`.

use crate::commands::Report;
use crate::commands::report::write_text;
use crate::error::CliError;
use crate::image_io::{Levels, read_levels, read_picture};
use crate::input_error::InputError;
use crate::options::{ProjectOptions, ResponseCurve};
use crate::probe_io::read_rows;
use pointillist_sh::{CubeMap, CubeProjector, Panorama, PanoramaProjector, Response, Sh, ShError};
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

/// Linear radiance in rows.
struct Image {
    width: usize,
    height: usize,
    pixels: Vec<[f32; 3]>,
}

fn response(curve: &ResponseCurve) -> Result<Response, CliError> {
    match curve {
        ResponseCurve::Srgb => Ok(Response::srgb()),
        ResponseCurve::Linear => Ok(Response::linear()),
        ResponseCurve::Gamma(gamma) => {
            Response::gamma(*gamma).map_err(|error| CliError::Usage(format!("--response: {error}")))
        }
        ResponseCurve::File(path) => {
            let levels: Vec<f32> =
                read_rows::<1>(path, "radiance", |_| Ok(()))?.into_iter().map(|[v]| v as f32).collect();
            Response::from_levels(&levels).map_err(|error| {
                let error = InputError::of_file(path.display().to_string(), error.to_string());
                error.with_help("the radiance of each of the 256 levels, one a line, rising").into()
            })
        }
    }
}

/// Photographs are made linear by their response; pictures of floats and of more bits are linear or sRGB as their format has it.
fn read(path: &Path, response: &Response, exposure: f32, report: &Report<'_>) -> Result<Image, CliError> {
    if let Some(Levels { size: [width, height], pixels }) = read_levels(path)? {
        let failed = |error: ShError| CliError::Usage(format!("--exposure: {error}"));
        let (pixels, clipping) = response.linearise(&pixels, exposure).map_err(failed)?;
        if clipping.over_exposed > 0.001 {
            let share = clipping.over_exposed * 100.0;
            let name = path.display();
            report.warn(&format!(
                "{name}: {share:.1} % of the pixels are overexposed; what shines there is lost"
            ));
        }
        return Ok(Image { width: width as usize, height: height as usize, pixels });
    }
    let picture = read_picture(path)?;
    let gain = exposure.exp2();
    let pixels = picture.color.iter().map(|&[r, g, b, _]| [r, g, b].map(|v| v * gain)).collect();
    Ok(Image { width: picture.size[0] as usize, height: picture.size[1] as usize, pixels })
}

fn project(
    images: &[Image],
    name: &str,
    options: &ProjectOptions,
    refused: &dyn Fn(ShError) -> CliError,
) -> Result<Sh, CliError> {
    let faces = match images {
        [one] if one.width == 6 * one.height || one.height == 6 * one.width => strip(one),
        [one] => {
            let map = Panorama::new(one.width, one.height, &one.pixels).map_err(refused)?;
            let projector = PanoramaProjector::new(
                one.width,
                one.height,
                options.order.into(),
                options.weights.weights(),
            )
            .map_err(refused)?;
            return projector.project(&map).map_err(refused);
        }
        [_, _, _, _, _, _] => six(images, options)?,
        _ => {
            let message =
                format!("{} pictures; one of all directions or six of a cube are needed", images.len());
            return Err(InputError::of_file(name, message).into());
        }
    };
    let size = ((faces.len() / 6) as f64).sqrt() as usize;
    let cube = CubeMap::from_texels(size, &faces).map_err(refused)?;
    let projector =
        CubeProjector::new(size, options.order.into(), options.weights.weights()).map_err(refused)?;
    projector.project(&cube).map_err(refused)
}

/// The faces of a strip, one after the other.
fn strip(image: &Image) -> Vec<[f32; 3]> {
    if image.height == 6 * image.width {
        return image.pixels.clone();
    }
    let n = image.height;
    let texel = |i: usize| {
        let (face, y, x) = (i / (n * n), i / n % n, i % n);
        image.pixels[y * image.width + face * n + x]
    };
    (0..6 * n * n).map(texel).collect()
}

fn six(images: &[Image], options: &ProjectOptions) -> Result<Vec<[f32; 3]>, CliError> {
    let n = images[0].width;
    for (image, path) in images.iter().zip(&options.images) {
        if [image.width, image.height] != [n, n] {
            let message =
                format!("is {}×{}; all six faces of a cube must be {n}×{n}", image.width, image.height);
            return Err(InputError::of_file(path.display().to_string(), message).into());
        }
    }
    Ok(images.iter().flat_map(|image| image.pixels.iter().copied()).collect())
}
