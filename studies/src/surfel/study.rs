//! `surfel`: time against error of point clouds, against rays cast at the surface through a thin lens.

use std::f32::consts::TAU;
use std::path::Path;

use glam::{DVec3, Quat, Vec3};
use pointillist_surfel::{
    Cloud, Method, Options, Points, Procedure, SampleOptions, SurfelError, estimate_normals,
};

use crate::common::charts::chart_of;
use crate::common::data;
use crate::common::picture_layers::PictureLayers;
use crate::common::report::{Outcome, write, write_csv};
use crate::common::timing::HOW;
use crate::common::true_surface::Surface;
use crate::surfel::coloured_cloud::ColouredCloud;
use crate::surfel::lens_scenes::{above, front, front_from, lens_name};
use crate::surfel::measured::Measured;
use crate::surfel::open3d;
use crate::surfel::same::{Same, compare};
use crate::surfel::sheets;
use crate::surfel::specks;
use crate::surfel::stage::{DEFAULT_LEVEL, Effort, PROCEDURES, REFERENCE_BLUR, Stage, at_level};
use crate::surfel::tables::{COLUMNS, Section, csv_rows, markdown};

/// Points of the paper's cloud, and of the bunny's own ten scans together.
const PAPERS_POINTS: usize = 97_000;
const SCANNED_POINTS: usize = 362_272;

/// Pixels on a side: of the paper's pictures and of ours.
const PAPERS_SIZE: u32 = 400;
const SIZE: u32 = 512;
const LARGE_SIZE: u32 = 1024;

/// Radii of discs, in those that sampling gives.
const RADII: [f32; 5] = [0.5, 0.75, 1.0, 1.5, 2.0];

/// By how much normals are turned to see what that costs.
const OFF_DEG: [f32; 3] = [1.0, 2.0, 3.0];

/// The golden ratio less 1: multiples of it are spread evenly over the turns.
pub(super) const GOLDEN_TURN: f64 = 0.618_033_988_749_894_9;

/// The level of detail that small objects had before the present default.
const COARSER_LEVEL: f32 = 1.4;

/// What all measurements share.
struct Bench {
    surface: Surface,
    effort: Effort,
    /// The paper's number of points, and that of the scans.
    small: ColouredCloud,
    small_ready: Cloud,
    large_ready: Cloud,
    /// What references agree to, in words.
    notes: Vec<String>,
}

/// Measures and writes `surfel.csv`, `surfel.md` and `surfel.svg`.
pub(crate) fn run(out_dir: &Path) -> Outcome {
    measure(Effort::FULL, out_dir)
}

/// The same in a minute or two, with fewer rays and runs.
pub(crate) fn run_quick(out_dir: &Path) -> Outcome {
    measure(Effort::QUICK, out_dir)
}

fn measure(effort: Effort, out_dir: &Path) -> Outcome {
    let mut bench = Bench::new(effort)?;
    let mut sections = vec![];
    sections.extend(bench.front_sections()?);
    sections.push(bench.normals()?);
    sections.push(bench.sizes()?);
    sections.push(bench.speed()?);
    sections.push(bench.lenses()?);
    let same = bench.same()?;
    let rows = csv_rows(&sections);
    write_csv(out_dir, "surfel", &COLUMNS, &rows)?;
    chart_of(out_dir, "surfel", "colour, RMSE of sRGB", &rows)?;
    eprintln!("surfel: two sheets");
    let two_sheets = sheets::table(effort.slants_deg)?;
    let specks = specks::table(effort.speckled)?;
    let beside = open3d::section(&bench.small, bench.small_ready.spacing())?;
    let others = [
        ("Two surfaces close to each other", two_sheets),
        ("Specks", specks),
        ("Normals beside Open3D", beside),
    ];
    write(out_dir, "surfel.md", &markdown(&bench.setup(), &sections, &others, &same))?;
    // A picture that depends on threads or on the order of points is a fault, however fast.
    Ok(same.iter().all(|s| s.same_bytes || s.may_differ))
}

