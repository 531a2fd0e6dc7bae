//! Error against number of probes, for each way to place them.

use std::cell::OnceCell;
use std::time::Instant;

use glam::DVec3;
use pointillist_delaunay::{Hint, Partition};
use pointillist_sh::Irradiance;
use pointillist_shprobe::Field;
use pointillist_shprobe::place::{self, AdaptiveOptions, Candidates, FitOptions, adaptive};

use crate::shprobe::site::{Baked, Ground, Site};
use crate::shprobe::trilinear::Grid;
use crate::shprobe::truth::{Truth, Wrong};

type Fault = Box<dyn std::error::Error + Send + Sync>;

/// One way to place so many probes.
pub(crate) struct Layout {
    pub(crate) placement: &'static str,
    /// How many were asked for, and how many there are.
    pub(crate) wanted: usize,
    pub(crate) probes: usize,
    pub(crate) cells: usize,
    /// Whether probes know what they see.
    pub(crate) distances: bool,
    pub(crate) wrong: Wrong,
    /// Of choosing them.
    pub(crate) seconds: f64,
}

pub(crate) const TRILINEAR: &str = "grid, trilinear";
pub(crate) const GRID: &str = "grid, tetrahedra";
pub(crate) const RANDOM: &str = "random";
pub(crate) const VERTICES: &str = "vertices";
pub(crate) const ADAPTIVE: &str = "adaptive";
pub(crate) const FITTED: &str = "adaptive, fitted";

/// Adaptive placement is not asked for more probes than this: it is there to need few.
const MOST_ADAPTIVE: usize = 192;

/// All that is measured at a site.
pub(crate) struct Survey<'a> {
    pub(crate) ground: Ground<'a>,
    pub(crate) truth: Truth,
    pub(crate) layouts: Vec<Layout>,
    candidates: OnceCell<Baked>,
}

impl<'a> Survey<'a> {
    pub(crate) fn new(site: &'a Site) -> Result<Self, Fault> {
        let start = Instant::now();
        let ground = Ground::new(site)?;
        let truth = Truth::new(&ground)?;
        let (queries, seconds) = (truth.positions.len(), start.elapsed().as_secs_f64());
        eprintln!("shprobe: {}: {queries} positions in {seconds:.1} s", site.name);
        Ok(Self { ground, truth, layouts: vec![], candidates: OnceCell::new() })
    }

    /// What order 2 loses without any interpolation.
    pub(crate) fn floor(&self) -> Wrong {
        self.truth.wrong_of_order_2(self.ground.site.dark_from)
    }

    /// Grids of these sizes, by both interpolations.
    pub(crate) fn grids(&mut self, sizes: &[[usize; 3]]) -> Result<(), Fault> {
        for &size in sizes {
            let grid = Grid::new(&self.ground, size);
            let baked = self.ground.look(&grid.positions)?;
            let lights: Vec<Irradiance> = baked.radiance.iter().map(Irradiance::new).collect();
            let wanted = size.iter().product();
            for distances in [false, true] {
                let light = |p: DVec3| grid.light(&baked, &lights, distances, p);
                let wrong = self.truth.wrong(self.ground.site.dark_from, light);
                let (probes, cells) = (grid.positions.len(), 0);
                let placement = TRILINEAR;
                self.layouts.push(Layout {
                    placement,
                    wanted,
                    probes,
                    cells,
                    distances,
                    wrong,
                    seconds: 0.0,
                });
            }
            self.tetrahedra(GRID, wanted, &baked)?;
        }
        Ok(())
    }

    /// Places that do not depend on light: random ones, and those above vertices.
    pub(crate) fn blind(&mut self, counts: &[usize]) -> Result<(), Fault> {
        let most = counts.iter().copied().max().unwrap_or(0);
        let random = self.ground.look(&self.ground.random(most, 1))?;
        // Some of the vertices are of no use: more of them than needed are spread.
        let vertices = self.ground.above_vertices();
        let spread = place::spread(&vertices, 4 * most).into_iter().map(|i| vertices[i]);
        let free: Vec<DVec3> = spread.filter(|&p| self.ground.is_free(p)).take(most).collect();
        let vertices = self.ground.look(&free)?;
        for (placement, all) in [(RANDOM, random), (VERTICES, vertices)] {
            for &count in counts.iter().filter(|&&c| c <= all.positions.len()) {
                self.tetrahedra(placement, count, &all.pick(0..count))?;
            }
        }
        Ok(())
    }

