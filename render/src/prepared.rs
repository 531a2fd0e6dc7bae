//! A scene with everything computed that does not depend on the view.

use crate::ambient::Ambient;
use crate::background::{Panorama, sum_up_environment};
use crate::casters::{Casters, ClearBoxes, Occasion, clear_casters};
use crate::emitters::{EmittingPolygon, emitting_polygons, radiance_of_triangle};
use crate::error::RenderError;
use crate::monitor::{Monitor, go_on, stage};
use crate::reflections::Reflections;
use crate::scene::{AmbientLight, Scene};
use crate::see_through::{Sight, sights};
use crate::surfaces::Surfaces;
use glam::Vec3;
use pointillist_micropoint::Geometry;
use std::sync::Arc;

/// What all views of a scene share: textures summed up, geometry sorted into clusters.
pub struct Prepared<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) surfaces: Arc<Surfaces>,
    pub(crate) geometry: Arc<Geometry>,
    /// What casts shadows in the place of `geometry`, if anything is clear.
    pub(crate) clear_casters: Arc<Vec<Casters>>,
    pub(crate) clear_boxes: Arc<ClearBoxes>,
    /// What the eye sees: one sight, or more if something that it sees through is coloured.
    pub(crate) sights: Arc<Vec<Sight>>,
    /// Polygons of materials that light others.
    pub(crate) emitters: Arc<Vec<EmittingPolygon>>,
    pub(crate) environment: Arc<Option<Panorama>>,
    pub(crate) reflections: Arc<Reflections>,
}

/// What is prepared of a scene's textures: for the same scene with its triangles in other places ([`Prepared::with_maps`]). Holds no reference
/// to the scene, which may be changed meanwhile.
#[derive(Clone)]
pub struct PreparedMaps {
    surfaces: Arc<Surfaces>,
    environment: Arc<Option<Panorama>>,
    reflections: Arc<Reflections>,
    sizes: [usize; 3],
}

/// Triangles, materials and textures.
fn sizes(scene: &Scene) -> [usize; 3] {
    [scene.mesh.triangle_count(), scene.materials.len(), scene.textures.len()]
}

impl PreparedMaps {
    pub(crate) fn check(&self, scene: &Scene) {
        assert_eq!(sizes(scene), self.sizes, "a scene of the same triangles, materials and textures");
    }
}

impl<'a> Prepared<'a> {
    /// What is prepared of the textures.
    #[must_use]
    pub fn maps(&self) -> PreparedMaps {
        PreparedMaps {
            surfaces: self.surfaces.clone(),
            environment: self.environment.clone(),
            reflections: self.reflections.clone(),
            sizes: sizes(self.scene),
        }
    }

    /// Prepares all but the surroundings that are captured for mirrors: those are drawn with what is prepared here.
    pub(crate) fn without_captures(
        scene: &'a Scene,
        maps: Option<&PreparedMaps>,
        monitor: &dyn Monitor,
    ) -> Result<Self, RenderError> {
        scene.check()?;
        let surfaces = stage(monitor, "textures", || match maps {
            Some(maps) => Ok(maps.surfaces.moved(scene)),
            None => Surfaces::new(scene),
        })?;
        go_on(monitor)?;
        let geometry = Arc::new(stage(monitor, "build", || surfaces.geometry(scene))?);
        go_on(monitor)?;
        let environment = match maps {
            Some(maps) => maps.environment.clone(),
            None => Arc::new(stage(monitor, "textures", || sum_up_environment(scene))?),
        };
        let reflections = match maps {
            Some(maps) => maps.reflections.without_captures(),
            None => Reflections::new(scene, monitor)?,
        };
        let clear_casters = clear_casters(scene, &geometry)?;
        let sights = Arc::new(sights(scene, &geometry, &clear_casters)?);
        let emitters = emitting_polygons(scene, |t| radiance_of_triangle(scene, &surfaces, t));
        monitor.count("triangles", geometry.triangle_count() as u64);
        monitor.count("triangles_of_solids", geometry.solid_triangle_count() as u64);
        monitor.count("emitting_polygons", emitters.len() as u64);
        Ok(Self {
            scene,
            surfaces: Arc::new(surfaces),
            geometry,
            sights,
            clear_boxes: Arc::new(if clear_casters.len() > 1 {
                ClearBoxes::new(scene)
            } else {
                ClearBoxes::default()
            }),
            clear_casters: Arc::new(clear_casters),
            emitters: Arc::new(emitters),
            environment,
            reflections: Arc::new(reflections),
        })
    }

