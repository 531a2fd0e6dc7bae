//! Placement of probes that know what they see.
//!
//! 1. All free candidates are probes. Each candidate keeps a list of the probes nearest to it by effective distance
//!    ([`Rows`]), from which its light is found without the other probes, and without one of its own.
//! 2. Rounds: the loss of each probe is the error without it minus the error with it, summed over the candidates that
//!    it lights. Those of least loss are taken out, no two that light the same candidate.
//! 3. Exchange: the probe of least loss goes, and that candidate comes which lowers the error most, while it falls.

use super::adaptive::{Adaptive, AdaptiveOptions};
use super::trial::Bench;
use crate::sight::{EXTENT, weights};
use crate::tree::{Extent, Found};
use crate::{ProbeError, parallel};
use std::collections::BTreeMap;

/// Length of lists: until half of the probes are gone, enough are left of it.
const LIST: Extent = Extent { count: 72, rim: 1.0, most: 72, ..EXTENT };

/// Part of the probes that a round may take out.
const SHARE: usize = 20;

/// Probes that light a candidate less than this together are no neighbours there.
const TOGETHER: f64 = 0.1;

/// Probes, and by whom candidates are lit.
#[derive(Clone)]
struct Rows<'a> {
    bench: &'a Bench<'a>,
    alive: Vec<bool>,
    count: usize,
    /// Of each candidate the nearest probes, by rising effective distance; some may be gone.
    lists: Vec<Vec<Found>>,
    /// How many probes there were when lists were made.
    listed: usize,
}

impl<'a> Rows<'a> {
    fn new(bench: &'a Bench<'a>) -> Result<Self, ProbeError> {
        let mut alive = vec![false; bench.count()];
        let free = bench.free();
        free.iter().for_each(|&i| alive[i as usize] = true);
        let mut rows = Self { bench, alive, count: free.len(), lists: vec![], listed: 0 };
        rows.list()?;
        Ok(rows)
    }

    fn chosen(&self) -> Vec<u32> {
        (0..self.alive.len() as u32).filter(|&i| self.alive[i as usize]).collect()
    }

    /// Makes lists anew.
    fn list(&mut self) -> Result<(), ProbeError> {
        let (tree, spacing) = self.bench.tree(&self.chosen())?;
        self.lists = parallel::map_heavy(self.bench.count(), |i| {
            let spot = self.bench.spot(i, spacing);
            tree.nearest(spot.position, LIST, |probe, _| self.bench.seen(&spot, probe))
        });
        self.listed = self.count;
        Ok(())
    }

    fn take_out(&mut self, probes: &[u32]) -> Result<(), ProbeError> {
        for &probe in probes {
            self.count -= usize::from(self.alive[probe as usize]);
            self.alive[probe as usize] = false;
        }
        if 2 * self.count < self.listed { self.list() } else { Ok(()) }
    }

    /// Shares of a candidate from probes but `without`, and from `more` that is none yet.
    fn shares(&self, i: usize, without: Option<u32>, more: Option<Found>) -> Vec<(u32, f64)> {
        let left = |f: &&Found| self.alive[f.probe as usize] && Some(f.probe) != without;
        let mut near: Vec<Found> = Vec::with_capacity(EXTENT.most + 2);
        for found in self.lists[i].iter().filter(left) {
            if found.distance > EXTENT.limit(&near) || near.len() > EXTENT.most {
                break;
            }
            near.push(*found);
        }
        if let Some(more) = more {
            near.insert(near.partition_point(|f| f.distance < more.distance), more);
            let limit = EXTENT.limit(&near);
            near.retain(|f| f.distance <= limit);
            near.truncate(EXTENT.most + 1);
        }
        let mut shares = weights(&near);
        let sum: f64 = shares.iter().map(|s| s.1).sum();
        shares.iter_mut().for_each(|s| s.1 /= sum);
        shares.retain(|s| s.1 > 0.0);
        shares
    }

