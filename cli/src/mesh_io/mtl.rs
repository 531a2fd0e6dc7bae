//! MTL.

use super::mtl_keys::{KEYS, Kind};
use super::mtl_map::MtlMap;
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
        // Not cut at #, which may be part of a file name.
        let text = trimmed[keyword.len()..].trim();
        let read = Statement { keyword, values: &values, text, line: index + 1 }.read(extra);
        plain.push_str(&read.map_err(fault)?);
        plain.push('\n');
    }
    Ok((plain, extras))
}

/// A line of a material.
struct Statement<'a> {
    keyword: &'a str,
    /// Without comments.
    values: &'a [&'a str],
    /// All that follows the keyword.
    text: &'a str,
    line: usize,
}

impl Statement<'_> {
    /// The line for the parser, or nothing if it is none of the parser's: then `extra` takes in what it says.
    fn read(&self, extra: &mut MtlMaterial) -> Result<String, String> {
        let Self { keyword, values, text, .. } = *self;
        let kind =
            KEYS.iter().find(|(name, ..)| *name == keyword).map_or(Kind::Nothing, |(_, kind, _)| *kind);
        match kind {
            Kind::Material => return Ok(format!("newmtl {text}")),
            Kind::Color => return color_line(keyword, values),
            Kind::Number => return number_line(keyword, values),
            Kind::Illumination => {
                let value = values.first().and_then(|word| word.parse::<f64>().ok()).map(|n| n as u8);
                return value
                    .map(|value| format!("illum {value}"))
                    .ok_or_else(|| "`illum` needs a number".to_owned());
            }
            Kind::Transmission => extra.transmission = Some(color(keyword, values)?),
            Kind::Roughness => extra.roughness = Some(share(keyword, values)?),
            Kind::Metallic => extra.metallic = Some(share(keyword, values)?),
            Kind::Map(name) => {
                if values.is_empty() {
                    return Err(format!("`{keyword}` without a file name"));
                }
                let map = MtlMap::read(name, text, self.line)?;
                extra.ignored.extend_from_slice(&map.ignored);
                extra.maps.push(map);
            }
            Kind::Nothing if extra.ignored.iter().any(|known| known == keyword) => {}
            Kind::Nothing => extra.ignored.push(keyword.to_owned()),
        }
        Ok(String::new())
    }
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
