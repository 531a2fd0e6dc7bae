//! Sums shaded micropoints up into the pixels of a tile.

use crate::background::Background;
use crate::frame::LayerKind;
use crate::partial::Pixels;
use crate::shader::{Point, Shader};
use glam::{DVec3, Vec3};
use pointillist_micropoint::{Micropoint, Tile};
use pointillist_view::PixelRect;
use std::collections::BTreeMap;

impl Shader<'_> {
    /// Sums up micropoints into the colour and depth of pixels. Depth is that of the micropoint with the largest weight.
    pub(crate) fn gather(
        &self,
        tile: &Tile,
        background: &Background<'_>,
        points: &[Point],
        pixels: &mut Pixels,
    ) {
        let rect = tile.rect();
        let mut sums = vec![[0.0_f64; 4]; rect.pixels() as usize];
        for (m, p) in tile.points().iter().zip(points) {
            let color = p.material.emission + p.indirect + p.direct;
            let s = &mut sums[index(&rect, m)];
            let weight = self.light_weight(tile, m);
            for (c, v) in color.to_array().into_iter().enumerate() {
                s[c] += weight * f64::from(v);
            }
            s[3] += m.weight;
        }
        pixels.color.clear();
        for (i, s) in sums.iter().enumerate() {
            let open = (1.0 - s[3]).max(0.0);
            let (x, y) = (rect.x0 + i as u32 % rect.width(), rect.y0 + i as u32 / rect.width());
            let behind = if open > 0.0 { background.behind(x, y) } else { Vec3::ZERO }.to_array();
            let color = std::array::from_fn(|c| {
                if c < 3 { (s[c] + open * f64::from(behind[c])) as f32 } else { s[3].min(1.0) as f32 }
            });
            pixels.color.push(color);
        }
        let depth = |i: usize| {
            let m = &tile.points()[i];
            tile.lens().depth(tile.faces()[m.face as usize].nearness_at(m.grid)) as f32
        };
        pixels.depth.clear();
        pixels.depth.extend(heaviest(tile).into_iter().map(|i| i.map_or(f32::INFINITY, depth)));
    }

    /// The further layers: colours are means over the micropoints of a pixel, geometry is that of the one with the largest weight.
    /// `lit` holds the fraction of each colour that arrives at each micropoint, for each light whose layer is asked for; those layers get a plane
    /// for each colour here, of which [`Pixels::mean_of_lit`] makes one.
    pub(crate) fn gather_layers(
        &self,
        tile: &Tile,
        layers: &[LayerKind],
        lit: &BTreeMap<usize, Vec<DVec3>>,
        points: &[Point],
        pixels: &mut Pixels,
    ) {
        let rect = tile.rect();
        pixels.planes.clear();
        let sum = |value: &dyn Fn(usize, &Point) -> Vec3, weight: &dyn Fn(&Micropoint) -> f64, channels| {
            let mut planes = vec![vec![0.0; rect.pixels() as usize]; channels];
            for (i, (m, p)) in tile.points().iter().zip(points).enumerate() {
                let (value, weight) = (value(i, p).to_array(), weight(m) as f32);
                let pixel = index(&rect, m);
                planes.iter_mut().zip(value).for_each(|(plane, v)| plane[pixel] += weight * v);
            }
            planes
        };
        let light = |value: &dyn Fn(usize, &Point) -> Vec3| sum(value, &|m| self.light_weight(tile, m), 3);
        let share = |value: &dyn Fn(usize) -> f32| sum(&|i, _| Vec3::splat(value(i)), &|m| m.weight, 1);
        for layer in layers {
            let planes = match layer {
                LayerKind::Albedo => light(&|_, p| p.material.diffuse),
                LayerKind::Direct => light(&|_, p| p.direct),
                LayerKind::Indirect => light(&|_, p| p.indirect),
                LayerKind::Back => {
                    let back = |i: usize| self.shows_back(&tile.faces()[tile.points()[i].face as usize]);
                    share(&|i| f32::from(u8::from(back(i))))
                }
                LayerKind::Cryptomatte(matte) => self.matte_planes(tile, *matte),
                LayerKind::Lit(light) => sum(&|i, _| lit[light][i].as_vec3(), &|m| m.weight, 3),
                LayerKind::Normal | LayerKind::Position | LayerKind::Id => {
                    let value = |i: usize| self.geometry_value(*layer, tile, &points[i], &tile.points()[i]);
                    let values = heaviest(tile).into_iter().map(|i| i.map_or(Vec3::ZERO, value));
                    let values: Vec<Vec3> = values.collect();
                    let channels = if *layer == LayerKind::Id { 1 } else { 3 };
                    (0..channels).map(|c| values.iter().map(|v| v[c]).collect()).collect()
                }
            };
            pixels.planes.extend(planes);
        }
    }

    /// What light from a micropoint counts in its pixel: its visible share, of a clear surface without what is seen through it.
    fn light_weight(&self, tile: &Tile, m: &Micropoint) -> f64 {
        if self.own_light.is_empty() {
            return m.weight;
        }
        let triangle = tile.faces()[m.face as usize].id;
        m.weight * self.own_light[self.scene.mesh.material(triangle) as usize]
    }

    fn geometry_value(&self, layer: LayerKind, tile: &Tile, p: &Point, m: &Micropoint) -> Vec3 {
        match layer {
            LayerKind::Normal => p.normal,
            LayerKind::Position => p.place.position.as_vec3(),
            _ => {
                let triangle = tile.faces()[m.face as usize].id;
                Vec3::splat(self.scene.mesh.object(triangle) as f32 + 1.0)
            }
        }
    }
}

/// The pixel of a micropoint within its tile.
fn index(rect: &PixelRect, m: &Micropoint) -> usize {
    ((m.y - rect.y0) * rect.width() + (m.x - rect.x0)) as usize
}

/// For each pixel of a tile, the micropoint with the largest weight; of equal ones the first.
fn heaviest(tile: &Tile) -> Vec<Option<usize>> {
    let rect = tile.rect();
    let mut best = vec![(0.0, None); rect.pixels() as usize];
    for (i, m) in tile.points().iter().enumerate() {
        let best = &mut best[index(&rect, m)];
        if m.weight > best.0 {
            *best = (m.weight, Some(i));
        }
    }
    best.into_iter().map(|(_, i)| i).collect()
}
