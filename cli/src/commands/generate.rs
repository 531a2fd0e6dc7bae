//! `completions` and `man`.

use super::report::write_text;
use crate::error::CliError;
use crate::image_io::write_atomically;
use crate::options::Cli;
use clap::builder::Resettable;
use clap::{Command, CommandFactory as _};
use clap_complete::Shell;
use clap_mangen::Man;
use clap_mangen::roff::{Roff, roman};
use std::io;
use std::path::Path;

pub(super) fn completions(shell: Shell) -> Result<(), CliError> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "pointillist", &mut script);
    write_text(Path::new("-"), |output| output.write_all(&script))
}

pub(super) fn man(folder: Option<&Path>) -> Result<(), CliError> {
    // Every page would have a neighbour `…-help(1)` that says nothing.
    let mut command = Cli::command().disable_help_subcommand(true);
    command.build();
    let failed = |error| CliError::Failed(format!("the manual page cannot be made: {error}"));
    let Some(folder) = folder else {
        let page = page(command).map_err(failed)?;
        return write_text(Path::new("-"), |output| output.write_all(&page));
    };
    std::fs::create_dir_all(folder)
        .map_err(|error| CliError::writing(&folder.display().to_string(), &error))?;
    let mut commands = vec![command];
    while let Some(command) = commands.pop() {
        commands.extend(command.get_subcommands().cloned());
        let path = folder.join(Man::new(command.clone()).get_filename());
        let page = page(command).map_err(failed)?;
        write_atomically(&path, |output| io::Write::write_all(output, &page))
            .map_err(|error| CliError::writing(&path.display().to_string(), &error))?;
    }
    Ok(())
}

/// The page of a command. What follows the options in `--help`, examples mostly, keeps its lines: as text of a manual page they would be
/// filled into a paragraph, and no longer be commands.
fn page(command: Command) -> io::Result<Vec<u8>> {
    let after = command.get_after_long_help().or_else(|| command.get_after_help()).map(ToString::to_string);
    let mut page = Vec::new();
    Man::new(command.after_help(Resettable::Reset).after_long_help(Resettable::Reset)).render(&mut page)?;
    let Some(after) = after else { return Ok(page) };
    let examples = after.split_once('\n').filter(|(first, _)| first.starts_with("Example"));
    let (title, lines) = examples.map_or(("EXIT STATUS", after.as_str()), |(_, lines)| ("EXAMPLES", lines));
    let mut roff = Roff::new();
    roff.control("SH", [title]).control("nf", []);
    for line in lines.lines() {
        roff.text([roman(line)]);
    }
    roff.control("fi", []);
    roff.to_writer(&mut page)?;
    Ok(page)
}
