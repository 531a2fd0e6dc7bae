//! Any values at all into every public function: an answer or a typed error, never a panic.

use glam::{DVec3, dvec3};
use pointillist_micropoint::{
    Geometry, MicropointOptions, Occlusion, PlainOpacity, Projection, Renderer, SurfaceOpacity, Tile, View,
};
use pointillist_shadow::{
    Emitter, Receivers, Resolution, ShadowError, ShadowLight, ShadowOptions, ShadowScratch, Viewer,
};
use proptest::prelude::*;
use testkit::numbers::{number, vector};

/// Corners that [`Geometry`] takes.
fn triangle() -> impl Strategy<Value = [DVec3; 3]> {
    let usable = |p: &DVec3| p.is_finite() && p.abs().max_element() < 1e80;
    [vector(number), vector(number), vector(number)].prop_filter("usable", move |c| c.iter().all(usable))
}

proptest! {
    #![proptest_config(testkit::config(512))]

    #[test]
    fn any_light_on_any_receivers_gives_fractions_or_an_error(
        triangles in prop::collection::vec((triangle(), 0.0..=1.0f32), 1..5), position in vector(number), axis in vector(number),
        directional: bool, cells in prop::option::of(any::<u32>()), paper: bool, extra in prop::collection::vec(vector(number), 0..9),
    ) {
        let positions: Vec<_> = triangles.iter().flat_map(|(c, _)| *c).collect();
        let indices: Vec<_> = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let surfaces: Vec<_> = triangles.iter().map(|t| SurfaceOpacity { opacity: t.1, ..SurfaceOpacity::default() }).collect();
        let surface_of: Vec<_> = (0..triangles.len() as u32).collect();
        let geometry = Geometry::new(&positions, &indices, &surface_of, &surfaces).unwrap();
        let view = View::look_at(dvec3(0.1, 0.2, 3.0), DVec3::ZERO, DVec3::Y, Projection::Perspective { fov_y_rad: 1.0 }, 3, 3).unwrap();
        let renderer = Renderer::new(&geometry, &PlainOpacity, view, MicropointOptions::DEFAULT).unwrap();
        let mut tile = Tile::default();
        renderer.render(renderer.picture(), &mut tile);
        let emitter = match directional {
            true => Emitter::Directional { direction: position },
            false => Emitter::Point { position, axis },
        };
        let rule = if paper { Occlusion::Paper } else { Occlusion::Correlated };
        let resolution = cells.map_or(Resolution::Auto, Resolution::Cells);
        let options = ShadowOptions::default().with_occlusion(rule).with_resolution(resolution);
        let light = match ShadowLight::new(&geometry, &PlainOpacity, emitter, options) {
            Ok(light) => light,
            Err(ShadowError::NotFinite { .. }) => {
                prop_assert!(!position.is_finite() || (!directional && !axis.is_finite()) || position.abs().max_element() > 1e80);
                return Ok(());
            }
            Err(_) => return Ok(()),
        };
        let mut receivers = Receivers::default();
        receivers.push_tile(&tile);
        if !tile.faces().is_empty() {
            receivers.push(0, extra.iter().copied());
            receivers.push(0, []);
        }
        let mut lit = vec![];
        light.lit(Viewer { lens: tile.lens(), faces: tile.faces() }, &receivers, &mut ShadowScratch::default(), &mut lit);
        prop_assert_eq!(lit.len(), receivers.len());
        for l in lit {
            prop_assert!((0.0..=1.0).contains(&l), "{}", l);
        }
    }
}
