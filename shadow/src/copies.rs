//! Copies of a triangle among the casters of a screen, taken together.
//!
//! Otherwise every receiver would be compared with each of n coincident casters, and n coincident receivers would need
//! n² comparisons. Copies of one opacity α are one caster of opacity 1 − (1 − α)ⁿ. Under the paper's rule, where the
//! opacities of a layer add up, they stay apart.

use crate::casters::Caster;
use glam::DVec3;

/// So many that few keys share one by chance.
const SLOTS_PER_KEY: usize = 8;

/// Memory of [`merge`].
#[derive(Debug, Default)]
pub(crate) struct Keys {
    list: Vec<(u64, u32)>,
    /// For each slot, how many keys fall into it: none, one, or more.
    slots: Vec<u8>,
}

/// Merges casters that have the same corners and the same opacity into the first of them; the others get opacity 0. `keys` is memory.
///
/// Only equal opacities are merged: a product of different ones would depend on their order by rounding.
pub(crate) fn merge(casters: &mut [Caster], keys: &mut Keys) {
    let Keys { list: keys, slots } = keys;
    keys.clear();
    let constant =
        casters.iter().enumerate().filter_map(|(i, c)| Some((key(&c.face.corners, c.opacity?), i as u32)));
    keys.extend(constant);
    // Hardly any are copies: what has a slot of its own need not be sorted.
    let count = (SLOTS_PER_KEY * keys.len()).next_power_of_two();
    slots.clear();
    slots.resize(count, 0);
    let slot = |key: u64| key as usize & (count - 1);
    keys.iter().for_each(|k| slots[slot(k.0)] = 2.min(slots[slot(k.0)] + 1));
    keys.retain(|k| slots[slot(k.0)] > 1);
    keys.sort_unstable();
    let mut start = 0;
    while start < keys.len() {
        let run = keys[start..].iter().take_while(|k| k.0 == keys[start].0).count();
        if run > 1 {
            merge_run(casters, &keys[start..start + run]);
        }
        start += run;
    }
}

/// Casters of one key, lowest index first. Different casters of one key are rare and stay apart.
fn merge_run(casters: &mut [Caster], run: &[(u64, u32)]) {
    let first = run[0].1 as usize;
    let (corners, opacity) = (casters[first].face.corners, casters[first].opacity);
    let mut copies = 1;
    for &(_, i) in &run[1..] {
        let other = &mut casters[i as usize];
        if other.face.corners == corners && other.opacity == opacity {
            other.opacity = Some(0.0);
            copies += 1;
        }
    }
    casters[first].opacity = opacity.map(|alpha| 1.0 - (1.0 - alpha).powi(copies));
}

fn key(corners: &[DVec3; 3], opacity: f64) -> u64 {
    const ODD: u64 = 0x9e37_79b9_7f4a_7c15;
    let mix = |hash: u64, bits: u64| (hash ^ bits).wrapping_mul(ODD).rotate_left(29);
    let coordinates = corners.iter().flat_map(|c| c.to_array());
    coordinates.fold(opacity.to_bits(), |hash, v| mix(hash, v.to_bits()))
}
