//! Gauss–Seidel, root by root.

use super::options::SolveOptions;
use super::solution::{Solution, by_area};
use super::state::State;
use crate::error::RadiosityError;
use crate::rgb::{Rgb, add, times};
use crate::transport::Transport;

pub(super) fn solve<'t>(
    transport: &'t Transport,
    before: &[Rgb],
    options: &SolveOptions,
) -> Result<Solution<'t>, RadiosityError> {
    options.check()?;
    let mut state = State::new(transport, &transport.direct)?;
    let (mut bound, mut steps, mut converged) = (0.0, 0, state.power == 0.0);
    if !before.is_empty() && !converged {
        let mut radiosity = std::mem::take(&mut state.radiosity);
        transport.leaves.iter().zip(before).for_each(|(&leaf, b)| radiosity[leaf as usize] = *b);
        state.pull_all(&mut radiosity);
        state.radiosity = radiosity;
        bound = state.bound(&state.residual());
        converged = bound <= options.tolerance * state.largest(&state.radiosity);
    }
    let balance = options.balance.then(|| Balance::new(&state));
    let mut history = vec![1.0];
    while !converged && steps < options.max_sweeps {
        for &root in &transport.scene.tree.roots {
            state.sweep(root, [0.0; 3]);
        }
        let mut residual = state.residual();
        if let Some(balance) = &balance {
            balance.correct(&mut state, &mut residual);
        }
        steps += 1;
        history.push(state.power_of(&residual) / state.power);
        bound = state.bound(&residual);
        converged = bound <= options.tolerance * state.largest(&state.radiosity);
    }
    let radiosity = transport.leaves.iter().map(|&leaf| state.radiosity[leaf as usize]).collect();
    let State { radiosity: of_element, contraction, .. } = state;
    let by_area = by_area(transport, &of_element);
    Ok(Solution { transport, of_element, by_area, radiosity, bound, contraction, steps, history, converged })
}

/// A correction along v = ρ, which in bright closed rooms is close to the slowest mode of the error. The step is the one after which the
/// signed sum of the residual's power is 0.
struct Balance {
    /// v, on all levels.
    along: Vec<Rgb>,
    /// v − ρ F v.
    changes: Vec<Rgb>,
    /// Power of the latter.
    power: Rgb,
}

impl Balance {
    fn new(state: &State<'_>) -> Self {
        let mut along = vec![[0.0; 3]; state.radiosity.len()];
        for &leaf in &state.transport.leaves {
            along[leaf as usize] = state.reflectance(leaf);
        }
        state.pull_all(&mut along);
        let mut changes = state.reflected(&along);
        for &leaf in &state.transport.leaves {
            let i = leaf as usize;
            changes[i] = add(along[i], -1.0, changes[i]);
        }
        let power = signed_power(state, &changes);
        Self { along, changes, power }
    }

    fn correct(&self, state: &mut State<'_>, residual: &mut [Rgb]) {
        let missing = signed_power(state, residual);
        let mut step = [0.0; 3];
        for band in 0..3 {
            if self.power[band] > 0.0 {
                step[band] = missing[band] / self.power[band];
            }
        }
        let negative = step.map(|s| -s);
        let after: Vec<Rgb> =
            residual.iter().zip(&self.changes).map(|(r, c)| add(*r, 1.0, times(negative, *c))).collect();
        if state.power_of(&after) >= state.power_of(residual) {
            return;
        }
        residual.copy_from_slice(&after);
        for (b, v) in state.radiosity.iter_mut().zip(&self.along) {
            *b = add(*b, 1.0, times(step, *v));
        }
    }
}

fn signed_power(state: &State<'_>, values: &[Rgb]) -> Rgb {
    let leaves = state.transport.leaves.iter();
    leaves.fold([0.0; 3], |sum, &leaf| add(sum, state.area(leaf), values[leaf as usize]))
}
