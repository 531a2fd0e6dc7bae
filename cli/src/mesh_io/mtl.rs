//! MTL.

use crate::input_error::InputError;
use glam::Vec3;
use std::io::Cursor;

/// A material as its MTL has it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MtlMaterial {
    /// After `newmtl`.
    pub name: String,
    /// `Kd`.
    pub diffuse: Option<Vec3>,
    /// `Ks`.
    pub specular: Option<Vec3>,
    /// `Ns`.
    pub shininess: Option<f32>,
    /// `Ke`.
    pub emission: Option<Vec3>,
    /// `d`, or 1 − `Tr`.
    pub opacity: Option<f32>,
    /// `illum`.
    pub illumination: Option<u8>,
    /// `map_Kd` with its line.
    pub diffuse_map: Option<(String, usize)>,
    /// `map_d` with its line.
    pub opacity_map: Option<(String, usize)>,
    /// Whether a map had `-clamp on`.
    pub clamp: bool,
    /// Keys that stand for something we do not draw, as they are written.
    pub ignored: Vec<String>,
}

/// Keys that change the picture where they are understood; here they are ignored with a warning.
const NOT_YET: [&str; 13] = [
    "map_bump", "map_Bump", "bump", "map_Ks", "map_Ke", "map_Ns", "map_Ka", "norm", "disp", "decal", "refl",
    "map_Pr", "map_Pm",
];

/// Reads an MTL; `name` is how messages call it.
///
/// # Errors
///
/// A line that cannot be read, or a value that makes no sense: with the line.
pub fn read_mtl(name: &str, bytes: &[u8]) -> Result<Vec<MtlMaterial>, InputError> {
    let plain = check(name, bytes)?;
    let (materials, _) = tobj::load_mtl_buf(&mut Cursor::new(plain.as_bytes()))
        .map_err(|error| InputError::of_file(name, format!("not an MTL file: {error}")))?;
    let line_of = |file: &str| {
        let position = plain.lines().position(|line| line.trim_end().ends_with(file));
        position.map_or(1, |index| index + 1)
    };
    Ok(materials.into_iter().map(|material| convert(material, line_of)).collect())
}

/// Checks every line that the parser could stumble over, and gives it back as the parser likes it: valid UTF-8, no
/// comments after values, one line for each line.
fn check(name: &str, bytes: &[u8]) -> Result<String, InputError> {
    let mut plain = String::with_capacity(bytes.len());
    let mut named = false;
    for (index, line) in bytes.split(|&b| b == b'\n').enumerate() {
        let text = String::from_utf8_lossy(line);
        let trimmed = text.trim();
        let fault = |message: String| InputError::in_line(name, bytes, index + 1, message);
        let mut words = trimmed.split('#').next().unwrap_or_default().split_whitespace();
        let keyword = words.next().unwrap_or_default();
        let values: Vec<&str> = words.collect();
        if keyword.is_empty() {
            plain.push('\n');
            continue;
        }
        if keyword == "newmtl" {
            named = true;
            if values.is_empty() {
                return Err(fault("`newmtl` without a name".to_owned()));
            }
        } else if !named {
            return Err(fault(format!("`{keyword}` before any `newmtl`")).with_help("is this an MTL file?"));
        }
        match keyword {
            "Ka" | "Kd" | "Ks" | "Ke" | "Tf" => plain.push_str(&color_line(keyword, &values).map_err(fault)?),
            "Ns" | "Ni" | "d" | "Tr" => plain.push_str(&number_line(keyword, &values).map_err(fault)?),
            "illum" => {
                let value = values.first().and_then(|word| word.parse::<f64>().ok()).map(|n| n as u8);
                let value = value.ok_or_else(|| fault("`illum` needs a number".to_owned()))?;
                plain.push_str(&format!("illum {value}"));
            }
            keyword if keyword.starts_with("map_") || NOT_YET.contains(&keyword) => {
                if values.is_empty() {
                    return Err(fault(format!("`{keyword}` without a file name")));
                }
                // Not cut at #, which may be part of a file name.
                plain.push_str(&format!("{keyword} {}", trimmed[keyword.len()..].trim()));
            }
            "newmtl" => plain.push_str(&format!("newmtl {}", trimmed[keyword.len()..].trim())),
            _ => plain.push_str(trimmed),
        }
        plain.push('\n');
    }
    Ok(plain)
}

