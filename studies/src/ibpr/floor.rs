//! Frames beside a plain C program that does the least the method needs: `studies/peers/points/floor.c`.

use std::fmt::Write as _;
use std::path::Path;

use cpu_time::ThreadTime;
use glam::DVec3;
use pointillist_ibpr::{Cloud, Culling, Frame, IbprError, Normals, Options, Passes, Renderer, Scale, View};

use crate::common::peers;
use crate::common::report::on_one_thread;
use crate::common::timing::{Clock, Ratio, Timing, timed_by};
use crate::common::true_surface::{ALBEDO, AMBIENT, LIGHT};
use crate::ibpr::scans::RangeScan;
use crate::ibpr::settings::defaults;

/// Names a program that takes scenes as `studies/peers/points/floor.c` does.
const FLOOR: &str = "POINTILLIST_POINTS_FLOOR";

/// Picture pixels per buffer pixel: the paper's for the bunny.
const BUFFER: f32 = 2.7;

/// Frames of a run of the program, which says how long one in the middle took.
const FRAMES: u32 = 9;

/// Neighbours on one surface differ by less in depth, spacings: the paper's.
const STEP: f64 = 5.0;

/// Scans of one picture, prepared for both programs.
pub(super) struct Subject<'a> {
    pub(super) cloud: &'a Cloud,
    pub(super) scans: &'a [RangeScan],
    pub(super) spacing: f64,
    pub(super) view: &'a View,
}

/// Our settings, the plainest first.
fn settings() -> [(&'static str, Options); 4] {
    let mut all = defaults();
    (all.passes, all.scale) = (Passes::One, Scale::Fixed(BUFFER));
    let mut plain = all;
    (plain.outline, plain.fill, plain.culling) = (0.0, 0, Culling::None);
    plain.normals = Normals::Triangles;
    let (mut fitted, mut outlined) = (plain, plain);
    (fitted.normals, outlined.normals) = (all.normals, all.normals);
    outlined.outline = all.outline;
    [
        ("what the floor does", plain),
        ("with fitted normals", fitted),
        ("with outlines, too", outlined),
        ("the defaults, one pass", all),
    ]
}

/// The section of the report.
pub(super) fn section(subject: &Subject<'_>) -> Result<String, Box<dyn std::error::Error + Send + Sync>> {
    let mut text = "\n## Beside a plain C program\n\n".to_owned();
    let Some(program) = peers::find(FLOOR, "points_floor") else {
        return Ok(text + &peers::skipped("The floor", FLOOR) + "\n");
    };
    let size = [subject.view.width(), subject.view.height()];
    let scene = scene(subject);
    let drawn = peers::draw(&program, &scene, size, &[FRAMES])?;
    let (floor, picture) = drawn.first().ok_or("a picture for each number of frames")?;
    let shown = picture.pixels.iter().filter(|c| **c != DVec3::ZERO).count();
    let _ = write!(
        text,
        "`studies/peers/points/floor.c`: depth and sums of all points, normals from eight triangles, faces, colour and depth of each pixel, on one thread, compiled for this \
         processor with floating point as the compiler likes. σ = 0, S = {BUFFER}. *Pixels*: those that show something. *Of the floor*: median of fifteen pairs of runs in turns, and half of what the middle half of them differ by.\n\n\
         | program | pixels | CPU ms | of the floor |\n| --- | ---: | ---: | ---: |\n| the floor | {shown} | {:.1} | 1 |\n",
        floor.in_ms()
    );
    for (name, options) in settings() {
        let (time, shown) = on_one_thread(|| ours(subject, &options))?;
        let Ratio { value, spread } = in_turns(subject, &options, (&program, &scene, size))?;
        let _ =
            writeln!(text, "| `ibpr`, {name} | {shown} | {:.1} | {value:.2} ± {spread:.2} |", time.in_ms());
    }
    Ok(text + LIMITS)
}

/// What keeps frames from the floor, and what was tried.
const LIMITS: &str = "\nWhere the time goes (a profiler's samples of the defaults in one pass): two fifths to points (nearest depths and sums, a third of that is projection), a sixth to filling triangles, an eighth to \
    light and writing pixels, the rest to fitted normals, outlines, gaps and clearing. The floor has none of the last four. Tried, and no faster: pixel numbers computed several at a time and no test of single points in blocks that lie wholly in a band; \
    offsets of 16 bits in blocks, for half the bytes per point: as many instructions to a thousandth, and 34.5 instead of 34.4 ms for a frame of a sphere that fills the picture.\n";

/// Processor seconds of a frame, and how many pixels show something.
fn ours(subject: &Subject<'_>, options: &Options) -> Result<(Timing, usize), IbprError> {
    let (mut renderer, mut frame) = (Renderer::new(), Frame::default());
    let draw = || renderer.draw(subject.cloud, subject.view, options, &mut frame);
    let (time, done) = timed_by(Clock::Processor, draw);
    done?;
    Ok((time, frame.color().iter().filter(|c| c[3] > 0.0).count()))
}

/// How much longer our frames take than those of the program with this scene and size, both in turns.
fn in_turns(
    subject: &Subject<'_>,
    options: &Options,
    (program, scene, size): (&Path, &str, [u32; 2]),
) -> Result<Ratio, Box<dyn std::error::Error + Send + Sync>> {
    let (mut renderer, mut frame, mut done) = (Renderer::new(), Frame::default(), Ok(()));
    let now = || ThreadTime::now().as_duration().as_secs_f64();
    let mut one = || {
        let begin = now();
        if done.is_ok() {
            done = renderer.draw(subject.cloud, subject.view, options, &mut frame);
        }
        now() - begin
    };
    let ours = || {
        let mut seconds: Vec<f64> = (0..FRAMES).map(|_| one()).collect();
        seconds.sort_by(f64::total_cmp);
        seconds[seconds.len() / 2]
    };
    let ratio = on_one_thread(|| peers::ratio_to(program, scene, size, FRAMES, ours))?;
    done?;
    Ok(ratio)
}

/// The scene as the program reads it.
fn scene(subject: &Subject<'_>) -> String {
    let Subject { scans, spacing, view, .. } = subject;
    let mut text = format!(
        "{} {}\n{BUFFER} {:e} {:e}\n",
        view.width(),
        view.height(),
        f64::from(defaults().gamma) * spacing,
        STEP * spacing
    );
    for v in [view.eye(), view.right(), -view.up(), view.forward()] {
        push(&mut text, v);
    }
    let _ = writeln!(text, "{:e}", view.focal_px());
    push(&mut text, LIGHT);
    let count: usize = scans.iter().map(|s| s.positions.len()).sum();
    let _ = writeln!(text, "{AMBIENT:e} {ALBEDO:e}\n{count}");
    scans.iter().flat_map(|s| &s.positions).for_each(|p| push(&mut text, *p));
    text
}

fn push(text: &mut String, v: DVec3) {
    let _ = writeln!(text, "{:e} {:e} {:e}", v.x, v.y, v.z);
}
