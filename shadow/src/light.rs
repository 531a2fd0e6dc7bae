//! One light and the fractions of it that reach receivers.

use crate::casters::{Casters, Nearby};
use crate::cells::LightCells;
use crate::ends::Shadow;
use crate::error::ShadowError;
use crate::grid::LightGrid;
use crate::lit_regions::LitRegions;
use crate::options::{Resolution, ShadowOptions};
use crate::query::{Measure, Query, is_edge_on};
use crate::receiver::{Receivers, Viewer};
use crate::scratch::{LitFaces, RuleMemory, ShadowScratch, Side, Sum};
use crate::screen::{Emitter, Screens, sees};
use crate::target::{Target, Targets, WHOLE_FACE};
use crate::whole_faces;
use crate::{copies, exact, layers};
use glam::{DVec2, DVec3};
use pointillist_dice::{ConvexPolygon, clip_ring, share_before_crossing};
use pointillist_micropoint::{
    Bounds, DepthRange, Face, FaceVisitor, Geometry, GridRect, Interval, Lens, LensKind, Occlusion,
    ProjectedVertex, Setup, SurfaceOpacity, TexturedOpacity,
};

/// A light with its screens, ready to be asked from any thread.
pub struct ShadowLight<'a> {
    geometry: &'a Geometry,
    opacity: &'a dyn TexturedOpacity,
    emitter: Emitter,
    screens: Screens,
    options: ShadowOptions,
}

/// Sine of the angle between a surface and its light below which the surface is edge-on, within the rounding of its normal.
const EDGE_ON: f64 = 1e-12;

impl<'a> ShadowLight<'a> {
    /// Sets up the screens of a light.
    ///
    /// # Errors
    /// [`ShadowError`] if the light has no usable position or direction, the resolution is 0 or
    /// above 2²⁰, or the squares under masks are not 1, 2 or 4.
    pub fn new(
        geometry: &'a Geometry,
        opacity: &'a dyn TexturedOpacity,
        emitter: Emitter,
        options: ShadowOptions,
    ) -> Result<Self, ShadowError> {
        if let Resolution::Cells(n) = options.resolution
            && !(1..=1 << 20).contains(&n)
        {
            return Err(ShadowError::BadResolution(n));
        }
        if !matches!(options.squares_under_masks, 1 | 2 | 4) {
            return Err(ShadowError::BadSquaresUnderMasks(options.squares_under_masks));
        }
        let screens = Screens::new(emitter, geometry)?;
        Ok(Self { geometry, opacity, emitter, screens, options })
    }

    /// Promises that all receivers are seen by this lens, which makes shadows of solids cheaper: those
    /// that the lens is outside of cast by the faces turned away from the light.
    #[must_use]
    pub fn seen_from(mut self, viewer: &Lens) -> Self {
        self.screens.hidden = self.screens.hidden.of_casters(&self.geometry.hidden_sides(viewer));
        self
    }

    /// The fraction of this light, 0..=1, that reaches each receiver, in their order.
    ///
    /// A receiver that shows the viewer a side turned away from the light gets 0. What a receiver gets
    /// depends on the receiver, the viewer and the scene only, not on its companions.
    pub fn lit(
        &self,
        viewer: Viewer<'_>,
        receivers: &Receivers,
        scratch: &mut ShadowScratch,
        lit: &mut Vec<f64>,
    ) {
        scratch.begin(receivers.len(), viewer.faces.len(), self.light_cells());
        self.collect_targets(viewer, receivers, scratch);
        for screen in 0..self.screens.lenses.len() {
            let targets = &scratch.targets.list;
            if scratch.grid.sort(targets, screen, self.options.resolution, self.screens.size) {
                scratch.counts.screens += 1;
                self.collect_casters(screen, scratch);
                self.resolve_groups(screen, viewer, receivers, scratch);
            }
        }
        scratch.lit_regions.sort();
        lit.clear();
        lit.extend(scratch.sums.iter().map(Sum::fraction));
    }

    /// The light cells of the paper's rule.
    fn light_cells(&self) -> Option<LightCells> {
        match (self.options.occlusion, self.options.resolution) {
            (Occlusion::Correlated, _) => None,
            (Occlusion::Paper, Resolution::Auto) => Some(LightCells { size: None }),
            (Occlusion::Paper, Resolution::Cells(n)) => {
                Some(LightCells { size: Some(self.screens.size / f64::from(n)) })
            }
        }
    }

