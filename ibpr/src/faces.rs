//! Faces between neighbouring averaged points, drawn at the size of the picture.
//!
//! Four neighbouring pixels are a quad. Those of its corners that hold points of one surface make the
//! face: four a quadrilateral, three a triangle, as in the paper. Towards corners that are missing (or
//! belong to another surface) the face reaches further, and the outline ([`crate::outline`]) decides how much of that is covered.

use crate::border::MARGIN;
use crate::buffer::STEP;
use crate::buffer::{Buffer, Corner, DepthScale, SUBPIXEL, whole_steps};
use crate::outline::Outline;
use crate::raster::{Paint, Pixels, Strip, Vertex};
use std::ops::Range;

/// How faces are made.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FaceRules {
    pub(crate) scale: DepthScale,
    /// Picture pixels by which outlines reach beyond the corners; 0: as printed.
    pub(crate) outline_px: f32,
    /// Buffer pixels per world unit at depth 1, and the offset and size of the buffer's pixels: what
    /// continues a surface beyond a corner.
    pub(crate) focal: f32,
    pub(crate) reference: f32,
    pub(crate) centre: (f32, f32),
    pub(crate) perspective: bool,
    /// Picture pixels per buffer pixel.
    pub(crate) pixel: f32,
    /// Whether color and count are drawn too.
    pub(crate) painted: bool,
    /// Second pass: no face where points are dense or the surface is nearly edge-on.
    pub(crate) sparse_only: bool,
}

/// More points in a pixel are "dense" (the paper's 8).
const DENSE: f32 = 8.0;

/// Cosine of the view's angle to the normal below which a surface is "nearly edge-on".
const EDGE_ON_COS: f32 = 0.3;

/// Buffer pixels that a surface reaches under a nearer one: from a corner at one side of its pixel to
/// beyond the outline of a corner at the other side of the next.
const UNDER: f32 = 1.5;

/// Buffer pixels that faces reach beyond the last corners where an outline is known: it decides where the surface ends on the way.
const BEYOND: f32 = 1.5;

/// The outline that a corner knows of.
fn outline_of(outlines: &[Outline], at: usize) -> Option<&Outline> {
    outlines.get(at).filter(|o| o.is_some())
}

/// Picture pixels from a corner of an incomplete face to its outline.
fn inside_px(outlines: &[Outline], rules: &FaceRules, at: usize) -> f32 {
    outline_of(outlines, at).map_or(rules.outline_px, |o| o.inside * rules.pixel + rules.outline_px)
}

/// Picture pixels from a corner of a complete face to its outline: far, if none is known.
fn inside_whole_px(outlines: &[Outline], rules: &FaceRules, at: usize) -> f32 {
    outlines.get(at).map_or(f32::INFINITY, |o| o.inside * rules.pixel + rules.outline_px)
}

/// Rows (or columns) of quads that may touch these rows (or columns) of the picture, each numbered by its first corner, from −1 on; `size`
/// is the buffer's.
pub(crate) fn quads_about(picture: &Range<usize>, pixel: f32, size: usize) -> Range<isize> {
    // A corner lies in its own pixel, and faces reach up to `UNDER` beyond.
    let reach = UNDER + 0.5 + 0.5 / pixel;
    let first = picture.start as f32 / pixel + MARGIN as f32;
    let last = picture.end as f32 / pixel + MARGIN as f32;
    (first - reach - 1.0).max(-1.0) as isize..(last + reach).min(size as f32) as isize
}

/// Columns of the picture that faces in these of its rows may touch, within `columns`.
pub(crate) fn columns_touched(
    buffer: &Buffer,
    pixel: f32,
    rows: &Range<usize>,
    columns: &Range<usize>,
) -> Range<usize> {
    let (mut first, mut last) = (usize::MAX, 0);
    for row in quads_about(rows, pixel, buffer.height) {
        let upper = buffer.at(0, 0).wrapping_add_signed(row * buffer.pitch as isize - 1);
        let quads = occupied(buffer, upper);
        if !quads.is_empty() {
            // Of the buffer, whose first pixel lies at 1 here.
            (first, last) = (first.min(quads.start - upper), last.max(quads.end - upper));
        }
    }
    if first > last {
        return columns.start..columns.start;
    }
    // A quad ends one pixel after its own, in which its right corners may lie anywhere.
    let picture = |column: f32| (column - MARGIN as f32) * pixel;
    let start = picture(first as f32 - 1.0 - UNDER).max(0.0) as usize;
    let end = picture(last as f32 + 1.0 + UNDER).ceil().max(0.0) as usize;
    let start = start.clamp(columns.start, columns.end);
    start..end.clamp(start, columns.end)
}

