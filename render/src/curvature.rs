//! Highlights on surfaces that bend within a pixel.

use crate::shader::Shader;
use glam::{DVec2, Vec3};
use pointillist_micropoint::{Face, SurfacePoint};
use pointillist_shade::{Interpolation, Material, interpolate_color};

/// Squared difference of corner normals that counts as none: an eighth of the narrowest highlight's α².
const LEAST_BEND: f32 = 1e-7;

impl Shader<'_> {
    /// The material as what is seen of a face shows it on average: its normals vary over the outlines, and widen the highlight by their variance
    /// as bumps do ([`Material::widened`]). Only normals between those of the corners are meant; faces of their own are micropoints of their own.
    pub(crate) fn widened_by_curvature(
        &self,
        face: &Face,
        material: Material,
        outlines: &mut impl FnMut(&mut dyn FnMut(&[SurfacePoint], f32)),
    ) -> Material {
        if self.scene.render.shading != Interpolation::Phong || !material.depends_on_view() {
            return material;
        }
        let Some(normals) = self.corner_normals(face).filter(bends) else { return material };
        let mut spread = Spread::about(interpolate_color(normals, Vec3::ONE).normalize_or_zero());
        outlines(&mut |polygon, weight| spread.add(polygon, weight, normals));
        material.widened(spread.variance())
    }
}

fn bends(normals: &[Vec3; 3]) -> bool {
    let [a, b, c] = *normals;
    a.distance_squared(b).max(a.distance_squared(c)) > LEAST_BEND
}

/// Moments of the normals over polygons, relative to one of them.
struct Spread {
    about: Vec3,
    mean: Vec3,
    square: f32,
    total: f32,
}

impl Spread {
    fn about(about: Vec3) -> Self {
        Self { about, mean: Vec3::ZERO, square: 0.0, total: 0.0 }
    }

    /// Adds a polygon with this weight, taking normals to be linear over each triangle of its fan.
    fn add(&mut self, polygon: &[SurfacePoint], weight: f32, normals: [Vec3; 3]) {
        let normal = |p: &SurfacePoint| {
            interpolate_color(normals, p.barycentric.as_vec3()).normalize_or(self.about) - self.about
        };
        let area = |a: DVec2, b: DVec2, c: DVec2| (b - a).perp_dot(c - a).abs();
        let triangles = || polygon.windows(2).skip(1).map(|w| [&polygon[0], &w[0], &w[1]]);
        let whole: f64 = triangles().map(|[a, b, c]| area(a.grid, b.grid, c.grid)).sum();
        if whole <= 0.0 {
            return;
        }
        for [a, b, c] in triangles() {
            let share = weight * (area(a.grid, b.grid, c.grid) / whole) as f32;
            let corners = [a, b, c].map(normal);
            let sum: Vec3 = corners.into_iter().sum();
            // The integrals of a linear function and its square over a triangle.
            self.mean += sum * (share / 3.0);
            let squares: f32 = corners.iter().map(|d| d.length_squared()).sum();
            self.square += share * (squares + sum.length_squared()) / 12.0;
            self.total += share;
        }
    }

    /// Mean squared distance from the mean; 0 without weight.
    fn variance(&self) -> f32 {
        if self.total <= 0.0 {
            return 0.0;
        }
        (self.square / self.total - (self.mean / self.total).length_squared()).max(0.0)
    }
}
