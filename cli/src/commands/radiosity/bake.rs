//! `radiosity SCENE`.

use super::{by_rays, dry_run};
use crate::baked_file::BakedFile;
use crate::commands::Report;
use crate::commands::report::{name_of_output, write_text};
use crate::error::CliError;
use crate::input::{is_standard, name_of};
use crate::input_error::InputError;
use crate::job::Progress;
use crate::memory;
use crate::options::{FormFactorKind, LinkKind, RadiosityBakeOptions, SolveMethod};
use crate::scene::{self, Overrides, Scene};
use glam::{DVec2, DVec3};
use pointillist_radiosity as radiosity;
use pointillist_radiosity::{
    Baked, HemicubeKind, RadiosityError, SceneOptions, Solution, SolveOptions, Transport,
};
use pointillist_render::{IndirectOptions, Lamps, SceneError, SceneSurfaces, scene_surfaces, with_lamps};
use std::path::Path;

/// Patches along the scene's longest side, unless said otherwise.
const PATCHES_ACROSS: f64 = 32.0;
/// Units of the progress bar, and shares of the time after which direct light, form factors and the solution are there, about.
pub(super) const PROGRESS_STEPS: u64 = 1000;
const LIT: f64 = 0.02;
const LINKED: f64 = 0.8;
const SOLVED: f64 = 0.82;
/// Scenes with more patches are linked by groups, unless said otherwise.
pub(super) const MOST_FULL: usize = 1000;
/// Scenes with more surfaces are linked by rays, unless said otherwise. For groups each pair of surfaces is looked at, cut where others stand on them:
/// the 248 of `examples/house.toml` are 6,300 parts, which take ten times as long by groups, and fifty times with large patches.
const MOST_GROUPED: usize = IndirectOptions::DEFAULT.most_paired;
/// With more surfaces, groups take from minutes to hours.
const MOST_PAIRED: usize = 2000;
/// `--tolerance` of groups, unless said otherwise.
const LINK_TOLERANCE: f64 = IndirectOptions::DEFAULT.tolerance;

pub(super) fn run(options: &RadiosityBakeOptions) -> Result<(), CliError> {
    let report =
        Report::new(&options.common)?.writing(std::iter::once(&options.output).chain(&options.factors))?;
    check(options)?;
    let Some(path) = &options.scene else {
        return Err(CliError::Usage("SCENE is missing".to_owned()));
    };
    let assignments = options.set.iter().map(|a| ("--set".to_owned(), a.clone())).collect();
    let overrides = Overrides { assignments };
    let loaded = report.stats.stage("load", || scene::load_to_bake(path, &overrides))?;
    loaded.warnings.iter().for_each(|warning| report.warn(warning));
    let scene = loaded.scene;
    let surfaces = report.stats.stage("load", || scene_surfaces(&scene).map_err(|e| unusable(path, &e)))?;
    if surfaces.translucent > 0 {
        let count = surfaces.translucent;
        report.warn(&format!("{count} triangles let most light through and are left out"));
    }
    if surfaces.light_mapped > 0 && !scene.lights.is_empty() {
        let count = surfaces.light_mapped;
        report.warn(&format!(
            "{count} triangles have a lightmap: they send out what it holds, by its mean, and pass nothing on of what lights and other surfaces add"
        ));
    }
    let bake = Bake { options, report: &report, scene: &scene, surfaces: &surfaces };
    bake.check_importance()?;
    if options.dry_run {
        return report.finish_expecting(dry_run::expect(&bake)?);
    }
    let progress = report.progress();
    if bake.by_rays() {
        by_rays::run(&bake, &progress)?;
        return report.finish();
    }
    let transport = bake.link(&progress)?;
    let solution = bake.solve(&transport, &progress)?;
    let baked = report
        .stats
        .stage("gather", || solution.bake_with(&|share| progress.reach(SOLVED + (1.0 - SOLVED) * share)));
    progress.finish();
    bake.tell(&transport, &solution);
    let factors = |f: &mut FactorVisitor<'_>| transport.factors(f);
    let found = Found { patches: transport.patch_count(), bound: solution.bound, factors: &factors };
    bake.write(&found, &baked)?;
    report.finish()
}

