//! Linear pictures in memory, and how far apart two of them are.

use std::path::Path;

use glam::DVec3;
use pointillist_cli::image_io::{Frame, read_picture};

/// Linear colours, row by row from the top.
#[derive(Clone, Debug)]
pub(crate) struct Picture {
    pub(crate) width: usize,
    pub(crate) pixels: Vec<DVec3>,
}

impl Picture {
    pub(crate) fn black(width: u32, height: u32) -> Self {
        Self { width: width as usize, pixels: vec![DVec3::ZERO; width as usize * height as usize] }
    }

    pub(crate) fn from_frame(frame: &Frame) -> Self {
        let color = |c: &[f32; 4]| DVec3::new(c[0].into(), c[1].into(), c[2].into());
        Self { width: frame.size[0] as usize, pixels: frame.color.iter().map(color).collect() }
    }

    /// A picture file; for `NAME.npz` the array `img` in it.
    pub(crate) fn read(path: &Path) -> Result<Self, String> {
        if path.extension().is_some_and(|e| e == "npz") {
            return read_npz(path);
        }
        let picture = read_picture(path).map_err(|e| e.to_string())?;
        let color = |c: &[f32; 4]| DVec3::new(c[0].into(), c[1].into(), c[2].into());
        Ok(Self { width: picture.size[0] as usize, pixels: picture.color.iter().map(color).collect() })
    }

    /// Root of the mean squared difference of all channels. Infinite if a value is not finite.
    pub(crate) fn rmse(&self, other: &Self) -> f64 {
        assert_eq!(self.pixels.len(), other.pixels.len(), "pictures of one size are compared");
        let sum: f64 = self.pixels.iter().zip(&other.pixels).map(|(a, b)| (*a - *b).length_squared()).sum();
        let mean = sum / (3 * self.pixels.len()).max(1) as f64;
        if mean.is_finite() { mean.sqrt() } else { f64::INFINITY }
    }

    /// The largest difference of a channel.
    pub(crate) fn largest_error(&self, other: &Self) -> f64 {
        let differences = self.pixels.iter().zip(&other.pixels).map(|(a, b)| (*a - *b).abs().max_element());
        differences.fold(0.0, |m: f64, d| if d.is_finite() { m.max(d) } else { f64::INFINITY })
    }

    /// How much brighter it is than another as a whole, as a share of that one's light.
    pub(crate) fn bias(&self, other: &Self) -> f64 {
        self.total() / other.total() - 1.0
    }

    /// The mean of two pictures of one size.
    pub(crate) fn mean(&self, other: &Self) -> Self {
        let pixels = self.pixels.iter().zip(&other.pixels).map(|(a, b)| 0.5 * (*a + *b)).collect();
        Self { width: self.width, pixels }
    }

    /// Sum of all pixels and channels.
    pub(crate) fn total(&self) -> f64 {
        self.pixels.iter().map(|p| p.element_sum()).sum()
    }
}

fn read_npz(path: &Path) -> Result<Picture, String> {
    let fault = |e: std::io::Error| format!("{}: {e}", path.display());
    let mut archive = npyz::npz::NpzArchive::open(path).map_err(fault)?;
    let array = archive.by_name("img").map_err(fault)?.ok_or("no array `img`")?;
    let width = *array.shape().get(1).ok_or("`img` has no columns")? as usize;
    let values: Vec<f64> = array.into_vec().map_err(fault)?;
    let pixels = values.chunks_exact(3).map(DVec3::from_slice).collect();
    Ok(Picture { width, pixels })
}
