//! A frame, from the cloud to the picture.

use crate::accumulate::{self, BandScratch, BlockView, Rules};
use crate::buffer::{Buffer, DepthScale};
use crate::cloud::Cloud;
use crate::cull;
use crate::error::IbprError;
use crate::eye_dome;
use crate::faces::{self, FaceRules};
use crate::fill::{self, FillScratch};
use crate::frame::{Frame, FrameCounts};
use crate::normals;
use crate::options::{Options, Passes, Scale};
use crate::parallel::*;
use crate::raster::{Paint, Strip};
use crate::shade::Shader;
use crate::view::{BufferMap, View};
use glam::Vec3;

/// Rows of the picture that are drawn together: their surfaces fit into the second-level cache.
const STRIP_ROWS: usize = 32;

/// Draws frames. Keeps its working memory, so that later frames do not allocate.
#[derive(Debug, Default)]
pub struct Renderer {
    visible: Vec<u32>,
    depths: Vec<(f64, usize)>,
    passes: [Pass; 2],
    bands: Pool<BandScratch>,
    strips: Pool<[Strip; 2]>,
    fill: FillScratch,
}

/// One buffer and what it was made from.
#[derive(Debug, Default)]
struct Pass {
    views: Vec<BlockView>,
    buffer: Buffer,
    noise: normals::Histogram,
}

impl Renderer {
    /// A renderer without memory.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Draws `cloud` into `frame`.
    ///
    /// The same for every order of scans and points, and for every number of threads, bit for bit.
    ///
    /// # Errors
    /// [`IbprError::BadOption`].
    pub fn draw(
        &mut self,
        cloud: &Cloud,
        view: &View,
        options: &Options,
        frame: &mut Frame,
    ) -> Result<(), IbprError> {
        options.check()?;
        let mut counts = FrameCounts::default();
        cull::visible(cloud, view, options.culling, &mut self.visible, &mut counts);
        counts.scale = self.scale(cloud, view, options);
        self.bands.fill(threads());
        self.strips.fill(threads());
        let reference = reference_depth(cloud, view);
        let normal = BufferMap::new(view, counts.scale, reference, cloud.unit);
        let maps = match options.passes {
            Passes::One => [Some(normal), None],
            Passes::Two { finer } => {
                let scale = (counts.scale * f64::from(finer)).max(1.0);
                [Some(BufferMap::new(view, scale, reference, cloud.unit)), Some(normal)]
            }
        };
        for (pass, map) in self.passes.iter_mut().zip(&maps) {
            let Some(map) = map else { continue };
            pass.make(cloud, &self.visible, map, options, &self.bands, &mut self.fill);
        }
        frame.reshape(view.width as usize, view.height as usize, options.surface_layers);
        frame.counts = counts;
        self.draw_faces(cloud, &maps, options, frame);
        if let Some(dome) = &options.eye_dome {
            eye_dome::apply(frame, dome);
        }
        Ok(())
    }

    /// Picture pixels per buffer pixel.
    fn scale(&mut self, cloud: &Cloud, view: &View, options: &Options) -> f64 {
        let factor = match options.scale {
            Scale::Fixed(s) => return f64::from(s),
            Scale::Auto(factor) => f64::from(factor),
        };
        // The median depth of the points in view: few points at the lens must not blur the rest.
        self.depths.clear();
        let blocks = self.visible.iter().map(|&i| &cloud.blocks[i as usize]);
        self.depths.extend(blocks.map(|b| (view.depth_of(b.origin), b.points.len())));
        self.depths.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let half = self.depths.iter().map(|d| d.1).sum::<usize>() / 2;
        let mut seen = 0;
        let median = self.depths.iter().find(|d| {
            seen += d.1;
            seen > half
        });
        let Some((depth, _)) = median else { return 1.0 };
        let spacing_px = cloud.density_spacing() * view.pixels_per_unit(depth.max(reference_depth(cloud, view) * 0.01));
        (factor * spacing_px).clamp(1.0, f64::from(view.width.max(view.height)))
    }

    fn draw_faces(&self, cloud: &Cloud, maps: &[Option<BufferMap>; 2], options: &Options, frame: &mut Frame) {
        let painted = cloud.has_colours() || options.surface_layers;
        let rules = [0, 1].map(|i| maps[i].as_ref().map(|map| face_rules(cloud, map, options, i == 1, painted)));
        let Some(map) = &maps[0] else { return };
        let shader = Shader::new(map, options);
        let width = frame.width;
        let n = STRIP_ROWS * width;
        let coloured = cloud.has_colours();
        let draw = |i: usize, out: &mut RowsOut<'_>| {
            self.strips.with(|[first, second]| {
                let (first_row, rows) = (i * STRIP_ROWS, out.depth.len() / width);
                for (k, strip) in [&mut *first, &mut *second].into_iter().enumerate() {
                    if let Some(rules) = &rules[k] {
                        strip.begin(width, first_row, rows, painted);
                        faces::draw(&self.passes[k].buffer, rules, strip);
                    }
                }
                if let Some(rules) = &rules[1] {
                    draw_over(first, second, &rules.scale);
                }
                finish(first, &shader, coloured, out);
            });
        };
        let base = chunks(&mut frame.colour, n).zip(chunks(&mut frame.depth, n));
        if options.surface_layers {
            base.zip(chunks(&mut frame.normal, n)).zip(chunks(&mut frame.count, n)).enumerate().for_each(
                |(i, (((colour, depth), normal), count))| {
                    draw(i, &mut RowsOut { colour, depth, surface: Some((normal, count)) });
                },
            );
        } else {
            base.enumerate().for_each(|(i, (colour, depth))| {
                draw(i, &mut RowsOut { colour, depth, surface: None });
            });
        }
    }
}

