//! The tables of the study of point clouds, and which goals are reached.

use std::fmt::Write as _;

use crate::common::provenance::provenance;
use crate::common::report::{Limit, Row, verdict};
use crate::common::timing::Ratio;
use crate::surfel::lens_scenes::lens_name;
use crate::surfel::measured::Measured;
use crate::surfel::same::Same;

/// Rows of one table.
pub(crate) struct Section {
    pub(crate) title: &'static str,
    /// What the ratios of times are to.
    pub(crate) ratio: Option<&'static str>,
    pub(crate) rows: Vec<Measured>,
}

/// Columns of `surfel.csv` behind those of all studies.
pub(crate) const COLUMNS: [&str; 11] = [
    "points_drawn",
    "wall_seconds",
    "cpu_ratio",
    "psnr_db",
    "ssim",
    "holes_pct",
    "spill_pct",
    "normal_mean_deg",
    "normal_median_deg",
    "depth_rmse",
    "depth_bias",
];

pub(crate) fn csv_rows(sections: &[Section]) -> Vec<Row> {
    sections.iter().flat_map(|s| &s.rows).map(Measured::row).collect()
}

impl Measured {
    fn row(&self) -> Row {
        let e = &self.error;
        let values = [
            self.points as f64,
            self.wall.seconds,
            self.ratio.map_or(f64::NAN, |ratio| ratio.value),
            e.psnr,
            e.ssim,
            e.holes,
            e.spill,
            e.normal_mean,
            e.normal_median,
            e.depth_rmse / self.spacing,
            e.depth_bias / self.spacing,
        ];
        Row {
            scene: self.scene.clone(),
            series: self.series.to_owned(),
            setting: self.setting.clone(),
            time: self.cpu,
            // PSNR is −20 log₁₀ of it.
            rmse: 10f64.powf(-e.psnr / 20.0),
            largest: e.largest,
            more: values.iter().map(|v| format!("{v:.5}")).collect(),
        }
    }

    fn line(&self) -> String {
        let e = &self.error;
        let ratio =
            self.ratio.map_or("–".to_owned(), |ratio| format!("{:.3} ± {:.3}", ratio.value, ratio.spread));
        format!(
            "| {} | {} | {} | {} | {:.2} | {:.2} | {ratio} | {:.2} | {:.4} | {:.4} | {:.2} | {:.3} |\n",
            self.scene,
            self.series,
            self.setting,
            self.points,
            self.cpu.in_ms(),
            self.wall.in_ms(),
            e.psnr,
            e.ssim,
            e.holes,
            e.normal_mean,
            e.depth_rmse / self.spacing,
        )
    }
}

const HEAD: &str = "| scene | procedure | setting | points drawn | CPU ms | wall ms | ratio | PSNR dB | SSIM | holes % | normals, mean ° | depth RMSE |\n\
                    | --- | --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n";

/// What a goal is about.
#[derive(Clone, Copy)]
enum Figure {
    /// Processor time, in that of another row.
    Time,
    /// PSNR, dB.
    Psnr,
    /// PSNR of the row with this setting less that of the goal's, dB.
    PsnrLost(&'static str),
}

/// A figure that must be reached: of one row.
struct Goal {
    what: &'static str,
    figure: Figure,
    limit: Limit,
    scene: &'static str,
    series: &'static str,
    setting: &'static str,
}

const fn goal(what: &'static str, limit: Limit, row: [&'static str; 3]) -> Goal {
    let [scene, series, setting] = row;
    Goal { what, figure: Figure::Time, limit, scene, series, setting }
}

const fn of_picture(what: &'static str, figure: Figure, limit: Limit, row: [&'static str; 3]) -> Goal {
    Goal { figure, ..goal(what, limit, row) }
}

impl Goal {
    /// What was found, and how much of it may be chance; nothing if a row was not measured.
    fn found(&self, sections: &[Section]) -> Option<Ratio> {
        let row = |setting: &str| {
            let is_meant =
                |m: &&Measured| (&*m.scene, m.series, &*m.setting) == (self.scene, self.series, setting);
            sections.iter().flat_map(|s| &s.rows).find(is_meant)
        };
        let own = row(self.setting)?;
        let exactly = |value| Ratio { value, spread: 0.0 };
        match self.figure {
            Figure::Time => own.ratio,
            Figure::Psnr => Some(exactly(own.error.psnr)),
            Figure::PsnrLost(setting) => Some(exactly(row(setting)?.error.psnr - own.error.psnr)),
        }
    }
}

