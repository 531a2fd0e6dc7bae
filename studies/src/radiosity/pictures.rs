//! Pictures of two rooms, from the dark one: error against the size of patches, and by links that are fine for the camera.

use std::fmt::Write as _;
use std::path::Path;

use cpu_time::ProcessTime;
use glam::{DVec2, dvec3};
use pointillist_cli::scene::{Overrides, load};
use pointillist_radiosity::{
    Baked, Lamp, RadiosityError, RayOptions, Scene as Divided, SceneOptions, SolveOptions, Surface,
};
use pointillist_render::{AmbientLight, Lamps, Lightmap, Scene, SceneSurfaces, scene_surfaces, with_lamps};

use crate::common::draw;
use crate::common::picture::Picture;
use crate::common::report::Outcome;
use crate::common::rooms::thin_wall_rooms;
use crate::radiosity::paths::size_of;
use crate::shprobe::together::Reference;

type Fault = Box<dyn std::error::Error + Send + Sync>;

/// Pixels of pictures.
const SIZE: [u32; 2] = [480, 300];
/// Paths of a pixel, in either half of the reference.
const PATHS: u32 = 64;
/// Patches along the longest side.
const ACROSS: [f64; 4] = [8.0, 16.0, 32.0, 64.0];
/// Tolerance of groups, unless said otherwise: that of the command.
const TOLERANCE: f64 = 0.01;
/// Tolerances of groups, without and with importance.
const TOLERANCES: [f64; 4] = [0.1, 0.03, 0.01, 0.003];
/// That of the solution that they are compared with.
const FINE: f64 = 0.001;

/// The rooms, seen from the dark one.
fn rooms() -> Scene {
    let mut scene = thin_wall_rooms();
    (scene.camera.eye, scene.camera.target) = (dvec3(7.7, 2.0, 3.7), dvec3(4.1, 1.0, 1.0));
    [scene.image.width, scene.image.height] = SIZE;
    scene
}

/// The rooms of the guide, whose walls are large, seen from the dark one.
fn guide_rooms() -> Result<Scene, Fault> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../book/scenes/rooms.toml");
    let mut scene = load(&file, &Overrides::default())?.scene;
    (scene.camera.eye, scene.camera.target) = (dvec3(-2.6, 1.6, 1.6), dvec3(-1.0, 1.0, -1.2));
    [scene.image.width, scene.image.height] = SIZE;
    Ok(scene)
}

/// What a bake took, and what it is.
struct Made {
    baked: Baked,
    links: usize,
    seconds: f64,
}

