//! `probe bake`.

use super::indirect::{self, KnownLight};
use super::inside::{self, Outcome};
use super::{check_output, dry_run, failed, overrides, write};
use crate::baked_objects::BakedObject;
use crate::commands::Report;
use crate::commands::report::name_of_output;
use crate::error::CliError;
use crate::job::{Expected, Watch};
use crate::memory;
use crate::options::{BakeOptions, Indirect, Inside, What};
use crate::probe_io::{Distances, ProbeEntry, ProbeFile, read_probes};
use crate::scene::{self, Scene};
use glam::DVec3;
use pointillist_render::{BakedProbe, CaptureOptions, DepthRange, Prepared, ProbeBake, Solids};
use pointillist_render::{bake_probes_in, fingerprint, fingerprints};
use std::collections::HashMap;
use std::hash::Hasher as _;
use std::ops::Range;
use std::path::Path;
use twox_hash::XxHash3_64;

pub(in crate::commands) fn run(options: &BakeOptions) -> Result<(), CliError> {
    let indirect = match &options.indirect {
        Some(Indirect::File(path)) => Some(path),
        _ => None,
    };
    let report = Report::new(&options.common)?
        .reading([&options.scene, &options.probes].into_iter().chain(indirect))?
        .writing([&options.output])?;
    check_output(&options.output)?;
    check(options)?;
    // Light between surfaces that `--indirect` brings takes the place of what the scene names.
    let load = if options.indirect.is_some() { scene::load_to_bake } else { scene::load };
    let loaded = report.stats.stage("load", || load(&options.scene, &overrides(&options.set)))?;
    loaded.warnings.iter().for_each(|warning| report.warn(warning));
    let scene = loaded.scene;
    let given = report.stats.stage("load", || read_probes(&options.probes))?;
    check_memory(given.probes.len(), options)?;
    let prepared = Prepared::new(&scene, &report.stats).map_err(failed)?;
    let solids = Solids::new(&prepared);
    let (mut file, positions) = settled(&given, &solids, options, &report)?;
    let known = indirect::known_light(options, &scene, &report)?;
    file.indirect = known.as_ref().map(|known| known.name.clone());
    let known = known.as_ref();
    let mark = fingerprint(&scene, options, known);
    file.fingerprint = Some(mark.clone());
    file.objects = BakedObject::all_of(&scene.mesh);
    let bake =
        Bake { prepared: &prepared, solids: &solids, known, mark, options, report: &report, positions };
    if options.dry_run {
        return report.finish_expecting(bake.expected(&scene)?);
    }
    let old = if options.overwrite { None } else { Old::read(&options.output, options) };
    let (kept, marks) = bake.unchanged(old.as_ref())?;
    bake.fill(&mut file, old.as_ref(), &kept, &marks)?;
    report.stats.stage("write", || write(&options.output, &file))?;
    let seconds = report.stats.elapsed().as_secs_f64();
    let baked = file.probes.len() - kept.iter().filter(|&&k| k).count();
    report.note(&format!(
        "{}: {} probes, {baked} of them baked, in {seconds:.2} s",
        name_of_output(&options.output),
        file.probes.len()
    ));
    if options.part.is_none() {
        report.tell_use(&options.scene, "ambient.probes", &options.output);
    }
    report.finish()
}

/// Refuses options that do not go together.
fn check(options: &BakeOptions) -> Result<(), CliError> {
    let message = if options.indirect.is_some() && options.bounces() > 0 {
        "--indirect holds all bounces: leave --bounces out"
    } else if options.part.is_some() && options.bounces() > 0 {
        "--part needs --bounces 0: a bounce needs the light of all probes; \
         for one more bounce, bake again with [ambient] probes naming the merged file"
    } else if options.part.is_some() && options.fit > 0 {
        "--part and --fit do not go together: probes are fitted to one another, too"
    } else if options.far.is_some_and(|far| far <= options.near) {
        "--far must be farther away than --near"
    } else {
        return Ok(());
    };
    Err(CliError::Usage(message.to_owned()))
}

