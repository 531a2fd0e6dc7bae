//! Surfaces, the input of a scene.

use glam::DVec3;

use crate::error::RadiosityError;
use crate::polygon::Polygon;
use crate::rgb::{Rgb, is_light};

/// A planar convex polygon of one material.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Corners, counter-clockwise seen from the front.
    pub vertices: Vec<DVec3>,
    /// Diffuse reflectance per band, 0 to 1.
    pub reflectance: Rgb,
    /// Exitance of its own, power per area: π times the radiance of a diffuse emitter.
    pub emission: Rgb,
    /// Whether the back reflects and emits like the front. A surface hides what is behind it either way.
    pub two_sided: bool,
}

impl Surface {
    /// A surface that reflects on its front and emits nothing.
    #[must_use]
    pub fn new(vertices: &[DVec3], reflectance: Rgb) -> Self {
        Self { vertices: vertices.to_vec(), reflectance, emission: [0.0; 3], two_sided: false }
    }

    /// The same with an exitance.
    #[must_use]
    pub const fn emitting(mut self, emission: Rgb) -> Self {
        self.emission = emission;
        self
    }

    /// The same on both sides.
    #[must_use]
    pub const fn two_sided(mut self) -> Self {
        self.two_sided = true;
        self
    }

    /// Its polygon; none if it has no area and emits nothing.
    ///
    /// # Errors
    /// As for the scene.
    pub(crate) fn checked(&self, surface: usize) -> Result<Option<Polygon>, RadiosityError> {
        check_material(surface, self.reflectance, self.emission)?;
        use crate::error::PolygonError::{NoArea, TooFewVertices};
        match Polygon::new(&self.vertices) {
            Ok(polygon) => Ok(Some(polygon)),
            Err(NoArea | TooFewVertices { .. }) if self.emission != [0.0; 3] => {
                Err(RadiosityError::EmitterWithoutArea { surface })
            }
            Err(NoArea | TooFewVertices { .. }) => Ok(None),
            Err(problem) => Err(RadiosityError::Outline { surface, problem }),
        }
    }
}

/// Checks what a material reflects and emits.
pub(crate) fn check_material(surface: usize, reflectance: Rgb, emission: Rgb) -> Result<(), RadiosityError> {
    for value in reflectance {
        if value.is_nan() || value < 0.0 {
            return Err(RadiosityError::Reflectance { surface, value });
        }
        if value > 1.0 {
            return Err(RadiosityError::ReflectanceAboveOne { surface, value });
        }
    }
    if let Some(&value) = emission.iter().find(|&&e| !is_light(e)) {
        return Err(RadiosityError::Emission { surface, value });
    }
    Ok(())
}
