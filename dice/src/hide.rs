//! What is left of a polygon behind other polygons, exactly: the kernel of visibility and of shadows.
//!
//! A polygon is divided into convex [`Region`]s, each behind the same set of occluders, by half-planes along the occluders' edges. No area is
//! lost: pieces too small to cut off stay with their neighbours.
//!
//! ```
//! use glam::dvec2;
//! use pointillist_dice::ConvexPolygon;
//! use pointillist_dice::hide::Regions;
//!
//! // A unit square behind a bar that covers its left third, and glass that takes half of the light of its lower half.
//! let square = ConvexPolygon::rectangle(dvec2(0.0, 0.0), dvec2(1.0, 1.0));
//! let bar = ConvexPolygon::rectangle(dvec2(-1.0, -1.0), dvec2(1.0 / 3.0, 2.0));
//! let glass = ConvexPolygon::rectangle(dvec2(-1.0, 0.5), dvec2(2.0, 2.0));
//! let mut regions = Regions::default();
//! regions.start(square, 1e-13);
//! regions.attenuate(bar.vertices(), None, |_| 1.0);
//! regions.attenuate(glass.vertices(), None, |_| 0.5);
//! let light: f64 = regions.list().iter().map(|region| region.polygon.area() * region.transmittance).sum();
//! assert!((light - 2.0 / 3.0 * 0.75).abs() < 1e-15);
//! ```

use crate::convex::{self, ConvexPolygon, HalfPlane};
use glam::DVec2;

/// A part of a polygon and the light that reaches it.
#[derive(Clone, Copy, Debug)]
pub struct Region {
    /// Convex, positive order.
    pub polygon: ConvexPolygon,
    /// Product of `1 − opacity` of everything in front, 0..=1.
    pub transmittance: f64,
}

/// Transmittance below this counts as zero: it changes no bit of a picture.
const FAINT: f64 = 1e-12;

/// Parts whose areas differ by less, relative to their sum, are halves: which is the larger would be rounding.
const HALVES: f64 = 1e-9;

/// With more regions than this an occluder no longer divides a region that it overlaps, but scales its transmittance by the
/// covered share. Reached only where hundreds of occluders overlap in one place that halving does not separate.
const MOST_REGIONS: usize = 256;

/// The same limit for translucent occluders where more than [`FEW`] of them overlap and halving does not separate them. In foliage the
/// opacity of each is a mean over its region anyway. Up to [`FEW`] of them among any number of opaque ones divide their regions exactly.
const MOST_TRANSLUCENT_REGIONS: usize = 24;

/// Most occluders by which a polygon is divided at once. With more, the polygon is halved first: each half meets fewer, and the
/// pieces in one half are not cut by occluders of the other.
const FEW: usize = 12;

/// How often a polygon is halved. Halving that leaves more than three quarters of the occluders in a half counts as four times:
/// long slivers side by side are better cut one after the other.
const MOST_HALVINGS: u32 = 12;

/// What stands before a polygon, by numbers that the caller gives meaning to.
pub trait Occluders {
    /// Outline of an occluder: convex, positive order.
    fn outline(&self, number: u32) -> &[DVec2];
    /// Whether nothing passes through it anywhere.
    fn is_opaque(&self, number: u32) -> bool;
    /// Its mean opacity over a polygon inside it.
    fn opacity(&self, number: u32, over: &ConvexPolygon) -> f64;
}

/// An occluder and, if it is in front of the polygon in part only, where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blocker {
    /// The occluder, by the number that [`Occluders`] knows it by.
    pub number: u32,
    /// Where it is in front of the polygon; `None` for everywhere.
    pub front: Option<HalfPlane>,
}

/// A polygon divided into convex regions, each behind the same set of occluders.
///
/// Occluders may come in any order. Regions that nothing reaches any more are dropped, so that an
/// empty list means *hidden*. Memory is reused from one polygon to the next.
#[derive(Debug, Default)]
pub struct Regions {
    list: Vec<Region>,
    /// Where the polygon being divided begins in `list`.
    base: usize,
    /// The region at hand: what is inside the occluder, and the parts outside. Polygons that stay in place, since moving whole ones costs as much
    /// as cutting them.
    inside: ConvexPolygon,
    kept: ConvexPolygon,
    outside: Vec<ConvexPolygon>,
    /// How many of `outside` are in use; the others are memory.
    outside_count: usize,
    negligible: f64,
    /// Stack of the occluders of each half.
    stack: Vec<Blocker>,
}

