//! A frame, from the cloud to the picture.

use crate::accumulate::{self, BandScratch};
use crate::block_view::{self, BlockView};
use crate::border::MARGIN;
use crate::buffer::{Buffer, DepthScale, STEP};
use crate::buffer_map::{BufferMap, depth_of};
use crate::cloud::Cloud;
use crate::cull;
use crate::error::IbprError;
use crate::eye_dome;
use crate::faces::{self, FaceRules};
use crate::fill::{self, FillScratch};
use crate::frame::{Frame, FrameCounts};
use crate::noise::Histogram;
use crate::normals;
use crate::options::{Culling, Normals, Options, Passes, Scale};
use crate::outline::Outlines;
use crate::parallel::*;
use crate::pixels::{Nearest, Stack};
use crate::raster::{Pixels, Strip};
use crate::rules::Rules;
use crate::seams;
use crate::shade::{RowsOut, Shader};
use crate::stray;
use crate::wanted::Wanted;
use glam::Vec3;
use pointillist_parallel::{Pool, threads};
use pointillist_view::{Projection, View};
use std::ops::Range;

/// Rows of the picture that are drawn together: their surfaces fit into the second-level cache.
const STRIP_ROWS: usize = 32;

/// The same for translucent frames, which keep several surfaces per pixel.
const STACK_ROWS: usize = 16;

/// Factor on the size of buffer pixels in translucent frames: gaps show the layer behind, and only the narrowest are
/// filled there. Found by experiment on a scanned sphere.
const SEEN_THROUGH: f64 = 1.6;

/// Draws frames. Keeps its working memory, so that later frames do not allocate.
#[derive(Debug, Default)]
pub struct Renderer {
    visible: Vec<u32>,
    depths: Vec<(f64, usize)>,
    passes: [Pass; 2],
    memory: PassScratch,
    strips: Pool<StripScratch>,
    /// Of each strip, the pixels that a surface covers in part, and nothing behind it.
    lone_rims: Vec<Vec<usize>>,
}

/// Working memory of a pass.
#[derive(Debug, Default)]
struct PassScratch {
    bands: Pool<BandScratch>,
    fill: FillScratch,
}

/// One buffer and what it was made from.
#[derive(Debug, Default)]
struct Pass {
    views: Vec<BlockView>,
    buffer: Buffer,
    noise: Histogram,
    strays: Vec<Vec<(usize, Vec3)>>,
    outlines: Outlines,
}

impl Renderer {
    /// Largest side of a picture in pixels: buffers and frames are kept whole.
    pub const LARGEST_SIDE: u32 = 16384;

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
    /// [`IbprError::TooLarge`] if a side of the picture is above [`Renderer::LARGEST_SIDE`]; [`IbprError::BadOption`].
    pub fn draw(
        &mut self,
        cloud: &Cloud,
        view: &View,
        options: &Options,
        frame: &mut Frame,
    ) -> Result<(), IbprError> {
        let (width, height) = (view.width(), view.height());
        if width.max(height) > Self::LARGEST_SIDE {
            return Err(IbprError::TooLarge { width, height });
        }
        options.check()?;
        let scale = self.scale(cloud, view, options);
        let mut counts = FrameCounts { scale, ..FrameCounts::default() };
        self.memory.bands.fill(threads());
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
        // Translucent surfaces show those behind them, also those that face away.
        let culling = if options.translucency.is_some() { Culling::None } else { options.culling };
        let coarsest = maps.iter().flatten().map(|map| map.scale).fold(0.0, f64::max);
        let margin = MARGIN as f64 * coarsest;
        cull::visible(cloud, view, margin, culling, &mut self.visible, &mut counts);
        let wanted = Wanted::new(options, [width, height]);
        let strip_rows = if options.translucency.is_some() { STACK_ROWS } else { STRIP_ROWS };
        let lit = wanted.with_surroundings(options, [width, height]);
        // With the neighbours that seams are closed by.
        let drawn = lit.wider(1, [width, height]).in_strips(strip_rows, height as usize);
        for (pass, map) in self.passes.iter_mut().zip(&maps) {
            let Some(map) = map else { continue };
            pass.make(cloud, &self.visible, map, options, &drawn, &mut self.memory);
        }
        frame.reshape(width as usize, height as usize, options.surface_layers);
        frame.counts = counts;
        let mut rims = std::mem::take(&mut self.lone_rims);
        rims.resize(frame.height.div_ceil(strip_rows), vec![]);
        rims.iter_mut().for_each(Vec::clear);
        self.draw_faces(cloud, &maps, options, &drawn, (frame, &mut rims));
        let strip = strip_rows * frame.width;
        let of_picture =
            rims.iter().enumerate().flat_map(|(i, rims)| rims.iter().map(move |rim| i * strip + rim));
        seams::close(frame, of_picture, &lit);
        self.lone_rims = rims;
        if let Some(dome) = &options.eye_dome {
            eye_dome::apply(frame, dome, &wanted);
        }
        Ok(())
    }

