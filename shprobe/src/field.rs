//! Light interpolated between probes.

use crate::delaunay::{Hint, Locator, Partition};
use crate::glossy::GlossyLight;
use crate::sh::{Irradiance, Lobe, MAX_COUNT, Sh, basis, coefficient_count};
use crate::sight::{MOST, Shares, Spot, by_cell, by_sight};
use crate::tree::Tree;
use crate::{DistanceMap, ProbeError, parallel};
use glam::{DVec3, Vec3};

/// Probes with what they hold, ready to light positions between them.
///
/// Space is divided into Delaunay tetrahedra; a position takes from the four probes around it by barycentric weights.
/// Where the probes' distances are known, it takes from the nearest that see it instead, the nearer the more: within 1.3
/// times the distance of the sixth of them, where a probe that does not see it counts as ten times as far and has next to
/// no weight beside those that do.
///
/// A surface takes from probes in front of it only, which fade out towards its plane, and where there is none from the
/// nearest. Shares are continuous in the position and the normal, for any number of probes.
#[derive(Clone, Debug)]
pub struct Field {
    pub(crate) positions: Vec<DVec3>,
    locator: Locator,
    partition: Partition,
    pub(crate) order: usize,
    /// Coefficients of irradiance, probe after probe.
    pub(crate) irradiance: Vec<Vec3>,
    /// What mirrors see.
    pub(crate) glossy: GlossyLight,
    /// The same up to band 2, for objects.
    pub(crate) lights: Vec<Irradiance>,
    pub(crate) distances: Option<Vec<DistanceMap>>,
    /// Finds the nearest probes.
    tree: Tree,
    /// Mean distance between neighbouring probes.
    spacing: f64,
    /// The bias that the caller set; [`BIAS`] times the spacing without.
    bias: Option<f64>,
}

/// A moving object: its position, and the light there.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct LitObject {
    /// Where it is; set by the caller.
    pub position: DVec3,
    /// Where it was found last.
    pub hint: Hint,
    /// What lights it.
    pub light: Irradiance,
}

impl LitObject {
    /// An object that is not lit yet.
    #[must_use]
    pub const fn at(position: DVec3) -> Self {
        Self { position, hint: Hint::START, light: Irradiance::DARK }
    }
}

/// Default of the farthest, over the mean spacing of probes, that positions on a surface are lifted off it.
pub(crate) const BIAS: f64 = 0.02;

impl Field {
    /// Largest absolute value of a coordinate of a probe: squares of distances are finite.
    pub const FARTHEST: f64 = 1e150;

    /// Most probes that light a position: 24 that see it, or of those whose sight is not known four of a cell and 24.
    pub const MOST_SHARES: usize = MOST + 4;

    /// Largest absolute value of a coefficient: light in single precision is finite.
    pub const BRIGHTEST: f64 = 1e30;

    /// Divides the space between `positions`, whose probes hold `radiance`.
    ///
    /// # Errors
    /// [`ProbeError::NoProbes`], [`ProbeError::CountMismatch`] if there is not one function for each position,
    /// [`ProbeError::PositionNotFinite`], [`ProbeError::PositionTooFar`], [`ProbeError::MixedOrders`],
    /// [`ProbeError::BadRadiance`].
    pub fn new(positions: &[DVec3], radiance: &[Sh]) -> Result<Self, ProbeError> {
        expect_count(positions.len(), radiance.len())?;
        Self::from_parts(positions, Partition::up_to_rounding(positions)?, radiance)
    }

    /// The same with cells that are known already, from [`Field::partition`] of an equal field: nothing is divided
    /// anew.
    ///
    /// Cells must be between these positions and know their neighbours, and that is checked. Whether they fill the hull
    /// once and are Delaunay's is not: [`Partition::verify`] checks that for cells from elsewhere.
    ///
    /// # Errors
    /// As [`Field::new`], and [`ProbeError::Cells`] for the first cell that is wrong.
    pub fn from_parts(
        positions: &[DVec3],
        partition: Partition,
        radiance: &[Sh],
    ) -> Result<Self, ProbeError> {
        expect_count(positions.len(), radiance.len())?;
        check_positions(positions)?;
        let order = common_order(radiance)?;
        let locator = Locator::new(positions, &partition)?;
        let spacing = spacing(positions, &partition);
        Ok(Self {
            spacing,
            positions: positions.to_vec(),
            locator,
            partition,
            order,
            irradiance: radiance.iter().flat_map(irradiance_of).collect(),
            glossy: GlossyLight::new(radiance),
            lights: radiance.iter().map(Irradiance::new).collect(),
            distances: None,
            tree: Tree::new(positions.iter().copied().zip(0..), spacing).with_lists(),
            bias: None,
        })
    }

    /// Divides space between other positions; if they are refused, the field is as it was.
    pub(crate) fn divide(&mut self, positions: Vec<DVec3>) -> Result<(), ProbeError> {
        check_positions(&positions)?;
        let partition = Partition::up_to_rounding(&positions)?;
        self.locator = Locator::new(&positions, &partition)?;
        self.partition = partition;
        self.positions = positions;
        self.spacing = spacing(&self.positions, &self.partition);
        self.tree = Tree::new(self.positions.iter().copied().zip(0..), self.spacing).with_lists();
        Ok(())
    }

