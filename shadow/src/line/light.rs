//! A line that shines, and what of it a point sees.

use super::cut::{Interval, positive};
use super::group::LineScratch;
use crate::area::AreaOptions;
use crate::area::light::{COINCIDENT, Frame};
use crate::error::ShadowError;
use crate::receiver::{Receivers, Viewer};
use glam::DVec3;
use pointillist_micropoint::{Geometry, TexturedOpacity};
use std::f64::consts::FRAC_1_PI;

/// A line that shines evenly in all directions, ready to be asked from any thread.
pub struct LineLight<'a> {
    pub(crate) geometry: &'a Geometry,
    pub(crate) opacity: &'a dyn TexturedOpacity,
    /// The world's axes about the line's first end.
    pub(crate) frame: Frame,
    /// Its ends in that frame.
    pub(crate) ends: [DVec3; 2],
    pub(crate) options: AreaOptions,
    /// Something may stand before it.
    pub(crate) casts: bool,
    /// Distances up to this are 0.
    pub(crate) coincident: f64,
}

impl<'a> LineLight<'a> {
    /// A light between two points. Of the options, [`AreaOptions::largest_shift`] is the share of the line by which a receiver's points may
    /// disagree.
    ///
    /// # Errors
    /// [`ShadowError`] if an end is not finite, or both are one.
    pub fn new(
        geometry: &'a Geometry,
        opacity: &'a dyn TexturedOpacity,
        [from, to]: [DVec3; 2],
        options: AreaOptions,
    ) -> Result<Self, ShadowError> {
        if !(from.is_finite() && to.is_finite()) {
            return Err(ShadowError::NotFinite { what: "line" });
        }
        if from == to {
            return Err(ShadowError::LineWithoutLength);
        }
        let bounds = geometry.bounds();
        let reach = |p: DVec3| (p - from).abs().max_element();
        let scene =
            if bounds.low.x <= bounds.high.x { reach(bounds.low).max(reach(bounds.high)) } else { 0.0 };
        Ok(Self {
            geometry,
            opacity,
            frame: Frame::at(from),
            ends: [DVec3::ZERO, to - from],
            options,
            casts: true,
            coincident: COINCIDENT * scene.max(reach(to)),
        })
    }

    /// The same light without shadows.
    #[must_use]
    pub fn without_shadows(mut self) -> Self {
        self.casts = false;
        self
    }

    /// Its length.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.ends[1].length()
    }

    /// What a point of a surface with this unit normal would see with nothing in between.
    #[must_use]
    pub fn whole(&self, position: DVec3, normal: DVec3) -> SeenLine {
        let mut seen = SeenLine::default();
        seen.start(self, self.frame.local(position));
        if let Some(interval) = above_horizon(self, seen.point, normal) {
            seen.parts.push((interval, 1.0));
        }
        seen
    }

    /// Calls `visit` for every receiver with what its points see of the light, as [`AreaLight::visit`](crate::AreaLight::visit) does.
    pub fn visit(
        &self,
        viewer: Viewer<'_>,
        receivers: &Receivers,
        scratch: &mut LineScratch,
        mut visit: impl FnMut(usize, f64, &SeenLine),
    ) {
        super::group::visit(self, viewer, receivers, scratch, &mut visit);
    }
}

/// The interval of the line that is above the horizon of a surface's point; what is in the surface's plane is not.
pub(crate) fn above_horizon(light: &LineLight<'_>, point: DVec3, normal: DVec3) -> Option<Interval> {
    let height = |end: DVec3| normal.dot(end - point) - light.coincident;
    let interval = positive((height(light.ends[0]), height(light.ends[1])), (0.0, 1.0));
    (interval.0 < interval.1).then_some(interval)
}

/// What a point sees of a line: intervals from 0 to 1, each with the share of light that passes through what is translucent in front of it.
#[derive(Debug)]
pub struct SeenLine {
    frame: Frame,
    ends: [DVec3; 2],
    /// The point, in the light's frame.
    pub(crate) point: DVec3,
    pub(crate) parts: Vec<(Interval, f64)>,
}

impl Default for SeenLine {
    fn default() -> Self {
        Self { frame: Frame::at(DVec3::ZERO), ends: [DVec3::ZERO; 2], point: DVec3::ZERO, parts: vec![] }
    }
}

impl SeenLine {
    pub(crate) fn start(&mut self, light: &LineLight<'_>, point: DVec3) {
        (self.frame, self.ends, self.point) = (light.frame, light.ends, point);
        self.parts.clear();
    }

    /// The point, in the world.
    #[must_use]
    pub fn position(&self) -> DVec3 {
        self.frame.origin + self.frame.world_vector(self.point)
    }

    /// The visible intervals of the line, from 0 at its first end to 1, and the transmittance of each.
    pub fn intervals(&self) -> impl Iterator<Item = ((f64, f64), f64)> + '_ {
        self.parts.iter().copied()
    }

    /// The ends of each part relative to the point, in the world's axes, and its transmittance.
    pub fn parts(&self) -> impl Iterator<Item = ([DVec3; 2], f64)> + '_ {
        let [a, b] = self.ends;
        let at = move |t: f64| a + (b - a) * t - self.point;
        self.parts.iter().map(move |&((from, to), transmittance)| ([at(from), at(to)], transmittance))
    }

    /// Irradiance of a surface element with this unit normal over π times the light's intensity per length: Σ ∫ cos θ / d² dl / π.
    #[must_use]
    pub fn share(&self, normal: DVec3) -> f64 {
        let of = |(ends, transmittance)| transmittance * cosine_over_square(ends, normal);
        (self.parts().map(of).sum::<f64>() * FRAC_1_PI).max(0.0)
    }

    /// Length of what is seen, each part times its transmittance.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.parts().map(|([a, b], transmittance)| transmittance * a.distance(b)).sum()
    }
}

/// ∫ cos θ / d² over a line whose ends are relative to the point, all of it above the horizon; 0 for a line through the point.
///
/// With s the place along the line from the foot of the perpendicular h, p = h + s·u and n·p/|p|³ is integrated by parts:
/// n·h (s/(h²·|p|)) − n·u / |p|, between the ends.
fn cosine_over_square([a, b]: [DVec3; 2], normal: DVec3) -> f64 {
    let along = (b - a).normalize_or_zero();
    let (s, t) = (a.dot(along), b.dot(along));
    let (from, to) = (a.length(), b.length());
    if from == 0.0 || to == 0.0 || along == DVec3::ZERO {
        return 0.0;
    }
    let foot = a - along * s;
    // s/|p| between the ends, over h²; where both are on one side of the foot, h² is cancelled by hand, for it may be 0.
    let across = if s * t > 0.0 {
        (t - s) * (t + s) / ((t * from + s * to) * from * to)
    } else {
        let h2 = foot.length_squared();
        if h2 == 0.0 { 0.0 } else { (t / to - s / from) / h2 }
    };
    normal.dot(foot) * across + normal.dot(along) * (1.0 / from - 1.0 / to)
}
