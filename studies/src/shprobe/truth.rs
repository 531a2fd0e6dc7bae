//! Irradiance by direct integration of what is seen, not by spherical harmonics.

use glam::{DVec3, Vec3, dvec3};
use pointillist_render::RenderError;
use pointillist_sh::{
    CubeMap, CubePoint, CubeProjector, Irradiance, Weights, cube_direction, texel_solid_angle,
};
use rayon::prelude::*;

use crate::shprobe::rays::Look;
use crate::shprobe::site::Ground;

/// To the middles of the faces, edges and corners of a cube.
pub(crate) fn normals() -> Vec<DVec3> {
    let at = |i: i32| dvec3(f64::from(i % 3 - 1), f64::from(i / 3 % 3 - 1), f64::from(i / 9 - 1));
    (0..27).map(at).filter_map(DVec3::try_normalize).collect()
}

/// Irradiance at positions, for each of [`normals`].
pub(crate) struct Truth {
    pub(crate) positions: Vec<DVec3>,
    pub(crate) normals: Vec<DVec3>,
    irradiance: Vec<Vec<DVec3>>,
    /// The same of order 2, at the same positions: the best that probes can do.
    best: Vec<Irradiance>,
}

/// Root mean square error of irradiance over that of irradiance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wrong {
    pub(crate) all: f64,
    /// In the dark room, over the irradiance there.
    pub(crate) dark: Option<f64>,
}

impl Truth {
    /// At random positions of a site.
    pub(crate) fn new(ground: &Ground<'_>) -> Result<Self, RenderError> {
        Self::at(ground, ground.random(ground.site.queries, 7))
    }

    pub(crate) fn at(ground: &Ground<'_>, positions: Vec<DVec3>) -> Result<Self, RenderError> {
        let normals = normals();
        let size = ground.site.truth_px as usize;
        let projector = CubeProjector::new(size, 2, Weights::Exact)?;
        let one = |&p: &DVec3| {
            let look = ground.capture(p, size as u32, true)?;
            let cube = CubeMap::from_planes(size, look.radiance.clone())?;
            Ok((integrated(&look, &normals), Irradiance::new(&projector.project(&cube)?)))
        };
        let found: Result<Vec<_>, RenderError> = positions.par_iter().map(one).collect();
        let (irradiance, best) = found?.into_iter().unzip();
        Ok(Self { positions, normals, irradiance, best })
    }

    /// Irradiance at places on surfaces, each with its normal.
    pub(crate) fn on_surfaces(
        ground: &Ground<'_>,
        places: &[(DVec3, DVec3)],
    ) -> Result<Vec<DVec3>, RenderError> {
        let size = ground.site.truth_px;
        let one =
            |&(p, normal): &(DVec3, DVec3)| Ok(integrated(&ground.capture(p, size, true)?, &[normal])[0]);
        places.par_iter().map(one).collect()
    }

    /// At each position, for each normal.
    pub(crate) fn irradiance(&self) -> &[Vec<DVec3>] {
        &self.irradiance
    }

    /// At each position, of order 2.
    pub(crate) fn best(&self) -> &[Irradiance] {
        &self.best
    }

    /// How far off `light` is: what a position is lit by.
    pub(crate) fn wrong(&self, dark_from: Option<f64>, light: impl Fn(DVec3) -> Irradiance) -> Wrong {
        self.compare(dark_from, |i| light(self.positions[i]))
    }

    /// What order 2 loses without any interpolation.
    pub(crate) fn wrong_of_order_2(&self, dark_from: Option<f64>) -> Wrong {
        self.compare(dark_from, |i| self.best[i])
    }

    fn compare(&self, dark_from: Option<f64>, light: impl Fn(usize) -> Irradiance) -> Wrong {
        let squares = |i: usize| {
            let light = light(i);
            let mut sums = [0.0; 2];
            for (n, truth) in self.normals.iter().zip(&self.irradiance[i]) {
                let found = light.at(n.as_vec3()).max(Vec3::ZERO).as_dvec3();
                sums = [sums[0] + (found - *truth).length_squared(), sums[1] + truth.length_squared()];
            }
            sums
        };
        let squares: Vec<[f64; 2]> = (0..self.positions.len()).map(squares).collect();
        let ratio = |is_meant: &dyn Fn(DVec3) -> bool| {
            let meant = squares.iter().zip(&self.positions).filter(|(_, p)| is_meant(**p));
            let [error, light] = meant.fold([0.0; 2], |a, (b, _)| [a[0] + b[0], a[1] + b[1]]);
            (error / light).sqrt()
        };
        Wrong { all: ratio(&|_| true), dark: dark_from.map(|x| ratio(&|p| p.x > x)) }
    }
}

/// ∫ L max(n·ω, 0) dω of a cube map by its texels' solid angles.
fn integrated(look: &Look, normals: &[DVec3]) -> Vec<DVec3> {
    let n = look.size;
    let middle = |i: usize| (2 * i + 1) as f64 / n as f64 - 1.0;
    let mut sums = vec![DVec3::ZERO; normals.len()];
    for (face, y, x) in (0..6).flat_map(|f| (0..n).flat_map(move |y| (0..n).map(move |x| (f, y, x)))) {
        let way = cube_direction(CubePoint { face, s: middle(x), t: middle(y) }).normalize();
        let texel = (face * n + y) * n + x;
        let [r, g, b] = [0, 1, 2].map(|c| f64::from(look.radiance[c][texel]));
        let light = dvec3(r, g, b) * texel_solid_angle(n, x, y);
        for (sum, normal) in sums.iter_mut().zip(normals) {
            *sum += light * normal.dot(way).max(0.0);
        }
    }
    sums
}
