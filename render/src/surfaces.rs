//! A scene's materials as the renderer sees them: opacity, and textures summed up for exact means.

use crate::copies::{MaskedCopy, OtherSide, masked_copies, other_sides};
use crate::detail_maps::{DetailMaps, DetailTable};
use crate::scene::{Details, MapPlace, Material, Mesh, Scene, Storage, Texture};
use crate::texel_sums::{Lazy, color_sums, opacity_sums, sums_of, when_needed};
use crate::uvs::{Uvs, texel_wrap};
use glam::{Vec3, Vec4};
use pointillist_micropoint::{
    Geometry, MaskSums, MicropointError, Placement, Shape, SurfaceOpacity, SurfacePoint, TexelSums,
    TexelWrap, TexturedOpacity,
};
use pointillist_parallel as parallel;
use pointillist_shade::Model;
use std::borrow::Cow;
use std::cell::Cell;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// What a material looks up in textures. Colour is summed up as colour × opacity, so that the empty
/// part of a leaf's texture does not bleed into its rim.
enum Textured {
    Nothing,
    Color(Lazy<TexelSums<3>>),
    Opacity(Lazy<MaskSums>),
    Masked {
        color: Box<Lazy<MaskedColor>>,
        /// By itself: shadows ask for it often, and for nothing else.
        opacity: Lazy<MaskSums>,
    },
    /// Both, in different places of the surface: texels of the one have no texel of the other.
    Apart {
        color: Box<Lazy<TexelSums<3>>>,
        opacity: Lazy<MaskSums>,
    },
}

/// Where the textures of colour and of opacity lie.
#[derive(Clone, Copy)]
struct Places {
    color: MapPlace,
    opacity: MapPlace,
}

/// Colour under a mask of opacity.
struct MaskedColor {
    /// Colour × opacity, and opacity.
    premultiplied: TexelSums<4>,
    /// Smallest and largest colour of a texel that is not empty.
    range: (Vec3, Vec3),
    /// Mean colour of the whole map by its mask.
    mean: Vec3,
}

/// A region of less mean opacity has no colour of its own: its sums of colour are rounding errors.
const EMPTY: f32 = 1e-6;

impl MaskedColor {
    fn new(color: &Texture, mask: &Texture, wrap: TexelWrap) -> Result<Self, MicropointError> {
        let (width, height) = (color.width.max(mask.width), color.height.max(mask.height));
        let at = |t: &Texture, x: u32, y: u32| {
            let scale = |v: u32, from: u32, to: u32| match from == to {
                true => v,
                false => (u64::from(v) * u64::from(to) / u64::from(from)) as u32,
            };
            t.texel(scale(x, width, t.width), scale(y, height, t.height))
        };
        let range = Cell::new((Vec3::INFINITY, Vec3::ZERO));
        let premultiplied = sums_of([color, mask], [width, height], wrap, |x, y| {
            let alpha = at(mask, x, y).w;
            if alpha == 0.0 {
                return [0.0; 4];
            }
            let color = at(color, x, y).truncate();
            range.set((range.get().0.min(color), range.get().1.max(color)));
            (color * alpha).extend(alpha).to_array()
        })?;
        let range = range.get();
        let whole = Vec4::from_array(premultiplied.whole_mean().map(|v| v as f32));
        let mean = if whole.w > 0.0 { whole.truncate() / whole.w } else { Vec3::ZERO };
        Ok(Self { premultiplied, range, mean })
    }

    /// The colour of a region from its sum of colour × opacity and of opacity.
    fn straight(&self, sum: Vec4) -> Vec3 {
        if sum.w <= EMPTY {
            // Under the paper's rule, regions have the mean opacity of their whole part: only holes may lie in one.
            return self.mean;
        }
        (sum.truncate() / sum.w).max(self.range.0).min(self.range.1)
    }
}

impl Places {
    fn of(material: &Material) -> Self {
        Self { color: material.diffuse_place, opacity: material.opacity_place }
    }

    fn are_one(&self) -> bool {
        self.color == self.opacity
    }
}

/// What does not depend on where the triangles are.
struct Still {
    textures: Vec<Arc<Textured>>,
    /// By material, as `textures`.
    places: Vec<Places>,
    uvs: Uvs,
    storage: Storage,
    /// By where triangles are stored.
    surface_of: Vec<u32>,
    surfaces: Vec<SurfaceOpacity>,
    /// By where triangles are stored.
    material_of: Vec<u32>,
    /// For each material; `None` for one of colour and opacity alone.
    details: Vec<Option<DetailMaps>>,
}

