//! Charts: time against error, or whatever grows with something.

use std::path::Path;

use super::report::{Row, SMALLEST, distinct, scenes};
use plotters::coord::Shift;
use plotters::prelude::*;

type Fault = Box<dyn std::error::Error + Send + Sync>;

/// Settings that are the crates' defaults, by chart, series and beginning of the setting.
const DEFAULTS: [(&str, &str, &str); 7] = [
    ("micropoint", "correlated", "1×1 cells"),
    ("shadow", "correlated", "auto"),
    ("surfel", "blended", "level 1.27"),
    ("surfel", "blended", "radii × 1 "),
    ("ibpr", "default", "default"),
    ("ibpr-depth", "default", "default"),
    ("shprobe", "Gregory", "128 px"),
];

/// Whether a row of a chart is drawn as a default.
fn is_default(chart: &str, row: &Row) -> bool {
    // So that `radii × 1.5` does not begin with `radii × 1 `.
    let setting = format!("{} ", row.setting);
    DEFAULTS
        .iter()
        .any(|(name, series, begin)| *name == chart && *series == row.series && setting.starts_with(begin))
}

/// As [`SMALLEST`], for what is not finite.
const LARGEST: f64 = 1e3;

/// Draws `NAME.svg`: for each scene time against error, both logarithmic.
pub(crate) fn chart(out_dir: &Path, name: &str, rows: &[Row]) -> Result<(), Fault> {
    chart_of(out_dir, name, "RMSE", rows)
}

/// The same for errors of another kind, or in another unit: `error` says which.
pub(crate) fn chart_of(out_dir: &Path, name: &str, error: &str, rows: &[Row]) -> Result<(), Fault> {
    chart_along(out_dir, name, ["seconds", error], rows)
}

/// The same along another axis than time: `along` says what each row's `time` is, and what its errors.
pub(crate) fn chart_along(out_dir: &Path, name: &str, along: [&str; 2], rows: &[Row]) -> Result<(), Fault> {
    let scenes = scenes(rows);
    let series = distinct(rows.iter().map(|r| r.series.as_str()));
    const COLUMNS: usize = 3;
    let lines = scenes.len().div_ceil(COLUMNS);
    let path = out_dir.join(format!("{name}.svg"));
    let size = (COLUMNS as u32 * 400, lines as u32 * 330 + 30 * series.len().div_ceil(4) as u32 + 10);
    let root = SVGBackend::new(&path, size).into_drawing_area();
    root.fill(&WHITE)?;
    let (legend, panels) = root.split_vertically(30 * series.len().div_ceil(4) as u32 + 10);
    for (i, s) in series.iter().enumerate() {
        let at = (20 + (i % 4) as i32 * 290, 20 + (i / 4) as i32 * 30);
        legend.draw(&Circle::new(at, 5, Palette99::pick(i).filled()))?;
        legend.draw(&Text::new((*s).to_owned(), (at.0 + 12, at.1 - 7), ("sans-serif", 15)))?;
    }
    if rows.iter().any(|row| is_default(name, row)) {
        legend.draw(&Circle::new((size.0 as i32 - 110, 20), RING, BLACK))?;
        legend.draw(&Text::new("default", (size.0 as i32 - 98, 13), ("sans-serif", 15)))?;
    }
    for (area, scene) in panels.split_evenly((lines, COLUMNS)).iter().zip(scenes) {
        let of_scene: Vec<&Row> = rows.iter().filter(|r| r.scene == scene).collect();
        panel(area, name, (scene, along), &series, &of_scene)?;
    }
    root.present()?;
    Ok(())
}

/// Radius of the ring around a default, in pixels.
const RING: i32 = 7;

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

fn panel(
    area: &Area<'_>,
    name: &str,
    (scene, [time, error]): (&str, [&str; 2]),
    series: &[&str],
    rows: &[&Row],
) -> Result<(), Fault> {
    let point = |r: &&Row| (r.time.seconds.max(1e-6), r.rmse.clamp(SMALLEST, LARGEST));
    let range = |values: Vec<f64>| {
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = values.iter().copied().fold(0.0, f64::max);
        10f64.powf(low.log10().floor())..10f64.powf(high.log10().floor() + 1.0)
    };
    let x = range(rows.iter().map(|r| point(r).0).collect());
    let y = range(rows.iter().map(|r| point(r).1).collect());
    let mut chart = ChartBuilder::on(area)
        .caption(scene, ("sans-serif", 16))
        .margin(10)
        .x_label_area_size(36)
        .y_label_area_size(56)
        .build_cartesian_2d(x.log_scale(), y.log_scale())?;
    let power = |v: &f64| format!("{v:.0e}");
    chart
        .configure_mesh()
        .x_desc(time)
        .y_desc(error)
        .x_label_formatter(&power)
        .y_label_formatter(&power)
        .max_light_lines(0)
        .draw()?;
    for (i, name) in series.iter().enumerate() {
        let points: Vec<_> = rows.iter().filter(|r| r.series == *name).map(point).collect();
        let color = Palette99::pick(i);
        chart.draw_series(LineSeries::new(points.iter().copied(), color.stroke_width(1)))?;
        chart.draw_series(PointSeries::<_, _, Circle<_, _>, _>::new(points, 3, color.filled()))?;
    }
    let defaults = rows.iter().filter(|row| is_default(name, row)).map(point);
    chart.draw_series(PointSeries::<_, _, Circle<_, _>, _>::new(defaults, RING, BLACK))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The tables that are in the repository have rows for all rings.
    #[test]
    fn defaults_that_charts_mark_are_measured() {
        for (chart, series, begin) in DEFAULTS {
            let file =
                format!("{}/results/{}.csv", env!("CARGO_MANIFEST_DIR"), chart.trim_end_matches("-depth"));
            let text = std::fs::read_to_string(&file).expect("a table of results");
            let found = text.lines().any(|line| {
                let cells: Vec<&str> = line.split(',').collect();
                cells[1] == series && format!("{} ", cells[2]).starts_with(begin)
            });
            assert!(found, "{file} has no {series}, {begin}");
        }
    }
}
