//! Cube maps whose faces join without seams.

use crate::ShadeError;
use glam::{DVec3, Vec3, dvec3};

/// The direction of a place on a face, not normalised: faces +X −X +Y −Y +Z −Z, s to the right and t down, both in
/// [−1, 1], oriented as OpenGL has them.
///
/// # Panics
///
/// For a face beyond 5.
#[must_use]
pub fn cube_direction(face: usize, s: f64, t: f64) -> DVec3 {
    match face {
        0 => dvec3(1.0, -t, -s),
        1 => dvec3(-1.0, -t, s),
        2 => dvec3(s, 1.0, t),
        3 => dvec3(s, -1.0, -t),
        4 => dvec3(s, -t, 1.0),
        5 => dvec3(-s, -t, -1.0),
        _ => panic!("a cube has faces 0 to 5, not {face}"),
    }
}

/// Face, s and t of a direction of any length, the inverse of [`cube_direction`]; the middle of +X for what is no direction.
#[must_use]
pub fn cube_place(d: DVec3) -> (usize, f64, f64) {
    let a = d.abs();
    let (face, s, t, major) = if a.x >= a.y && a.x >= a.z {
        if d.x >= 0.0 { (0, -d.z, -d.y, a.x) } else { (1, d.z, -d.y, a.x) }
    } else if a.y >= a.z {
        if d.y >= 0.0 { (2, d.x, d.z, a.y) } else { (3, d.x, -d.z, a.y) }
    } else if d.z >= 0.0 {
        (4, d.x, -d.y, a.z)
    } else {
        (5, -d.x, -d.y, a.z)
    };
    if major > 0.0 && d.is_finite() { (face, s / major, t / major) } else { (0, 0.0, 0.0) }
}

/// Radiance from all directions on the six faces of a cube.
///
/// Each face has a border of one texel taken from its neighbours (at corners, the mean of the three texels that meet),
/// so that a lookup interpolates within one face and still comes to the same at an edge from both sides.
#[derive(Clone, Debug, PartialEq)]
pub struct CubeMap {
    size: usize,
    /// Faces of (size + 2)² texels.
    texels: Vec<Vec3>,
}

impl CubeMap {
    /// A map of six faces of `size`² texels, one after the other, row by row (see [`cube_direction`]).
    ///
    /// # Errors
    ///
    /// No texels, or another number of them.
    pub fn new(size: u32, texels: &[Vec3]) -> Result<Self, ShadeError> {
        // Six faces of 2³² texels a side overflow 64 bits.
        if size == 0 || texels.len() as u128 != 6 * u128::from(size) * u128::from(size) {
            return Err(ShadeError::TextureSize {
                len: texels.len(),
                width: size,
                height: size.saturating_mul(6),
            });
        }
        let size = size as usize;
        Ok(Self::build(size, |face, x, y| texels[(face * size + y) * size + x]))
    }

    /// A map of what a function says about the middle of each texel, as a unit vector. A `size` of 0 counts as 1.
    #[must_use]
    pub fn from_function(size: u32, radiance: impl Fn(DVec3) -> Vec3) -> Self {
        let size = size.max(1) as usize;
        Self::build(size, |face, x, y| radiance(texel_direction(size, face, x, y).normalize()))
    }

    fn build(size: usize, texel: impl Fn(usize, usize, usize) -> Vec3) -> Self {
        let stride = size + 2;
        let mut map = Self { size, texels: vec![Vec3::ZERO; 6 * stride * stride] };
        for (face, y, x) in
            (0..6).flat_map(|f| (0..size).flat_map(move |y| (0..size).map(move |x| (f, y, x))))
        {
            let index = map.index(face, x + 1, y + 1);
            map.texels[index] = texel(face, x, y);
        }
        map.fill_borders();
        map
    }

