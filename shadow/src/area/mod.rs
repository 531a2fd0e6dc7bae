//! What points see of a polygonal light, exactly and without samples.
//!
//! From a point P, everything between P and the light's plane is projected onto that plane; what no projection covers is the visible part
//! of the light (\[2\]). Projections are never cut by one another triangle by triangle: only their outlines matter.
//!
//! 1. Casters that may stand between a batch of receivers and the light are gathered, with the edges that they share ([`sheets`]).
//! 2. Receivers are divided into ever smaller groups, and casters outside the shaft between a group and the light are left out
//!    ([`group`], [`shaft`]). A group without casters sees the whole light.
//!    Pieces of one receiver are asked at one point if it is in one of them and stands for them as [`AreaOptions`] say ([`piece`]):
//!    behind translucent surfaces, what is seen of a surface comes in many pieces.
//! 3. From each point, a caster is seen from one side or the other; an edge between two casters seen from the same side is inside of the
//!    shadow and drops out ([`outline`]). What is left of the edges is the shadow's outline, with winding numbers.
//! 4. A sweep along the light's plane finds where the winding number is 0 ([`sweep`]): the visible parts, as trapezoids. A light behind many outlines
//!    is divided into cells first, and those that one connected piece of casters covers are left out ([`light_cells`]).
//!    Sheets of one opacity are counted together: a winding number of n is n layers of them.
//! 5. Masked casters divide these parts further ([`masks`]), each by itself or, where they are many, in the cells of a grid ([`transmittance`]).
//!
//! Grouping only ever leaves out casters whose projections lie outside the light's bounding rectangle. Their edges add up to a winding number
//! of 0 there, exactly (step 4), so that what a point sees depends neither on its companions nor on the order of triangles.

mod group;
mod joined;
pub(crate) mod light;
mod light_cells;
pub(crate) mod masks;
mod outline;
pub(crate) mod piece;
mod shaft;
mod sheets;
mod sweep;
pub(crate) mod targets;
mod transmittance;

pub use group::AreaScratch;
pub use light::{AreaLight, AreaOptions, LARGEST_OUTLINE, SeenLight, check_outline};
