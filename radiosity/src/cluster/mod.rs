//! Buildings: radiosity of many thousand surfaces, by clusters of patches and rays (\[6\], \[7\], \[8\]).
//!
//! 1. Patches that are near one another and face about the same way form a cluster ([`groups`]). Their number is bounded by
//!    the size of the scene over that of a cluster, however small the surfaces are.
//! 2. A cluster gathers along links to patches: each is a ray from a point of the cluster to the patch that it meets ([`links`]), all of one weight. So a
//!    row of form factors never adds up to more than 1, and what hides what costs nothing extra.
//! 3. All patches of a cluster share its irradiance from other patches; their emission, their direct light and their reflectance are their own
//!    ([`solution`]).
//! 4. For drawing, the irradiance at every vertex is gathered again by rays ([`gather`]), more where they differ, and averaged over neighbours where light
//!    comes from so far away that it cannot differ ([`smooth`]). Patches are divided where it changes fast ([`bake`]).
//! 5. Surfaces that emit are looked at one by one ([`emitters`]), since rays would rarely meet them.
//!
//! Nothing is looked at pair by pair. Cost: the logarithm of the number of surfaces times the number of clusters and vertices.

mod bake;
mod clusters;
mod emitters;
mod gather;
mod groups;
mod links;
mod options;
mod smooth;
mod solution;
pub(crate) mod surroundings;

pub use clusters::{ClusterCounts, Clusters};
pub use options::ClusterOptions;
pub use solution::ClusterSolution;
