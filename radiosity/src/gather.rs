//! Irradiance at free points, by Lambert's formula for the visible parts of patches.

use glam::DVec3;

use crate::error::RadiosityError;
use crate::polygon::Polygon;
use crate::rgb::Rgb;
use crate::solve::Solution;
use crate::tree::ElementId;
use crate::visible::parts::{Eye, Pieces, Source};
use pointillist_dice::lambert;

/// Elements whose radius is below this share of their distance are not divided into their children.
const FAR: f64 = 0.15;

impl Solution<'_> {
    /// Irradiance at a point with a normal (of any length) from all patches by Lambert's formula, patches far away taken
    /// together with their neighbours. Light of lamps is not in it.
    ///
    /// `visibility`: whether surfaces hide what is behind them; without, in convex rooms, it is faster.
    ///
    /// # Errors
    /// [`RadiosityError::BadPoint`].
    pub fn irradiance(&self, point: DVec3, normal: DVec3, visibility: bool) -> Result<Rgb, RadiosityError> {
        let (Some(normal), true) = (normal.try_normalize(), point.is_finite()) else {
            return Err(RadiosityError::BadPoint);
        };
        let mut gather = Gather {
            solution: self,
            point: self.transport.scene.inward(point),
            normal,
            visibility,
            sum: [0.0; 3],
            pieces: Pieces::default(),
            near: vec![],
        };
        for &root in &self.transport.scene.tree.roots {
            gather.visit(root);
        }
        Ok(gather.sum)
    }
}

struct Gather<'t> {
    solution: &'t Solution<'t>,
    point: DVec3,
    normal: DVec3,
    visibility: bool,
    sum: Rgb,
    pieces: Pieces,
    near: Vec<u32>,
}

impl Gather<'_> {
    fn visit(&mut self, id: ElementId) {
        let element = &self.solution.transport.scene.tree.elements[id as usize];
        let polygon = &element.polygon;
        if self.solution.by_area[id as usize] == [0.0; 3] || polygon.height(self.point) <= 0.0 {
            return;
        }
        if polygon.vertices().iter().all(|&v| self.normal.dot(v - self.point) <= 0.0) {
            return;
        }
        let distance = (polygon.centre() - self.point).length();
        if !element.is_leaf() && polygon.radius() > FAR * distance {
            element.children().for_each(|child| self.visit(child));
            return;
        }
        let share = if self.visibility { self.seen(polygon) } else { self.whole(polygon) };
        let light = self.solution.by_area[id as usize];
        for (s, l) in self.sum.iter_mut().zip(light) {
            *s += share * l;
        }
    }

    fn whole(&self, polygon: &Polygon) -> f64 {
        lambert::share_above_horizon(self.point, self.normal, polygon.vertices()).max(0.0)
    }

    fn seen(&mut self, polygon: &Polygon) -> f64 {
        let (low, high) = polygon
            .vertices()
            .iter()
            .fold((self.point, self.point), |(low, high), &v| (low.min(v), high.max(v)));
        self.solution.transport.scene.boxes.in_box(low, high, &mut self.near);
        let occluders = &self.solution.transport.scene.occluders;
        let list = self.near.iter().map(|&i| &occluders[i as usize]);
        visible_share(self.point, self.normal, polygon, list, &mut self.pieces)
    }
}

/// Share of the hemisphere over `point` that a polygon takes past occluders; what is below the horizon is left out.
pub(crate) fn visible_share<'p>(
    point: DVec3,
    normal: DVec3,
    polygon: &Polygon,
    occluders: impl Iterator<Item = &'p Polygon>,
    pieces: &mut Pieces,
) -> f64 {
    let above = |v: DVec3| normal.dot(v - point);
    if polygon.vertices().iter().all(|&v| above(v) >= 0.0) {
        let source = Source::new(polygon);
        let (seen, _) = source.see(Eye::Point(point), occluders, pieces);
        return source.share(point, normal, seen).max(0.0);
    }
    let Some(part) = Polygon::unchecked(crate::polygon::clipped(polygon.vertices(), above)) else {
        return 0.0;
    };
    let source = Source::new(&part);
    let (seen, _) = source.see(Eye::Point(point), occluders, pieces);
    source.share(point, normal, seen).max(0.0)
}