/// Refuses more harmonics and distances than memory can hold.
fn check_memory(probes: usize, options: &BakeOptions) -> Result<(), CliError> {
    let places = probes as u128 + u128::from(options.fit);
    let needed = places * u128::from(place_bytes(options));
    memory::check(needed, || format!("{places} places (probes and --fit) with --order and --distances take"))
        .map_err(|error| CliError::Usage(error.with_help()))
}

/// Bytes that are kept of a place that is looked from.
fn place_bytes(options: &BakeOptions) -> u64 {
    let (bands, side) = (u64::from(options.order) + 1, u64::from(options.distances));
    // Three colours of each coefficient in double precision, this round's and the last's; two numbers for a direction.
    bands * bands * 3 * 8 * 2 + side * side * 2 * 4
}

/// What earlier runs left in the output.
struct Old {
    file: ProbeFile,
    /// The baked probes by their positions' bits.
    by_position: HashMap<[u64; 3], usize>,
}

fn bits(position: [f64; 3]) -> [u64; 3] {
    position.map(f64::to_bits)
}

impl Old {
    /// The output, if it was baked with the same settings.
    fn read(path: &Path, options: &BakeOptions) -> Option<Self> {
        let file = read_probes(path).ok()?;
        let same = file.order == Some(options.order.into())
            && file.resolution == Some(options.resolution)
            && file.bounces == Some(options.bounces())
            && file.fit.unwrap_or(0) == options.fit
            && file.what.as_deref() == Some(options.what.name());
        let baked = |(i, p): (usize, &ProbeEntry)| p.sh.is_some().then(|| (bits(p.position), i));
        // Of equal positions the first counts.
        let by_position = file.probes.iter().enumerate().rev().filter_map(baked).collect();
        same.then_some(Self { file, by_position })
    }

    /// The baked probe at a position.
    fn at(&self, position: DVec3) -> Option<&ProbeEntry> {
        self.by_position.get(&bits(position.to_array())).map(|&i| &self.file.probes[i])
    }
}

/// The probes of this run with their final positions.
fn settled(
    given: &ProbeFile,
    solids: &Solids<'_>,
    options: &BakeOptions,
    report: &Report<'_>,
) -> Result<(ProbeFile, Vec<DVec3>), CliError> {
    let range = part(given.probes.len(), options)?;
    let mut file = ProbeFile {
        order: Some(options.order.into()),
        resolution: Some(options.resolution),
        what: Some(options.what.name().to_owned()),
        bounces: Some(options.bounces()),
        indirect: None,
        near: (options.near > 0.0).then_some(options.near),
        far: options.far,
        fit: (options.fit > 0).then_some(options.fit),
        keep: (options.inside == Inside::Keep).then_some(true),
        fingerprint: None,
        objects: vec![],
        part: options.part.map(|part| part.to_string()),
        first: options.part.map(|_| range.start),
        total: options.part.map(|_| given.probes.len()),
        probes: vec![],
    };
    let (mut moved, mut dropped) = (0, 0);
    for (i, probe) in given.probes.iter().enumerate().take(range.end).skip(range.start) {
        let mut position = DVec3::from_array(probe.position);
        match inside::settle(solids, i, position, options.inside)? {
            Outcome::Free | Outcome::Kept => {}
            Outcome::Moved(to) => {
                moved += 1;
                position = to;
            }
            Outcome::Dropped => {
                dropped += 1;
                continue;
            }
        }
        file.probes.push(ProbeEntry { name: probe.name.clone(), ..ProbeEntry::at(position) });
    }
    if moved + dropped > 0 {
        report.warn(&format!(
            "{} probes were inside of solids: {moved} moved out, {dropped} left out",
            moved + dropped
        ));
    }
    let positions = file.positions();
    Ok((file, positions))
}

/// The probes that `--part` asks for.
fn part(count: usize, options: &BakeOptions) -> Result<Range<usize>, CliError> {
    let Some(part) = options.part else { return Ok(0..count) };
    let parts = part.count as usize;
    if parts > count {
        return Err(CliError::Usage(format!("--part {part}: there are only {count} probes")));
    }
    Ok(count * part.first as usize / parts..count * (part.last as usize + 1) / parts)
}