/// What must be reached. Times are ratios of processor time.
const GOALS: [Goal; 12] = [
    goal("object of 1/8 size / full size", Limit::AtMost(0.05), ["1/8 size", "blended", "level 1.27"]),
    of_picture(
        "object of 1/8 size",
        Figure::Psnr,
        Limit::AtLeast(35.0),
        ["1/8 size", "blended", "level 1.27"],
    ),
    goal("object of 1/8 size / full size", Limit::AtMost(0.1), ["1/8 size", "paper", "level 1.27"]),
    goal("1274573 points / 362272", Limit::AtMost(2.0), ["speed", "blended", "1274573 points at 1024²"]),
    goal("1274573 points / 362272", Limit::AtMost(2.0), ["speed", "paper", "1274573 points at 1024²"]),
    goal("lens of 6 px / sharp", Limit::AtMost(1.14), ["lens 6 px", "blended", "97000 points"]),
    goal("lens of 6 px / sharp", Limit::AtMost(1.14), ["lens 6 px", "paper", "97000 points"]),
    goal("lens of 16 px / sharp", Limit::AtMost(1.4), ["lens 16 px", "blended", "97000 points"]),
    goal("lens of 16 px / sharp", Limit::AtMost(1.4), ["lens 16 px", "paper", "97000 points"]),
    goal("lens of 32 px / sharp", Limit::AtMost(1.5), ["lens 32 px", "blended", "97000 points"]),
    goal("16 views from the lens / blended", Limit::AtLeast(10.0), ["lens 16 px", "lens views", "16 views"]),
    of_picture(
        "without normals, lost by it",
        Figure::PsnrLost("97000 points"),
        Limit::AtMost(1.0),
        ["front", "blended", "97000 points without normals"],
    ),
];

/// Why goals are missed, of those that are, and what was tried.
const LIMITS: &str = "\nWhat limits those that are missed, where they are:\n\n\
    * *Lens of 32 px*: kernels. A disc as wide as the blur covers 3.9·R² pixels and may be 3.5 + 0.4·R pixels from the next, so that 15 lie on a pixel at R = 32, and 10 at 16.\n\
    * *Object of 1/8 size*: it lies where four tiles meet, and each draws a ring of two pixels around what it shows, fills the pixels that nothing touches and writes all. Without filling and writing them a sphere took 6 % less.\n\
    * *1274573 points against 362272*: the larger cloud has more points to draw (*points drawn* under *Speed*), and the ratio of times is that of points. At a level of 1.4, for which there are rows too, it is smaller: 1.27, which small objects gain from, \
      draws more points of the larger cloud only.\n\
    * *The paper's procedure* has no levels between those of the tree, and filters every pixel with kernels as wide as its blur.\n\
    * *Without normals*: see *Normals* below. Of what is lost, as much as *estimated, sides known* has less than *of triangles, smooth ones for light* is the direction of estimated normals, the rest their sides: discs that are seen from both cannot be \
      refused for facing away, and those of the far side count at the outline. Rows of smooth normals that are off show what a direction costs.\n";

/// Pictures of a scene elsewhere may differ by rounding: so many dB from the unchanged one do not show.
const ROUNDING: Limit = Limit::AtLeast(60.0);

fn goals(sections: &[Section], same: &[Same]) -> String {
    let mut text = "| goal | procedure | wanted | found | |\n| --- | --- | ---: | ---: | --- |\n".to_owned();
    for goal in &GOALS {
        let Some(found) = goal.found(sections) else { continue };
        let Goal { what, figure, limit, series, .. } = goal;
        let Ratio { value, spread } = found;
        let word = limit.verdict(value, spread);
        let spread = if spread > 0.0 { format!(" ± {spread:.3}") } else { String::new() };
        let kind = if let Figure::Time = figure { "CPU time" } else { "PSNR, dB" };
        let _ = writeln!(text, "| {kind}, {what} | {series} | {limit} | {value:.3}{spread} | {word} |");
    }
    for change in ["moved", "scaled"] {
        let changed = same.iter().filter(|s| s.change.starts_with(change)).map(|s| s.error.psnr);
        let least = changed.fold(f64::INFINITY, |a, b| ROUNDING.worse(a, b));
        let word = verdict(ROUNDING.is_kept_by(least));
        let _ =
            writeln!(text, "| scene {change}, dB from unchanged | both | {ROUNDING} | {least:.1} | {word} |");
    }
    let bytes: Vec<&Same> = same.iter().filter(|s| !s.may_differ).collect();
    let (good, all) = (bytes.iter().filter(|s| s.same_bytes).count(), bytes.len());
    let word = verdict(good == all);
    let _ = writeln!(
        text,
        "| points shuffled, 1 thread, 2: same bytes | both | {all} of {all} | {good} | {word} |"
    );
    text
}

