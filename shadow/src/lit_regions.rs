//! The lit regions of receivers that a light reaches only in part.

use crate::query::Measure;
use glam::DVec2;

/// A part of a receiver that some light reaches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LitRegion<'a> {
    /// Its convex outline on the viewer's grid.
    pub outline: &'a [DVec2],
    /// Its area in the picture times the transmittance on the way from the light, up to a factor that all regions of a receiver share.
    pub weight: f64,
}

/// What [`ShadowLight::lit`](crate::ShadowLight::lit) left of the receivers of one batch that asked for their regions.
#[derive(Debug, Default)]
pub(crate) struct LitRegions {
    list: Vec<Entry>,
    vertices: Vec<DVec2>,
}

#[derive(Clone, Copy, Debug)]
struct Entry {
    receiver: u32,
    first_vertex: u32,
    vertex_count: u32,
    weight: f64,
}

impl LitRegions {
    /// Removes all regions and keeps the memory.
    pub(crate) fn clear(&mut self) {
        self.list.clear();
        self.vertices.clear();
    }

    /// Adds a region with this outline on the light grid.
    pub(crate) fn push(&mut self, receiver: u32, outline: &[DVec2], weight: f64, measure: &Measure<'_>) {
        let first_vertex = self.vertices.len() as u32;
        self.vertices.extend(outline.iter().map(|&v| measure.in_picture(v)));
        let vertex_count = outline.len() as u32;
        self.list.push(Entry { receiver, first_vertex, vertex_count, weight });
    }

    /// Puts the regions of a receiver side by side, in the order in which they were found.
    pub(crate) fn sort(&mut self) {
        self.list.sort_by_key(|entry| entry.receiver);
    }

    /// The regions of a receiver, once sorted.
    pub(crate) fn of(&self, receiver: u32) -> impl Iterator<Item = LitRegion<'_>> {
        let first = self.list.partition_point(|entry| entry.receiver < receiver);
        let entries = self.list[first..].iter().take_while(move |entry| entry.receiver == receiver);
        entries.map(|entry| LitRegion {
            outline: &self.vertices[entry.first_vertex as usize..][..entry.vertex_count as usize],
            weight: entry.weight,
        })
    }
}
