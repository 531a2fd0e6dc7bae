//! `probe capture`.

use super::photographs::{Exposed, merged, overexposed, project_one, response};
use super::{check_output, write};
use crate::commands::Report;
use crate::commands::report::name_of_output;
use crate::error::CliError;
use crate::input_error::InputError;
use crate::options::CaptureOptions;
use crate::probe_io::{CaptureEntry, CaptureList, ProbeEntry, ProbeFile, read_captures};
use glam::{DMat3, DVec3};
use pointillist_sh::{Brackets, Response, Rotation, Sh, ShError};

pub(super) fn run(options: &CaptureOptions) -> Result<(), CliError> {
    let list = read_captures(&options.list)?;
    let images = list.captures.iter().map(|entry| list.path_of(entry));
    let inputs: Vec<_> = std::iter::once(options.list.clone()).chain(images).collect();
    let report = Report::new(&options.common)?.reading(&inputs)?.writing([&options.output])?;
    check_output(&options.output)?;
    let response = response(&options.response)?;
    let capture = Capture { list: &list, response, options, report: &report };
    let mut file = ProbeFile {
        order: Some(options.order.into()),
        what: Some("total".to_owned()),
        ..ProbeFile::default()
    };
    for brackets in list.brackets() {
        let sh = capture.sh(&brackets)?;
        let first = &list.captures[brackets[0]];
        file.probes.push(ProbeEntry {
            name: brackets.iter().find_map(|&i| list.captures[i].name.clone()),
            sh: Some(sh.coefficients().iter().map(DVec3::to_array).collect()),
            ..ProbeEntry::at(first.position())
        });
    }
    report.stats.count("pictures", list.captures.len() as u64);
    report.stats.count("probes", file.probes.len() as u64);
    report.stats.stage("write", || write(&options.output, &file))?;
    report.note(&format!(
        "{}: {} probes of {} pictures",
        name_of_output(&options.output),
        file.probes.len(),
        list.captures.len()
    ));
    report.finish()
}

struct Capture<'a> {
    list: &'a CaptureList,
    response: Response,
    options: &'a CaptureOptions,
    report: &'a Report<'a>,
}

impl Capture<'_> {
    /// What the pictures of one position hold, in world axes.
    fn sh(&self, indices: &[usize]) -> Result<Sh, CliError> {
        let Self { list, options, report, .. } = self;
        let mut brackets = Brackets::new();
        let mut size = None;
        for &index in indices {
            let entry = &list.captures[index];
            let picture = report.stats.stage("load", || Exposed::read(&list.path_of(entry)))?;
            let found = picture.size();
            let first = *size.get_or_insert(found);
            if found != first {
                let ([w, h], [fw, fh]) = (found, first);
                let other = &list.captures[indices[0]].image;
                let message = format!(
                    "`captures[{index}].image` `{}` is {w}×{h}, and `{other}` of the same position is {fw}×{fh}",
                    entry.image
                );
                return Err(list.error(message).with_help("brackets are pictures of one size").into());
            }
            let added = picture.add_to(&mut brackets, &self.response, entry.exposure);
            added.map_err(|error| self.refused(index, &error))?;
        }
        let (image, clipping) = merged(&brackets, size.unwrap_or_default());
        let names: Vec<&str> = indices.iter().map(|&i| list.captures[i].image.as_str()).collect();
        if let Some(warning) = overexposed(&names.join(", "), clipping) {
            report.warn(&warning);
        }
        let refused = |error: ShError| CliError::from(self.refused(indices[0], &error));
        let project = || project_one(&image, options.order.into(), options.weights.weights());
        let sh = report.stats.stage("project", project).map_err(refused)?;
        let turn = Rotation::new(options.order.into(), world_from_image(&list.captures[indices[0]]));
        let sh = turn.and_then(|turn| turn.of(&sh)).map_err(refused)?;
        Ok(if options.dering { sh.deringed() } else { sh })
    }

    fn refused(&self, index: usize, error: &ShError) -> InputError {
        let image = &self.list.captures[index].image;
        self.list.error(format!("`captures[{index}].image` `{image}`: {error}"))
    }
}

/// How a picture was held: turned about x, then y, then z.
fn world_from_image(entry: &CaptureEntry) -> DMat3 {
    let [x, y, z] = entry.rotate.map(f64::to_radians);
    DMat3::from_rotation_z(z) * DMat3::from_rotation_y(y) * DMat3::from_rotation_x(x)
}
