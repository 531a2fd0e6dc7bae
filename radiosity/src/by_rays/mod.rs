//! Buildings: radiosity of many thousand surfaces, whose links are found by rays (\[6\], \[7\], \[8\]).
//!
//! 1. From points that are spread over a patch, rays leave by the cosine; each links the patch to the one that it meets ([`links`]), all with the same weight. So a
//!    row of form factors never adds up to more than 1, and nothing is looked at pair by pair. Large patches have more links: the
//!    error of a small one, which is independent of that of its neighbours, does not matter where many are seen together.
//! 2. The equations are solved with emission, direct light and reflectance of every patch ([`solution`]).
//! 3. For drawing, the irradiance at every vertex is gathered again by rays ([`gather`]). Vertices near to one another, compared with the distances from which
//!    light comes, form a cluster of receivers, which share their rays ([`smooth`]); more rays are taken where the error is still too large, and towards those parts
//!    of the hemisphere where neighbours have seen light differ ([`parts`], [`neighbours`]). Patches are divided where light changes fast ([`bake`]).
//! 4. Surfaces that emit are looked at one by one ([`emitters`]), since rays would rarely meet them.
//!
//! Cost: the logarithm of the number of surfaces times the number of patches and vertices.

mod bake;
mod emitters;
mod gather;
mod links;
mod neighbours;
mod options;
mod parts;
mod smooth;
mod solution;
pub(crate) mod surroundings;
mod transport;

pub use options::RayOptions;
pub use solution::RaySolution;
pub use transport::{RayCounts, RayTransport};
