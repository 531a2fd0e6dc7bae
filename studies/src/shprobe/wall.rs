//! Light on both faces of a wall between a bright and a dark room, where light that leaks shows most.

use std::fmt::Write as _;
use std::path::Path;

use glam::{DVec3, Vec3, dvec3};
use pointillist_delaunay::Hint;
use pointillist_render::AmbientLight;
use pointillist_shprobe::Field;
use pointillist_shprobe::place;

use crate::common::draw;
use crate::common::rooms::{ROOMS, THIN_WALL};
use crate::shprobe::canvas::{save, sheet};
use crate::shprobe::known::{Counts, HEIGHT, Known, Places, on_all};
use crate::shprobe::layouts::light;
use crate::shprobe::site::{Baked, Ground, Site, lit_by};
use crate::shprobe::trilinear::Grid;
use crate::shprobe::truth::Truth;

type Fault = Box<dyn std::error::Error + Send + Sync>;

/// Numbers of adaptive probes.
pub(crate) const COUNTS: [usize; 4] = [86, 96, 192, 432];

/// Places on each face of the wall, and on all surfaces together.
const ON_FACE: usize = 160;
const ON_ALL: usize = 200;

/// What probes are chosen among and fitted to, beside a grid: further candidates about the doorway, places in free space and on surfaces.
const FIT: Counts = Counts { openings: 300, free: 500, surfaces: 700 };

/// One row of the table: relative errors.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    pub(crate) name: String,
    /// How many probes there are.
    pub(crate) probes: usize,
    pub(crate) free: f64,
    pub(crate) dark_room: f64,
    /// Over the mean of the face.
    pub(crate) dark_face: f64,
    pub(crate) lit_face: f64,
    pub(crate) surfaces: f64,
}

/// The rooms with all that is compared.
pub(crate) struct Rooms<'a> {
    ground: Ground<'a>,
    free: Truth,
    /// Dark face, lit face, all surfaces: places and what is true there.
    on: [(Places, Vec<DVec3>); 3],
    known: Known,
}

impl<'a> Rooms<'a> {
    pub(crate) fn new(site: &'a Site) -> Result<Self, Fault> {
        let ground = Ground::with_bounces(site)?;
        let free = Truth::new(&ground)?;
        let face = |x: f64, way: f64| {
            let drawn = place::random(DVec3::ZERO, dvec3(0.0, ROOMS.y, ROOMS.z), 2 * ON_FACE, 21);
            let place = |p: &DVec3| (dvec3(x + way * HEIGHT, p.y, p.z), DVec3::X * way);
            // Not in the doorway.
            let is_on = |(p, n): &(DVec3, DVec3)| !ground.is_open(*p, *p - *n * (2.0 * HEIGHT));
            drawn.iter().map(place).filter(is_on).take(ON_FACE).collect::<Places>()
        };
        let faces = [face(THIN_WALL[1], 1.0), face(THIN_WALL[0], -1.0), on_all(&ground, ON_ALL, 22)];
        let mut on = vec![];
        for places in faces {
            let truth = Truth::on_surfaces(&ground, &places)?;
            on.push((places, truth));
        }
        let on = on.try_into().map_err(|_| "there are three sets of places")?;
        let known = Known::look(&ground, &FIT)?;
        Ok(Self { ground, free, on, known })
    }

    pub(crate) const fn ground(&self) -> &Ground<'a> {
        &self.ground
    }

    /// So many chosen probes, as they saw and fitted.
    pub(crate) fn adaptive(&self, count: usize, balance: f64, distances: bool) -> Result<[Baked; 2], Fault> {
        self.known.adaptive(count, balance, distances)
    }

    /// The grid of 432, as it saw and fitted.
    pub(crate) fn grid(&self, distances: bool) -> Result<[Baked; 2], Fault> {
        let seen = self.ground.look(&Grid::new(&self.ground, [12, 6, 6]).positions)?;
        self.known.fitted_to_all(seen, distances)
    }

    /// How wrong light between these probes is.
    pub(crate) fn row(&self, name: &str, baked: &Baked, distances: bool) -> Result<Row, Fault> {
        let field = baked.field(distances)?;
        let wrong = self.free.wrong(self.ground.site.dark_from, |p| light(&field, p));
        let [dark_face, lit_face, surfaces] = [0, 1, 2].map(|k| off(&field, &self.on[k].0, &self.on[k].1));
        let word = if distances { "with" } else { "without" };
        let dark_room = wrong.dark.unwrap_or(f64::NAN);
        let (probes, name) = (baked.positions.len(), format!("{name} | {word}"));
        Ok(Row { name, probes, free: wrong.all, dark_room, dark_face, lit_face, surfaces })
    }
}

/// Root mean square error over the mean of what is true.
fn off(field: &Field, places: &Places, truth: &[DVec3]) -> f64 {
    let (mut square, mut sum) = (0.0, DVec3::ZERO);
    for ((p, n), truth) in places.iter().zip(truth) {
        let n = n.as_vec3();
        let found = field.irradiance(*p, n, n, &mut Hint::default()).unwrap_or(Vec3::ZERO);
        square += (found.as_dvec3() - *truth).length_squared();
        sum += *truth;
    }
    let count = places.len() as f64;
    (square / count).sqrt() / (sum / count).length()
}