impl Bench {
    fn new(effort: Effort) -> Result<Self, SurfelError> {
        let surface = Surface::coarse_bunny_or_bumpy();
        let small = sampled(&surface, Method::Poisson, PAPERS_POINTS)?;
        let small_ready = small.ready()?;
        let large_ready = sampled(&surface, effort.method, SCANNED_POINTS)?.ready()?;
        Ok(Self { surface, effort, small, small_ready, large_ready, notes: vec![] })
    }

    /// What was drawn, in words.
    fn setup(&self) -> String {
        let [rays, lens_rays] = self.effort.rays;
        format!(
            "Surface: {} ({} triangles), with colours that wave along the axes, a sun, and a tenth of the light from everywhere. \
             Large clouds are sampled by {:?}. Truth: {rays} rays a pixel, {lens_rays} through a lens. {HOW} {}",
            self.surface.name,
            self.surface.triangle_count(),
            self.effort.method,
            self.notes.join(" "),
        )
    }

    /// Notes how far the truth is from the picture that another program made of the same scene, if it is there.
    fn note_reference(&mut self, stage: &Stage, file: &str) {
        let Some(folder) = data::folder() else { return };
        match PictureLayers::read(&folder.join("reference/points").join(file)) {
            Ok(picture) => {
                let error = stage.measure.of(&picture);
                self.notes.push(format!(
                    "Of {}, the reference data have a picture by another program: {:.1} dB from our truth, normals {:.3}°.",
                    stage.name, error.psnr, error.normal_mean
                ));
            }
            Err(error) => eprintln!("surfel: no reference picture: {error}"),
        }
    }

    /// Clouds of all kinds and discs of all sizes.
    fn front_sections(&mut self) -> Result<[Section; 2], SurfelError> {
        let mut stage = Stage::new("front", &self.surface, front(&self.surface, SIZE), &self.effort);
        self.note_reference(&stage, "front.exr");
        let bare = || Points::new(&self.small.positions).with_colors(&self.small.colours);
        let without_normals = Cloud::new(&bare().with_radii(&self.small.radii))?;
        let normals = bare().with_normals(&self.small.face_normals).with_shading_normals(&self.small.normals);
        let without_radii = Cloud::new(&normals)?;
        let ldi = sampled(&self.surface, Method::Ldi, SCANNED_POINTS)?.ready()?;
        let (mut clouds, mut radii) = (vec![], vec![]);
        let of_points = |n: usize, what: &str| format!("{n} points{what}");
        for (name, cloud) in [
            (of_points(PAPERS_POINTS, ""), &self.small_ready),
            (of_points(PAPERS_POINTS, " without normals"), &without_normals),
            (of_points(PAPERS_POINTS, " without radii"), &without_radii),
            (of_points(SCANNED_POINTS, ""), &self.large_ready),
            (of_points(ldi.len(), " by rays"), &ldi),
        ] {
            clouds.extend(by_both(&stage, cloud, &name, None)?);
        }
        stage.name = "radii".to_owned();
        for factor in RADII {
            let cloud = self.small.clone().with_radii_times(factor).ready()?;
            radii.extend(by_both(&stage, &cloud, &format!("radii × {factor}"), None)?);
        }
        Ok([
            Section { title: "Clouds, 512×512", ratio: None, rows: clouds },
            Section { title: "Radii of discs: 97000 points, 512×512", ratio: None, rows: radii },
        ])
    }

