//! `dice`: run time against error of seven ways to find the areas of a triangle in the cells of a grid.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use glam::{DVec2, IVec2, dvec2};
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive, Zero};
use plotters::prelude::*;
use pointillist_dice::invariants::cell_area_by_clipping;
use pointillist_dice::{Accumulator, CellWindow, Cut, Grid, accumulate, cut, split};

use crate::common::provenance::provenance;
use crate::common::report::Outcome;
use crate::common::timing::{Clock, HOW, Timing, timed_by};

type Cells = BTreeMap<(i32, i32), f64>;

/// One way to find areas; the name says which.
struct Method {
    name: &'static str,
    areas: FindAreas,
}

/// Tells every cell that a triangle may meet and the area found there.
type FindAreas = fn(&[DVec2; 3], &mut Accumulator, &mut dyn FnMut(IVec2, f64));

const METHODS: [Method; 7] = [
    Method { name: "accumulate", areas: by_accumulate },
    Method { name: "split", areas: by_split },
    Method { name: "cut", areas: by_cut },
    Method { name: "Sutherland–Hodgman", areas: by_clipping },
    Method { name: "4×4 points", areas: by_points::<4> },
    Method { name: "16×16 points", areas: by_points::<16> },
    Method { name: "64×64 points", areas: by_points::<64> },
];

fn by_accumulate(t: &[DVec2; 3], scratch: &mut Accumulator, visit: &mut dyn FnMut(IVec2, f64)) {
    let runs = accumulate(t, &Grid::UNIT, scratch, |run| {
        for x in run.columns {
            visit(IVec2::new(x, run.row), run.area);
        }
    });
    runs.expect("the triangles are small and finite");
}

fn by_split(t: &[DVec2; 3], _: &mut Accumulator, visit: &mut dyn FnMut(IVec2, f64)) {
    split(t, &Grid::UNIT, |p| visit(p.cell, p.area)).expect("the triangles are small and finite");
}

fn by_cut(t: &[DVec2; 3], _: &mut Accumulator, visit: &mut dyn FnMut(IVec2, f64)) {
    let (low, high) = bounds(t);
    let window = CellWindow { x0: low.x, y0: low.y, x1: high.x, y1: high.y };
    cut(t, window, |part| match part {
        Cut::Span { row, first, end } => (first..end).for_each(|x| visit(IVec2::new(x, row), 1.0)),
        Cut::Piece { cell, polygon } => visit(cell, polygon.area()),
    });
}

fn by_clipping(t: &[DVec2; 3], _: &mut Accumulator, visit: &mut dyn FnMut(IVec2, f64)) {
    for cell in cells_of(t) {
        visit(cell, cell_area_by_clipping(t, &Grid::UNIT, cell));
    }
}

fn by_points<const N: usize>(t: &[DVec2; 3], _: &mut Accumulator, visit: &mut dyn FnMut(IVec2, f64)) {
    let side = |p: DVec2, i: usize| (t[(i + 1) % 3] - t[i]).perp_dot(p - t[i]) >= 0.0;
    for cell in cells_of(t) {
        let mut hits = 0;
        for k in 0..N * N {
            let p = cell.as_dvec2() + (dvec2((k % N) as f64, (k / N) as f64) + 0.5) / N as f64;
            hits += usize::from(side(p, 0) && side(p, 1) && side(p, 2));
        }
        visit(cell, hits as f64 / (N * N) as f64);
    }
}

/// The first cell of a triangle's bounds, and the one past their last.
fn bounds(t: &[DVec2; 3]) -> (IVec2, IVec2) {
    (t[0].min(t[1]).min(t[2]).floor().as_ivec2(), t[0].max(t[1]).max(t[2]).ceil().as_ivec2())
}

fn cells_of(t: &[DVec2; 3]) -> impl Iterator<Item = IVec2> {
    let (low, high) = bounds(t);
    (low.y..high.y).flat_map(move |y| (low.x..high.x).map(move |x| IVec2::new(x, y)))
}

/// A row of the result.
struct Row {
    method: &'static str,
    size: f64,
    offset: f64,
    /// Of one triangle.
    nanoseconds: Timing,
    /// Largest error of a cell, in cells.
    error: f64,
}

