//! A file of probes: its header and its probes.

use super::ProbeEntry;
use crate::baked_objects::{BakedObject, find_baked};
use crate::coordinate::{LARGEST, is_usable};
use crate::input;
use crate::input_error::InputError;
use crate::json_kind::JsonKind;
use crate::json_words;
use glam::DVec3;
use pointillist_render::{Mesh, Unbaked, buried};
use pointillist_sh::Sh;
use pointillist_shprobe::{DistanceMap, Field, ProbeError};
use serde::{Deserialize, Serialize};
use std::io::{self, Write};
use std::path::Path;

/// Probes and how they were baked.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProbeFile {
    /// Order of the coefficients.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub order: Option<usize>,
    /// Pixels on a side of the pictures that were projected.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub resolution: Option<u32>,
    /// `total` or `indirect`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub what: Option<String>,
    /// How often light was sent on from surface to surface.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bounces: Option<u32>,
    /// What surfaces were lit by in the place of bounces: a hash of a file of radiosity, or `solve`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub indirect: Option<String>,
    /// How near surfaces were seen, if not all were.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub near: Option<f64>,
    /// How far surfaces were seen, if not all were.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub far: Option<f64>,
    /// Whether probes inside of walls light like others.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub keep: Option<bool>,
    /// How many more places the probes' light is fitted to.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fit: Option<u32>,
    /// Stands for the scene and the settings.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fingerprint: Option<String>,
    /// The objects that they saw; files of before have none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub objects: Vec<BakedObject>,
    /// Which part of the probes these are, as in `0/4`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub part: Option<String>,
    /// Where the part begins among all probes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first: Option<usize>,
    /// How many probes all parts have together.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub total: Option<usize>,
    /// The probes.
    pub probes: Vec<ProbeEntry>,
}

/// First bytes of a binary file; the first is not ASCII, so that the file cannot be mistaken for JSON.
const MAGIC: &[u8; 8] = b"\x93PROBES1";

impl ProbeFile {
    /// Positions without light.
    pub fn of_positions(positions: &[DVec3]) -> Self {
        Self { probes: positions.iter().copied().map(ProbeEntry::at).collect(), ..Self::default() }
    }

    /// Where the probes are.
    pub fn positions(&self) -> Vec<DVec3> {
        self.probes.iter().map(|p| DVec3::from_array(p.position)).collect()
    }

    /// The triangles of a scene that came after probes were baked: those of other objects than were seen, if all that were seen are still there.
    pub fn unbaked(&self, mesh: &Mesh) -> Unbaked {
        let known = find_baked(&self.objects, mesh);
        known.map_or(Unbaked::NONE, |known| Unbaked::all_but(&known, mesh.triangle_count() as u32))
    }

    /// Decides which probes lie inside of walls, by what all of them see; none if they are kept. The number of those that do comes back.
    pub fn mark_buried(&mut self) -> usize {
        let shares: Vec<f64> = self.probes.iter().map(|p| p.back.unwrap_or(0.0)).collect();
        let buried = if self.keep == Some(true) { vec![] } else { buried(&shares) };
        for (i, probe) in self.probes.iter_mut().enumerate() {
            probe.buried = buried.get(i).filter(|&&b| b).copied();
        }
        buried.into_iter().filter(|&b| b).count()
    }

    /// The numbers of the probes that light something: those of a field are counted among these.
    pub fn lit_numbers(&self) -> Vec<usize> {
        self.lit().map(|(i, _)| i).collect()
    }

    /// The probes that light something, with their numbers: all that do not lie inside of walls.
    fn lit(&self) -> impl Iterator<Item = (usize, &ProbeEntry)> {
        self.probes.iter().enumerate().filter(|(_, p)| p.buried != Some(true))
    }

    /// Their coefficients.
    fn radiance(&self) -> Result<Vec<Sh>, (String, String)> {
        let one = |(i, probe): (usize, &ProbeEntry)| {
            probe.radiance().map_err(|message| (format!("probes[{i}].sh"), message))
        };
        self.lit().map(one).collect()
    }

    /// How much of the sky they see, if all of them say so.
    fn sky(&self) -> Result<Option<Vec<Sh<f64>>>, (String, String)> {
        let mut shares = Vec::with_capacity(self.probes.len());
        for (i, probe) in self.lit() {
            let share = probe.sky_share().map_err(|message| (format!("probes[{i}].sky"), message))?;
            let Some(share) = share else { return Ok(None) };
            shares.push(share);
        }
        Ok(Some(shares))
    }

    /// How far they see, if all of them say so.
    fn distances(&self) -> Result<Option<Vec<DistanceMap>>, (String, String)> {
        let mut maps = Vec::with_capacity(self.probes.len());
        for (i, probe) in self.lit() {
            let Some(distances) = &probe.distances else { return Ok(None) };
            maps.push(distances.map().map_err(|message| (format!("probes[{i}].distances"), message))?);
        }
        Ok(Some(maps))
    }

