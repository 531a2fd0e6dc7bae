//! What points see of a line that shines, exactly and without samples.
//!
//! From a point P, a triangle between P and the line from A to B hides those places A + t (B − A) whose lines to P pass through it: on the inner
//! sides of its three edges, and with its plane between P and the place. Each of these four conditions is linear in t, so that a triangle hides
//! one interval ([`cut`]).
//!
//! 1. Receivers are divided into ever smaller groups, and casters outside the hull of a group and the line are left out ([`group`],
//!    [`hull`]). A group without casters sees the whole line.
//! 2. A receiver is asked in its middle and near its corners. Where their answers disagree by more than [`AreaOptions`](crate::AreaOptions)
//!    allow, it is halved.
//! 3. Ends of intervals divide the line into parts. A part passes the product of what its casters pass, masks by their mean along the part.

mod cut;
mod group;
mod hull;
mod light;

pub use group::LineScratch;
pub use light::{LineLight, SeenLine};