    /// Receivers on lit sides, on the screens that see them.
    fn collect_targets(&self, viewer: Viewer<'_>, receivers: &Receivers, scratch: &mut ShadowScratch) {
        scratch.counts.receivers += receivers.list.len() as u64;
        for (index, r) in receivers.list.iter().enumerate() {
            let face = &viewer.faces[r.face as usize];
            let side = match scratch.sides[r.face as usize] {
                Side::Unknown => match self.lit_side(face) {
                    Side::Lit if self.push_whole(viewer, r.face, &mut scratch.targets) => Side::LitWhole,
                    side => side,
                },
                known => known,
            };
            scratch.sides[r.face as usize] = side;
            match side {
                Side::Dark => {
                    scratch.counts.facing_away += 1;
                    continue;
                }
                Side::LitWhole => {
                    scratch.by_face.add(r.face, index as u32);
                    continue;
                }
                Side::Lit | Side::Unknown => {}
            }
            let corners = receivers.corners(viewer, r);
            let offset = viewer.lens.origin - self.screens.lenses[0].origin;
            let count = self.screens.lenses.len();
            // Where two screens see all of it, the choice must not depend on other receivers.
            let likely = self.screens.facing(corners.clone().next().map_or(DVec3::ZERO, |c| c + offset));
            let ShadowScratch { targets, local, .. } = scratch;
            let mut sees_all = |&screen: &usize| {
                let lens = &self.screens.lenses[screen];
                local.clear();
                local.extend(corners.clone().map(|c| lens.local_vector(c + offset)));
                local.iter().all(|&p| sees(lens, p))
            };
            if let Some(screen) = std::iter::once(likely).chain(0..count).find(&mut sees_all) {
                let lens = &self.screens.lenses[screen];
                targets.push((index as u32, r.face), screen, false, local.iter().map(|&p| placed(lens, p)));
            } else {
                for screen in 0..count {
                    let receiver = (index as u32, r.face);
                    self.push_clipped(receiver, screen, corners.clone(), offset, &mut scratch.targets);
                }
            }
        }
    }

    /// Makes a target of a whole face, if it is small and one screen sees all of it.
    fn push_whole(&self, viewer: Viewer<'_>, index: u32, targets: &mut Targets) -> bool {
        let face = &viewer.faces[index as usize];
        if self.options.occlusion == Occlusion::Paper || !whole_faces::is_small(viewer.lens, face.corners) {
            return false;
        }
        let corners = self.geometry.corners(face.source);
        let screen = self.screens.facing(corners[0] - self.screens.lenses[0].origin);
        let lens = &self.screens.lenses[screen];
        let local = corners.map(|c| lens.local(c));
        if !local.iter().all(|&p| sees(lens, p)) {
            return false;
        }
        targets.push((WHOLE_FACE, index), screen, false, local.iter().map(|&p| placed(lens, p)));
        true
    }

    fn lit_side(&self, face: &Face) -> Side {
        let [a, b, c] = self.geometry.corners(face.source);
        let normal = (b - a).cross(c - a);
        let towards = match self.emitter {
            Emitter::Point { position, .. } => position - a,
            Emitter::Directional { direction } => -direction,
        };
        let slope = normal.normalize_or_zero().dot(towards.normalize_or_zero());
        // Edge-on to the light: its area on the screen is rounding, and so is the light that it gets.
        let towards = if slope.abs() > EDGE_ON { slope } else { 0.0 };
        if (face.front && towards > 0.0) || (!face.front && towards < 0.0) { Side::Lit } else { Side::Dark }
    }

    /// A receiver across the edge of a screen: the part that this screen sees.
    #[cold]
    fn push_clipped(
        &self,
        receiver: (u32, u32),
        screen: usize,
        corners: impl Iterator<Item = DVec3>,
        offset: DVec3,
        targets: &mut Targets,
    ) {
        let lens = &self.screens.lenses[screen];
        let mut ring: Vec<DVec3> = corners.map(|c| lens.local_vector(c + offset)).collect();
        let sides = [
            DVec3::new(1.0, 0.0, 1.0),
            DVec3::new(-1.0, 0.0, 1.0),
            DVec3::new(0.0, 1.0, 1.0),
            DVec3::new(0.0, -1.0, 1.0),
        ];
        for normal in sides {
            let mut clipped = Vec::with_capacity(ring.len() + 1);
            let crossing = |(a, va): (DVec3, f64), (b, vb)| a + (b - a) * share_before_crossing(va, vb);
            clip_ring(&ring, |p| normal.dot(p), crossing, |p| clipped.push(p));
            ring = clipped;
        }
        if ring.len() >= 3 && ring.iter().all(|p| p.z > 0.0) {
            targets.push(receiver, screen, true, ring.iter().map(|&p| placed(lens, p)));
        }
    }

