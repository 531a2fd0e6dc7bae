//! The tables of the study of range scans, and which goals are reached.

use std::fmt::Write as _;

use pointillist_ibpr::FrameCounts;

use crate::common::frame_error::FrameError;
use crate::common::provenance::provenance;
use crate::common::report::{Limit, Row, distinct, verdict};
use crate::common::timing::{HOW, Timing};

/// Begins the names of scans of the surface in relief.
pub(crate) const RELIEF: &str = "relief, ";

/// A frame of one setting on one set of scans.
pub(crate) struct Measured {
    pub(crate) faults: String,
    pub(crate) group: &'static str,
    pub(crate) setting: String,
    pub(crate) counts: FrameCounts,
    /// Processor time.
    pub(crate) time: Timing,
    pub(crate) error: FrameError,
}

/// Columns of `ibpr.csv` behind those of all studies.
pub(crate) const COLUMNS: [&str; 11] = [
    "scale",
    "skipped_pct",
    "normal_mean_deg",
    "normal_median_deg",
    "depth_rmse_with_steps",
    "depth_bias",
    "depth_p95",
    "holes_pct",
    "psnr_db",
    "spill_pct",
    "outline_px",
];

impl Measured {
    /// Percent of the points that no frame has to look at.
    fn skipped(&self) -> f64 {
        let FrameCounts { points, points_skipped, .. } = self.counts;
        100.0 * points_skipped as f64 / (points + points_skipped) as f64
    }

    pub(crate) fn row(&self, rmse: fn(&FrameError) -> f64) -> Row {
        let e = &self.error;
        let values = [
            self.counts.scale,
            self.skipped(),
            e.normal_mean,
            e.normal_median,
            e.depth_rmse_all,
            e.bias,
            e.depth_p95,
            e.holes,
            e.psnr,
            e.spill,
            e.outline,
        ];
        Row {
            scene: self.faults.clone(),
            series: self.group.to_owned(),
            setting: self.setting.replace(',', ""),
            time: self.time,
            rmse: rmse(e),
            largest: e.depth_p95,
            more: values.iter().map(|v| format!("{v:.4}")).collect(),
        }
    }
}

/// A figure that must be reached.
struct Goal {
    faults: &'static str,
    what: &'static str,
    unit: &'static str,
    limit: Limit,
    value: fn(&FrameError) -> f64,
}

const fn goal(
    faults: &'static str,
    what: &'static str,
    limit: Limit,
    unit: &'static str,
    value: fn(&FrameError) -> f64,
) -> Goal {
    Goal { faults, what, unit, limit, value }
}

/// Why goals are missed, of those that are, and what was tried.
const LIMITS: &str = "\nWhat limits those that are missed, where they are:\n\n\
    * *Depth RMSE with steps*: where the outline of what is in front is drawn, not the depth of it. Without the 0.3 buffer pixels by which outlines reach beyond the outermost points (*outline 0* below) it is 0.04 spacings without noise and 0.75 at σ = 0.25, but the outline is then \
      2.4 px off and PSNR 27 dB. A pixel whose centre lies between the drawn outline and the true one shows the other surface, a step of tens of spacings away: if 1 pixel in 5000 were off by 40, that alone would be an RMSE of 0.57. Outlines would \
      have to be right to a few hundredths of a pixel. Smaller buffer pixels (factor 1: 0.56), two passes (0.60), narrower outlines (0.2: 0.61) and other weights (0.55 to 0.62) do not change it.\n\
    * *Outline at σ = 0.25*: noise of the outermost points; 0.68 to 0.74 px on four seeds. It grows with σ whatever the setting: 0.43, 0.53, 0.68, 1.52, 3.53 px for σ = 0, 0.1, 0.25, 0.5, 1. Factor 1 has 0.65, two passes 0.60 to 0.69, and outlines that reach 0.25 instead of \
      0.3 buffer pixels 0.62 with 0.7 dB more; but flat sheets then end three tenths of a buffer pixel too early, where a fifth is promised (`tests/closed_forms.rs`).\n\
    * *Normals in relief without noise*: most of the mean is what the surface has without relief (0.70°); the median is 0.49°. Windows are the smallest already.\n\
    * *A radius for each pixel* (the windows of fits have one for the whole frame, by its noise): slopes of windows of the frame's radius and of the next smaller were mixed, by how far they differ beyond what noise does \
      (James and Stein's estimator, with one to four times the variance that the frame's noise gives the difference). On the surface in relief that is 1.9 to 2.2° instead of 1.8° at σ = 0.1, 2.4 to 2.5° instead of 2.4° at 0.25, 3.3 to 3.4° \
      instead of 3.3° at 0.5 and 5.3 to 5.8° instead of 5.1° at 1: where a pixel's own points have more noise than the frame's, it is taken for detail.\n\
    * *Specks along outlines of real scans* (the bunny's ten by `scan`; no goal): single pixels of the buffer whose planes lean on few or wrong neighbours. To compare those with fewer than four neighbours of their own surface with all around them was tried: \
      some specks go, and holes get lighter rims; three rounds of it spread these.\n";

