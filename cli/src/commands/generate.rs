//! `completions` and `man`.

use super::report::write_text;
use crate::error::CliError;
use crate::image_io::write_atomically;
use crate::options::Cli;
use clap::CommandFactory as _;
use clap_complete::Shell;
use std::path::Path;

pub(super) fn completions(shell: Shell) -> Result<(), CliError> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "pointillist", &mut script);
    write_text(Path::new("-"), |output| output.write_all(&script))
}

pub(super) fn man(folder: Option<&Path>) -> Result<(), CliError> {
    let mut command = Cli::command();
    command.build();
    let Some(folder) = folder else {
        let page = page(command)?;
        return write_text(Path::new("-"), |output| output.write_all(&page));
    };
    let mut pages = vec![("pointillist.1".to_owned(), command.clone())];
    for sub in command.get_subcommands().filter(|sub| sub.get_name() != "help") {
        let name = format!("pointillist-{}", sub.get_name());
        // clap wants names that live as long as the program; these are eight, once.
        pages.push((format!("{name}.1"), sub.clone().name(&*name.leak())));
    }
    std::fs::create_dir_all(folder)
        .map_err(|error| CliError::writing(&folder.display().to_string(), &error))?;
    for (file, command) in pages {
        let page = page(command)?;
        let path = folder.join(file);
        write_atomically(&path, |output| std::io::Write::write_all(output, &page))
            .map_err(|error| CliError::writing(&path.display().to_string(), &error))?;
    }
    Ok(())
}

fn page(command: clap::Command) -> Result<Vec<u8>, CliError> {
    let mut page = Vec::new();
    clap_mangen::Man::new(command)
        .render(&mut page)
        .map_err(|error| CliError::Failed(format!("the manual page cannot be made: {error}")))?;
    Ok(page)
}
