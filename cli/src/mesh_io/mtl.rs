//! MTL.

use super::names::unquoted;
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
    /// `Ni`.
    pub refraction_index: Option<f32>,
    /// `Tf`.
    pub transmission: Option<Vec3>,
    /// `Pr`.
    pub roughness: Option<f32>,
    /// `Pm`.
    pub metallic: Option<f32>,
    /// The maps by keyword, in the file's order.
    pub maps: Vec<MtlMap>,
    /// Keys that stand for something we do not draw, as they are written.
    pub ignored: Vec<String>,
}

/// A texture as a line names it.
#[derive(Clone, Debug, PartialEq)]
pub struct MtlMap {
    /// `map_Kd`, `map_d`, … with `map_Bump` and `bump` both as `map_bump`.
    pub keyword: &'static str,
    /// The file, after the options.
    pub file: String,
    /// The line, from 1.
    pub line: usize,
    /// Whether it had `-clamp on`.
    pub clamp: bool,
    /// `-bm`: the factor on a bump map's heights.
    pub bump_multiplier: Option<f32>,
    /// `-type`: what kind of reflection map it is.
    pub kind: Option<String>,
}

/// Maps that are understood, and what they are called here.
const MAPS: [(&str, &str); 13] = [
    ("map_Kd", "map_Kd"),
    ("map_Ks", "map_Ks"),
    ("map_Ns", "map_Ns"),
    ("map_Ke", "map_Ke"),
    ("map_d", "map_d"),
    ("map_bump", "map_bump"),
    ("map_Bump", "map_bump"),
    ("bump", "map_bump"),
    ("norm", "norm"),
    ("refl", "refl"),
    ("map_Pr", "map_Pr"),
    ("map_Pm", "map_Pm"),
    ("map_refl", "refl"),
];

/// Keys that change the picture where they are understood; here they are ignored with a warning.
const NOT_YET: [&str; 10] =
    ["map_Ka", "map_Tr", "disp", "decal", "map_disp", "map_aat", "Ps", "Pc", "aniso", "sharpness"];

/// Reads an MTL; `name` is how messages call it.
///
/// # Errors
///
/// A line that cannot be read, or a value that makes no sense: with the line.
pub fn read_mtl(name: &str, bytes: &[u8]) -> Result<Vec<MtlMaterial>, InputError> {
    let (plain, extras) = check(name, bytes)?;
    let (materials, _) = tobj::load_mtl_buf(&mut Cursor::new(plain.as_bytes()))
        .map_err(|_| InputError::of_file(name, "not an MTL file"))?;
    // Neither loses a material that the other has; if ever, maps are missing and nothing is mixed up.
    let extras = extras.into_iter().chain(std::iter::repeat_with(MtlMaterial::default));
    Ok(materials.into_iter().zip(extras).map(|(material, extra)| convert(material, extra)).collect())
}

/// Checks every line that the parser could stumble over, and gives it back as the parser likes it: valid UTF-8, no
/// comments after values. What the parser does not keep comes back beside it, for each material.
fn check(name: &str, bytes: &[u8]) -> Result<(String, Vec<MtlMaterial>), InputError> {
    let mut plain = String::with_capacity(bytes.len());
    let mut extras: Vec<MtlMaterial> = Vec::new();
    for (index, line) in bytes.split(|&b| b == b'\n').enumerate() {
        let text = String::from_utf8_lossy(line);
        let trimmed = text.trim();
        let fault = |message: String| InputError::in_line(name, bytes, index + 1, message);
        let statement = line.split(|&b| b == b'#').next().unwrap_or_default();
        if std::str::from_utf8(statement).is_err() {
            let error = fault("bytes that are not UTF-8 text".to_owned());
            return Err(error.with_help("save the file as UTF-8; is it an MTL file?"));
        }
        let mut words = trimmed.split('#').next().unwrap_or_default().split_whitespace();
        let keyword = words.next().unwrap_or_default();
        let values: Vec<&str> = words.collect();
        if keyword.is_empty() {
            plain.push('\n');
            continue;
        }
        if keyword == "newmtl" {
            if values.is_empty() {
                return Err(fault("`newmtl` without a name".to_owned()));
            }
            extras.push(MtlMaterial::default());
        }
        let Some(extra) = extras.last_mut() else {
            return Err(fault(format!("`{keyword}` before any `newmtl`")).with_help("is this an MTL file?"));
        };
        match keyword {
            "Ka" | "Kd" | "Ks" | "Ke" => plain.push_str(&color_line(keyword, &values).map_err(fault)?),
            "Tf" => extra.transmission = Some(color(keyword, &values).map_err(fault)?),
            "Ns" | "Ni" | "d" | "Tr" => plain.push_str(&number_line(keyword, &values).map_err(fault)?),
            "Pr" => extra.roughness = Some(share(keyword, &values).map_err(fault)?),
            "Pm" => extra.metallic = Some(share(keyword, &values).map_err(fault)?),
            "illum" => {
                let value = values.first().and_then(|word| word.parse::<f64>().ok()).map(|n| n as u8);
                let value = value.ok_or_else(|| fault("`illum` needs a number".to_owned()))?;
                plain.push_str(&format!("illum {value}"));
            }
            keyword if NOT_YET.contains(&keyword) => extra.ignored.push(keyword.to_owned()),
            keyword if keyword.starts_with("map_") || MAPS.iter().any(|(known, _)| *known == keyword) => {
                if values.is_empty() {
                    return Err(fault(format!("`{keyword}` without a file name")));
                }
                // Not cut at #, which may be part of a file name.
                let text = trimmed[keyword.len()..].trim();
                match MAPS.iter().find(|(known, _)| *known == keyword) {
                    Some(&(_, as_known)) => {
                        extra.maps.push(map(as_known, text, index + 1).map_err(fault)?);
                    }
                    None => extra.ignored.push(keyword.to_owned()),
                }
            }
            "newmtl" => plain.push_str(&format!("newmtl {}", trimmed[keyword.len()..].trim())),
            _ => plain.push_str(trimmed),
        }
        plain.push('\n');
    }
    Ok((plain, extras))
}

