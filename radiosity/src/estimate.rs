//! An estimate of the radiosity before the scene is solved, by which refinement weighs the errors of links.

use crate::rgb::Rgb;
use crate::scene::Scene;

/// Estimated radiosity of each side and the resulting tolerance of links.
#[derive(Debug)]
pub(crate) struct Estimate {
    /// Estimated radiosity of each side: its largest band, power per area.
    pub(crate) of_side: Vec<f64>,
    /// Tolerance of a link, power per area.
    pub(crate) allowed: f64,
}

impl Estimate {
    /// Emission, reflected direct light, and a uniform ambient term for all further reflections (\[2\], eq. 8).
    pub(crate) fn new(scene: &Scene, direct: &[Rgb]) -> Self {
        let largest = |v: Rgb| v.into_iter().fold(0.0, f64::max);
        let mut first = vec![0.0_f64; scene.sides.len()];
        let (mut area, mut power, mut reflected) = (0.0, 0.0, 0.0);
        for leaf in scene.tree.leaves() {
            let element = &scene.tree.elements[leaf as usize];
            let side = &scene.sides[element.side as usize];
            let reflectance = largest(side.reflectance);
            let radiosity = largest(side.emission) + reflectance * largest(direct[leaf as usize]);
            let of_side = &mut first[element.side as usize];
            *of_side = of_side.max(radiosity);
            area += element.polygon.area();
            power += element.polygon.area() * radiosity;
            reflected += element.polygon.area() * reflectance;
        }
        let mean_reflectance = (reflected / area).min(0.95);
        let ambient = power / area / (1.0 - mean_reflectance);
        let of_side = first
            .iter()
            .zip(&scene.sides)
            .map(|(radiosity, side)| radiosity + largest(side.reflectance) * ambient)
            .collect();
        let allowed = scene.options.tolerance.unwrap_or(0.0) * (power / area).max(ambient * mean_reflectance);
        Self { of_side, allowed }
    }
}