/// What must be reached.
const GOALS: [Goal; 13] = [
    goal("σ = 0", "PSNR", Limit::AtLeast(33.0), "dB", |e| e.psnr),
    goal("σ = 0", "interior holes", Limit::AtMost(0.05), "%", |e| e.holes),
    goal("σ = 0", "normals, mean", Limit::AtMost(0.7), "°", |e| e.normal_mean),
    goal("σ = 0.25", "normals, mean", Limit::AtMost(2.5), "°", |e| e.normal_mean),
    goal("σ = 0", "outline", Limit::AtMost(0.7), "px", |e| e.outline),
    goal("σ = 0.25", "outline", Limit::AtMost(0.7), "px", |e| e.outline),
    goal("σ = 0.25", "depth RMSE", Limit::AtMost(0.3), "spacings", |e| e.depth_rmse),
    goal("σ = 0", "depth RMSE with steps", Limit::AtMost(0.4), "spacings", |e| e.depth_rmse_all),
    goal("σ = 0.25", "depth RMSE with steps", Limit::AtMost(0.4), "spacings", |e| e.depth_rmse_all),
    goal("σ = 0.25", "depth bias, either sign", Limit::AtMost(0.05), "spacings", |e| e.bias.abs()),
    goal("σ = 0.5", "normals, mean", Limit::AtMost(5.5), "°", |e| e.normal_mean),
    goal("relief, σ = 0", "normals, mean", Limit::AtMost(0.8), "°", |e| e.normal_mean),
    goal("relief, σ = 0.25", "normals, mean", Limit::AtMost(2.5), "°", |e| e.normal_mean),
];

impl Goal {
    fn reached(&self, m: &Measured) -> bool {
        m.faults == self.faults && self.limit.is_kept_by((self.value)(&m.error))
    }
}

fn goals(results: &[Measured]) -> String {
    let mut text = "| scans | goal | wanted | default | worst of four seeds | | fastest setting below that reaches it |\n\
                    | --- | --- | ---: | ---: | ---: | --- | --- |\n"
        .to_owned();
    for goal in &GOALS {
        let value = |m: &Measured| (goal.value)(&m.error);
        let defaults = results.iter().filter(|m| m.faults == goal.faults && m.group == "default");
        let Some(first) = defaults.clone().next() else { continue };
        let worst = defaults.clone().map(value).fold(value(first), |a, b| goal.limit.worse(a, b));
        let fastest = results
            .iter()
            .filter(|m| goal.reached(m))
            .min_by(|a, b| a.time.seconds.total_cmp(&b.time.seconds))
            .map_or("none".to_owned(), |m| {
                format!("{}: {:.3}, {:.1} ms", m.setting, value(m), 1e3 * m.time.seconds)
            });
        let word = verdict(defaults.clone().all(|m| goal.reached(m)));
        let (limit, unit, got) = (goal.limit, goal.unit, value(first));
        let _ = writeln!(
            text,
            "| {} | {} | {limit} {unit} | {got:.3} | {worst:.3} | {word} | {fastest} |",
            goal.faults, goal.what
        );
    }
    text
}