impl Pass {
    fn make(
        &mut self,
        cloud: &Cloud,
        visible: &[u32],
        map: &BufferMap,
        options: &Options,
        bands: &Pool<BandScratch>,
        fill: &mut FillScratch,
    ) {
        accumulate::view_blocks(cloud, visible, map, &mut self.views);
        self.buffer.reshape(map);
        let scale = DepthScale::new(map, cloud.spacing());
        let rules = Rules { gamma: options.gamma, weighting: options.weighting, scale };
        accumulate::accumulate(cloud, &self.views, map, rules, &mut self.buffer, bands);
        fill::pull_push(&mut self.buffer, &scale, options.fill, fill);
        normals::make_corners(&mut self.buffer, map, &scale, options.normals, &mut self.noise);
    }
}

/// Depth of the middle of the cloud; never at or behind the eye.
fn reference_depth(cloud: &Cloud, view: &View) -> f64 {
    let (low, high) = cloud.bounds();
    let extent = (high - low).length();
    let depth = view.depth_of(0.5 * low + 0.5 * high);
    depth.max(0.01 * extent).max(f64::MIN_POSITIVE * 1e16)
}

fn face_rules(cloud: &Cloud, map: &BufferMap, options: &Options, second: bool, painted: bool) -> FaceRules {
    let (x, y) = map.centre();
    FaceRules {
        scale: DepthScale::new(map, cloud.spacing()),
        // The second pass fills; the outline is the first one's.
        outline_px: if second { 0.0 } else { (f64::from(options.outline) * map.scale) as f32 },
        focal: map.focal() as f32,
        reference: map.reference as f32,
        centre: (x as f32, y as f32),
        perspective: map.view.is_perspective(),
        pixel: map.scale as f32,
        painted,
        sparse_only: second,
    }
}

/// Puts the coarser pass over the finer one, except where that shows another surface in front.
fn draw_over(fine: &mut Strip, coarse: &Strip, scale: &DepthScale) {
    for (i, (under, over)) in fine.solid.iter_mut().zip(&coarse.solid).enumerate() {
        let together = || over[0] < under[0] + scale.bent_step(over[0], normals::STEP);
        if over[0] < f32::INFINITY && together() {
            *under = *over;
            if let Some(paint) = fine.solid_paint.get_mut(i) {
                *paint = coarse.solid_paint[i];
            }
        }
    }
}

/// Rows of the frame.
struct RowsOut<'a> {
    colour: &'a mut [[f32; 4]],
    depth: &'a mut [f32],
    surface: Option<(&'a mut [[f32; 3]], &'a mut [f32])>,
}

/// Shades a strip: the rim over what is behind it.
fn finish(strip: &Strip, shader: &Shader, coloured: bool, out: &mut RowsOut<'_>) {
    let shade = |i: usize, surface: &[f32; 4], paint: &[Paint]| {
        let n = Shader::normal(surface);
        let colour = coloured.then(|| Vec3::from_slice(&paint[i][..3]));
        let (x, y) = (i % strip.width, strip.first_row + i / strip.width);
        (shader.colour(x, y, n, colour), n)
    };
    for i in 0..out.depth.len() {
        let (solid, cover) = (&strip.solid[i], strip.rim_cover[i]);
        let has_solid = solid[0] < f32::INFINITY;
        let has_rim = cover > 0.0 && strip.rim[i][0] < solid[0];
        if !(has_solid || has_rim) {
            (out.colour[i], out.depth[i]) = ([0.0; 4], f32::INFINITY);
            if let Some((normal, count)) = &mut out.surface {
                (normal[i], count[i]) = ([0.0; 3], 0.0);
            }
            continue;
        }
        let mut colour = [0.0; 4];
        let mut put = |c: Vec3, share: f32| {
            let c = c * share;
            colour = [colour[0] + c.x, colour[1] + c.y, colour[2] + c.z, colour[3] + share];
        };
        // Depth and normal are those of the surface that covers more.
        let mut nearest = (f32::INFINITY, Vec3::ZERO, 0.0);
        let points = |paint: &[Paint]| paint.get(i).map_or(0.0, |p| p[3]);
        if has_solid {
            let (c, n) = shade(i, solid, &strip.solid_paint);
            put(c, if has_rim { 1.0 - cover } else { 1.0 });
            nearest = (solid[0], n, points(&strip.solid_paint));
        }
        if has_rim {
            let (c, n) = shade(i, &strip.rim[i], &strip.rim_paint);
            put(c, cover);
            if cover >= 0.5 || !has_solid {
                nearest = (strip.rim[i][0], n, points(&strip.rim_paint));
            }
        }
        let shown = has_solid || cover >= 0.5;
        out.colour[i] = colour;
        out.depth[i] = if shown { shader.depth(nearest.0) } else { f32::INFINITY };
        if let Some((normal, count)) = &mut out.surface {
            normal[i] = if shown { shader.world(nearest.1).to_array() } else { [0.0; 3] };
            count[i] = if shown { nearest.2 } else { 0.0 };
        }
    }
}