/// Draws all faces of `buffer` that touch `strip`.
pub(crate) fn draw<P: Pixels>(
    buffer: &Buffer,
    outlines: &[Outline],
    rules: &FaceRules,
    strip: &mut Strip<P>,
) {
    let rows = strip.first_row..strip.first_row + strip.rows;
    let columns = quads_about(&strip.columns, rules.pixel, buffer.width);
    for row in quads_about(&rows, rules.pixel, buffer.height) {
        let upper = buffer.at(0, 0).wrapping_add_signed(row * buffer.pitch as isize - 1);
        let near = upper.wrapping_add_signed(columns.start + 1)..upper.wrapping_add_signed(columns.end + 1);
        let occupied = occupied(buffer, upper);
        for at in occupied.start.max(near.start)..occupied.end.min(near.end) {
            let quad = [at, at + 1, at + 1 + buffer.pitch, at + buffer.pitch];
            if buffer.layers == 1 {
                draw_quad(buffer, outlines, rules, quad, strip);
            } else {
                draw_layers(buffer, rules, quad, strip);
            }
        }
    }
}

/// Quads of a row, from its upper left corners on, between the first pixel that holds a point and the last.
fn occupied(buffer: &Buffer, upper: usize) -> std::ops::Range<usize> {
    let n = buffer.width + 2;
    let rows = [upper, upper + buffer.pitch].map(|start| &buffer.count[start..start + n]);
    let holds = |i: &usize| rows.iter().any(|row| row[*i] > 0.0);
    match (0..n).find(holds) {
        // A quad is numbered by its left corners.
        Some(first) => {
            let last = (first..n).rev().find(holds).unwrap_or(first);
            upper + first.max(1) - 1..upper + last.min(n - 2) + 1
        }
        None => upper..upper,
    }
}

/// The faces of all surfaces that pass through a quad: each corner joins the corners nearest to it in
/// depth, whatever their layer.
fn draw_layers<P: Pixels>(buffer: &Buffer, rules: &FaceRules, quad: [usize; 4], strip: &mut Strip<P>) {
    let mut used = [0u32; 4];
    for k in 0..4 {
        for layer in 0..buffer.layers {
            let seed = quad[k] + layer * buffer.stride;
            if buffer.count[seed] == 0.0 {
                // Layers are filled from the first on.
                break;
            }
            let depth = buffer.corners[seed].surface[0];
            if depth == f32::INFINITY || used[k] >> layer & 1 == 1 {
                continue;
            }
            used[k] |= 1 << layer;
            let (mut face, mut group) = (quad, 1 << k);
            face[k] = seed;
            for j in k + 1..4 {
                let apart =
                    |l: &usize| (buffer.corners[quad[j] + l * buffer.stride].surface[0] - depth).abs();
                let layers =
                    (0..buffer.layers).take_while(|l| buffer.count[quad[j] + l * buffer.stride] > 0.0);
                let free = layers.filter(|l| used[j] >> l & 1 == 0);
                let nearest = free.min_by(|a, b| apart(a).total_cmp(&apart(b)));
                if let Some(l) = nearest.filter(|l| apart(l) < rules.scale.bent_step(depth, STEP)) {
                    used[j] |= 1 << l;
                    face[j] = quad[j] + l * buffer.stride;
                    group |= 1 << j;
                }
            }
            let fine = |j: usize| group >> j & 1 == 1 && too_fine(buffer, rules, face[j]);
            if rules.sparse_only && (0..4).any(fine) {
                continue;
            }
            if group == 15 {
                let vertices = face.map(|i| vertex(&buffer.corners[i], f32::INFINITY));
                draw_whole::<false, P>(buffer, rules, face, &vertices, strip);
            } else {
                draw_part(buffer, &[], rules, face, group, strip);
            }
        }
    }
}

