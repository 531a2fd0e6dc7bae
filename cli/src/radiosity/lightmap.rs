//! Baked light at points of a scene's triangles.

use super::file::BakedFile;
use crate::input_error::InputError;
use glam::{DVec2, DVec3, Vec3};

/// Bins of a surface for each of its triangles, about.
const BINS_PER_TRIANGLE: f64 = 2.0;

/// Irradiance between baked vertices.
#[derive(Clone, Debug, Default)]
pub struct Lightmap {
    surfaces: Vec<Map>,
    /// Front and back of each of the scene's triangles: index into `surfaces`.
    of_face: Vec<[Option<u32>; 2]>,
}

/// The triangles of one side of a surface, seen along the axis nearest to its normal.
#[derive(Clone, Debug)]
struct Map {
    /// The axis that is left out.
    axis: usize,
    corners: Vec<[DVec2; 3]>,
    light: Vec<[Vec3; 3]>,
    low: DVec2,
    bin: DVec2,
    bins: [usize; 2],
    /// Triangles of each bin.
    lists: Vec<Vec<u32>>,
}

impl Lightmap {
    /// The light of a file, for a scene of `triangles` triangles.
    ///
    /// # Errors
    /// As [`BakedFile::check`].
    pub fn new(file: &BakedFile, name: &str, triangles: usize) -> Result<Self, InputError> {
        file.check(name, triangles)?;
        let mut map = Self { surfaces: vec![], of_face: vec![[None; 2]; triangles] };
        let mut first = 0;
        for entry in &file.surfaces {
            let list = &file.triangles[first..first + entry.count];
            first += entry.count;
            for &face in &entry.faces {
                map.of_face[face as usize][usize::from(entry.back)] = Some(map.surfaces.len() as u32);
            }
            map.surfaces.push(Map::new(file, list));
        }
        Ok(map)
    }

    /// Irradiance at a position on one side of a triangle; 0 where nothing was baked.
    pub fn irradiance(&self, triangle: u32, front: bool, position: DVec3) -> Vec3 {
        let sides = self.of_face.get(triangle as usize).copied().unwrap_or_default();
        match sides[usize::from(!front)] {
            Some(surface) => self.surfaces[surface as usize].at(position),
            None => Vec3::ZERO,
        }
    }
}

/// Without one coordinate.
fn flat(p: DVec3, axis: usize) -> DVec2 {
    match axis {
        0 => DVec2::new(p.y, p.z),
        1 => DVec2::new(p.z, p.x),
        _ => DVec2::new(p.x, p.y),
    }
}

impl Map {
    fn new(file: &BakedFile, triangles: &[[u32; 3]]) -> Self {
        let normal = triangles.first().map_or(Vec3::Z, |t| Vec3::from_array(file.normals[t[0] as usize]));
        let axis = normal.abs().max_position();
        let place = |v: u32| flat(DVec3::from_array(file.positions[v as usize]), axis);
        let light = |v: u32| Vec3::from_array(file.irradiance[v as usize]);
        let corners: Vec<[DVec2; 3]> = triangles.iter().map(|t| t.map(place)).collect();
        let all = || corners.iter().flatten();
        let low = all().fold(DVec2::INFINITY, |m, &p| m.min(p));
        let high = all().fold(DVec2::NEG_INFINITY, |m, &p| m.max(p));
        let size = (high - low).max(DVec2::splat(f64::MIN_POSITIVE));
        let wanted = BINS_PER_TRIANGLE * triangles.len() as f64;
        let columns = (wanted * size.x / size.y).sqrt().clamp(1.0, 4096.0);
        let bins = [columns as usize, (wanted / columns).clamp(1.0, 4096.0) as usize];
        let bin = size / DVec2::new(bins[0] as f64, bins[1] as f64);
        let mut map = Self {
            axis,
            light: triangles.iter().map(|t| t.map(light)).collect(),
            corners,
            low,
            bin,
            bins,
            lists: vec![vec![]; bins[0] * bins[1]],
        };
        map.fill();
        map
    }

    fn bin_of(&self, p: DVec2) -> [usize; 2] {
        let at = (p - self.low) / self.bin;
        // Conversion clamps at 0.
        [(at.x as usize).min(self.bins[0] - 1), (at.y as usize).min(self.bins[1] - 1)]
    }

    fn fill(&mut self) {
        for (i, ring) in self.corners.iter().enumerate() {
            let low = ring.iter().fold(DVec2::INFINITY, |m, &p| m.min(p));
            let high = ring.iter().fold(DVec2::NEG_INFINITY, |m, &p| m.max(p));
            let ([x0, y0], [x1, y1]) = (self.bin_of(low), self.bin_of(high));
            for y in y0..=y1 {
                for x in x0..=x1 {
                    self.lists[y * self.bins[0] + x].push(i as u32);
                }
            }
        }
    }

    /// Linear within the triangle that holds the position; rounding may put it just beside all of them, and then the
    /// nearest counts.
    fn at(&self, position: DVec3) -> Vec3 {
        let p = flat(position, self.axis);
        let [x, y] = self.bin_of(p);
        let list = &self.lists[y * self.bins[0] + x];
        let mut best = (f64::NEG_INFINITY, Vec3::ZERO);
        for &i in list {
            let [a, b, c] = self.corners[i as usize];
            let area = (b - a).perp_dot(c - a);
            let weights = [(c - b).perp_dot(p - b), (a - c).perp_dot(p - c), (b - a).perp_dot(p - a)];
            let weights = weights.map(|w| w / area);
            let least = weights.into_iter().fold(f64::INFINITY, f64::min);
            if least > best.0 {
                let clamped = weights.map(|w| w.clamp(0.0, 1.0));
                let sum: f64 = clamped.iter().sum();
                let light = self.light[i as usize];
                let mixed = (0..3).map(|k| light[k] * (clamped[k] / sum) as f32).sum();
                best = (least, mixed);
            }
            if least >= 0.0 {
                break;
            }
        }
        best.1
    }
}