/// Materials ready to be looked up, and where their textures lie on the triangles.
pub(crate) struct Surfaces {
    still: Arc<Still>,
    /// Masked triangles that coincide with an earlier one, of the mesh itself and of each of its shapes.
    copies: Vec<Vec<MaskedCopy>>,
    /// By where the triangles are stored that stand for both sides of a masked card; those of shapes are numbered as these are.
    other_sides: HashMap<u32, OtherSide>,
}

impl Surfaces {
    pub(crate) fn new(scene: &Scene) -> Result<Self, MicropointError> {
        let (textures, details) =
            parallel::join(|| textured_by_material(scene), || details_by_material(scene));
        let (textures, details) = (textures?, details?);
        let (surfaces, surface_of) = surfaces_by_material(scene, &textures);
        let any_detail = details.iter().flatten().any(DetailMaps::any);
        let any_texture = any_detail || textures.iter().any(|t| !matches!(**t, Textured::Nothing));
        let uvs = if any_texture { Uvs::new(&scene.mesh) } else { Uvs::default() };
        let material_of = scene.mesh.stores().flat_map(|mesh| &mesh.material_of).copied().collect();
        let storage = scene.mesh.storage();
        let places = scene.materials.iter().map(Places::of).collect();
        let still = Still { textures, places, uvs, storage, surface_of, surfaces, material_of, details };
        Ok(Self::of_places(scene, Arc::new(still)))
    }

    /// The same for triangles in other places: textures stay summed up.
    pub(crate) fn moved(&self, scene: &Scene) -> Self {
        Self::of_places(scene, self.still.clone())
    }

    fn of_places(scene: &Scene, still: Arc<Still>) -> Self {
        let (mut copies, mut sides, mut first) = (vec![], HashMap::new(), 0);
        for mesh in scene.mesh.stores() {
            let masked = |t: usize| {
                let number = still.surface_of[first + t];
                let surface = &still.surfaces[number as usize];
                (surface.textured_opacity && surface.two_sided).then_some(number)
            };
            let own = masked_copies(mesh, |t| still.uvs.stored(first + t), masked);
            let stored = other_sides(mesh, &own).into_iter().map(|(t, side)| (t + first as u32, side));
            sides.extend(stored);
            copies.push(own);
            first += mesh.triangles.len();
        }
        Self { still, copies, other_sides: sides }
    }

    /// The triangle in the place of this one that is turned the other way, if it is a card of two sides.
    pub(crate) fn other_side(&self, triangle: u32) -> Option<OtherSide> {
        if self.other_sides.is_empty() {
            return None;
        }
        let (index, order) = self.still.storage.find(triangle);
        let side = self.other_sides.get(&(index as u32))?;
        // `order` is its own inverse.
        let corners = order.map(|k| order[side.corners[k]]);
        Some(OtherSide { ahead: side.ahead, corners })
    }

    pub(crate) fn geometry(&self, scene: &Scene) -> Result<Geometry, MicropointError> {
        self.geometry_of(scene, None)
    }

    /// Everything but one object. Triangles keep their numbers.
    pub(crate) fn geometry_without(&self, scene: &Scene, object: u32) -> Result<Geometry, MicropointError> {
        self.geometry_of(scene, Some(object))
    }

    /// The triangles of all objects but one, less copies of masked ones.
    fn geometry_of(&self, scene: &Scene, without: Option<u32>) -> Result<Geometry, MicropointError> {
        let mesh = &scene.mesh;
        let own = triangles_shown(mesh, &self.copies[0], |t| Some(mesh.object_of[t]) != without);
        let (own_surfaces, mut surface_of) = self.still.surface_of.split_at(mesh.triangles.len());
        let mut places = vec![vec![]; mesh.shapes().len()];
        for (number, instance) in mesh.instances().iter().enumerate() {
            if Some(instance.object) != without {
                let world_from_shape = instance.world_from_shape;
                let place = Placement { world_from_shape, first_id: mesh.first_of(number) };
                places[instance.shape as usize].push(place);
            }
        }
        let shown = mesh.shapes().iter().zip(&self.copies[1..]);
        let shown: Vec<_> = shown.map(|(shape, copies)| triangles_shown(shape, copies, |_| true)).collect();
        let shapes = mesh.shapes().iter().zip(&shown).zip(&places).map(|((shape, triangles), places)| {
            let (own, others) = surface_of.split_at(triangles.len());
            surface_of = others;
            Shape { positions: &shape.positions, triangles, surface_of: own, places }
        });
        let shapes: Vec<_> = shapes.collect();
        let world =
            Shape { positions: &mesh.positions, triangles: &own, surface_of: own_surfaces, places: &[] };
        Geometry::with_instances(&world, &self.still.surfaces, &shapes)
    }

