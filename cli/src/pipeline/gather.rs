//! Sums shaded micropoints up into the pixels of a tile.

use super::background::Background;
use super::shading::{Point, Shader, ShaderScratch};
use crate::image_io::LayerKind;
use glam::Vec3;
use pointillist_micropoint::{Micropoint, Tile};

impl Shader<'_> {
    /// Sums up micropoints into pixels.
    pub(super) fn gather(
        &self,
        tile: &Tile,
        background: &Background<'_>,
        layers: &[LayerKind],
        lit: &[Vec<f64>],
        scratch: &mut ShaderScratch,
    ) {
        let ShaderScratch { points, pixels, .. } = scratch;
        let rect = tile.rect();
        let count = (rect.width() * rect.height()) as usize;
        let index = |m: &Micropoint| ((m.y - rect.y0) * rect.width() + (m.x - rect.x0)) as usize;
        let mut sums = vec![[0.0_f64; 4]; count];
        let mut heaviest = vec![(0.0_f64, 0_u32); count];
        for (i, (m, p)) in tile.points().iter().zip(points.iter()).enumerate() {
            let color = p.material.emission + p.indirect + p.direct;
            let s = &mut sums[index(m)];
            for (c, v) in color.to_array().into_iter().enumerate() {
                s[c] += m.weight * f64::from(v);
            }
            s[3] += m.weight;
            if m.weight > heaviest[index(m)].0 {
                heaviest[index(m)] = (m.weight, i as u32);
            }
        }
        pixels.color.clear();
        pixels.depth.clear();
        for (i, s) in sums.iter().enumerate() {
            let open = (1.0 - s[3]).max(0.0);
            let (x, y) = (rect.x0 + i as u32 % rect.width(), rect.y0 + i as u32 / rect.width());
            let behind = if open > 0.0 { background.behind(x, y) } else { Vec3::ZERO }.to_array();
            let color = std::array::from_fn(|c| {
                if c < 3 { (s[c] + open * f64::from(behind[c])) as f32 } else { s[3].min(1.0) as f32 }
            });
            pixels.color.push(color);
            let depth = |point: u32| (points[point as usize].position - self.eye).dot(self.forward) as f32;
            pixels.depth.push(if heaviest[i].0 > 0.0 { depth(heaviest[i].1) } else { f32::INFINITY });
        }
        self.gather_layers(tile, layers, lit, &heaviest, scratch);
    }

    /// The further layers: colours are means over the micropoints of a pixel, geometry is that of the
    /// one with the largest weight.
    fn gather_layers(
        &self,
        tile: &Tile,
        layers: &[LayerKind],
        lit: &[Vec<f64>],
        heaviest: &[(f64, u32)],
        scratch: &mut ShaderScratch,
    ) {
        let ShaderScratch { points, pixels, .. } = scratch;
        let rect = tile.rect();
        pixels.planes.clear();
        let mut lit = lit.iter();
        let mean = |value: &dyn Fn(usize, &Point) -> Vec3, channels: usize| {
            let mut planes = vec![vec![0.0; heaviest.len()]; channels];
            for (i, (m, p)) in tile.points().iter().zip(points.iter()).enumerate() {
                let pixel = ((m.y - rect.y0) * rect.width() + (m.x - rect.x0)) as usize;
                let value = value(i, p).to_array();
                planes.iter_mut().zip(value).for_each(|(plane, v)| plane[pixel] += m.weight as f32 * v);
            }
            planes
        };
        for layer in layers {
            let planes = match layer {
                LayerKind::Albedo => mean(&|_, p| p.material.diffuse, 3),
                LayerKind::Direct => mean(&|_, p| p.direct, 3),
                LayerKind::Indirect => mean(&|_, p| p.indirect, 3),
                LayerKind::Back => {
                    let back = |i: usize| !tile.faces()[tile.points()[i].face as usize].front;
                    mean(&|i, _| Vec3::splat(f32::from(u8::from(back(i)))), 1)
                }
                LayerKind::Lit(_) => {
                    let values = lit.next().map_or(&[][..], Vec::as_slice);
                    mean(&|i, _| Vec3::splat(values.get(i).map_or(0.0, |&v| v as f32)), 1)
                }
                LayerKind::Normal | LayerKind::Position | LayerKind::Id => {
                    let value = |&(weight, i): &(f64, u32)| {
                        let p = &points.get(i as usize).filter(|_| weight > 0.0);
                        let m = tile.points().get(i as usize);
                        match (p, m) {
                            (Some(p), Some(m)) => self.geometry_value(*layer, tile, p, m),
                            _ => Vec3::ZERO,
                        }
                    };
                    let values: Vec<Vec3> = heaviest.iter().map(value).collect();
                    let channels = if *layer == LayerKind::Id { 1 } else { 3 };
                    (0..channels).map(|c| values.iter().map(|v| v[c]).collect()).collect()
                }
            };
            pixels.planes.extend(planes);
        }
    }

    fn geometry_value(&self, layer: LayerKind, tile: &Tile, p: &Point, m: &Micropoint) -> Vec3 {
        match layer {
            LayerKind::Normal => p.normal,
            LayerKind::Position => p.position.as_vec3(),
            _ => {
                let triangle = tile.faces()[m.face as usize].id as usize;
                Vec3::splat(self.scene.mesh.object_of[triangle] as f32 + 1.0)
            }
        }
    }
}