    /// Places chosen for their light.
    pub(crate) fn adaptive(&mut self, counts: &[usize]) -> Result<(), Fault> {
        for &count in counts.iter().filter(|&&c| c <= MOST_ADAPTIVE) {
            for distances in [false, true] {
                let start = Instant::now();
                let chosen = self.chosen(count, distances)?;
                let seconds = start.elapsed().as_secs_f64();
                for (placement, baked) in [(ADAPTIVE, &chosen.seen), (FITTED, &chosen.fitted)] {
                    self.tetrahedra_with(placement, count, baked, distances)?;
                    if let Some(layout) = self.layouts.last_mut() {
                        layout.seconds = seconds;
                        eprintln!("{}", line(self.ground.site.name, layout));
                    }
                }
            }
        }
        Ok(())
    }

    /// The candidates that adaptive placement takes.
    pub(crate) fn chosen(&self, count: usize, distances: bool) -> Result<Chosen, Fault> {
        let all = self.candidates()?;
        let mut candidates = Candidates::new(&all.positions, &all.radiance);
        candidates.distances = distances.then_some(all.distances.as_slice());
        let balance = self.ground.site.balance;
        let options = AdaptiveOptions::DEFAULT.with_max_count(count).with_balance(balance);
        let chosen = adaptive(candidates, &options)?.chosen;
        let seen = all.pick(chosen.iter().map(|&i| i as usize));
        let radiance = place::fit(candidates, &chosen, &FitOptions::DEFAULT.with_balance(balance))?;
        let fitted = Baked { radiance, ..seen.clone() };
        Ok(Chosen { seen, fitted })
    }

    /// A fine grid with what is seen from it.
    pub(crate) fn candidates(&self) -> Result<&Baked, Fault> {
        if let Some(known) = self.candidates.get() {
            return Ok(known);
        }
        let start = Instant::now();
        let site = self.ground.site;
        let all = place::grid(site.low, site.high, site.candidates);
        let places: Vec<DVec3> = all.into_iter().filter(|&p| self.ground.is_free(p)).collect();
        let baked = self.ground.look(&places)?;
        let seconds = start.elapsed().as_secs_f64();
        eprintln!("shprobe: {}: {} candidates in {seconds:.1} s", self.ground.site.name, places.len());
        Ok(self.candidates.get_or_init(|| baked))
    }

    fn tetrahedra(&mut self, placement: &'static str, wanted: usize, baked: &Baked) -> Result<(), Fault> {
        for distances in [false, true] {
            self.tetrahedra_with(placement, wanted, baked, distances)?;
        }
        Ok(())
    }

    pub(crate) fn tetrahedra_with(
        &mut self,
        placement: &'static str,
        wanted: usize,
        baked: &Baked,
        distances: bool,
    ) -> Result<(), Fault> {
        let field = baked.field(distances)?;
        let wrong = self.truth.wrong(self.ground.site.dark_from, |p| light(&field, p));
        let (probes, cells) = (baked.positions.len(), cell_count(&field));
        self.layouts.push(Layout { placement, wanted, probes, cells, distances, wrong, seconds: 0.0 });
        Ok(())
    }
}

/// Probes placed where light asks for them.
pub(crate) struct Chosen {
    /// With what they saw.
    pub(crate) seen: Baked,
    /// With what lights all candidates best.
    pub(crate) fitted: Baked,
}

/// What lights an object at a position.
pub(crate) fn light(field: &Field, p: DVec3) -> Irradiance {
    let mut hint: Hint = field.locator().hint(p);
    field.light(p, &mut hint).unwrap_or(Irradiance::DARK)
}

/// Tetrahedra, or what there is instead.
pub(crate) fn cell_count(field: &Field) -> usize {
    match field.partition() {
        Partition::Tetrahedra(t) => t.corners.len(),
        Partition::Triangles(t) => t.corners.len(),
        Partition::Line(line) => line.len().saturating_sub(1),
        Partition::Point(_) => 0,
    }
}

/// The heads of the columns of [`line()`].
pub(crate) const HEAD: &str = "| scene | placement | asked for | probes | cells | distances | error % | dark room % | choosing, s |\n\
                               | --- | --- | ---: | ---: | ---: | --- | ---: | ---: | ---: |\n";

/// A line of the table.
pub(crate) fn line(scene: &str, l: &Layout) -> String {
    let dark = l.wrong.dark.map_or("–".to_owned(), |d| format!("{:.2}", 100.0 * d));
    let distances = if l.distances { "with" } else { "without" };
    let cells = if l.placement == TRILINEAR { "–".to_owned() } else { l.cells.to_string() };
    let seconds = if l.seconds > 0.0 { format!("{:.1}", l.seconds) } else { "–".to_owned() };
    format!(
        "| {scene} | {} | {} | {} | {cells} | {distances} | {:.2} | {dark} | {seconds} |",
        l.placement,
        l.wanted,
        l.probes,
        100.0 * l.wrong.all,
    )
}
