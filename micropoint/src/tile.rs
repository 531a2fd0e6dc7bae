//! The visible micropoints of a rectangle of pixels.

use crate::dicer::{Dicer, TileCounts};
use crate::face::{Face, SurfacePoint};
use crate::interval::Interval;
use crate::lens::Lens;
use crate::resolve::{ResolveScratch, Visible};
use glam::{DVec2, DVec3};
use pointillist_dice::convex;
use pointillist_view::PixelRect;

/// A visible piece of a surface: what a shader shades, once.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Micropoint {
    /// Column of its pixel in the picture.
    pub x: u32,
    /// Row of its pixel in the picture.
    pub y: u32,
    /// Index into [`Tile::faces`].
    pub face: u32,
    /// Its share of the pixel, 0..=1: visible area × transmittance in front × opacity.
    pub weight: f64,
    /// Centroid of what is seen of it, in cells of the picture.
    pub grid: DVec2,
    /// Smallest and largest nearness (1/depth, or −depth of an orthographic view).
    pub nearness: Interval,
    /// Index of its first fragment in [`Tile::fragments`].
    pub first_fragment: u32,
    /// Number of its fragments.
    pub fragment_count: u32,
}

/// A convex part of the visible area of a micropoint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fragment {
    first_vertex: u32,
    vertex_count: u32,
    /// Its share of the pixel, as [`Micropoint::weight`].
    pub weight: f64,
}

/// The visible micropoints of a tile, and the memory to make them; reused from tile to tile.
#[derive(Debug, Default)]
pub struct Tile {
    pub(crate) dicer: Dicer,
    pub(crate) resolve: ResolveScratch,
    rect: Option<PixelRect>,
    lens: Option<Lens>,
    cells_per_pixel: u32,
    points: Vec<Micropoint>,
    fragments: Vec<Fragment>,
    vertices: Vec<DVec2>,
}

impl Tile {
    /// Empties the tile for these pixels of the view with this lens; keeps the memory.
    pub(crate) fn start(&mut self, rect: PixelRect, lens: Lens, cells_per_pixel: u32) {
        self.cells_per_pixel = cells_per_pixel;
        self.rect = Some(rect);
        self.lens = Some(lens);
        self.points.clear();
        self.fragments.clear();
        self.vertices.clear();
    }

    /// The pixels of this tile.
    #[must_use]
    pub fn rect(&self) -> PixelRect {
        self.rect.unwrap_or(PixelRect { x0: 0, y0: 0, x1: 0, y1: 0 })
    }

    /// The visible micropoints: cell by cell in rows, nearest first within a cell.
    #[must_use]
    pub fn points(&self) -> &[Micropoint] {
        &self.points
    }

    /// The faces that micropoints refer to.
    #[must_use]
    pub fn faces(&self) -> &[Face] {
        &self.dicer.faces
    }

    /// The fragments of a micropoint.
    #[must_use]
    pub fn fragments(&self, point: &Micropoint) -> &[Fragment] {
        &self.fragments[point.first_fragment as usize..][..point.fragment_count as usize]
    }

    /// Outline of a fragment in cells of the picture, in positive order.
    #[must_use]
    pub fn outline(&self, fragment: &Fragment) -> &[DVec2] {
        &self.vertices[fragment.first_vertex as usize..][..fragment.vertex_count as usize]
    }

    /// The point of a face at a grid position: barycentric coordinates and nearness.
    ///
    /// # Panics
    /// If no tile has been rendered yet.
    #[must_use]
    pub fn surface_point(&self, face: u32, grid: DVec2) -> SurfacePoint {
        self.faces()[face as usize].point(self.lens(), grid)
    }

    /// Position of a point of a face relative to the eye, in world axes.
    ///
    /// # Panics
    /// If no tile has been rendered yet.
    #[must_use]
    pub fn position(&self, grid: DVec2, nearness: f64) -> DVec3 {
        let lens = self.lens();
        lens.to_world_axes(lens.unproject(grid, nearness))
    }

    /// What a micropoint gives to the picture over what it would give if it were opaque with nothing in front: the mean of transmittance
    /// in front × opacity over its fragments, 0..=1. 1 for one without an area.
    #[must_use]
    pub fn visibility(&self, point: &Micropoint) -> f64 {
        let fragments = self.fragments(point).iter();
        let (weight, area) = fragments.fold((0.0, 0.0), |(weight, area), fragment| {
            (weight + fragment.weight, area + convex::area(self.outline(fragment)))
        });
        let cells = f64::from(self.cells_per_pixel).powi(2);
        if area > 0.0 { (weight * cells / area).min(1.0) } else { 1.0 }
    }

    /// The lens of the view.
    ///
    /// # Panics
    /// If no tile has been rendered yet.
    #[must_use]
    pub fn lens(&self) -> &Lens {
        self.lens.as_ref().expect("a tile has been rendered")
    }

    /// Counts of the work for this tile.
    #[must_use]
    pub fn counts(&self) -> TileCounts {
        self.dicer.counts
    }

    /// Adds what is seen of a part: a micropoint with its fragments.
    pub(crate) fn push(
        &mut self,
        dicer: &Dicer,
        seen: &Visible<'_>,
        corner: DVec2,
        pixel: (u32, u32),
        share: f64,
    ) {
        let part = dicer.part(seen.part);
        let first_fragment = self.fragments.len() as u32;
        match seen.pieces {
            None => self.push_fragment(dicer.outline(part), corner, seen.weight * share),
            Some(regions) => {
                for r in regions {
                    let weight = r.polygon.area() * r.transmittance * seen.scale * share;
                    self.push_fragment(r.polygon.vertices(), corner, weight);
                }
            }
        }
        self.points.push(Micropoint {
            x: pixel.0,
            y: pixel.1,
            face: part.face,
            weight: seen.weight * share,
            // Rounding may put the centroid of a sliver outside it.
            grid: seen.centroid.clamp(DVec2::ZERO, DVec2::ONE) + corner,
            nearness: part.nearness,
            first_fragment,
            fragment_count: self.fragments.len() as u32 - first_fragment,
        });
    }

    fn push_fragment(&mut self, outline: &[DVec2], corner: DVec2, weight: f64) {
        let first_vertex = self.vertices.len() as u32;
        self.vertices.extend(outline.iter().map(|&v| v + corner));
        let vertex_count = outline.len() as u32;
        self.fragments.push(Fragment { first_vertex, vertex_count, weight });
    }
}
