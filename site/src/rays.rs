//! Rectangles that rays meet, with the light that leaves them.

use glam::DVec3;

/// A rectangle, and its radiosity on a grid.
pub(crate) struct Panel {
    pub(crate) origin: DVec3,
    /// Two sides; their cross product is the normal of the side that is lit.
    pub(crate) sides: [DVec3; 2],
    /// Nodes along each of them.
    pub(crate) nodes: [usize; 2],
    /// Radiosity at the nodes, row by row along the first side.
    pub(crate) light: Vec<DVec3>,
}

/// What a ray meets.
pub(crate) struct Met<'a> {
    pub(crate) panel: &'a Panel,
    /// In lengths of the direction.
    pub(crate) distance: f64,
    /// Place on the panel, each from 0 to 1 along its side.
    pub(crate) place: [f64; 2],
}

impl Panel {
    pub(crate) fn at(&self, [u, v]: [f64; 2]) -> DVec3 {
        self.origin + u * self.sides[0] + v * self.sides[1]
    }

    /// The radiosity between nodes.
    pub(crate) fn light(&self, place: [f64; 2]) -> DVec3 {
        let node = |k: usize| {
            let cells = (self.nodes[k] - 1) as f64;
            let at = (place[k] * cells).clamp(0.0, cells);
            let low = at.floor().min(cells - 1.0);
            (low as usize, at - low)
        };
        let ((x, s), (y, t)) = (node(0), node(1));
        let row = |y: usize| {
            let first = y * self.nodes[0] + x;
            self.light[first].lerp(self.light[first + 1], s)
        };
        row(y).lerp(row(y + 1), t)
    }

    fn meet(&self, origin: DVec3, direction: DVec3) -> Option<Met<'_>> {
        let normal = self.sides[0].cross(self.sides[1]);
        let distance = (self.origin - origin).dot(normal) / direction.dot(normal);
        let offset = origin + distance * direction - self.origin;
        let place = self.sides.map(|side| offset.dot(side) / side.length_squared());
        // NaN, of a ray along the plane, fails too.
        let is_met = distance > 0.0 && place.iter().all(|p| (0.0..=1.0).contains(p));
        is_met.then_some(Met { panel: self, distance, place })
    }
}

/// The first panel in a direction.
pub(crate) fn first(panels: &[Panel], origin: DVec3, direction: DVec3) -> Option<Met<'_>> {
    let met = panels.iter().filter_map(|panel| panel.meet(origin, direction));
    met.min_by(|a, b| a.distance.total_cmp(&b.distance))
}
