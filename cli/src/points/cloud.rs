//! Clouds for `surfel`: files in, points with what they have out.

use super::colouring::{Colouring, Legend, Part};
use super::reading::{PointOptions, read_points};
use crate::cloud_io::CloudBlock;
use crate::input;
use crate::input_error::InputError;
use crate::memory::Meter;
use glam::{DVec3, Vec3};
use pointillist_ibpr as ibpr;
use pointillist_render::fingerprint::ByteHash;
use pointillist_surfel::{Cloud, Division, Points, SurfelError};
use std::path::{Path, PathBuf};

/// The points of all files, with the attributes that all of them have.
#[derive(Clone, Debug, Default)]
pub struct PointSet {
    positions: Vec<DVec3>,
    normals: Option<Vec<Vec3>>,
    /// Of the surface, where the normals are interpolated; none as long as no file has them. Points of files without them have their normals here.
    face_normals: Option<Vec<Vec3>>,
    colours: Option<Vec<[f32; 3]>>,
    radii: Option<Vec<f32>>,
    /// None as long as no file has them; points of files without them are opaque.
    opacities: Option<Vec<f32>>,
    /// What was measured, if points are coloured by it.
    values: Vec<f32>,
    /// The files, and the number of the first point of each.
    files: Vec<(PathBuf, usize)>,
    /// The number of the first of them among all that are drawn.
    first_number: usize,
    /// What may be wrong, with the name of the file.
    pub warnings: Vec<String>,
    /// What its points take.
    meter: Meter,
}

/// Bytes of a point: as it is kept here, and what the renderer makes of it. Half of what was measured at the peak (430 to 460,
/// three million points), because [`Meter`] asks for twice as much.
const POINT_BYTES: u64 = 230;

/// Appends a file's part of an attribute, which counts only if all files have it.
fn append<T: Clone>(all: &mut Option<Vec<T>>, part: Option<&[T]>) {
    match (all.as_mut(), part) {
        (Some(all), Some(part)) => all.extend_from_slice(part),
        _ => *all = None,
    }
}

/// The same of chosen values.
fn append_chosen<T: Copy>(all: &mut Option<Vec<T>>, part: Option<&Vec<T>>, chosen: &[u32]) {
    match (all.as_mut(), part) {
        (Some(all), Some(part)) => all.extend(chosen.iter().map(|&i| part[i as usize])),
        _ => *all = None,
    }
}

impl PointSet {
    /// Reads clouds.
    ///
    /// # Errors
    ///
    /// [`InputError`] for the first file that cannot be used.
    pub fn load(paths: &[PathBuf], options: &PointOptions) -> Result<Self, InputError> {
        let mut set = Self::empty();
        for path in paths {
            set.read(path, options)?;
        }
        options.selection.check_any(set.positions.len(), paths)?;
        Ok(set)
    }

    /// No points yet.
    pub(super) fn empty() -> Self {
        Self { normals: Some(vec![]), colours: Some(vec![]), radii: Some(vec![]), ..Self::default() }
    }

    /// No points yet of a file with this number among all that are drawn.
    pub(super) fn of_file(path: &Path, number: usize) -> Self {
        Self { files: vec![(path.to_owned(), 0)], first_number: number, ..Self::empty() }
    }

    /// Says that the points to come are of this file.
    pub(super) fn begin(&mut self, path: &Path) {
        self.files.push((path.to_owned(), self.positions.len()));
    }

    /// How many points there are.
    pub fn count(&self) -> usize {
        self.positions.len()
    }