/// Raised when something else is made of the same sight, so that probes of before are baked again. 1: maps of distances with planes.
const MADE: u8 = 1;

/// Stands for the scene, the settings and light that is known already.
fn fingerprint(scene: &Scene, options: &BakeOptions, known: Option<&KnownLight>) -> String {
    let mut hash = XxHash3_64::default();
    hash.write(&fingerprint::of_light(scene).to_le_bytes());
    let numbers =
        [options.resolution, options.bounces(), options.fit, options.distances, u32::from(options.order)];
    numbers.iter().for_each(|n| hash.write(&n.to_le_bytes()));
    let lengths = [options.until, options.near, options.far.unwrap_or(f64::INFINITY)];
    lengths.iter().for_each(|n| hash.write(&n.to_le_bytes()));
    hash.write(known.map_or("", |known| &known.name).as_bytes());
    let keep = options.inside == Inside::Keep;
    hash.write(&[options.thorough, options.dering, keep].map(u8::from));
    hash.write(options.what.name().as_bytes());
    hash.write(env!("CARGO_PKG_VERSION").as_bytes());
    hash.write(&[MADE]);
    format!("{:016x}", hash.finish())
}

/// Where surfaces are seen.
fn depths(options: &BakeOptions) -> DepthRange {
    DepthRange { near: options.near, far: options.far.unwrap_or(f64::INFINITY) }
}

/// What the renderer is asked for.
fn look_options(options: &BakeOptions) -> pointillist_render::BakeOptions {
    pointillist_render::BakeOptions::DEFAULT
        .with_resolution(options.resolution)
        .with_order(options.order.into())
        .with_distances(options.distances as usize)
        .with_bounces(options.bounces())
        .with_until(options.until)
        .with_fit(options.fit as usize)
        .with_emission(options.what == What::Total)
        .with_thorough(options.thorough)
        .with_dering(options.dering)
        .with_keep_buried(options.inside == Inside::Keep)
        .with_depths(depths(options))
}

/// One run.
struct Bake<'a> {
    prepared: &'a Prepared<'a>,
    solids: &'a Solids<'a>,
    known: Option<&'a KnownLight>,
    /// Stands for the scene and the settings.
    mark: String,
    options: &'a BakeOptions,
    report: &'a Report<'a>,
    positions: Vec<DVec3>,
}

