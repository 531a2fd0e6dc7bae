//! Pictures of all directions, from files to harmonics.

use crate::error::CliError;
use crate::image_io::{Levels, faces_of_strip, read_levels, read_picture, strip_face};
use crate::input_error::InputError;
use crate::options::ResponseCurve;
use crate::probe_io::read_rows;
use pointillist_sh::{
    Brackets, Clipping, CubeMap, CubeProjector, Panorama, PanoramaProjector, Response, Sh, ShError, Weights,
};
use std::path::Path;

/// Linear radiance in rows.
pub(super) struct Image {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) pixels: Vec<[f32; 3]>,
}

/// A picture as it is in its file.
pub(super) enum Exposed {
    /// Levels of a photograph.
    Levels(Levels),
    /// Linear radiance.
    Linear(Image),
}

impl Exposed {
    /// Reads a picture: photographs have levels; pictures of floats and of more bits are linear or sRGB as their format has it.
    pub(super) fn read(path: &Path) -> Result<Self, InputError> {
        if let Some(levels) = read_levels(path)? {
            return Ok(Self::Levels(levels));
        }
        let picture = read_picture(path)?;
        let [width, height] = picture.size.map(|n| n as usize);
        let pixels = picture.color.iter().map(|&[r, g, b, _]| [r, g, b]).collect();
        Ok(Self::Linear(Image { width, height, pixels }))
    }

    pub(super) fn size(&self) -> [usize; 2] {
        match self {
            Self::Levels(levels) => levels.size.map(|n| n as usize),
            Self::Linear(image) => [image.width, image.height],
        }
    }

    /// Adds it to pictures of other exposures.
    pub(super) fn add_to(
        &self,
        brackets: &mut Brackets,
        response: &Response,
        exposure: f32,
    ) -> Result<(), ShError> {
        match self {
            Self::Levels(levels) => brackets.add_photograph(&levels.pixels, response, exposure),
            Self::Linear(image) => brackets.add_radiance(&image.pixels, exposure),
        }
    }
}

/// What brackets of this size hold together, and how much of it is clipped.
pub(super) fn merged(brackets: &Brackets, [width, height]: [usize; 2]) -> (Image, Clipping) {
    let (pixels, clipping) = brackets.merged();
    (Image { width, height, pixels }, clipping)
}

/// A warning about light that is lost, if there is much of it.
pub(super) fn overexposed(name: &str, clipping: Clipping) -> Option<String> {
    let share = clipping.over_exposed * 100.0;
    (share > 0.1)
        .then(|| format!("{name}: {share:.1} % of the pixels are overexposed; what shines there is lost"))
}

/// `--response`.
pub(super) fn response(curve: &ResponseCurve) -> Result<Response, CliError> {
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

/// The harmonics of one picture of all directions: an equirectangular one, or a strip of the faces of a cube.
pub(super) fn project_one(image: &Image, order: usize, weights: Weights) -> Result<Sh, ShError> {
    let Image { width, height, ref pixels } = *image;
    if let Some(face) = strip_face([width, height]) {
        return project_faces(&faces_of_strip(face, width, pixels), order, weights);
    }
    let map = Panorama::new(width, height, pixels)?;
    PanoramaProjector::new(width, height, order, weights)?.project(&map)
}

/// The harmonics of the six faces of a cube, one after the other.
pub(super) fn project_faces(faces: &[[f32; 3]], order: usize, weights: Weights) -> Result<Sh, ShError> {
    let size = ((faces.len() / 6) as f64).sqrt() as usize;
    CubeProjector::new(size, order, weights)?.project(&CubeMap::from_texels(size, faces)?)
}