/// Sizes of triangles, in cells.
const SIZES: [f64; 3] = [1.5, 12.0, 200.0];

/// Cells from the origin to the triangles.
const OFFSETS: [f64; 4] = [0.0, 1e3, 1e6, 1e7];

/// Measures and writes `dice.csv`, `dice.md` and `dice.svg`.
pub(crate) fn run(out_dir: &Path) -> Outcome {
    measure(out_dir, &SIZES, &OFFSETS)
}

/// The same of all but the largest triangles, whose exact areas take a minute without optimisation, in two places.
pub(crate) fn run_quick(out_dir: &Path) -> Outcome {
    measure(out_dir, &SIZES[..2], &[OFFSETS[0], OFFSETS[3]])
}

fn measure(out_dir: &Path, sizes: &[f64], offsets: &[f64]) -> Outcome {
    let mut rows = vec![];
    for &size in sizes {
        for &offset in offsets {
            let triangles = triangles(size, offset);
            // 200 cells square by rational arithmetic would take minutes: there, every 15th partly covered cell is compared.
            let stride = if size > 100.0 { 15 } else { 1 };
            for method in &METHODS {
                let error = triangles.iter().map(|t| worst_error(method, t, stride)).fold(0.0, f64::max);
                let nanoseconds = time(method, &triangles);
                rows.push(Row { method: method.name, size, offset, nanoseconds, error });
            }
        }
    }
    std::fs::create_dir_all(out_dir)?;
    std::fs::write(out_dir.join("dice.csv"), csv(&rows))?;
    std::fs::write(out_dir.join("dice.md"), markdown(&rows))?;
    chart(&rows, &out_dir.join("dice.svg")).map_err(std::io::Error::other)?;
    Ok(true)
}

/// Fixed, counter-clockwise triangles of about `size` cells.
fn triangles(size: f64, offset: f64) -> Vec<[DVec2; 3]> {
    let corner = |i: usize, turn: f64| DVec2::from_angle(turn + i as f64 * 2.1) * (0.5 * size);
    let centre = |k: usize| DVec2::splat(offset + 0.5 * size) + dvec2(0.317, 0.731) * k as f64;
    let count = if size > 100.0 { 2 } else { 8 };
    (0..count).map(|k| [0, 1, 2].map(|i| centre(k) + corner(i, 0.7 * k as f64))).collect()
}

fn worst_error(method: &Method, t: &[DVec2; 3], stride: usize) -> f64 {
    let mut found = Cells::new();
    (method.areas)(t, &mut Accumulator::new(), &mut |c, a| *found.entry((c.x, c.y)).or_insert(0.0) += a);
    let error = |cell: IVec2| {
        let area = found.get(&(cell.x, cell.y)).copied().unwrap_or(0.0);
        (exact(area) - exact_area(t, cell)).abs().to_f64().unwrap_or(f64::INFINITY)
    };
    let mut cells = vec![];
    by_accumulate(t, &mut Accumulator::new(), &mut |cell, area| {
        if area < 1.0 {
            cells.push(cell);
        }
    });
    let compared: Vec<_> =
        if stride == 1 { cells_of(t).collect() } else { cells.into_iter().step_by(stride).collect() };
    compared.into_iter().map(error).fold(0.0, f64::max)
}

/// About how long the triangles of one timing take together, in nanoseconds.
const LONG_ENOUGH: f64 = 2e7;

/// Time of a triangle.
fn time(method: &Method, triangles: &[[DVec2; 3]]) -> Timing {
    let mut scratch = Accumulator::new();
    let mut all = |rounds: usize| {
        let mut sum = 0.0;
        for t in (0..rounds).flat_map(|_| triangles) {
            (method.areas)(black_box(t), &mut scratch, &mut |_, area| sum += area);
        }
        black_box(sum);
    };
    // Processor time has steps of its own: as many rounds as make them small.
    let clock = Instant::now();
    let mut rounds = 1;
    loop {
        let before = clock.elapsed();
        all(rounds);
        let taken = (clock.elapsed() - before).as_nanos() as f64;
        if taken >= LONG_ENOUGH {
            break;
        }
        rounds = (rounds as f64 * (1.2 * LONG_ENOUGH / taken.max(1.0)).clamp(2.0, 100.0)).ceil() as usize;
    }
    let (timing, ()) = timed_by(Clock::Processor, || all(rounds));
    Timing { seconds: 1e9 * timing.seconds / (rounds * triangles.len()) as f64, ..timing }
}

