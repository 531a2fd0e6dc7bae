//! A checked scene, divided into patches.

use glam::DVec3;

use crate::contact;
use crate::error::RadiosityError;
use crate::factor::FactorOptions;
use crate::polygon::Polygon;
use crate::rgb::Rgb;
use crate::surface::{Surface, check_material};
use crate::tree::Tree;
use crate::visible::boxes::Boxes;

/// How a scene is divided and how accurate exchange is.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SceneOptions {
    /// Longest edge of a patch, in the scene's unit. Default: infinite, that is, one patch for each surface that is about square.
    pub patch: f64,
    /// Where light changes fast, patches are divided down to this longest edge. Default: infinite, that is, never.
    pub smallest_patch: f64,
    /// Tolerance of one link of a hierarchy, as a share of the scene's mean radiosity; `None` links every
    /// patch with every other one (the full matrix). Default: `None`.
    pub tolerance: Option<f64>,
    /// Whether surfaces that are much longer than wide are divided into squarer ones even below the size of a patch. Pairs of patches are more accurate
    /// then; [`Scene::transport_by_rays`] needs it not. Default: true.
    pub squarer: bool,
    /// Most patches and patches of patches. Default: 4 million.
    pub max_elements: usize,
    /// Form factors below this are left out; how much they add up to is counted. Default: 0.
    pub least_factor: f64,
    /// Accuracy of each form factor. Default: 1e-9 in the open, 1e-3 behind something, or 1e-5 absolute,
    /// with at most 400 cells.
    pub factors: FactorOptions,
}

impl SceneOptions {
    /// The defaults, as a constant.
    pub const DEFAULT: Self = Self {
        patch: f64::INFINITY,
        smallest_patch: f64::INFINITY,
        tolerance: None,
        squarer: true,
        max_elements: 4_000_000,
        least_factor: 0.0,
        factors: FactorOptions::DEFAULT
            .with_unoccluded(1e-9)
            .with_occluded(1e-3)
            .with_absolute(1e-5)
            .with_max_cells(400),
    };

    /// Another longest edge of patches.
    #[must_use]
    pub const fn with_patch(mut self, size: f64) -> Self {
        self.patch = size;
        self
    }

    /// Patches may become this small where light changes fast.
    #[must_use]
    pub const fn with_smallest_patch(mut self, size: f64) -> Self {
        self.smallest_patch = size;
        self
    }

    /// What suits links by rays: patches of this size, a quarter of it at the edges of shadows of lamps, and long surfaces as they are.
    ///
    /// Dabrovic's Sponza (`studies -- radiosity buildings`) errs by 8.5 % where patches at edges of shadows are as large as others, and by 5.6 % so.
    #[must_use]
    pub const fn for_rays(patch: f64) -> Self {
        Self::DEFAULT.with_squarer(false).with_patch(patch).with_smallest_patch(0.25 * patch)
    }

    /// A hierarchy of links with this tolerance, or the full matrix.
    #[must_use]
    pub const fn with_tolerance(mut self, tolerance: Option<f64>) -> Self {
        self.tolerance = tolerance;
        self
    }

    /// Long surfaces in squarer patches, or not.
    #[must_use]
    pub const fn with_squarer(mut self, squarer: bool) -> Self {
        self.squarer = squarer;
        self
    }

    /// Another limit of elements.
    #[must_use]
    pub const fn with_max_elements(mut self, limit: usize) -> Self {
        self.max_elements = limit;
        self
    }

    /// Leaves out form factors below this.
    #[must_use]
    pub const fn with_least_factor(mut self, least: f64) -> Self {
        self.least_factor = least;
        self
    }

    /// Another accuracy of form factors.
    #[must_use]
    pub const fn with_factors(mut self, factors: FactorOptions) -> Self {
        self.factors = factors;
        self
    }

    /// Area below which patches are not divided, whatever their length, where they should be no longer than `size`.
    pub(crate) fn sliver(&self, size: f64) -> f64 {
        if self.squarer { 0.0 } else { SLIVER * size * size }
    }

    fn check(&self) -> Result<(), RadiosityError> {
        let above_0 = |name, value: f64| {
            if value > 0.0 {
                Ok(())
            } else {
                Err(RadiosityError::Option { name, value, expected: "above 0" })
            }
        };
        above_0("patch", self.patch)?;
        above_0("smallest_patch", self.smallest_patch)?;
        above_0("tolerance", self.tolerance.unwrap_or(1.0))?;
        if self.least_factor >= 0.0 && self.least_factor < 1.0 {
            return Ok(());
        }
        let (name, expected) = ("least_factor", "from 0 to below 1");
        Err(RadiosityError::Option { name, value: self.least_factor, expected })
    }
}

impl Default for SceneOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// Where long surfaces may stay as they are, patches are divided no further whose area is below this share of the square of the patch size.
const SLIVER: f64 = 1.0 / 32.0;

/// One side of a surface, or of a part of it.
#[derive(Clone, Debug)]
pub(crate) struct Side {
    pub(crate) surface: usize,
    pub(crate) back: bool,
    pub(crate) reflectance: Rgb,
    pub(crate) emission: Rgb,
    /// 0, or different for each part of a surface that others stand on: radiosity is discontinuous between parts.
    pub(crate) part: u32,
}

impl Side {
    /// Whether it neither reflects nor emits.
    pub(crate) fn is_black(&self) -> bool {
        self.reflectance == [0.0; 3] && self.emission == [0.0; 3]
    }
}

