//! A point cloud as it comes from a caller.

use crate::error::SurfelError;
use glam::{DVec3, Vec3};

/// Points of a surface, as slices of one length.
#[derive(Clone, Copy, Debug)]
pub struct Points<'a> {
    /// World.
    pub(crate) positions: &'a [DVec3],
    /// Outward; of any length above 0. Without them they are estimated: see [`crate::Cloud::has_estimated_normals`].
    pub(crate) normals: Option<&'a [Vec3]>,
    /// What light sees in the place of the normals; of any length above 0.
    pub(crate) shading_normals: Option<&'a [Vec3]>,
    /// Linear RGB, from 0 to [`Points::BRIGHTEST`].
    pub(crate) colors: Option<&'a [[f32; 3]]>,
    /// Discs of these radii leave no gap; world units, above 0. Without them they are estimated.
    pub(crate) radii: Option<&'a [f32]>,
    /// 0 to 1. Without them all points are opaque.
    pub(crate) opacities: Option<&'a [f32]>,
}

impl<'a> Points<'a> {
    /// Points without attributes.
    #[must_use]
    pub const fn new(positions: &'a [DVec3]) -> Self {
        Self { positions, normals: None, shading_normals: None, colors: None, radii: None, opacities: None }
    }

    /// Gives them normals.
    ///
    /// A disc lies across its normal, and covers as much of the picture as it faces the eye. Normals that are interpolated over a coarse mesh are
    /// not those of the surface on which the points lie: see [`Points::with_shading_normals`].
    #[must_use]
    pub const fn with_normals(mut self, normals: &'a [Vec3]) -> Self {
        self.normals = Some(normals);
        self
    }

    /// Gives them normals for light alone, beside those of the surface: interpolated ones, where the others are those of the triangles.
    ///
    /// With interpolated normals alone, discs next to the silhouette of a coarse mesh face away while the surface does not, and leave holes.
    #[must_use]
    pub const fn with_shading_normals(mut self, normals: &'a [Vec3]) -> Self {
        self.shading_normals = Some(normals);
        self
    }

    /// Gives them colors.
    #[must_use]
    pub const fn with_colors(mut self, colors: &'a [[f32; 3]]) -> Self {
        self.colors = Some(colors);
        self
    }

    /// Gives them radii.
    #[must_use]
    pub const fn with_radii(mut self, radii: &'a [f32]) -> Self {
        self.radii = Some(radii);
        self
    }

    /// Gives them opacities, 0 to 1: the share of light that a surface of such points keeps back.
    #[must_use]
    pub const fn with_opacities(mut self, opacities: &'a [f32]) -> Self {
        self.opacities = Some(opacities);
        self
    }

    /// Most points of a cloud: indices of points have 32 bits, some values of which have other meanings.
    pub const MOST: usize = 1 << 30;

    /// Largest absolute value of a coordinate, a quarter of `f64::MAX`: differences of coordinates, and twice those,
    /// are finite.
    pub const FARTHEST: f64 = 0.25 * f64::MAX;

    /// Largest channel of a color: weighted sums of it are finite in `f32`.
    pub const BRIGHTEST: f32 = 1e30;

    pub(crate) fn check(&self) -> Result<(), SurfelError> {
        let count = self.positions.len();
        if count == 0 {
            return Err(SurfelError::NoPoints);
        }
        if count > Self::MOST {
            return Err(SurfelError::TooManyPoints { count: count as f64, limit: Self::MOST });
        }
        let lengths = [
            ("normals", self.normals.map(<[_]>::len)),
            ("shading normals", self.shading_normals.map(<[_]>::len)),
            ("colors", self.colors.map(<[_]>::len)),
            ("radii", self.radii.map(<[_]>::len)),
            ("opacities", self.opacities.map(<[_]>::len)),
        ];
        for (what, length) in lengths {
            if let Some(length) = length.filter(|&l| l != count) {
                return Err(SurfelError::LengthMismatch { what, length, count });
            }
        }
        // Not `max_element`, which ignores NaN.
        let good = |p: &DVec3| p.abs().cmple(DVec3::splat(Self::FARTHEST)).all();
        if let Some(index) = self.positions.iter().position(|p| !good(p)) {
            let (finite, value) = (self.positions[index].is_finite(), self.positions[index].to_array());
            return Err(match finite {
                true => SurfelError::PointTooFar { index, value },
                false => SurfelError::PointNotFinite { index, value },
            });
        }
        if self.shading_normals.is_some() && self.normals.is_none() {
            return Err(SurfelError::OnlyShadingNormals);
        }
        self.check_attributes()
    }

    fn check_attributes(&self) -> Result<(), SurfelError> {
        let normal = |n: &Vec3| n.is_finite() && *n != Vec3::ZERO;
        for normals in [self.normals, self.shading_normals].into_iter().flatten() {
            if let Some(index) = normals.iter().position(|n| !normal(n)) {
                return Err(SurfelError::BadNormal { index });
            }
        }
        let channel = |c: &f32| (0.0..=Self::BRIGHTEST).contains(c);
        if let Some(index) = self.colors.and_then(|all| all.iter().position(|c| !c.iter().all(channel))) {
            return Err(SurfelError::BadColor { index });
        }
        let radius = |r: &f32| *r > 0.0 && r.is_finite();
        if let Some(index) = self.radii.and_then(|all| all.iter().position(|r| !radius(r))) {
            let radius = self.radii.map_or(0.0, |all| all[index]);
            return Err(SurfelError::BadRadius { index, radius });
        }
        let opacities = self.opacities.unwrap_or_default();
        if let Some(index) = opacities.iter().position(|o| !(0.0..=1.0).contains(o)) {
            return Err(SurfelError::BadOpacity { index, value: opacities[index] });
        }
        Ok(())
    }
}
