//! Whether cells are a Delaunay triangulation, decided exactly; and if not, the cell that shows it.

use crate::triangulation::{Sites, Vertex};
use crate::{Cell, DelaunayError, Facet, Partition};
use glam::DVec3;
use std::collections::HashMap;

impl Partition {
    /// Checks that these cells are a Delaunay triangulation of their corners, which are some of `points`. All decisions
    /// are exact.
    ///
    /// 1. Corners are points, and neighbours are mutual ([`Partition::check`]) and share the side between them.
    /// 2. No cell is flat, all turn alike, and neighbours lie on different sides of what they share; triangles lie in
    ///    one plane, and points of a line follow one another.
    /// 3. No cell has the far corner of a neighbour inside its sphere, or circle: then no sphere has any corner inside
    ///    (Delaunay's lemma).
    /// 4. The sides without a neighbour close up to a hull that bends inward nowhere.
    ///
    /// Linear in the number of cells. It does not check that every point is a corner: those removed, and those that
    /// coincide with others, are not.
    ///
    /// # Errors
    /// [`DelaunayError::PointNotFinite`], or [`DelaunayError::BadCell`] with the first cell found that breaks one of
    /// these.
    ///
    /// ```
    /// use pointillist_delaunay::{Delaunay, DelaunayError, Partition};
    ///
    /// let kite = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [2.0, 1.0, 0.0], [2.0, -1.0, 0.0]];
    /// let delaunay = Delaunay::new(&kite)?;
    /// let Partition::Triangles(mut triangles) = delaunay.partition() else { unreachable!() };
    /// assert!(Partition::Triangles(triangles.clone()).verify(delaunay.points()).is_ok());
    ///
    /// triangles.corners[1].swap(0, 1);
    /// triangles.neighbours[1].swap(0, 1);
    /// let error = Partition::Triangles(triangles).verify(delaunay.points());
    /// assert!(matches!(error, Err(DelaunayError::BadCell { cell: 1, .. })));
    /// # Ok::<(), DelaunayError>(())
    /// ```
    pub fn verify(&self, points: &[DVec3]) -> Result<(), DelaunayError> {
        if let Some(index) = points.iter().position(|p| !p.is_finite()) {
            return Err(DelaunayError::PointNotFinite { index });
        }
        self.check(points.len())?;
        if let Self::Point(_) = self {
            return Ok(());
        }
        for cell in self.cells() {
            for (side, beyond) in beyond(cell) {
                let is_shared =
                    facet_towards(beyond, cell).is_some_and(|f| f.key() == Facet::of(cell, side).key());
                holds(cell, is_shared, "does not share the side to its neighbour with it")?;
            }
        }
        let sites = Sites::new(points.iter().copied());
        match self {
            Self::Point(_) => Ok(()),
            Self::Line(_) => check_line(self, &sites),
            Self::Triangles(_) => check_triangles(self, sites),
            Self::Tetrahedra(_) => check_tetrahedra(self, &sites),
        }
    }
}

fn holds(cell: Cell<'_>, is_so: bool, problem: &'static str) -> Result<(), DelaunayError> {
    if is_so { Ok(()) } else { Err(DelaunayError::BadCell { cell: cell.index() as usize, problem }) }
}

/// The vertex of a point in [`Sites`], where the first is the one at infinity.
fn vertex(point: u32) -> Vertex {
    Vertex(point + 1)
}

/// Neighbours, with the side that each lies beyond.
fn beyond<'a>(cell: Cell<'a>) -> impl Iterator<Item = (usize, Cell<'a>)> {
    (0..cell.corners().len()).filter_map(move |side| Some((side, cell.neighbour(side)?)))
}

/// The side of a cell beyond which lies `to`.
fn facet_towards(cell: Cell<'_>, to: Cell<'_>) -> Option<Facet> {
    beyond(cell).find(|(_, next)| next.index() == to.index()).map(|(side, _)| Facet::of(cell, side))
}

/// The corner of `beyond` that `cell` has not, if they share a side.
fn far_corner(cell: Cell<'_>, beyond: Cell<'_>) -> Option<Vertex> {
    facet_towards(beyond, cell).map(|f| vertex(beyond.corners()[f.side()]))
}