/// Surfaces, checked, moved to the origin, scaled to about 1 and divided into patches.
#[derive(Clone, Debug)]
pub struct Scene {
    pub(crate) tree: Tree,
    pub(crate) sides: Vec<Side>,
    /// All surfaces, black ones included, as occluders.
    pub(crate) occluders: Vec<Polygon>,
    /// Where the occluders are.
    pub(crate) boxes: Boxes,
    /// The caller's number of each occluder.
    pub(crate) surface_of: Vec<usize>,
    pub(crate) options: SceneOptions,
    /// Internal coordinates are `(p + by) · scale`, for `p` in the caller's (the scene's) coordinates.
    pub(crate) by: DVec3,
    pub(crate) scale: f64,
    dropped: usize,
}

impl Scene {
    /// Checks and divides. Surfaces without area that emit nothing are dropped and counted.
    ///
    /// # Errors
    /// [`RadiosityError`]: outlines that are not convex and planar, reflectances outside 0 to 1, emissions that are negative or not
    /// finite, emitters without area, options out of range, too many patches.
    pub fn new(surfaces: &[Surface], options: &SceneOptions) -> Result<Self, RadiosityError> {
        options.check()?;
        let mut kept = vec![];
        for (i, surface) in surfaces.iter().enumerate() {
            kept.extend(surface.checked(i)?.map(|polygon| (i, polygon)));
        }
        if kept.is_empty() {
            return Err(RadiosityError::NoSurface);
        }
        let all = || kept.iter().flat_map(|(_, p)| p.vertices());
        let low = all().fold(DVec3::INFINITY, |m, &v| m.min(v));
        let high = all().fold(DVec3::NEG_INFINITY, |m, &v| m.max(v));
        let by = -0.5 * (low + high);
        // A power of two: scaling is exact.
        let scale = 2.0_f64.powi(-((high - low).max_element().log2().ceil() as i32));
        let dropped = surfaces.len() - kept.len();
        let mut scene = Self {
            tree: Tree::default(),
            sides: vec![],
            occluders: vec![],
            boxes: Boxes::default(),
            surface_of: kept.iter().map(|(i, _)| *i).collect(),
            options: *options,
            by,
            scale,
            dropped,
        };
        scene.occluders = kept.iter().map(|(_, polygon)| polygon.moved(by, scale)).collect();
        scene.boxes = Boxes::new(&scene.occluders);
        let mut near = vec![];
        for (slot, (i, _)) in kept.iter().enumerate() {
            scene.add(*i, &surfaces[*i], slot, &mut near);
        }
        let size = options.patch * scale;
        if !scene.tree.divide_all(size, options.sliver(size), options.max_elements) {
            return Err(RadiosityError::TooManyPatches { limit: options.max_elements });
        }
        Ok(scene)
    }

    /// Adds both sides of a surface, in parts where others stand on it.
    fn add(&mut self, index: usize, surface: &Surface, slot: usize, near: &mut Vec<u32>) {
        let polygon = &self.occluders[slot];
        let reach = DVec3::splat(2.0 * polygon.radius() * f64::EPSILON.sqrt());
        let all = polygon.vertices();
        let low = all.iter().fold(DVec3::INFINITY, |m, &v| m.min(v)) - reach;
        let high = all.iter().fold(DVec3::NEG_INFINITY, |m, &v| m.max(v)) + reach;
        self.boxes.in_box(low, high, near);
        let parts = contact::parts(polygon, near.iter().map(|&i| &self.occluders[i as usize]));
        let Surface { reflectance, emission, .. } = *surface;
        let whole = parts.len() == 1;
        let shortest = if self.options.squarer { 0.0 } else { self.options.patch * self.scale };
        for back in [false, true] {
            if back && !surface.two_sided {
                continue;
            }
            for polygon in &parts {
                let number = self.sides.len() as u32;
                let part = if whole { 0 } else { number + 1 };
                self.sides.push(Side { surface: index, back, reflectance, emission, part });
                let polygon = if back { polygon.flipped() } else { polygon.clone() };
                self.tree.add_side(&polygon, number, shortest);
            }
        }
    }

    /// Gives a surface another reflectance and emission; returns whether the emission changed.
    ///
    /// # Errors
    /// [`RadiosityError::UnknownSurface`]; [`RadiosityError::Reflectance`], [`RadiosityError::ReflectanceAboveOne`] and
    /// [`RadiosityError::Emission`] for values that are none. Then nothing is changed.
    pub fn set_material(
        &mut self,
        surface: usize,
        reflectance: Rgb,
        emission: Rgb,
    ) -> Result<bool, RadiosityError> {
        check_material(surface, reflectance, emission)?;
        // Sides are in the order of surfaces.
        let first = self.sides.partition_point(|side| side.surface < surface);
        let count = self.sides[first..].partition_point(|side| side.surface == surface);
        if count == 0 {
            return Err(RadiosityError::UnknownSurface { surface });
        }
        let sides = &mut self.sides[first..first + count];
        let changes = sides.iter().any(|side| side.emission != emission);
        for side in sides {
            (side.reflectance, side.emission) = (reflectance, emission);
        }
        Ok(changes)
    }

    /// How many surfaces without area were dropped.
    #[must_use]
    pub const fn dropped(&self) -> usize {
        self.dropped
    }

    /// How many patches there are: leaves of the tree. Refinement may add to them.
    #[must_use]
    pub fn patch_count(&self) -> usize {
        self.tree.elements.iter().filter(|e| e.is_leaf()).count()
    }

    /// From the caller's to internal coordinates.
    pub(crate) fn inward(&self, p: DVec3) -> DVec3 {
        (p + self.by) * self.scale
    }

    /// From internal to the caller's coordinates.
    pub(crate) fn outward(&self, p: DVec3) -> DVec3 {
        p / self.scale - self.by
    }
}
