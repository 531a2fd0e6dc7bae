//! The fixed-function OpenGL lighting formula \[5\], with its own light and material.
//!
//! Not physical: the highlight is not weighted by the cosine, and nothing is normalised. It gives the values that OpenGL gives, for
//! comparison. Its light and material hold what the specification \[5\] names, and will not grow.

use crate::{Falloff, brdf::power};
use glam::{DVec3, Vec3};

/// Where an OpenGL light is: its position with w = 0 or 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Placement {
    /// w = 0: infinitely far towards this direction.
    Towards(DVec3),
    /// w = 1: at this point.
    At(DVec3),
}

/// The cone of a spot light: `max(travel·direction, 0)^exponent` inside `cutoff_rad`, 0 outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// The axis, the way the light travels.
    pub direction: DVec3,
    /// Half-angle of the cone.
    pub cutoff_rad: f64,
    /// How fast the light weakens away from the axis.
    pub exponent: f32,
}

/// An OpenGL light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// La.
    pub ambient: Vec3,
    /// Ld.
    pub diffuse: Vec3,
    /// Ls.
    pub specular: Vec3,
    /// Where it is.
    pub placement: Placement,
    /// The cone, if it is a spot.
    pub spot: Option<Spot>,
    /// Constant, linear and quadratic attenuation; not used at infinity.
    pub attenuation: [f32; 3],
}

/// An OpenGL material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Ma.
    pub ambient: Vec3,
    /// Md.
    pub diffuse: Vec3,
    /// Ms.
    pub specular: Vec3,
    /// The exponent m.
    pub shininess: f32,
    /// Added as is.
    pub emission: Vec3,
}

/// What one light adds: `a · s · (La·Ma + max(l·n,0) Ld·Md + f · max(s·n,0)^m Ls·Ms)`, with f = 1 if l·n > 0.
///
/// `a` is attenuation, `s` the spot factor, and in the last term `s` the half vector. `normal` and `to_eye` are unit
/// vectors. Not clamped: [`display`] does that, once, for the sum.
///
/// With OpenGL's local viewer, `to_eye` points from the surface to the eye; without (its default), it is the
/// view's backward axis, the same for all points.
#[must_use]
pub fn contribution(light: &Light, material: &Material, point: DVec3, normal: Vec3, to_eye: Vec3) -> Vec3 {
    let (to_light, strength) = arrival(light, point);
    let cos_light = normal.dot(to_light).max(0.0);
    let half = (to_light + to_eye).normalize_or_zero();
    let highlight = if cos_light > 0.0 { power(half.dot(normal), material.shininess) } else { 0.0 };

    let ambient = light.ambient * material.ambient;
    let diffuse = cos_light * light.diffuse * material.diffuse;
    let specular = highlight * light.specular * material.specular;
    strength * (ambient + diffuse + specular)
}

/// Emission, global ambient and all lights, not clamped.
#[must_use]
pub fn shade(
    lights: &[Light],
    global_ambient: Vec3,
    material: &Material,
    point: DVec3,
    normal: Vec3,
    to_eye: Vec3,
) -> Vec3 {
    let own = material.emission + global_ambient * material.ambient;
    lights.iter().fold(own, |sum, light| sum + contribution(light, material, point, normal, to_eye))
}

/// Clamped to [0, 1], as OpenGL does before it draws.
#[must_use]
pub fn display(color: Vec3) -> Vec3 {
    color.clamp(Vec3::ZERO, Vec3::ONE)
}

/// A unit vector and the length; zeros for a vector without direction.
fn direction_and_length(v: DVec3) -> (DVec3, f64) {
    // The squares of 1e200 and 1e-200 overflow and underflow.
    let is_normal = (1e-280..=1e280).contains(&v.length_squared());
    if is_normal { (v.normalize_or_zero(), v.length()) } else { crate::light::direction_and_length(v) }
}

/// Unit vector to the light, and attenuation times spot factor.
fn arrival(light: &Light, point: DVec3) -> (Vec3, f32) {
    let (to_light, attenuation) = match light.placement {
        Placement::Towards(direction) => (direction_and_length(direction).0, 1.0),
        Placement::At(position) => {
            let (to_light, distance) = direction_and_length(position - point);
            (to_light, Falloff::Polynomial(light.attenuation).at(distance))
        }
    };
    let spot = match (light.spot, light.placement) {
        (Some(spot), Placement::At(_)) => spot_factor(spot, -to_light),
        _ => 1.0,
    };
    (to_light.as_vec3(), attenuation as f32 * spot)
}

fn spot_factor(spot: Spot, travel: DVec3) -> f32 {
    // A cutoff of 180° is OpenGL's way to say that there is no cone.
    if spot.cutoff_rad >= std::f64::consts::PI {
        return 1.0;
    }
    let cosine = travel.dot(direction_and_length(spot.direction).0);
    if cosine < spot.cutoff_rad.cos() { 0.0 } else { power(cosine as f32, spot.exponent) }
}
