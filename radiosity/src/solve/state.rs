//! The state of a solver: radiosity on all levels of the tree, and the operator ρF.

use crate::error::RadiosityError;
use crate::rgb::{Rgb, add, times};
use crate::transport::Transport;
use crate::tree::ElementId;

/// Contractions nearer to 1 bound nothing.
const MOST: f64 = 1.0 - 1e-12;

/// The state of a solver.
pub(crate) struct State<'t> {
    pub(crate) transport: &'t Transport,
    /// Emission and reflected direct light of leaves, by element.
    pub(crate) source: Vec<Rgb>,
    /// Mean radiosity of every element, as links see it.
    pub(crate) radiosity: Vec<Rgb>,
    /// Reflectance of leaves times the scale of their rows, by element.
    pub(crate) reflectance: Vec<Rgb>,
    pub(crate) contraction: f64,
    proof: Proof,
    /// Power of all sources: Σ area · (E + ρH) over leaves and bands.
    pub(crate) power: f64,
}

impl<'t> State<'t> {
    pub(crate) fn new(transport: &'t Transport, direct: &[Rgb]) -> Result<Self, RadiosityError> {
        let mut source = vec![[0.0; 3]; transport.scene.tree.elements.len()];
        let mut reflectance = source.clone();
        let mut contraction = 0.0_f64;
        let mut power = 0.0;
        for (i, (&leaf, sum)) in transport.leaves.iter().zip(transport.row_sums()).enumerate() {
            let element = &transport.scene.tree.elements[leaf as usize];
            let side = &transport.scene.sides[element.side as usize];
            let light = direct.get(i).copied().unwrap_or_default();
            source[leaf as usize] = add(side.emission, 1.0, times(side.reflectance, light));
            let most = side.reflectance.into_iter().fold(0.0, f64::max);
            contraction = contraction.max(most * sum);
            reflectance[leaf as usize] = side.reflectance.map(|r| r * transport.scale[i]);
            power += element.polygon.area() * source[leaf as usize].iter().sum::<f64>();
        }
        let radiosity = vec![[0.0; 3]; source.len()];
        let proof = Proof::Rows { contraction };
        let mut state = Self { transport, source, radiosity, reflectance, contraction, proof, power };
        if contraction > MOST {
            state.proof = Proof::of_weights(&state).ok_or(RadiosityError::NoEquilibrium { contraction })?;
        }
        Ok(state)
    }

    /// Of a leaf.
    pub(crate) fn reflectance(&self, leaf: ElementId) -> Rgb {
        self.reflectance[leaf as usize]
    }

    pub(crate) fn area(&self, element: ElementId) -> f64 {
        self.transport.scene.tree.elements[element as usize].polygon.area()
    }

    /// A step of Gauss–Seidel: gathers at an element and at all below it, added to what arrives by the links of its parents. New values are
    /// used at once.
    pub(crate) fn sweep(&mut self, element: ElementId, from_above: Rgb) {
        let i = element as usize;
        let arriving = add(from_above, 1.0, self.gathered(&self.radiosity, element));
        let children = self.transport.scene.tree.elements[i].children();
        if children.is_empty() {
            self.radiosity[i] = add(self.source[i], 1.0, times(self.reflectance(element), arriving));
            return;
        }
        for child in children {
            let share = self.transport.shares[child as usize];
            self.sweep(child, arriving.map(|a| a * share));
        }
        self.radiosity[i] = self.pulled(&self.radiosity, element);
    }

    /// Irradiance of an element by its own links.
    #[inline]
    pub(crate) fn gathered(&self, radiosity: &[Rgb], element: ElementId) -> Rgb {
        let row = self.transport.row(element);
        row.iter().fold([0.0; 3], |sum, e| add(sum, e.factor, radiosity[e.to as usize]))
    }

    /// Mean of the children as links see it: by area and share.
    pub(crate) fn pulled(&self, values: &[Rgb], element: ElementId) -> Rgb {
        let (mut sum, mut area) = ([0.0; 3], 0.0);
        for child in self.transport.scene.tree.elements[element as usize].children() {
            sum = add(sum, self.area(child) * self.transport.shares[child as usize], values[child as usize]);
            area += self.area(child);
        }
        sum.map(|s| s / area)
    }

    /// Means of all inner elements from the leaves.
    pub(crate) fn pull_all(&self, values: &mut [Rgb]) {
        // Children come after their parents.
        for element in (0..values.len() as u32).rev() {
            if !self.transport.scene.tree.elements[element as usize].is_leaf() {
                values[element as usize] = self.pulled(values, element);
            }
        }
    }