    /// Lets a position take only from probes that see it.
    ///
    /// # Errors
    /// [`ProbeError::CountMismatch`] if there is not one map for each probe.
    pub fn with_distances(mut self, distances: Vec<DistanceMap>) -> Result<Self, ProbeError> {
        expect_count(self.probe_count(), distances.len())?;
        self.distances = Some(distances);
        Ok(self)
    }

    /// Sets the farthest that positions on a surface are lifted off it along its normal before a probe is asked whether
    /// it sees them. It is also never more than 1 % of the distance to that probe, which is the precision of its map:
    /// a surface in front that is farther than both is not jumped over. Default: 2 % of the mean distance between
    /// neighbouring probes. World units, 0 to [`Field::FARTHEST`].
    ///
    /// # Errors
    /// [`ProbeError::BadOption`].
    pub fn with_bias(mut self, bias: f64) -> Result<Self, ProbeError> {
        if !(0.0..=Self::FARTHEST).contains(&bias) {
            return Err(ProbeError::BadOption { name: "bias", value: bias, range: "it must be 0 to 1e150" });
        }
        self.bias = Some(bias);
        Ok(self)
    }

    /// The farthest that positions on a surface are lifted off it.
    #[must_use]
    pub fn bias(&self) -> f64 {
        self.bias.unwrap_or(BIAS * self.spacing)
    }

    /// The cells.
    #[must_use]
    pub const fn partition(&self) -> &Partition {
        &self.partition
    }

    /// Finds the cell of a position. It does not take visibility into account.
    #[must_use]
    pub const fn locator(&self) -> &Locator {
        &self.locator
    }

    /// The order of the probes' coefficients.
    #[must_use]
    pub const fn order(&self) -> usize {
        self.order
    }

    /// How many probes there are.
    #[must_use]
    pub fn probe_count(&self) -> usize {
        self.lights.len()
    }

    /// The probes that light a position in free space with their shares, which are above 0 and sum to 1; continuous in
    /// the position.
    ///
    /// # Errors
    /// [`ProbeError::QueryNotFinite`].
    pub fn shares(&self, position: DVec3, hint: &mut Hint) -> Result<Vec<(u32, f64)>, ProbeError> {
        Ok(self.weigh(position, Vec3::ZERO, hint)?.iter().collect())
    }

    /// The same of a position on a surface, as [`Field::irradiance`] takes from them: continuous in the position and in
    /// `face_normal`, which points away from the surface on the side that is lit.
    ///
    /// # Errors
    /// [`ProbeError::QueryNotFinite`] if the position or the normal is not finite.
    pub fn surface_shares(
        &self,
        position: DVec3,
        face_normal: Vec3,
        hint: &mut Hint,
    ) -> Result<Vec<(u32, f64)>, ProbeError> {
        Ok(self.weigh(position, face_normal, hint)?.iter().collect())
    }

    pub(crate) fn weigh(
        &self,
        position: DVec3,
        face_normal: Vec3,
        hint: &mut Hint,
    ) -> Result<Shares, ProbeError> {
        if !position.is_finite() || !face_normal.is_finite() {
            return Err(ProbeError::QueryNotFinite { index: 0 });
        }
        let spot = Spot::new(position, face_normal.as_dvec3(), self.bias(), self.spacing);
        if let Some(distances) = &self.distances {
            return Ok(by_sight(&spot, &self.tree, |probe| distances.get(probe as usize)));
        }
        let cell = self.locator.locate(position, hint)?;
        Ok(by_cell(&spot, &cell, &self.tree, |probe| self.positions[probe as usize]))
    }

    /// Irradiance on a surface in space: `face_normal` points away from it, on the side that is lit, and `normal` is
    /// what it is shaded with, both of length 1; a `face_normal` of 0 is none: all probes around count, as for objects.
    /// Linear RGB, at least 0.
    ///
    /// # Errors
    /// [`ProbeError::QueryNotFinite`] if the position or a normal is not finite.
    pub fn irradiance(
        &self,
        position: DVec3,
        face_normal: Vec3,
        normal: Vec3,
        hint: &mut Hint,
    ) -> Result<Vec3, ProbeError> {
        if !normal.is_finite() {
            return Err(ProbeError::QueryNotFinite { index: 0 });
        }
        let shares = self.weigh(position, face_normal, hint)?;
        let basis: [f64; MAX_COUNT] = basis(self.order, normal.as_dvec3());
        let count = coefficient_count(self.order);
        let mut sum = Vec3::ZERO;
        for (probe, weight) in shares.iter() {
            let light = &self.irradiance[probe as usize * count..][..count];
            let at: Vec3 = light.iter().zip(basis).map(|(c, y)| *c * y as f32).sum();
            sum += at * weight as f32;
        }
        Ok(sum.max(Vec3::ZERO))
    }

