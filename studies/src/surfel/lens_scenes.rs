//! The two settings of the reference pictures of points, for a surface of any size.

use glam::DVec3;

use crate::common::true_surface::Surface;
use crate::surfel::lens_camera::{LensCamera, Matt};

/// From the middle of the box of the surface to the eye, in diagonals of that box.
const DISTANCE: f64 = 1.55;

/// Full vertical field of view.
const FOV_Y_DEG: f64 = 35.0;

/// Waves of colour in a diagonal.
const WAVES: f64 = 25.0;

/// Radius of the lens and depth of what is sharp, in diagonals: what is farthest blurs over a radius of about 4 % of
/// the picture's height, 16 pixels of 400.
const APERTURE: f64 = 0.176_101_634_4;
const FOCUS: f64 = 1.430_177_841_9;

/// Share of the light that comes from everywhere.
const AMBIENT: f64 = 0.1;

/// The front, all sharp: `front.json` for the bunny.
pub(crate) fn front(surface: &Surface, size: u32) -> (LensCamera, Matt) {
    front_from(surface, size, 1.0)
}

/// The same with the eye so many times as far away.
pub(crate) fn front_from(surface: &Surface, size: u32, distances: f64) -> (LensCamera, Matt) {
    let light = DVec3::new(0.371_827_223_4, 0.477_123_428_3, 0.796_302_549_3);
    setting(surface, size, distances * DVec3::new(0.25, 0.2, 1.0).normalize(), light)
}

/// From above through a lens: `dof.json` for the bunny. `share` scales the lens.
pub(crate) fn above(surface: &Surface, size: u32, share: f64) -> (LensCamera, Matt) {
    let light = DVec3::new(0.248_788_581_6, 0.909_150_632_5, 0.333_990_073_2);
    let (camera, matt) = setting(surface, size, DVec3::new(0.1, 1.0, 0.35).normalize(), light);
    let diagonal = surface.diagonal();
    (camera.with_lens(share * APERTURE * diagonal, FOCUS * diagonal), matt)
}

/// `to_eye` is in units of [`DISTANCE`].
fn setting(surface: &Surface, size: u32, to_eye: DVec3, light: DVec3) -> (LensCamera, Matt) {
    let target = surface.centre();
    let eye = target + DISTANCE * surface.diagonal() * to_eye;
    let camera = LensCamera::look_at([eye, target, DVec3::Y], FOV_Y_DEG.to_radians(), [size, size]);
    (camera, Matt { light: light.normalize(), ambient: AMBIENT, period: surface.diagonal() / WAVES })
}

/// The name of the scene in which a lens blurs by so many pixels.
pub(crate) fn lens_name(px: u32) -> String {
    format!("lens {px} px")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::common::data;

    use std::path::Path;

    use serde_json::Value;

    /// As the reference pictures write it, with the direction of the light and the share of ambient light.
    fn read(path: &Path) -> Option<(LensCamera, DVec3, f64)> {
        let json: Value = serde_json::from_str(&std::fs::read_to_string(path).ok()?).ok()?;
        let vector = |name: &str| {
            let v = &json[name];
            Some(DVec3::new(v[0].as_f64()?, v[1].as_f64()?, v[2].as_f64()?))
        };
        let size = [json["width"].as_u64()? as u32, json["height"].as_u64()? as u32];
        let places = [vector("eye")?, vector("target")?, vector("up")?];
        let mut camera = LensCamera::look_at(places, json["fov_y_deg"].as_f64()?.to_radians(), size);
        let lens = &json["lens"];
        if !lens.is_null() {
            camera = camera.with_lens(lens["aperture_radius"].as_f64()?, lens["focus_distance"].as_f64()?);
        }
        Some((camera, vector("light_dir")?.normalize(), json["ambient"].as_f64()?))
    }

    #[test]
    fn the_bunnys_settings_are_those_of_the_references() {
        let Some(folder) = data::folder() else { return };
        let surface = Surface::coarse_bunny_or_bumpy();
        for (name, (camera, matt)) in [("front", front(&surface, 512)), ("dof", above(&surface, 400, 1.0))] {
            let path = folder.join("reference/points").join(name).with_extension("json");
            let Some((wanted, light, ambient)) = read(&path) else { return };
            assert!(camera.eye.distance(wanted.eye) < 1e-9 && camera.forward.distance(wanted.forward) < 1e-9);
            assert!((camera.aperture - wanted.aperture).abs() < 1e-9);
            assert!((camera.width, camera.height) == (wanted.width, wanted.height));
            // A pinhole is sharp everywhere.
            assert!(camera.aperture == 0.0 || (camera.focus - wanted.focus).abs() < 1e-9);
            assert!(matt.light.distance(light) < 1e-9 && matt.ambient == ambient);
            assert!((matt.period - 0.010_003_766_569).abs() < 1e-12);
        }
    }
}