/// Takes a patch, another patch and their form factor.
pub(super) type FactorVisitor<'v> = dyn FnMut(usize, usize, f64) + 'v;

/// What is written besides the light of vertices.
pub(super) struct Found<'a> {
    pub(super) patches: usize,
    pub(super) bound: f64,
    /// Calls a function with all form factors.
    pub(super) factors: &'a dyn Fn(&mut FactorVisitor<'_>),
}

/// What light cannot be baked for, with the way out.
fn unusable(path: &Path, error: &SceneError) -> InputError {
    let refused = InputError::of_file(name_of(path), error.to_string());
    match error {
        SceneError::Albedo { material, .. } => refused.with_help(format!(
            "light would grow at every reflection: set [material.{material}] diffuse below 1"
        )),
        _ => refused,
    }
}

fn check(options: &RadiosityBakeOptions) -> Result<(), CliError> {
    let hemicube = options.form_factor != FormFactorKind::Analytic;
    if hemicube && options.links == LinkKind::Hierarchical {
        let message = "--form-factor hemicube takes --links full: a hemicube sees single patches, not groups";
        return Err(CliError::Usage(message.to_owned()));
    }
    if options.links == LinkKind::Rays && (hemicube || options.method == SolveMethod::Progressive) {
        let message =
            "--links rays has form factors and a solver of its own: leave --form-factor and --method out";
        return Err(CliError::Usage(message.to_owned()));
    }
    if options.links == LinkKind::Rays && options.least_factor > 0.0 {
        let message = "--least-factor is about pairs of patches: leave it or --links rays out";
        return Err(CliError::Usage(message.to_owned()));
    }
    if options.adaptive.is_some() && (hemicube || options.links == LinkKind::Full) {
        let message = "--adaptive needs groups of patches: leave --links full and --form-factor hemicube out";
        return Err(CliError::Usage(message.to_owned()));
    }
    if options.importance && (hemicube || matches!(options.links, LinkKind::Full | LinkKind::Rays)) {
        let message = "--importance is about links of groups: leave --links full, --links rays and --form-factor hemicube out";
        return Err(CliError::Usage(message.to_owned()));
    }
    let output = &options.output;
    let known = output.extension().is_some_and(|e| e == "json" || e == "ply");
    if known || is_standard(output) {
        return Ok(());
    }
    Err(CliError::Usage(format!("`{}`: baked light ends in .json or .ply", output.display())))
}

/// Bytes of a patch or a group of patches at least, before anything is linked.
const ELEMENT_BYTES: u128 = 512;
/// Bytes of a link between two patches at least, seen from either.
const LINK_BYTES: u128 = 24;

/// How many patches and groups memory has room for.
fn affordable_elements() -> usize {
    let fits = |bytes: u64| usize::try_from(u128::from(bytes) / ELEMENT_BYTES).unwrap_or(usize::MAX);
    memory::available_bytes().map_or(usize::MAX, fits)
}

/// Patches a surface, both sides together, from which groups within surfaces are worth finding the importance for: with 8, 5 % of the links are of
/// groups (`studies/results/radiosity.md`, "Links for a camera").
const LEAST_PATCHES: usize = 16;

#[derive(Clone, Copy)]
pub(super) struct Bake<'a> {
    pub(super) options: &'a RadiosityBakeOptions,
    pub(super) report: &'a Report<'a>,
    pub(super) scene: &'a Scene,
    pub(super) surfaces: &'a SceneSurfaces,
}

