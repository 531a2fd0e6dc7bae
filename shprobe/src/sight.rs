//! Which probes light a position: those that see it, and of a surface those on its lit side.
//!
//! 1. Every probe sees so much of the position, 0 to 1: by its map, times how far it is in front of the surface
//!    ([`Spot::seen`]).
//! 2. Its effective distance is its distance over that, or over [`UNSEEN`] if it sees nothing.
//! 3. Nearest first, those within [`RIM`] times the effective distance of the [`COUNT`]-th light the position, and at
//!    most [`MOST`], with weights that fall to 0 at that rim: no probe is dropped before it has no weight. What is nearly
//!    linear in the position is kept so ([`weights`]).
//! 4. Weights are as much as is seen, without a lower bound but [`LEAST`]: visibility counts relative to that of those
//!    that see the position best. In a corner, where maps are too coarse for any to see it well, those of the room are
//!    still far ahead of what is behind its walls.
//! 5. Probes that see the position doubtfully count only if others that light it see them ([`agree`]).
//!
//! All of these are continuous in the position and the normal, for any number of probes: the k-th smallest of
//! continuous functions is continuous, and what goes out of reach has no weight by then. Where no probe is left
//! that sees the position, all are farther by the same factor, and the nearest light it.

use crate::DistanceMap;
use crate::delaunay::Blend;
use crate::tree::{Extent, Found, Tree};
use glam::{DMat3, DVec3};

/// Probes and their shares, which sum to 1.
#[derive(Clone, Debug, Default)]
pub(crate) struct Shares(Vec<(u32, f64)>);

impl Shares {
    /// Those of a cell.
    pub(crate) fn of_cell(blend: &Blend) -> Self {
        Self(blend.parts().collect())
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = (u32, f64)> + '_ {
        self.0.iter().copied()
    }

    /// Adds to a probe's share.
    fn add(&mut self, probe: u32, share: f64) {
        match self.0.iter_mut().find(|s| s.0 == probe) {
            Some(own) => own.1 += share,
            None => self.0.push((probe, share)),
        }
    }

    /// These parts of the shares, which sum to 1 again, and what they summed to. All of them where that is 0.
    pub(crate) fn parts(&self, of: impl Fn(u32) -> f64) -> (Self, f64) {
        let parts: Vec<(u32, f64)> = self.iter().map(|(probe, share)| (probe, share * of(probe))).collect();
        let sum = parts.iter().map(|part| part.1).sum();
        if sum > 0.0 { (Self(parts).normalised(), sum) } else { (self.clone(), 0.0) }
    }

    fn normalised(mut self) -> Self {
        if self.0.iter().all(|s| s.1 <= 0.0) {
            self.0.iter_mut().for_each(|s| s.1 = 1.0);
        }
        self.0.retain(|s| s.1 > 0.0);
        let sum: f64 = self.0.iter().map(|s| s.1).sum();
        self.0.iter_mut().for_each(|s| s.1 /= sum);
        self
    }
}

/// What the distance of a probe that sees nothing of a position is divided by. It bounds how far is searched for probes
/// that see it.
const UNSEEN: f64 = 0.1;

/// What is added to the part that a probe sees: positions of which no probe sees anything are lit, and continuously.
const LEAST: f64 = 1e-5;

/// Cosine, between the normal and the way to a probe, from which on the probe counts fully. Below it falls smoothly, to
/// nothing at the plane of the surface.
const FULL_COSINE: f64 = 0.2;

/// Height above the plane of the surface, over the spacing of probes, from which on a probe counts fully at any cosine: a probe a hand's breadth off a
/// wall is in front of all of that wall. By the cosine alone it lit a disc of the wall about itself, whose edges showed as scallops where probes
/// farther off took over. By experiment (the rooms of `studies shprobe wall` and `seams`, 96 probes, surfaces anywhere): by the cosine alone 4.9 %, with
/// 0.05 4.6 to 4.9, with 0.02 and 0.03 3.9 to 4.6 %, within which placement differs by chance.
const FULL_HEIGHT: f64 = 0.02;

/// The least cosine from which on a probe counts fully, whatever its height: shares must not change by more than their rounding from one normal in single
/// precision to the next.
const LEAST_COSINE: f64 = 0.03;

/// Distance, over the spacing of probes, below which the direction to a probe does not matter: a probe in the
/// surface itself has none.
const CLOSE: f64 = 0.01;

/// Most that a position on a surface is lifted, over its distance from the probe that is asked whether it sees it: the
/// precision of maps of distances. A surface in front that is farther than that is not jumped over.
const LIFT: f64 = 0.01;

/// The rim is [`RIM`] times the effective distance of this probe. Where probes are evenly dense, 13 are within it.
/// By experiment: with 8, 12, 16 and 20 within it the error of 96 probes differs by less than a tenth, least for 12.
pub(crate) const COUNT: usize = 6;
pub(crate) const RIM: f64 = 1.3;