    /// Shares and error of each candidate.
    fn lit(&self) -> Vec<(Vec<(u32, f64)>, f64)> {
        parallel::map_heavy(self.bench.count(), |i| {
            let shares = self.shares(i, None, None);
            let error = self.bench.error_with(i, &shares);
            (shares, error)
        })
    }

    /// What the loss of each probe costs.
    fn costs(&self, lit: &[(Vec<(u32, f64)>, f64)]) -> Vec<f64> {
        let without = parallel::map_heavy(lit.len(), |i| {
            let (shares, error) = &lit[i];
            let loss = |&(probe, _): &(u32, f64)| {
                let rest = self.shares(i, Some(probe), None);
                // Nothing is left of the list: the probe cannot be judged, and is kept.
                let other = if rest.is_empty() { f64::INFINITY } else { self.bench.error_with(i, &rest) };
                (probe, other - error)
            };
            shares.iter().map(loss).collect::<Vec<_>>()
        });
        let mut costs = vec![0.0; self.alive.len()];
        for (probe, loss) in without.into_iter().flatten() {
            costs[probe as usize] += loss;
        }
        costs
    }

    /// Up to `count` probes whose loss costs least, no two of which light a candidate together; one at least, and
    /// further ones as long as they cost `budget` together.
    fn cheapest(&self, lit: &[(Vec<(u32, f64)>, f64)], count: usize, budget: f64) -> Vec<u32> {
        let costs = self.costs(lit);
        let mut lights: Vec<Vec<u32>> = vec![vec![]; self.alive.len()];
        for (i, (shares, _)) in lit.iter().enumerate() {
            shares.iter().filter(|s| s.1 > TOGETHER).for_each(|s| lights[s.0 as usize].push(i as u32));
        }
        let mut order = self.chosen();
        let cost = |i: u32| costs[i as usize];
        order.sort_by(|&a, &b| cost(a).total_cmp(&cost(b)).then(a.cmp(&b)));
        let mut blocked = vec![false; self.alive.len()];
        let (mut out, mut spent) = (vec![], 0.0);
        for probe in order {
            if out.len() == count || blocked[probe as usize] {
                continue;
            }
            spent += cost(probe).max(0.0);
            if !out.is_empty() && spent > budget {
                break;
            }
            out.push(probe);
            for &i in &lights[probe as usize] {
                lit[i as usize]
                    .0
                    .iter()
                    .filter(|s| s.1 > TOGETHER)
                    .for_each(|s| blocked[s.0 as usize] = true);
            }
        }
        out
    }

    /// What the errors change by if a candidate becomes a probe.
    fn gain(&self, probe: u32, spacing: f64, lit: &[(Vec<(u32, f64)>, f64)], rims: &[f64]) -> f64 {
        let at = self.bench.positions()[probe as usize];
        let change = |i: usize| {
            let spot = self.bench.spot(i, spacing);
            let offset = at - spot.position;
            let plain = offset.length();
            if plain > rims[i] {
                return 0.0;
            }
            let seen = self.bench.seen(&spot, probe);
            let found = Found { distance: LIST.effective(plain, seen), seen, offset, probe };
            if found.distance > rims[i] {
                return 0.0;
            }
            self.bench.error_with(i, &self.shares(i, None, Some(found))) - lit[i].1
        };
        (0..lit.len()).map(change).sum()
    }

    /// The effective distance up to which a probe lights each candidate.
    fn rims(&self) -> Vec<f64> {
        parallel::map(self.lists.len(), |i| {
            let near: Vec<Found> =
                self.lists[i].iter().filter(|f| self.alive[f.probe as usize]).copied().collect();
            EXTENT.limit(&near)
        })
    }

