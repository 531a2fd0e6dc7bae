//! Placement driven by the error of interpolation.

use super::sighted::choose_by_sight;
use super::thin::thin;
use super::trial::{BALANCE, Bench, Candidates, Outcome, check_amount};
use crate::{ProbeError, parallel};
use std::collections::BTreeMap;

/// When [`adaptive`] stops, and how errors are weighted.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct AdaptiveOptions {
    /// Most probes. Default: 96.
    pub max_count: usize,
    /// Relative RMS error of irradiance at which placement stops. Default: 0: as many probes as allowed are used.
    pub max_error: f64,
    /// How errors are weighted: with 0 they count in absolute terms, with 1 relative to the light at their position.
    /// Default: [`BALANCE`](super::BALANCE).
    pub balance: f64,
    /// Candidates tried in each exchange: the worst lit of the cells with the largest errors. Default: 48.
    pub trials: usize,
    /// Most exchanges at the end, each of a probe that matters little for one that matters more. Default: 64; without distances
    /// at most 16 are made, which take much longer there.
    pub exchanges: usize,
}

impl AdaptiveOptions {
    /// The defaults, as a constant.
    pub const DEFAULT: Self =
        Self { max_count: 96, max_error: 0.0, balance: BALANCE, trials: 48, exchanges: 64 };

    /// Sets how many probes there may be.
    #[must_use]
    pub const fn with_max_count(mut self, count: usize) -> Self {
        self.max_count = count;
        self
    }

    /// Sets the error that may be reached.
    #[must_use]
    pub const fn with_max_error(mut self, error: f64) -> Self {
        self.max_error = error;
        self
    }

    /// Sets how much errors in the dark count.
    #[must_use]
    pub const fn with_balance(mut self, balance: f64) -> Self {
        self.balance = balance;
        self
    }

    /// Sets how many candidates are tried in each exchange.
    #[must_use]
    pub const fn with_trials(mut self, trials: usize) -> Self {
        self.trials = trials;
        self
    }

    /// Sets how many probes may be exchanged at the end.
    #[must_use]
    pub const fn with_exchanges(mut self, exchanges: usize) -> Self {
        self.exchanges = exchanges;
        self
    }
}

impl Default for AdaptiveOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// Most exchanges of probes whose sight is not known: each divides space anew for every trial.
const BLIND_EXCHANGES: usize = 16;

/// Which candidates became probes.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Adaptive {
    /// Indices of candidates, rising.
    pub chosen: Vec<u32>,
    /// How many probes were left, and the error then, round after round.
    pub errors: Vec<(usize, f64)>,
    /// Relative RMS error of irradiance over all candidates and directions with the probes as they are returned.
    pub error: f64,
}

/// Chooses probes among candidates so that interpolation between them errs little, over all candidates and all
/// directions.
///
/// 1. All candidates are probes. Take out, round by round, those that are missed least, never two neighbours at once,
///    until the count is reached; with an error to be reached, on until the next would go beyond it.
/// 2. Exchange: remove the probe whose loss costs least and insert the one that lowers the error most, while the error
///    falls.
///
/// Removing probes works where inserting them fails: a small bright region needs several probes around it before the
/// first of them lowers the error. Interpolation is that of [`Field`](crate::Field), with visibility where distances
/// are given. The result does not depend on threads.
///
/// # Errors
/// [`ProbeError::NoProbes`], [`ProbeError::CountMismatch`], [`ProbeError::PositionNotFinite`],
/// [`ProbeError::MixedOrders`], [`ProbeError::BadRadiance`], [`ProbeError::BadWeight`], [`ProbeError::BadOption`].
pub fn adaptive(candidates: Candidates<'_>, options: &AdaptiveOptions) -> Result<Adaptive, ProbeError> {
    let bench = Bench::new(candidates, options.balance)?;
    check_amount("max_error", options.max_error)?;
    let limit = options.max_count.clamp(1, bench.free().len());
    if bench.sees() {
        return choose_by_sight(&bench, limit, options);
    }
    let thinned = thin(&bench, limit, options.max_error * options.max_error)?;
    let mut state = State { chosen: thinned.chosen, outcome: Some(thinned.outcome) };
    for _ in 0..options.exchanges.min(BLIND_EXCHANGES) {
        let Some(fewer) = best_removal(&bench, &state)? else { break };
        match best_insertion(&bench, &fewer, options.trials)? {
            Some(better) if better.error2() < state.error2() => state = better,
            _ => break,
        }
    }
    state.chosen.sort_unstable();
    Ok(Adaptive { error: state.error2().sqrt(), chosen: state.chosen, errors: thinned.errors })
}

