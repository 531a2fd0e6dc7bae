//! `probe tetra`.

use crate::commands::Report;
use crate::commands::report::write_text;
use crate::error::CliError;
use crate::input::name_of;
use crate::input_error::InputError;
use crate::job::ThreadClock;
use crate::options::TetraOptions;
use crate::probe_io::{format_cells, read_points};
use glam::{DVec3, dvec3};
use pointillist_delaunay::{Delaunay, DelaunayError, Hint, Locator, Partition, Tetrahedra};

use std::f64::consts::TAU;

pub(super) fn run(options: &TetraOptions) -> Result<(), CliError> {
    let report = Report::new(&options.common)?
        .reading(std::iter::once(&options.points).chain(&options.locate))?
        .writing(options.result())?;
    let points = report.stats.stage("load", || read_points(&options.points))?;
    let name = name_of(&options.points);
    let refused = |error: DelaunayError| {
        let error = InputError::of_file(&name, error.to_string());
        CliError::Input(error.with_help("points are finite numbers, `x y z` a line"))
    };
    let start = std::time::Instant::now();
    let partition = report.stats.stage("build", || partition(&points)).map_err(refused)?;
    report.stats.figure("build_s", start.elapsed().as_secs_f64());
    report.stats.count("points", points.len() as u64);
    report.stats.figure("cells", partition.cell_count() as f64);
    if let Some(path) = &options.locate {
        let queries = report.stats.stage("load", || read_points(path))?;
        measure(&points, &partition, &queries, &report);
    }
    let binary = options.output.path.extension().is_some_and(|e| e.eq_ignore_ascii_case("bin"));
    if let Some(path) = options.result() {
        write_text(path, |output| format_cells(output, &partition, binary))?;
    }
    report.finish()
}

/// The cells between points; none if there are no points, which is no fault of the caller's.
fn partition(points: &[DVec3]) -> Result<Partition, DelaunayError> {
    if points.is_empty() {
        return Ok(Partition::Tetrahedra(Tetrahedra { corners: vec![], neighbours: vec![] }));
    }
    Delaunay::new(points).map(|d| d.partition())
}

/// Millions of queries a second of processor time of one thread: one by one, and along a path from cell to cell.
fn measure(points: &[DVec3], partition: &Partition, queries: &[DVec3], report: &Report<'_>) {
    if points.is_empty() {
        ["locate_random_mqps", "locate_coherent_mqps"].iter().for_each(|name| report.stats.figure(name, 0.0));
        return;
    }
    let locator = report.stats.stage("index", || Locator::new(points, partition));
    let locator = locator.expect("the partition is of these points");
    let rate = |run: &dyn Fn() -> f64| {
        let clock = ThreadClock::start();
        // The sum is used, so that the work cannot be left out.
        let sum = run();
        let seconds = clock.seconds();
        report.detail(&format!("mean of the first weights: {}", sum / queries.len().max(1) as f64));
        queries.len() as f64 / seconds / 1e6
    };
    let random =
        || queries.iter().filter_map(|&q| locator.locate_anywhere(q).ok()).map(|b| b.weights[0]).sum();
    report.stats.figure("locate_random_mqps", rate(&random));
    let (low, high) = points.iter().fold((points[0], points[0]), |(l, h), p| (l.min(*p), h.max(*p)));
    let along = |i: usize| {
        let f = i as f64 / queries.len() as f64;
        let unit =
            dvec3((TAU * 3.0 * f).sin(), (TAU * 5.0 * f).cos(), (TAU * 7.0 * f + 1.0).sin()) * 0.45 + 0.5;
        low + (high - low) * unit
    };
    let coherent = || {
        let mut hint = Hint::default();
        (0..queries.len())
            .filter_map(|i| locator.locate(along(i), &mut hint).ok())
            .map(|b| b.weights[0])
            .sum()
    };
    report.stats.figure("locate_coherent_mqps", rate(&coherent));
}
