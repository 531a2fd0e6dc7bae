//! Receivers on the screens of a light.

use crate::cells::LightCells;
use glam::DVec2;
use pointillist_dice::convex;
use pointillist_micropoint::Interval;

/// In the place of a receiver: the target is a whole face of the viewer.
pub(crate) const WHOLE_FACE: u32 = u32::MAX;

/// A receiver on a light screen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Target {
    pub(crate) receiver: u32,
    pub(crate) screen: u8,
    /// Index of the viewer's face.
    pub(crate) face: u32,
    first_vertex: u32,
    vertex_count: u32,
    pub(crate) bounds: (DVec2, DVec2),
    /// Least and largest nearness of a corner.
    pub(crate) nearness: Interval,
    pub(crate) area: f64,
    /// The receiver lies on more than one screen: its parts are weighed by their areas in the picture.
    pub(crate) shared: bool,
}

/// The targets of one batch, on all screens.
#[derive(Debug, Default)]
pub(crate) struct Targets {
    pub(crate) list: Vec<Target>,
    vertices: Vec<DVec2>,
    light_cells: Option<LightCells>,
}

impl Targets {
    /// Removes all targets and keeps the memory. `light_cells` is for the paper's rule.
    pub(crate) fn clear(&mut self, light_cells: Option<LightCells>) {
        self.list.clear();
        self.vertices.clear();
        self.light_cells = light_cells;
    }

    /// Adds a target; its outline in either winding, with the nearness of each corner.
    pub(crate) fn push(
        &mut self,
        (receiver, face): (u32, u32),
        screen: usize,
        shared: bool,
        outline: impl Iterator<Item = (DVec2, f64)>,
    ) {
        let first = self.vertices.len();
        let mut nearness = Interval::EMPTY;
        for (v, q) in outline {
            self.vertices.push(v);
            nearness.include(q);
        }
        let outline = &mut self.vertices[first..];
        let area = convex::area(outline);
        // A receiver without corners, or with a corner that is not finite, gets no light.
        if outline.is_empty() || !area.is_finite() || !outline.iter().all(|v| v.is_finite()) {
            self.vertices.truncate(first);
            return;
        }
        if area < 0.0 {
            outline.reverse();
        }
        let mut bounds = convex::bounds(outline);
        if let Some(cells) = &self.light_cells {
            // Whatever shares a cell with the target may merge into a layer with its casters.
            bounds = cells.around(bounds);
            nearness = Interval::ALL;
        }
        self.list.push(Target {
            receiver,
            screen: screen as u8,
            face,
            first_vertex: first as u32,
            vertex_count: outline.len() as u32,
            bounds,
            nearness,
            area: area.abs(),
            shared,
        });
    }

    /// Outline of a target on its screen, in positive order.
    #[inline]
    pub(crate) fn outline(&self, target: &Target) -> &[DVec2] {
        &self.vertices[target.first_vertex as usize..][..target.vertex_count as usize]
    }
}
