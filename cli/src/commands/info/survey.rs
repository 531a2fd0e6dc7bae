//! What a cloud holds beside its bounds: spacing, density, intensities, classes, returns; in two readings of the file and in memory that
//! does not grow with it.

use crate::cloud_io::{CloudBlock, CloudOptions, CloudSummary, Scalar, read_cloud};
use crate::input_error::InputError;
use crate::points::class_name;
use glam::{DVec2, DVec3};
use serde_json::{Value, json};
use std::collections::{BTreeMap, HashMap};
use std::path::Path;

/// Points whose nearest neighbour is looked for.
const ASKED: usize = 512;

/// Side of the cells in which neighbours are looked for, in spacings that the points would have if they filled their box evenly.
const REACH: f64 = 4.0;

/// Points in a cell of the plan on average if they fill it.
const PLAN_POINTS: f64 = 16.0;

/// Most cells along a side of the plan.
const PLAN_CELLS: f64 = 2048.0;

/// A cloud, and what was found in it.
#[derive(Debug)]
pub(super) struct Survey {
    pub(super) summary: CloudSummary,
    /// Median distance of points to the nearest point elsewhere.
    spacing: Option<f64>,
    /// Points per square unit of the plan (x, y) where there are any.
    density: Option<f64>,
    measured: Measured,
}

/// What the first reading finds.
#[derive(Debug, Default)]
struct Measured {
    /// Points with each value; by their bits, as values need not be whole.
    counts: [BTreeMap<u32, u64>; 2],
    intensities: Option<[f32; 2]>,
    sample: Sample,
}

/// Some of the points, each as likely as any other, and the same ones every time.
#[derive(Debug, Default)]
struct Sample {
    seen: u64,
    points: Vec<DVec3>,
}

impl Sample {
    /// Algorithm R of Vitter (Random Sampling with a Reservoir, 1985).
    fn push(&mut self, point: DVec3) {
        self.seen += 1;
        if self.points.len() < ASKED {
            self.points.push(point);
            return;
        }
        let place = (u128::from(hash(self.seen)) * u128::from(self.seen)) >> 64;
        if let Some(kept) = self.points.get_mut(place as usize) {
            *kept = point;
        }
    }
}