/// Most probes that light a position.
pub(crate) const MOST: usize = 24;

/// The rank of the probe whose distance the peak of weights is as wide as, and the square of how wide over that.
const PEAK_RANK: usize = 4;
const PEAK: f64 = 0.11;

/// What [`Tree::nearest`] is asked for.
pub(crate) const EXTENT: Extent = Extent { count: COUNT, rim: RIM, most: MOST, unseen: UNSEEN };

/// Positions are clamped to this cube: the distances to what is farther would overflow.
const FARTHEST: f64 = 1e152;

/// Where light is asked for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spot {
    pub(crate) position: DVec3,
    /// Away from the surface, of length 1; 0 in free space.
    normal: DVec3,
    /// Upper limit of the lift off the surface.
    bias: f64,
    /// See [`CLOSE`].
    close: f64,
    /// The height at which a probe counts fully; infinite if probes have no spacing.
    high: f64,
}

impl Spot {
    /// A position on a surface, or with a normal of 0 in free space, among probes of this mean spacing.
    pub(crate) fn new(position: DVec3, normal: DVec3, bias: f64, spacing: f64) -> Self {
        let limit = DVec3::splat(FARTHEST);
        let position = position.clamp(-limit, limit);
        let high = if spacing > 0.0 { FULL_HEIGHT * spacing } else { f64::INFINITY };
        Self { position, normal: normal.normalize_or_zero(), bias, close: CLOSE * spacing, high }
    }

    pub(crate) fn is_free(&self) -> bool {
        self.normal == DVec3::ZERO
    }

    /// How far a probe is in front of the surface: 0 behind it, 1 in free space.
    fn side(&self, offset: DVec3, distance: f64) -> f64 {
        if self.is_free() {
            return 1.0;
        }
        let height = -offset.dot(self.normal);
        let full = ((distance + self.close) * FULL_COSINE).min(self.high.max(distance * LEAST_COSINE));
        let t = (height / full).clamp(0.0, 1.0);
        // A probe at the position itself, without any spacing: NaN of 0 by 0.
        if t.is_nan() { 0.0 } else { t * t * (3.0 - 2.0 * t) }
    }

    /// How much a probe at `probe` sees of the spot, 0 to 1, if it sees as far as `map` says.
    pub(crate) fn seen(&self, probe: DVec3, map: Option<&DistanceMap>) -> f64 {
        let offset = self.position - probe;
        let distance = offset.length();
        let side = self.side(offset, distance);
        match map {
            Some(map) if side > 0.0 => {
                side * map.visibility(offset + self.normal * self.bias.min(LIFT * distance))
            }
            _ => side,
        }
    }
}

/// Weights of probes by rising effective distance, of which those at the rim or beyond it have none; not normalised.
///
/// 1. (seen + [`LEAST`]) · (1 − q²)² / (q² + c), where q is the distance over that of the rim. The numerator falls to 0 smoothly; the
///    peak at the probe, that of an inverse squared distance, is as wide as the probes are apart.
/// 2. These average light that changes across the position, and at the rim of all probes lag behind. So they are
///    multiplied by 1 + seen · b·x, with x from the position to the probe and b such that linear functions are nearly
///    reproduced ([`slope`]), and 0 where that is negative.
///
/// Without any weight, where more than [`MOST`] are at the very same distance, all count alike.
pub(crate) fn weights(found: &[Found]) -> Vec<(u32, f64)> {
    let farthest = found.last().map_or(0.0, |f| f.distance);
    let limit = EXTENT.limit(found);
    let rim = if limit.is_finite() { limit } else { RIM * farthest };
    let peak = found.get(PEAK_RANK - 1).map_or(farthest, |f| f.distance);
    // At the place of all probes at once there is no distance: they count alike.
    let over_rim = |d: f64| if rim > 0.0 { d / rim } else { 0.0 };
    let width = PEAK * over_rim(peak).powi(2) + f64::MIN_POSITIVE.sqrt();
    let plain = found.iter().map(|f| {
        let q2 = over_rim(f.distance).powi(2);
        (f.seen + LEAST) * (1.0 - q2).max(0.0).powi(2) / (q2 + width)
    });
    let plain: Vec<f64> = plain.collect();
    let offset = |f: &Found| if rim > 0.0 { f.offset / rim } else { DVec3::ZERO };
    let slope = slope(found.iter().zip(&plain).map(|(f, w)| (offset(f), w * f.seen)));
    let corrected = |(f, w): (&Found, f64)| (f.probe, w * (1.0 + f.seen * slope.dot(offset(f))).max(0.0));
    found.iter().zip(plain).map(corrected).collect()
}

/// How much linear functions are not reproduced for the sake of weights that are not negative, over the mean square
/// extent of the probes. By experiment, two rooms and 96 probes: 0.2 and 0.6 err alike, less than 0.05 and 1.5, and all a
/// fifth less than no correction.
const RIDGE: f64 = 0.5;

