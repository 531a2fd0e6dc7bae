//! The paper's procedure: z-buffers of discs, links in the pixels of their centres, and a filter over the pixels
//! between.
//!
//! Discs have hard edges and the radius r₀, or r = r₀ + d·|l − f| with depth of field (l: depth of the disc, f: depth
//! in focus).
//!
//! 1. Two z-buffers are drawn, one with r₀ and one with r. A disc whose centre is not hidden in the first leaves a link
//!    in the pixel of its centre.
//! 2. A covered pixel without a link is a hole: it gets the mean of the links within the radius of the disc that covers
//!    it, weighted with a Gaussian. Pixels that are out of focus are filtered in the same way. Where the two z-buffers
//!    differ, surfaces at different depths meet, and every link is weighted with the Gaussian of its own radius.
//!
//! Departures: blurred pixels are as opaque as the share of the filter that the first z-buffer covers (the paper's
//! figures have no background to tell), and a disc is never so small that it misses all pixel centres. Points with
//! opacities have their mean, as of colors; nothing is seen behind them, since the z-buffers know one surface.

use crate::camera::Camera;
use crate::frame::Band;
use crate::grid::{HEIGHT, TileRect};
use crate::kernel;
use crate::layer::{LANES, Layer, PITCH, Touched};
use crate::project::Projector;
use crate::scene::Scene;
use crate::select::Selected;
use crate::splat::{Shape, Splat};
use crate::splats::Splats;
use glam::Vec3;

/// The filter's radius is this many of its standard deviations.
const DEVIATIONS: f32 = 2.0;

/// A disc that is blurred by less is sharp.
const LEAST_BLUR_PX: f32 = 0.25;

/// Largest radius of the filter in pixels: its time grows with the square.
const WIDEST_PX: f32 = 64.0;

/// A disc in the pixel of its centre.
#[derive(Clone, Copy, Debug)]
struct PaperLink {
    /// +∞ if there is none.
    depth: f32,
    /// With depth of field, pixels.
    radius: f32,
    normal: Vec3,
    /// Shaded, premultiplied by the opacity.
    color: Vec3,
    opacity: f32,
}

impl PaperLink {
    const NONE: Self =
        Self { depth: f32::INFINITY, radius: 0.0, normal: Vec3::ZERO, color: Vec3::ZERO, opacity: 0.0 };

    fn of(s: &Splat) -> Self {
        Self {
            depth: s.depth,
            radius: s.sharpness,
            normal: s.normal.into(),
            color: s.color.into(),
            opacity: s.opacity,
        }
    }
}

/// A pixel between the two steps.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PaperPixel {
    /// Nearest depth of discs with r₀ and with r.
    near: [f32; 2],
    /// Of the disc that is nearest with r: its radius in pixels, and whether it is blurred.
    radius: f32,
    link: PaperLink,
}

impl PaperPixel {
    const EMPTY: Self = Self { near: [f32::INFINITY; 2], radius: 0.0, link: PaperLink::NONE };
}

/// Working memory for tiles.
pub(crate) struct PaperTile {
    projector: Box<Projector>,
    splats: Splats,
    layer: Layer,
}

impl Default for PaperTile {
    fn default() -> Self {
        Self { projector: Projector::new(), splats: Splats::default(), layer: Layer::new() }
    }
}