/// A map's line after its keyword.
fn map(keyword: &'static str, text: &str, line: usize) -> Result<MtlMap, String> {
    let name = file_name(text);
    let options = &text[..text.len() - name.len()];
    let file = unquoted(name).to_owned();
    let mut words = options.split_whitespace();
    let (mut bump_multiplier, mut kind) = (None, None);
    while let Some(word) = words.next() {
        match word {
            "-bm" => {
                let value = words.next().unwrap_or_default();
                let number = value.parse::<f32>().ok().filter(|n| n.is_finite());
                bump_multiplier =
                    Some(number.ok_or_else(|| format!("`{keyword} -bm {value}`: not a number"))?);
            }
            "-type" => kind = words.next().map(str::to_owned),
            _ => {}
        }
    }
    Ok(MtlMap { keyword, file, line, clamp: options.contains("-clamp on"), bump_multiplier, kind })
}

/// A number from 0 to 1.
fn share(keyword: &str, values: &[&str]) -> Result<f32, String> {
    let value = finite(keyword, values.first().ok_or_else(|| format!("`{keyword}` needs a number"))?)?;
    if value > 1.0 { Err(format!("`{keyword}` is {value}; it must be from 0 to 1")) } else { Ok(value) }
}

/// Three numbers, or one for all three.
fn color_line(keyword: &str, values: &[&str]) -> Result<String, String> {
    let Vec3 { x, y, z } = color(keyword, values)?;
    Ok(format!("{keyword} {x} {y} {z}"))
}

fn color(keyword: &str, values: &[&str]) -> Result<Vec3, String> {
    if matches!(values.first(), Some(&("spectral" | "xyz"))) {
        return Err(format!("`{keyword} {}` is not supported; give red, green and blue", values[0]));
    }
    let numbers = values.iter().take(3).map(|word| finite(keyword, word)).collect::<Result<Vec<_>, _>>()?;
    match numbers[..] {
        [v] => Ok(Vec3::splat(v)),
        [r, g, b] => Ok(Vec3::new(r, g, b)),
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

fn convert(material: tobj::Material, extra: MtlMaterial) -> MtlMaterial {
    let color = |value: Option<[f64; 3]>| value.map(|rgb| Vec3::from_array(rgb.map(|n| n as f32)));
    MtlMaterial {
        diffuse: color(material.diffuse),
        specular: color(material.specular),
        shininess: material.shininess.map(|n| n as f32),
        emission: color(material.emissive),
        opacity: material.dissolve.map(|n| n as f32),
        illumination: material.illumination_model,
        refraction_index: material.optical_density.map(|n| n as f32),
        name: material.name,
        ..extra
    }
}

impl MtlMaterial {
    /// The last map of this keyword, which counts.
    pub fn map(&self, keyword: &str) -> Option<&MtlMap> {
        self.maps.iter().rfind(|map| map.keyword == keyword)
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