/// A set of probes and what it leaves wrong.
struct State {
    chosen: Vec<u32>,
    outcome: Option<Outcome>,
}

impl State {
    fn error2(&self) -> f64 {
        self.outcome.as_ref().map_or(f64::INFINITY, |o| o.error2)
    }
}

/// The probes with the one more that helps most; none if every candidate is a probe, or is lit without error.
fn best_insertion(bench: &Bench<'_>, state: &State, trials: usize) -> Result<Option<State>, ProbeError> {
    let tries = shortlist(bench, state, trials.max(1));
    let with = |&new: &u32| state.chosen.iter().copied().chain([new]).collect::<Vec<_>>();
    best(bench, tries.iter().map(with).collect())
}

/// The probes without the one that is missed least; none if there is only one.
fn best_removal(bench: &Bench<'_>, state: &State) -> Result<Option<State>, ProbeError> {
    if state.chosen.len() < 2 {
        return Ok(None);
    }
    let without = |out: usize| {
        state.chosen.iter().enumerate().filter(|&(i, _)| i != out).map(|(_, &c)| c).collect::<Vec<_>>()
    };
    best(bench, (0..state.chosen.len()).map(without).collect())
}

/// The set with the smallest error; of equal ones the first.
fn best(bench: &Bench<'_>, sets: Vec<Vec<u32>>) -> Result<Option<State>, ProbeError> {
    let outcomes = parallel::map_heavy(sets.len(), |i| bench.outcome(&sets[i]));
    let mut best: Option<State> = None;
    for (chosen, outcome) in sets.into_iter().zip(outcomes) {
        let state = State { chosen, outcome: Some(outcome?) };
        if best.as_ref().is_none_or(|b| state.error2() < b.error2()) {
            best = Some(state);
        }
    }
    Ok(best)
}

/// Candidates to try: of each cell the one with the largest error, from the cells with the largest errors.
fn shortlist(bench: &Bench<'_>, state: &State, trials: usize) -> Vec<u32> {
    let Some(outcome) = &state.outcome else { return vec![] };
    let mut cells: BTreeMap<[u32; 4], (f64, u32)> = BTreeMap::new();
    for (i, (&part, cell)) in outcome.parts.iter().zip(&outcome.cells).enumerate() {
        if part > 0.0 && bench.basis(i).is_none() && !state.chosen.contains(&(i as u32)) {
            let entry = cells.entry(*cell).or_insert((0.0, i as u32));
            entry.0 += part;
            if part > outcome.parts[entry.1 as usize] {
                entry.1 = i as u32;
            }
        }
    }
    let mut worst: Vec<(f64, u32)> = cells.into_values().collect();
    worst.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    worst.truncate(trials);
    // At first few cells hold many candidates: then the list is filled up with the candidates of largest error.
    let mut tries: Vec<u32> = worst.into_iter().map(|(_, i)| i).collect();
    let mut rest: Vec<u32> =
        bench.free().into_iter().filter(|i| !tries.contains(i) && !state.chosen.contains(i)).collect();
    rest.sort_by(|&a, &b| outcome.parts[b as usize].total_cmp(&outcome.parts[a as usize]).then(a.cmp(&b)));
    let missing = trials - tries.len();
    tries.extend(rest.into_iter().filter(|&i| outcome.parts[i as usize] > 0.0).take(missing));
    tries
}