    /// All positions.
    pub fn positions(&self) -> impl Iterator<Item = DVec3> + '_ {
        self.positions.iter().copied()
    }

    /// Adds points.
    pub(super) fn add(&mut self, block: &CloudBlock<'_>, values: &[f32]) {
        self.values.extend_from_slice(values);
        self.positions.extend_from_slice(block.positions);
        self.add_face_normals(block.face_normals, block.normals);
        append(&mut self.normals, block.normals);
        append(&mut self.colours, block.colours);
        append(&mut self.radii, block.radii);
        let opacities = block.opacities;
        if opacities.is_some() || self.opacities.is_some() {
            let all = self.opacities.get_or_insert_default();
            // Of files without.
            all.resize(self.positions.len() - block.positions.len(), 1.0);
            all.extend_from_slice(opacities.unwrap_or_default());
            all.resize(self.positions.len(), 1.0);
        }
    }

    /// Before the normals of the same points are added.
    fn add_face_normals(&mut self, own: Option<&[Vec3]>, normals: Option<&[Vec3]>) {
        let (Some(before), Some(normals)) = (&self.normals, normals) else {
            self.face_normals = None;
            return;
        };
        if own.is_some() && self.face_normals.is_none() {
            self.face_normals = Some(before.clone());
        }
        if let Some(all) = &mut self.face_normals {
            all.extend_from_slice(own.unwrap_or(normals));
        }
    }

    /// Adds points of another set that have been coloured, by their numbers.
    pub(super) fn add_chosen(&mut self, from: &Self, chosen: &[u32]) {
        let before = self.positions.len();
        self.positions.extend(chosen.iter().map(|&i| from.positions[i as usize]));
        let of = |all: Option<&Vec<Vec3>>| -> Option<Vec<Vec3>> {
            all.map(|all| chosen.iter().map(|&i| all[i as usize]).collect())
        };
        self.add_face_normals(
            of(from.face_normals.as_ref()).as_deref(),
            of(from.normals.as_ref()).as_deref(),
        );
        append_chosen(&mut self.normals, from.normals.as_ref(), chosen);
        append_chosen(&mut self.colours, from.colours.as_ref(), chosen);
        append_chosen(&mut self.radii, from.radii.as_ref(), chosen);
        if from.opacities.is_some() || self.opacities.is_some() {
            let all = self.opacities.get_or_insert_default();
            all.resize(before, 1.0);
            all.extend(from.opacities.iter().flat_map(|own| chosen.iter().map(|&i| own[i as usize])));
            all.resize(self.positions.len(), 1.0);
        }
    }

    /// Adds points with what was measured, of a file with this number.
    pub(super) fn add_measured(&mut self, from: &Self) {
        self.files.extend(from.files.iter().map(|(path, _)| (path.clone(), self.positions.len())));
        self.add_all(from);
        self.values.extend_from_slice(&from.values);
    }

    /// Adds all points of another set that have been coloured.
    pub(super) fn add_all(&mut self, from: &Self) {
        let all: Vec<u32> = (0..from.positions.len() as u32).collect();
        self.add_chosen(from, &all);
    }

    /// Bytes that its points take.
    pub(super) fn bytes(&self) -> u64 {
        let rows = |has: bool, bytes: usize| if has { bytes } else { 0 };
        let each = size_of::<DVec3>()
            + rows(self.normals.is_some(), size_of::<Vec3>())
            + rows(self.face_normals.is_some(), size_of::<Vec3>())
            + rows(self.colours.is_some(), size_of::<[f32; 3]>())
            + rows(self.radii.is_some(), size_of::<f32>())
            + rows(self.opacities.is_some(), size_of::<f32>())
            + rows(!self.values.is_empty(), size_of::<f32>());
        (self.positions.len() * each) as u64
    }

    fn read(&mut self, path: &Path, options: &PointOptions) -> Result<(), InputError> {
        let first = self.positions.len();
        self.begin(path);
        let summary = read_points(path, options, None, &mut |block, values| {
            self.add(&block, values);
            let taken = block.positions.len() as u64 * POINT_BYTES;
            self.meter
                .add(taken, || "its points take".to_owned())
                .map_err(|error| error.in_file(input::name_of(path)))
        })?;
        let name = input::name_of(path);
        let mut warn = |warning: &str| self.warnings.push(format!("{name}: {warning}"));
        summary.warnings.iter().for_each(|warning| warn(warning));
        if summary.dropped > 0 {
            warn(&format!("{} points that are not finite were left out", summary.dropped));
        }
        if summary.faces > 0 {
            warn("its faces are not drawn; `pointillist sample` puts points all over them");
        }
        let own = self.opacities.as_ref().map(|all| &all[first..]);
        if own.is_some_and(|own| !own.is_empty() && own.iter().all(|&opacity| opacity == 0.0)) {
            warn(
                "all its points have opacity 0, so that nothing is seen of them; `--ignore-alpha` draws them opaque",
            );
        }
        if !summary.has_normals {
            warn(
                "has no normals: they are estimated; closed surfaces are seen from outside, others from both sides",
            );
        }
        Ok(())
    }

    /// Gives the points the colours that are asked for; returns what they mean.
    pub fn colour(&mut self, colouring: &Colouring) -> Option<Legend> {
        let names: Vec<String> = self.files.iter().map(|(path, _)| input::name_of(path)).collect();
        let firsts = self.files.iter().map(|(_, first)| *first);
        let ends = firsts.clone().skip(1).chain([self.positions.len()]);
        let parts: Vec<Part<'_>> = (firsts.zip(ends).zip(&names).enumerate())
            .map(|(number, ((first, end), name))| Part {
                positions: &self.positions[first..end],
                values: self.values.get(first..end).unwrap_or_default(),
                name,
                number: self.first_number + number,
            })
            .collect();
        let (colours, legend) = colouring.colours(&parts)?;
        self.colours = Some(colours.concat());
        self.values = vec![];
        Some(legend)
    }

    /// Makes the points ready to be drawn.
    ///
    /// # Errors
    ///
    /// [`InputError`] for an attribute that cannot be used.
    pub fn cloud(&self, estimate_normals: bool) -> Result<Cloud, InputError> {
        Cloud::new(&self.points(estimate_normals)).map_err(|error| self.blame(&error))
    }

    /// The points as `scan` draws them, `spacing` apart.
    pub fn as_scan(&self, spacing: Option<f64>) -> ibpr::Scan<'_> {
        let mut scan = ibpr::Scan::new(&self.positions);
        if let Some(colours) = &self.colours {
            scan = scan.with_colors(colours);
        }
        if let Some(opacities) = &self.opacities {
            scan = scan.with_opacities(opacities);
        }
        if let Some(spacing) = spacing {
            scan = scan.with_spacing(spacing);
        }
        scan
    }

    /// Whether any point is not opaque.
    pub fn has_translucent(&self) -> bool {
        self.opacities.iter().flatten().any(|&opacity| opacity < 1.0)
    }

    /// Makes parts of the points ready to be drawn together with those of other sets: see [`Cloud::parts`].
    pub(super) fn parts(
        &self,
        estimate_normals: bool,
        numbers: &[u8],
        division: &Division,
    ) -> Result<Vec<Option<Cloud>>, InputError> {
        Cloud::parts(&self.points(estimate_normals), numbers, division).map_err(|error| self.blame(&error))
    }

    fn points(&self, estimate_normals: bool) -> Points<'_> {
        let mut points = Points::new(&self.positions);
        if let Some(normals) = self.normals.as_deref().filter(|_| !estimate_normals) {
            points = match &self.face_normals {
                Some(of_surface) => points.with_normals(of_surface).with_shading_normals(normals),
                None => points.with_normals(normals),
            };
        }
        if let Some(colors) = &self.colours {
            points = points.with_colors(colors);
        }
        if let Some(radii) = &self.radii {
            points = points.with_radii(radii);
        }
        if let Some(opacities) = &self.opacities {
            points = points.with_opacities(opacities);
        }
        points
    }

    /// Names the file and the point within it.
    fn blame(&self, error: &SurfelError) -> InputError {
        let index = match error {
            SurfelError::PointNotFinite { index, .. }
            | SurfelError::PointTooFar { index, .. }
            | SurfelError::BadNormal { index }
            | SurfelError::BadColor { index }
            | SurfelError::BadRadius { index, .. }
            | SurfelError::BadOpacity { index, .. } => *index,
            _ => 0,
        };
        let file = self.files.iter().rev().find(|(_, first)| *first <= index);
        let (name, first) = file.map_or((String::new(), 0), |(path, first)| (input::name_of(path), *first));
        let number = index - first;
        let (message, help) = match error {
            SurfelError::BadNormal { .. } => (
                format!("the normal of point {number} (from 0) is zero"),
                "`--estimate-normals` fits planes in the place of the file's normals",
            ),
            SurfelError::BadRadius { radius, .. } => (
                format!("the radius of point {number} (from 0) is {radius}; it must be above 0"),
                "a file without the property `radius` has radii estimated",
            ),
            SurfelError::PointTooFar { .. } => (
                format!("point {number} (from 0) is too far away for numbers"),
                "coordinates up to 4e307 can be used",
            ),
            other => (other.to_string(), "see `pointillist info` for what the file holds"),
        };
        InputError::of_file(name, message).with_help(help)
    }

    /// Hash of all that is drawn.
    #[must_use]
    pub fn fingerprint(&self) -> u64 {
        let mut hash = ByteHash::default();
        for value in self.positions.iter().flat_map(|p| p.to_array()) {
            hash.write(&value.to_le_bytes());
        }
        let normals = self.normals.iter().flatten().flat_map(|n| n.to_array());
        let colours = self.colours.iter().flatten().copied().flatten();
        let [radii, opacities] = [&self.radii, &self.opacities].map(|all| all.iter().flatten().copied());
        for value in normals.chain(colours).chain(radii).chain(opacities) {
            hash.write(&value.to_le_bytes());
        }
        hash.finish()
    }
}
