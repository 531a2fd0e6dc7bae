//! `ibpr`: time against error of raw range scans, against the surface that they measured.

use std::path::Path;

use glam::Vec3;
use pointillist_ibpr::{Cloud, Frame, FrameCounts, IbprError, Options, Renderer, Scan, View};

use crate::common::charts::chart_of;
use crate::common::frame_error::{FrameError, Measure};
use crate::common::layers::Layers;
use crate::common::report::{Outcome, Row, on_one_thread, write, write_csv};
use crate::common::timing::{Clock, Timing, timed_by};
use crate::common::true_surface::{Surface, Truth, point_at};
use crate::ibpr::floor::{self, Subject};
use crate::ibpr::scans::{Faults, RangeScan, Survey};
use crate::ibpr::settings::{Group, again, groups};
use crate::ibpr::tables::{self, COLUMNS, Measured, RELIEF, markdown};

/// Pixels on a side.
const SIZE: u32 = 1024;

/// Points of all scans together: those of the bunny's own ten scans.
const POINTS: usize = 362_272;

/// Noise of depth, in spacings.
const NOISES: [f64; 5] = [0.0, 0.1, 0.25, 0.5, 1.0];

/// Scans that settings are tried on are made with the first of these seeds; the defaults with all.
const SEEDS: [u64; 4] = [1, 2, 3, 4];

/// What all measurements share.
struct Bench {
    surface: Surface,
    survey: Survey,
    measure: Measure,
    view: View,
}

/// Measures and writes `ibpr.csv`, `ibpr.md`, `ibpr.svg` and `ibpr-depth.svg`.
pub(crate) fn run(out_dir: &Path) -> Outcome {
    let bench = Bench::new(Surface::bunny_or_bumpy());
    let floor = beside_the_floor(&bench.survey, &bench.view)?;
    let mut results = vec![];
    for noise in NOISES {
        eprintln!("ibpr: noise {noise}");
        let faults = Faults { noise, ..Faults::default() };
        let name = format!("σ = {noise}");
        results.extend(on_one_thread(|| bench.groups(&name, faults, SEEDS[0], groups()))?);
        for seed in SEEDS.into_iter().skip(1).filter(|_| noise > 0.0) {
            results.extend(on_one_thread(|| bench.groups(&name, faults, seed, again(seed)))?);
        }
    }
    for (name, faults) in faulty() {
        eprintln!("ibpr: {name}");
        results
            .extend(on_one_thread(|| bench.groups(name, faults, SEEDS[0], groups().drain(..1).collect()))?);
    }
    results.extend(in_relief(&bench.surface)?);
    let empty = bench.measure.of(&bench.measure.truth().as_layers());
    assert!(empty.normal_mean < 1e-3 && empty.holes == 0.0, "the truth has no error: {empty:?}");
    let rows = |error: fn(&FrameError) -> f64| results.iter().map(|r| r.row(error)).collect::<Vec<_>>();
    write_csv(out_dir, "ibpr", &COLUMNS, &rows(|e| e.depth_rmse))?;
    let charted = |rows: Vec<Row>| rows.into_iter().filter(|r| r.scene.starts_with('σ')).collect::<Vec<_>>();
    chart_of(out_dir, "ibpr", "normals, mean error in degrees", &charted(rows(|e| e.normal_mean)))?;
    chart_of(out_dir, "ibpr-depth", "depth, RMSE in spacings", &charted(rows(|e| e.depth_rmse)))?;
    let text = markdown(&bench.setup(), &results) + &floor;
    write(out_dir, "ibpr.md", &text)?;
    Ok(true)
}

/// Prints the section about relief alone.
pub(crate) fn run_relief() -> Outcome {
    print!("{}", tables::in_relief(&in_relief(&Surface::bunny_or_bumpy())?));
    Ok(true)
}

/// The defaults on scans of the same surface with relief.
fn in_relief(surface: &Surface) -> Result<Vec<Measured>, IbprError> {
    let bench = Bench::new(surface.in_relief("the same in relief"));
    let mut results = vec![];
    for noise in NOISES {
        eprintln!("ibpr: relief, noise {noise}");
        let (name, faults) = (format!("{RELIEF}σ = {noise}"), Faults { noise, ..Faults::default() });
        let default = groups().drain(..1).collect();
        results.extend(on_one_thread(|| bench.groups(&name, faults, SEEDS[0], default))?);
    }
    Ok(results)
}