    /// F x for every element, with x on all levels.
    pub(crate) fn arriving(&self, values: &[Rgb]) -> Vec<Rgb> {
        let elements = &self.transport.scene.tree.elements;
        let mut arriving = vec![[0.0; 3]; elements.len()];
        for element in 0..elements.len() as u32 {
            let here = add(arriving[element as usize], 1.0, self.gathered(values, element));
            for child in elements[element as usize].children() {
                let share = self.transport.shares[child as usize];
                arriving[child as usize] = here.map(|h| h * share);
            }
            arriving[element as usize] = here;
        }
        arriving
    }

    /// ρ F x, of which the leaves matter.
    pub(crate) fn reflected(&self, values: &[Rgb]) -> Vec<Rgb> {
        let mut light = self.arriving(values);
        for &leaf in &self.transport.leaves {
            light[leaf as usize] = times(self.reflectance(leaf), light[leaf as usize]);
        }
        light
    }

    /// E + ρFB − B of every leaf.
    pub(crate) fn residual(&self) -> Vec<Rgb> {
        let mut r = self.reflected(&self.radiosity);
        for &leaf in &self.transport.leaves {
            let i = leaf as usize;
            r[i] = add(add(r[i], 1.0, self.source[i]), -1.0, self.radiosity[i]);
        }
        r
    }

    /// Σ area · |value| over leaves and bands.
    pub(crate) fn power_of(&self, values: &[Rgb]) -> f64 {
        let leaves = self.transport.leaves.iter();
        leaves.map(|&leaf| self.area(leaf) * values[leaf as usize].iter().map(|v| v.abs()).sum::<f64>()).sum()
    }

    /// Largest value of any leaf and band.
    pub(crate) fn largest(&self, values: &[Rgb]) -> f64 {
        let leaves = self.transport.leaves.iter();
        leaves.flat_map(|&leaf| values[leaf as usize]).fold(0.0, |m, v| m.max(v.abs()))
    }

    /// Bound on the error, given the residual.
    pub(crate) fn bound(&self, residual: &[Rgb]) -> f64 {
        match &self.proof {
            Proof::Rows { contraction } => self.largest(residual) / (1.0 - contraction),
            Proof::Weights { largest, left } => {
                let leaves = self.transport.leaves.iter();
                let of = |&leaf: &u32| {
                    let i = leaf as usize;
                    residual[i].into_iter().fold(0.0, |m: f64, v| m.max(v.abs())) / left[i]
                };
                largest * leaves.map(of).fold(0.0, f64::max)
            }
        }
    }
}

/// Why the error is bounded by the residual.
#[derive(Debug)]
pub(crate) enum Proof {
    /// No row reflects more than this.
    Rows {
        /// Reflectance times row sum, at most.
        contraction: f64,
    },
    /// Rows may add up to more than 1 by errors of their factors. If w > 0 and v = (I − ρF) w > 0, then (I − ρF)⁻¹
    /// has no negative entries, and |error| ≤ max w · max |r|/v.
    Weights {
        /// Largest w.
        largest: f64,
        /// v, by element.
        left: Vec<f64>,
    },
}

/// Most sweeps in which a proof is looked for.
const PROOF_SWEEPS: usize = 2000;
/// Least v with which the proof is accepted; the exact solution has v = 1.
const PROVEN: f64 = 0.5;

impl Proof {
    /// Solves (I − ρF) w = 1 until v is positive everywhere.
    fn of_weights(state: &State<'_>) -> Option<Self> {
        let transport = state.transport;
        let brightest = |r: Rgb| [r.into_iter().fold(0.0, f64::max); 3];
        let mut trial = State {
            transport,
            source: state.source.clone(),
            radiosity: state.radiosity.clone(),
            reflectance: state.reflectance.iter().map(|&r| brightest(r)).collect(),
            contraction: state.contraction,
            proof: Self::Rows { contraction: state.contraction },
            power: state.power,
        };
        for &leaf in &transport.leaves {
            trial.source[leaf as usize] = [1.0; 3];
        }
        for _ in 0..PROOF_SWEEPS {
            for &root in &transport.scene.tree.roots {
                trial.sweep(root, [0.0; 3]);
            }
            // 1 + ρFw − w is 1 − v.
            let residual = trial.residual();
            let left: Vec<f64> = residual.iter().map(|r| 1.0 - r[0]).collect();
            let least = transport.leaves.iter().fold(f64::MAX, |m, &leaf| m.min(left[leaf as usize]));
            let largest = trial.largest(&trial.radiosity);
            if least >= PROVEN && largest.is_finite() {
                return Some(Self::Weights { largest, left });
            }
            if largest.is_nan() || largest > 1e12 {
                return None;
            }
        }
        None
    }
}
