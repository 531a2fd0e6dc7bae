//! What is drawn, as plain data: triangles, materials, textures, lights and a camera.

mod ambient;
mod camera;
mod check;
mod details;
mod error;
mod instances;
mod light;
mod map_place;
mod material;
mod mesh;
mod texture;

pub use ambient::{AmbientLight, SkyLight};
pub use camera::Camera;
pub use details::{Bump, BumpHeight, Channel, Details, Map, MeasuredBrdf, Surroundings, Transmission};
pub use error::SceneError;
pub(crate) use instances::Storage;
pub use instances::{Instance, normal_matrix};
pub use light::LightSource;
pub use map_place::{MapPlace, UvSet};
pub use material::Material;
pub use mesh::{Mesh, NONE, Object, Part};
pub(crate) use texture::{LINEAR_OF_SRGB, unit_of_byte};
pub use texture::{Texels, Texture, linear_from_srgb, srgb_from_linear};

use glam::{DVec3, Vec3};
use pointillist_micropoint::{MicropointOptions, Occlusion};
use pointillist_shade::Interpolation;
use pointillist_view::View;

/// Everything that a picture is made of.
///
/// Lists refer to one another by index; [`Scene::check`] says whether they fit, and everything that draws a scene asks it first.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Scene {
    /// Where the eye is.
    pub camera: Camera,
    /// The picture's size and what is behind everything.
    pub image: ImageSettings,
    /// How to draw.
    pub render: RenderSettings,
    /// All objects together, in world space.
    pub mesh: Mesh,
    /// What [`Mesh::material_of`] refers to.
    pub materials: Vec<Material>,
    /// What materials and [`ImageSettings::environment`] refer to.
    pub textures: Vec<Texture>,
    /// The lights. The layer `lit.<name>` of a light is asked for by its index.
    pub lights: Vec<LightSource>,
    /// Light that does not come straight from the lights.
    pub ambient: AmbientLight,
}

/// The picture's size and what is behind everything.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ImageSettings {
    /// Pixels in a row, 1 to [`View::LARGEST_SIDE`].
    pub width: u32,
    /// Rows, 1 to [`View::LARGEST_SIDE`].
    pub height: u32,
    /// Linear radiance where no surface is; alpha is 0 there. Default: black.
    pub background: Vec3,
    /// Index of a texture of all directions in place of the colour: equirectangular (row 0 is +Y, its centre is −Z, columns run towards +X)
    /// or the faces of a cube ([`Texture::is_cube`]).
    pub environment: Option<usize>,
    /// The picture shows [`ImageSettings::background`] although there is an environment, which then only lights and is mirrored. Probes
    /// see the environment. Default: `false`.
    pub hides_environment: bool,
}

/// How to draw.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct RenderSettings {
    /// Cells per pixel side: 1, 2 or 4; `None` is the renderer's default.
    pub cells_per_pixel: Option<u32>,
    /// How pieces in a cell hide one another; `None` is the renderer's default.
    pub occlusion: Option<Occlusion>,
    /// What is interpolated across a triangle.
    pub shading: Interpolation,
}

impl RenderSettings {
    pub(crate) fn occlusion(&self) -> Occlusion {
        self.occlusion.unwrap_or_default()
    }

    pub(crate) fn micropoints(&self) -> MicropointOptions {
        let options = MicropointOptions::DEFAULT;
        let cells = self.cells_per_pixel.unwrap_or(options.cells_per_pixel);
        options.with_cells_per_pixel(cells).with_occlusion(self.occlusion())
    }
}

impl Scene {
    /// An empty scene of this picture size in pixels, width and height: black, without lights.
    #[must_use]
    pub fn new(camera: Camera, [width, height]: [u32; 2]) -> Self {
        Self {
            camera,
            image: ImageSettings {
                width,
                height,
                background: Vec3::ZERO,
                environment: None,
                hides_environment: false,
            },
            render: RenderSettings::default(),
            mesh: Mesh::default(),
            materials: Vec::new(),
            textures: Vec::new(),
            lights: Vec::new(),
            ambient: AmbientLight::Color(Vec3::ZERO),
        }
    }

    /// Adds a material; the index that [`Part::with_material`] takes comes back.
    pub fn add_material(&mut self, material: Material) -> u32 {
        self.materials.push(material);
        self.materials.len() as u32 - 1
    }

    /// Adds a texture; the index that materials refer to comes back.
    pub fn add_texture(&mut self, texture: Texture) -> usize {
        self.textures.push(texture);
        self.textures.len() - 1
    }

    /// The camera with a picture of this scene's size.
    ///
    /// # Errors
    /// [`pointillist_view::ViewError`] if the camera or the size is refused.
    pub fn view(&self) -> Result<View, pointillist_view::ViewError> {
        self.camera.view([self.image.width, self.image.height])
    }

    /// World positions of a triangle's corners.
    pub(crate) fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.mesh.corners(triangle)
    }
}
