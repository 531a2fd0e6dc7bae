//! `merge`.

use super::Report;
use super::probe::{is_probe_file, merge_probes};
use super::render::{OutputFormat, write_display, write_exr};
use crate::error::CliError;
use crate::image_io::{Channel, ExrFile, Frame, Stamp};
use crate::input::{self, is_standard, name_of};
use crate::input_error::InputError;
use crate::name_pattern;
use crate::options::MergeOptions;
use exr::prelude::FlatSamples;
use std::path::Path;

/// A part and the name of its file.
struct Part {
    name: String,
    file: ExrFile,
    stamp: Stamp,
}

pub(super) fn run(options: &MergeOptions) -> Result<(), CliError> {
    let options = &with_numbers(options)?;
    let report = Report::new(&options.common)?.reading(&options.parts)?.writing([&options.output])?;
    let is_text = is_standard(&options.output) && options.parts.iter().all(|part| is_probe_file(part));
    let holds_probes = is_text || is_probe_file(&options.output);
    let format = if holds_probes { None } else { Some(OutputFormat::of(&options.output)?) };
    if let Some(part) = options.parts.iter().find(|part| !is_standard(part) && !part.exists()) {
        return Err(CliError::Parts(format!("part {} is missing", part.display())));
    }
    format.map_or(Ok(()), |format| format.check_display(&options.display))?;
    let Some(format) = format else { return merge_probes(options, &report) };
    let parts = options.parts.iter().map(|path| report.stats.stage("load", || read_part(path)));
    let mut parts = parts.collect::<Result<Vec<_>, _>>()?;
    report.stats.count("parts", parts.len() as u64);
    parts.sort_by_key(|part| (part.file.window.y0, part.file.window.x0));
    check_same_job(&parts)?;
    check_cover(&parts)?;
    format.check_sides(parts[0].stamp.region)?;
    let whole = report.stats.stage("merge", || join(&parts));
    report.stats.stage("write", || match format {
        OutputFormat::Exr => write_exr(&options.output, whole),
        OutputFormat::Png | OutputFormat::Jpeg => {
            let background = parts[0].stamp.background;
            write_display(&options.output, format, &frame_of(&whole), background, &options.display)
        }
    })?;
    report.note(&format!("{} parts joined in {}", parts.len(), options.output.display()));
    report.finish()
}

/// The options with `--tiles` and `--frame` put into the names.
fn with_numbers(options: &MergeOptions) -> Result<MergeOptions, CliError> {
    let numbered = |path: &Path, kind: &str, number: Option<u32>, option: &str| {
        let name = path.display();
        let wrong = |message: String| CliError::Usage(format!("{name}: {message}"));
        match (name_pattern::has(path, kind).map_err(wrong)?, number) {
            (true, None) => Err(wrong(format!("{{{kind}}} needs {option} N"))),
            (true, Some(number)) => name_pattern::fill(path, kind, number).map_err(wrong),
            (false, _) => Ok(path.to_path_buf()),
        }
    };
    let with_frame = |path: &Path| numbered(path, "frame", options.frame, "--frame");
    let mut parts = vec![];
    for part in &options.parts {
        let has_tile = name_pattern::has(part, "tile").unwrap_or(true);
        let count = if has_tile { options.tiles.unwrap_or(1) } else { 1 };
        for tile in 1..=count {
            let tile = options.tiles.map(|_| tile);
            parts.push(with_frame(&numbered(part, "tile", tile, "--tiles")?)?);
        }
    }
    if options.tiles.is_some() && parts.len() == options.parts.len() && options.tiles != Some(1) {
        let message =
            "--tiles counts the files that a name with {tile} stands for, and there is no such name";
        return Err(CliError::Usage(message.to_owned()));
    }
    Ok(MergeOptions { parts, output: with_frame(&options.output)?, ..options.clone() })
}

fn read_part(path: &Path) -> Result<Part, CliError> {
    let name = name_of(path);
    let fault = |message: String| {
        let error = InputError::of_file(&name, message);
        CliError::Input(error.with_help(
            "parts are the EXR files of `--tile`, as in `render scene.toml --tile 0/4 -o part0.exr`",
        ))
    };
    let bytes = input::read(path)?;
    input::not_empty(&name, &bytes)?;
    let mut file = ExrFile::read(&bytes).map_err(|error| fault(format!("cannot be decoded: {error}")))?;
    let stamp = file.stamp.take();
    let stamp =
        stamp.ok_or_else(|| CliError::Parts(format!("{name} was not written by `pointillist render`")))?;
    if stamp.unfinished {
        let message = "holds the finished tiles of a run that was interrupted; run that `render` again to finish the part";
        return Err(CliError::Parts(format!("{name} {message}")));
    }
    Ok(Part { name, file, stamp })
}