impl Bake<'_> {
    /// Which probes need not be baked again, and the fingerprints of what probes see.
    ///
    /// If the scene is the same, all that are there already. Otherwise those that see the same as before; with bounces, light gets
    /// everywhere, and then all or none are kept. Fitted probes are kept only if the scene is the same: what is seen between them
    /// counts, too.
    fn unchanged(&self, old: Option<&Old>) -> Result<(Vec<bool>, Vec<String>), CliError> {
        let Self { options, report, positions, .. } = self;
        let before = |i: usize| old.and_then(|old| old.at(positions[i]));
        let fresh = (0..positions.len()).filter(|&i| before(i).is_none());
        if old.is_some_and(|old| old.file.fingerprint.as_ref() == Some(&self.mark))
            && (options.bounces() + options.fit == 0 || fresh.clone().next().is_none())
        {
            let marks = |i: usize| before(i).and_then(|p| p.fingerprint.clone());
            let mut marks: Vec<Option<String>> = (0..positions.len()).map(marks).collect();
            let new: Vec<usize> = fresh.collect();
            let at: Vec<DVec3> = new.iter().map(|&i| positions[i]).collect();
            for (i, mark) in new.into_iter().zip(self.marks(&at)?) {
                marks[i] = Some(mark);
            }
            let kept = (0..positions.len()).map(|i| before(i).is_some()).collect();
            return Ok((kept, marks.into_iter().map(Option::unwrap_or_default).collect()));
        }
        let marks = report.stats.stage("watch", || self.marks(positions))?;
        let same = |i: usize| {
            options.fit == 0 && before(i).is_some_and(|p| p.fingerprint.as_deref() == Some(&marks[i]))
        };
        let mut kept: Vec<bool> = (0..positions.len()).map(same).collect();
        let as_many = old.is_some_and(|old| old.file.probes.len() == positions.len());
        if options.bounces() > 0 && !(as_many && kept.iter().all(|&k| k)) {
            kept.fill(false);
        }
        Ok((kept, marks))
    }

    fn marks(&self, positions: &[DVec3]) -> Result<Vec<String>, CliError> {
        let ambient = indirect::ambient(self.prepared, self.known);
        let capture = CaptureOptions {
            emission: self.options.what == What::Total,
            depths: depths(self.options),
            ..CaptureOptions::DEFAULT
        };
        let numbers =
            fingerprints(self.prepared, positions, capture, ambient, &self.report.stats).map_err(failed)?;
        // With settings that change what is made of the same sight.
        let settings =
            [self.options.distances, u32::from(self.options.thorough) + 2 * u32::from(self.options.dering)];
        let mark = |n: u64| format!("{n:016x}{:02x}{}{MADE}", settings[0], settings[1]);
        Ok(numbers.into_iter().map(mark).collect())
    }

    /// What `--dry-run` tells. All probes count as new, whatever the output holds.
    fn expected(&self, scene: &Scene) -> Result<Expected, CliError> {
        let places = self.positions.len() + self.options.fit as usize;
        let unfitted = look_options(self.options).with_fit(0);
        let bake = |at: &[DVec3]| {
            self.marks(at)?;
            self.look_with(at, &unfitted).map(drop)
        };
        dry_run::expect(scene, &self.positions, places, place_bytes(self.options), &bake, self.report)
    }

    fn look(&self, at: &[DVec3]) -> Result<Vec<BakedProbe>, CliError> {
        self.look_with(at, &look_options(self.options))
    }

    fn look_with(
        &self,
        at: &[DVec3],
        settings: &pointillist_render::BakeOptions,
    ) -> Result<Vec<BakedProbe>, CliError> {
        let Self { report, .. } = self;
        let progress = report.progress();
        let watch = Watch { task: "bake", progress: &progress, stats: &report.stats };
        let ambient = indirect::ambient(self.prepared, self.known);
        let baked = bake_probes_in(self.prepared, self.solids, at, ambient, settings, &watch);
        let ProbeBake { probes, changes } = baked.map_err(failed)?;
        for (change, bounce) in changes.iter().zip(1..) {
            report.detail(&format!("bounce {bounce}: light changed by {:.2} %", change * 100.0));
        }
        progress.finish();
        Ok(probes)
    }

    /// Bakes what is not kept, bounce after bounce.
    fn fill(
        &self,
        file: &mut ProbeFile,
        old: Option<&Old>,
        kept: &[bool],
        marks: &[String],
    ) -> Result<(), CliError> {
        let stats = &self.report.stats;
        let todo: Vec<usize> = (0..self.positions.len()).filter(|&i| !kept[i]).collect();
        let at: Vec<DVec3> = todo.iter().map(|&i| self.positions[i]).collect();
        let lit = self.look(&at)?;
        stats.count("probes", at.len() as u64);
        stats.skip("probes_unchanged", (self.positions.len() - at.len()) as u64);
        for (i, probe) in file.probes.iter_mut().enumerate() {
            if let Some(before) = old.filter(|_| kept[i]).and_then(|old| old.at(self.positions[i])) {
                *probe = ProbeEntry { name: probe.name.take(), ..before.clone() };
            }
            probe.fingerprint = Some(marks[i].clone());
        }
        for (i, BakedProbe { seen, .. }) in todo.into_iter().zip(lit) {
            let probe = &mut file.probes[i];
            probe.back = Some(seen.back_share);
            probe.sh = Some(seen.radiance.coefficients().iter().map(DVec3::to_array).collect());
            probe.sky = Some(seen.sky.coefficients().to_vec());
            probe.distances = seen.distances.as_ref().map(Distances::of);
        }
        let count = file.mark_buried();
        if count > 0 {
            self.report.warn(&format!("{count} probes lie inside of walls, and light nothing"));
        }
        Ok(())
    }
}