impl PaperTile {
    /// Step 1: z-buffers and links of one tile into `cells`, whose rows are `width` long.
    pub(crate) fn project(
        &mut self,
        scene: &Scene<'_>,
        rect: &TileRect,
        nodes: &[Selected],
        (cells, width): (&mut [PaperPixel], usize),
    ) {
        let at = |row: usize, column: usize| row * width + rect.x + column;
        for row in 0..rect.height {
            cells[at(row, 0)..at(row, rect.width)].fill(PaperPixel::EMPTY);
        }
        // Without depth of field both z-buffers are the same.
        let second = (scene.camera.blur > 0.0).then_some(Shape::WIDENED_DISC);
        for (k, shape) in [Some(Shape::DISC), second].into_iter().flatten().enumerate() {
            self.splats.clear();
            for selected in nodes {
                self.projector.project(scene, selected, &shape, rect, &mut self.splats);
            }
            self.layer.clear_near(&Touched::ALL);
            kernel::nearest(&mut self.layer, self.splats.as_slice(), kernel::HARD);
            kernel::sharpness_of_nearest(&mut self.layer, self.splats.as_slice());
            for row in 0..rect.height {
                for column in 0..rect.width {
                    let cell = &mut cells[at(row, column)];
                    let (block, lane) = (row * PITCH + column / LANES, column % LANES);
                    cell.near[k..].fill(self.layer.depths[block].near[lane]);
                    cell.radius = self.layer.sums[block].0[0][lane];
                }
            }
        }
        // The splats are those with r, which is the radius of a link's filter.
        for s in self.splats.as_slice() {
            let (x, y) = (s.x.floor(), s.y.floor());
            let inside = x >= 0.0 && y >= 0.0 && x < rect.width as f32 && y < rect.height as f32;
            if !inside {
                continue;
            }
            let (column, row) = (x as usize, y as usize);
            let cell = &mut cells[at(row, column)];
            if s.depth <= cell.near[0] + s.thickness && s.depth < cell.link.depth {
                cell.link = PaperLink::of(s);
            }
        }
    }
}

/// Step 2: filters all pixels of a band.
pub(crate) fn reconstruct(scene: &Scene<'_>, cells: &[PaperPixel], band: &mut Band<'_>) {
    match scene.cloud.has_opacities() {
        true => filter_band::<true>(scene, cells, band),
        false => filter_band::<false>(scene, cells, band),
    }
}

/// Opacities are looked at if the cloud is `CLEAR`.
fn filter_band<const CLEAR: bool>(scene: &Scene<'_>, cells: &[PaperPixel], band: &mut Band<'_>) {
    let width = band.width;
    let height = cells.len() / width;
    for row in 0..band.rows() {
        for column in 0..width {
            let i = row * width + column;
            let filter = Filter::new(scene, cells, (width, height), (column, band.first_row + row));
            let filtered = filter.run::<CLEAR>();
            let [r, g, b] = (filtered.color * filtered.covered).to_array();
            let alpha = filtered.covered * filtered.opacity;
            band.color[i] = [r, g, b, alpha];
            let shown = alpha >= 0.5;
            band.depth[i] = if shown { scene.camera.world_depth(filtered.depth) } else { f32::INFINITY };
            if let Some(normals) = &mut band.normal {
                normals[i] = if shown { scene.shader.in_world(filtered.normal) } else { [0.0; 3] };
            }
        }
    }
    band.drawn.fill(true);
}

struct Filtered {
    /// Premultiplied by the opacity.
    color: Vec3,
    opacity: f32,
    normal: Vec3,
    depth: f32,
    covered: f32,
}

impl Filtered {
    /// Of one link, all over the pixel.
    fn of(link: &PaperLink, depth: f32) -> Self {
        Self { color: link.color, opacity: link.opacity, normal: link.normal, depth, covered: 1.0 }
    }
}

/// The filter over one pixel.
struct Filter<'a> {
    camera: &'a Camera,
    cells: &'a [PaperPixel],
    size: (usize, usize),
    at: (usize, usize),
}

impl<'a> Filter<'a> {
    fn new(scene: &'a Scene<'_>, cells: &'a [PaperPixel], size: (usize, usize), at: (usize, usize)) -> Self {
        Self { camera: &scene.camera, cells, size, at }
    }

