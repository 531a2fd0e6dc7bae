//! Everything about a micropoint that does not depend on lights: place, normals, material, ambient light.

use crate::detail::Mapped;
use crate::face_look::FaceLook;
use crate::shader::{Place, Point, ShadedSurface, Shader};
use glam::{DVec2, DVec3, Vec3};
use pointillist_delaunay::Hint;
use pointillist_micropoint::{Face, Fragment, LensKind, Micropoint, SurfacePoint, Tile};
use pointillist_shade::{Interpolation, Material, interpolate_color, interpolate_normal};

/// Barycentric coordinates of a place on a face on which nothing varies by corner.
const MIDDLE: Vec3 = Vec3::splat(1.0 / 3.0);

impl Shader<'_> {
    /// A micropoint before light is added. Where it is, is left out if nothing asks: `with_places` says that layers do.
    pub(crate) fn set_up(
        &self,
        tile: &Tile,
        m: &Micropoint,
        look: &FaceLook,
        with_places: bool,
        polygon: &mut Vec<SurfacePoint>,
        hint: &mut Hint,
    ) -> Point {
        if look.is_constant && !with_places {
            return Point::constant(look.material);
        }
        let face = &tile.faces()[m.face as usize];
        let place = self.place(tile, m.grid, face, look);
        if let Some(indirect) = look.even_indirect {
            let FaceLook { normal, material, .. } = *look;
            return Point { place, normal, material, direct: Vec3::ZERO, indirect };
        }
        let outlines =
            |each: &mut dyn FnMut(&[SurfacePoint], f32)| self.for_outlines(tile, m, face, polygon, each);
        let (surface, mapped) = self.surface(face, look, &place, outlines);
        let mut indirect = if look.has_details {
            self.surrounding_light(&self.described(face).details, &surface, &mapped, hint)
        } else if surface.material.ambient_albedo() == Vec3::ZERO {
            // What reflects nothing needs no light.
            Vec3::ZERO
        } else {
            self.ambient.at(&surface.spot(surface.normal), hint) * surface.material.ambient_albedo()
        };
        if surface.material.model.is_opengl() {
            indirect += self.lights.ambient_at(place.position) * surface.material.ambient_albedo();
        }
        Point { place, normal: surface.normal, material: surface.material, direct: Vec3::ZERO, indirect }
    }

    fn place(&self, tile: &Tile, grid: DVec2, face: &Face, look: &FaceLook) -> Place {
        let (relative, barycentric) = if look.varies_by_corner {
            let at = face.point(tile.lens(), grid);
            (tile.position(grid, at.nearness), at.barycentric.as_vec3())
        } else {
            (tile.position(grid, face.nearness_at(grid)), MIDDLE)
        };
        let to_eye = match tile.lens().kind {
            _ if !look.depends_on_view => DVec3::ZERO,
            LensKind::Perspective => -relative.normalize_or_zero(),
            LensKind::Orthographic => -self.forward,
        };
        let (position, face_normal) = (self.eye + relative, look.normal);
        Place { position, barycentric, to_eye: to_eye.as_vec3(), face_normal }
    }

    /// A place of a face with its maps averaged over `outlines`, each with its weight, and what its maps say of ambient light.
    pub(crate) fn surface(
        &self,
        face: &Face,
        look: &FaceLook,
        place: &Place,
        mut outlines: impl FnMut(&mut dyn FnMut(&[SurfacePoint], f32)),
    ) -> (ShadedSurface, Mapped) {
        let Place { position, barycentric, to_eye, face_normal } = *place;
        let mut material = look.material;
        if look.has_color {
            material = self.textured(face, material, &mut outlines);
        }
        if self.economy.is_none() {
            material = self.widened_by_curvature(face, material, &mut outlines);
        }
        if self.scene.mesh.has_colors() {
            material = material.colored(self.vertex_color(face.id, barycentric));
        }
        let normal = match look.varies_by_corner {
            true => self.shading_normal(face, barycentric, face_normal, to_eye),
            false => face_normal,
        };
        // Only probes ask which side is lit.
        let side = if self.ambient.field().is_some() { look.side(normal) } else { face_normal };
        let (triangle, front) = (face.id, face.front);
        let mut s = ShadedSurface { triangle, front, position, to_eye, face_normal, side, normal, material };
        let mapped = match look.has_details.then(|| self.surfaces.details(face.id)).flatten() {
            Some(maps) => self.apply_maps(&self.described(face).details, maps, &mut s, outlines),
            None => Mapped::NOTHING,
        };
        (s, mapped)
    }

    fn shading_normal(&self, face: &Face, barycentric: Vec3, face_normal: Vec3, to_eye: Vec3) -> Vec3 {
        match self.corner_normals(face) {
            Some(normals) if self.scene.render.shading == Interpolation::Phong => {
                interpolate_normal(normals, barycentric, face_normal, to_eye)
            }
            _ => face_normal,
        }
    }

    /// The material with its albedo averaged over the outlines.
    fn textured(
        &self,
        face: &Face,
        material: Material,
        outlines: &mut impl FnMut(&mut dyn FnMut(&[SurfacePoint], f32)),
    ) -> Material {
        let (mut sum, mut total) = (Vec3::ZERO, 0.0);
        outlines(&mut |polygon, weight| {
            sum += self.surfaces.color(face.id, polygon) * weight;
            total += weight;
        });
        if total <= 0.0 {
            return material;
        }
        material.colored(sum / total)
    }

    /// What is seen of a micropoint, piece by piece, with the weight of each.
    fn for_outlines(
        &self,
        tile: &Tile,
        m: &Micropoint,
        face: &Face,
        polygon: &mut Vec<SurfacePoint>,
        each: &mut dyn FnMut(&[SurfacePoint], f32),
    ) {
        let fragments = tile.fragments(m);
        let limit = self.economy.map_or(usize::MAX, |e| e.textures_per_micropoint);
        let lightest = heaviest_weights(fragments, limit);
        for fragment in fragments.iter().filter(|f| f.weight >= lightest).take(limit) {
            polygon.clear();
            polygon.extend(face.points(tile.lens(), tile.outline(fragment).iter().copied()));
            each(polygon, fragment.weight as f32);
        }
    }

    fn vertex_color(&self, triangle: u32, barycentric: Vec3) -> Vec3 {
        interpolate_color(self.scene.mesh.corner_colors(triangle), barycentric)
    }
}

/// The smallest weight among the `count` heaviest fragments; 0 if there are no more than that.
fn heaviest_weights(fragments: &[Fragment], count: usize) -> f64 {
    if fragments.len() <= count {
        return 0.0;
    }
    let mut weights: Vec<f64> = fragments.iter().map(|f| f.weight).collect();
    let (_, nth, _) = weights.select_nth_unstable_by(count - 1, |a, b| b.total_cmp(a));
    *nth
}
