//! Images of any values and coefficients of any size: projected, turned and evaluated they are refused or finite.
#![no_main]

use arbitrary::Arbitrary;
use glam::{DQuat, DVec3, dvec3};
use libfuzzer_sys::fuzz_target;
use pointillist_sh::invariants::brackets_stay_within;
use pointillist_sh::{CubeMap, CubeProjector, IrradianceMatrix, Panorama, PanoramaProjector, Sh, Weights};

#[derive(Arbitrary, Debug)]
struct Input {
    texels: Vec<[f32; 3]>,
    order: u8,
    weights: u8,
    turn: [i8; 4],
    towards: [i8; 3],
    cube: bool,
    photographs: Vec<(Vec<[u8; 3]>, f32)>,
}

fn project(input: &Input, weights: Weights) -> Option<Sh> {
    let order = usize::from(input.order % 10);
    if input.cube {
        let size = ((input.texels.len() / 6) as f64).sqrt() as usize;
        let map = CubeMap::from_texels(size, input.texels.get(..6 * size * size)?).ok()?;
        return CubeProjector::new(size, order, weights).ok()?.project(&map).ok();
    }
    let height = (input.texels.len() / 2).isqrt();
    let map = Panorama::new(2 * height, height, input.texels.get(..2 * height * height)?).ok()?;
    PanoramaProjector::new(2 * height, height, order, weights).ok()?.project(&map).ok()
}

fuzz_target!(|input: Input| {
    brackets_stay_within(&input.photographs).unwrap();
    let weights = [Weights::Gregory, Weights::Exact, Weights::Paper][usize::from(input.weights % 3)];
    let Some(sh) = project(&input, weights) else { return };
    let largest = input.texels.iter().flatten().fold(0.0_f64, |m, v| m.max(f64::from(v.abs())));
    let [x, y, z] = input.towards.map(f64::from);
    let normal = dvec3(x, y, z).try_normalize().unwrap_or(DVec3::Y);
    // No order 8 sum exceeds its largest value by more than the number of its terms.
    let bounded = |v: DVec3| assert!(v.abs().max_element() <= 1e3 * largest + 1e-300, "{v} of {largest}");
    bounded(sh.irradiance(normal));
    bounded(sh.at(normal));
    bounded(IrradianceMatrix::new(&sh).at(normal));
    let [a, b, c, d] = input.turn.map(f64::from);
    if let Some(turn) =
        (a != 0.0 || b != 0.0 || c != 0.0 || d != 0.0).then(|| DQuat::from_xyzw(a, b, c, d).normalize())
        && let Ok(turned) = sh.rotated(turn)
    {
        for l in 0..=sh.order() {
            let (before, after) = (sh.band_power(l), turned.band_power(l));
            assert!((before - after).abs().max_element() <= 1e-9 * before.abs().max_element() + 1e-290);
        }
    }
});
