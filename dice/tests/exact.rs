//! Against exact rational arithmetic, in units in the last place. `--nocapture` prints what was found.

use std::collections::BTreeMap;

use glam::{DVec2, dvec2};
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive, Zero};
use pointillist_dice::{Accumulator, FillRule, Grid, accumulate, accumulate_filled, split};

type Exact = BigRational;
type Ring = Vec<(Exact, Exact)>;

fn exact(v: f64) -> Exact {
    Exact::from_float(v).expect("vertices are finite")
}

/// The part of the ring on one side of a line x = `at` (or y): `keep` is +1 for beyond, −1 for before.
fn clip(ring: &Ring, at: &Exact, keep: i32, by_y: bool) -> Ring {
    let side = |p: &(Exact, Exact)| {
        let d = (if by_y { &p.1 } else { &p.0 }) - at;
        if keep > 0 { d } else { -d }
    };
    let mut out = vec![];
    for (i, q) in ring.iter().enumerate() {
        let p = &ring[(i + ring.len() - 1) % ring.len()];
        let (from, to) = (side(p), side(q));
        if from.is_negative() != to.is_negative() {
            let t = &from / (&from - &to);
            out.push((&p.0 + (&q.0 - &p.0) * &t, &p.1 + (&q.1 - &p.1) * &t));
        }
        if !to.is_negative() {
            out.push(q.clone());
        }
    }
    out
}

fn area(ring: &Ring) -> Exact {
    let twice = (0..ring.len()).fold(Exact::zero(), |sum, i| {
        let (a, b) = (&ring[i], &ring[(i + 1) % ring.len()]);
        sum + &a.0 * &b.1 - &a.1 * &b.0
    });
    (twice / exact(2.0)).abs()
}

/// Exact areas by cell of the unit grid.
fn exact_cells(polygon: &[DVec2]) -> BTreeMap<(i32, i32), Exact> {
    let ring: Ring = polygon.iter().map(|v| (exact(v.x), exact(v.y))).collect();
    let low = polygon.iter().copied().reduce(DVec2::min).unwrap().floor().as_ivec2();
    let high = polygon.iter().copied().reduce(DVec2::max).unwrap().ceil().as_ivec2();
    let mut cells = BTreeMap::new();
    for y in low.y..high.y {
        let row = clip(&clip(&ring, &exact(y.into()), 1, true), &exact((y + 1).into()), -1, true);
        for x in low.x..high.x {
            let part = clip(&clip(&row, &exact(x.into()), 1, false), &exact((x + 1).into()), -1, false);
            let area = area(&part);
            if area.is_positive() {
                cells.insert((x, y), area);
            }
        }
    }
    cells
}

/// Distance in units in the last place of the exact value.
fn ulps(found: f64, wanted: &Exact) -> f64 {
    let near = wanted.to_f64().unwrap();
    let unit = near.next_up() - near;
    ((exact(found) - wanted).abs() / exact(unit)).to_f64().unwrap()
}

/// Worst error of both products: (split, accumulate) in ulps. Cells must be the same ones.
fn worst(polygon: &[DVec2]) -> (f64, f64) {
    let wanted = exact_cells(polygon);
    let (mut by_split, mut by_accumulate) = (BTreeMap::new(), BTreeMap::new());
    split(polygon, &Grid::UNIT, |p| *by_split.entry((p.cell.x, p.cell.y)).or_insert(0.0) += p.area).unwrap();
    accumulate(polygon, &Grid::UNIT, &mut Accumulator::new(), |run| {
        for x in run.columns {
            by_accumulate.insert((x, run.row), run.area);
        }
    })
    .unwrap();
    let worst_of = |found: &BTreeMap<(i32, i32), f64>| {
        assert!(found.keys().eq(wanted.keys()), "cells missed or invented: {polygon:?}");
        found.iter().map(|(cell, area)| ulps(*area, &wanted[cell])).fold(0.0, f64::max)
    };
    (worst_of(&by_split), worst_of(&by_accumulate))
}

