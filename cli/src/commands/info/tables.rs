//! Files of numbers and names that commands pass on to one another: points, tetrahedra, form factors, JSON lines, statistics,
//! response curves, materials and measured reflection.

use super::bounds;
use crate::input_error::InputError;
use crate::json_words;
use crate::mesh_io::read_mtl;
use glam::DVec3;
use pointillist_shade::MerlTable;
use serde_json::{Map, Value, json};

/// Levels of a response curve: one for each value of 8 bits.
const LEVELS: usize = 256;
/// Coordinates of points are 0 or between these; other bytes read as doubles are smaller or larger.
const COORDINATES: std::ops::RangeInclusive<f64> = 1e-200..=1e200;

/// A text that a command wrote and that is no cloud; nothing if it is something else.
pub(super) fn of_text(bytes: &[u8]) -> Option<Value> {
    let text = String::from_utf8_lossy(bytes);
    let first = text.lines().next().unwrap_or_default().trim();
    let rows = || text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'));
    for (what, per_line) in [("tetrahedra", 4), ("dimension", 0)] {
        let Some(number) = first.strip_prefix(&format!("# {what} ")) else { continue };
        let number: u64 = number.trim().parse().ok()?;
        return Some(if per_line > 0 {
            json!({ "kind": "tetrahedra", "cells": number, "lines": rows().count() })
        } else {
            json!({ "kind": "tetrahedra", "dimension": number, "lines": rows().count() })
        });
    }
    if first == "i,j,F" {
        return Some(json!({
            "kind": "form factors",
            "factors": rows().count() - 1,
            "units": { "F": "share of what surface i sends out that arrives at j" },
        }));
    }
    let numbers: Vec<&str> = rows().take(LEVELS + 1).collect();
    let is_curve = numbers.len() == LEVELS && numbers.iter().all(|line| line.parse::<f64>().is_ok());
    is_curve.then(|| json!({ "kind": "response curve", "levels": LEVELS }))
}

/// Raw numbers: positions as three doubles each, or tetrahedra as four 32-bit numbers each.
pub(super) fn of_raw(name: &str, bytes: &[u8]) -> Result<Value, InputError> {
    let (doubles, rest) = bytes.as_chunks::<8>();
    let numbers: Vec<f64> = doubles.iter().map(|b| f64::from_le_bytes(*b)).collect();
    let is_coordinate = |n: &f64| *n == 0.0 || COORDINATES.contains(&n.abs());
    if rest.is_empty() && numbers.len().is_multiple_of(3) && numbers.iter().all(is_coordinate) {
        let positions: Vec<DVec3> = numbers.chunks_exact(3).map(DVec3::from_slice).collect();
        return Ok(json!({
            "kind": "points",
            "format": "raw doubles",
            "points": positions.len(),
            "bounds": bounds(positions.iter().copied()),
        }));
    }
    if bytes.len().is_multiple_of(16) {
        return Ok(
            json!({ "kind": "tetrahedra", "format": "raw 32-bit numbers", "cells": bytes.len() / 16 }),
        );
    }
    Err(InputError::of_file(
        name,
        format!("has {} bytes, which are no raw points or tetrahedra", bytes.len()),
    )
    .with_help("points are three little-endian doubles each, tetrahedra four 32-bit numbers each"))
}

/// Questions for `dice` and `radiosity factors`, or their answers.
pub(super) fn of_json_lines(name: &str, bytes: &[u8]) -> Result<Value, InputError> {
    let lines: Vec<&[u8]> =
        bytes.split(|&b| b == b'\n').filter(|line| !line.trim_ascii().is_empty()).collect();
    let help = "each line is a JSON object, as `pointillist dice --help` shows";
    let first: Map<String, Value> = json_words::parse(name, lines.first().copied().unwrap_or(b"{}"), help)?;
    let has = |key: &str| first.contains_key(key);
    let (of, by) = match () {
        () if has("polygon") || has("rings") => ("polygons to be cut", "dice"),
        () if has("pieces") => ("pieces of polygons", "dice"),
        () if has("cells") => ("areas in cells", "dice --areas"),
        () if has("from") && has("to") => ("pairs of polygons", "radiosity factors"),
        () if has("F") => ("form factors", "radiosity factors"),
        () => ("objects of another program", "none"),
    };
    Ok(json!({ "kind": "JSON lines", "lines": lines.len(), "of": of, "command": by }))
}

/// What `--stats` writes.
pub(super) fn of_stats(name: &str, bytes: &[u8]) -> Result<Value, InputError> {
    let stats: Value = json_words::parse(name, bytes, "`--stats` writes such files")?;
    Ok(json!({
        "kind": "statistics",
        "total_s": stats["seconds"]["total"],
        "cpu_s": stats["cpu_seconds"]["total"],
        "peak_bytes": stats["peak_bytes"],
        "stages": stats["seconds"].as_object().map(|seconds| seconds.keys().collect::<Vec<_>>()),
    }))
}

/// What `compare` writes.
pub(super) fn of_comparison(name: &str, bytes: &[u8]) -> Result<Value, InputError> {
    let found: Value = json_words::parse(name, bytes, "`pointillist compare` writes such files")?;
    Ok(json!({
        "kind": "comparison",
        "size": [found["width"], found["height"]],
        "rmse": found["rmse"],
        "max": found["max"],
    }))
}

/// A job for a render farm, in JSON.
pub(super) fn of_job(name: &str, bytes: &[u8]) -> Result<Value, InputError> {
    let job: Value = json_words::parse(name, bytes, "`pointillist job` writes such files")?;
    let names = |key: &str| -> Vec<&Value> {
        job[key].as_array().into_iter().flatten().map(|entry| &entry["name"]).collect()
    };
    Ok(json!({
        "kind": "job template",
        "format": "json",
        "version": job["specificationVersion"],
        "name": job["name"],
        "parameters": names("parameterDefinitions"),
        "steps": names("steps"),
    }))
}

/// A job for a render farm, in YAML: known by its first key that counts, not parsed.
pub(super) fn of_yaml(name: &str, bytes: &[u8]) -> Result<Value, InputError> {
    let text = String::from_utf8_lossy(bytes);
    let value = |key: &str| {
        let found = text.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix(':'));
        found.map(|value| value.trim().trim_matches(['"', '\'']).to_owned())
    };
    let Some(version) = value("specificationVersion") else {
        let help = "of YAML, jobs are known, which `pointillist job` writes";
        return Err(InputError::of_file(name, "this YAML is no job template").with_help(help));
    };
    Ok(json!({ "kind": "job template", "format": "yaml", "version": version, "name": value("name") }))
}

pub(super) fn of_mtl(name: &str, bytes: &[u8]) -> Result<Value, InputError> {
    let materials: Vec<Value> = read_mtl(name, bytes)?
        .iter()
        .map(|material| {
            json!({
                "name": material.name,
                "maps": material.maps.iter().map(|map| [map.keyword, &map.file]).collect::<Vec<_>>(),
                "ignored": material.ignored,
            })
        })
        .collect();
    Ok(json!({ "kind": "materials", "format": "mtl", "materials": materials }))
}

/// Measured reflection as MERL's files have it.
pub(super) fn of_merl(name: &str, bytes: &[u8]) -> Result<Value, InputError> {
    let table = MerlTable::from_bytes(bytes)
        .map_err(|error| InputError::of_file(name, format!("cannot be used: {error}")))?;
    Ok(json!({ "kind": "measured reflection", "format": "merl", "albedo": table.albedo().to_array() }))
}
