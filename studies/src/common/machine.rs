//! Results of every machine in a folder of its own: figures of one are not replaced by those of another.

use super::provenance::processor;
use std::path::{Path, PathBuf};
use std::{fs, io};

/// Names the machine whose figures the READMEs quote.
const REFERENCE: &str = "machine.txt";

/// Where this machine's results go: into `results` itself on the machine that its `machine.txt` names, and else into a folder in it.
pub(crate) fn results_folder(results: &Path) -> io::Result<PathBuf> {
    folder_of(&processor(), results)
}

fn folder_of(machine: &str, results: &Path) -> io::Result<PathBuf> {
    let reference = results.join(REFERENCE);
    match fs::read_to_string(&reference) {
        Ok(named) if named.trim() == machine => return Ok(results.to_owned()),
        Ok(_) => {}
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            fs::create_dir_all(results)?;
            fs::write(reference, format!("{machine}\n"))?;
            return Ok(results.to_owned());
        }
        Err(error) => return Err(error),
    }
    let letters =
        machine.chars().map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { ' ' });
    let words: Vec<String> = letters.collect::<String>().split_whitespace().map(str::to_owned).collect();
    let folder = results.join("on").join(words.join("-"));
    fs::create_dir_all(&folder)?;
    Ok(folder)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_machine_has_a_folder_of_its_own() -> io::Result<()> {
        let results = std::env::temp_dir().join(format!("results-of-machines-{}", std::process::id()));
        assert_eq!(folder_of("2 cores of A", &results)?, results);
        assert_eq!(folder_of("2 cores of A", &results)?, results);
        let other = folder_of("16 cores of B(R) @ 2.5GHz", &results)?;
        assert_eq!(other, results.join("on/16-cores-of-b-r-2-5ghz"));
        assert!(other.is_dir());
        assert_eq!(fs::read_to_string(results.join(REFERENCE))?, "2 cores of A\n");
        fs::remove_dir_all(results)
    }
}
