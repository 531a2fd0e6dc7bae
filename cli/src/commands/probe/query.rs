//! `probe query`.

use crate::commands::Report;
use crate::commands::report::write_text;
use crate::error::CliError;
use crate::options::QueryOptions;
use crate::probe_io::{read_probes, read_rows};
use glam::{DVec3, Vec3};

pub(super) fn run(options: &QueryOptions) -> Result<(), CliError> {
    let report = Report::new(&options.common)?;
    let name = options.probes.display().to_string();
    let field = report.stats.stage("load", || read_probes(&options.probes)?.field(&name))?;
    let rows = report.stats.stage("load", || read_rows::<6>(&options.points, "x y z nx ny nz"))?;
    let query = |&[x, y, z, nx, ny, nz]: &[f64; 6]| -> (DVec3, Vec3) {
        (DVec3::new(x, y, z), DVec3::new(nx, ny, nz).normalize_or_zero().as_vec3())
    };
    let queries: Vec<(DVec3, Vec3)> = rows.iter().map(query).collect();
    if let Some(i) = queries.iter().position(|(_, n)| *n == Vec3::ZERO) {
        let [x, y, z, ..] = rows[i];
        return Err(CliError::Failed(format!("the point {x} {y} {z} has no normal: nx, ny and nz are 0")));
    }
    let light = report.stats.stage("query", || field.irradiance_all(&queries));
    let light = light.map_err(|error| CliError::Failed(error.to_string()))?;
    report.stats.count("queries", light.len() as u64);
    write_text(&options.output.path, |output| {
        light.iter().try_for_each(|c| writeln!(output, "{} {} {}", c.x, c.y, c.z))
    })?;
    report.finish()
}