type Exact = BigRational;

fn exact(v: f64) -> Exact {
    Exact::from_float(v).expect("finite")
}

/// Area of the triangle in a cell without any rounding.
fn exact_area(t: &[DVec2; 3], cell: IVec2) -> Exact {
    let mut ring: Vec<[Exact; 2]> = t.iter().map(|v| [exact(v.x), exact(v.y)]).collect();
    for (axis, at, keep) in [(0, cell.x, 1), (0, cell.x + 1, -1), (1, cell.y, 1), (1, cell.y + 1, -1)] {
        let side = |p: &[Exact; 2]| (&p[axis] - exact(at.into())) * exact(keep.into());
        let mut kept = vec![];
        for (i, q) in ring.iter().enumerate() {
            let p = &ring[(i + ring.len() - 1) % ring.len()];
            let (from, to) = (side(p), side(q));
            if from.is_negative() != to.is_negative() {
                let s = &from / (&from - &to);
                kept.push([&p[0] + (&q[0] - &p[0]) * &s, &p[1] + (&q[1] - &p[1]) * &s]);
            }
            if !to.is_negative() {
                kept.push(q.clone());
            }
        }
        ring = kept;
    }
    let twice = (0..ring.len()).fold(Exact::zero(), |sum, i| {
        let (a, b) = (&ring[i], &ring[(i + 1) % ring.len()]);
        sum + &a[0] * &b[1] - &a[1] * &b[0]
    });
    twice.abs() / exact(2.0)
}

fn csv(rows: &[Row]) -> String {
    let mut text = "method,size_cells,offset_cells,nanoseconds,worst_error_cells\n".to_owned();
    for r in rows {
        let _ =
            writeln!(text, "{},{},{},{:.0},{:e}", r.method, r.size, r.offset, r.nanoseconds.seconds, r.error);
    }
    text
}

fn markdown(rows: &[Row]) -> String {
    let mut text = format!(
        "# Areas of a triangle in the cells of a grid: time against error\n\n\
        `cargo run --release -p studies -- dice` made this, on one thread ({}). Processor time of one triangle. {HOW} Errors are the largest of any cell, in \
        cells, against exact rational arithmetic. Triangles are as far from the origin as the offset says, in cells.\n\n## All settings\n\n\
        | triangle | offset | method | µs | worst error |\n| ---: | ---: | --- | ---: | ---: |\n",
        provenance()
    );
    for r in rows {
        let _ = writeln!(
            text,
            "| {} cells | {:e} | {} | {:.2} | {:.1e} |",
            r.size,
            r.offset,
            r.method,
            Timing { seconds: r.nanoseconds.seconds / 1e3, ..r.nanoseconds },
            r.error
        );
    }
    text
}

/// Errors below this are drawn at it: a logarithmic axis has no zero.
const SMALLEST: f64 = 1e-17;

fn chart(rows: &[Row], path: &Path) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
    let root = SVGBackend::new(path, (760, 520)).into_drawing_area();
    root.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&root)
        .caption("12-cell triangles: time against worst error", ("sans-serif", 18))
        .margin(12)
        .x_label_area_size(40)
        .y_label_area_size(60)
        .build_cartesian_2d((1e2f64..1e7).log_scale(), (SMALLEST..1.0f64).log_scale())?;
    chart.configure_mesh().x_desc("nanoseconds").y_desc("worst error, cells").draw()?;
    for (i, method) in METHODS.iter().enumerate() {
        let points = rows.iter().filter(|r| r.method == method.name && r.size == 12.0);
        let points: Vec<_> = points.map(|r| (r.nanoseconds.seconds, r.error.max(SMALLEST))).collect();
        let style = Palette99::pick(i).filled();
        chart
            .draw_series(PointSeries::<_, _, Circle<_, _>, _>::new(points, 4, style))?
            .label(method.name)
            .legend(move |at| Circle::new(at, 4, style));
    }
    chart.configure_series_labels().border_style(BLACK).background_style(WHITE).draw()?;
    root.present()?;
    Ok(())
}