/// Corners run clockwise in the picture from the upper left.
fn draw_quad<P: Pixels>(
    buffer: &Buffer,
    outlines: &[Outline],
    rules: &FaceRules,
    quad: [usize; 4],
    strip: &mut Strip<P>,
) {
    let corners = quad.map(|i| &buffer.corners[i]);
    let depth = corners.map(|c| c.surface[0]);
    let farthest = depth[0].max(depth[1]).max(depth[2].max(depth[3]));
    let nearest = depth[0].min(depth[1]).min(depth[2].min(depth[3]));
    if nearest == f32::INFINITY {
        return;
    }
    let step = rules.scale.bent_step(nearest, STEP);
    if rules.sparse_only && quad.iter().any(|i| too_fine(buffer, rules, *i)) {
        return;
    }
    if farthest - nearest < step {
        let rows = strip.first_row as i32..(strip.first_row + strip.rows) as i32;
        let y = corners.map(|c| c.y / SUBPIXEL as i32);
        if y.iter().all(|y| *y < rows.start - 1) || y.iter().all(|y| *y > rows.end) {
            return;
        }
        let inside = quad.map(|i| inside_whole_px(outlines, rules, i));
        let vertices = [0, 1, 2, 3].map(|k| vertex(corners[k], inside[k]));
        if inside.iter().any(|px| *px < 0.5) {
            return draw_whole::<true, P>(buffer, rules, quad, &vertices, strip);
        }
        return draw_whole::<false, P>(buffer, rules, quad, &vertices, strip);
    }
    let joined = [0, 1, 2, 3].map(|k: usize| (depth[k] - depth[(k + 1) % 4]).abs() < step);
    let mut left = 0;
    for (k, d) in depth.iter().enumerate() {
        left |= usize::from(*d < f32::INFINITY) << k;
    }
    while left != 0 {
        let group = surface_of(left.trailing_zeros() as usize, left, joined);
        left &= !group;
        draw_part(buffer, outlines, rules, quad, group, strip);
    }
}

/// Corners that belong with `first`, as a bit mask.
fn surface_of(first: usize, valid: usize, joined: [bool; 4]) -> usize {
    let mut group = 1 << first;
    // Three rounds reach every corner of a ring of four.
    for _ in 0..3 {
        for (k, joined) in joined.into_iter().enumerate() {
            let pair = 1 << k | 1 << ((k + 1) % 4);
            if joined && group & pair != 0 {
                group |= pair & valid;
            }
        }
    }
    group
}

fn too_fine(buffer: &Buffer, rules: &FaceRules, at: usize) -> bool {
    let corner = &buffer.corners[at];
    buffer.count[at] > DENSE || (corner.is_some() && facing(corner, rules, buffer, at) < EDGE_ON_COS)
}

/// Cosine between the normal and the direction to the eye.
fn facing(corner: &Corner, rules: &FaceRules, buffer: &Buffer, at: usize) -> f32 {
    let [_, nx, ny, nz] = corner.surface;
    if !rules.perspective {
        return nz;
    }
    let (u, v) = (buffer.x[at] - rules.centre.0, buffer.y[at] - rules.centre.1);
    let (x, y) = (u / rules.focal, v / rules.focal);
    (nz - nx * x + ny * y) / (1.0 + x * x + y * y).sqrt()
}

fn vertex(corner: &Corner, inside: f32) -> Vertex {
    Vertex { x: corner.x, y: corner.y, surface: corner.surface, inside }
}

fn paint(buffer: &Buffer, at: usize) -> Paint {
    Paint { color: buffer.color[at], count: buffer.count[at] }
}

/// Two triangles, along the diagonal whose ends are closer in depth.
fn draw_whole<const RIM: bool, P: Pixels>(
    buffer: &Buffer,
    rules: &FaceRules,
    quad: [usize; 4],
    v: &[Vertex; 4],
    strip: &mut Strip<P>,
) {
    let depth = |k: usize| v[k].surface[0];
    let turn = (depth(0) - depth(2)).abs() > (depth(1) - depth(3)).abs();
    let triangles = if turn { [[1, 2, 3], [1, 3, 0]] } else { [[0, 1, 2], [0, 2, 3]] };
    let paints = rules.painted.then(|| quad.map(|i| paint(buffer, i)));
    for t in triangles {
        let paints = paints.as_ref().map(|p| t.map(|k: usize| &p[k]));
        strip.triangle::<RIM>(t.map(|k: usize| &v[k]), paints);
    }
}

