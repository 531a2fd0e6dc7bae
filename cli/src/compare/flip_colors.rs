//! Colours for FLIP, from black (equal) over purple and orange to a pale yellow (as different as can be).

/// sRGB at even steps from 0 to 1. Brightness rises all the way, so that the map can be read without its hues.
const STOPS: [[f32; 3]; 7] = [
    [0.0, 0.0, 0.02],
    [0.16, 0.07, 0.36],
    [0.42, 0.11, 0.5],
    [0.69, 0.21, 0.48],
    [0.93, 0.36, 0.38],
    [0.99, 0.65, 0.45],
    [0.99, 0.99, 0.75],
];

/// The map as bytes of red, green and blue.
pub(super) fn flip_bytes(map: &[f32]) -> Vec<u8> {
    map.iter().flat_map(|&error| color_of(error)).collect()
}

fn color_of(error: f32) -> [u8; 3] {
    let at = error.clamp(0.0, 1.0) * (STOPS.len() - 1) as f32;
    let below = (at as usize).min(STOPS.len() - 2);
    let share = at - below as f32;
    let mix = |i: usize| STOPS[below][i] + share * (STOPS[below + 1][i] - STOPS[below][i]);
    [0, 1, 2].map(|i| (mix(i) * 255.0 + 0.5) as u8)
}
