//! The adjoint: how much what a patch emits adds to what is seen.

use super::state::{State, add, times};
use super::{SolveOptions, check, check_importance};
use crate::error::RadiosityError;
use crate::surface::Rgb;
use crate::transport::Transport;

/// I = S + F ρ I. With J = ρ I this is J = ρ S + ρ F J: light from a scene in which what the camera sees is lit.
pub(super) fn solve(
    transport: &Transport,
    seen: &[f64],
    options: &SolveOptions,
) -> Result<Vec<f64>, RadiosityError> {
    check(options)?;
    check_importance(transport.leaves.len(), seen)?;
    let state = State::new(transport, &[])?;
    let mut along: Vec<Rgb> = vec![[0.0; 3]; state.source.len()];
    for (&leaf, &value) in transport.leaves.iter().zip(seen) {
        along[leaf as usize] = [value; 3];
    }
    let start = along.clone();
    let largest = state.largest(&start).max(f64::MIN_POSITIVE);
    state.pull_all(&mut along);
    for _ in 0..options.max_sweeps {
        // ρ I on all levels, then gathered.
        let mut dimmed = along.clone();
        for &leaf in &transport.leaves {
            dimmed[leaf as usize] = times(state.reflectance(leaf), along[leaf as usize]);
        }
        state.pull_all(&mut dimmed);
        let mut next = state.arriving(&dimmed);
        let mut change = 0.0_f64;
        for &leaf in &transport.leaves {
            let i = leaf as usize;
            next[i] = add(next[i], 1.0, start[i]);
            change = change.max(add(next[i], -1.0, along[i]).into_iter().fold(0.0, |m, v| m.max(v.abs())));
        }
        state.pull_all(&mut next);
        along = next;
        if change <= options.tolerance * (1.0 - state.contraction) * largest {
            break;
        }
    }
    let mean = |v: Rgb| v.iter().sum::<f64>() / 3.0;
    Ok(transport.leaves.iter().map(|&leaf| mean(along[leaf as usize])).collect())
}
