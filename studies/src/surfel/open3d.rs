//! Estimated normals beside those of Open3D.

use std::error::Error;

use glam::{DVec3, Vec3};
use pointillist_surfel::estimate_normals;

use crate::common::peers;
use crate::common::report::on_one_thread;
use crate::common::timing::{Clock, Timing, timed_by};
use crate::surfel::coloured_cloud::ColouredCloud;
use crate::surfel::study::GOLDEN_TURN;

const OPEN3D: &str = "OPEN3D";

/// Places around a point that its normal is fitted to; the last is Open3D's default.
const NEIGHBOURS: [u32; 2] = [14, 30];

/// Largest shifts along the normals, in spacings of the cloud.
const NOISE: [f64; 2] = [0.0, 0.25];

/// A cloud of a known surface, and what of it was estimated.
struct Subject<'a> {
    positions: Vec<DVec3>,
    smooth: &'a [Vec3],
}

/// The section of the report.
pub(crate) fn section(cloud: &ColouredCloud, spacing: f64) -> Result<String, Box<dyn Error + Send + Sync>> {
    let Some(program) = peers::find(OPEN3D, "open3d") else {
        let skipped = peers::skipped("Open3D", OPEN3D);
        return Ok(format!("{skipped} `studies/peers/build python` does.\n"));
    };
    let mut text = format!(
        "`studies/peers/open3d/normals.py`: normals of {} points of blue noise by planes through their neighbours, and one side for all by a spanning tree over as many, or whatever side comes; on one thread. \
         *Noise*: largest shift along the smooth normals, in spacings (evenly distributed). *Off*: mean angle to the smooth normals, whichever side. *Wrong side*: of all points. \
         *Of ours*: processor time over that of `estimate_normals`.\n\n\
         | noise | program | off ° | wrong side % | CPU s | of ours |\n| ---: | --- | ---: | ---: | ---: | ---: |\n",
        cloud.positions.len()
    );
    for noise in NOISE {
        eprintln!("surfel: Open3D, noise {noise}");
        let subject = Subject { positions: shifted(cloud, noise * spacing), smooth: &cloud.normals };
        let (own, ours) =
            on_one_thread(|| timed_by(Clock::Processor, || estimate_normals(&subject.positions)));
        text += &subject.row(noise, "`surfel`", &ours?, [own, own]);
        let places: String = subject.positions.iter().map(|p| format!("{} {} {}\n", p.x, p.y, p.z)).collect();
        for (sided, what) in [("1", ""), ("0", ", no sides")] {
            let cloud = format!("{sided}\n{places}");
            let drawn = peers::draw(&program, &cloud, [subject.positions.len() as u32, 1], &NEIGHBOURS)?;
            for (neighbours, (time, picture)) in NEIGHBOURS.iter().zip(drawn) {
                let normals: Vec<Vec3> = picture.pixels.iter().map(|n| n.as_vec3()).collect();
                let name = format!("Open3D, {neighbours} neighbours{what}");
                text += &subject.row(noise, &name, &normals, [time, own]);
            }
        }
    }
    Ok(text)
}

/// Points moved along their smooth normals by up to `most`, forth or back.
fn shifted(cloud: &ColouredCloud, most: f64) -> Vec<DVec3> {
    // Golden angles: no two neighbours in the list are moved alike.
    let share = |i: usize| 2.0 * (i as f64 * GOLDEN_TURN).fract() - 1.0;
    let points = cloud.positions.iter().zip(&cloud.normals).enumerate();
    points.map(|(i, (p, n))| *p + n.as_dvec3() * (most * share(i))).collect()
}

impl Subject<'_> {
    /// A row of the table; `times` are the program's and ours.
    fn row(&self, noise: f64, program: &str, normals: &[Vec3], times: [Timing; 2]) -> String {
        let cosines = || normals.iter().zip(self.smooth).map(|(n, smooth)| f64::from(n.dot(*smooth)));
        let count = normals.len() as f64;
        let off = cosines().map(|c| c.abs().min(1.0).acos().to_degrees()).sum::<f64>() / count;
        let wrong = 100.0 * cosines().filter(|c| *c < 0.0).count() as f64 / count;
        let [time, own] = times;
        format!(
            "| {noise} | {program} | {off:.2} | {wrong:.2} | {time:.2} | {:.1} |\n",
            time.seconds / own.seconds
        )
    }
}