impl Regions {
    /// Begins with a polygon that nothing hides. Parts of at most `negligible` area are not cut off: an overlap
    /// that small counts as outside of the occluder, a remainder that small as inside. So no area is lost: what is
    /// left behind sheets of one opacity has the whole polygon's area to rounding, however the sheets divide it.
    pub fn start(&mut self, polygon: ConvexPolygon, negligible: f64) {
        self.list.clear();
        self.base = 0;
        self.list.push(Region { polygon, transmittance: 1.0 });
        self.negligible = negligible;
    }

    /// Finds what is left of a polygon behind all of its blockers; see [`Regions::start`] for
    /// `negligible`. The same blockers in the same order give the same regions, bit for bit.
    pub fn hide(
        &mut self,
        polygon: ConvexPolygon,
        negligible: f64,
        blockers: &[Blocker],
        occluders: &impl Occluders,
    ) {
        self.list.clear();
        self.negligible = negligible;
        self.stack.clear();
        self.stack.extend_from_slice(blockers);
        self.hide_part(&polygon, 0, 0, occluders);
    }

    /// Adds what is left of a part of the polygon behind the blockers from `first` on the stack.
    fn hide_part(
        &mut self,
        polygon: &ConvexPolygon,
        first: usize,
        halvings: u32,
        occluders: &impl Occluders,
    ) {
        let end = self.stack.len();
        let count = end - first;
        if count <= FEW || halvings >= MOST_HALVINGS {
            self.base = self.list.len();
            self.list.push(Region { polygon: *polygon, transmittance: 1.0 });
            let is_translucent = |b: &Blocker| !occluders.is_opaque(b.number);
            let crowd = self.stack[first..].iter().filter(|b| is_translucent(b)).count() > FEW;
            for i in first..end {
                let Blocker { number, front } = self.stack[i];
                let translucent = !occluders.is_opaque(number);
                let most = if crowd && translucent { MOST_TRANSLUCENT_REGIONS } else { MOST_REGIONS };
                self.attenuate_up_to(most, occluders.outline(number), front, |p| {
                    occluders.opacity(number, p)
                });
                if self.list.len() == self.base {
                    break;
                }
            }
            return;
        }
        let (low, high) = polygon.bounds();
        let middle = 0.5 * (low + high);
        let wide = high.x - low.x >= high.y - low.y;
        let normal = if wide { DVec2::X } else { DVec2::Y };
        let (above, below) = polygon.divided(&HalfPlane { anchor: middle, normal, offset: 0.0 });
        if above.area().min(below.area()) <= self.negligible {
            // Nothing that small is cut off: it would be lost.
            return self.hide_part(polygon, first, MOST_HALVINGS, occluders);
        }
        for half in [below, above] {
            if self.push_blockers_of(&half, first..end, occluders) {
                let few = 4 * (self.stack.len() - end) <= 3 * count;
                self.hide_part(&half, end, halvings + if few { 1 } else { 4 }, occluders);
            }
            self.stack.truncate(end);
        }
    }

    /// Pushes the blockers that touch a half. Returns false if one of them hides it.
    fn push_blockers_of(
        &mut self,
        half: &ConvexPolygon,
        range: std::ops::Range<usize>,
        occluders: &impl Occluders,
    ) -> bool {
        let (low, high) = half.bounds();
        for i in range {
            let Blocker { number, front } = self.stack[i];
            let outline = occluders.outline(number);
            let (olow, ohigh) = convex::bounds(outline);
            if !(olow.cmplt(high).all() && ohigh.cmpgt(low).all())
                || convex::are_disjoint(half.vertices(), outline)
            {
                continue;
            }
            if front.is_none() && occluders.is_opaque(number) && convex::contains(outline, half.vertices()) {
                return false;
            }
            self.stack.push(Blocker { number, front });
        }
        true
    }

    /// Scales the light that reaches every region; those that get next to none are dropped.
    pub fn dim(&mut self, transmittance: f64) {
        self.list.retain_mut(|region| {
            region.transmittance *= transmittance;
            region.transmittance > FAINT
        });
    }

    /// The regions that some light reaches.
    #[must_use]
    pub fn list(&self) -> &[Region] {
        &self.list
    }

    /// Whether nothing is left.
    #[must_use]
    pub fn is_hidden(&self) -> bool {
        self.list.is_empty()
    }

