//! Which points of clouds are drawn: those in boxes, those of classes.

use crate::cloud_io::{CloudBlock, Scalar};
use crate::input;
use crate::input_error::InputError;
use glam::{DVec3, Vec3};
use std::path::PathBuf;

/// A box along the axes of the world, its faces included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorldBox {
    /// Lowest coordinates.
    pub low: DVec3,
    /// Highest coordinates.
    pub high: DVec3,
}

impl WorldBox {
    fn contains(&self, point: DVec3) -> bool {
        point.cmpge(self.low).all() && point.cmple(self.high).all()
    }
}

/// Which points are drawn. The default takes all.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Selection {
    /// Only points in any of these, if there are some.
    pub boxes: Vec<WorldBox>,
    /// No points in any of these.
    pub dropped_boxes: Vec<WorldBox>,
    /// Only points of these classes, if there are some.
    pub classes: Vec<u8>,
    /// No points of these classes.
    pub dropped_classes: Vec<u8>,
}

impl Selection {
    /// Whether every point is taken.
    #[must_use]
    pub fn is_all(&self) -> bool {
        self.boxes.is_empty() && self.dropped_boxes.is_empty() && !self.needs_classes()
    }

    /// Whether points must say their class.
    #[must_use]
    pub fn needs_classes(&self) -> bool {
        !(self.classes.is_empty() && self.dropped_classes.is_empty())
    }

    /// Refuses that nothing is left of `paths`.
    ///
    /// # Errors
    ///
    /// `points` is 0.
    pub fn check_any(&self, points: usize, paths: &[PathBuf]) -> Result<(), InputError> {
        if points > 0 {
            return Ok(());
        }
        let names: Vec<String> = paths.iter().map(|path| input::name_of(path)).collect();
        Err(InputError::of_file(names.join(", "), "no point is left by --box, --classes and what they drop")
            .with_help("`pointillist info FILE` prints the bounds of a cloud and its classes"))
    }

    /// Whether points between two corners may be taken.
    #[must_use]
    pub fn may_take_of(&self, low: DVec3, high: DVec3) -> bool {
        let meets = |one: &WorldBox| one.low.cmple(high).all() && one.high.cmpge(low).all();
        self.boxes.is_empty() || self.boxes.iter().any(meets)
    }

    fn takes_place(&self, point: DVec3) -> bool {
        let is_in = |boxes: &[WorldBox]| boxes.iter().any(|one| one.contains(point));
        (self.boxes.is_empty() || is_in(&self.boxes)) && !is_in(&self.dropped_boxes)
    }

    fn takes_class(&self, class: f32) -> bool {
        let is_in = |classes: &[u8]| classes.iter().any(|&one| f32::from(one) == class);
        (self.classes.is_empty() || is_in(&self.classes)) && !is_in(&self.dropped_classes)
    }
}

/// Takes what is selected out of blocks.
#[derive(Debug)]
pub struct Selector<'a> {
    selection: &'a Selection,
    taken: Vec<usize>,
    positions: Vec<DVec3>,
    colours: Vec<[f32; 3]>,
    opacities: Vec<f32>,
    normals: Vec<Vec3>,
    face_normals: Vec<Vec3>,
    radii: Vec<f32>,
    scalars: [Vec<f32>; Scalar::ALL.len()],
}

/// The values with these numbers.
fn gather<'a, T: Copy>(taken: &[usize], values: &[T], into: &'a mut Vec<T>) -> &'a [T] {
    into.clear();
    into.extend(taken.iter().map(|&i| values[i]));
    into
}

impl<'a> Selector<'a> {
    /// Of this selection.
    #[must_use]
    pub fn new(selection: &'a Selection) -> Self {
        Self {
            selection,
            taken: vec![],
            positions: vec![],
            colours: vec![],
            opacities: vec![],
            normals: vec![],
            face_normals: vec![],
            radii: vec![],
            scalars: Default::default(),
        }
    }

    /// The points of a block that are selected, which may be none; their positions are in the world. `name` is that of the file.
    ///
    /// # Errors
    ///
    /// Classes are asked for, but the points have none.
    pub fn of<'b>(&'b mut self, block: &CloudBlock<'b>, name: &str) -> Result<CloudBlock<'b>, InputError> {
        if self.selection.is_all() {
            return Ok(*block);
        }
        let classes = block.scalar(Scalar::Class).filter(|_| self.selection.needs_classes());
        if self.selection.needs_classes() && classes.is_none() {
            return Err(InputError::of_file(name, "its points have no classes to be selected by").with_help(
                "LAS has them, and PLY and text where a property or column is called `classification`, `class` or `label`",
            ));
        }
        self.taken.clear();
        self.taken.extend((0..block.positions.len()).filter(|&i| {
            self.selection.takes_place(block.positions[i])
                && classes.is_none_or(|classes| self.selection.takes_class(classes[i]))
        }));
        let taken = &self.taken;
        let mut scalars = [None; Scalar::ALL.len()];
        for ((part, values), into) in scalars.iter_mut().zip(block.scalars).zip(&mut self.scalars) {
            *part = values.map(|values| gather(taken, values, into));
        }
        Ok(CloudBlock {
            positions: gather(taken, block.positions, &mut self.positions),
            colours: block.colours.map(|values| gather(taken, values, &mut self.colours)),
            opacities: block.opacities.map(|values| gather(taken, values, &mut self.opacities)),
            normals: block.normals.map(|values| gather(taken, values, &mut self.normals)),
            face_normals: block.face_normals.map(|values| gather(taken, values, &mut self.face_normals)),
            radii: block.radii.map(|values| gather(taken, values, &mut self.radii)),
            scalars,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_and_classes_take_and_drop() {
        let cube = |low: f64, high: f64| WorldBox { low: DVec3::splat(low), high: DVec3::splat(high) };
        let positions: Vec<DVec3> = (0..10).map(|i| DVec3::splat(f64::from(i))).collect();
        let classes: Vec<f32> = (0..10_u8).map(f32::from).collect();
        let block = CloudBlock {
            positions: &positions,
            colours: None,
            opacities: None,
            normals: None,
            face_normals: None,
            radii: None,
            scalars: [None, Some(&classes), None],
        };
        let taken = |selection: &Selection| {
            let mut selector = Selector::new(selection);
            let part = selector.of(&block, "a.las").unwrap();
            let classes = part.scalar(Scalar::Class).unwrap().to_vec();
            assert_eq!(part.positions.iter().map(|p| p.x as f32).collect::<Vec<_>>(), classes);
            classes
        };
        let all = Selection::default();
        assert_eq!(taken(&all).len(), 10);
        let boxes = Selection { boxes: vec![cube(1.0, 3.0), cube(7.5, 8.5)], ..all.clone() };
        assert_eq!(taken(&boxes), [1.0, 2.0, 3.0, 8.0]);
        let without = Selection { dropped_boxes: vec![cube(2.0, 2.0)], ..boxes };
        assert_eq!(taken(&without), [1.0, 3.0, 8.0]);
        let classes = Selection { classes: vec![3, 8, 200], ..without };
        assert_eq!(taken(&classes), [3.0, 8.0]);
        let dropped = Selection { dropped_classes: vec![0, 1, 2, 3, 4, 5, 6, 7, 8], ..all };
        assert_eq!(taken(&dropped), [9.0]);
        let bare = CloudBlock { scalars: [None; 3], ..block };
        let error = Selector::new(&dropped).of(&bare, "a.ply").unwrap_err().to_string();
        assert!(error.contains("a.ply") && error.contains("no classes"), "{error}");
    }
}