const HEAD: &str = "| probes | distances | count | free % | dark room % | dark face % | lit face % | all surfaces % |\n\
                    | --- | --- | ---: | ---: | ---: | ---: | ---: | ---: |\n";

const TEXT: &str = "Two rooms and a wall of 10 cm with a doorway, a lamp in one room. Irradiance on surfaces is that of places on them, for their normals, over \
     the mean of all places on the face; *free* and *dark room* as above. Light that is sent on is that of one radiosity solution: \
     no probe depends on another. The truth is what is seen from each place, by 40² rays a face. Adaptive probes are chosen among a grid and places about openings, with errors in free space and on surfaces; fitted ones hold what lights all of these best.\n\n";

/// Pixels of pictures.
const SIZE: [u32; 2] = [800, 500];

/// Counts of probes in pictures of the dark room.
const SHOWN: [usize; 2] = [96, 192];

/// Two stops.
const BRIGHTENED: f64 = 4.0;

/// Exposure of the dark room.
const DARK_GAIN: f64 = 6.0;

/// The dark face of the wall seen from inside the dark room: by the radiosity solution and by fitted probes, also two
/// stops brighter. Returns the errors of the pictures.
pub(crate) fn pictures(folder: &Path) -> Result<String, Fault> {
    let site = Site::thin_wall();
    let rooms = Rooms::new(&site)?;
    let mut scene = site.scene.clone();
    [scene.image.width, scene.image.height] = SIZE;
    (scene.camera.eye, scene.camera.target) = (dvec3(7.7, 2.0, 3.7), dvec3(4.1, 1.0, 1.0));
    let light = rooms.ground.sent_on().ok_or("the rooms have light that is sent on")?;
    scene.ambient = AmbientLight::Radiosity { light: Box::new(light.clone()), fingerprint: 0 };
    let truth = draw::with_pipeline(&scene)?;
    let mut text =
        "| dark room from inside | error of the picture, over its mean % |\n| --- | ---: |\n".to_owned();
    let mut shown = vec![truth.clone()];
    let mut add = |name: String, baked: &Baked, text: &mut String| -> Result<(), Fault> {
        let picture = draw::with_pipeline(&lit_by(&scene, baked, true)?)?;
        let mean =
            truth.pixels.iter().map(|p| p.element_sum()).sum::<f64>() / 3.0 / truth.pixels.len() as f64;
        writeln!(text, "| {name} | {:.1} |", 100.0 * picture.rmse(&truth) / mean)?;
        shown.push(picture);
        Ok(())
    };
    for count in SHOWN {
        let [_, fitted] = rooms.adaptive(count, place::BALANCE, true)?;
        add(format!("{count} probes, fitted"), &fitted, &mut text)?;
    }
    add("grid of 432, fitted".to_owned(), &rooms.grid(true)?[1], &mut text)?;
    save(&sheet(&shown, 2), DARK_GAIN, &folder.join("wall.png"))?;
    save(&sheet(&shown, 2), DARK_GAIN * BRIGHTENED, &folder.join("wall-bright.png"))?;
    Ok(text)
}

/// The table, and its rows; if `only_seeing` without probes that light passes walls from.
pub(crate) fn table(
    counts: &[usize],
    balances: &[f64],
    only_seeing: bool,
) -> Result<(String, Vec<Row>), Fault> {
    let site = Site::thin_wall();
    eprintln!("shprobe: both faces of a wall");
    let rooms = Rooms::new(&site)?;
    let mut rows = vec![];
    for distances in if only_seeing { &[true][..] } else { &[false, true] }.iter().copied() {
        let [seen, fitted] = rooms.grid(distances)?;
        rows.push(rooms.row("grid", &seen, distances)?);
        rows.push(rooms.row("grid, fitted", &fitted, distances)?);
        for (&count, &balance) in counts.iter().flat_map(|c| balances.iter().map(move |b| (c, b))) {
            let word = if balances.len() > 1 { format!(", balance {balance}") } else { String::new() };
            let [seen, fitted] = rooms.adaptive(count, balance, distances)?;
            rows.push(rooms.row(&format!("adaptive{word}"), &seen, distances)?);
            rows.push(rooms.row(&format!("adaptive, fitted{word}"), &fitted, distances)?);
            eprint!("{}", line(&rows[rows.len() - 2]));
            eprint!("{}", line(&rows[rows.len() - 1]));
        }
    }
    let mut text = TEXT.to_owned() + HEAD;
    rows.iter().for_each(|row| text += &line(row));
    Ok((text, rows))
}

fn line(row: &Row) -> String {
    let mut text = format!("| {} | {} |", row.name, row.probes);
    for error in [row.free, row.dark_room, row.dark_face, row.lit_face, row.surfaces] {
        let _ = write!(text, " {:.2} |", 100.0 * error);
    }
    text + "\n"
}
