//! Lights in physical units, and what of them arrives at a point.

use crate::outline::LightOutline;
use glam::{DVec3, Vec3};
use std::num::NonZeroU32;

/// Irradiance is cut at this value, which keeps everything computed from it finite in `f32`.
///
/// Chosen: far above any light that means something (sunlight is 1e3 W/m²), and with eight decades of room below
/// `f32::MAX` for a BRDF and a sum over lights.
pub const LARGEST_IRRADIANCE: f32 = 1e30;

/// How light weakens with distance `d`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Falloff {
    /// 1 / d², as in nature.
    #[default]
    InverseSquare,
    /// 1 / (c + l·d + q·d²) for `[c, l, q]`, as in OpenGL.
    Polynomial([f32; 3]),
}

impl Falloff {
    /// The factor at distance `d`; 0 where the formula has no finite positive value.
    #[must_use]
    pub fn at(self, d: f64) -> f64 {
        let denominator = match self {
            Self::InverseSquare => d * d,
            Self::Polynomial([c, l, q]) => f64::from(c) + f64::from(l) * d + f64::from(q) * d * d,
        };
        let factor = 1.0 / denominator;
        if factor.is_finite() && factor > 0.0 { factor } else { 0.0 }
    }
}

/// A light source.
#[expect(clippy::large_enum_variant, reason = "lights are few, and kept in lists of their own")]
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Light {
    /// Parallel light, as from the sun.
    Directional {
        /// The way the light travels; any length but zero.
        direction: DVec3,
        /// Irradiance of a surface that faces the light.
        irradiance: Vec3,
    },
    /// The same intensity in all directions.
    Point {
        /// Where it is.
        position: DVec3,
        /// Radiant intensity (power per solid angle).
        intensity: Vec3,
        /// How it weakens with distance.
        falloff: Falloff,
    },
    /// A point light within a cone: full inside `beam_rad`, 0 outside `cutoff_rad`, linear in the angle between.
    Spot {
        /// Where it is.
        position: DVec3,
        /// The axis of the cone, the way the light travels; any length but zero.
        direction: DVec3,
        /// Radiant intensity inside the beam.
        intensity: Vec3,
        /// Half-angle of the full beam.
        beam_rad: f64,
        /// Half-angle of the whole cone; where it is not beyond `beam_rad` the edge is sharp.
        cutoff_rad: f64,
        /// The cosine of the angle from the axis to this power is a further factor, as in OpenGL; 0 for none.
        exponent: f64,
        /// How it weakens with distance.
        falloff: Falloff,
    },
    /// A rectangle that radiates evenly from the side `edge_u × edge_v`.
    Rect {
        /// One corner.
        corner: DVec3,
        /// From the corner along one side.
        edge_u: DVec3,
        /// From the corner along the other side.
        edge_v: DVec3,
        /// Radiance of the front.
        radiance: Vec3,
        /// How many points stand for it; `None` for the whole area, exactly.
        samples: Option<NonZeroU32>,
        /// How each point of it weakens with distance.
        falloff: Falloff,
    },
    /// A convex polygon that radiates evenly from its front, or from both sides.
    Polygon {
        /// Its vertices, counter-clockwise as seen from the front.
        outline: LightOutline,
        /// Radiance of each side that shines.
        radiance: Vec3,
        /// Whether its back shines, too.
        two_sided: bool,
        /// How many points stand for it; `None` for the whole area, exactly.
        samples: Option<NonZeroU32>,
        /// How each point of it weakens with distance.
        falloff: Falloff,
    },
    /// A line each of whose points shines alike in all directions.
    Line {
        /// One end.
        from: DVec3,
        /// The other end.
        to: DVec3,
        /// Radiant intensity per length: of a thin tube, its radiance times its thickness.
        radiance: Vec3,
        /// How many points stand for it; `None` for the whole line, exactly.
        samples: Option<NonZeroU32>,
        /// How each point of it weakens with distance.
        falloff: Falloff,
    },
}

/// Points that stand for an area light without a number of its own, where points have to stand for it.
pub const DEFAULT_SAMPLES: u32 = 16;

/// Where the light comes from, for a shadow test.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Source {
    /// From infinity, along this way of travel (as given, not normalised).
    Direction(DVec3),
    /// From this point.
    Position(DVec3),
}