/// All parts are of one picture, drawn with the same options.
fn check_same_job(parts: &[Part]) -> Result<(), CliError> {
    let first = &parts[0];
    for part in parts {
        let same = part.stamp.fingerprint == first.stamp.fingerprint
            && part.stamp.version == first.stamp.version
            && part.stamp.region == first.stamp.region
            && part.file.size == first.file.size;
        let kinds = |part: &Part| -> Vec<_> {
            part.file.channels.iter().map(|c| (c.name.clone(), std::mem::discriminant(&c.samples))).collect()
        };
        if !same || kinds(part) != kinds(first) {
            return Err(CliError::Parts(format!(
                "{} and {} are not parts of the same picture: scene, options or version differ",
                first.name, part.name
            )));
        }
    }
    Ok(())
}

/// The parts, sorted by row, cover the region without gap or overlap.
fn check_cover(parts: &[Part]) -> Result<(), CliError> {
    let region = parts[0].stamp.region;
    let mut next = region.y0;
    let mut before: Option<&Part> = None;
    for part in parts {
        let window = part.file.window;
        if (window.x0, window.x1) != (region.x0, region.x1) || window.y1 > region.y1 {
            return Err(CliError::Parts(format!("{} does not fit into the picture {region}", part.name)));
        }
        if window.y0 < next {
            let other = before.map_or("another part", |part| part.name.as_str());
            return Err(CliError::Parts(format!(
                "{other} and {} overlap from row {} on",
                part.name, window.y0
            )));
        }
        if window.y0 > next {
            return Err(gap(next, window.y0));
        }
        next = window.y1;
        before = Some(part);
    }
    if next < region.y1 { Err(gap(next, region.y1)) } else { Ok(()) }
}

fn gap(from: u32, to: u32) -> CliError {
    CliError::Parts(format!("a part is missing: nothing covers rows {from} to {}", to - 1))
}

/// Parts are bands of full rows, so the whole is their samples one after the other.
fn join(parts: &[Part]) -> ExrFile {
    let first = &parts[0];
    let channels = first.file.channels.iter().enumerate().map(|(index, channel)| {
        let planes = parts.iter().map(|part| &part.file.channels[index].samples);
        let samples = match channel.samples {
            FlatSamples::F16(_) => FlatSamples::F16(
                planes
                    .flat_map(|plane| if let FlatSamples::F16(s) = plane { s.as_slice() } else { &[] })
                    .copied()
                    .collect(),
            ),
            FlatSamples::F32(_) => FlatSamples::F32(
                planes
                    .flat_map(|plane| if let FlatSamples::F32(s) = plane { s.as_slice() } else { &[] })
                    .copied()
                    .collect(),
            ),
            FlatSamples::U32(_) => FlatSamples::U32(
                planes
                    .flat_map(|plane| if let FlatSamples::U32(s) = plane { s.as_slice() } else { &[] })
                    .copied()
                    .collect(),
            ),
        };
        Channel { name: channel.name.clone(), samples }
    });
    let stamp = Stamp { tile: None, ..first.stamp.clone() };
    ExrFile {
        size: first.file.size,
        window: first.stamp.region,
        channels: channels.collect(),
        stamp: Some(stamp),
        texts: first.file.texts.clone(),
    }
}

/// Only the colours, for a PNG.
fn frame_of(file: &ExrFile) -> Frame {
    let pixels = file.window.pixels() as usize;
    let plane = |name: &str, other: f32| file.plane(name).unwrap_or_else(|| vec![other; pixels]);
    let [r, g, b, a] =
        [("R", 0.0), ("G", 0.0), ("B", 0.0), ("A", 1.0)].map(|(name, other)| plane(name, other));
    let color = (0..pixels).map(|i| [r[i], g[i], b[i], a[i]]).collect();
    let window = file.window;
    Frame { size: file.size, window, color, depth: Vec::new(), layers: Vec::new() }
}