    fn fill_borders(&mut self) {
        let n = self.size;
        for face in 0..6 {
            for i in 0..n {
                let along = (2 * i + 1) as f64 / n as f64 - 1.0;
                let sides = [(0, i + 1, -1.0, along), (n + 1, i + 1, 1.0, along)];
                let ends = [(i + 1, 0, along, -1.0), (i + 1, n + 1, along, 1.0)];
                for (x, y, s, t) in sides.into_iter().chain(ends) {
                    let index = self.index(face, x, y);
                    self.texels[index] = self.beyond(face, s, t);
                }
            }
            for (x, y) in [(0, 0), (n + 1, 0), (0, n + 1), (n + 1, n + 1)] {
                let own = self.index(face, x.clamp(1, n), y.clamp(1, n));
                let beside = self.index(face, x, y.clamp(1, n));
                let above = self.index(face, x.clamp(1, n), y);
                let index = self.index(face, x, y);
                self.texels[index] = (self.texels[own] + self.texels[beside] + self.texels[above]) / 3.0;
            }
        }
    }

    /// The neighbour's texel on the other side of an edge.
    fn beyond(&self, face: usize, s: f64, t: f64) -> Vec3 {
        // A hair across the edge: there it is the neighbour's outermost texel, in the same place along the edge.
        let hair = 1.0 + 1e-3 / self.size as f64;
        let out = |c: f64| if c.abs() == 1.0 { c * hair } else { c };
        let (other, s, t) = cube_place(cube_direction(face, out(s), out(t)));
        let texel = |c: f64| (((c + 1.0) * 0.5 * self.size as f64) as usize).min(self.size - 1) + 1;
        self.texels[self.index(other, texel(s), texel(t))]
    }

    /// Position in the list; x and y count from the border.
    fn index(&self, face: usize, x: usize, y: usize) -> usize {
        let stride = self.size + 2;
        (face * stride + y) * stride + x
    }

    /// Texels on a side of a face.
    #[must_use]
    pub fn size(&self) -> u32 {
        self.size as u32
    }

    /// A texel of a face.
    ///
    /// # Panics
    ///
    /// Outside the face.
    #[must_use]
    pub fn texel(&self, face: usize, x: u32, y: u32) -> Vec3 {
        let (x, y) = (x as usize, y as usize);
        assert!(face < 6 && x < self.size && y < self.size, "texel {x}, {y} of face {face} is not there");
        self.texels[self.index(face, x + 1, y + 1)]
    }

    /// Radiance from a direction of any length, interpolated between four texels; continuous everywhere.
    #[must_use]
    pub fn sample(&self, direction: DVec3) -> Vec3 {
        let (face, s, t) = cube_place(direction);
        let n = self.size as f64;
        // In texels from the middle of the border's.
        let at = |c: f64| ((c + 1.0) * 0.5 * n + 0.5).clamp(0.0, n + 0.999_999);
        let (x, y) = (at(s), at(t));
        let (fx, fy) = (x.fract() as f32, y.fract() as f32);
        let first = self.index(face, x as usize, y as usize);
        let stride = self.size + 2;
        let row = |i: usize| self.texels[i].lerp(self.texels[i + 1], fx);
        row(first).lerp(row(first + stride), fy)
    }

    /// The same with half as many texels on a side, each the mean of four; itself if the size is odd.
    #[must_use]
    pub fn halved(&self) -> Self {
        if !self.size.is_multiple_of(2) {
            return self.clone();
        }
        Self::build(self.size / 2, |face, x, y| {
            let texel = |dx: usize, dy: usize| self.texels[self.index(face, 2 * x + dx + 1, 2 * y + dy + 1)];
            (texel(0, 0) + texel(1, 0) + texel(0, 1) + texel(1, 1)) * 0.25
        })
    }
}

/// The middle of a texel, not normalised.
pub(super) fn texel_direction(size: usize, face: usize, x: usize, y: usize) -> DVec3 {
    let c = |i: usize| (2 * i + 1) as f64 / size as f64 - 1.0;
    cube_direction(face, c(x), c(y))
}