    /// What normals are worth: exact ones, those of one kind alone, ones that are off, and estimated ones with and without sides.
    fn normals(&mut self) -> Result<Section, SurfelError> {
        let stage = Stage::new("normals", &self.surface, front(&self.surface, SIZE), &self.effort);
        let ColouredCloud { positions, normals, face_normals, colours, radii } = &self.small;
        let estimated = estimate_normals(positions)?;
        let off = |of: &[Vec3]| {
            let angle = |(a, b): (&Vec3, &Vec3)| f64::from(a.dot(*b).abs().min(1.0)).acos().to_degrees();
            estimated.iter().zip(of).map(angle).sum::<f64>() / of.len() as f64
        };
        let wrong = estimated.iter().zip(normals).filter(|(e, n)| e.dot(**n) < 0.0).count();
        self.notes.push(format!(
            "Estimated normals are off by {:.2}° from those of triangles in the mean, and by {:.2}° from smooth ones; {wrong} of them have the wrong side.",
            off(face_normals),
            off(normals)
        ));
        let sided: Vec<Vec3> =
            estimated.iter().zip(normals).map(|(e, n)| if e.dot(*n) < 0.0 { -*e } else { *e }).collect();
        let bare = || Points::new(positions).with_colors(colours).with_radii(radii);
        let mut clouds = vec![
            ("of triangles, smooth ones for light".to_owned(), self.small.points()),
            ("of triangles alone".to_owned(), bare().with_normals(face_normals)),
            ("smooth ones alone".to_owned(), bare().with_normals(normals)),
            ("estimated, sides known".to_owned(), bare().with_normals(&sided)),
            ("estimated".to_owned(), bare()),
        ];
        let turned = OFF_DEG.map(|degrees| (degrees, turned_by(normals, degrees)));
        for (degrees, normals) in &turned {
            clouds.push((format!("smooth ones, {degrees}° off"), bare().with_normals(normals)));
        }
        let blended = stage.options(Procedure::Blended);
        let row = |(setting, points): (String, Points<'_>)| {
            eprintln!("surfel: {}: {setting}", stage.name);
            stage.measured(&Cloud::new(&points)?, setting, &blended)
        };
        let rows = clouds.into_iter().map(row).collect::<Result<_, _>>()?;
        Ok(Section { title: "Normals: 97000 points, 512×512", ratio: None, rows })
    }

    /// Levels of detail at all sizes of the object.
    fn sizes(&self) -> Result<Section, SurfelError> {
        let mut rows: Vec<Measured> = vec![];
        let stages = Vec::from_iter(self.effort.sizes.iter().map(|&(distances, name)| {
            let setting = front_from(&self.surface, LARGE_SIZE, distances);
            Stage::new(name, &self.surface, setting, &self.effort)
        }));
        let cloud = &self.large_ready;
        for (i, stage) in stages.iter().enumerate() {
            let full = (i > 0).then_some((&stages[0], cloud));
            for &level in self.effort.levels {
                for procedure in procedures_at(level) {
                    let options = at_level(level, stage.options(procedure));
                    rows.push(row(stage, cloud, format!("level {level}"), &options, full)?);
                }
            }
        }
        let title = "Levels of detail: 362272 points, 1024×1024";
        Ok(Section { title, ratio: Some("of the full size by the same level"), rows })
    }

    /// More points and more pixels.
    fn speed(&self) -> Result<Section, SurfelError> {
        let most = sampled(&self.surface, self.effort.method, self.effort.most_points)?.ready()?;
        let mut rows: Vec<Measured> = vec![];
        let [small, large] = [PAPERS_SIZE, LARGE_SIZE]
            .map(|size| Stage::new("speed", &self.surface, front(&self.surface, size), &self.effort));
        let compared = Some((&large, &self.large_ready));
        let setting = |cloud: &Cloud, size: u32| format!("{} points at {size}²", cloud.len());
        let of_papers = setting(&self.small_ready, PAPERS_SIZE);
        rows.extend(by_both(&small, &self.small_ready, &of_papers, compared)?);
        for (cloud, compared) in [(&self.large_ready, None), (&most, compared)] {
            let setting = setting(cloud, LARGE_SIZE);
            rows.extend(by_both(&large, cloud, &setting, compared)?);
            let coarser = at_level(COARSER_LEVEL, large.options(Procedure::Blended));
            rows.push(row(&large, cloud, format!("{setting}, level {COARSER_LEVEL}"), &coarser, compared)?);
        }
        Ok(Section {
            title: "Speed, front",
            ratio: Some("of 362272 points at 1024², by the same level"),
            rows,
        })
    }