    /// The light at an object, up to band 2, to be evaluated at each of its normals: one look-up a frame.
    ///
    /// # Errors
    /// [`ProbeError::QueryNotFinite`].
    pub fn light(&self, position: DVec3, hint: &mut Hint) -> Result<Irradiance, ProbeError> {
        let shares = self.weigh(position, Vec3::ZERO, hint)?;
        let mut light = Irradiance::DARK;
        for (probe, weight) in shares.iter() {
            light.add_scaled(&self.lights[probe as usize], weight as f32);
        }
        Ok(light)
    }

    /// The light at each of many moving objects, on all cores; `objects` keep their hints from frame to frame.
    ///
    /// # Errors
    /// [`ProbeError::QueryNotFinite`] for the first that is not; then none is changed.
    pub fn light_objects(&self, objects: &mut [LitObject]) -> Result<(), ProbeError> {
        if let Some(index) = objects.iter().position(|o| !o.position.is_finite()) {
            return Err(ProbeError::QueryNotFinite { index });
        }
        parallel::for_each_mut(objects, |object| {
            if let Ok(light) = self.light(object.position, &mut object.hint) {
                object.light = light;
            }
        });
        Ok(())
    }

    /// Irradiance at many positions and unit normals, on all cores.
    ///
    /// # Errors
    /// [`ProbeError::QueryNotFinite`] for the first that is not.
    pub fn irradiance_all(&self, queries: &[(DVec3, Vec3)]) -> Result<Vec<Vec3>, ProbeError> {
        if let Some(index) = queries.iter().position(|(p, n)| !p.is_finite() || !n.is_finite()) {
            return Err(ProbeError::QueryNotFinite { index });
        }
        let one = |i: usize| {
            let (position, normal) = queries[i];
            let mut hint = self.locator.hint(position);
            self.irradiance(position, normal, normal, &mut hint)
        };
        parallel::map(queries.len(), one).into_iter().collect()
    }
}

/// Coefficients of irradiance from those of radiance.
pub(crate) fn irradiance_of(radiance: &Sh) -> Vec<Vec3> {
    radiance.convolved(&Lobe::COSINE).into_coefficients().into_iter().map(|c| c.as_vec3()).collect()
}

pub(crate) fn expect_count(probes: usize, given: usize) -> Result<(), ProbeError> {
    if probes == given { Ok(()) } else { Err(ProbeError::CountMismatch { probes, given }) }
}

/// Refuses positions whose squared distances would overflow. Coordinates that are not finite are refused by the
/// triangulation.
fn check_positions(positions: &[DVec3]) -> Result<(), ProbeError> {
    let is_far = |p: &DVec3| p.is_finite() && p.abs().max_element() > Field::FARTHEST;
    match positions.iter().position(is_far) {
        Some(index) => Err(ProbeError::PositionTooFar { index }),
        None => Ok(()),
    }
}

/// The order of all; 0 of none.
///
/// # Errors
/// [`ProbeError::MixedOrders`] for the first that has another than the first of all; [`ProbeError::BadRadiance`].
pub(crate) fn common_order(radiance: &[Sh]) -> Result<usize, ProbeError> {
    let expected = radiance.first().map_or(0, Sh::order);
    for (index, sh) in radiance.iter().enumerate() {
        check_radiance(index, sh, expected)?;
    }
    Ok(expected)
}

/// What a probe may hold: functions of the order of the others, whose light is finite in single precision.
pub(crate) fn check_radiance(index: usize, sh: &Sh, expected: usize) -> Result<(), ProbeError> {
    let order = sh.order();
    if order != expected {
        return Err(ProbeError::MixedOrders { index, order, expected });
    }
    let is_good = |c: &DVec3| c.abs().cmple(DVec3::splat(Field::BRIGHTEST)).all();
    if sh.coefficients().iter().all(is_good) { Ok(()) } else { Err(ProbeError::BadRadiance { index }) }
}

/// Mean length of the edges between probes; 0 for a single probe.
pub(crate) fn spacing(positions: &[DVec3], partition: &Partition) -> f64 {
    let mut sum = 0.0;
    let mut count = 0_usize;
    let mut add = |a: u32, b: u32| {
        sum += positions[a as usize].distance(positions[b as usize]);
        count += 1;
    };
    match partition {
        Partition::Point(_) => {}
        Partition::Line(line) => line.windows(2).for_each(|ends| add(ends[0], ends[1])),
        Partition::Triangles(t) => {
            t.corners
                .iter()
                .for_each(|&[a, b, c]| [(a, b), (b, c), (c, a)].into_iter().for_each(|(i, j)| add(i, j)));
        }
        Partition::Tetrahedra(t) => {
            let edges = |&[a, b, c, d]: &[u32; 4]| [(a, b), (a, c), (a, d), (b, c), (b, d), (c, d)];
            t.corners.iter().flat_map(edges).for_each(|(i, j)| add(i, j));
        }
    }
    if count == 0 { 0.0 } else { sum / count as f64 }
}