/// Prints the section about the floor alone.
pub(crate) fn run_floor() -> Outcome {
    let surface = Surface::bunny_or_bumpy();
    let survey = Survey::new(&surface, POINTS);
    print!("{}", beside_the_floor(&survey, &surface.view(SIZE))?);
    Ok(true)
}

/// The section about the floor.
fn beside_the_floor(
    survey: &Survey,
    view: &View,
) -> Result<String, Box<dyn std::error::Error + Send + Sync>> {
    eprintln!("ibpr: the floor");
    let scans = survey.measured(Faults::default(), SEEDS[0]);
    let spacing = survey.spacing;
    let cloud = cloud_of(&scans, spacing)?;
    floor::section(&Subject { cloud: &cloud, scans: &scans, spacing, view })
}

/// Faults besides depth noise.
fn faulty() -> Vec<(&'static str, Faults)> {
    let noise = 0.25;
    let perfect = Faults::default();
    vec![
        ("registration 0.5", Faults { registration: 0.5, ..perfect }),
        ("registration 1", Faults { registration: 1.0, ..perfect }),
        ("outliers 1 %", Faults { outliers: 0.01, ..perfect }),
        ("flying pixels", Faults { flying: 0.5, ..perfect }),
        ("all of them, σ = 0.25", Faults { noise, registration: 0.5, outliers: 0.01, flying: 0.5 }),
    ]
}

impl Bench {
    fn new(surface: Surface) -> Self {
        let survey = Survey::new(&surface, POINTS);
        let view = surface.view(SIZE);
        let measure = Measure::new(Truth::new(&surface, &view), survey.spacing);
        Self { surface, survey, measure, view }
    }

    /// What was drawn, in words.
    fn setup(&self) -> String {
        let points = self.survey.measured(Faults::default(), SEEDS[0]);
        let total: usize = points.iter().map(|s| s.positions.len()).sum();
        let unseen =
            self.measure.interior_share(|i| !self.survey.saw(point_at(self.measure.truth(), &self.view, i)));
        format!(
            "Surface: {} ({} triangles). Scans: {total} points from ten directions, parallel rays {:.3} % of the \
             diagonal apart, incidence up to 75°. Picture: {SIZE}×{SIZE}, {} pixels inside the outline; of these {unseen:.3} % \
             show what no scan saw.",
            self.surface.name,
            self.surface.triangle_count(),
            100.0 * self.survey.spacing / self.surface.diagonal(),
            self.measure.interior_pixels(),
        )
    }

    fn groups(
        &self,
        name: &str,
        faults: Faults,
        seed: u64,
        groups: Vec<Group>,
    ) -> Result<Vec<Measured>, IbprError> {
        let scans = self.survey.measured(faults, seed);
        let cloud = cloud_of(&scans, self.survey.spacing)?;
        let mut results = vec![];
        for group in groups {
            for (setting, options) in &group.settings {
                let (counts, time, error) = self.frame(&cloud, options)?;
                let (faults, setting) = (name.to_owned(), setting.clone());
                results.push(Measured { faults, group: group.name, setting, counts, time, error });
            }
        }
        Ok(results)
    }

    /// What one frame drew, its processor seconds, and its errors.
    fn frame(
        &self,
        cloud: &Cloud,
        options: &Options,
    ) -> Result<(FrameCounts, Timing, FrameError), IbprError> {
        let (mut renderer, mut frame) = (Renderer::new(), Frame::default());
        renderer.draw(cloud, &self.view, options, &mut frame)?;
        let draw = || renderer.draw(cloud, &self.view, options, &mut frame);
        let (time, drawn) = timed_by(Clock::Processor, draw);
        drawn?;
        let mut layered = *options;
        layered.surface_layers = true;
        renderer.draw(cloud, &self.view, &layered, &mut frame)?;
        Ok((*frame.counts(), time, self.measure.of(&Layers::of(&frame))))
    }
}

fn cloud_of(scans: &[RangeScan], spacing: f64) -> Result<Cloud, IbprError> {
    let scans: Vec<Scan<'_>> = scans
        .iter()
        .map(|s| Scan::new(&s.positions).with_spacing(spacing).with_scanner(s.towards_scanner))
        .collect();
    Cloud::new(&scans, Vec3::splat(0.8))
}
