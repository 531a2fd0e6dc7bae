//! Our own pictures: through the whole pipeline, or from the micropoints alone.

use glam::DVec3;
use pointillist_micropoint::{
    Geometry, MicropointError, MicropointOptions, PlainOpacity, Renderer, SurfaceOpacity, Tile, View,
    ViewError,
};
use pointillist_render::Scene;
use pointillist_render::{DrawOptions, RenderError, render};

use crate::common::picture::Picture;

/// Tiles as in the pipeline.
pub(crate) const TILE_SIZE: u32 = 16;

/// Draws a scene as `pointillist render` does.
pub(crate) fn with_pipeline(scene: &Scene) -> Result<Picture, RenderError> {
    let frame = render(scene, &DrawOptions::DEFAULT, &())?;
    Ok(Picture::from_frame(&frame))
}

/// The geometry of a scene without textures.
pub(crate) fn geometry(scene: &Scene) -> Result<Geometry, MicropointError> {
    let surface = |m: &pointillist_render::Material| SurfaceOpacity {
        opacity: m.surface.opacity,
        textured_opacity: false,
        two_sided: true,
    };
    let surfaces: Vec<_> = scene.materials.iter().map(surface).collect();
    let mesh = &scene.mesh;
    Geometry::new(&mesh.positions, &mesh.triangles, &mesh.material_of, &surfaces)
}

/// The camera of a scene.
pub(crate) fn view(scene: &Scene) -> Result<View, ViewError> {
    scene.camera.view([scene.image.width, scene.image.height])
}

/// Draws a scene of emissive surfaces from its micropoints, on the calling thread.
pub(crate) fn emissive(scene: &Scene, options: MicropointOptions) -> Result<Picture, MicropointError> {
    let geometry = geometry(scene)?;
    let renderer = Renderer::new(&geometry, &PlainOpacity, view(scene)?, options)?;
    let mut picture = Picture::black(scene.image.width, scene.image.height);
    let mut tile = Tile::default();
    let background = scene.image.background.as_dvec3();
    for rect in renderer.picture().tiles(TILE_SIZE) {
        renderer.render(rect, &mut tile);
        let mut covered = vec![0.0; picture.pixels.len().min((TILE_SIZE * TILE_SIZE) as usize)];
        for m in tile.points() {
            let triangle = tile.faces()[m.face as usize].id as usize;
            let material = &scene.materials[scene.mesh.material_of[triangle] as usize];
            picture.pixels[m.y as usize * picture.width + m.x as usize] +=
                m.weight * material.surface.emission.as_dvec3();
            covered[((m.y - rect.y0) * TILE_SIZE + m.x - rect.x0) as usize] += m.weight;
        }
        if background != DVec3::ZERO {
            for y in rect.y0..rect.y1 {
                for x in rect.x0..rect.x1 {
                    let open: f64 = 1.0 - covered[((y - rect.y0) * TILE_SIZE + x - rect.x0) as usize];
                    picture.pixels[y as usize * picture.width + x as usize] += background * open.max(0.0);
                }
            }
        }
    }
    Ok(picture)
}
