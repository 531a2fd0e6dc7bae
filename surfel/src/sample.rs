//! Sampling a mesh: the public functions and their options.

use crate::mesh::Mesh;
use crate::{SurfacePoint, SurfelError, blue_noise, ldi, radius};
use glam::DVec3;

/// Most points that [`sample`] makes.
pub const MAX_COUNT: usize = 1 << 28;

/// How many points.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Amount {
    /// This many, at least 1. [`Method::Poisson`] makes exactly this many; [`Method::Ldi`] takes the spacing at which
    /// this many are to be expected.
    Count(usize),
    /// Points about this far from their neighbours, world units. [`Method::Ldi`]: the distance of the rays.
    /// [`Method::Poisson`]: the distance in a hexagonal lattice of as many points.
    Spacing(f64),
}

/// How points are chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Method {
    /// By rays along the three axes: regular, independent of the order of triangles.
    Ldi,
    /// By elimination of the most crowded: blue noise.
    #[default]
    Poisson,
}

/// What [`sample`] is to do.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SampleOptions {
    /// How many points. Default: a count of 100,000.
    pub amount: Amount,
    /// How they are chosen. Default: [`Method::Poisson`].
    pub method: Method,
    /// Where the random numbers of [`Method::Poisson`] begin. Default: 0.
    pub seed: u64,
}

impl Default for SampleOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl SampleOptions {
    /// The defaults, as a constant.
    pub const DEFAULT: Self = Self { amount: Amount::Count(100_000), method: Method::Poisson, seed: 0 };

    /// Sets the number of points.
    #[must_use]
    pub const fn with_count(mut self, count: usize) -> Self {
        self.amount = Amount::Count(count);
        self
    }

    /// Sets the spacing of the points, world units.
    #[must_use]
    pub const fn with_spacing(mut self, spacing: f64) -> Self {
        self.amount = Amount::Spacing(spacing);
        self
    }

    /// Sets how points are chosen.
    #[must_use]
    pub const fn with_method(mut self, method: Method) -> Self {
        self.method = method;
        self
    }

    /// Sets where random numbers begin.
    #[must_use]
    pub const fn with_seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }
}

/// Share of the time after which points are chosen and only their radii are left, about.
const CHOSEN: f64 = 0.75;

/// Points all over a mesh, evenly by area, each with the radius of its disc.
///
/// Triangles without area get none. Points come ray by ray ([`Method::Ldi`]) or in the order of the triangles
/// ([`Method::Poisson`]). The same input gives the same points, bit for bit, on any number of threads.
///
/// # Errors
/// [`SurfelError::VertexNotFinite`], [`SurfelError::VertexOutOfRange`], [`SurfelError::NoArea`],
/// [`SurfelError::ZeroCount`], [`SurfelError::BadSpacing`], [`SurfelError::TooManyPoints`], [`SurfelError::TooFine`].
pub fn sample(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    options: &SampleOptions,
) -> Result<Vec<SurfacePoint>, SurfelError> {
    sample_with(positions, triangles, options, &|_| ())
}

/// As [`sample`]; `done` is called now and then, from any thread, with the share of the work that is done, 0 to 1.
///
/// # Errors
/// As [`sample`].
pub fn sample_with(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    options: &SampleOptions,
    done: &(dyn Fn(f64) + Sync),
) -> Result<Vec<SurfacePoint>, SurfelError> {
    match options.amount {
        Amount::Count(0) => return Err(SurfelError::ZeroCount),
        Amount::Spacing(spacing) if !(spacing > 0.0 && spacing.is_finite()) => {
            return Err(SurfelError::BadSpacing { spacing });
        }
        _ => {}
    }
    let mesh = Mesh::new(positions, triangles)?;
    let (mut points, reach, on_border) = match options.method {
        Method::Ldi => {
            let spacing = match options.amount {
                Amount::Count(count) => ldi::spacing_for(&mesh, within_limit(count as f64)?),
                Amount::Spacing(spacing) => spacing,
            };
            within_limit(ldi::expected_count(&mesh, spacing))?;
            (ldi::points(&mesh, spacing)?, ldi::COVER * spacing, ldi::COVER * spacing)
        }
        Method::Poisson => {
            let count = match options.amount {
                Amount::Count(count) => count as f64,
                Amount::Spacing(spacing) => blue_noise::count_for(mesh.area(), spacing),
            };
            let count = within_limit(count)? as usize;
            let lattice = blue_noise::lattice_spacing(mesh.area(), count);
            let points = blue_noise::points(&mesh, count, options.seed, &|share| done(CHOSEN * share));
            (points, blue_noise::COVER * lattice, blue_noise::ON_BORDER * lattice)
        }
    };
    done(CHOSEN);
    radius::assign(&mut points, reach, on_border, &|share| done(CHOSEN + (1.0 - CHOSEN) * share));
    Ok(points)
}

fn within_limit(count: f64) -> Result<f64, SurfelError> {
    if count <= MAX_COUNT as f64 {
        Ok(count)
    } else {
        Err(SurfelError::TooManyPoints { count, limit: MAX_COUNT })
    }
}
