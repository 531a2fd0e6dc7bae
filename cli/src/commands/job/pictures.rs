//! Pictures: a task for each tile of each frame, then one that joins the tiles of a frame.

use super::{count, file, job, named_from, program, step, template::Node, words};
use crate::commands::Report;
use crate::commands::render::{OutputFormat, numbered};
use crate::error::CliError;
use crate::image_io::Bits;
use crate::name_pattern;
use crate::options::{Command, FrameRange, JobOptions, RenderOptions, parse};
use crate::scene;
use std::path::PathBuf;

pub(super) fn template(options: &JobOptions, report: &Report<'_>) -> Result<Node, CliError> {
    let render = render_options(options)?;
    let frames = match (options.frames, render.turntable) {
        (Some(frames), _) => Some(frames),
        (None, Some(views)) => Some(FrameRange { first: 0, last: views - 1 }),
        (None, None) => None,
    };
    let result = result(options, frames)?;
    let format = OutputFormat::of(&result)?;
    format.check(!render.layers.is_empty(), &render.picture)?;
    check_together(&render)?;
    let most = check_scene(options, &render, report)?;
    let [scene, result] = [&options.scene, &result].map(|path| named_from(&options.output, path));
    let mut parameters = vec![
        file("Scene", "IN", &scene?, "The scene; tasks find the files that it names where it says"),
        file(
            "Output",
            "OUT",
            &result?,
            "The picture: .exr, .png or .jpg, with {frame} where there are several",
        ),
        count("Tiles", options.tiles, most, "Tasks for each frame"),
    ];
    let mut entries = vec![
        ("name", Node::text("Frames")),
        ("type", Node::text("STRING")),
        ("default", Node::text(&frames.map_or_else(|| "0".to_owned(), |f| f.to_string()))),
        ("description", Node::text("Frames to draw, such as 1-24 or 1-100:10")),
    ];
    if frames.is_none() {
        // The name of its picture has no place for a number.
        entries.push(("allowedValues", Node::List(words(&["0"]))));
    }
    parameters.push(Node::Map(entries));
    parameters.push(program());
    let frame = ("Frame", "{{Param.Frames}}");
    let steps = vec![
        step(
            "Tiles",
            None,
            &[frame, ("Tile", "1-{{Param.Tiles}}")],
            tile_arguments(options, &render, format),
        ),
        step("Merge", Some("Tiles"), &[frame], merge_arguments(&render, format)),
    ];
    Ok(job(options, parameters, steps))
}

/// Options about the numbers of the whole picture's file: its tiles are EXR.
const OF_MERGE: [&str; 3] = ["--exposure", "--bits", "--quality"];

/// Refuses what tasks without a terminal cannot do, and what no two tasks would do alike.
fn check_together(render: &RenderOptions) -> Result<(), CliError> {
    let given = [
        ("--watch", render.watch),
        ("--preview", render.preview),
        ("--dry-run", render.dry_run),
        ("--time-budget", render.time_budget.is_some()),
        ("--bg with --exposure", render.picture.bg.is_some() && render.picture.display.exposure != 0.0),
    ];
    match given.into_iter().find(|(_, given)| *given) {
        Some((name, _)) => {
            Err(CliError::Usage(format!("options for `render`: {name} is not for the tasks of a job")))
        }
        None => Ok(()),
    }
}

/// What the tasks are asked for besides what the template says.
fn render_options(options: &JobOptions) -> Result<RenderOptions, CliError> {
    let mut line = vec!["pointillist".to_owned(), "render".to_owned()];
    line.push(options.scene.to_string_lossy().into_owned());
    line.extend_from_slice(&options.more);
    let wrong = |message: String| CliError::Usage(format!("options for `render`: {message}"));
    let Command::Render(render) = parse(&line).map_err(wrong)? else {
        unreachable!("the line is one of `render`");
    };
    let taken = [
        ("--tile", render.camera.tile.is_some()),
        ("--frames", render.frames.is_some()),
        ("-o", render.output.is_some()),
        ("--stats", render.common.stats.is_some()),
        ("--progress", render.common.progress.is_some()),
    ];
    match taken.iter().find(|(_, given)| *given) {
        Some((option, _)) => Err(wrong(format!("{option} is what the template says for each task"))),
        None => Ok(render),
    }
}

