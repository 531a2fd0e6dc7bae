//! Links of a scene whose form factors come from hemicubes at the patches' centres.

use crate::error::RadiosityError;
use crate::hemicube::{Hemicube, HemicubeKind};
use crate::link::Link;
use crate::polygon::Polygon;
use crate::rgb::{Rgb, check_direct};
use crate::scene::Scene;
use crate::transport::Transport;
use pointillist_parallel as parallel;

impl Scene {
    /// As [`Scene::transport`] without a tolerance, with a hemicube of `resolution` cells at each patch's centre.
    ///
    /// One point is sampled for a whole patch, which is inaccurate for neighbouring patches at any resolution. Form factors from both ends are
    /// averaged, which reduces the error a little and makes them reciprocal. The error of a link is unknown; half of the difference
    /// between both ends is given for it.
    ///
    /// # Errors
    /// [`RadiosityError::CountMismatch`] and [`RadiosityError::DirectIrradiance`] for `direct`, [`RadiosityError::Option`] for a resolution outside 1 to 4096.
    pub fn transport_by_hemicubes(
        mut self,
        kind: HemicubeKind,
        resolution: usize,
        direct: &[Rgb],
    ) -> Result<Transport, RadiosityError> {
        self.options.tolerance = None;
        let leaves = self.tree.leaves();
        check_direct(leaves.len(), direct)?;
        if !(1..=4096).contains(&resolution) {
            let (name, expected) = ("resolution", "from 1 to 4096");
            return Err(RadiosityError::Option { name, value: resolution as f64, expected });
        }
        let polygons: Vec<&Polygon> =
            leaves.iter().map(|&l| &self.tree.elements[l as usize].polygon).collect();
        let occluders: Vec<&Polygon> = self.occluders.iter().collect();
        let rows = parallel::map_with(
            leaves.len(),
            || Hemicube::new(kind, resolution),
            |hemicube, i| {
                let polygon = polygons[i];
                hemicube.factors_of(polygon.centre(), polygon.normal(), &polygons, &occluders)
            },
        );
        let mut links = vec![];
        for i in 0..leaves.len() {
            for j in i + 1..leaves.len() {
                let from = |a: usize, b: usize| rows[a][b] * polygons[a].area();
                let (one, other) = (from(i, j), from(j, i));
                let mutual = 0.5 * (one + other);
                if mutual > 0.0 {
                    let error = 0.5 * (one - other).abs();
                    links.push(Link { a: leaves[i], b: leaves[j], mutual, error, between: (0, 0) });
                }
            }
        }
        Ok(Transport::of_links(self, links, direct))
    }
}
