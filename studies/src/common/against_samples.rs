//! Tables of one scene drawn by points and by ever more samples a pixel: processor time, RMSE and bias.

use std::fmt::Write as _;

use pointillist_render::{RenderError, Scene};

use crate::common::draw;
use crate::common::picture::Picture;
use crate::common::provenance::provenance;
use crate::common::report::{Row, on_one_thread, scenes, time_ratio};
use crate::common::timing::{Clock, HOW, Timing, timed_by};

/// Further columns of the tables.
pub(crate) const MORE: [&str; 1] = ["bias %"];

/// Cells along a side of a pixel.
pub(crate) const CELLS: [u32; 3] = [1, 2, 4];

/// Samples along a side of a pixel: 1 to 256 in all.
const SIDES: [u32; 5] = [1, 2, 4, 8, 16];

/// The series of [`Subject::samples`].
pub(crate) const SAMPLES: &str = "samples";

/// A scene, and the picture that all methods are compared with.
pub(crate) struct Subject {
    pub(crate) name: String,
    pub(crate) expected: Picture,
    /// RMSE of `expected` itself, estimated.
    pub(crate) floor: f64,
}

impl Subject {
    /// Expects the mean of two independent pictures, which is off by half of what they differ.
    pub(crate) fn between(name: impl Into<String>, [a, b]: [Picture; 2]) -> Self {
        Self { name: name.into(), expected: a.mean(&b), floor: 0.5 * a.rmse(&b) }
    }

    /// Measures one picture on one thread.
    pub(crate) fn row(&self, series: &str, setting: String, draw: impl FnMut() -> Picture + Send) -> Row {
        let (time, picture) = on_one_thread(|| timed_by(Clock::Processor, draw));
        self.row_of(series, setting, time, &picture)
    }

    /// A picture that took this time.
    pub(crate) fn row_of(&self, series: &str, setting: String, time: Timing, picture: &Picture) -> Row {
        Row {
            scene: self.name.clone(),
            series: series.to_owned(),
            setting,
            time,
            rmse: picture.rmse(&self.expected),
            largest: picture.largest_error(&self.expected),
            more: vec![format!("{:+.3}", 100.0 * picture.bias(&self.expected))],
        }
    }

    /// The scene by these numbers of cells along a side of a pixel.
    pub(crate) fn cells(&self, series: &str, cells: &[u32], scene: &Scene) -> Vec<Row> {
        let draw = |cells| draw_cells(scene, cells).expect("the scene is valid");
        cells.iter().map(|&n| self.row(series, format!("{n}×{n} cells"), || draw(n))).collect()
    }

    /// The scene by 1 to 256 samples a pixel, as `draw` takes them: its argument is the number along a side.
    pub(crate) fn samples(&self, draw: impl Fn(u32) -> Picture + Sync) -> Vec<Row> {
        SIDES.map(|n| self.row(SAMPLES, format!("{n}×{n} samples"), || draw(n))).into()
    }
}

/// The scene by `cells` × `cells` cells a pixel.
pub(crate) fn draw_cells(scene: &Scene, cells: u32) -> Result<Picture, RenderError> {
    let mut scene = scene.clone();
    scene.render.cells_per_pixel = Some(cells);
    draw::with_pipeline(&scene)
}

/// What the times are, as all these tables have it.
pub(crate) fn conditions(command: &str) -> String {
    format!(
        "`cargo run --release -p studies -- {command}` made this, on one thread ({}). Processor seconds, with everything that depends on \
         the geometry. {HOW} Errors are of linear radiance; the bias is the \
         light of the whole picture against that of the expected one, in per cent. Samples go one into each stratum of the pixel, with shadow \
         rays, through a tree of boxes in double precision: their errors are those of any ray tracer, their times are not those of the \
         fastest.",
        provenance()
    )
}

/// Every row of ours beside 256 samples, and the time that samples need for the same error.
pub(crate) fn summary(subjects: &[Subject], rows: &[Row]) -> String {
    let mut text = "| scene | reference's own error | method | RMSE | bias % | seconds | 256 samples: RMSE | seconds | same error by samples |\n\
                    | --- | ---: | --- | ---: | ---: | ---: | ---: | ---: | ---: |\n"
        .to_owned();
    for scene in scenes(rows) {
        let of_scene: Vec<&Row> = rows.iter().filter(|r| r.scene == scene).collect();
        let samples: Vec<&Row> = of_scene.iter().copied().filter(|r| r.series == SAMPLES).collect();
        let most = samples[samples.len() - 1];
        let floor = subjects.iter().find(|s| s.name == scene).map_or(f64::NAN, |s| s.floor);
        for ours in of_scene.iter().filter(|r| r.series != SAMPLES) {
            let ratio = same_error(ours, &samples);
            let _ = writeln!(
                text,
                "| {scene} | {floor:.1e} | {}, {} | {:.2e} | {} | {} | {:.2e} | {} | {ratio} |",
                ours.series, ours.setting, ours.rmse, ours.more[0], ours.time, most.rmse, most.time
            );
        }
    }
    text
}

/// The time that samples, from the fewest to the most, need for the same error, in words.
pub(crate) fn same_error(ours: &Row, samples: &[&Row]) -> String {
    if let Some(ratio) = time_ratio(ours, samples) {
        return format!("{ratio:.2}× the time");
    }
    if ours.rmse > samples[0].rmse {
        return "one sample has less".to_owned();
    }
    let most = samples[samples.len() - 1];
    format!("not in {:.1}× the time", most.time.seconds / ours.time.seconds)
}