    /// The light between the probes; `name` is what the file is called in messages.
    ///
    /// # Errors
    /// What is wrong with the file.
    pub fn field(&self, name: &str) -> Result<Field, InputError> {
        let of_field = |(field, message): (String, String)| {
            let help = if message.contains("not baked") {
                "bake it with `pointillist probe bake`"
            } else {
                "bake it again"
            };
            InputError::of_file(name, format!("`{field}` {message}")).with_help(help)
        };
        let positions: Vec<DVec3> = self.lit().map(|(_, p)| DVec3::from_array(p.position)).collect();
        let field = Field::new(&positions, &self.radiance().map_err(of_field)?)
            .map_err(|error| refused(name, &error))?;
        let field = match self.sky().map_err(of_field)? {
            Some(sky) => field.with_sky(&sky).map_err(|error| {
                InputError::of_file(name, format!("`sky`: {error}")).with_help("bake it again")
            })?,
            None => field,
        };
        match self.distances().map_err(of_field)? {
            Some(maps) => field.with_distances(maps).map_err(|error| refused(name, &error)),
            None => Ok(field),
        }
    }
}

fn refused(name: &str, error: &ProbeError) -> InputError {
    match error {
        ProbeError::PositionNotFinite { index } => {
            InputError::of_file(name, format!("`probes[{index}].position` is not finite"))
        }
        ProbeError::NoProbes => InputError::of_file(name, "`probes` is empty")
            .with_help("place some with `pointillist probe place`"),
        _ => InputError::of_file(name, error.to_string()),
    }
}

/// Reads JSON or binary, told apart by their beginning.
///
/// # Errors
/// A file that is missing or not one of probes, with the place and the field.
pub fn read_probes(path: &Path) -> Result<ProbeFile, InputError> {
    parse_probes(&input::name_of(path), &input::read(path)?)
}

/// Refuses places that nothing can be seen from, by the probe.
fn with_usable_places(name: &str, file: ProbeFile) -> Result<ProbeFile, InputError> {
    match file.positions().iter().position(|&place| !is_usable(place)) {
        None => Ok(file),
        Some(index) => {
            let [x, y, z] = file.probes[index].position;
            let message = format!("`probes[{index}].position` is [{x}, {y}, {z}], beyond ±{LARGEST:e}");
            Err(InputError::of_file(name, message).with_help("move the probe into the scene"))
        }
    }
}

/// Reads JSON or binary from memory; `name` is what it is called in messages.
///
/// # Errors
/// As [`read_probes`].
pub fn parse_probes(name: &str, bytes: &[u8]) -> Result<ProbeFile, InputError> {
    let Some(packed) = bytes.strip_prefix(MAGIC) else {
        let help = "probes are {\"probes\":[{\"position\":[x,y,z], …}, …]}";
        return json_words::parse(name, bytes, help)
            .map_err(|error| JsonKind::explain(JsonKind::Probes, name, bytes, error))
            .and_then(|file| with_usable_places(name, file));
    };
    let mut reader = rmp_serde::Deserializer::new(packed);
    let read = serde_path_to_error::deserialize(&mut reader).map_err(|error| {
        let field = error.path().to_string();
        let message = match error.inner() {
            rmp_serde::decode::Error::Syntax(what) if field != "." => {
                format!("`{field}` {}", json_words::after_field(&json_words::plain(what)))
            }
            _ => "these are no probes, or not all of them".to_owned(),
        };
        InputError::of_file(name, message).with_help("the file is damaged; bake it again")
    });
    read.and_then(|file| with_usable_places(name, file))
}

/// Writes probes, `binary` or as JSON with a line for each probe.
///
/// # Errors
/// Those of the output.
pub fn write_probes(output: &mut dyn Write, file: &ProbeFile, binary: bool) -> io::Result<()> {
    if binary {
        output.write_all(MAGIC)?;
        return rmp_serde::encode::write_named(output, file).map_err(io::Error::other);
    }
    let header = serde_json::to_string(&file.header())?;
    let open = header.strip_suffix("[]}").unwrap_or(&header);
    writeln!(output, "{open}[")?;
    for (i, probe) in file.probes.iter().enumerate() {
        serde_json::to_writer(&mut *output, probe)?;
        writeln!(output, "{}", if i + 1 < file.probes.len() { "," } else { "" })?;
    }
    writeln!(output, "]}}")
}

impl ProbeFile {
    /// Everything but the probes.
    pub fn header(&self) -> Self {
        Self {
            order: self.order,
            resolution: self.resolution,
            what: self.what.clone(),
            bounces: self.bounces,
            indirect: self.indirect.clone(),
            near: self.near,
            far: self.far,
            fit: self.fit,
            keep: self.keep,
            fingerprint: self.fingerprint.clone(),
            objects: self.objects.clone(),
            part: self.part.clone(),
            first: self.first,
            total: self.total,
            probes: vec![],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file() -> ProbeFile {
        let mut file = ProbeFile::of_positions(&[DVec3::ZERO, DVec3::new(0.1, -2e-9, 3e7)]);
        file.order = Some(1);
        file.probes[1].sh = Some(vec![[0.1, 0.2, 0.3]; 4]);
        file
    }

    #[test]
    fn what_is_written_is_read_as_json_and_as_binary() {
        for binary in [false, true] {
            let mut bytes = vec![];
            write_probes(&mut bytes, &file(), binary).unwrap();
            assert_eq!(parse_probes("p", &bytes).unwrap(), file());
        }
    }

    #[test]
    fn errors_name_line_and_field() {
        let text = b"{\"probes\":[\n{\"position\":[1,2,3]},\n{\"position\":[1,2,\"x\"]}]}";
        let error = parse_probes("p.json", text).unwrap_err().to_string();
        assert!(error.contains("probes[1].position[2]") && error.contains("p.json:3"), "{error}");
        let short = parse_probes("p.json", b"{\"probes\":[{\"position\":[1,2]}]}").unwrap_err().to_string();
        assert!(short.contains("probes[0].position"), "{short}");
    }
}
