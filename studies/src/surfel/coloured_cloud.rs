//! A surface as coloured points.

use glam::{DVec3, Vec3};
use pointillist_surfel::{Cloud, Points, SampleOptions, SurfacePoint, SurfelError, sample};

use crate::common::true_surface::Surface;
use crate::surfel::lens_camera::Matt;

/// Points with what a renderer needs of them, one entry each.
#[derive(Clone, Debug, Default)]
pub(crate) struct ColouredCloud {
    pub(crate) positions: Vec<DVec3>,
    /// Unit; the smooth normals of the surface, which light sees.
    pub(crate) normals: Vec<Vec3>,
    /// Unit; those of its triangles, on the side of the smooth ones.
    pub(crate) face_normals: Vec<Vec3>,
    /// Linear albedo.
    pub(crate) colours: Vec<[f32; 3]>,
    /// Of discs that leave no gap, world units.
    pub(crate) radii: Vec<f32>,
}

impl ColouredCloud {
    /// Samples a surface evenly.
    pub(crate) fn of(surface: &Surface, matt: &Matt, options: &SampleOptions) -> Result<Self, SurfelError> {
        let points = sample(surface.positions(), surface.triangles(), options)?;
        let normal = |p: &SurfacePoint| {
            let corners = surface.triangles()[p.triangle as usize].map(|v| surface.normals()[v as usize]);
            p.interpolate(corners).normalize_or(p.normal).as_vec3()
        };
        let normals: Vec<Vec3> = points.iter().map(normal).collect();
        let outwards = |(p, n): (&SurfacePoint, &Vec3)| {
            let own = p.normal.as_vec3();
            if own.dot(*n) < 0.0 { -own } else { own }
        };
        Ok(Self {
            positions: points.iter().map(|p| p.position).collect(),
            face_normals: points.iter().zip(&normals).map(outwards).collect(),
            normals,
            colours: points.iter().map(|p| matt.albedo(p.position).as_vec3().to_array()).collect(),
            radii: points.iter().map(|p| p.radius).collect(),
        })
    }

    pub(crate) fn points(&self) -> Points<'_> {
        Points::new(&self.positions)
            .with_normals(&self.face_normals)
            .with_shading_normals(&self.normals)
            .with_colors(&self.colours)
            .with_radii(&self.radii)
    }

    /// Made ready for drawing.
    pub(crate) fn ready(&self) -> Result<Cloud, SurfelError> {
        Cloud::new(&self.points())
    }

    /// With all radii so many times as large.
    pub(crate) fn with_radii_times(mut self, factor: f32) -> Self {
        self.radii.iter_mut().for_each(|r| *r *= factor);
        self
    }

    /// Scaled about the origin, then moved.
    pub(crate) fn mapped(&self, scale: f64, shift: DVec3) -> Self {
        let positions = self.positions.iter().map(|p| *p * scale + shift).collect();
        Self { positions, ..self.clone().with_radii_times(scale as f32) }
    }

    /// The points with these numbers.
    pub(crate) fn picked(&self, numbers: &[usize]) -> Self {
        fn pick<T: Copy>(all: &[T], numbers: &[usize]) -> Vec<T> {
            numbers.iter().map(|i| all[*i]).collect()
        }
        Self {
            positions: pick(&self.positions, numbers),
            normals: pick(&self.normals, numbers),
            face_normals: pick(&self.face_normals, numbers),
            colours: pick(&self.colours, numbers),
            radii: pick(&self.radii, numbers),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_have_the_surfaces_normals_and_colours() {
        let corners = vec![DVec3::ZERO, DVec3::X, DVec3::ONE - DVec3::Z, DVec3::Y];
        let square = Surface::new("a square", corners, vec![[0, 1, 2], [0, 2, 3]]);
        let matt = Matt { light: DVec3::Z, ambient: 0.1, period: 0.5 };
        let cloud = ColouredCloud::of(&square, &matt, &SampleOptions::DEFAULT.with_count(100)).unwrap();
        assert_eq!(cloud.positions.len(), 100);
        assert!(cloud.normals.iter().all(|n| *n == Vec3::Z) && cloud.radii.iter().all(|r| *r > 0.0));
        // No wave along z: half of the range.
        assert!(cloud.colours.iter().all(|c| (c[2] - 0.525).abs() < 1e-6));
        assert!(cloud.colours.iter().all(|c| c.iter().all(|v| (0.15..=0.9).contains(v))));
    }
}
