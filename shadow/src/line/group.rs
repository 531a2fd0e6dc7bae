//! Receivers in groups, each with the casters that may hide something of a line.

use super::cut::{Interval, LineCaster};
use super::hull::Hull;
use super::light::{LineLight, SeenLine, above_horizon};
use crate::area::masks::surface_point;
use crate::area::piece;
use crate::area::targets::{Target, Targets, bounds, split};
use crate::counts::AreaCounts;
use crate::receiver::{Receivers, Viewer};
use glam::{DVec3, dvec2, dvec3};
use pointillist_micropoint::{Bounds, ClusterView};

/// Groups of this many receivers are not divided further.
const FEW_RECEIVERS: usize = 8;

/// Groups with no more casters than this are not divided further.
const FEW_CASTERS: usize = 4;

/// How far from a receiver's corner, towards its middle, it is asked for the corner: at the corner itself it may touch another surface.
const INSET: f64 = 0.02;

/// Reusable memory of [`LineLight::visit`], one per thread.
#[derive(Debug, Default)]
pub struct LineScratch {
    targets: Targets,
    casters: Vec<LineCaster>,
    /// Stack of the casters of nested groups.
    stack: Vec<u32>,
    point: PointScratch,
    counts: AreaCounts,
}

impl LineScratch {
    /// What has been done since the last call.
    #[must_use]
    pub fn take_counts(&mut self) -> AreaCounts {
        std::mem::take(&mut self.counts)
    }
}

/// Memory for one point.
#[derive(Debug, Default)]
struct PointScratch {
    marks: Marks,
    seen: SeenLine,
    corner: SeenLine,
}

/// What divides a line, as a point sees it.
#[derive(Debug, Default)]
struct Marks {
    /// Intervals and their casters.
    hidden: Vec<(Interval, u32)>,
    /// Their ends.
    borders: Vec<f64>,
}

/// See [`LineLight::visit`].
pub(crate) fn visit(
    light: &LineLight<'_>,
    viewer: Viewer<'_>,
    receivers: &Receivers,
    scratch: &mut LineScratch,
    visit: &mut impl FnMut(usize, f64, &SeenLine),
) {
    let LineScratch { targets, casters, stack, point, counts } = scratch;
    targets.collect((light.geometry, &light.frame), viewer, receivers, |_, own, _, normal| {
        light.ends.iter().any(|&end| own.iter().any(|&c| normal.dot(end - c) > 0.0))
    });
    let Targets { list, pieces, corners } = targets;
    counts.batch(receivers.wholes(), list.len());
    if list.is_empty() {
        return;
    }
    casters.clear();
    if light.casts {
        gather(light, &Hull::new(bounds(list), light.ends), casters);
    }
    stack.clear();
    stack.extend(0..casters.len() as u32);
    Groups { light, pieces, corners, casters, stack, point, counts, visit }.divide(list, 0);
}

/// Adds what a hull does not miss.
fn gather(light: &LineLight<'_>, hull: &Hull, casters: &mut Vec<LineCaster>) {
    let wants = |bounds: &Bounds| {
        let side = |k: usize, bit: bool| if bit { bounds.high[k] } else { bounds.low[k] };
        let corner = |i: usize| dvec3(side(0, i & 1 > 0), side(1, i & 2 > 0), side(2, i & 4 > 0));
        !hull.misses(&std::array::from_fn::<_, 8, _>(|i| light.frame.local(corner(i))))
    };
    let add = |cluster: &ClusterView<'_>| {
        for face in cluster.faces() {
            let surface = &light.geometry.surfaces()[face.surface as usize];
            let corners = face.corners.map(|c| light.frame.local(cluster.vertices[c]));
            let [a, b, c] = corners;
            let normal = (b - a).cross(c - a).normalize_or_zero();
            if surface.opacity <= 0.0 || normal == DVec3::ZERO || hull.misses(&corners) {
                continue;
            }
            let mask = surface.textured_opacity.then_some((face.surface, face.id));
            let opacity = f64::from(surface.opacity);
            casters.push(LineCaster { corners, normal, offset: normal.dot(a), opacity, mask });
        }
    };
    light.geometry.visit_clusters(wants, add);
    // By place: products do not depend on the order of triangles.
    let key = |c: &LineCaster| {
        let places = c.corners.map(|p| p.to_array().map(f64::to_bits));
        (places, c.opacity.to_bits(), c.mask)
    };
    casters.sort_unstable_by_key(key);
}

/// A batch of receivers while it is divided.
struct Groups<'s, F> {
    light: &'s LineLight<'s>,
    pieces: &'s [piece::Piece],
    corners: &'s [DVec3],
    casters: &'s [LineCaster],
    stack: &'s mut Vec<u32>,
    point: &'s mut PointScratch,
    counts: &'s mut AreaCounts,
    visit: &'s mut F,
}

