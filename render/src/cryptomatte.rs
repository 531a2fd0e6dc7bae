//! Which objects and materials a pixel shows, and how much of it each covers: layers as Cryptomatte has them, for masks in compositing.
//!
//! J. Friedman, A. C. Jones, *Fully Automatic ID Mattes with Support for Motion Blur and Transparency*, SIGGRAPH 2015 talks, and the
//! *Cryptomatte Specification* 1.2 of Psyop. An id is a hash of a name, so that it stays the same from frame to frame and from
//! program to program. A pixel has [`Matte::RANKS`] pairs of id and coverage, the largest coverage first; what else it
//! shows is left out. Coverage is that of the picture itself, exact and with transparency: all pairs of a pixel add up to its alpha.

use crate::scene::Scene;
use crate::shader::Shader;
use pointillist_micropoint::Tile;
use std::sync::OnceLock;

/// What is told apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Matte {
    /// Objects by their names.
    Object,
    /// Materials by their names.
    Material,
}

impl Matte {
    /// Pairs of id and coverage of a pixel: what programs that read them expect by default.
    pub const RANKS: usize = 6;

    /// The name of the layer.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Object => "CryptoObject",
            Self::Material => "CryptoMaterial",
        }
    }

    /// `CryptoObject00.R`, `G`, `B`, `A`, then `CryptoObject01.R`, …: two pairs each.
    pub(crate) fn channels(self) -> Vec<String> {
        let of_level = |level: usize| ["R", "G", "B", "A"].map(|c| format!("{}{level:02}.{c}", self.name()));
        (0..Self::RANKS / 2).flat_map(of_level).collect()
    }

    /// The names in a scene, by number.
    pub(crate) fn names(self, scene: &Scene) -> Vec<String> {
        match self {
            Self::Object => scene.mesh.objects.iter().map(|object| object.name.clone()).collect(),
            Self::Material => scene.materials.iter().map(|material| material.name.clone()).collect(),
        }
    }
}

/// The hash of a name: MurmurHash3, 32 bits, seed 0.
#[must_use]
pub fn cryptomatte_hash(name: &str) -> u32 {
    // Reading from memory cannot fail.
    murmur3::murmur3_32(&mut name.as_bytes(), 0).unwrap_or_default()
}

/// The id of a name: its hash as the bits of a number, but for those of infinities, NaN and numbers too small to be kept by every program.
#[must_use]
pub fn cryptomatte_id(name: &str) -> f32 {
    let hash = cryptomatte_hash(name);
    let exponent = hash >> 23 & 255;
    let flip = u32::from(exponent == 0 || exponent == 255) << 23;
    f32::from_bits(hash ^ flip)
}

/// The ids of a scene's objects and materials, each list made when it is first asked for.
#[derive(Debug, Default)]
pub(crate) struct MatteIds {
    objects: OnceLock<Vec<f32>>,
    materials: OnceLock<Vec<f32>>,
}

impl MatteIds {
    fn of(&self, matte: Matte, scene: &Scene) -> &[f32] {
        let list = match matte {
            Matte::Object => &self.objects,
            Matte::Material => &self.materials,
        };
        list.get_or_init(|| matte.names(scene).iter().map(|name| cryptomatte_id(name)).collect())
    }
}

impl Shader<'_> {
    /// The planes of a tile: id and coverage of the first rank, of the second, and so on; 0 beyond the last.
    pub(crate) fn matte_planes(&self, tile: &Tile, matte: Matte) -> Vec<Vec<f32>> {
        let rect = tile.rect();
        let ids = self.mattes.of(matte, self.scene);
        let mesh = &self.scene.mesh;
        let number_of = |triangle: u32| match matte {
            Matte::Object => mesh.object(triangle),
            Matte::Material => mesh.material(triangle),
        };
        // Bits of ids, so that they can be sorted: names with the same id are one.
        let mut seen: Vec<(u32, u32, f64)> = Vec::with_capacity(tile.points().len());
        seen.extend(tile.points().iter().map(|m| {
            let triangle = self.seen_triangle(&tile.faces()[m.face as usize]);
            let id = ids[number_of(triangle) as usize];
            ((m.y - rect.y0) * rect.width() + (m.x - rect.x0), id.to_bits(), m.weight)
        }));
        // Stable: equal ids are added up in the order of the micropoints, whatever sorts them.
        seen.sort_by_key(|&(pixel, id, _)| (pixel, id));
        let mut planes = vec![vec![0.0; rect.pixels() as usize]; 2 * Matte::RANKS];
        let mut ranks: Vec<(u32, f64)> = vec![];
        for of_pixel in seen.chunk_by(|a, b| a.0 == b.0) {
            ranks.clear();
            let sum = |same: &[(u32, u32, f64)]| (same[0].1, same.iter().map(|(_, _, weight)| weight).sum());
            ranks.extend(of_pixel.chunk_by(|a, b| a.1 == b.1).map(sum));
            ranks.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
            let pixel = of_pixel[0].0 as usize;
            for (rank, &(id, coverage)) in
                ranks.iter().take(Matte::RANKS).enumerate().filter(|(_, r)| r.1 > 0.0)
            {
                planes[2 * rank][pixel] = f32::from_bits(id);
                planes[2 * rank + 1][pixel] = coverage.min(1.0) as f32;
            }
        }
        planes
    }
}

#[cfg(test)]
mod tests {
    use super::{cryptomatte_hash, cryptomatte_id};

    /// Published values of MurmurHash3_x86_32.
    #[test]
    fn hashes_are_those_of_murmur3() {
        for (name, hash) in [
            ("", 0),
            ("hello", 0x248b_fa47),
            ("hello, world", 0x149b_bb7f),
            ("The quick brown fox jumps over the lazy dog", 0x2e4f_f723),
        ] {
            assert_eq!(cryptomatte_hash(name), hash, "{name}");
        }
    }

    #[test]
    fn ids_are_numbers_that_survive_any_program() {
        // Among so many names some have the exponent of infinity or of numbers below the normal ones.
        let names: Vec<String> = (0..4000).map(|i| format!("object {i}")).collect();
        let is_special = |name: &&String| matches!(cryptomatte_hash(name) >> 23 & 255, 0 | 255);
        assert!(names.iter().filter(is_special).count() > 5);
        for name in &names {
            let id = cryptomatte_id(name);
            assert!(id.is_normal(), "{name}: {id}");
            let changed = id.to_bits() ^ cryptomatte_hash(name);
            assert!(changed == 0 || (changed == 1 << 23 && is_special(&name)));
        }
    }
}