    /// The receiver's own triangle as the light sees it: casters are compared with its plane.
    fn face_on_screen(&self, face: &Face, screen: usize) -> Face {
        let lens = &self.screens.lenses[screen];
        let corners = self.geometry.corners(face.source).map(|p| lens.local(p));
        let least = corners.iter().map(|p| p.z).fold(f64::INFINITY, f64::min);
        let nearness = if lens.kind == LensKind::Perspective && least <= 0.0 {
            Interval { least: 0.0, most: f64::INFINITY }
        } else {
            let q = corners.map(|p| lens.nearness(p.z));
            Interval { least: q[0].min(q[1]).min(q[2]), most: q[0].max(q[1]).max(q[2]) }
        };
        Face { corners, nearness, plane: lens.plane(corners), ..*face }
    }

    /// Finds the triangles between the light and the targets, and links them to the groups that they
    /// may darken.
    fn collect_casters(&self, screen: usize, scratch: &mut ShadowScratch) {
        let lens = &self.screens.lenses[screen];
        let ShadowScratch { grid, casters, visit, counts, copy_keys, .. } = scratch;
        casters.clear();
        let (low, high) = grid.bounds();
        let all = self.options.occlusion == Occlusion::Paper;
        let farthest = if all { f64::INFINITY } else { lens.depth(grid.least_nearness) };
        let setup = Setup {
            lens,
            rect: &self.screens.rect,
            hidden: &self.screens.hidden,
            keeps_backs: true,
            range: DepthRange::ALL,
        };
        let mut linker = Linker { lens, farthest, grid, casters, linked: 0, unlinked: 0 };
        let seen = self.geometry.visit_faces(&setup, &GridRect { low, high }, farthest, visit, &mut linker);
        counts.clusters += seen.clusters;
        counts.clusters_skipped += seen.clusters_skipped;
        counts.casters += linker.linked;
        counts.casters_culled += seen.triangles_culled + linker.unlinked;
        if self.options.occlusion == Occlusion::Correlated {
            copies::merge(&mut casters.list, copy_keys);
        }
    }

    fn resolve_groups(
        &self,
        screen: usize,
        viewer: Viewer<'_>,
        receivers: &Receivers,
        scratch: &mut ShadowScratch,
    ) {
        let ShadowScratch {
            grid,
            casters,
            nearby,
            targets,
            by_face,
            single,
            whole_face,
            lit_faces,
            rules,
            counts,
            sums,
            lit_regions,
            ..
        } = scratch;
        let mut work = Work { screen, viewer, receivers, lit_faces, rules, lit_regions };
        let mut lit_part = ConvexPolygon::EMPTY;
        for group in &grid.groups {
            casters.of_group(group, nearby);
            let settled = if group.dark { Some(0.0) } else { nearby.is_empty().then_some(1.0) };
            let query = self.query(screen, casters, nearby);
            work.rules.exact.start_group();
            for &t in &grid.order[group.first_target as usize..group.end_target as usize] {
                let target = &targets.list[t as usize];
                let outline = targets.outline(target);
                if target.receiver != WHOLE_FACE {
                    counts.settle(settled, 1);
                    let shadow = settled.map_or(Shadow::Unknown, Shadow::Even);
                    let part = self.resolve(&query, target, outline, &shadow, &mut work);
                    sums[target.receiver as usize].add(part);
                    continue;
                }
                let settled = settled.or_else(|| {
                    let face = work.face(self, target.face);
                    whole_face.look(&query, target, (face, outline))
                });
                let query = Query { nearby: &whole_face.casters, ..query };
                work.rules.exact.start_group();
                for receiver in by_face.receivers(target.face) {
                    counts.settle(settled, 1);
                    if let Some(fraction) = settled {
                        sums[receiver as usize].add((fraction, 1.0));
                        continue;
                    }
                    single.clear(None);
                    let offset = viewer.lens.origin - query.lens.origin;
                    let corners = receivers.corners(viewer, &receivers.list[receiver as usize]);
                    let local = corners.map(|c| query.lens.local_vector(c + offset));
                    single.push((receiver, target.face), screen, false, local.map(|p| placed(query.lens, p)));
                    if let [target] = &single.list[..] {
                        let outline = single.outline(target);
                        let shadow = whole_face.shadow_on(&query, outline, &mut lit_part);
                        let part = self.resolve(&query, target, outline, &shadow, &mut work);
                        sums[receiver as usize].add(part);
                    }
                }
                work.rules.exact.start_group();
            }
        }
        counts.partial += work.rules.take_partial();
    }

