//! Removes the probes whose loss costs least.

use super::trial::{Bench, Outcome};
use crate::{ProbeError, parallel};

/// The probes that are left, and the error after each round.
pub(super) struct Thinned {
    pub(super) chosen: Vec<u32>,
    pub(super) outcome: Outcome,
    pub(super) errors: Vec<(usize, f64)>,
}

/// Part of the probes that a round may take out, as long as they are not neighbours: small, since costs are found one
/// by one.
const SHARE: usize = 20;

/// Takes out probes until `limit` are left, and on as long as the squared error stays within `enough`.
pub(super) fn thin(bench: &Bench<'_>, limit: usize, enough: f64) -> Result<Thinned, ProbeError> {
    let mut chosen = bench.free();
    let mut outcome = bench.outcome(&chosen)?;
    let mut errors = vec![(chosen.len(), outcome.error2.sqrt())];
    // Rounds become smaller after one that went beyond the error allowed.
    let mut most = usize::MAX;
    while chosen.len() > 1 {
        let wanted = chosen.len().saturating_sub(limit);
        let share = (chosen.len() / SHARE).max(1);
        let (round, budget) = if wanted > 0 {
            (share.min(wanted), f64::INFINITY)
        } else {
            (share.min(most), enough - outcome.error2)
        };
        let out = cheapest(bench, &chosen, &outcome, round, budget)?;
        let left = |i: &usize| !out.contains(&(*i as u32));
        let left: Vec<u32> = (0..chosen.len()).filter(left).map(|i| chosen[i]).collect();
        let next = bench.outcome(&left)?;
        if wanted == 0 && next.error2 > enough {
            if out.len() == 1 {
                break;
            }
            most = out.len() / 2;
            continue;
        }
        (chosen, outcome) = (left, next);
        errors.push((chosen.len(), outcome.error2.sqrt()));
    }
    Ok(Thinned { chosen, outcome, errors })
}

/// Up to `count` probes, as indices into those chosen, none a neighbour of another, whose loss costs least; one at
/// least, and further ones as long as they cost `budget` together.
fn cheapest(
    bench: &Bench<'_>,
    chosen: &[u32],
    outcome: &Outcome,
    count: usize,
    budget: f64,
) -> Result<Vec<u32>, ProbeError> {
    let graph = outcome.partition.graph(chosen.len())?;
    let mut lit_by = vec![vec![]; chosen.len()];
    for (i, cell) in outcome.cells.iter().enumerate() {
        for (k, &probe) in cell.iter().enumerate() {
            if !cell[..k].contains(&probe) {
                lit_by[probe as usize].push(i as u32);
            }
        }
    }
    // The cells that appear where a probe was lie between its neighbours, and are Delaunay cells of the neighbours
    // alone.
    let cost = |probe: usize| -> Result<f64, ProbeError> {
        let around: Vec<u32> = graph.around(probe as u32).iter().map(|&n| chosen[n as usize]).collect();
        if around.is_empty() {
            // It coincides with another probe, which takes over its positions at no cost.
            return Ok(0.0);
        }
        let before: f64 = lit_by[probe].iter().map(|&i| outcome.parts[i as usize]).sum();
        Ok(bench.errors_of(&lit_by[probe], &around)? - before)
    };
    let costs: Vec<f64> = parallel::map_heavy(chosen.len(), cost).into_iter().collect::<Result<_, _>>()?;
    let mut order: Vec<u32> = (0..chosen.len() as u32).collect();
    order.sort_by(|&a, &b| costs[a as usize].total_cmp(&costs[b as usize]).then(a.cmp(&b)));
    let mut blocked = vec![false; chosen.len()];
    let (mut out, mut spent) = (vec![], 0.0);
    for probe in order {
        spent += if blocked[probe as usize] { 0.0 } else { costs[probe as usize].max(0.0) };
        let affordable = out.is_empty() || spent <= budget;
        if out.len() < count && affordable && !blocked[probe as usize] {
            out.push(probe);
            graph.around(probe).iter().for_each(|&n| blocked[n as usize] = true);
        }
    }
    Ok(out)
}