    /// Depth of field against the mean of views from all over the lens.
    fn lenses(&mut self) -> Result<Section, SurfelError> {
        let (mut rows, mut blurs) = (vec![], vec![]);
        let blur_px = self.effort.blurs;
        let stages = Vec::from_iter(blur_px.iter().map(|&px| {
            let share = f64::from(px) / f64::from(REFERENCE_BLUR);
            let setting = above(&self.surface, PAPERS_SIZE, share);
            Stage::new(&lens_name(px), &self.surface, setting, &self.effort)
        }));
        for (&px, stage) in blur_px.iter().zip(&stages) {
            if px == REFERENCE_BLUR {
                self.note_reference(stage, "dof.exr");
            }
            blurs.push(format!("{:.1}", largest_blur(stage, &self.small.positions)));
            let cloud = &self.small_ready;
            let sharp = (px > 0).then_some((&stages[0], cloud));
            rows.extend(by_both(stage, cloud, &format!("{PAPERS_POINTS} points"), sharp)?);
            for views in self.effort.views.iter().filter(|_| px > 0) {
                eprintln!("surfel: {}: {views} views", stage.name);
                rows.push(stage.measured_views(cloud, *views)?);
            }
        }
        self.notes.push(format!("The lenses blur by up to {} px.", blurs.join(", ")));
        let title = "Depth of field: 97000 points, 400×400";
        let ratio =
            "of the sharp frame by the same procedure; of lens views: of the blended frame with this lens";
        Ok(Section { title, ratio: Some(ratio), rows })
    }

    fn same(&self) -> Result<Vec<Same>, SurfelError> {
        eprintln!("surfel: place, scale, order and threads");
        let diagonal = self.surface.diagonal();
        let mut list = compare(("front", 1.0), &self.small, front(&self.surface, SIZE), diagonal)?;
        let lens = above(&self.surface, PAPERS_SIZE, 1.0);
        for scene in [("lens 16 px", 1.0), ("lens 16 px, level 0", 0.0)] {
            list.extend(compare(scene, &self.small, lens, diagonal)?);
        }
        Ok(list)
    }
}

/// Unit vectors turned by this angle, each about another axis across it.
fn turned_by(normals: &[Vec3], degrees: f32) -> Vec<Vec3> {
    let turn = |(i, n): (usize, &Vec3)| {
        // Golden angles: no two neighbours in the list are turned alike.
        let around = (i as f64 * GOLDEN_TURN).fract() as f32 * TAU;
        Quat::from_axis_angle(*n, around)
            * (Quat::from_axis_angle(n.any_orthonormal_vector(), degrees.to_radians()) * *n)
    };
    normals.iter().enumerate().map(turn).collect()
}

fn sampled(surface: &Surface, method: Method, count: usize) -> Result<ColouredCloud, SurfelError> {
    eprintln!("surfel: {count} points by {method:?}");
    let options = SampleOptions::DEFAULT.with_method(method).with_count(count);
    // Colours are the same under every camera.
    let (_, matt) = front(surface, 1);
    ColouredCloud::of(surface, &matt, &options)
}

/// A frame by each procedure, with the defaults; its time beside that of another scene or cloud, if one is given.
fn by_both(
    stage: &Stage,
    cloud: &Cloud,
    setting: &str,
    compared: Option<(&Stage, &Cloud)>,
) -> Result<Vec<Measured>, SurfelError> {
    eprintln!("surfel: {}: {setting}", stage.name);
    let row = |procedure| row(stage, cloud, setting.to_owned(), &stage.options(procedure), compared);
    PROCEDURES.into_iter().map(row).collect()
}

fn row(
    stage: &Stage,
    cloud: &Cloud,
    setting: String,
    options: &Options,
    compared: Option<(&Stage, &Cloud)>,
) -> Result<Measured, SurfelError> {
    match compared {
        Some(other) => stage.compared(cloud, setting, options, other),
        None => stage.measured(cloud, setting, options),
    }
}

/// Levels are of the octree, not of the procedure: one of them has to do, except at the default.
fn procedures_at(level: f32) -> impl Iterator<Item = Procedure> {
    PROCEDURES.into_iter().take(if level == DEFAULT_LEVEL { 2 } else { 1 })
}

/// Pixels.
fn largest_blur(stage: &Stage, positions: &[DVec3]) -> f64 {
    let depth = |p: &DVec3| (*p - stage.camera.eye).dot(stage.camera.forward);
    positions.iter().map(|p| stage.camera.blur_px(depth(p))).fold(0.0, f64::max)
}