    /// The lit fraction of a target, and its weight among the parts of its receiver.
    fn resolve(
        &self,
        query: &Query<'_>,
        target: &Target,
        outline: &[DVec2],
        shadow: &Shadow<'_>,
        work: &mut Work<'_>,
    ) -> (f64, f64) {
        // A receiver on one screen needs no weight, and keeps a plain 0 or 1.
        if let Shadow::Even(fraction) = *shadow
            && !target.shared
        {
            return (fraction, 1.0);
        }
        let wanted = self.wanted(work.viewer, work.receivers, target);
        let lit_regions = &mut *work.lit_regions;
        let Work { screen, viewer, lit_faces, .. } = work;
        let make = || self.face_on_screen(&viewer.faces[target.face as usize], *screen);
        let face = lit_faces.get(target.face, *screen, make);
        let measure = Measure { lens: query.lens, viewer: work.viewer.lens, face };
        let total = if target.shared { measure.area(outline) } else { 1.0 };
        let mut regions = wanted.then_some(lit_regions);
        let fraction = match shadow {
            Shadow::Even(fraction) => {
                // What another screen sees of the same receiver may be dark.
                if let (Some(regions), 1.0) = (&mut regions, fraction) {
                    regions.push(target.receiver, outline, total, &measure);
                }
                *fraction
            }
            Shadow::AllBut(lit) => {
                let weight = measure.area(lit.vertices());
                if let Some(regions) = regions {
                    regions.push(target.receiver, lit.vertices(), weight, &measure);
                }
                work.rules.exact.partial += 1;
                let whole = measure.area(outline);
                if whole > 0.0 { (weight / whole).min(1.0) } else { 0.0 }
            }
            Shadow::Unknown => self.lit_fraction(query, target, outline, &measure, work.rules, regions),
        };
        (fraction, total)
    }

    /// Whether the lit regions of a target are asked for, and known.
    fn wanted(&self, viewer: Viewer<'_>, receivers: &Receivers, target: &Target) -> bool {
        self.options.occlusion == Occlusion::Correlated
            && receivers.list[target.receiver as usize].wants_regions
            && !is_edge_on(viewer.lens, &viewer.faces[target.face as usize])
    }

    fn query<'q>(&'q self, screen: usize, casters: &'q Casters, nearby: &'q [Nearby]) -> Query<'q> {
        let Casters { list, sides, vertices, .. } = casters;
        let lens = &self.screens.lenses[screen];
        Query { lens, geometry: self.geometry, opacity: self.opacity, casters: list, sides, vertices, nearby }
    }

    fn lit_fraction(
        &self,
        query: &Query<'_>,
        target: &Target,
        outline: &[DVec2],
        measure: &Measure<'_>,
        rules: &mut RuleMemory,
        regions: Option<&mut LitRegions>,
    ) -> f64 {
        match self.light_cells() {
            None => {
                let squares = self.options.squares_under_masks;
                exact::lit_fraction(query, target, outline, (measure, squares), &mut rules.exact, regions)
            }
            Some(cells) => layers::lit_fraction(query, outline, measure.face, cells, &mut rules.layers),
        }
    }
}

/// What resolving targets needs besides casters.
struct Work<'s> {
    screen: usize,
    viewer: Viewer<'s>,
    receivers: &'s Receivers,
    lit_faces: &'s mut LitFaces,
    rules: &'s mut RuleMemory,
    lit_regions: &'s mut LitRegions,
}

impl Work<'_> {
    /// A face of the viewer in the frame of the screen.
    fn face(&mut self, light: &ShadowLight<'_>, face: u32) -> &Face {
        let make = || light.face_on_screen(&self.viewer.faces[face as usize], self.screen);
        self.lit_faces.get(face, self.screen, make)
    }
}

/// Links triangles to the groups of targets that they may darken.
struct Linker<'s> {
    lens: &'s Lens,
    farthest: f64,
    grid: &'s mut LightGrid,
    casters: &'s mut Casters,
    linked: u64,
    unlinked: u64,
}

impl FaceVisitor for Linker<'_> {
    #[inline]
    fn wants(&self, bounds: &Bounds) -> bool {
        self.grid.may_be_darkened_by(self.lens, bounds)
    }

    #[inline]
    fn skips(&self, corners: [&ProjectedVertex; 3], surface: &SurfaceOpacity) -> bool {
        surface.opacity <= 0.0 || self.grid.is_missed_by(corners)
    }

    #[inline]
    fn visit(&mut self, face: Face, outline: &[DVec2], opacity: Option<f32>) {
        if self.casters.link(&face, outline, opacity, self.grid) {
            self.linked += 1;
        } else {
            self.unlinked += 1;
        }
    }

    fn farthest(&self) -> f64 {
        if self.grid.open_groups == 0 { f64::NEG_INFINITY } else { self.farthest }
    }
}

/// A point of a lens's frame on its grid, with its nearness.
fn placed(lens: &Lens, local: DVec3) -> (DVec2, f64) {
    (lens.project(local), lens.nearness(local.z))
}
