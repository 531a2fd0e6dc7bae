//! A probe as it stands in a file.

use glam::{DVec3, Vec3};
use pointillist_sh::Sh;
use pointillist_shprobe::DistanceMap;
use serde::{Deserialize, Serialize};

/// A probe: where it is and, once it is baked, what it holds.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProbeEntry {
    /// World position.
    pub position: [f64; 3],
    /// A name for messages and tools; not used otherwise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Radiance: (order + 1)² RGB coefficients.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sh: Option<Vec<[f64; 3]>>,
    /// The share of sky, in the same basis.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sky: Option<Vec<f64>>,
    /// The share of all directions in which it sees the back of a surface.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub back: Option<f64>,
    /// Whether it lies inside of a wall, and lights nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub buried: Option<bool>,
    /// How far it sees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub distances: Option<Distances>,
    /// Stands for everything that it saw when it was baked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fingerprint: Option<String>,
}

/// How near what it sees is in the directions of an octahedral square.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Distances {
    /// Cells on a side; there is one node more.
    pub size: usize,
    /// One over |x| + |y| + |z| of the offset to the surface at each node, row by row.
    pub nearness: Vec<f32>,
    /// How far it departs about each node from what is interpolated between them.
    pub deviation: Vec<f32>,
    /// The plane q·x = 1 of the surface at each node, offsets x from the probe; 0 where none is known. Without it, light along
    /// edges of rooms is patchy.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub planes: Vec<[f32; 3]>,
}

impl ProbeEntry {
    /// A probe that is not baked.
    pub fn at(position: DVec3) -> Self {
        Self { position: position.to_array(), ..Self::default() }
    }

    /// Its coefficients.
    ///
    /// # Errors
    /// What is wrong with them, or that there are none.
    pub fn radiance(&self) -> Result<Sh, String> {
        let Some(sh) = &self.sh else { return Err("is missing: the probe is not baked".to_owned()) };
        Sh::new(sh.iter().map(|&c| DVec3::from_array(c)).collect()).map_err(|error| error.to_string())
    }

    /// The share of sky, if it is known.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn sky_share(&self) -> Result<Option<Sh<f64>>, String> {
        self.sky.as_ref().map(|sky| Sh::new(sky.clone()).map_err(|error| error.to_string())).transpose()
    }
}

impl Distances {
    /// As it is written.
    pub fn of(map: &DistanceMap) -> Self {
        let (nearness, deviation) = map.nodes().iter().map(|n| (short(n[0]), short(n[1]))).unzip();
        let known = map.planes().iter().any(|q| *q != Vec3::ZERO);
        let planes = map.planes().iter().filter(|_| known).map(|q| q.to_array().map(short)).collect();
        Self { size: map.size(), nearness, deviation, planes }
    }

    /// As it is used.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn map(&self) -> Result<DistanceMap, String> {
        let (near, off) = (&self.nearness, &self.deviation);
        if near.len() != off.len() {
            return Err(format!("has {} of `nearness` and {} of `deviation`", near.len(), off.len()));
        }
        let nodes: Vec<[f32; 2]> = near.iter().zip(off).map(|(n, d)| [*n, *d]).collect();
        let map = DistanceMap::new(self.size, &nodes).map_err(|error| error.to_string())?;
        if self.planes.is_empty() {
            return Ok(map);
        }
        if self.planes.len() != near.len() {
            return Err(format!("has {} of `nearness` and {} of `planes`", near.len(), self.planes.len()));
        }
        map.with_planes(&self.planes).map_err(|error| format!("`planes`: {error}"))
    }
}

/// With four digits: distances of surfaces are not known better than a texel is wide.
fn short(value: f32) -> f32 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_of_distances_come_back_with_their_planes() {
        let wall = [0.0, 0.5, 0.0];
        let map = DistanceMap::new(2, &[[0.25, 0.125]; 9]).expect("nine nodes");
        let plain = Distances::of(&map);
        assert!(plain.planes.is_empty() && plain.map() == Ok(map.clone()));
        let map = map.with_planes(&[wall; 9]).expect("nine planes");
        let mut written = Distances::of(&map);
        assert_eq!(written.map(), Ok(map));
        written.planes.pop();
        assert_eq!(written.map(), Err("has 9 of `nearness` and 8 of `planes`".to_owned()));
    }
}
