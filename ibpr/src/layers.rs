//! Several surfaces per pixel, for translucent frames.
//!
//! The points of a pixel are sorted by depth and taken from the near end: a point further than the
//! threshold from the first one of its layer opens the next. The paper opens layers in the order in
//! which points arrive; sorted first, the layers are the same for every order.

use crate::block_view::{BlockView, walk};
use crate::border::PAD;
use crate::buffer::BufferBand;
use crate::cloud::Cloud;
use crate::options::Translucency;
use crate::project::Band;
use crate::rules::Rules;

/// A point in its pixel.
#[derive(Clone, Copy, Debug, Default)]
struct Member {
    depth: f32,
    x: f32,
    y: f32,
    point: u32,
}

/// Working memory of a band.
#[derive(Debug, Default)]
pub(crate) struct LayerScratch {
    found: Vec<(u32, Member)>,
    /// Where each pixel's members begin.
    starts: Vec<u32>,
    members: Vec<Member>,
}

/// Averages the points of each layer of each pixel of a band.
pub(crate) fn fill_band(
    cloud: &Cloud,
    views: &[BlockView],
    band: &Band,
    rules: Rules,
    options: Translucency,
    scratch: &mut LayerScratch,
    mut out: BufferBand<'_>,
) {
    sort_by_pixel(cloud, views, band, scratch);
    for row in 0..band.rows {
        for column in 0..band.width {
            let pixel = row * band.width + column;
            let range = scratch.starts[pixel] as usize..scratch.starts[pixel + 1] as usize;
            let members = &mut scratch.members[range];
            members.sort_unstable_by(|a, b| a.depth.total_cmp(&b.depth).then(a.point.cmp(&b.point)));
            let first = row * out.pitch + column + PAD;
            split(cloud, rules, options, members, first, &mut out);
        }
    }
}

/// A counting sort.
fn sort_by_pixel(cloud: &Cloud, views: &[BlockView], band: &Band, scratch: &mut LayerScratch) {
    let LayerScratch { found, starts, members } = scratch;
    found.clear();
    starts.clear();
    starts.resize(band.width * band.rows + 1, 0);
    walk(
        cloud,
        views,
        band,
        |_| false,
        |p, k, pixel, point| {
            let member = Member { depth: p.depth[k], x: p.x[k], y: p.y[k], point: point as u32 };
            found.push((pixel as u32, member));
            starts[pixel] += 1;
        },
    );
    let mut sum = 0;
    for start in starts.iter_mut() {
        sum += *start;
        *start = sum;
    }
    members.clear();
    members.resize(found.len(), Member::default());
    // From the back, so that each pixel's start counts down to where it begins.
    for (pixel, member) in found.iter().rev() {
        let start = &mut starts[*pixel as usize];
        *start -= 1;
        members[*start as usize] = *member;
    }
}

fn split(
    cloud: &Cloud,
    rules: Rules,
    options: Translucency,
    members: &[Member],
    first: usize,
    out: &mut BufferBand<'_>,
) {
    let mut rest = members;
    for layer in 0..options.layers {
        let to = first + layer * out.stride;
        out.count[to] = 0.0;
        let Some(nearest) = rest.first() else { continue };
        let unit = rules.scale.unit(nearest.depth);
        let within = |steps: f32| rest.partition_point(|m| m.depth - nearest.depth <= steps * unit);
        let (slab, end) = (&rest[..within(rules.gamma.min(options.threshold))], within(options.threshold));
        let inverse = 1.0 / slab.len() as f32;
        let mean = |value: fn(&Member, &Member) -> f32| {
            slab.iter().map(|m| value(m, nearest)).sum::<f32>() * inverse
        };
        out.count[to] = slab.len() as f32;
        // About the nearest one: sums of large coordinates would lose digits.
        out.x[to] = nearest.x + mean(|m, n| m.x - n.x);
        out.y[to] = nearest.y + mean(|m, n| m.y - n.y);
        out.q[to] = rules.scale.bent(nearest.depth + mean(|m, n| m.depth - n.depth));
        let mut color = [0.0; 4];
        for m in slab {
            for (sum, c) in color.iter_mut().zip(cloud.premultiplied(m.point as usize)) {
                *sum += c * inverse;
            }
        }
        out.color[to] = color;
        rest = &rest[end..];
    }
}