    /// Puts an occluder in front: inside it, and inside `front` if given, light is scaled by
    /// `1 − opacity` of the overlap. `front` limits an occluder to where it is the nearer surface.
    pub fn attenuate(
        &mut self,
        occluder: &[DVec2],
        front: Option<HalfPlane>,
        opacity: impl FnMut(&ConvexPolygon) -> f64,
    ) {
        self.attenuate_up_to(MOST_REGIONS, occluder, front, opacity);
    }

    /// As [`Regions::attenuate`]; with more than `most` regions none is divided any more.
    fn attenuate_up_to(
        &mut self,
        most: usize,
        occluder: &[DVec2],
        front: Option<HalfPlane>,
        mut opacity: impl FnMut(&ConvexPolygon) -> f64,
    ) {
        let crowded = self.list.len() - self.base > most;
        // Backward, so that what is appended is not met again.
        for i in (self.base..self.list.len()).rev() {
            if !self.overlap(i, occluder, front.as_ref()) {
                continue;
            }
            let opacity = opacity(&self.inside);
            if opacity <= 0.0 {
                // A hole in a mask: not worth a cut.
                continue;
            }
            if crowded {
                let region = &mut self.list[i];
                let share = (self.inside.area() / region.polygon.area()).min(1.0);
                region.transmittance *= 1.0 - opacity * share;
                continue;
            }
            let transmittance = self.list[i].transmittance;
            self.list.swap_remove(i);
            let outside = self.outside[..self.outside_count].iter();
            self.list.extend(outside.map(|&polygon| Region { polygon, transmittance }));
            let passed = transmittance * (1.0 - opacity);
            if passed > FAINT {
                self.list.push(Region { polygon: self.inside, transmittance: passed });
            }
        }
    }

    /// Whether part of region `i` is inside the occluder: it is left in `self.inside`, and the parts outside in `self.outside`.
    fn overlap(&mut self, i: usize, occluder: &[DVec2], front: Option<&HalfPlane>) -> bool {
        let Self { list, inside, kept, outside, outside_count, .. } = self;
        *outside_count = 0;
        let region = &list[i].polygon;
        if region.has_separating_edge(occluder) {
            return false;
        }
        let mut edges = convex::half_planes(occluder).peekable();
        // An outline whose corners coincide has no edges that would cut anything off.
        if edges.peek().is_none() {
            return false;
        }
        inside.copy(region);
        for half in edges.chain(front.copied()) {
            if inside.vertices().iter().all(|&v| half.value(v) >= 0.0) {
                continue;
            }
            if outside.len() == *outside_count {
                outside.push(ConvexPolygon::EMPTY);
            }
            let cut_off = &mut outside[*outside_count];
            inside.divide_into(&half, kept, cut_off);
            if kept.is_empty() {
                return false;
            }
            if cut_off.area() > self.negligible {
                inside.copy(kept);
                *outside_count += 1;
            } else if is_less(kept, cut_off, half.normal) {
                return false;
            }
        }
        inside.area() > self.negligible
    }
}