/// Three numbers, or one for all three.
fn color_line(keyword: &str, values: &[&str]) -> Result<String, String> {
    if matches!(values.first(), Some(&("spectral" | "xyz"))) {
        return Err(format!("`{keyword} {}` is not supported; give red, green and blue", values[0]));
    }
    let numbers = values.iter().take(3).map(|word| finite(keyword, word)).collect::<Result<Vec<_>, _>>()?;
    match numbers[..] {
        [v] => Ok(format!("{keyword} {v} {v} {v}")),
        [r, g, b] => Ok(format!("{keyword} {r} {g} {b}")),
        _ => Err(format!("`{keyword}` needs three numbers, found {}", numbers.len())),
    }
}

fn number_line(keyword: &str, values: &[&str]) -> Result<String, String> {
    // `d -halo 0.5`: the number is the last word.
    let word = values.iter().find(|word| !word.starts_with("-h"));
    let value = finite(keyword, word.ok_or_else(|| format!("`{keyword}` needs a number"))?)?;
    if keyword != "Ns" && keyword != "Ni" && !(0.0..=1.0).contains(&value) {
        return Err(format!("`{keyword}` is {value}; it must be from 0 to 1"));
    }
    // 1 − Tr in the place of Tr, which the parser does not know.
    if keyword == "Tr" { Ok(format!("d {}", 1.0 - value)) } else { Ok(format!("{keyword} {value}")) }
}

fn finite(keyword: &str, word: &str) -> Result<f32, String> {
    let number = word.parse::<f32>().ok().filter(|n| n.is_finite() && *n >= 0.0);
    number.ok_or_else(|| format!("`{keyword}`: `{word}` is not a number from 0 up"))
}

fn convert(material: tobj::Material, line_of: impl Fn(&str) -> usize) -> MtlMaterial {
    let color = |value: Option<[f64; 3]>| value.map(|rgb| Vec3::from_array(rgb.map(|n| n as f32)));
    let map =
        |value: &Option<String>| value.as_deref().map(|text| (file_name(text).to_owned(), line_of(text)));
    let emission = material.emissive;
    let mut ignored: Vec<String> = NOT_YET
        .iter()
        .filter(|key| material.unknown_param.contains_key(**key))
        .map(|&key| key.to_owned())
        .collect();
    let known = [
        ("map_bump", &material.normal_texture),
        ("map_Ks", &material.specular_texture),
        ("map_Ns", &material.shininess_texture),
    ];
    ignored.extend(known.iter().filter(|(_, value)| value.is_some()).map(|(key, _)| (*key).to_owned()));
    let clamps = |text: &Option<String>| text.as_deref().is_some_and(|text| text.contains("-clamp on"));
    MtlMaterial {
        diffuse: color(material.diffuse),
        specular: color(material.specular),
        shininess: material.shininess.map(|n| n as f32),
        emission: color(emission),
        opacity: material.dissolve.map(|n| n as f32),
        illumination: material.illumination_model,
        diffuse_map: map(&material.diffuse_texture),
        opacity_map: map(&material.dissolve_texture),
        clamp: clamps(&material.diffuse_texture),
        ignored,
        name: material.name,
    }
}

/// The file name after options like `-s 1 1 1` and `-clamp on`; names may hold spaces.
fn file_name(text: &str) -> &str {
    let mut rest = text.trim();
    while let Some(option) = rest.strip_prefix('-') {
        let (name, mut after) = option.split_once(char::is_whitespace).unwrap_or((option, ""));
        let most = match name {
            "o" | "s" | "t" => 3,
            "mm" => 2,
            _ => 1,
        };
        for taken in 0..most {
            let next = after.trim_start();
            let (word, following) = next.split_once(char::is_whitespace).unwrap_or((next, ""));
            // The second and third number of `-s u v w` may be left out.
            if following.is_empty() || (taken > 0 && word.parse::<f64>().is_err()) {
                break;
            }
            after = following;
        }
        let next = after.trim_start();
        if next.is_empty() || next.len() >= rest.len() {
            break;
        }
        rest = next;
    }
    rest
}