/// What arrives at a point from one sample of a light, if nothing is in between.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Incident {
    /// Unit vector towards the light; zero if there is no such direction (the point is on the lamp).
    pub to_light: Vec3,
    /// Irradiance of a surface that faces the light; to be multiplied by the cosine at the surface.
    pub irradiance: Vec3,
    /// Where it comes from.
    pub source: Source,
}

impl Incident {
    /// Whether nothing arrives, so that neither shadow nor BRDF matters.
    #[must_use]
    pub fn is_dark(&self) -> bool {
        self.irradiance == Vec3::ZERO
    }
}

impl Light {
    /// How many samples stand for this light: 1 except for lights with an area and lines, which have [`DEFAULT_SAMPLES`] if they do not say.
    #[must_use]
    pub fn samples(&self) -> u32 {
        match self {
            Self::Rect { samples, .. } | Self::Polygon { samples, .. } | Self::Line { samples, .. } => {
                samples.map_or(DEFAULT_SAMPLES, NonZeroU32::get)
            }
            _ => 1,
        }
    }

    /// The outline of a light with an area whose samples nobody asked for: it can be taken as a whole. The flag says whether its back
    /// shines, too.
    #[must_use]
    pub fn exact_area(&self) -> Option<(LightOutline, bool)> {
        match *self {
            Self::Rect { samples: None, .. } => Some((self.outline()?, false)),
            Self::Polygon { samples: None, two_sided, .. } => Some((self.outline()?, two_sided)),
            _ => None,
        }
    }

    /// The ends of a line whose samples nobody asked for: it can be taken as a whole.
    #[must_use]
    pub fn exact_line(&self) -> Option<[DVec3; 2]> {
        match *self {
            Self::Line { from, to, samples: None, .. } => Some([from, to]),
            _ => None,
        }
    }

    /// The outline of a light with an area, counter-clockwise as seen from its front.
    #[must_use]
    pub fn outline(&self) -> Option<LightOutline> {
        match *self {
            Self::Rect { corner, edge_u, edge_v, .. } => {
                let ring = [corner, corner + edge_u, corner + edge_u + edge_v, corner + edge_v];
                Some(LightOutline::from_quad(ring))
            }
            Self::Polygon { outline, .. } => Some(outline),
            _ => None,
        }
    }

    /// How it weakens with distance; inverse-square for a directional light, which does not.
    #[must_use]
    pub fn falloff(&self) -> Falloff {
        match *self {
            Self::Directional { .. } => Falloff::InverseSquare,
            Self::Point { falloff, .. }
            | Self::Spot { falloff, .. }
            | Self::Rect { falloff, .. }
            | Self::Polygon { falloff, .. }
            | Self::Line { falloff, .. } => falloff,
        }
    }

    /// Where sample number `sample` is; numbers beyond [`Light::samples`] start again.
    #[must_use]
    pub fn source(&self, sample: u32) -> Source {
        match *self {
            Self::Directional { direction, .. } => Source::Direction(direction),
            Self::Point { position, .. } | Self::Spot { position, .. } => Source::Position(position),
            Self::Rect { corner, edge_u, edge_v, .. } => {
                let [s, t] = hammersley(sample % self.samples(), self.samples());
                Source::Position(corner + edge_u * s + edge_v * t)
            }
            Self::Line { from, to, .. } => {
                let [t, _] = hammersley(sample % self.samples(), self.samples());
                Source::Position(from + (to - from) * t)
            }
            Self::Polygon { outline, .. } => {
                Source::Position(outline.point(hammersley(sample % self.samples(), self.samples())))
            }
        }
    }

    /// What arrives at `point` from sample number `sample`; the light is the sum over its samples.
    ///
    /// Finite input gives finite output. A point that coincides with the source receives nothing.
    #[must_use]
    pub fn illuminate(&self, sample: u32, point: DVec3) -> Incident {
        let source = self.source(sample);
        let position = match source {
            Source::Direction(direction) => return self.parallel(direction, source),
            Source::Position(position) => position,
        };
        let (to_light, d) = direction_and_length(position - point);
        let strength = match *self {
            Self::Directional { .. } => unreachable!("a directional light has no position"),
            Self::Point { falloff, .. } => falloff.at(d),
            Self::Spot { direction, beam_rad, cutoff_rad, exponent, falloff, .. } => {
                let (axis, _) = direction_and_length(direction);
                let towards_axis =
                    if exponent > 0.0 { axis.dot(-to_light).max(0.0).powf(exponent) } else { 1.0 };
                falloff.at(d) * cone(axis, -to_light, beam_rad, cutoff_rad) * towards_axis
            }
            Self::Rect { edge_u, edge_v, falloff, .. } => {
                let (front, area) = direction_and_length(edge_u.cross(edge_v));
                let cos_light = front.dot(-to_light).max(0.0);
                let sample_area = area / f64::from(self.samples());
                sample_area * cos_light * falloff.at(d)
            }
            Self::Polygon { outline, two_sided, falloff, .. } => {
                let (front, area) = direction_and_length(outline.area_vector());
                let cos_light = front.dot(-to_light);
                let cos_light = if two_sided { cos_light.abs() } else { cos_light.max(0.0) };
                area / f64::from(self.samples()) * cos_light * falloff.at(d)
            }
            Self::Line { from, to, falloff, .. } => {
                let (_, length) = direction_and_length(to - from);
                length / f64::from(self.samples()) * falloff.at(d)
            }
        };
        Incident { to_light: to_light.as_vec3(), irradiance: scaled(self.color(), strength), source }
    }

