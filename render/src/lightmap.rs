//! Baked light at points of a scene's triangles.

use glam::{DVec2, DVec3, Vec3};
use pointillist_radiosity::{Baked, BakedTriangle};

/// Light baked on vertices of a scene's surfaces, as slices.
#[derive(Clone, Copy, Debug)]
pub struct BakedLight<'a> {
    /// Vertices in world space.
    pub positions: &'a [[f64; 3]],
    /// Unit normal of each vertex's surface, on its front.
    pub normals: &'a [[f32; 3]],
    /// What arrives at each vertex from other surfaces: power per area; red, green, blue.
    pub irradiance: &'a [[f32; 3]],
    /// Corners of triangles between the vertices, those of one side of a surface after another.
    pub triangles: &'a [[u32; 3]],
}

/// One side of a flat surface that light was baked on.
#[derive(Clone, Copy, Debug)]
pub struct BakedSide<'a> {
    /// Triangles of the scene that it is.
    pub faces: &'a [u32],
    /// Whether it is their back.
    pub back: bool,
    /// How many of [`BakedLight::triangles`] are its own, after those of the sides before.
    pub count: usize,
}

/// What can be wrong with baked light.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum LightmapError {
    /// There are not as many entries as positions.
    #[error("`{list}` has {length} entries for {count} positions")]
    Length {
        /// The list, a field of [`BakedLight`].
        list: &'static str,
        /// Its entries.
        length: usize,
        /// Positions there are.
        count: usize,
    },
    /// An entry is infinite or NaN.
    #[error("`{list}[{index}]` is not finite")]
    NotFinite {
        /// The list, a field of [`BakedLight`].
        list: &'static str,
        /// Which entry.
        index: usize,
    },
    /// A triangle refers to a vertex that does not exist.
    #[error("`triangles[{triangle}]` names a vertex beyond the {count} there are")]
    Vertex {
        /// Which triangle.
        triangle: usize,
        /// Positions there are.
        count: usize,
    },
    /// The sides do not have all triangles.
    #[error("`surfaces` do not add up to the {count} triangles")]
    Count {
        /// Triangles there are.
        count: usize,
    },
    /// Light was baked on a surface that has no triangles.
    #[error("light was baked on surface {surface}, but there are faces of {count} surfaces")]
    Surface {
        /// Which surface.
        surface: u32,
        /// Surfaces whose faces are known.
        count: usize,
    },
    /// A side is that of a triangle that the scene does not have.
    #[error("`surfaces[{side}].faces` names a triangle that the scene does not have")]
    Face {
        /// Which side.
        side: usize,
    },
}

/// The sides of what `pointillist-radiosity` baked; `faces` are the scene's triangles of each surface
/// ([`crate::SceneSurfaces::faces`]).
///
/// # Panics
/// If `faces` does not have an entry for every surface that light was baked on; [`Lightmap::of_baked`] returns an error instead.
#[must_use]
pub fn baked_sides<'a>(baked: &Baked, faces: &'a [Vec<u32>]) -> Vec<BakedSide<'a>> {
    let same = |a: &BakedTriangle, b: &BakedTriangle| (a.surface, a.back) == (b.surface, b.back);
    let side = |list: &[BakedTriangle]| BakedSide {
        faces: &faces[list[0].surface as usize],
        back: list[0].back,
        count: list.len(),
    };
    baked.triangles.chunk_by(same).map(side).collect()
}