/// b of [`weights`]: −(Σ w x xᵀ + ridge)⁻¹ Σ w x, for probes at `x` with weights `w`.
fn slope(probes: impl Iterator<Item = (DVec3, f64)>) -> DVec3 {
    let (mut first, mut second) = (DVec3::ZERO, DMat3::ZERO);
    for (x, w) in probes {
        first += x * w;
        second += DMat3::from_cols(x * x.x, x * x.y, x * x.z) * w;
    }
    let mean_square = (second.x_axis.x + second.y_axis.y + second.z_axis.z) / 3.0;
    let b = -(second + DMat3::from_diagonal(DVec3::splat(RIDGE * mean_square))).inverse() * first;
    // Without any extent, all probes at the position itself, there is no slope.
    if b.is_finite() { b } else { DVec3::ZERO }
}

/// The shares of a spot by what probes see, and for surfaces on which side they are. `map` is what a probe sees.
pub(crate) fn by_sight<'m>(spot: &Spot, tree: &Tree, map: impl Fn(u32) -> Option<&'m DistanceMap>) -> Shares {
    let found = tree.nearest(spot.position, EXTENT, |probe, at| spot.seen(at, map(probe)));
    let mut weights = weights(&found);
    agree(&found, &mut weights, map);
    Shares(weights).normalised()
}

/// A probe that sees less of a position than this is in doubt, and one that sees less than the second of these entirely.
const SURE: f64 = 0.95;
const DOUBTFUL: f64 = 0.85;

/// Probes with less than this share of the largest weight are not asked about the others.
const JUDGE: f64 = 0.2;

/// Share of those asked, by weight, that must see a probe for its weight to be left as it is.
const SUPPORT: f64 = 0.2;

/// Takes weight from probes whose sight of the position is doubtful, and which next to none of the others see: just behind a thin wall, next to
/// where another wall meets it, maps are too coarse to tell one side from the other, but the probes of the room see one another and
/// not those behind the wall. By experiment (`studies shprobe seams`, 96 and 192 probes): the RMS of ln ratio in
/// corners falls from 0.242 and 0.201 to 0.218 and 0.185, errors anywhere rise from 5.7 and 4.5 to 5.8 and 4.7 %; shares of 0.1 to 0.3 for either limit differ little.
fn agree<'m>(found: &[Found], weights: &mut [(u32, f64)], map: impl Fn(u32) -> Option<&'m DistanceMap>) {
    let doubt = |f: &Found| ((SURE - f.seen) / (SURE - DOUBTFUL)).clamp(0.0, 1.0);
    let most = weights.iter().fold(0.0, |most: f64, w| most.max(w.1));
    if most <= 0.0 || found.iter().all(|f| doubt(f) == 0.0) {
        return;
    }
    // Their votes fall to nothing before they are not asked.
    let judges = found.iter().zip(&*weights).map(|(f, w)| (f, w.1 - JUDGE * most));
    let judges: Vec<(&Found, f64)> = judges.filter(|judge| judge.1 > 0.0).collect();
    let enough = SUPPORT * judges.iter().map(|judge| judge.1).sum::<f64>();
    for (of, weight) in found.iter().zip(weights) {
        let doubt = doubt(of);
        if doubt == 0.0 || weight.1 <= 0.0 {
            continue;
        }
        // Its own vote and those of the nearest others, which mostly see it, tend to be enough: the rest is not asked.
        let mut support = (weight.1 - JUDGE * most).max(0.0);
        let mut others = judges.iter().filter(|judge| judge.0.probe != of.probe);
        while support < enough {
            let Some((judge, vote)) = others.next() else { break };
            support += vote * map(judge.probe).map_or(1.0, |map| map.visibility(of.offset - judge.offset));
        }
        weight.1 *= 1.0 - doubt * (1.0 - (support / enough).min(1.0));
    }
}

/// The shares of a spot in `cell`, of probes whose sight is not known. In free space they are the cell's. On a surface,
/// what the cell takes from probes behind it is taken from the nearest in front instead.
pub(crate) fn by_cell(spot: &Spot, cell: &Blend, tree: &Tree, positions: impl Fn(u32) -> DVec3) -> Shares {
    let mut shares = Shares::of_cell(cell);
    if spot.is_free() {
        return shares;
    }
    let mut lost = 0.0;
    for (probe, share) in &mut shares.0 {
        let offset = spot.position - positions(*probe);
        let side = spot.side(offset, offset.length());
        lost += *share * (1.0 - side);
        *share *= side;
    }
    if lost > 0.0 {
        let instead = by_sight(spot, tree, |_| None);
        instead.iter().for_each(|(probe, share)| shares.add(probe, lost * share));
    }
    shares.normalised()
}