    /// Picture pixels per buffer pixel.
    fn scale(&mut self, cloud: &Cloud, view: &View, options: &Options) -> f64 {
        let seen_through = if options.translucency.is_some() { SEEN_THROUGH } else { 1.0 };
        let for_spacing = |factor: f32, spacing_px: f64| {
            let widest = f64::from(view.width().max(view.height()));
            (f64::from(factor) * seen_through * spacing_px).clamp(1.0, widest)
        };
        let factor = match options.scale {
            Scale::Fixed(s) => return f64::from(s),
            Scale::Spaced { factor, spacing_px } => return for_spacing(factor, spacing_px.into()),
            Scale::Auto(factor) => factor,
        };
        // The median depth of the points in view, so that few points close to the eye do not coarsen the buffer. Points
        // that face away are included, or culling would change the picture.
        cull::depths(cloud, view, &mut self.depths);
        self.depths.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let half = self.depths.iter().map(|d| d.1).sum::<usize>() / 2;
        let mut seen = 0;
        let median = self.depths.iter().find(|d| {
            seen += d.1;
            seen > half
        });
        let Some((depth, _)) = median else { return 1.0 };
        let spacing_px =
            cloud.density_spacing() * pixels_per_unit(view, depth.max(reference_depth(cloud, view) * 0.01));
        for_spacing(factor, spacing_px)
    }

    fn draw_faces(
        &self,
        cloud: &Cloud,
        maps: &[Option<BufferMap>; 2],
        options: &Options,
        drawn: &Wanted,
        (frame, rims): (&mut Frame, &mut [Vec<usize>]),
    ) {
        let [Some(map), _] = maps else { return };
        let drawing = Drawing {
            passes: &self.passes,
            rules: [0, 1].map(|i| maps[i].as_ref().map(|map| face_rules(cloud, map, options, i == 1))),
            shader: Shader::new(map, options),
            colored: cloud.has_colors(),
            width: frame.width,
            columns: drawn.columns.clone(),
            alpha: options.translucency.map(|t| t.alpha),
        };
        let rows = if drawing.alpha.is_some() { STACK_ROWS } else { STRIP_ROWS };
        let n = rows * frame.width;
        let draw = |i: usize, out: &mut RowsOut<'_>| {
            if !drawn.rows.contains(&(i * rows)) {
                return;
            }
            self.strips.with(|scratch| drawing.strip(scratch, i * rows, out));
        };
        let base = chunks(&mut frame.color, n).zip(chunks(&mut frame.depth, n)).zip(chunks(rims, 1));
        if options.surface_layers {
            base.zip(chunks(&mut frame.normal, n)).zip(chunks(&mut frame.count, n)).enumerate().for_each(
                |(i, ((((color, depth), rims), normal), count))| {
                    let surface = Some((normal, count));
                    draw(i, &mut RowsOut { color, depth, surface, lone_rims: &mut rims[0] });
                },
            );
        } else {
            base.enumerate().for_each(|(i, ((color, depth), rims))| {
                draw(i, &mut RowsOut { color, depth, surface: None, lone_rims: &mut rims[0] });
            });
        }
    }
}