    /// The light's own quantity: irradiance, intensity or radiance.
    #[must_use]
    pub fn color(&self) -> Vec3 {
        match *self {
            Self::Directional { irradiance, .. } => irradiance,
            Self::Point { intensity, .. } | Self::Spot { intensity, .. } => intensity,
            Self::Rect { radiance, .. } | Self::Polygon { radiance, .. } | Self::Line { radiance, .. } => {
                radiance
            }
        }
    }

    /// The same light with another quantity.
    #[must_use]
    pub fn with_color(mut self, color: Vec3) -> Self {
        let own = match &mut self {
            Self::Directional { irradiance, .. } => irradiance,
            Self::Point { intensity, .. } | Self::Spot { intensity, .. } => intensity,
            Self::Rect { radiance, .. } | Self::Polygon { radiance, .. } | Self::Line { radiance, .. } => {
                radiance
            }
        };
        *own = color;
        self
    }

    fn parallel(&self, direction: DVec3, source: Source) -> Incident {
        let (way, length) = direction_and_length(direction);
        let strength = if length > 0.0 { 1.0 } else { 0.0 };
        Incident { to_light: -way.as_vec3(), irradiance: scaled(self.color(), strength), source }
    }
}

/// A unit vector and the length, or zeros for a vector without direction. Safe from overflow and underflow.
pub(crate) fn direction_and_length(v: DVec3) -> (DVec3, f64) {
    let largest = v.abs().max_element();
    if largest == 0.0 || !v.is_finite() {
        return (DVec3::ZERO, 0.0);
    }
    // Scaled first: the square of 1e200 is not a number we can use, nor is that of 1e-200.
    let scaled = v / largest;
    let length = scaled.length();
    (scaled / length, length * largest)
}

/// 1 within the beam, 0 beyond the cutoff, linear in the angle between them.
fn cone(axis: DVec3, travel: DVec3, beam_rad: f64, cutoff_rad: f64) -> f64 {
    if axis == DVec3::ZERO || travel == DVec3::ZERO {
        return 0.0;
    }
    // Not acos of the dot product, which loses half the digits near the axis.
    let angle = axis.cross(travel).length().atan2(axis.dot(travel));
    if angle <= beam_rad {
        1.0
    } else if angle >= cutoff_rad {
        0.0
    } else {
        (cutoff_rad - angle) / (cutoff_rad - beam_rad)
    }
}

pub(crate) fn scaled(color: Vec3, strength: f64) -> Vec3 {
    let limit = f64::from(LARGEST_IRRADIANCE);
    // An area that overflows, seen from a distance that does, is 0 · ∞: no light, rather than no number.
    let strength = if strength.is_nan() { 0.0 } else { strength.min(f64::MAX) };
    let channel = |c: f32| (f64::from(c) * strength).clamp(-limit, limit) as f32;
    Vec3::new(channel(color.x), channel(color.y), channel(color.z))
}

/// Point `i` of `n` of the Hammersley set in the unit square, each in the middle of its stratum.
fn hammersley(i: u32, n: u32) -> [f64; 2] {
    let half_stratum = 0.5 / f64::from(n);
    let half_digit = 0.5 / f64::from(n.checked_next_power_of_two().unwrap_or(u32::MAX));
    let radical_inverse = f64::from(i.reverse_bits()) / (f64::from(u32::MAX) + 1.0);
    [f64::from(i) / f64::from(n) + half_stratum, radical_inverse + half_digit]
}
