//! Range scans: a model scanned from nine sides with noise, and drawn from the raw points.
//!
//! * `scans RAYS NOISE`: so many rays along the longest side of the model, errors of depth in units of the rays' distance; the facts `points` and
//!   `spacing`;
//! * `scans-frame CAMERA LOOK GAMMA PAPER`: a picture; look `surface`, `stations` (each in a colour of its own) or `points` (just these). The
//!   fact `pixel` is the size of a pixel of the buffer, in pixels of the picture.

use crate::model::Model;
use crate::paper::Paper;
use crate::reply::Reply;
use crate::request::Request;
use crate::scanner::{Random, STATIONS, Scanner};
use crate::{SiteError, camera};
use glam::{DVec3, Vec3, dvec3};
use pointillist_ibpr::{Cloud, Frame, IbprError, Light, Options, Renderer, Scan};
use pointillist_view::View;

const MOST_RAYS: u32 = 600;
/// One start for all: another noise is the same picture again, noisier.
const SEED: u64 = 1;
const COLOR: Vec3 = Vec3::new(0.78, 0.62, 0.45);

/// How points are shown.
#[derive(Clone, Copy)]
enum Look {
    Surface,
    Stations,
    Points,
}

pub(crate) struct Scans {
    /// By station.
    points: Vec<Vec<DVec3>>,
    plain: Cloud,
    /// The same points, in the colours of their stations.
    colored: Cloud,
    renderer: Renderer,
    frame: Frame,
}

impl Scans {
    pub(crate) fn new(model: &Model, request: &mut Request<'_>) -> Result<Self, SiteError> {
        let rays = request.count("rays", 8, MOST_RAYS)?;
        let noise = request.number("noise")?.clamp(0.0, 10.0);
        let points = scan(model, model.extent() / f64::from(rays), noise);
        let colors: Vec<_> = points.iter().zip(0..).map(|(p, i)| vec![color(i); p.len()]).collect();
        let scans: Vec<_> = points.iter().zip(STATIONS).map(|(p, s)| Scan::new(p).with_scanner(s)).collect();
        let colored: Vec<_> = scans.iter().zip(&colors).map(|(scan, c)| scan.with_colors(c)).collect();
        Ok(Self {
            plain: cloud(&scans)?,
            colored: cloud(&colored)?,
            points,
            renderer: Renderer::new(),
            frame: Frame::new(),
        })
    }

    pub(crate) fn describe(&self) -> Reply {
        Reply::default().with("points", [self.plain.len()]).with("spacing", [self.plain.spacing()])
    }

    pub(crate) fn draw(&mut self, request: &mut Request<'_>) -> Result<Reply, SiteError> {
        let view = camera::read(request)?;
        let looks = [("surface", Look::Surface), ("stations", Look::Stations), ("points", Look::Points)];
        let look = request.one_of("look", "surface, stations or points", &looks)?;
        let gamma = request.number("gamma")? as f32;
        let paper = Paper::read(request)?;
        let cloud = match look {
            Look::Surface => &self.plain,
            Look::Stations => &self.colored,
            Look::Points => return Ok(Reply::default().with_pixels(paper.under(&self.dots(&view)))),
        };
        let light = view.view_from_world().matrix3.transpose() * dvec3(-0.5, 0.7, 1.0);
        let options = Options::DEFAULT
            .with_gamma(gamma)
            .with_light(Light::Towards(light))
            .with_ambient(0.15)
            .with_base(COLOR);
        self.renderer.draw(cloud, &view, &options, &mut self.frame)?;
        let reply = Reply::default().with("pixel", [self.frame.counts().scale]);
        Ok(reply.with_pixels(paper.under(self.frame.color())))
    }

    /// Each point as one pixel: what the scanner gave.
    fn dots(&self, view: &View) -> Vec<[f32; 4]> {
        let (width, height) = (view.width() as usize, view.height() as usize);
        let mut pixels = vec![[0.0; 4]; width * height];
        let mut depths = vec![f64::INFINITY; width * height];
        for (points, station) in self.points.iter().zip(0..) {
            for found in points.iter().filter_map(|&p| view.project(p)) {
                let place = found.pixel.floor();
                let is_inside = place.x >= 0.0 && place.y >= 0.0;
                let (x, y) = (place.x as usize, place.y as usize);
                if is_inside && x < width && y < height && found.depth < depths[y * width + x] {
                    depths[y * width + x] = found.depth;
                    let [r, g, b] = color(station);
                    pixels[y * width + x] = [r, g, b, 1.0];
                }
            }
        }
        pixels
    }
}

fn scan(model: &Model, spacing: f64, noise: f64) -> Vec<Vec<DVec3>> {
    let mut random = Random(SEED);
    STATIONS.iter().map(|&station| Scanner::new(station, spacing).scan(model, noise, &mut random)).collect()
}

fn cloud(scans: &[Scan<'_>]) -> Result<Cloud, IbprError> {
    Cloud::new(scans, COLOR)
}

/// A colour for each station, different from those beside it.
fn color(station: usize) -> [f32; 3] {
    const COLORS: [[f32; 3]; 3] = [[0.80, 0.33, 0.10], [0.10, 0.45, 0.70], [0.25, 0.55, 0.15]];
    COLORS[station % COLORS.len()]
}