    /// Candidates to try: of those next to each probe the one with the largest error, from the probes about which
    /// errors are largest.
    fn shortlist(&self, lit: &[(Vec<(u32, f64)>, f64)], trials: usize) -> Vec<u32> {
        let mut about: BTreeMap<u32, (f64, Option<u32>)> = BTreeMap::new();
        for (i, (shares, error)) in lit.iter().enumerate() {
            let Some(&(probe, _)) = shares.iter().max_by(|a, b| a.1.total_cmp(&b.1)) else { continue };
            let entry = about.entry(probe).or_insert((0.0, None));
            entry.0 += error;
            let is_new = self.bench.basis(i).is_none() && !self.alive[i];
            if is_new && entry.1.is_none_or(|worst| *error > lit[worst as usize].1) {
                entry.1 = Some(i as u32);
            }
        }
        let mut worst: Vec<(f64, u32)> = about.into_values().filter_map(|(e, i)| Some((e, i?))).collect();
        worst.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        worst.truncate(trials);
        worst.into_iter().map(|w| w.1).collect()
    }

    /// The probe of least loss for the candidate of most use; `None` if nothing can be tried.
    fn exchanged(&self, trials: usize) -> Result<Option<Self>, ProbeError> {
        if self.count < 2 {
            return Ok(None);
        }
        let mut fewer = self.clone();
        fewer.take_out(&self.cheapest(&self.lit(), 1, f64::INFINITY))?;
        let lit = fewer.lit();
        let tries = fewer.shortlist(&lit, trials);
        let (_, spacing) = self.bench.tree(&fewer.chosen())?;
        let rims = fewer.rims();
        let gains = parallel::map_heavy(tries.len(), |k| fewer.gain(tries[k], spacing, &lit, &rims));
        let best = tries.iter().zip(gains).min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(b.0)));
        let Some((&new, _)) = best else { return Ok(None) };
        fewer.alive[new as usize] = true;
        fewer.count += 1;
        fewer.list()?;
        Ok(Some(fewer))
    }
}

fn error2(lit: &[(Vec<(u32, f64)>, f64)]) -> f64 {
    lit.iter().map(|l| l.1).sum()
}

/// As [`adaptive`](super::adaptive), for candidates with distances; at most `limit` are left.
pub(super) fn choose_by_sight(
    bench: &Bench<'_>,
    limit: usize,
    options: &AdaptiveOptions,
) -> Result<Adaptive, ProbeError> {
    let (mut rows, errors) = thinned(bench, limit, options.max_error * options.max_error)?;
    let mut error = error2(&rows.lit());
    for _ in 0..options.exchanges {
        let Some(other) = rows.exchanged(options.trials.max(1))? else { break };
        let then = error2(&other.lit());
        if then >= error {
            break;
        }
        (rows, error) = (other, then);
    }
    Ok(Adaptive { error: error.sqrt(), chosen: rows.chosen(), errors })
}

/// Takes out probes until `limit` are left, and on as long as the squared error stays within `enough`.
fn thinned<'a>(
    bench: &'a Bench<'a>,
    limit: usize,
    enough: f64,
) -> Result<(Rows<'a>, Vec<(usize, f64)>), ProbeError> {
    let mut rows = Rows::new(bench)?;
    let mut lit = rows.lit();
    let mut errors = vec![(rows.count, error2(&lit).sqrt())];
    // Rounds become smaller after one that went beyond the error allowed.
    let mut most = usize::MAX;
    while rows.count > 1 {
        let wanted = rows.count.saturating_sub(limit);
        let share = (rows.count / SHARE).max(1);
        let out = match wanted {
            0 => rows.cheapest(&lit, share.min(most), enough - error2(&lit)),
            _ => rows.cheapest(&lit, share.min(wanted), f64::INFINITY),
        };
        let mut left = rows.clone();
        left.take_out(&out)?;
        let then = left.lit();
        if wanted == 0 && error2(&then) > enough {
            if out.len() == 1 {
                break;
            }
            most = out.len() / 2;
            continue;
        }
        (rows, lit) = (left, then);
        errors.push((rows.count, error2(&lit).sqrt()));
    }
    Ok((rows, errors))
}
