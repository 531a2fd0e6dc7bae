//! Reads what is wanted of clouds: the selected points, in the world, with what they are coloured by.

use super::selection::{Selection, Selector};
use crate::cloud_io::{CloudBlock, CloudOptions, CloudSummary, Pose, Scalar, read_cloud};
use crate::input;
use crate::input_error::InputError;
use std::path::Path;

/// How clouds are read.
#[derive(Clone, Debug, Default)]
pub struct PointOptions {
    /// Leave out points that are not finite.
    pub drop_invalid: bool,
    /// Take all points for opaque.
    pub ignore_alpha: bool,
    /// Which points are taken.
    pub selection: Selection,
    /// A measured value that all points must have.
    pub scalar: Option<Scalar>,
}

impl PointOptions {
    /// Refuses a mesh where points have to have been measured.
    ///
    /// # Errors
    ///
    /// Points are selected, or must have a value.
    pub fn refuse_mesh(&self, path: &Path) -> Result<(), InputError> {
        let message = match self.scalar {
            Some(scalar) => format!("a mesh has no {} to be coloured by", scalar.name()),
            None if !self.selection.is_all() => {
                "boxes and classes select points, and this is a mesh".to_owned()
            }
            None => return Ok(()),
        };
        Err(InputError::of_file(input::name_of(path), message)
            .with_help("`pointillist sample MODEL` makes a cloud of it"))
    }
}

/// What takes points: a block of them, and the values that they are coloured by.
pub type PointSink<'a> = &'a mut dyn FnMut(CloudBlock<'_>, &[f32]) -> Result<(), InputError>;

/// Reads a cloud and hands out the points that are selected: blocks of any size from 1, in the order of the file, their positions moved
/// into the world by `pose`, normals as in the file; and the values of [`PointOptions::scalar`], or none. The summary is of all points of
/// the file, in its own frame.
///
/// # Errors
///
/// [`InputError`] if the file cannot be used, or its points have no classes or values that are asked for, or that of `sink`.
pub fn read_points(
    path: &Path,
    options: &PointOptions,
    pose: Option<&Pose>,
    sink: PointSink<'_>,
) -> Result<CloudSummary, InputError> {
    let name = input::name_of(path);
    let mut taker = Taker::new(options, &name);
    let mut moved = vec![];
    let cloud_options = CloudOptions::default()
        .with_drop_invalid(options.drop_invalid)
        .with_scalars(options.scalar.is_some() || options.selection.needs_classes());
    read_cloud(path, &cloud_options, &mut |block| {
        let mut block = block;
        if let Some(pose) = pose {
            moved.clear();
            moved.extend(block.positions.iter().map(|position| pose.to_world(*position)));
            block.positions = &moved;
        }
        taker.take(block, sink)
    })
}

/// Hands on what is wanted of blocks.
#[derive(Debug)]
pub(super) struct Taker<'a> {
    options: &'a PointOptions,
    name: &'a str,
    selector: Selector<'a>,
}

impl<'a> Taker<'a> {
    pub(super) fn new(options: &'a PointOptions, name: &'a str) -> Self {
        Self { options, name, selector: Selector::new(&options.selection) }
    }

    /// Hands on the points of a block that are selected, with their values, if there are any.
    pub(super) fn take(&mut self, mut block: CloudBlock<'_>, sink: PointSink<'_>) -> Result<(), InputError> {
        if self.options.ignore_alpha {
            block.opacities = None;
        }
        let taken = self.selector.of(&block, self.name)?;
        let values = match self.options.scalar {
            None => &[],
            Some(scalar) => taken.scalar(scalar).ok_or_else(|| without(self.name, scalar))?,
        };
        if taken.positions.is_empty() { Ok(()) } else { sink(taken, values) }
    }
}

fn without(name: &str, scalar: Scalar) -> InputError {
    InputError::of_file(name, format!("its points have no {} to be coloured by", scalar.name()))
        .with_help("`pointillist info FILE` says what they have; --color-by elevation and scan need nothing")
}
