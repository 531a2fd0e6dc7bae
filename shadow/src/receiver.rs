//! What light falls on: convex pieces of surfaces, as a viewer sees them.

use glam::{DVec2, DVec3};
use pointillist_micropoint::{Face, Fragment, Lens, Micropoint, Tile};
use std::sync::OnceLock;

/// Convex planar pieces that may be lit. Corners are relative to the viewer's lens, in world axes, or on its grid.
#[derive(Debug, Default)]
pub struct Receivers {
    pub(crate) list: Vec<Receiver>,
    /// Corners of the pieces that were given in world axes.
    vertices: Vec<DVec3>,
    /// Corners of the pieces that were given on the viewer's grid.
    outlines: Vec<DVec2>,
    /// The box around all corners, once it was asked for: lights that are points never ask.
    around: OnceLock<(DVec3, DVec3)>,
    /// Pieces that do not join the one before.
    wholes: usize,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Receiver {
    pub(crate) face: u32,
    first_vertex: u32,
    vertex_count: u32,
    /// Its corners are on the viewer's grid.
    on_grid: bool,
    /// It is a piece of the same receiver as the one before, for lights with an area.
    pub(crate) joins: bool,
    /// Its share of that receiver.
    pub(crate) weight: f64,
    /// What it gives to the picture over what it would give with nothing in front.
    pub(crate) visibility: f64,
    /// Its lit regions are kept, too.
    pub(crate) wants_regions: bool,
}

impl Receivers {
    /// Removes all pieces and keeps the memory.
    pub fn clear(&mut self) {
        self.list.clear();
        self.vertices.clear();
        self.outlines.clear();
        self.around = OnceLock::new();
        self.wholes = 0;
    }

    /// A box around all corners: its lowest and its highest corner, relative to the viewer's lens. `None` if there are none.
    ///
    /// All calls up to the next [`Receivers::clear`] must be for the same viewer.
    #[must_use]
    pub fn bounds(&self, viewer: Viewer<'_>) -> Option<(DVec3, DVec3)> {
        let mut corners = self.list.iter().flat_map(|r| self.corners(viewer, r)).peekable();
        let first = *corners.peek()?;
        let grow = |(low, high): (DVec3, DVec3), v: DVec3| (low.min(v), high.max(v));
        Some(*self.around.get_or_init(|| corners.fold((first, first), grow)))
    }

    /// Number of pieces.
    #[must_use]
    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Adds a piece of face `face` with these corners: convex, in any order of winding, at most eleven.
    pub fn push(&mut self, face: u32, corners: impl IntoIterator<Item = DVec3>) {
        self.add_corners(face, corners, false);
    }

    /// As [`Receivers::push`]; if only part of the light reaches it, [`ShadowScratch::lit_regions`](crate::ShadowScratch::lit_regions)
    /// knows where.
    pub fn push_with_regions(&mut self, face: u32, corners: impl IntoIterator<Item = DVec3>) {
        self.add_corners(face, corners, true);
    }

    /// Adds a piece of face `face` by its outline on the viewer's grid, as [`Receivers::push`] or
    /// [`Receivers::push_with_regions`] does. Where its corners are in the world is found only if that is asked: most receivers of
    /// small faces are lit or dark with their whole face.
    pub fn push_outline(&mut self, face: u32, outline: &[DVec2], wants_regions: bool) {
        let first_vertex = self.outlines.len() as u32;
        self.outlines.extend_from_slice(outline);
        self.add(face, first_vertex, outline.len() as u32, true, wants_regions);
    }

    fn add_corners(&mut self, face: u32, corners: impl IntoIterator<Item = DVec3>, wants_regions: bool) {
        let first_vertex = self.vertices.len() as u32;
        self.vertices.extend(corners);
        let vertex_count = self.vertices.len() as u32 - first_vertex;
        self.add(face, first_vertex, vertex_count, false, wants_regions);
    }

    fn add(&mut self, face: u32, first_vertex: u32, vertex_count: u32, on_grid: bool, wants_regions: bool) {
        self.around = OnceLock::new();
        self.wholes += 1;
        self.list.push(Receiver {
            face,
            first_vertex,
            vertex_count,
            on_grid,
            joins: false,
            weight: 1.0,
            visibility: 1.0,
            wants_regions,
        });
    }

    /// Adds every fragment of a tile's micropoints, in order, as receivers of their own.
    pub fn push_tile(&mut self, tile: &Tile) {
        for point in tile.points() {
            for fragment in tile.fragments(point) {
                self.push_fragment(tile, point, fragment);
            }
        }
    }

    /// Adds a micropoint of a tile: its fragments, in order.
    ///
    /// [`AreaLight::visit`](crate::AreaLight::visit) takes them as one receiver, with the first one's position in the list. For other lights
    /// each is a receiver of its own. The less is seen of it, the coarser it is asked: see [`AreaOptions`](crate::AreaOptions).
    pub fn push_point(&mut self, tile: &Tile, point: &Micropoint) {
        self.push_points(tile, std::iter::once(point));
    }

    /// As [`Receivers::push_point`] for micropoints of one face: all their fragments are one receiver.
    pub fn push_points<'t>(&mut self, tile: &'t Tile, points: impl Iterator<Item = &'t Micropoint> + Clone) {
        let visibility = points.clone().map(|point| tile.visibility(point)).fold(0.0, f64::max);
        let fragments = points.flat_map(|point| tile.fragments(point).iter().map(move |f| (point, f)));
        for (i, (point, fragment)) in fragments.enumerate() {
            self.push_fragment(tile, point, fragment);
            if let Some(piece) = self.list.last_mut() {
                (piece.weight, piece.joins, piece.visibility) = (fragment.weight, i > 0, visibility);
                self.wholes -= usize::from(i > 0);
            }
        }
    }

    fn push_fragment(&mut self, tile: &Tile, point: &Micropoint, fragment: &Fragment) {
        let face: &Face = &tile.faces()[point.face as usize];
        let corners = tile.outline(fragment).iter();
        self.push(point.face, corners.map(|&v| tile.position(v, face.nearness_at(v))));
    }

    /// Number of receivers for lights with an area.
    pub(crate) fn wholes(&self) -> usize {
        self.wholes
    }

    /// Corners of a piece, relative to the viewer's lens.
    pub(crate) fn corners<'a>(
        &'a self,
        viewer: Viewer<'a>,
        r: &Receiver,
    ) -> impl Iterator<Item = DVec3> + Clone + 'a {
        let Viewer { lens, faces } = viewer;
        let range = r.first_vertex as usize..(r.first_vertex + r.vertex_count) as usize;
        let (vertices, outline) = match r.on_grid {
            true => (&[][..], &self.outlines[range]),
            false => (&self.vertices[range], &[][..]),
        };
        let face = &faces[r.face as usize];
        let place = |&v: &DVec2| lens.to_world_axes(lens.unproject(v, face.nearness_at(v)));
        vertices.iter().copied().chain(outline.iter().map(place))
    }
}

/// The viewer of the receivers: its lens and the faces that it sees.
#[derive(Clone, Copy, Debug)]
pub struct Viewer<'a> {
    /// The lens relative to which receivers are given.
    pub lens: &'a Lens,
    /// The faces that receivers refer to.
    pub faces: &'a [Face],
}