/// Strips of both passes, opaque or translucent.
#[derive(Debug, Default)]
struct StripScratch {
    nearest: [Strip<Nearest>; 2],
    stacks: [Strip<Stack>; 2],
}

/// What all strips of a frame share.
struct Drawing<'a> {
    passes: &'a [Pass; 2],
    rules: [Option<FaceRules>; 2],
    shader: Shader,
    colored: bool,
    width: usize,
    /// Columns that are drawn.
    columns: Range<usize>,
    /// Opacity of translucent surfaces.
    alpha: Option<f32>,
}

impl Drawing<'_> {
    fn strip(&self, scratch: &mut StripScratch, first_row: usize, out: &mut RowsOut<'_>) {
        let painted = self.colored || out.surface.is_some();
        let n = out.depth.len();
        let columns = self.columns_touched(first_row, n / self.width);
        let part = Part { first_row, rows: n / self.width, columns };
        let pixels = || part.pixels(self.width);
        if let Some(alpha) = self.alpha {
            let [first, second] = &mut scratch.stacks;
            self.draw_passes([&mut *first, &mut *second], &part, |s| {
                s.begin(n, self.width, &part.columns);
            });
            if let Some(rules) = &self.rules[1] {
                first.pixels.draw_over(&second.pixels, pixels(), &rules.scale, STEP);
            }
            let scale = self.rules[0].as_ref().map(|r| r.scale);
            let together = |q: f32| scale.map_or(0.0, |s| s.bent_step(q, 1.0));
            self.finish(&part, out, |range, place, out| {
                for (column, i) in (place.0..).zip(range) {
                    let place = (column, place.1);
                    let shaded =
                        self.shader.through(first.pixels.of(i), place, alpha, self.colored, together);
                    self.shader.write(&shaded, out, i);
                }
            });
        } else {
            let [first, second] = &mut scratch.nearest;
            self.draw_passes([&mut *first, &mut *second], &part, |s| {
                s.begin(n, self.width, &part.columns, painted);
            });
            if let Some(rules) = &self.rules[1] {
                first.pixels.draw_over(&second.pixels, pixels(), &rules.scale, STEP);
            }
            self.finish(&part, out, |range, place, out| {
                self.shader.nearest_row(&first.pixels, range, place, self.colored, out);
            });
        }
    }

    /// The columns in which anything may be drawn in these rows.
    fn columns_touched(&self, first_row: usize, rows: usize) -> Range<usize> {
        let rows = first_row..first_row + rows;
        let of_pass = |(pass, rules): (&Pass, &Option<FaceRules>)| {
            rules.as_ref().map(|r| faces::columns_touched(&pass.buffer, r.pixel, &rows, &self.columns))
        };
        let all = self.passes.iter().zip(&self.rules).filter_map(of_pass).filter(|c| !c.is_empty());
        all.reduce(|a, b| a.start.min(b.start)..a.end.max(b.end))
            .unwrap_or(self.columns.start..self.columns.start)
    }

    /// Has each row of a part written by `row`, given its pixels in the strip and the column and row in the picture of
    /// the first, and says that there is nothing beside it.
    fn finish(
        &self,
        part: &Part,
        out: &mut RowsOut<'_>,
        row: impl Fn(Range<usize>, (usize, usize), &mut RowsOut<'_>),
    ) {
        for i in 0..part.rows {
            let at = |columns: Range<usize>| i * self.width + columns.start..i * self.width + columns.end;
            out.clear(at(self.columns.start..part.columns.start));
            out.clear(at(part.columns.end..self.columns.end));
            row(at(part.columns.clone()), (part.columns.start, part.first_row + i), out);
        }
    }

    fn draw_passes<P: Pixels>(&self, strips: [&mut Strip<P>; 2], part: &Part, begin: impl Fn(&mut P)) {
        for (k, strip) in strips.into_iter().enumerate() {
            if let Some(rules) = &self.rules[k] {
                strip.set_rows(self.width, part.first_row, part.rows, part.columns.clone());
                begin(&mut strip.pixels);
                faces::draw(&self.passes[k].buffer, &self.passes[k].outlines.list, rules, strip);
            }
        }
    }
}