impl<F: FnMut(usize, f64, &SeenLine)> Groups<'_, F> {
    /// A group of receivers, with the casters from `first` on the stack.
    fn divide(&mut self, targets: &mut [Target], first: usize) {
        let around = bounds(targets);
        let hull = Hull::new(around, self.light.ends);
        let own = self.stack.len();
        for i in first..own {
            let caster = self.stack[i];
            if !hull.misses(&self.casters[caster as usize].corners) {
                self.stack.push(caster);
            }
        }
        if targets.len() <= FEW_RECEIVERS || self.stack.len() - own <= FEW_CASTERS {
            self.counts.casters += (self.stack.len() - own) as u64;
            for target in &*targets {
                self.ask_pieces(target, own);
            }
        } else {
            let (low, high) = split(targets, around);
            self.divide(low, own);
            self.divide(high, own);
        }
        self.stack.truncate(own);
    }

    fn ask_pieces(&mut self, target: &Target, first: usize) {
        let pieces = &self.pieces[target.first_piece as usize..][..target.piece_count as usize];
        let total = piece::weight(pieces);
        for piece in pieces {
            self.ask(target, piece.corners(self.corners), piece.weight / total, (first, 0));
        }
    }

    /// Asks the middle of a convex piece of a receiver, or the middles of its halves.
    fn ask(&mut self, target: &Target, ring: &[DVec3], share: f64, (first, halvings): (usize, u32)) {
        let (middle, _) = piece::middle(ring);
        if self.is_coarse(target, ring, middle, (first, halvings)) {
            let halves = piece::halves(ring, middle);
            let areas = halves.each_ref().map(|h| piece::area(h));
            let total = areas[0] + areas[1];
            if total > 0.0 {
                for (half, own) in halves.iter().zip(areas).filter(|(_, own)| *own > 0.0) {
                    self.ask(target, half, share * own / total, (first, halvings + 1));
                }
                return;
            }
        }
        let PointScratch { marks, seen, .. } = &mut *self.point;
        cast(self.light, (middle, target.normal), (self.casters, &self.stack[first..]), marks, seen);
        self.counts.point(self.stack.len() > first, seen.parts.is_empty());
        if !seen.parts.is_empty() {
            (self.visit)(target.receiver as usize, share, seen);
        }
    }

    /// Whether the corners of a piece see so much else than its middle that one point is too few.
    fn is_coarse(
        &mut self,
        target: &Target,
        ring: &[DVec3],
        middle: DVec3,
        (first, halvings): (usize, u32),
    ) -> bool {
        let options = &self.light.options;
        let casters = (self.casters, &self.stack[first..]);
        if halvings >= options.most_halvings || casters.1.is_empty() {
            return false;
        }
        let PointScratch { marks, seen, corner } = &mut *self.point;
        cast(self.light, (middle, target.normal), casters, marks, seen);
        ring.iter().any(|&c| {
            let near = c + (middle - c) * INSET;
            cast(self.light, (near, target.normal), casters, marks, corner);
            disagreement(&seen.parts, &corner.parts) * target.visibility > options.largest_shift
        })
    }
}

type Parts = [(Interval, f64)];

/// Length over which two points see the line differently, times how much; both lists rise.
fn disagreement(a: &Parts, b: &Parts) -> f64 {
    let overlap = |(f, t): Interval, (g, u): Interval| (t.min(u) - f.max(g)).max(0.0);
    let length = |parts: &Parts| parts.iter().map(|&((f, t), passed)| (t - f) * passed).sum::<f64>();
    let both =
        a.iter().flat_map(|&(p, passed)| b.iter().map(move |&(q, other)| overlap(p, q) * passed.min(other)));
    length(a) + length(b) - 2.0 * both.sum::<f64>()
}

/// What a point of a surface sees: step 3.
fn cast(
    light: &LineLight<'_>,
    (point, normal): (DVec3, DVec3),
    (casters, group): (&[LineCaster], &[u32]),
    Marks { hidden, borders }: &mut Marks,
    seen: &mut SeenLine,
) {
    seen.start(light, point);
    let Some((least, most)) = above_horizon(light, point, normal) else { return };
    hidden.clear();
    borders.clear();
    borders.extend([least, most]);
    for &c in group {
        let Some((from, to)) = casters[c as usize].hidden(point, light.ends, light.coincident) else {
            continue;
        };
        let (from, to) = (from.max(least), to.min(most));
        if from < to {
            hidden.push(((from, to), c));
            borders.extend([from, to]);
        }
    }
    borders.sort_unstable_by(f64::total_cmp);
    borders.dedup();
    for pair in borders.windows(2) {
        let part = (pair[0], pair[1]);
        let before = hidden.iter().filter(|(interval, _)| interval.0 <= part.0 && part.1 <= interval.1);
        let mut passed = 1.0;
        for (_, c) in before {
            passed *= 1.0 - opacity(light, &casters[*c as usize], point, part);
            if passed <= 0.0 {
                break;
            }
        }
        if passed > 0.0 {
            join(&mut seen.parts, part, passed);
        }
    }
}

/// Adds a part, or makes the last one longer.
fn join(parts: &mut Vec<(Interval, f64)>, part: Interval, passed: f64) {
    match parts.last_mut() {
        Some((last, alike)) if last.1 == part.0 && *alike == passed => last.1 = part.1,
        _ => parts.push((part, passed)),
    }
}

/// Opacity of a caster before a part of the line: of a mask, the mean along the part's shadow on it.
fn opacity(light: &LineLight<'_>, caster: &LineCaster, point: DVec3, (from, to): Interval) -> f64 {
    let Some((surface, triangle)) = caster.mask else { return caster.opacity };
    let corners = caster.corners.map(|c| c - point);
    let [a, b] = light.ends;
    let at = |t: f64| surface_point(corners, a + (b - a) * t - point, dvec2(t, 0.0), 1.0);
    let mean = light.opacity.mean_opacity(triangle, &[at(from), at(0.5 * (from + to)), at(to)]);
    f64::from(light.geometry.surfaces()[surface as usize].behind_mask(mean))
}