fn result(options: &JobOptions, frames: Option<FrameRange>) -> Result<PathBuf, CliError> {
    let Some(result) = &options.result else {
        let own = PathBuf::from(options.scene.with_extension("exr").file_name().unwrap_or_default());
        // Beside the template, wherever that is.
        let own = options.output.parent().map_or(own.clone(), |folder| folder.join(own));
        return Ok(if frames.is_some() { numbered(&own) } else { own });
    };
    let wrong = |message: String| CliError::Usage(format!("--result {}: {message}", result.display()));
    match (name_pattern::has(result, "frame").map_err(wrong)?, frames) {
        (false, Some(frames)) => {
            let example = numbered(result);
            Err(wrong(format!("frames {frames} need {{frame}} in the name, as in {}", example.display())))
        }
        (true, None) => Err(wrong("{frame} is for --frames".to_owned())),
        _ => Ok(result.clone()),
    }
}

/// Reads the scene as the tasks will, so that what is wrong with it is known before a farm is; gives the rows of its picture.
fn check_scene(options: &JobOptions, render: &RenderOptions, report: &Report<'_>) -> Result<u32, CliError> {
    let overrides = render.camera.overrides(&render.set);
    let loaded = report.stats.stage("load", || scene::load(&options.scene, &overrides))?;
    loaded.warnings.iter().for_each(|warning| report.warn(warning));
    if options.frames.is_some() && loaded.motion.is_still() && render.turntable.is_none() {
        report.warn("nothing in the scene moves: all frames are alike");
    }
    let image = &loaded.scene.image;
    let (region, _) = render.camera.windows(image.width, image.height)?;
    if region.height() < options.tiles {
        let message =
            format!("--tiles {}: {} rows cannot be cut into more tiles", options.tiles, region.height());
        return Err(CliError::Usage(message));
    }
    Ok(region.height())
}

fn tile_arguments(options: &JobOptions, render: &RenderOptions, format: OutputFormat) -> Vec<Node> {
    let mut arguments = words(&[
        "render",
        "{{Param.Scene}}",
        "--frames",
        "{{Task.Param.Frame}}",
        "--tile",
        "{{Task.Param.Tile}}of{{Param.Tiles}}",
        "-o",
        "{{Param.Output}}.tile{{Task.Param.Tile}}.exr",
        "--progress",
        "openjd",
    ]);
    if format != OutputFormat::Exr && !render.picture.float {
        // A PNG or JPEG that is drawn at once is made of full floats.
        arguments.extend(words(&["--float"]));
    }
    let mut more = options.more.iter();
    while let Some(word) = more.next() {
        if OF_MERGE.contains(&word.as_str()) {
            // `merge` is asked for these.
            more.next();
        } else if !OF_MERGE.iter().any(|option| word.starts_with(&format!("{option}="))) {
            arguments.push(Node::text(word));
        }
    }
    arguments
}

fn merge_arguments(render: &RenderOptions, format: OutputFormat) -> Vec<Node> {
    let mut arguments = words(&[
        "merge",
        "{{Param.Output}}.tile{tile}.exr",
        "--tiles",
        "{{Param.Tiles}}",
        "--frame",
        "{{Task.Param.Frame}}",
        "-o",
        "{{Param.Output}}",
        "--progress",
        "openjd",
    ]);
    let display = &render.picture.display;
    if format != OutputFormat::Exr && display.exposure != 0.0 {
        arguments.extend(words(&["--exposure", &display.exposure.to_string()]));
    }
    if let Some(bits) = display.bits {
        arguments.extend(words(&["--bits", if bits == Bits::Sixteen { "16" } else { "8" }]));
    }
    if let Some(quality) = display.quality {
        arguments.extend(words(&["--quality", &quality.to_string()]));
    }
    arguments
}