fn check_line(line: &Partition, sites: &Sites) -> Result<(), DelaunayError> {
    let Some(first) = line.cell(0) else { return Ok(()) };
    let [a, b] = [0, 1].map(|k| vertex(first.corners()[k]));
    let sense = sites.compare(a, b);
    for cell in line.cells() {
        let [c, d] = [0, 1].map(|k| vertex(cell.corners()[k]));
        holds(cell, sense.is_ne() && sites.compare(c, d) == sense, "does not lead on along the line")?;
        holds(cell, sites.are_collinear([a, b, d]), "leaves the line")?;
    }
    Ok(())
}

/// Facts of one cell: it is positive, or negative if `flip`, its neighbours lie beyond it, and its sphere holds none of
/// their far corners. In a plane the fourth corner is a point off that plane.
fn check_cell(cell: Cell<'_>, corners: [Vertex; 4], flip: bool, sites: &Sites) -> Result<(), DelaunayError> {
    let sign = if flip { -1.0 } else { 1.0 };
    holds(cell, sign * sites.orient(corners) > 0.0, "is flat or turned inside out")?;
    let [a, b, c, d] = corners;
    let positive = if flip { [b, a, c, d] } else { corners };
    for (side, next) in beyond(cell) {
        let Some(far) = far_corner(cell, next) else { continue };
        let mut across = corners;
        across[side] = far;
        holds(cell, sign * sites.orient(across) < 0.0, "overlaps a neighbour")?;
        holds(cell, sites.sphere_sign(positive, far) <= 0.0, "has a corner of a neighbour in its sphere")?;
    }
    Ok(())
}

fn check_tetrahedra(cells: &Partition, sites: &Sites) -> Result<(), DelaunayError> {
    for cell in cells.cells() {
        check_cell(cell, std::array::from_fn(|k| vertex(cell.corners()[k])), false, sites)?;
    }
    // The facet to the left of each edge, and its third corner.
    let hull = cells.hull();
    let turns = |facet: &Facet| {
        let [a, b, c] = std::array::from_fn(|k| facet.corners()[k]);
        [([a, b], c), ([b, c], a), ([c, a], b)]
    };
    let mut third = HashMap::new();
    for facet in &hull {
        for (edge, opposite) in turns(facet) {
            let is_first = third.insert(edge, opposite).is_none();
            holds(owner(cells, facet), is_first, "shares an edge of the hull with more than one other")?;
        }
    }
    for facet in &hull {
        for ([a, b], c) in turns(facet) {
            let owner = owner(cells, facet);
            let Some(&d) = third.get(&[b, a]) else {
                return holds(owner, false, "is where the hull is open");
            };
            let bend = sites.orient([a, b, c, d].map(vertex));
            holds(owner, bend <= 0.0, "is where the hull bends inward")?;
        }
    }
    Ok(())
}

fn check_triangles(cells: &Partition, mut sites: Sites) -> Result<(), DelaunayError> {
    let Some(first) = cells.cell(0) else { return Ok(()) };
    let triangle = |cell: Cell<'_>| -> [Vertex; 3] { std::array::from_fn(|k| vertex(cell.corners()[k])) };
    let plane = triangle(first);
    holds(first, !sites.are_collinear(plane), "is flat")?;
    let [a, b, c] = plane;
    for cell in cells.cells() {
        let is_in_plane = |v: Vertex| sites.orient([a, b, c, v]) == 0.0;
        holds(cell, triangle(cell).into_iter().all(is_in_plane), "leaves the plane")?;
    }
    let apex = sites.push_apex(plane);
    // On which side of the plane the apex lies is an accident; two corners change places to make cells positive.
    let flip = sites.orient([a, b, c, apex]) < 0.0;
    for cell in cells.cells() {
        let [a, b, c] = triangle(cell);
        check_cell(cell, [a, b, c, apex], flip, &sites)?;
    }
    let hull = cells.hull();
    let next: HashMap<u32, u32> = hull.iter().map(|f| (f.corners()[0], f.corners()[1])).collect();
    for facet in &hull {
        let (owner, [a, b]) = (owner(cells, facet), [0, 1].map(|k| facet.corners()[k]));
        let Some(&c) = next.get(&b) else { return holds(owner, false, "is where the hull is open") };
        let turn = sites.orient([vertex(a), vertex(b), vertex(c), apex]);
        holds(owner, if flip { turn <= 0.0 } else { turn >= 0.0 }, "is where the hull bends inward")?;
    }
    Ok(())
}

fn owner<'a>(cells: &'a Partition, facet: &Facet) -> Cell<'a> {
    cells.cell(facet.cell()).expect("facets are sides of cells")
}
