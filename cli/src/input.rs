//! Opens inputs: a file, or standard input for `-`.

use crate::input_error::InputError;
use crate::memory;
use flate2::read::GzDecoder;
use std::io::Read as _;
use std::path::Path;
use std::sync::OnceLock;

/// What messages call standard input.
pub const STANDARD_INPUT: &str = "standard input";

/// All of standard input, once it was asked for. Kept, because some files are looked at twice: for what they are, and for what is in them.
static BYTES: OnceLock<Result<Vec<u8>, String>> = OnceLock::new();

/// Whether a path stands for standard input, or for standard output.
pub fn is_standard(path: &Path) -> bool {
    path == Path::new("-")
}

/// What messages call an input.
pub fn name_of(path: &Path) -> String {
    if is_standard(path) { STANDARD_INPUT.to_owned() } else { path.display().to_string() }
}

/// Standard input to its end.
///
/// # Errors
/// It cannot be read, or does not fit into memory.
pub fn standard() -> Result<&'static [u8], InputError> {
    let read = || {
        memory::read_to_end(std::io::stdin().lock(), 0, "its bytes take").map_err(|error| error.to_string())
    };
    match BYTES.get_or_init(read) {
        Ok(bytes) => Ok(bytes),
        Err(error) => Err(InputError::of_file(STANDARD_INPUT, format!("cannot be read: {error}"))),
    }
}

/// The bytes of a file, or of standard input for `-`.
///
/// # Errors
/// It cannot be read.
pub fn read(path: &Path) -> Result<Vec<u8>, InputError> {
    if is_standard(path) {
        return standard().map(<[u8]>::to_vec);
    }
    memory::read(path).map_err(|error| cannot_read(&path.display().to_string(), &error))
}

/// Refuses a file without any byte, of a kind that always has some.
///
/// # Errors
/// It is empty.
pub fn not_empty(name: &str, bytes: &[u8]) -> Result<(), InputError> {
    if !bytes.is_empty() {
        return Ok(());
    }
    let error = InputError::of_file(name, "the file is empty");
    Err(error.with_help("what should have written it may have failed; get or write it again"))
}

/// A file that cannot be opened or read.
pub fn cannot_read(name: &str, error: &std::io::Error) -> InputError {
    // JSON in the place of the name of a file.
    let help = match name.starts_with(['{', '[']) {
        true => "a file is named here; text goes in by standard input: echo '…' | pointillist COMMAND",
        false => "check the path; it is taken from the folder you are in",
    };
    InputError::of_file(name, format!("cannot be read: {error}")).with_help(help)
}

/// What kind of file this is, as the end of a name in lower case: of standard input by its content.
///
/// # Errors
/// Standard input cannot be read.
pub fn kind_of(path: &Path) -> Result<String, InputError> {
    if is_standard(path) {
        return standard().map(|bytes| kind_of_content(bytes).to_owned());
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
    let kind =
        if name.ends_with(".ply.gz") { "ply.gz" } else { name.rsplit_once('.').map_or("", |(_, end)| end) };
    Ok(kind.to_owned())
}

/// What begins each kind of file that is known by its first bytes.
const MARKS: [(&[u8], &str); 11] = [
    (b"ply\n", "ply"),
    (b"ply\r", "ply"),
    (b"glTF", "glb"),
    (b"LASF", "las"),
    (b"ASTM-E57", "e57"),
    (b"\x76\x2f\x31\x01", "exr"),
    (b"\x89PNG", "png"),
    (b"\xff\xd8\xff", "jpg"),
    (b"#?RADIANCE", "hdr"),
    (b"#?RGBE", "hdr"),
    (b"\x93PROBES", "probes"),
];

/// First words of the lines of an OBJ.
const OBJ: [&str; 9] = ["v", "vn", "vt", "f", "o", "g", "s", "mtllib", "usemtl"];
/// First words of the lines of a Stanford `.conf`.
const CONF: [&str; 3] = ["bmesh", "mesh", "camera"];

fn kind_of_content(bytes: &[u8]) -> &'static str {
    if let Some((_, kind)) = MARKS.iter().find(|(mark, _)| bytes.starts_with(mark)) {
        return kind;
    }
    if bytes.starts_with(b"\x1f\x8b") {
        let mut head = [0; 3];
        let is_ply = GzDecoder::new(bytes).read_exact(&mut head).is_ok() && head == *b"ply";
        return if is_ply { "ply.gz" } else { "gz" };
    }
    let lines = bytes.split(|&b| b == b'\n').map(|line| String::from_utf8_lossy(line).trim().to_owned());
    let Some(line) = lines.into_iter().find(|line| !line.is_empty() && !line.starts_with('#')) else {
        return "toml";
    };
    let mut words = line.split([' ', '\t', ',', ';']).filter(|word| !word.is_empty());
    let first = words.next().unwrap_or_default();
    // `v = 1` is TOML.
    let is_key = words.next().is_none_or(|second| second.starts_with('='));
    match first {
        _ if line.starts_with('{') => "json",
        _ if first.parse::<f64>().is_ok() => "xyz",
        // The names of columns, as CSV has them.
        "x" | "X" | "\"x\"" | "\"X\"" if !is_key => "xyz",
        _ if !is_key && OBJ.contains(&first) => "obj",
        _ if !is_key && CONF.contains(&first) => "conf",
        _ => "toml",
    }
}

#[cfg(test)]
mod tests {
    use super::kind_of_content;

    #[test]
    fn content_says_what_it_is() {
        for (text, kind) in [
            ("ply\nformat ascii 1.0\n", "ply"),
            ("# made by hand\n\nv 0 0 0\n", "obj"),
            ("mtllib a.mtl\n", "obj"),
            ("bmesh a.ply 0 0 0 0 0 0 1\n", "conf"),
            ("0.5 -1e3 7\n", "xyz"),
            ("1,2,3\n", "xyz"),
            ("X,Y,Z,R,G,B\n", "xyz"),
            ("x = 1\n", "toml"),
            ("  {\"camera\": {}}", "json"),
            ("# a scene\n[camera]\n", "toml"),
            ("v = 1\n", "toml"),
            ("", "toml"),
        ] {
            assert_eq!(kind_of_content(text.as_bytes()), kind, "{text:?}");
        }
    }
}