/// Frames a second of the paper's program on a Pentium III of 1.2 GHz, sharp and with depth of field.
const PAPERS_FPS: [f64; 2] = [0.98, 0.86];

fn paper_table(sections: &[Section]) -> String {
    let rows = || sections.iter().flat_map(|s| &s.rows);
    let find = |px: u32, series: &str| rows().find(|m| m.scene == lens_name(px) && m.series == series);
    let [sharp, deep] = PAPERS_FPS;
    let mut text = format!(
        "| 97000 points, 400×400 | sharp, frames/s | depth of field, frames/s | what depth of field costs |\n\
         | --- | ---: | ---: | ---: |\n\
         | the paper, Pentium III 1.2 GHz | {sharp} | {deep} | {:+.0} % |\n",
        100.0 * (sharp / deep - 1.0)
    );
    for (series, px) in ["paper", "blended"].into_iter().flat_map(|s| [(s, 6), (s, 16)]) {
        let (Some(sharp), Some(deep)) = (find(0, series), find(px, series)) else { continue };
        for (clock, sharp, deep) in [
            ("one thread, CPU time", sharp.cpu.seconds, deep.cpu.seconds),
            ("all cores", sharp.wall.seconds, deep.wall.seconds),
        ] {
            let (a, b, more) = (1.0 / sharp, 1.0 / deep, 100.0 * (deep / sharp - 1.0));
            let _ = writeln!(text, "| {series}, {px} px, {clock} | {a:.1} | {b:.1} | {more:+.0} % |");
        }
    }
    text
}

fn same_table(same: &[Same]) -> String {
    let mut text =
        "| scene | procedure | change | bytes | PSNR dB from unchanged | largest difference of 255 |\n\
                    | --- | --- | --- | --- | ---: | ---: |\n"
            .to_owned();
    for s in same {
        let bytes = match (s.same_bytes, s.may_differ) {
            (true, _) => "the same",
            (false, false) => "**differ**",
            (false, true) => "differ",
        };
        let (psnr, largest) = (s.error.psnr, 255.0 * s.error.largest);
        let _ = writeln!(
            text,
            "| {} | {} | {} | {bytes} | {psnr:.1} | {largest:.3} |",
            s.scene, s.series, s.change
        );
    }
    text
}

/// The whole report; `setup` says what was drawn, `others` are the titles and texts of sections without frames.
pub(crate) fn markdown(
    setup: &str,
    sections: &[Section],
    others: &[(&str, String)],
    same: &[Same],
) -> String {
    let mut text = format!(
        "# Point clouds: time against error\n\n`cargo run --release -p studies -- surfel` made this ({}). {setup}\n\n\
         *Blended* is `Procedure::Blended`, *paper* is `Procedure::Paper`. *CPU ms*: processor time of a frame on one thread, *wall \
         ms*: time of a frame on all cores. *Points drawn* counts links. *PSNR* and \
         *SSIM*: sRGB, over the surface's box and 8 pixels around. Depth, normals and holes are compared with rays through the pixels' centres, \
         through the middle of a lens, over pixels more than 2 inside the outline; depth is in spacings of the cloud. \
         *Holes*: such pixels without a surface. Clouds are blue noise unless the row says otherwise.\n\n## Goals\n\nA ratio of times is the median of fifteen pairs of frames, drawn in turns, and half of what the middle half of them differ by; one that is nearer to its bound than that is undecided.\n\n{}{LIMITS}\n\
         ## Beside the paper\n\n{}",
        provenance(),
        goals(sections, same),
        paper_table(sections),
    );
    for section in sections {
        let ratio = section.ratio.map_or(String::new(), |r| {
            format!("*Ratio*: CPU time, in that {r}; frames of both were drawn in turns.\n\n")
        });
        let _ = write!(text, "\n## {}\n\n{ratio}{HEAD}", section.title);
        section.rows.iter().for_each(|m| text += &m.line());
    }
    for (title, section) in others {
        let _ = write!(text, "\n## {title}\n\n{section}");
    }
    text + "\n## What must not change a picture\n\n97000 points.\n\n" + &same_table(same)
}
