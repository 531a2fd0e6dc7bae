//! What a point sees of a light with an area or a length, as shading takes it.

use glam::{DVec3, Vec3};
use pointillist_shade::{Emission, Incident, Lobe, integrate_line, integrate_polygon};
use pointillist_shadow::{SeenLight, SeenLine};

/// What a point sees of a light as a whole.
pub(crate) trait Seen {
    /// The point, in the world.
    fn position(&self) -> DVec3;
    /// Irradiance over π times the light's radiance, or intensity per length.
    fn share(&self, normal: DVec3) -> f64;
    /// Area or length of what is seen.
    fn extent(&self) -> f64;
    /// Adds up what a surface makes of it.
    fn integrate(
        &self,
        emission: &Emission,
        lobe: &Lobe,
        reflect: &mut dyn FnMut(&Incident) -> Vec3,
        sum: &mut Vec3,
    );
}

impl Seen for SeenLight {
    fn position(&self) -> DVec3 {
        self.position()
    }

    fn share(&self, normal: DVec3) -> f64 {
        self.share(normal)
    }

    fn extent(&self) -> f64 {
        self.area()
    }

    fn integrate(
        &self,
        emission: &Emission,
        lobe: &Lobe,
        reflect: &mut dyn FnMut(&Incident) -> Vec3,
        sum: &mut Vec3,
    ) {
        self.for_each_part(|ring, transmittance| {
            *sum += integrate_polygon(ring, emission, lobe, &mut *reflect) * transmittance as f32;
        });
    }
}

impl Seen for SeenLine {
    fn position(&self) -> DVec3 {
        self.position()
    }

    fn share(&self, normal: DVec3) -> f64 {
        self.share(normal)
    }

    fn extent(&self) -> f64 {
        self.length()
    }

    fn integrate(
        &self,
        emission: &Emission,
        lobe: &Lobe,
        reflect: &mut dyn FnMut(&Incident) -> Vec3,
        sum: &mut Vec3,
    ) {
        for (ends, transmittance) in self.parts() {
            *sum += integrate_line(ends, emission, lobe, &mut *reflect) * transmittance as f32;
        }
    }
}