/// Bits that look random, of a counter (Steele, Lea, Flood: SplitMix, 2014).
const fn hash(counter: u64) -> u64 {
    let z = counter.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

impl Measured {
    fn add(&mut self, block: &CloudBlock<'_>) {
        block.positions.iter().for_each(|point| self.sample.push(*point));
        for value in block.scalar(Scalar::Intensity).into_iter().flatten().filter(|value| !value.is_nan()) {
            let [low, high] = self.intensities.unwrap_or([*value; 2]);
            self.intensities = Some([low.min(*value), high.max(*value)]);
        }
        for (counts, scalar) in self.counts.iter_mut().zip([Scalar::Class, Scalar::Return]) {
            for value in block.scalar(scalar).into_iter().flatten() {
                *counts.entry(value.to_bits()).or_default() += 1;
            }
        }
    }

    /// Values and the points that have them, in order; `null` where points have none.
    fn counted(&self, index: usize, entry: impl Fn(f32, u64) -> Value) -> Value {
        let mut found: Vec<(f32, u64)> =
            self.counts[index].iter().map(|(bits, count)| (f32::from_bits(*bits), *count)).collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        if found.is_empty() {
            return Value::Null;
        }
        found.into_iter().map(|(value, count)| entry(value, count)).collect()
    }
}

impl Survey {
    /// Of a file. Broken points are counted and not an error: `info` is for looking at files.
    pub(super) fn of(path: &Path) -> Result<Self, InputError> {
        let options = CloudOptions::default().with_drop_invalid(true).with_scalars(true);
        let mut measured = Measured::default();
        let summary = read_cloud::<InputError>(path, &options, &mut |block| {
            measured.add(&block);
            Ok(())
        })?;
        let sample = std::mem::take(&mut measured.sample.points);
        // Nobody asks how far apart the corners of a mesh are.
        let (spacing, density) =
            if summary.faces == 0 { spread(path, &summary, sample)? } else { (None, None) };
        Ok(Self { summary, spacing, density, measured })
    }

    pub(super) fn to_json(&self) -> Value {
        let mut value = super::cloud::of_summary(&self.summary);
        let Self { measured, .. } = self;
        value["spacing"] = json!(self.spacing);
        value["density"] = json!(self.density);
        value["intensities"] = json!(measured.intensities);
        value["classes"] = measured.counted(
            0,
            |class, points| json!({ "class": number(class), "name": class_name(class), "points": points }),
        );
        value["returns"] =
            measured.counted(1, |value, points| json!({ "return": number(value), "points": points }));
        value["units"] = json!({
            "bounds": "as the file; clouds do not say their unit",
            "spacing": "median distance of a point to the nearest point elsewhere",
            "density": "points per square unit of the plan (x, y), where there are any",
        });
        value
    }
}

/// Whole where it is.
fn number(value: f32) -> Value {
    if value.fract() == 0.0 { json!(value as i64) } else { json!(value) }
}

/// Spacing and density of a cloud, of which `sample` is a part.
fn spread(
    path: &Path,
    summary: &CloudSummary,
    sample: Vec<DVec3>,
) -> Result<(Option<f64>, Option<f64>), InputError> {
    let [low, high] = summary.bounds;
    let count = summary.points as f64;
    let mut neighbours = Neighbours::new(sample, high - low, count);
    let mut plan = Plan::new(low.truncate(), (high - low).truncate(), count);
    let options = CloudOptions::default().with_drop_invalid(true);
    read_cloud::<InputError>(path, &options, &mut |block| {
        for point in block.positions {
            neighbours.meet(*point);
            plan.mark(point.truncate());
        }
        Ok(())
    })?;
    Ok((neighbours.median(), plan.density(count)))
}

/// Finds the nearest neighbours of a few points as all points pass by.
struct Neighbours {
    asked: Vec<DVec3>,
    /// Squares of the distances found so far.
    nearest: Vec<f64>,
    cell: f64,
    /// Those of `asked` that may have a neighbour in a cell.
    around: HashMap<[i64; 3], Vec<u32>>,
}

impl Neighbours {
    fn new(asked: Vec<DVec3>, size: DVec3, count: f64) -> Self {
        let largest_face = (size.x * size.y).max(size.y * size.z).max(size.z * size.x);
        // Points on a line have no face.
        let spacing = (largest_face / count).sqrt().max(size.max_element() / count);
        let mut neighbours = Self {
            nearest: vec![f64::INFINITY; asked.len()],
            asked,
            cell: REACH * spacing,
            around: HashMap::new(),
        };
        for (index, point) in neighbours.asked.iter().enumerate() {
            let [x, y, z] = neighbours.cell_of(*point);
            for (dx, dy, dz) in
                (-1..=1).flat_map(|x| (-1..=1).flat_map(move |y| (-1..=1).map(move |z| (x, y, z))))
            {
                let cell = [x.saturating_add(dx), y.saturating_add(dy), z.saturating_add(dz)];
                neighbours.around.entry(cell).or_default().push(index as u32);
            }
        }
        neighbours
    }

    fn cell_of(&self, point: DVec3) -> [i64; 3] {
        (point / self.cell).to_array().map(|coordinate| coordinate.floor() as i64)
    }

    fn meet(&mut self, point: DVec3) {
        let Some(candidates) = self.around.get(&self.cell_of(point)) else { return };
        for &index in candidates {
            let distance = self.asked[index as usize].distance_squared(point);
            let nearest = &mut self.nearest[index as usize];
            // Points at the same place, itself among them, say nothing of how far apart points are.
            if distance > 0.0 && distance < *nearest {
                *nearest = distance;
            }
        }
    }

    /// Nothing if fewer than half have a neighbour within reach, so that the median is not known.
    fn median(mut self) -> Option<f64> {
        let middle = self.nearest.len() / 2;
        let (_, median, _) = self.nearest.select_nth_unstable_by(middle, f64::total_cmp);
        Some(median.sqrt()).filter(|distance| distance.is_finite())
    }
}

/// Which cells of the plan hold points.
struct Plan {
    low: DVec2,
    cell: DVec2,
    columns: usize,
    rows: usize,
    held: Vec<bool>,
}

impl Plan {
    fn new(low: DVec2, size: DVec2, count: f64) -> Self {
        let cell = (PLAN_POINTS * size.x * size.y / count).sqrt().max(size.max_element() / PLAN_CELLS);
        let cells = |length: f64| if length > 0.0 { ((length / cell) as usize).max(1) } else { 0 };
        let [columns, rows] = size.to_array().map(cells);
        // Cells end where the plan ends.
        let cell = size / DVec2::new(columns as f64, rows as f64);
        Self { low, cell, columns, rows, held: vec![false; columns * rows] }
    }

    fn mark(&mut self, point: DVec2) {
        if self.held.is_empty() {
            return;
        }
        let at = (point - self.low) / self.cell;
        let (column, row) = ((at.x as usize).min(self.columns - 1), (at.y as usize).min(self.rows - 1));
        self.held[row * self.columns + column] = true;
    }

    /// Nothing where the plan has no area.
    fn density(&self, count: f64) -> Option<f64> {
        let cells = self.held.iter().filter(|held| **held).count() as f64;
        let area = cells * self.cell.x * self.cell.y;
        Some(count / area).filter(|density| area > 0.0 && density.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn survey(points: &[DVec3]) -> (Option<f64>, Option<f64>) {
        let mut sample = Sample::default();
        points.iter().for_each(|point| sample.push(*point));
        let low = points.iter().copied().reduce(DVec3::min).unwrap();
        let size = points.iter().copied().reduce(DVec3::max).unwrap() - low;
        let count = points.len() as f64;
        let mut neighbours = Neighbours::new(sample.points, size, count);
        let mut plan = Plan::new(low.truncate(), size.truncate(), count);
        for point in points {
            neighbours.meet(*point);
            plan.mark(point.truncate());
        }
        (neighbours.median(), plan.density(count))
    }

    #[test]
    fn a_field_has_its_spacing_and_density() {
        let field: Vec<DVec3> = (0..250_000)
            .map(|i| DVec3::new(5e5 + 0.5 * f64::from(i % 500), 5e6 + 0.5 * f64::from(i / 500), 300.0))
            .collect();
        let (spacing, density) = survey(&field);
        assert!((spacing.unwrap() - 0.5).abs() < 1e-6, "{spacing:?}");
        assert!((density.unwrap() - 4.0).abs() < 0.1, "{density:?}");
        // Half of the plan is empty: density is where points are.
        let halves: Vec<DVec3> = field
            .iter()
            .map(|p| if p.x > 5e5 + 125.0 { *p + DVec3::new(1000.0, 0.0, 0.0) } else { *p })
            .collect();
        let (spacing, density) = survey(&halves);
        assert!(
            (spacing.unwrap() - 0.5).abs() < 1e-6 && (density.unwrap() - 4.0).abs() < 0.3,
            "{spacing:?} {density:?}"
        );
    }

    #[test]
    fn lines_walls_and_single_places_are_fine() {
        let line: Vec<DVec3> = (0..1000).map(|i| DVec3::new(0.0, 0.0, 0.25 * f64::from(i))).collect();
        assert_eq!(survey(&line), (Some(0.25), None));
        let twice: Vec<DVec3> = line.iter().chain(&line).copied().collect();
        assert_eq!(survey(&twice), (Some(0.25), None));
        assert_eq!(survey(&[DVec3::ONE; 10]), (None, None));
        let huge: Vec<DVec3> = (0..100).map(|i| DVec3::splat(1e18 * f64::from(i % 2))).collect();
        // Two places, out of reach of one another.
        assert_eq!(survey(&huge).0, None);
    }
}