impl BakedLight<'_> {
    /// Whether lists fit one another and a scene of so many triangles, and all numbers are finite.
    ///
    /// # Errors
    /// [`LightmapError`] with the first entry that is wrong.
    pub fn check(&self, sides: &[BakedSide<'_>], triangles_of_scene: usize) -> Result<(), LightmapError> {
        let count = self.positions.len();
        for (list, length) in [("normals", self.normals.len()), ("irradiance", self.irradiance.len())] {
            if length != count {
                return Err(LightmapError::Length { list, length, count });
            }
        }
        let finite = |list, wrong: Option<usize>| match wrong {
            Some(index) => Err(LightmapError::NotFinite { list, index }),
            None => Ok(()),
        };
        finite("positions", self.positions.iter().position(|p| p.iter().any(|v| !v.is_finite())))?;
        finite("normals", self.normals.iter().position(|n| n.iter().any(|v| !v.is_finite())))?;
        finite("irradiance", self.irradiance.iter().position(|p| p.iter().any(|v| !v.is_finite())))?;
        let beyond = |t: &[u32; 3]| t.iter().any(|&v| v as usize >= count);
        if let Some(triangle) = self.triangles.iter().position(beyond) {
            return Err(LightmapError::Vertex { triangle, count });
        }
        let total = sides.iter().try_fold(0_usize, |sum, s| sum.checked_add(s.count));
        if total != Some(self.triangles.len()) {
            return Err(LightmapError::Count { count: self.triangles.len() });
        }
        let beyond = |s: &BakedSide<'_>| s.faces.iter().any(|&f| f as usize >= triangles_of_scene);
        match sides.iter().position(beyond) {
            Some(side) => Err(LightmapError::Face { side }),
            None => Ok(()),
        }
    }
}

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
    /// Baked light for a scene of so many triangles.
    ///
    /// # Errors
    /// As [`BakedLight::check`].
    pub fn new(
        light: &BakedLight<'_>,
        sides: &[BakedSide<'_>],
        triangles_of_scene: usize,
    ) -> Result<Self, LightmapError> {
        light.check(sides, triangles_of_scene)?;
        let mut map = Self { surfaces: vec![], of_face: vec![[None; 2]; triangles_of_scene] };
        // Pieces of one surface have the same faces, and are one map.
        let mut pieces: Vec<Vec<[u32; 3]>> = vec![];
        let mut first = 0;
        for side in sides {
            let list = &light.triangles[first..first + side.count];
            first += side.count;
            let slot = |face: &u32| (*face as usize, usize::from(side.back));
            let known = side.faces.first().map(slot).and_then(|(face, back)| map.of_face[face][back]);
            let number = known.unwrap_or(pieces.len() as u32);
            if number as usize == pieces.len() {
                pieces.push(vec![]);
            }
            pieces[number as usize].extend_from_slice(list);
            for (face, back) in side.faces.iter().map(slot) {
                map.of_face[face][back] = Some(number);
            }
        }
        map.surfaces = pieces.iter().map(|list| Map::new(light, list)).collect();
        Ok(map)
    }

    /// The light of surfaces that `pointillist-radiosity` baked; `faces` as for [`baked_sides`].
    ///
    /// # Errors
    /// [`LightmapError::Surface`] if `faces` lacks a surface, and as [`BakedLight::check`].
    pub fn of_baked(
        baked: &Baked,
        faces: &[Vec<u32>],
        triangles_of_scene: usize,
    ) -> Result<Self, LightmapError> {
        let count = faces.len();
        if let Some(t) = baked.triangles.iter().find(|t| t.surface as usize >= count) {
            return Err(LightmapError::Surface { surface: t.surface, count });
        }
        let single = |v: [f64; 3]| v.map(|x| x as f32);
        let vertices = &baked.vertices;
        let light = BakedLight {
            positions: &vertices.iter().map(|v| v.position.to_array()).collect::<Vec<_>>(),
            normals: &vertices.iter().map(|v| v.normal.as_vec3().to_array()).collect::<Vec<_>>(),
            irradiance: &vertices.iter().map(|v| single(v.irradiance)).collect::<Vec<_>>(),
            triangles: &baked.triangles.iter().map(|t| t.vertices).collect::<Vec<_>>(),
        };
        Self::new(&light, &baked_sides(baked, faces), triangles_of_scene)
    }

    /// Irradiance at a position on one side of a triangle; 0 where nothing was baked.
    #[must_use]
    pub fn irradiance(&self, triangle: u32, front: bool, position: DVec3) -> Vec3 {
        self.known(triangle, front, position).unwrap_or_default()
    }

    /// The same; `None` where nothing was baked.
    #[must_use]
    pub fn known(&self, triangle: u32, front: bool, position: DVec3) -> Option<Vec3> {
        let surface = self.of_face.get(triangle as usize)?[usize::from(!front)]?;
        Some(self.surfaces[surface as usize].at(position))
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
    fn new(baked: &BakedLight<'_>, triangles: &[[u32; 3]]) -> Self {
        let normal = triangles.first().map_or(Vec3::Z, |t| Vec3::from_array(baked.normals[t[0] as usize]));
        let axis = normal.abs().max_position();
        let place = |v: u32| flat(DVec3::from_array(baked.positions[v as usize]), axis);
        let light = |v: u32| Vec3::from_array(baked.irradiance[v as usize]);
        let corners: Vec<[DVec2; 3]> = triangles.iter().map(|t| t.map(place)).collect();
        let all = || corners.iter().flatten();
        let low = all().fold(DVec2::INFINITY, |m, &p| m.min(p));
        let high = all().fold(DVec2::NEG_INFINITY, |m, &p| m.max(p));
        let size = (high - low).max(DVec2::splat(f64::MIN_POSITIVE));
        let wanted = BINS_PER_TRIANGLE * triangles.len() as f64;
        let columns = (wanted * size.x / size.y).sqrt().clamp(1.0, 4096.0);
        // Not a number if the size overflows.
        let bins = [columns, (wanted / columns).clamp(1.0, 4096.0)].map(|n| (n as usize).max(1));
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
            // A triangle without area, or one that overflows, holds no position.
            if !weights.iter().all(|w| w.is_finite()) {
                continue;
            }
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