/// By groups, finely for the scene's camera alone or everywhere.
fn by_groups(
    scene: &Scene,
    (surfaces, lamps): (&[Surface], &[Lamp<'_>]),
    (across, tolerance): (f64, f64),
    for_the_camera: bool,
) -> Result<Made, Fault> {
    let start = ProcessTime::now();
    let patch = size_of(surfaces) / across;
    let options =
        SceneOptions::DEFAULT.with_patch(patch).with_smallest_patch(patch).with_tolerance(Some(tolerance));
    let mut divided = Divided::new(surfaces, &options)?;
    let direct = divided.direct(lamps)?;
    let transport = if for_the_camera {
        let view = scene.view()?;
        let size = DVec2::new(f64::from(SIZE[0]), f64::from(SIZE[1]));
        let inside = |p: DVec2| p.cmpge(DVec2::ZERO).all() && p.cmple(size).all();
        let seen =
            divided.seen_from(view.eye(), &|p| view.project(p).is_some_and(|seen| inside(seen.pixel)))?;
        let importance = divided.importance(&direct, &seen)?;
        divided.transport_for(&direct, &importance, &|_| ())?
    } else {
        divided.transport(&direct)?
    };
    let links = transport.counts().links;
    let baked = transport.gauss_seidel(&SolveOptions::DEFAULT)?.bake();
    Ok(Made { baked, links, seconds: start.elapsed().as_secs_f64() })
}

/// By rays, without division for drawing: the size of patches alone decides.
fn by_rays(surfaces: &[Surface], lamps: &[Lamp<'_>], across: f64) -> Result<Made, RadiosityError> {
    let start = ProcessTime::now();
    let patch = size_of(surfaces) / across;
    let options = SceneOptions::DEFAULT.with_squarer(false).with_patch(patch).with_smallest_patch(patch);
    let mut divided = Divided::new(surfaces, &options)?;
    let direct = divided.direct(lamps)?;
    let transport = divided.transport_by_rays(&direct, &RayOptions::DEFAULT, &|_| ())?;
    let baked = transport.solve(&SolveOptions::DEFAULT.with_tolerance(1e-4))?.bake();
    Ok(Made { baked, links: transport.counts().links, seconds: start.elapsed().as_secs_f64() })
}

/// The rooms in baked light.
fn picture(scene: &Scene, found: &SceneSurfaces, baked: &Baked) -> Result<Picture, Fault> {
    let map = Lightmap::of_baked(baked, &found.faces, scene.mesh.triangles.len())?;
    let mut lit = scene.clone();
    lit.ambient = AmbientLight::Radiosity { light: Box::new(map), fingerprint: 0 };
    Ok(draw::with_pipeline(&lit)?)
}

/// Error of the picture against the size of patches.
pub(crate) fn patches(text: &mut String) -> Outcome {
    let scene = rooms();
    let reference = Reference::new(&scene, PATHS);
    let nothing = reference.error(&draw::with_pipeline(&scene)?);
    writeln!(
        text,
        "\n## Pictures against the size of patches\n\nTwo rooms with a wall of 10 cm and a doorway, from the dark one, {} × {} pixels: patches along the longest side; \
         groups at {TOLERANCE}, and rays without division for drawing. Error: root mean square over the mean of the picture, against two pictures of {PATHS} paths a pixel each, drawn apart, whose noise \
         ({:.1} %) is not in it; the picture without light between surfaces is wrong by {:.0} %.\n\n\
         | links by | patches | vertices | links | processor seconds | error % | brighter % |\n| --- | ---: | ---: | ---: | ---: | ---: | ---: |",
        SIZE[0],
        SIZE[1],
        100.0 * reference.noise(),
        100.0 * nothing.relative
    )?;
    let found = scene_surfaces(&scene)?;
    with_lamps(&Lamps::new(&scene), |lamps| {
        for across in ACROSS {
            let groups = by_groups(&scene, (&found.surfaces, lamps), (across, TOLERANCE), false)?;
            let rays = by_rays(&found.surfaces, lamps, across)?;
            for (name, made) in [("groups", groups), ("rays", rays)] {
                let error = reference.error(&picture(&scene, &found, &made.baked)?);
                let row = format!(
                    "| {name} | {across} | {} | {} | {:.1} | {:.1} | {:+.1} |",
                    made.baked.vertices.len(),
                    made.links,
                    made.seconds,
                    100.0 * error.relative,
                    100.0 * error.bias
                );
                eprintln!("    {row}");
                writeln!(text, "{row}")?;
            }
        }
        Ok(true)
    })
}

/// Links that are fine for the camera, and those that are fine everywhere.
pub(crate) fn importance(text: &mut String) -> Outcome {
    let scene = guide_rooms()?;
    let across = 32.0;
    writeln!(
        text,
        "\n## Links for a camera\n\nThe two rooms of the guide (`book/scenes/rooms.toml`), whose walls are single surfaces, from the dark one, patches of a {across}nd: groups that are fine everywhere, or for the camera (`--importance`). Error: root mean square over the \
         mean of the picture, against groups at {FINE} everywhere; processor seconds with what finds the importance. It gains nothing where surfaces are as small as groups would be: in the rooms above, with squares of half a metre, all but 5 % of the links are between whole \
         surfaces, and finding the importance takes as long as the links.\n\n\
         | tolerance | links everywhere | seconds | error % | links for the camera | seconds | error % |\n| ---: | ---: | ---: | ---: | ---: | ---: | ---: |"
    )?;
    let found = scene_surfaces(&scene)?;
    with_lamps(&Lamps::new(&scene), |lamps| {
        let exact = by_groups(&scene, (&found.surfaces, lamps), (across, FINE), false)?;
        let exact = picture(&scene, &found, &exact.baked)?;
        let mean = exact.total() / (3 * exact.pixels.len()) as f64;
        for tolerance in TOLERANCES {
            let mut row = format!("| {tolerance}");
            for for_the_camera in [false, true] {
                let made = by_groups(&scene, (&found.surfaces, lamps), (across, tolerance), for_the_camera)?;
                let error = picture(&scene, &found, &made.baked)?.rmse(&exact) / mean;
                write!(row, " | {} | {:.1} | {:.2}", made.links, made.seconds, 100.0 * error)?;
            }
            eprintln!("    {row} |");
            writeln!(text, "{row} |")?;
        }
        Ok(true)
    })
}
