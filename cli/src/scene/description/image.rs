//! `[image]`.

use super::LARGEST_SIDE;
use super::maps::{EnvironmentReference, environment};
use crate::input_error::InputError;
use crate::scene::text::Table;
use glam::Vec3;

/// Width and height of a picture whose scene does not say.
pub const DEFAULT_SIZE: [u32; 2] = [960, 540];

/// The picture's size and what is behind everything.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageDescription {
    /// Width and height.
    pub size: [u32; 2],
    /// Linear colour behind everything.
    pub background: Vec3,
    /// Picture around everything.
    pub environment: Option<EnvironmentReference>,
    /// The colour is seen behind everything although there is a picture, which then only lights and is mirrored.
    pub hides_environment: bool,
}

impl ImageDescription {
    pub(super) fn read(root: &mut Table<'_>) -> Result<Self, InputError> {
        let nothing =
            Self { size: DEFAULT_SIZE, background: Vec3::ZERO, environment: None, hides_environment: false };
        let Some(mut table) = root.table("image")? else { return Ok(nothing) };
        let size = size(&mut table)?;
        let background = table.color("background")?.unwrap_or(Vec3::ZERO);
        let environment = environment(&mut table, "environment")?;
        let backdrops = [("environment", false), ("background", true)];
        let hides_environment = table.choice("backdrop", &backdrops)?.unwrap_or(false);
        table.finish()?;
        Ok(Self { size, background, environment, hides_environment })
    }
}

fn size(table: &mut Table<'_>) -> Result<[u32; 2], InputError> {
    let Some(size) = table.numbers::<2>("size")? else { return Ok(DEFAULT_SIZE) };
    let fits = |n: f64| n.fract() == 0.0 && (1.0..=f64::from(LARGEST_SIDE)).contains(&n);
    if !size.iter().all(|&n| fits(n)) {
        let [w, h] = size;
        let message = format!(
            "`image.size` is [{w}, {h}]; width and height must be whole numbers from 1 to {LARGEST_SIDE}"
        );
        return Err(table.error("size", message));
    }
    Ok(size.map(|n| n as u32))
}