/// A seeded sequence in 0..1 with 53 random bits.
fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

fn triangles(size: f64, offset: f64, seed: u64) -> impl Iterator<Item = [DVec2; 3]> {
    let mut state = seed;
    (0..60).map(move |_| {
        let base = dvec2(offset, -offset) + dvec2(random(&mut state), random(&mut state));
        [(); 3].map(|()| base + size * dvec2(random(&mut state), random(&mut state)))
    })
}

#[test]
fn areas_are_within_a_few_ulps_at_any_size_and_offset() {
    for size in [1.5, 12.0] {
        for offset in [0.0, 1e3, 1e6, 1e7] {
            let (mut s, mut a) = (0.0_f64, 0.0_f64);
            for t in triangles(size, offset, 7) {
                let (ts, ta) = worst(&t);
                (s, a) = (s.max(ts), a.max(ta));
            }
            println!("triangles of {size} at {offset:e}: split {s:.2} ulp, accumulate {a:.2} ulp");
            // Sums are exact and rounded once: half a unit. Pieces may cancel to 2⁻⁸ before `split` turns to fixed point.
            assert!(a <= 0.51, "accumulate: {a} ulp");
            assert!(s <= 1024.0, "split: {s} ulp");
        }
    }
}

#[test]
fn slivers_keep_their_digits() {
    for width in [1e-3, 1e-8, 1e-12, 1e-15] {
        let (mut s, mut a) = (0.0_f64, 0.0_f64);
        let mut state = 3;
        for _ in 0..40 {
            let p = dvec2(random(&mut state), random(&mut state)) * 2.0;
            let q = p + dvec2(3.0 * random(&mut state) - 1.5, 6.0 * random(&mut state) + 1.0);
            let across = dvec2(width, 0.0);
            let wanted = exact_cells(&[p, p + across, q + across, q]);
            split(&[p, p + across, q + across, q], &Grid::UNIT, |piece| {
                assert!(wanted.contains_key(&(piece.cell.x, piece.cell.y)), "invented {piece:?}");
            })
            .unwrap();
            let (ts, ta) = worst(&[p, p + across, q + across, q]);
            (s, a) = (s.max(ts), a.max(ta));
        }
        println!("slivers of {width:e}: split {s:.2e} ulp, accumulate {a:.2e} ulp");
        assert!(s.max(a) * f64::EPSILON < 1e-3 * (1e-12 / width).max(1e-3), "{s} and {a} ulp");
    }
}

#[test]
fn holes_are_as_exact_as_outlines() {
    for offset in [0.0, 1e3, 1e6, 1e7] {
        let mut worst = 0.0_f64;
        for outer in triangles(6.0, offset, 11) {
            // Around the middle, so that no coordinate is a short number.
            let middle = (outer[0] + outer[1] + outer[2]) / 3.0;
            let hole = outer.map(|v| middle + (v - middle) * 0.7);
            let mut wanted = exact_cells(&outer);
            for (cell, area) in exact_cells(&hole) {
                *wanted.get_mut(&cell).expect("the hole lies inside") -= area;
            }
            wanted.retain(|_, area| area.is_positive());
            let mut found = BTreeMap::new();
            accumulate_filled(
                &[&outer, &hole],
                FillRule::EvenOdd,
                &Grid::UNIT,
                &mut Accumulator::new(),
                |run| {
                    found.extend(run.columns.map(|x| ((x, run.row), run.area)));
                },
            )
            .unwrap();
            assert!(found.keys().eq(wanted.keys()), "cells missed or invented: {outer:?}");
            worst = found.iter().map(|(cell, area)| ulps(*area, &wanted[cell])).fold(worst, f64::max);
        }
        println!("triangles with holes at {offset:e}: {worst:.2} ulp");
        assert!(worst <= 0.51, "{worst} ulp at {offset:e}");
    }
}
