//! A camera with a thin lens, and the light it takes pictures in.

use glam::{DAffine3, DMat3, DVec2, DVec3, dvec2};

/// Looks along `forward`; pixel (0, 0) is top left. The lens lies in the plane through the eye across the view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LensCamera {
    pub(crate) eye: DVec3,
    pub(crate) right: DVec3,
    pub(crate) up: DVec3,
    pub(crate) forward: DVec3,
    pub(crate) fov_y_rad: f64,
    pub(crate) width: u32,
    pub(crate) height: u32,
    /// Radius of the lens in world units; 0 is a pinhole.
    pub(crate) aperture: f64,
    /// Depth of what is sharp, along the view axis.
    pub(crate) focus: f64,
}

/// A matt surface whose colour waves along the axes, in the light of a sun and some from everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Matt {
    /// Towards the light, unit.
    pub(crate) light: DVec3,
    /// Share of the light that comes from everywhere.
    pub(crate) ambient: f64,
    /// Length of a wave of colour, world units.
    pub(crate) period: f64,
}

impl LensCamera {
    /// A pinhole at `eye` with `up` as near to the picture's as can be.
    pub(crate) fn look_at([eye, target, up]: [DVec3; 3], fov_y_rad: f64, [width, height]: [u32; 2]) -> Self {
        let forward = (target - eye).normalize();
        let right = forward.cross(up).normalize();
        let up = right.cross(forward);
        let focus = target.distance(eye);
        Self { eye, right, up, forward, fov_y_rad, width, height, aperture: 0.0, focus }
    }

    /// With a lens of this radius in front, sharp at depth `focus`.
    pub(crate) fn with_lens(mut self, aperture: f64, focus: f64) -> Self {
        (self.aperture, self.focus) = (aperture, focus);
        self
    }

    /// Scaled about the origin, then moved; the picture of a scene that is mapped alike stays the same.
    pub(crate) fn mapped(mut self, scale: f64, shift: DVec3) -> Self {
        self.eye = self.eye * scale + shift;
        (self.aperture, self.focus) = (self.aperture * scale, self.focus * scale);
        self
    }

    /// The same picture with `margin` more pixels on each side, from an eye elsewhere on the lens; sharp everywhere.
    pub(crate) fn widened(mut self, margin: u32, shift: DVec2) -> Self {
        let focal = self.focal_px();
        self.eye += shift.x * self.right + shift.y * self.up;
        (self.width, self.height) = (self.width + 2 * margin, self.height + 2 * margin);
        self.fov_y_rad = 2.0 * (0.5 * f64::from(self.height) / focal).atan();
        self.aperture = 0.0;
        self
    }

    /// Pixels per world unit at depth 1.
    pub(crate) fn focal_px(&self) -> f64 {
        0.5 * f64::from(self.height) / (0.5 * self.fov_y_rad).tan()
    }

    /// Radius in pixels of the disc as which a point at `depth` is seen.
    pub(crate) fn blur_px(&self, depth: f64) -> f64 {
        self.focal_px() * self.aperture * (1.0 / self.focus - 1.0 / depth).abs()
    }

    /// What renderers take: the camera looks along its −Z.
    pub(crate) fn view_from_world(&self) -> DAffine3 {
        let world_from_view = DMat3::from_cols(self.right, self.up, -self.forward);
        DAffine3::from_mat3_translation(world_from_view, self.eye).inverse()
    }

    /// The ray that meets `pixel` and the lens at `lens`, a place in the unit disc. Its direction has unit depth.
    pub(crate) fn ray(&self, pixel: DVec2, lens: DVec2) -> (DVec3, DVec3) {
        let size = dvec2(f64::from(self.width), f64::from(self.height));
        let slope = (pixel - 0.5 * size) / self.focal_px();
        let through_eye = self.forward + slope.x * self.right - slope.y * self.up;
        let shift = self.aperture * (lens.x * self.right + lens.y * self.up);
        // All rays of a pixel meet in the plane of focus.
        (self.eye + shift, through_eye - shift / self.focus)
    }
}

impl Matt {
    /// From 0.15 to 0.9 in each channel, along one axis each.
    pub(crate) fn albedo(&self, position: DVec3) -> DVec3 {
        let phase = position * (std::f64::consts::TAU / self.period);
        0.15 + 0.75 * (0.5 + 0.5 * phase.map(f64::sin))
    }

    /// What leaves a place with this unit normal.
    pub(crate) fn radiance(&self, position: DVec3, normal: DVec3) -> DVec3 {
        let light = self.ambient + (1.0 - self.ambient) * normal.dot(self.light).max(0.0);
        self.albedo(position) * light
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_of_a_pixel_meet_in_the_plane_of_focus() {
        let places = [DVec3::new(1.0, 2.0, 3.0), DVec3::new(-0.5, 0.1, 0.2), DVec3::Y];
        let camera = LensCamera::look_at(places, 0.6, [40, 30]).with_lens(0.3, 2.5);
        let pixel = dvec2(7.25, 11.5);
        let at = |lens: DVec2, depth: f64| {
            let (origin, direction) = camera.ray(pixel, lens);
            origin + depth * direction
        };
        let sharp = at(DVec2::ZERO, 2.5);
        let seen = camera.view_from_world().transform_point3(sharp);
        assert!((seen.z + 2.5).abs() < 1e-12, "depth is along the axis");
        for lens in [DVec2::X, DVec2::NEG_Y, dvec2(0.3, -0.4)] {
            assert!(at(lens, 2.5).distance(sharp) < 1e-12);
            // Elsewhere they part by the radius of blur.
            let px = at(lens, 4.0).distance(at(DVec2::ZERO, 4.0)) * camera.focal_px() / 4.0;
            assert!((px - camera.blur_px(4.0) * lens.length()).abs() < 1e-9);
        }
    }
}