    fn run<const CLEAR: bool>(&self) -> Filtered {
        let cell = &self.cells[self.at.1 * self.size.0 + self.at.0];
        let depth = if cell.near[0] < f32::INFINITY { cell.near[0] } else { cell.near[1] };
        let blank = Filtered { color: Vec3::ZERO, opacity: 0.0, normal: Vec3::ZERO, depth, covered: 0.0 };
        if depth == f32::INFINITY {
            return blank;
        }
        let blurred = self.camera.blur_px(depth) > LEAST_BLUR_PX;
        let link = &cell.link;
        let thickness = self.camera.bent_length(cell.radius, depth);
        let differ = (cell.near[0] - cell.near[1]).abs() > thickness || cell.near[0] == f32::INFINITY;
        if link.depth < f32::INFINITY && !blurred && !differ {
            return Filtered::of(link, depth);
        }
        let radius = cell.radius.clamp(1.0, WIDEST_PX);
        let mut sums = Sums::default();
        self.neighbours(radius, |other, distance2| {
            let own = if differ { other.link.radius.clamp(1.0, WIDEST_PX) } else { radius };
            let weight = gaussian(distance2, own);
            let open = gaussian(distance2, radius);
            sums.all += open;
            sums.covered += if other.near[0] < f32::INFINITY { open } else { 0.0 };
            // Not from another surface behind or before, where only one is meant.
            let same = differ || (other.link.depth - depth).abs() <= thickness;
            if other.link.depth < f32::INFINITY && same {
                sums.add::<CLEAR>(&other.link, weight);
            }
        });
        if sums.weight == 0.0 {
            // No link in reach: a covered pixel stays opaque.
            return self.nearest_link(radius, depth).unwrap_or(blank);
        }
        let covered = if blurred || differ { sums.covered / sums.all } else { 1.0 };
        let (color, normal) = (sums.color / sums.weight, sums.normal / sums.weight);
        let opacity = if CLEAR { sums.opacity / sums.weight } else { 1.0 };
        Filtered { color, opacity, normal, depth, covered }
    }

    /// Calls `each` with all pixels within `radius` and their squared distances.
    fn neighbours(&self, radius: f32, mut each: impl FnMut(&PaperPixel, f32)) {
        let reach = radius.ceil() as usize;
        let range = |at: usize, size: usize| at.saturating_sub(reach)..(at + reach + 1).min(size);
        for y in range(self.at.1, self.size.1) {
            let dy = y as f32 - self.at.1 as f32;
            for x in range(self.at.0, self.size.0) {
                let dx = x as f32 - self.at.0 as f32;
                let distance2 = dx * dx + dy * dy;
                if distance2 <= radius * radius {
                    each(&self.cells[y * self.size.0 + x], distance2);
                }
            }
        }
    }

    /// The nearest link within twice the radius.
    fn nearest_link(&self, radius: f32, depth: f32) -> Option<Filtered> {
        let mut nearest: Option<(f32, PaperLink)> = None;
        self.neighbours(2.0 * radius + 1.0, |other, distance2| {
            let is_nearer = nearest.is_none_or(|(best, _)| distance2 < best);
            if other.link.depth < f32::INFINITY && is_nearer {
                nearest = Some((distance2, other.link));
            }
        });
        nearest.map(|(_, link)| Filtered::of(&link, depth))
    }
}

fn gaussian(distance2: f32, radius: f32) -> f32 {
    let deviation = radius / DEVIATIONS;
    if distance2 > radius * radius { 0.0 } else { (-0.5 * distance2 / (deviation * deviation)).exp() }
}

#[derive(Default)]
struct Sums {
    weight: f32,
    color: Vec3,
    opacity: f32,
    normal: Vec3,
    /// Of the filter: all, and where there is surface.
    all: f32,
    covered: f32,
}

impl Sums {
    fn add<const CLEAR: bool>(&mut self, link: &PaperLink, weight: f32) {
        self.weight += weight;
        self.color += link.color * weight;
        if CLEAR {
            self.opacity += link.opacity * weight;
        }
        self.normal += link.normal * weight;
    }
}

/// Makes room for a frame.
pub(crate) fn reshape(cells: &mut Vec<PaperPixel>, width: usize, height: usize) {
    cells.resize(width * height, PaperPixel::EMPTY);
}

/// Rows of cells for each band of tiles.
pub(crate) fn rows(cells: &mut [PaperPixel], width: usize) -> impl Iterator<Item = &mut [PaperPixel]> {
    cells.chunks_mut(width * HEIGHT)
}