/// Whether what is inside an edge is the lesser part, or of two halves the one on its left. Where two occluders meet in an edge and neither part is
/// large enough to be cut off, the whole is inside one of them, and not inside both.
fn is_less(inside: &ConvexPolygon, outside: &ConvexPolygon, normal: DVec2) -> bool {
    let (inside, outside) = (inside.area(), outside.area());
    if (inside - outside).abs() <= HALVES * (inside + outside) {
        return normal.x < 0.0 || (normal.x == 0.0 && normal.y < 0.0);
    }
    inside < outside
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec2;

    fn area(regions: &Regions) -> f64 {
        regions.list().iter().map(|r| r.polygon.area() * r.transmittance).sum()
    }

    #[test]
    fn two_crossing_bars_hide_their_union() {
        let cell = ConvexPolygon::rectangle(DVec2::ZERO, DVec2::ONE);
        let bars = [
            ConvexPolygon::rectangle(dvec2(0.4, -1.0), dvec2(0.6, 2.0)),
            ConvexPolygon::rectangle(dvec2(-1.0, 0.4), dvec2(2.0, 0.6)),
        ];
        let mut regions = Regions::default();
        regions.start(cell, 1e-12);
        for bar in &bars {
            regions.attenuate(bar.vertices(), None, |_| 1.0);
        }
        assert!((area(&regions) - 0.64).abs() < 1e-15);
        regions.start(cell, 1e-12);
        for bar in &bars {
            regions.attenuate(bar.vertices(), None, |_| 0.5);
        }
        assert!((area(&regions) - (0.64 + 0.32 * 0.5 + 0.04 * 0.25)).abs() < 1e-15);
    }

    #[test]
    fn the_front_half_plane_limits_an_occluder() {
        let cell = ConvexPolygon::rectangle(DVec2::ZERO, DVec2::ONE);
        let front = HalfPlane { anchor: dvec2(0.25, 0.0), normal: dvec2(1.0, 0.0), offset: 0.0 };
        let mut regions = Regions::default();
        regions.start(cell, 1e-12);
        regions.attenuate(cell.vertices(), Some(front), |_| 1.0);
        assert!((area(&regions) - 0.25).abs() < 1e-15);
        regions.attenuate(cell.vertices(), None, |_| 1.0);
        assert!(regions.is_hidden());
    }

    #[test]
    fn dimmed_regions_keep_their_share_and_dark_ones_go() {
        let square = ConvexPolygon::rectangle(DVec2::ZERO, DVec2::ONE);
        let glass = ConvexPolygon::rectangle(dvec2(0.0, 0.0), dvec2(0.5, 1.0));
        let mut regions = Regions::default();
        regions.start(square, 1e-12);
        regions.attenuate(glass.vertices(), None, |_| 0.5);
        regions.dim(0.25);
        assert!((area(&regions) - 0.25 * 0.75).abs() < 1e-15);
        regions.dim(6e-12);
        assert_eq!(regions.list().len(), 1, "behind the glass it is dark");
        regions.dim(0.0);
        assert!(regions.is_hidden());
    }

    #[test]
    fn from_one_region_too_many_on_they_are_dimmed_whole() {
        let square = ConvexPolygon::rectangle(DVec2::ZERO, DVec2::ONE);
        let left = ConvexPolygon::rectangle(DVec2::ZERO, dvec2(0.5, 1.0));
        let below = ConvexPolygon::rectangle(DVec2::ZERO, dvec2(1.0, 0.25));
        for (most, count) in [(1, 2), (2, 4)] {
            let mut regions = Regions::default();
            regions.start(square, 1e-12);
            regions.attenuate_up_to(most, left.vertices(), None, |_| 0.5);
            assert_eq!(regions.list().len(), 2, "one region is divided if it is all that there may be");
            regions.attenuate_up_to(most, below.vertices(), None, |_| 0.5);
            assert_eq!(regions.list().len(), count, "two, of which there may be {most}");
            // A quarter of each is dimmed by half, divided or not.
            assert!((area(&regions) - 0.75 * 0.875).abs() < 1e-15, "{}", area(&regions));
        }
    }

    /// Opaque triangles, and translucent ones after them.
    struct Tiles {
        triangles: Vec<[DVec2; 3]>,
        opaque: usize,
    }

    impl Occluders for Tiles {
        fn outline(&self, number: u32) -> &[DVec2] {
            &self.triangles[number as usize]
        }
        fn is_opaque(&self, number: u32) -> bool {
            (number as usize) < self.opaque
        }
        fn opacity(&self, number: u32, _: &ConvexPolygon) -> f64 {
            if self.is_opaque(number) { 1.0 } else { 0.25 }
        }
    }

    /// What is left of the unit square behind the tiles.
    fn left_behind(tiles: &Tiles) -> f64 {
        let blockers: Vec<Blocker> =
            (0..tiles.triangles.len() as u32).map(|number| Blocker { number, front: None }).collect();
        let mut regions = Regions::default();
        regions.hide(ConvexPolygon::rectangle(DVec2::ZERO, DVec2::ONE), 1e-12, &blockers, tiles);
        area(&regions)
    }

    #[test]
    fn a_few_translucent_occluders_among_many_opaque_ones_are_exact() {
        // A fan of slivers about a point: halving does not separate them, and they leave more than a hundred regions.
        let centre = dvec2(0.51, 0.48);
        let ray = |turns: f64| centre + 2.0 * DVec2::from_angle(turns * std::f64::consts::TAU);
        let n = 60;
        let fan = (0..n).map(|i| {
            let turns = f64::from(i) / f64::from(n);
            [centre, ray(turns), ray(turns + 0.3 / f64::from(n))]
        });
        let mut tiles = Tiles { triangles: fan.collect(), opaque: n as usize };
        let without = left_behind(&tiles);
        let glass = [dvec2(0.3, 0.2), dvec2(0.9, 0.35), dvec2(0.45, 0.8)];
        let inside_glass = |sliver| {
            let polygon = ConvexPolygon::from_vertices(&glass);
            convex::half_planes(sliver).fold(polygon, |p, half| p.clipped(&half)).area()
        };
        let opaque_in_glass: f64 = tiles.triangles.iter().map(|s| inside_glass(s)).sum();
        tiles.triangles.extend([glass, glass]);
        let expected = without - (1.0 - 0.75 * 0.75) * (convex::area(&glass) - opaque_in_glass);
        assert!((left_behind(&tiles) - expected).abs() < 1e-10, "{} {expected}", left_behind(&tiles));
    }

    #[test]
    fn a_thousand_small_occluders_hide_exactly_what_they_cover() {
        let n = 24;
        let mut tiles = Vec::new();
        for i in 0..n * n {
            let low = dvec2(f64::from(i % n), f64::from(i / n)) / f64::from(n);
            let (e, f) = (DVec2::X / f64::from(n), DVec2::Y / f64::from(n));
            tiles.push([low, low + e, low + f]);
            // One column is left half open.
            if i % n != 7 {
                tiles.push([low + e, low + e + f, low + f]);
            }
        }
        let tiles = Tiles { opaque: tiles.len(), triangles: tiles };
        assert!((left_behind(&tiles) - 0.5 / f64::from(n)).abs() < 1e-9);
    }

    #[test]
    fn slivers_too_small_to_cut_off_are_not_lost() {
        // Two sheets of one opacity that meet in a line through the cell, a sliver of less than `negligible` away
        // from its corner: whatever side the sliver is counted to, the sheets take the same light from all of the cell.
        let cell = ConvexPolygon::rectangle(DVec2::ZERO, DVec2::ONE);
        for offset in [0.0, 1e-7, 1e-6, 1e-5, 3.2e-5, 1e-4, 1e-3] {
            let (a, b) = (dvec2(3.0 - offset, -1.0), dvec2(-1.0 - offset, 3.0));
            let sheets = [[a, b, dvec2(-9.0, -9.0)], [b, a, dvec2(9.0, 9.0)]];
            for sheets in [sheets, [sheets[1], sheets[0]]] {
                let mut regions = Regions::default();
                regions.start(cell, 1e-9);
                for sheet in &sheets {
                    let positive =
                        if convex::area(sheet) > 0.0 { *sheet } else { [sheet[1], sheet[0], sheet[2]] };
                    regions.attenuate(&positive, None, |_| 0.25);
                }
                assert!((area(&regions) - 0.75).abs() < 1e-15, "{offset}: {}", area(&regions));
            }
        }
    }

    #[test]
    fn slivers_in_which_two_sheets_meet_are_dimmed_once() {
        // So small that neither half can be cut off.
        let cell = ConvexPolygon::rectangle(DVec2::ZERO, DVec2::splat(1e-5));
        for along in [dvec2(0.0, 1.0), dvec2(1.0, 0.3), dvec2(-0.2, 1.0)] {
            for shift in [0.0, 1e-6, -2e-6] {
                let middle = DVec2::splat(5e-6 + shift);
                let (a, b) = (middle - along, middle + along);
                let sheets = [[a, b, middle - along.perp()], [b, a, middle + along.perp()]];
                let mut regions = Regions::default();
                regions.start(cell, 0.8e-10);
                for sheet in sheets {
                    let positive =
                        if convex::area(&sheet) > 0.0 { sheet } else { [sheet[1], sheet[0], sheet[2]] };
                    regions.attenuate(&positive, None, |_| 0.25);
                }
                assert!((area(&regions) / 1e-10 - 0.75).abs() < 1e-12, "{along} {shift}: {}", area(&regions));
            }
        }
    }

    #[test]
    fn neighbours_leave_each_other_alone() {
        let mut regions = Regions::default();
        regions.start(ConvexPolygon::rectangle(DVec2::ZERO, DVec2::ONE), 1e-12);
        let neighbour = ConvexPolygon::rectangle(dvec2(1.0, 0.0), dvec2(2.0, 1.0));
        regions.attenuate(neighbour.vertices(), None, |_| 1.0);
        assert_eq!(regions.list().len(), 1);
        assert_eq!(area(&regions), 1.0);
    }
}