    fn material(&self, triangle: u32) -> usize {
        self.still.material_of[self.still.storage.index(triangle)] as usize
    }

    /// The maps of a triangle's material beyond colour and opacity; `None` if it has nothing beyond them.
    pub(crate) fn details(&self, triangle: u32) -> Option<&DetailMaps> {
        self.still.details[self.material(triangle)].as_ref()
    }

    /// Where textures lie on the triangles.
    pub(crate) fn uvs(&self) -> &Uvs {
        &self.still.uvs
    }

    fn textured(&self, triangle: u32) -> &Textured {
        &self.still.textures[self.material(triangle)]
    }

    fn places(&self, triangle: u32) -> &Places {
        &self.still.places[self.material(triangle)]
    }

    /// Whether the colour of a triangle varies.
    pub(crate) fn has_color(&self, triangle: u32) -> bool {
        !matches!(self.textured(triangle), Textured::Nothing | Textured::Opacity(_))
    }

    /// Whether the opacity of a triangle varies.
    pub(crate) fn is_masked(&self, triangle: u32) -> bool {
        self.mask(triangle).is_some()
    }

    fn mask(&self, triangle: u32) -> Option<&MaskSums> {
        match self.textured(triangle) {
            Textured::Nothing | Textured::Color(_) => None,
            Textured::Opacity(mask)
            | Textured::Masked { opacity: mask, .. }
            | Textured::Apart { opacity: mask, .. } => Some(mask),
        }
    }

    /// Whether a triangle has any map.
    pub(crate) fn varies(&self, triangle: u32) -> bool {
        !matches!(self.textured(triangle), Textured::Nothing)
            || self.details(triangle).is_some_and(DetailMaps::any)
    }

    fn plain_color(&self, triangle: u32, polygon: &[SurfacePoint], sums: &TexelSums<3>) -> Vec3 {
        let place = &self.places(triangle).color;
        Vec3::from_array(self.still.uvs.mean(triangle, polygon, sums, place).map(|v| v as f32))
    }

    /// The factor on a triangle's diffuse albedo: the mean colour over a polygon of it, weighted by the mask's opacity if there is one.
    pub(crate) fn color(&self, triangle: u32, polygon: &[SurfacePoint]) -> Vec3 {
        match self.textured(triangle) {
            Textured::Nothing | Textured::Opacity(_) => Vec3::ONE,
            Textured::Color(sums) => self.plain_color(triangle, polygon, sums),
            Textured::Apart { color, .. } => self.plain_color(triangle, polygon, color),
            Textured::Masked { color, .. } => {
                let place = &self.places(triangle).color;
                let mean = self.still.uvs.mean(triangle, polygon, &color.premultiplied, place);
                let mean = mean.map(|v| v as f32);
                color.straight(Vec4::from_array(mean))
            }
        }
    }
}

impl TexturedOpacity for Surfaces {
    fn mean_opacity(&self, triangle: u32, polygon: &[SurfacePoint]) -> f32 {
        self.mask(triangle).map_or(1.0, |mask| {
            self.still.uvs.mean_of_mask(triangle, polygon, mask, &self.places(triangle).opacity) as f32
        })
    }

    fn rough_opacity(&self, triangle: u32, polygon: &[SurfacePoint]) -> f32 {
        self.mask(triangle).map_or(1.0, |mask| {
            self.still.uvs.rough_mean_of_mask(triangle, polygon, mask, &self.places(triangle).opacity) as f32
        })
    }

    fn even_opacity(&self, triangle: u32, polygon: &[SurfacePoint]) -> Option<f32> {
        self.mask(triangle).map_or(Some(1.0), |mask| {
            let place = &self.places(triangle).opacity;
            self.still.uvs.uniform_mean_of_mask(triangle, polygon, mask, place).map(|mean| mean as f32)
        })
    }
}