const HEAD: &str = "| scans | setting | S | skipped % | CPU ms | normals, mean ° | median ° | depth RMSE | with steps | bias | 95 % | holes % | PSNR dB | spill % | outline px |\n\
                    | --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n";

fn line(m: &Measured) -> String {
    let e = &m.error;
    format!(
        "| {} | {} | {:.2} | {:.0} | {:.1} | {:.2} | {:.2} | {:.3} | {:.2} | {:+.3} | {:.3} | {:.4} | {:.2} | {:.3} | {:.2} |\n",
        m.faults,
        m.setting,
        m.counts.scale,
        m.skipped(),
        m.time.in_ms(),
        e.normal_mean,
        e.normal_median,
        e.depth_rmse,
        e.depth_rmse_all,
        e.bias,
        e.depth_p95,
        e.holes,
        e.psnr,
        e.spill,
        e.outline
    )
}

/// The whole report; `setup` says what was drawn.
pub(crate) fn markdown(setup: &str, results: &[Measured]) -> String {
    let mut text = format!(
        "# Raw range scans: time against error\n\n`cargo run --release -p studies -- ibpr` made this ({}). {setup}\n\n\
         σ is the standard deviation of depth noise along each scan, in spacings of its rays. *CPU ms*: processor time of one \
         frame on one thread. {HOW} Normals and depth are compared at pixel centres with rays cast at the \
         surface, over pixels more than 2 inside the outline; depth is in spacings, *depth RMSE* leaves out pixels within 2 of \
         a depth step (there half a pixel decides between two surfaces), *with steps* does not; *bias* is the median, positive \
         behind the surface. *Holes*: interior pixels without a surface. *PSNR*: sRGB, over the surface's box and 8 pixels around, \
         against a picture with 4×4 samples at edges. *Spill*: pixels more than 2 outside the outline, per pixel of the surface. \
         *Outline*: root mean square distance of the drawn outline (coverage 1/2) from the true one, in pixels. \
         *Skipped*: points that the frame need not look at. *S* is the size of a buffer pixel in picture pixels, *factor* that of `Scale::Auto`.\n\n## Goals\n\n{}{LIMITS}",
        provenance(),
        goals(results)
    );
    let of_scanners = |m: &&Measured| !m.faults.starts_with('σ') && !m.faults.starts_with(RELIEF);
    let _ = write!(text, "\n## Other faults of scanners, by default\n\n{HEAD}");
    results.iter().filter(of_scanners).for_each(|m| text += &line(m));
    text += &in_relief(results);
    for name in distinct(results.iter().map(|m| m.group)) {
        let _ = write!(text, "\n## {}\n\n{HEAD}", title(name));
        let of_group = |m: &&Measured| m.group == name && m.faults.starts_with('σ');
        results.iter().filter(of_group).for_each(|m| text += &line(m));
    }
    text
}

/// The section about the surface in relief.
pub(crate) fn in_relief(results: &[Measured]) -> String {
    let mut text = format!(
        "\n## A surface in relief, by default\n\nThe same surface, raised along its normals by waves 6 and 3 % of the diagonal long, with root mean squares of 0.14 \
         and 0.05 %.\n\n{HEAD}"
    );
    results.iter().filter(|m| m.faults.starts_with(RELIEF)).for_each(|m| text += &line(m));
    text
}

fn title(group: &str) -> &str {
    match group {
        "default" => "Defaults",
        "factor" => "Size of buffer pixels",
        "triangles" => "Normals from eight triangles, as printed",
        "γ" => "Thickness of a surface (γ)",
        "passes" => "One pass and two",
        "weighting" => "Weights of the points of a surface",
        "outline" => "Reach of outlines",
        "fill" => "Pull-push",
        "culling" => "Culling",
        "together" => "Small buffer pixels with wider gaps filled",
        other => other,
    }
}
