//! Shooting, in the order of unshot power.

use super::importance::check_importance;
use super::options::SolveOptions;
use super::solution::{Solution, by_area};
use super::state::State;
use crate::error::RadiosityError;
use crate::rgb::{Rgb, add, times};
use crate::transport::Transport;
use crate::tree::ElementId;

/// Least importance of a patch, relative to the largest: patches of no importance are shot last, but are shot.
const LEAST_IMPORTANCE: f64 = 1e-3;

pub(super) fn solve<'t>(
    transport: &'t Transport,
    importance: &[f64],
    options: &SolveOptions,
) -> Result<Solution<'t>, RadiosityError> {
    options.check()?;
    if !importance.is_empty() {
        check_importance(transport.leaves.len(), importance)?;
    }
    // With importance, the most important patches would exchange their overshot (negative) power while the others are never shot.
    let overshoot = options.overshoot && importance.is_empty();
    let mut shooter = Shooter::new(State::new(transport, &transport.direct)?, importance, overshoot);
    let mut history = vec![1.0];
    let (mut bound, mut steps, mut converged) = (0.0, 0, shooter.state.power == 0.0);
    let units = shooter.units.len();
    while !converged && steps < options.max_sweeps.saturating_mul(units) {
        let ambient = shooter.ambient();
        let unit = shooter.next(ambient);
        shooter.shoot(unit, ambient);
        steps += 1;
        if steps % units == 0 {
            history.push(shooter.state.power_of(&shooter.unshot) / shooter.state.power);
            bound = shooter.state.bound(&shooter.unshot);
            converged = bound <= options.tolerance * shooter.state.largest(&shooter.state.radiosity);
        }
    }
    let mut state = shooter.state;
    let mut of_element = std::mem::take(&mut state.radiosity);
    state.pull_all(&mut of_element);
    let radiosity = transport.leaves.iter().map(|&leaf| of_element[leaf as usize]).collect();
    Ok(Solution {
        transport,
        by_area: by_area(transport, &of_element),
        of_element,
        radiosity,
        bound,
        contraction: state.contraction,
        steps,
        history,
        converged,
    })
}

struct Shooter<'t> {
    state: State<'t>,
    /// Residual of every leaf: its unshot radiosity, negative after overshooting.
    unshot: Vec<Rgb>,
    /// Units of one shot: leaves, or roots of a hierarchy.
    units: Vec<ElementId>,
    weight: Vec<f64>,
    /// Reflectance averaged over area, and area.
    mean_reflectance: Rgb,
    area: f64,
    overshoot: bool,
    flat: bool,
}

impl<'t> Shooter<'t> {
    fn new(mut state: State<'t>, importance: &[f64], overshoot: bool) -> Self {
        let transport = state.transport;
        let flat = transport
            .links
            .iter()
            .all(|l| [l.a, l.b].into_iter().all(|e| transport.scene.tree.elements[e as usize].is_leaf()));
        let units = if flat { transport.leaves.clone() } else { transport.scene.tree.roots.clone() };
        let mut of_leaf = vec![1.0; state.source.len()];
        let most = importance.iter().copied().fold(0.0, f64::max);
        for (&leaf, value) in transport.leaves.iter().zip(importance) {
            of_leaf[leaf as usize] = value.max(LEAST_IMPORTANCE * most);
        }
        let (mut area, mut reflected) = (0.0, [0.0; 3]);
        for &leaf in &transport.leaves {
            area += state.area(leaf);
            reflected = add(reflected, state.area(leaf), state.reflectance(leaf));
        }
        let unshot = state.source.clone();
        state.radiosity.clone_from(&state.source);
        let mean_reflectance = reflected.map(|r| r / area);
        Self { state, unshot, units, weight: of_leaf, mean_reflectance, area, overshoot, flat }
    }

    /// What a leaf sends when it is shot: its unshot radiosity, and the estimate of what it will receive and reflect later (overshooting).
    fn light(&self, leaf: ElementId, ambient: Rgb) -> Rgb {
        add(self.unshot[leaf as usize], 1.0, times(self.state.reflectance(leaf), ambient))
    }

    /// The power that a unit sends, weighted by importance. Negative residuals count only as far as the new estimate does not cancel them:
    /// a patch that has just overshot would otherwise be chosen again and again for its negative residual.
    fn power_below(&self, unit: ElementId, ambient: Rgb) -> f64 {
        let mut power = 0.0;
        self.state.transport.scene.tree.leaves_below(unit, &mut |leaf| {
            let light: f64 = self.light(leaf, ambient).iter().map(|v| v.abs()).sum();
            power += self.state.area(leaf) * light * self.weight[leaf as usize];
        });
        power
    }

    /// The unit that sends the most power, weighted by importance.
    fn next(&self, ambient: Rgb) -> ElementId {
        let mut best = (self.units[0], -1.0);
        for &unit in &self.units {
            let power = self.power_below(unit, ambient);
            if power > best.1 {
                best = (unit, power);
            }
        }
        best.0
    }

    /// Uniform ambient radiosity that is still to come, for overshooting: unshot power after all further reflections (\[2\], eq. 8).
    fn ambient(&self) -> Rgb {
        if !self.overshoot {
            return [0.0; 3];
        }
        let leaves = self.state.transport.leaves.iter();
        let power =
            leaves.fold([0.0; 3], |sum, &leaf| add(sum, self.state.area(leaf), self.unshot[leaf as usize]));
        let mut ambient = [0.0; 3];
        for band in 0..3 {
            let stays = (1.0 - self.mean_reflectance[band]).max(1e-3);
            ambient[band] = (power[band] / self.area / stays).max(0.0);
        }
        ambient
    }

    fn shoot(&mut self, unit: ElementId, ambient: Rgb) {
        let transport = self.state.transport;
        let tree = &transport.scene.tree;
        let mut sent = vec![];
        tree.leaves_below(unit, &mut |leaf| {
            sent.push((leaf, self.light(leaf, ambient)));
            // Overshooting leaves a negative residual, which light that arrives later cancels.
            self.unshot[leaf as usize] = times(self.state.reflectance(leaf), ambient).map(|e| -e);
        });
        if self.flat {
            for (leaf, light) in sent {
                self.deliver(leaf, light);
            }
            return;
        }
        let mut on_all_levels = vec![[0.0; 3]; tree.elements.len()];
        for (leaf, light) in sent {
            on_all_levels[leaf as usize] = light;
        }
        self.state.pull_all(&mut on_all_levels);
        let arrived = self.state.reflected(&on_all_levels);
        for &leaf in &transport.leaves {
            let i = leaf as usize;
            self.unshot[i] = add(self.unshot[i], 1.0, arrived[i]);
            self.state.radiosity[i] = add(self.state.radiosity[i], 1.0, arrived[i]);
        }
    }

    /// From one leaf to all that it is linked with.
    fn deliver(&mut self, leaf: ElementId, light: Rgb) {
        let transport = self.state.transport;
        for entry in transport.row(leaf) {
            let to = entry.to as usize;
            // Reciprocity: the link's exchange over the receiver's area.
            let factor = transport.links[entry.link as usize].mutual / self.state.area(entry.to);
            let arrived = times(self.state.reflectance(entry.to), light.map(|l| factor * l));
            self.unshot[to] = add(self.unshot[to], 1.0, arrived);
            self.state.radiosity[to] = add(self.state.radiosity[to], 1.0, arrived);
        }
    }
}
