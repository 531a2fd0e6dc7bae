//! Importance: the adjoint of radiosity, how much the emission of a patch contributes to what the camera sees.

use super::options::SolveOptions;
use super::state::State;
use crate::error::RadiosityError;
use crate::rgb::{Rgb, add, is_light, times};
use crate::transport::Transport;

/// I = S + F ρ I. With J = ρ I this is J = ρ S + ρ F J: light from a scene in which what the camera sees is lit.
pub(super) fn solve(
    transport: &Transport,
    seen: &[f64],
    options: &SolveOptions,
) -> Result<Vec<f64>, RadiosityError> {
    options.check()?;
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

/// Checks weights of patches: one for each, all of them usable.
pub(crate) fn check_importance(patches: usize, importance: &[f64]) -> Result<(), RadiosityError> {
    if importance.len() != patches {
        return Err(RadiosityError::CountMismatch { patches, given: importance.len() });
    }
    match importance.iter().position(|&value| !is_light(value)) {
        Some(patch) => Err(RadiosityError::Importance { patch, value: importance[patch] }),
        None => Ok(()),
    }
}
