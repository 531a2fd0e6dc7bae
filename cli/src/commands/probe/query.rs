//! `probe query`.

use crate::commands::Report;
use crate::commands::report::write_text;
use crate::error::CliError;
use crate::input::name_of;
use crate::input_error::InputError;
use crate::options::QueryOptions;
use crate::probe_io::{read_probes, read_rows};
use glam::{DVec3, Vec3};
use pointillist_delaunay::Hint;
use pointillist_shprobe::{Field, ProbeError};

pub(super) fn run(options: &QueryOptions) -> Result<(), CliError> {
    let report = Report::new(&options.common)?
        .reading([&options.probes, &options.points])?
        .writing([&options.output.path])?;
    let name = name_of(&options.probes);
    let file = report.stats.stage("load", || read_probes(&options.probes))?;
    let field = report.stats.stage("load", || file.field(&name))?;
    let rows = report.stats.stage("load", || read_rows(&options.points, "x y z nx ny nz", has_normal))?;
    let queries: Vec<(DVec3, Vec3)> = rows.iter().map(query).collect();
    let light = report.stats.stage("query", || field.irradiance_all(&queries));
    let light = light.map_err(broken)?;
    let shares =
        if options.shares { shares(&field, &queries, &file.lit_numbers()).map_err(broken)? } else { vec![] };
    let sky = if options.sky { sky(&field, &queries, &name)? } else { vec![] };
    report.stats.count("queries", light.len() as u64);
    write_text(&options.output.path, |output| {
        light.iter().enumerate().try_for_each(|(i, c)| {
            let shares = shares.get(i).map_or("", String::as_str);
            let sky = sky.get(i).map_or("", String::as_str);
            writeln!(output, "{} {} {}{sky}{shares}", c.x, c.y, c.z)
        })
    })?;
    report.finish()
}

/// Position and unit normal of a line; the normal is 0 if the line has none.
fn query(&[x, y, z, nx, ny, nz]: &[f64; 6]) -> (DVec3, Vec3) {
    (DVec3::new(x, y, z), DVec3::new(nx, ny, nz).normalize_or_zero().as_vec3())
}

fn has_normal(row: &[f64; 6]) -> Result<(), String> {
    if query(row).1 == Vec3::ZERO {
        Err("nx, ny and nz are 0, which is no normal".to_owned())
    } else {
        Ok(())
    }
}

fn broken(error: ProbeError) -> CliError {
    CliError::Failed(error.to_string())
}

/// For each query how much of the sky is seen.
fn sky(field: &Field, queries: &[(DVec3, Vec3)], name: &str) -> Result<Vec<String>, CliError> {
    let mut hint = Hint::default();
    let unknown =
        || InputError::of_file(name, "`sky` is missing: these probes do not know how much of it they see");
    let mut one = |&(position, normal): &(DVec3, Vec3)| {
        let share = field.sky_share(position, normal, &mut hint).map_err(broken)?;
        let share = share.ok_or_else(|| unknown().with_help("bake them with `pointillist probe bake`"))?;
        Ok(format!(" {share}"))
    };
    queries.iter().map(&mut one).collect()
}

/// For each query ` number:share` of the probes that light it, the largest first.
fn shares(field: &Field, queries: &[(DVec3, Vec3)], numbers: &[usize]) -> Result<Vec<String>, ProbeError> {
    let mut hint = Hint::default();
    let mut one = |&(position, normal): &(DVec3, Vec3)| {
        let mut shares = field.surface_shares(position, normal, &mut hint)?;
        shares.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        Ok(shares.iter().map(|(probe, share)| format!(" {}:{share:.4}", numbers[*probe as usize])).collect())
    };
    queries.iter().map(&mut one).collect()
}