impl Bake<'_> {
    /// Whether links are found by rays.
    pub(super) fn by_rays(&self) -> bool {
        let Self { options, surfaces, .. } = self;
        let plain = options.form_factor == FormFactorKind::Analytic
            && options.method == SolveMethod::GaussSeidel
            && options.least_factor == 0.0;
        let many = surfaces.surfaces.len() > MOST_GROUPED && !options.importance;
        options.links == LinkKind::Rays || (options.links == LinkKind::Auto && plain && many)
    }

    /// `--patch`.
    pub(super) fn patch(&self) -> f64 {
        self.options.patch.unwrap_or_else(|| self.extent() / PATCHES_ACROSS)
    }

    /// `--tolerance` of links by rays.
    pub(super) fn ray_tolerance(&self) -> f64 {
        let count = self.surfaces.surfaces.len();
        self.options.tolerance.unwrap_or_else(|| IndirectOptions::DEFAULT.ray_tolerance(count))
    }

    pub(super) fn link(&self, progress: &Progress) -> Result<Transport, CliError> {
        let Self { options, report, .. } = self;
        progress.begin("radiosity", PROGRESS_STEPS);
        let stats = &report.stats;
        self.warn_of_pairs();
        let mut patches = stats.stage("divide", || self.divided())?;
        let lamps = Lamps::new(self.scene);
        let done = |share| progress.reach(LIT * share);
        let direct = stats.stage("direct", || with_lamps(&lamps, |list| patches.direct_with(list, &done)));
        let direct = direct.map_err(|e| self.refused(&e))?;
        progress.reach(LIT);
        let kind = match options.form_factor {
            FormFactorKind::Analytic => None,
            FormFactorKind::Hemicube => Some(HemicubeKind::Exact),
            FormFactorKind::HemicubeClassic => Some(HemicubeKind::Classic),
        };
        if options.importance {
            self.warn_of_small_surfaces(patches.patch_count());
        }
        let seen = if options.importance { Some(self.seen(&patches)?) } else { None };
        let linking = |share| progress.reach(LIT + (LINKED - LIT) * share);
        let linked = stats.stage("factors", || match (kind, &seen) {
            (None, Some(seen)) => {
                let importance = patches.importance(&direct, seen)?;
                patches.transport_for(&direct, &importance, &linking)
            }
            (None, None) => patches.transport_with(&direct, &linking),
            (Some(kind), _) => patches.transport_by_hemicubes(kind, options.resolution as usize, &direct),
        });
        let transport = linked.map_err(|e| self.refused(&e))?;
        progress.reach(LINKED);
        Ok(transport)
    }

    /// Refuses groups of so many surfaces that nobody would wait for them, unless they were asked for.
    fn check_importance(&self) -> Result<(), CliError> {
        let count = self.surfaces.surfaces.len();
        if !self.options.importance || self.options.links != LinkKind::Auto || count <= MOST_PAIRED {
            return Ok(());
        }
        let message = format!(
            "--importance is about links of groups, for which each pair of {count} surfaces is looked at: leave it out, or add --links hierarchical and wait"
        );
        Err(CliError::Usage(message))
    }

    /// Groups are of patches of one surface. Where two balls of 1152 triangles stand in a room, shadows of hundreds of triangles are cut for each of many pairs.
    fn warn_of_pairs(&self) {
        let count = self.surfaces.surfaces.len();
        if count > MOST_PAIRED {
            let pairs = count * (count - 1) / 2;
            self.report.warn(&format!(
                "each of {pairs} pairs of {count} surfaces is looked at, which may take from minutes to hours: --links rays takes seconds"
            ));
        }
    }

    /// Links between whole surfaces cannot be coarser: finding the importance takes as long as they do, and saves none.
    fn warn_of_small_surfaces(&self, patches: usize) {
        let surfaces = self.surfaces.surfaces.len();
        if patches < LEAST_PATCHES * surfaces {
            self.report.warn(&format!(
                "{surfaces} surfaces in {patches} patches: --importance saves nothing where surfaces are about as small as patches, and takes as long as \
                 the links do; leave it out"
            ));
        }
    }

    /// Which share of each patch the scene's camera sees.
    fn seen(&self, patches: &radiosity::Scene) -> Result<Vec<f64>, CliError> {
        let view = self.scene.view().map_err(|e| CliError::Failed(e.to_string()))?;
        if !view.projection().is_perspective() {
            let message = "--importance needs a camera with a field of view: set camera.fov, or leave it out";
            return Err(CliError::Usage(message.to_owned()));
        }
        let size = DVec2::new(f64::from(view.width()), f64::from(view.height()));
        let in_picture = |point: DVec3| {
            let inside = |p: DVec2| p.cmpge(DVec2::ZERO).all() && p.cmple(size).all();
            view.project(point).is_some_and(|seen| inside(seen.pixel))
        };
        let seen = patches.seen_from(view.eye(), &in_picture).map_err(|e| self.refused(&e))?;
        if seen.iter().all(|&share| share == 0.0) {
            self.report.warn("the camera sees no surface: with --importance, all light is coarse");
        }
        Ok(seen)
    }

    pub(super) fn solve<'t>(
        &self,
        transport: &'t Transport,
        progress: &Progress,
    ) -> Result<Solution<'t>, CliError> {
        let Self { options, report, .. } = self;
        let solution = report.stats.stage("solve", || match options.method {
            SolveMethod::GaussSeidel => transport.gauss_seidel(&SolveOptions::DEFAULT),
            SolveMethod::Progressive => transport.progressive(&[], &SolveOptions::DEFAULT),
        });
        let solution = solution.map_err(|e| self.refused(&e))?;
        progress.reach(SOLVED);
        Ok(solution)
    }

    /// The scene in patches, linked as asked.
    pub(super) fn divided(&self) -> Result<radiosity::Scene, CliError> {
        let options = self.options;
        let patch = self.patch();
        let mut settings = SceneOptions::DEFAULT
            .with_patch(patch)
            .with_smallest_patch(options.adaptive.unwrap_or(patch))
            .with_least_factor(options.least_factor)
            .with_max_elements(self.most_elements());
        let new = |settings: &SceneOptions| {
            radiosity::Scene::new(&self.surfaces.surfaces, settings).map_err(|e| self.refused(&e))
        };
        let plain = new(&settings)?;
        let grouped = match options.links {
            LinkKind::Full => false,
            LinkKind::Hierarchical | LinkKind::Rays => true,
            LinkKind::Auto => {
                let wanted = options.adaptive.is_some() || options.importance;
                options.form_factor == FormFactorKind::Analytic && (plain.patch_count() > MOST_FULL || wanted)
            }
        };
        if !grouped {
            self.check_full_links(plain.patch_count())?;
            return Ok(plain);
        }
        settings = settings.with_tolerance(Some(options.tolerance.unwrap_or(LINK_TOLERANCE)));
        new(&settings)
    }

    /// Longest side of the box around all surfaces.
    pub(super) fn extent(&self) -> f64 {
        let all = || self.surfaces.surfaces.iter().flat_map(|s| &s.vertices);
        let low = all().fold(DVec3::INFINITY, |m, &v| m.min(v));
        let high = all().fold(DVec3::NEG_INFINITY, |m, &v| m.max(v));
        let longest = (high - low).max_element();
        if longest > 0.0 { longest } else { 1.0 }
    }

    /// The error with the triangle, the object and the material that it is about.
    pub(super) fn refused(&self, error: &RadiosityError) -> CliError {
        use RadiosityError::{Emission, EmitterWithoutArea, Outline, Reflectance, ReflectanceAboveOne};
        let surface = match error {
            Outline { surface, .. }
            | Reflectance { surface, .. }
            | ReflectanceAboveOne { surface, .. }
            | Emission { surface, .. }
            | EmitterWithoutArea { surface } => *surface,
            RadiosityError::TooManyPatches { limit } => return self.too_many(*limit),
            _ => return CliError::Failed(error.to_string()),
        };
        let mesh = &self.scene.mesh;
        let face = self.surfaces.faces[surface][0];
        let object = &mesh.objects[mesh.object(face) as usize].name;
        let material = &self.scene.materials[mesh.material(face) as usize].name;
        let name = self.options.scene.as_deref().map(name_of).unwrap_or_default();
        let message = format!("triangle {face} (of `{object}`, material `{material}`): {error}");
        CliError::Input(InputError::of_file(name, message))
    }

    /// Most patches, and patches of patches, that are asked for and that there is memory for.
    pub(super) fn most_elements(&self) -> usize {
        // A patch of four counts five elements.
        self.options.max_patches.saturating_mul(2).min(affordable_elements())
    }

    /// The patches are more than asked for, or than there is memory for.
    fn too_many(&self, elements: usize) -> CliError {
        let most = self.options.max_patches;
        if elements >= most.saturating_mul(2) {
            let message =
                format!("more than {most} patches: use a larger --patch, or a larger --max-patches");
            return CliError::Usage(message);
        }
        let needed = elements as u128 * ELEMENT_BYTES;
        let error = memory::MemoryError {
            what: format!("more than {} patches take more than", elements / 2),
            needed,
            available: memory::available_bytes().unwrap_or(u64::MAX),
        };
        CliError::Usage(format!("{}; use a larger --patch", error.with_help()))
    }

    /// Refuses links of each patch with each other that memory cannot hold.
    fn check_full_links(&self, patches: usize) -> Result<(), CliError> {
        let needed = (patches as u128).pow(2) * LINK_BYTES;
        memory::check(needed, || format!("the links of {patches} patches with each other take"))
            .map_err(|error| CliError::Usage(format!("{}; or use --links hierarchical", error.with_help())))
    }

    fn tell(&self, transport: &Transport, solution: &Solution) {
        let stats = &self.report.stats;
        let counts = transport.counts();
        stats.count("surfaces", self.surfaces.surfaces.len() as u64);
        stats.count("patches", transport.patch_count() as u64);
        stats.count("links", counts.links as u64);
        stats.count("links_partly_hidden", counts.partly_hidden as u64);
        stats.count("cells_sampled", counts.cells as u64);
        stats.count("steps", solution.steps as u64);
        stats.skip("pairs_facing_apart", counts.facing_apart as u64);
        stats.skip("pairs_black", counts.black as u64);
        stats.skip("pairs_hidden", counts.hidden as u64);
        stats.skip("pairs_below_bound", counts.below_bound as u64);
        stats.skip("surfaces_without_area", transport.scene().dropped() as u64);
        stats.skip("triangles_translucent", self.surfaces.translucent as u64);
        stats.figure("error_bound", solution.bound);
        stats.figure("contraction", solution.contraction);
        stats.figure("largest_left_out", counts.left_out);
        stats.figure("largest_row_excess", counts.row_excess);
        self.report.note(&format!(
            "{} patches, {} links, solved in {} steps to within {:.2e}",
            transport.patch_count(),
            counts.links,
            solution.steps,
            solution.bound
        ));
        if !solution.converged {
            self.report
                .warn("the solution has not reached its tolerance; the bound above says how far it is");
        }
        if counts.below_bound > 0 {
            let most = counts.left_out;
            self.report.note(&format!(
                "{} pairs were left out; of no patch more than {most:.2e} of all it sees",
                counts.below_bound
            ));
        }
    }

    pub(super) fn write(&self, found: &Found<'_>, baked: &Baked) -> Result<(), CliError> {
        let Self { options, report, .. } = self;
        if let Some(path) = &options.factors {
            report.stats.stage("write", || write_factors(path, found))?;
        }
        let mut file = BakedFile::new(baked, &self.surfaces.faces).of(self.scene);
        file.patches = found.patches;
        file.bound = found.bound;
        let path = &options.output;
        let is_ply = path.extension().is_some_and(|e| e == "ply");
        report.stats.stage("write", || {
            write_text(path, |output| if is_ply { file.write_ply(output) } else { file.write_json(output) })
        })?;
        let seconds = report.stats.elapsed().as_secs_f64();
        let vertices = file.positions.len();
        report.note(&format!("{}: {vertices} vertices in {seconds:.2} s", name_of_output(path)));
        if let Some(scene) = options.scene.as_ref().filter(|_| !is_ply) {
            report.tell_use(scene, "ambient.radiosity", path);
        }
        Ok(())
    }
}

fn write_factors(path: &Path, found: &Found<'_>) -> Result<(), CliError> {
    write_text(path, |output| {
        let mut result = writeln!(output, "i,j,F");
        (found.factors)(&mut |i, j, factor| {
            if result.is_ok() {
                result = writeln!(output, "{i},{j},{factor}");
            }
        });
        result
    })
}