/// The part of a strip in which something may be drawn.
struct Part {
    first_row: usize,
    rows: usize,
    columns: Range<usize>,
}

impl Part {
    /// Numbers of its pixels in a strip of this width.
    fn pixels(&self, width: usize) -> impl Iterator<Item = usize> {
        let columns = self.columns.clone();
        (0..self.rows).flat_map(move |row| row * width + columns.start..row * width + columns.end)
    }
}

impl Pass {
    fn make(
        &mut self,
        cloud: &Cloud,
        visible: &[u32],
        map: &BufferMap,
        options: &Options,
        drawn: &Wanted,
        memory: &mut PassScratch,
    ) {
        block_view::view_blocks(cloud, visible, map, &mut self.views);
        let layers = options.translucency;
        self.buffer.reshape(map.width, map.height, layers.map_or(1, |t| t.layers));
        let scale = DepthScale::new(map, cloud.spacing());
        let rules = Rules { gamma: options.gamma, weighting: options.weighting, scale, layers };
        accumulate::accumulate(cloud, &self.views, map, rules, &mut self.buffer, &memory.bands);
        fill::pull_push(&mut self.buffer, &scale, options.fill, &mut memory.fill);
        // A quad's last corners are in the row after that which it is numbered by.
        let quads = faces::quads_about(&drawn.rows, map.scale as f32, map.height);
        let rows = quads.start.max(0) as usize..(quads.end.max(0) + 1) as usize;
        // With the neighbours that stray normals are compared with.
        let around = rows.start.saturating_sub(1)..rows.end + 1;
        normals::make_corners(&mut self.buffer, map, &scale, options.normals, around, &mut self.noise);
        if options.normals == Normals::Plane && self.buffer.layers == 1 {
            stray::replace(&mut self.buffer, &scale, &rows, &mut self.strays);
        }
        if options.outline > 0.0 && self.buffer.layers == 1 {
            self.outlines.find(&self.buffer, &scale);
        } else {
            self.outlines.clear();
        }
    }
}

/// Pixels that one world unit takes at `depth`; for a perspective camera at least at a tiny depth.
fn pixels_per_unit(view: &View, depth: f64) -> f64 {
    match view.projection() {
        Projection::Perspective { .. } => view.focal_px() / depth.max(f64::MIN_POSITIVE),
        Projection::Orthographic { .. } => view.focal_px(),
    }
}

/// Depth of the middle of the cloud; never at or behind the eye.
fn reference_depth(cloud: &Cloud, view: &View) -> f64 {
    let (low, high) = cloud.bounds();
    let extent = (high - low).length();
    let depth = depth_of(view, 0.5 * low + 0.5 * high);
    depth.max(0.01 * extent).max(f64::MIN_POSITIVE * 1e16)
}

fn face_rules(cloud: &Cloud, map: &BufferMap, options: &Options, second: bool) -> FaceRules {
    let (x, y) = map.centre();
    FaceRules {
        scale: DepthScale::new(map, cloud.spacing()),
        // The second pass fills; the outline is the first one's.
        outline_px: if second { 0.0 } else { (f64::from(options.outline) * map.scale) as f32 },
        focal: map.focal() as f32,
        reference: map.reference as f32,
        centre: (x as f32, y as f32),
        perspective: map.is_perspective(),
        pixel: map.scale as f32,
        painted: cloud.has_colors()
            || options.surface_layers
            || (options.translucency.is_some() && cloud.has_opacities()),
        sparse_only: second,
    }
}