    /// The same scene with other triangles in view.
    pub(crate) fn with_geometry(&self, geometry: Geometry) -> Result<Self, RenderError> {
        let geometry = Arc::new(geometry);
        let clear_casters = clear_casters(self.scene, &geometry)?;
        Ok(Self {
            scene: self.scene,
            surfaces: self.surfaces.clone(),
            sights: Arc::new(sights(self.scene, &geometry, &clear_casters)?),
            clear_casters: Arc::new(clear_casters),
            clear_boxes: self.clear_boxes.clone(),
            geometry,
            emitters: self.emitters.clone(),
            environment: self.environment.clone(),
            reflections: self.reflections.clone(),
        })
    }

    /// The same triangles, materials and textures in another scene: one that differs in its camera, its picture and its lights only. Costs
    /// nothing. What mirrors had captured ([`Surroundings::Capture`](crate::Surroundings::Capture)) stays as it was lit before.
    ///
    /// # Errors
    /// [`RenderError::Scene`] if the scene cannot be drawn.
    ///
    /// # Panics
    /// If the scene has another number of triangles, materials or textures.
    pub fn with_scene<'b>(&self, scene: &'b Scene) -> Result<Prepared<'b>, RenderError> {
        scene.check()?;
        assert_eq!(sizes(scene), sizes(self.scene), "a scene of the same triangles, materials and textures");
        Ok(Prepared {
            scene,
            surfaces: self.surfaces.clone(),
            geometry: self.geometry.clone(),
            sights: self.sights.clone(),
            clear_casters: self.clear_casters.clone(),
            clear_boxes: self.clear_boxes.clone(),
            emitters: self.emitters.clone(),
            environment: self.environment.clone(),
            reflections: self.reflections.clone(),
        })
    }

    /// What casts shadows, the channels of light for which it does, and when it is asked.
    pub(crate) fn casters(&self) -> impl Iterator<Item = (Vec3, &Geometry, Occasion)> {
        let clear = &*self.clear_casters;
        let (serves_all, occasion) = match &clear[..] {
            [] => (&*self.geometry, Occasion::Always),
            [alike] => (&*alike.geometry, Occasion::Always),
            [first, ..] => (&*first.geometry, Occasion::Untinted),
        };
        let divided = clear.iter().filter(|_| clear.len() > 1);
        std::iter::once((Vec3::ONE, serves_all, occasion))
            .chain(divided.map(|c| (c.channels, &*c.geometry, Occasion::Tinted)))
    }

    /// The triangles.
    pub fn geometry(&self) -> &Geometry {
        &self.geometry
    }

    /// The scene's own ambient light.
    pub fn ambient(&self) -> Ambient<'_> {
        match &self.scene.ambient {
            AmbientLight::Color(color) => Ambient::Color(*color),
            AmbientLight::Sky(light) => Ambient::Sky(*light),
            AmbientLight::Probes { field, unbaked, .. } => Ambient::Probes(field, unbaked),
            AmbientLight::Environment => match self.reflections.of_scene() {
                Some(map) => Ambient::Environment(map),
                None => Ambient::Color(self.scene.image.background),
            },
            AmbientLight::Radiosity { light, .. } => Ambient::Radiosity(light),
            AmbientLight::RadiosityAndProbes { light, field, unbaked, .. } => {
                Ambient::RadiosityAndProbes(light, field, unbaked)
            }
        }
    }

    pub(crate) fn has_constant_background(&self) -> bool {
        self.environment.is_none()
    }
}
