//! Probes inside of solids: moved, left out or refused, as the user wants.

use crate::error::CliError;
use crate::options::Inside;
use glam::DVec3;
use pointillist_render::Solids;

/// What became of a probe inside a solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Outcome {
    /// It is not in a solid.
    Free,
    /// It was, and this is the nearest free place that was found.
    Moved(DVec3),
    /// It is, and is kept as it is.
    Kept,
    /// It is left out.
    Dropped,
}

/// Deals with probe number `index`.
pub(super) fn settle(
    solids: &Solids<'_>,
    index: usize,
    p: DVec3,
    inside: Inside,
) -> Result<Outcome, CliError> {
    if inside == Inside::Keep || solids.is_free(p) {
        return Ok(if inside == Inside::Keep { Outcome::Kept } else { Outcome::Free });
    }
    match inside {
        Inside::Drop => Ok(Outcome::Dropped),
        Inside::Move => solids.nearest_free(p).map(Outcome::Moved).ok_or_else(|| refusal(index, p)),
        Inside::Refuse | Inside::Keep => Err(refusal(index, p)),
    }
}

fn refusal(index: usize, p: DVec3) -> CliError {
    CliError::Failed(format!(
        "probe {index} at {}, {}, {} is inside of a solid\n  = help: move it, or use --inside drop; \
         if the solid is a room, turn its faces inward or put a light or the camera into it",
        p.x, p.y, p.z
    ))
}