/// A surface for each material and each kind of object.
fn surfaces_by_material(scene: &Scene, textures: &[Arc<Textured>]) -> (Vec<SurfaceOpacity>, Vec<u32>) {
    let mut surfaces = Vec::with_capacity(2 * scene.materials.len());
    for (m, t) in scene.materials.iter().zip(textures) {
        let textured_opacity = !matches!(**t, Textured::Nothing | Textured::Color(_));
        let opacity = m.surface.opacity;
        surfaces.push(SurfaceOpacity { opacity, textured_opacity, two_sided: true });
        surfaces.push(SurfaceOpacity { opacity, textured_opacity, two_sided: false });
    }
    let two_sided = |mesh: &Mesh, t: usize, m: u32| {
        let object = mesh.objects.get(mesh.object_of[t] as usize);
        object.is_none_or(|o| o.two_sided) && !scene.materials[m as usize].details.one_sided
    };
    let mut surface_of = vec![];
    for mesh in scene.mesh.stores() {
        let surface = |(t, &m): (usize, &u32)| 2 * m + u32::from(!two_sided(mesh, t, m));
        surface_of.extend(mesh.material_of.iter().enumerate().map(surface));
    }
    (surfaces, surface_of)
}

/// A mesh's own triangles: those that are shown, less copies of masked ones. The others have no area: they are never seen, and the rest keeps
/// its numbers.
fn triangles_shown<'a>(
    mesh: &'a Mesh,
    copies: &[MaskedCopy],
    shown: impl Fn(usize) -> bool,
) -> Cow<'a, [[u32; 3]]> {
    let mut triangles = Cow::Borrowed(&mesh.triangles[..]);
    // Of masked triangles that coincide, the first that is shown stays.
    let mut standing = HashSet::new();
    let hides = |copy: &&MaskedCopy| {
        shown(copy.triangle as usize) && (shown(copy.original as usize) || !standing.insert(copy.original))
    };
    let hidden = (0..mesh.triangles.len()).filter(|&t| !shown(t)).map(|t| t as u32);
    for t in hidden.chain(copies.iter().filter(hides).map(|copy| copy.triangle)) {
        let triangle = &mut triangles.to_mut()[t as usize];
        *triangle = [triangle[0]; 3];
    }
    triangles
}

fn textured_by_material(scene: &Scene) -> Result<Vec<Arc<Textured>>, MicropointError> {
    let mut numbers = HashMap::new();
    let mut different = vec![];
    let mut number_of = Vec::with_capacity(scene.materials.len());
    for m in &scene.materials {
        let number = *numbers
            .entry((m.diffuse_map, m.opacity_map, m.wrap, Places::of(m).are_one()))
            .or_insert_with(|| {
                different.push(m);
                different.len() - 1
            });
        number_of.push(number);
    }
    let sums =
        parallel::map_heavy(different.len(), |i| textured(different[i], &scene.textures).map(Arc::new));
    let sums: Vec<Arc<Textured>> = sums.into_iter().collect::<Result<_, _>>()?;
    Ok(number_of.into_iter().map(|number| sums[number].clone()).collect())
}

fn details_by_material(scene: &Scene) -> Result<Vec<Option<DetailMaps>>, MicropointError> {
    let table = DetailTable::new(scene)?;
    let maps = |m: &Material| {
        let beyond = m.details != Details::default() || m.surface.model == Model::Ggx;
        beyond.then(|| table.maps(m))
    };
    Ok(scene.materials.iter().map(maps).collect())
}

fn textured(material: &Material, textures: &[Texture]) -> Result<Textured, MicropointError> {
    let wrap = texel_wrap(material.wrap);
    let texture = |map: Option<usize>| map.map(|i| &textures[i]);
    let opacity = |mask: &Texture| when_needed([mask], move |[mask]| opacity_sums(mask, wrap));
    // A mask that hides nothing would keep surfaces from hiding what is behind them, and costs its means.
    let mask = texture(material.opacity_map).filter(|mask| !mask.texels.are_opaque());
    Ok(match (texture(material.diffuse_map), mask) {
        (None, None) => Textured::Nothing,
        (Some(color), None) => Textured::Color(when_needed([color], move |[color]| color_sums(color, wrap))?),
        (None, Some(mask)) => Textured::Opacity(opacity(mask)?),
        (Some(color), Some(mask)) if !Places::of(material).are_one() => Textured::Apart {
            color: Box::new(when_needed([color], move |[color]| color_sums(color, wrap))?),
            opacity: opacity(mask)?,
        },
        (Some(color), Some(mask)) => {
            let make = move |[color, mask]: [&Texture; 2]| MaskedColor::new(color, mask, wrap);
            Textured::Masked { color: Box::new(when_needed([color, mask], make)?), opacity: opacity(mask)? }
        }
    })
}
