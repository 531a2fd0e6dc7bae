//! Light from lights with an area, taken as a whole: what each visible piece of a surface sees of them is integrated.
//!
//! The constant part of a BRDF has a closed form, Lambert's formula; the rest is integrated by quadrature over what is seen of the light.

use crate::direct::DirectScratch;
use crate::lights::{WholeLight, share};
use crate::monitor::Monitor;
use crate::shader::{Point, Shader};
use glam::Vec3;
use pointillist_micropoint::{Face, Tile};
use pointillist_shade::{Falloff, Interpolation, Lobe, Model, integrate_polygon, interpolate_color, turn_to};
use pointillist_shadow::{SeenLight, Viewer};

/// Lobe of measured BRDFs, in radians: the width of a highlight that most of them have.
const MEASURED_LOBE: f32 = 0.1;

impl Shader<'_> {
    /// Adds one side of a light as a whole.
    pub(crate) fn add_whole_light(
        &self,
        tile: &Tile,
        light: &WholeLight<'_>,
        points: &mut [Point],
        direct: &mut DirectScratch,
        mut lit_layer: Option<&mut Vec<f64>>,
        monitor: &dyn Monitor,
    ) {
        let DirectScratch { area, seen, owners, receivers, .. } = direct;
        receivers.clear();
        owners.clear();
        for (i, p) in points.iter().enumerate() {
            let m = &tile.points()[i];
            if lit_layer.is_some() || !self.is_black(p, tile.faces()[m.face as usize].id) {
                receivers.push_point(tile, m);
                owners.resize(receivers.len(), i as u32);
            }
        }
        // Summed up by receiver first: they come in an order that depends on the tile.
        seen.clear();
        seen.resize(owners.len(), (Vec3::ZERO, 0.0));
        let viewer = Viewer { lens: tile.lens(), faces: tile.faces() };
        light.side.visit(viewer, receivers, area, |receiver, share, part| {
            let owner = owners[receiver] as usize;
            let face = &tile.faces()[tile.points()[owner].face as usize];
            let sum = &mut seen[receiver];
            sum.0 += self.reflect_whole(light, &points[owner], face, part) * share as f32;
            sum.1 += share * part.area();
        });
        // All of a micropoint is at its first piece.
        for (&owner, (radiance, lit)) in owners.iter().zip(&*seen) {
            points[owner as usize].direct += *radiance;
            if let Some(layer) = lit_layer.as_deref_mut() {
                layer[owner as usize] += lit / light.side.area() * share(light.channels);
            }
        }
        monitor.lap("shadow");
    }

    /// Radiance that a point sends to the eye because of what it sees of a light.
    fn reflect_whole(&self, light: &WholeLight<'_>, p: &Point, face: &Face, seen: &SeenLight) -> Vec3 {
        if self.scene.render.shading == Interpolation::Gouraud
            && let Some(normals) = self.corner_normals(face)
        {
            return self.reflect_at_corners(light, p, face, seen, normals);
        }
        self.reflect_seen(light, p, face.id, seen, p.normal, p.place.to_eye)
    }

    /// The interpolated light of the corners without shadow, times the share of the irradiance that arrives.
    fn reflect_at_corners(
        &self,
        light: &WholeLight<'_>,
        p: &Point,
        face: &Face,
        seen: &SeenLight,
        normals: [Vec3; 3],
    ) -> Vec3 {
        let above = p.place.face_normal.as_dvec3();
        let most = light.side.whole(seen.position(), above).share(above);
        if most <= 0.0 {
            return Vec3::ZERO;
        }
        let corners = self.scene.corners(face.id);
        let at = |k: usize| {
            let to_eye = (self.eye - corners[k]).normalize_or_zero().as_vec3();
            let whole = light.side.whole(corners[k], above);
            self.reflect_seen(light, p, face.id, &whole, turn_to(normals[k], p.place.face_normal), to_eye)
        };
        let share = (seen.share(above) / most).min(1.0) as f32;
        interpolate_color([at(0), at(1), at(2)], p.place.barycentric) * share
    }

    /// By the material's formula, or as measured.
    fn reflect_seen(
        &self,
        light: &WholeLight<'_>,
        p: &Point,
        triangle: u32,
        seen: &SeenLight,
        normal: Vec3,
        to_eye: Vec3,
    ) -> Vec3 {
        let emission = &light.emission;
        let measured = self.measured(triangle);
        let mut material = p.material;
        let mut sum = Vec3::ZERO;
        // The base below a GGX coat is no constant: it gets what the coat lets through.
        let constant = material.model != Model::Ggx || material.specular == Vec3::ZERO;
        if measured.is_none() && constant && emission.falloff == Falloff::InverseSquare {
            sum += material.diffuse * emission.radiance * seen.share(normal.as_dvec3()) as f32;
            material.diffuse = Vec3::ZERO;
            if material.model == Model::Lambert || material.specular == Vec3::ZERO {
                return sum;
            }
        }
        let lobe = match measured {
            Some(_) => Lobe { width_rad: MEASURED_LOBE, ..material.lobe(normal, to_eye) },
            None => material.lobe(normal, to_eye),
        };
        let surface = Point { material, ..*p };
        seen.for_each_part(|ring, transmittance| {
            let reflect = |incident: &_| self.reflect(&surface, triangle, incident, normal, to_eye);
            sum += integrate_polygon(ring, emission, &lobe, reflect) * transmittance as f32;
        });
        sum
    }
}
