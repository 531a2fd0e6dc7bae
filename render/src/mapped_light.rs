//! What light maps hold of surfaces as wholes: radiosity takes it for light that is known.
//!
//! A light map is an atlas: its mean over one surface says nothing of another, and of what lies between them nothing at all.

use crate::scene::{Map, Scene, SceneError};
use crate::texel_sums::color_sums;
use crate::uvs::texel_wrap;
use glam::{DVec2, DVec3, Vec3};
use pointillist_micropoint::{TexelCorner, TexelSums};

/// A triangle's corners in the plane: means over it do not depend on which.
const CORNERS: [DVec2; 3] = [DVec2::ZERO, DVec2::X, DVec2::Y];

/// The light map of a material, summed up.
pub(crate) struct MappedLight {
    map: Map,
    sums: TexelSums<3>,
}

impl MappedLight {
    /// Those of all materials.
    ///
    /// # Errors
    /// [`SceneError::LightMap`] if texels are negative or not finite, or too many.
    pub(crate) fn of_materials(scene: &Scene) -> Result<Vec<Option<Self>>, SceneError> {
        let one = |material: &crate::scene::Material| {
            let Some(map) = material.details.light_map else { return Ok(None) };
            let sums = color_sums(&scene.textures[map.texture], texel_wrap(map.wrap)).map_err(|problem| {
                SceneError::LightMap { material: material.name.clone(), problem: problem.to_string() }
            })?;
            Ok(Some(Self { map, sums }))
        };
        scene.materials.iter().map(one).collect()
    }

    /// The mean over some triangles, by area; without texture coordinates that of the corner (0, 0), as pictures have it.
    pub(crate) fn mean(&self, scene: &Scene, triangles: &[u32]) -> Vec3 {
        let (mut sum, mut areas) = (DVec3::ZERO, 0.0);
        for &t in triangles {
            let [a, b, c] = scene.corners(t);
            // A triangle without area counts a little, so that the mean of no area at all is a mean, too.
            let area = (b - a).cross(c - a).length().max(f64::MIN_POSITIVE);
            sum += self.mean_of_triangle(scene, t) * area;
            areas += area;
        }
        (sum / areas).as_vec3()
    }

    fn mean_of_triangle(&self, scene: &Scene, triangle: u32) -> DVec3 {
        let uv = scene.mesh.map_corners(triangle, &self.map.place);
        let uv = uv.unwrap_or_else(|| self.map.place.of([DVec2::ZERO; 3]));
        let size = DVec2::new(f64::from(self.sums.width()), f64::from(self.sums.height()));
        let corner = |k: usize| TexelCorner {
            grid: CORNERS[k],
            rational: 1.0,
            texel: DVec2::new(uv[k].x, 1.0 - uv[k].y) * size,
        };
        DVec3::from_array(self.sums.mean(&[corner(0), corner(1), corner(2)]))
    }
}