/// The face of some of the corners, with its outline towards the others.
fn draw_part<P: Pixels>(
    buffer: &Buffer,
    outlines: &[Outline],
    rules: &FaceRules,
    quad: [usize; 4],
    group: usize,
    strip: &mut Strip<P>,
) {
    let size = group.count_ones();
    if rules.outline_px <= 0.0 && size < 3 {
        return;
    }
    let has = |k: usize| group >> (k % 4) & 1 == 1;
    let blank = (vertex(&Corner::NONE, 0.0), Paint::NONE);
    let mut ring = [blank; 6];
    let mut n = 0;
    let mut push = |v: Vertex, p: Paint| {
        ring[n] = (v, p);
        n += 1;
    };
    for k in (0..4).filter(|k| has(*k)) {
        let at = quad[k];
        let p = if rules.painted { paint(buffer, at) } else { Paint::NONE };
        let outline = rules.outline_px > 0.0;
        if outline && !has(k + 3) {
            push(beyond(buffer, outlines, rules, [at, quad[(k + 3) % 4]], towards(k, (k + 3) % 4)), p);
        }
        let inside = match (outline, size) {
            (false, _) => f32::INFINITY,
            (true, 4) => inside_whole_px(outlines, rules, at),
            (true, _) => inside_px(outlines, rules, at),
        };
        push(vertex(&buffer.corners[at], inside), p);
        if outline && !has(k + 1) {
            push(beyond(buffer, outlines, rules, [at, quad[(k + 1) % 4]], towards(k, (k + 1) % 4)), p);
        }
    }
    for k in 1..n.saturating_sub(1) {
        let t = [0, k, k + 1];
        let paints = rules.painted.then(|| t.map(|i| &ring[i].1));
        let vertices = t.map(|i| &ring[i].0);
        if (size == 4 && outlines.is_empty()) || rules.outline_px <= 0.0 {
            strip.triangle::<false>(vertices, paints);
        } else {
            strip.triangle::<true>(vertices, paints);
        }
    }
}

/// Direction from corner `from` of a quad to its neighbour `to`.
fn towards(from: usize, to: usize) -> (f32, f32) {
    const PLACE: [(f32, f32); 4] = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
    (PLACE[to].0 - PLACE[from].0, PLACE[to].1 - PLACE[from].1)
}

/// The point where the surface of corner `at` ends towards the neighbour `next`: on the corner's plane,
/// half a picture pixel outside the outline. Behind a nearer neighbour it does not end: there it goes on
/// until that one hides it.
fn beyond(
    buffer: &Buffer,
    outlines: &[Outline],
    rules: &FaceRules,
    [at, next]: [usize; 2],
    direction: (f32, f32),
) -> Vertex {
    /// From here on a picture pixel is not touched by the surface.
    const OUTSIDE_PX: f32 = 0.5;
    let corner = &buffer.corners[at];
    // Not in translucent frames: the continued surface would show through the nearer one.
    let hidden = buffer.layers == 1 && buffer.corners[next].surface[0] < corner.surface[0];
    let (length_px, inside) = if let Some(outline) = outline_of(outlines, at) {
        let length_px = if hidden { UNDER } else { BEYOND } * rules.pixel;
        let inward = outline.inward.0 * direction.0 + outline.inward.1 * direction.1;
        (length_px, inside_px(outlines, rules, at) + inward * length_px)
    } else if hidden {
        (UNDER * rules.pixel, rules.outline_px + UNDER * rules.pixel)
    } else {
        (rules.outline_px + OUTSIDE_PX, -OUTSIDE_PX)
    };
    let [q, nx, ny, nz] = corner.surface;
    // The slope of the bent depth, from the normal: see `Camera::normal`.
    let toward = if rules.perspective {
        let (u, v) = (buffer.x[at] - rules.centre.0, buffer.y[at] - rules.centre.1);
        (nz - nx * u / rules.focal + ny * v / rules.focal) / (rules.reference - q)
    } else {
        nz
    };
    let along = (nx * direction.0 - ny * direction.1) / (rules.focal * toward);
    let limit = rules.scale.bent_step(q, 1.0);
    let rise = (along * length_px / rules.pixel).clamp(-limit, limit);
    let step = |d: f32| whole_steps((d * length_px * SUBPIXEL).trunc());
    Vertex {
        x: corner.x + step(direction.0),
        y: corner.y + step(direction.1),
        surface: [if rise.is_nan() { q } else { q + rise }, nx, ny, nz],
        inside,
    }
}
