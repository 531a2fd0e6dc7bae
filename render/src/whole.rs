//! Light from lights with an area or a length, taken as a whole: what each visible piece of a surface sees of them is integrated.
//!
//! The constant part of a BRDF has a closed form, of an area Lambert's formula; the rest is integrated by quadrature over what is seen of the light.

use crate::direct::DirectScratch;
use crate::lights::{Shape, WholeLight};
use crate::monitor::Monitor;
use crate::seen::Seen;
use crate::shader::{Point, Shader};
use glam::{DVec3, Vec3};
use pointillist_micropoint::{Face, Tile};
use pointillist_shade::{Falloff, Interpolation, Lobe, Model, interpolate_color, turn_to};
use pointillist_shadow::{Receivers, Viewer};
use std::ops::Range;

/// Lobe of measured BRDFs, in radians: the width of a highlight that most of them have.
const MEASURED_LOBE: f32 = 0.1;

impl WholeLight<'_> {
    /// Its area or length.
    fn extent(&self) -> f64 {
        match &self.shape {
            Shape::Side(side) => side.area(),
            Shape::Line(line) => line.length(),
        }
    }

    /// What a point of a surface would see with nothing in between.
    fn unhindered(&self, position: DVec3, normal: DVec3) -> Box<dyn Seen> {
        match &self.shape {
            Shape::Side(side) => Box::new(side.whole(position, normal)),
            Shape::Line(line) => Box::new(line.whole(position, normal)),
        }
    }

    /// Whether any receiver is where it may shine.
    fn may_reach(&self, receivers: &Receivers, viewer: Viewer<'_>) -> bool {
        let Some((low, high)) = receivers.bounds(viewer) else { return false };
        let origin = viewer.lens.origin;
        self.within.is_none_or(|(least, most)| {
            (low + origin).cmple(most).all() && (high + origin).cmpge(least).all()
        })
    }
}

impl Shader<'_> {
    /// Adds one side of a light as a whole, to the receivers of [`Shader::ask_for_whole`].
    pub(crate) fn add_whole_light(
        &self,
        tile: &Tile,
        light: &WholeLight<'_>,
        points: &mut [Point],
        direct: &mut DirectScratch,
        mut lit_layer: Option<&mut Vec<DVec3>>,
        monitor: &dyn Monitor,
    ) {
        let DirectScratch { area, line, seen, asked, owners, receivers, .. } = direct;
        let viewer = Viewer { lens: tile.lens(), faces: tile.faces() };
        if !light.may_reach(receivers, viewer) {
            return;
        }
        // Summed up by micropoint first: receivers come in an order that depends on the tile.
        seen.clear();
        seen.resize(points.len(), (Vec3::ZERO, 0.0));
        let mut add = |receiver: usize, share: f64, part: &dyn Seen| {
            let Range { start, end } = owners[receiver].clone();
            for &owner in &asked[start as usize..end as usize] {
                let face = &tile.faces()[tile.points()[owner as usize].face as usize];
                let sum = &mut seen[owner as usize];
                sum.0 += self.reflect_whole(light, &points[owner as usize], face, part) * share as f32;
                sum.1 += share * part.extent();
            }
        };
        match &light.shape {
            Shape::Side(side) => side.visit(viewer, receivers, area, |r, share, part| add(r, share, part)),
            Shape::Line(own) => own.visit(viewer, receivers, line, |r, share, part| add(r, share, part)),
        }
        for &owner in &*asked {
            let (radiance, lit) = seen[owner as usize];
            points[owner as usize].direct += radiance;
            if let Some(layer) = lit_layer.as_deref_mut() {
                layer[owner as usize] += light.channels.as_dvec3() * (lit / light.extent());
            }
        }
        monitor.lap("shadow");
    }

    /// Collects the receivers of whole lights. What a pixel sees of a masked face is one: its mask divides it into squares, and
    /// light of this kind does not vary from one to the next.
    pub(crate) fn ask_for_whole(
        &self,
        tile: &Tile,
        points: &[Point],
        with_black: bool,
        direct: &mut DirectScratch,
    ) {
        let DirectScratch { asked, owners, receivers, .. } = direct;
        receivers.clear();
        owners.clear();
        asked.clear();
        let face_of = |i: u32| tile.faces()[tile.points()[i as usize].face as usize].id;
        let wanted = |&i: &u32| with_black || !self.is_black(&points[i as usize], face_of(i));
        asked.extend((0..points.len() as u32).filter(wanted));
        let masked_face = |i: u32| {
            self.surfaces.is_masked(face_of(i)).then(|| {
                let m = &tile.points()[i as usize];
                (m.y, m.x, m.face)
            })
        };
        asked.sort_unstable_by_key(|&i| (masked_face(i), i));
        let mut start = 0;
        for same in asked.chunk_by(|&a, &b| masked_face(a).is_some() && masked_face(a) == masked_face(b)) {
            receivers.push_points(tile, same.iter().map(|&i| &tile.points()[i as usize]));
            let end = start + same.len() as u32;
            owners.resize(receivers.len(), start..end);
            start = end;
        }
    }

    /// Radiance that a point sends to the eye because of what it sees of a light.
    fn reflect_whole(&self, light: &WholeLight<'_>, p: &Point, face: &Face, seen: &dyn Seen) -> Vec3 {
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
        seen: &dyn Seen,
        normals: [Vec3; 3],
    ) -> Vec3 {
        let above = p.place.face_normal.as_dvec3();
        let most = light.unhindered(seen.position(), above).share(above);
        if most <= 0.0 {
            return Vec3::ZERO;
        }
        let corners = self.scene.corners(face.id);
        let at = |k: usize| {
            let to_eye = self.to_eye(corners[k]);
            let whole = light.unhindered(corners[k], above);
            self.reflect_seen(light, p, face.id, &*whole, turn_to(normals[k], p.place.face_normal), to_eye)
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
        seen: &dyn Seen,
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
            sum += material.lambert_albedo() * emission.radiance * seen.share(normal.as_dvec3()) as f32;
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
        let mut reflect = |incident: &_| self.reflect(&surface, triangle, incident, normal, to_eye);
        seen.integrate(emission, &lobe, &mut reflect, &mut sum);
        sum
    }
}
