//! Meshes and amounts of any kind: points where they should be, or a refusal.
#![no_main]

use arbitrary::Arbitrary;
use glam::{DVec3, dvec3};
use libfuzzer_sys::fuzz_target;
use pointillist_surfel::{Amount, Method, SampleOptions, invariants};

/// Corners in steps of 1/64, often shared, or any numbers.
#[derive(Arbitrary, Debug)]
enum Corner {
    Steps([i8; 3]),
    Raw([f64; 3]),
}

#[derive(Arbitrary, Debug)]
enum Wanted {
    Count(u16),
    Spacing(u8),
    Raw(f64),
}

fn position(corner: &Corner) -> DVec3 {
    match corner {
        Corner::Steps([x, y, z]) => dvec3((*x).into(), (*y).into(), (*z).into()) / 64.0,
        Corner::Raw(p) => DVec3::from_array(*p),
    }
}

fuzz_target!(|input: (Vec<Corner>, Vec<[u8; 3]>, Wanted, bool, u64)| {
    let (corners, triangles, wanted, is_ldi, seed) = input;
    let positions: Vec<DVec3> = corners.iter().take(64).map(position).collect();
    // Nearly always a number that there is.
    let number = |i: u8| if i == u8::MAX { 255 } else { u32::from(i) % positions.len().max(1) as u32 };
    let triangles: Vec<[u32; 3]> = triangles.iter().take(64).map(|t| t.map(number)).collect();
    let options = SampleOptions::DEFAULT.with_seed(seed).with_method(if is_ldi {
        Method::Ldi
    } else {
        Method::Poisson
    });
    let options = match wanted {
        Wanted::Count(count) => options.with_count((count % 3000).into()),
        Wanted::Spacing(spacing) => options.with_spacing(f64::from(spacing) / 64.0),
        Wanted::Raw(spacing) => options.with_spacing(spacing),
    };
    // Spacings of very many points take long, as they should.
    if let Amount::Spacing(spacing) = options.amount
        && area(&positions, &triangles) > 1e4 * spacing * spacing
    {
        return;
    }
    if let Err(broken) = invariants::anything_is_sampled_or_refused(&positions, &triangles, &options) {
        panic!("{broken}");
    }
});

/// Sum of the triangles' areas.
fn area(positions: &[DVec3], triangles: &[[u32; 3]]) -> f64 {
    let of = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| positions.get(v as usize).copied().unwrap_or_default());
        0.5 * (b - a).cross(c - a).length()
    };
    triangles.iter().map(of).sum()
}
