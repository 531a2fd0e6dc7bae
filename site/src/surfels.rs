//! Surfels: a model sampled to discs, drawn with focus.
//!
//! * `surfels COUNT`: about so many discs of the model, as the fact `points`;
//! * `surfels-frame CAMERA APERTURE FOCUS PAPER`: a picture through a lens of that radius; the facts `drawn`, and `links` among these;
//! * `surfels-depth X Y`: the fact `depth` of that pixel of the last picture, infinite where nothing is.

use crate::model::Model;
use crate::paper::Paper;
use crate::reply::Reply;
use crate::request::Request;
use crate::{SiteError, camera};
use glam::{Vec3, dvec3};
use pointillist_surfel::{
    Cloud, Focus, Frame, Light, Method, Options, Points, Renderer, SampleOptions, SurfelError, sample,
};

/// Most discs: a phone has memory for these.
const MOST: u32 = 1_000_000;
const COLOR: Vec3 = Vec3::new(0.78, 0.62, 0.45);

pub(crate) struct Surfels {
    cloud: Cloud,
    renderer: Renderer,
    frame: Frame,
}

impl Surfels {
    pub(crate) fn new(model: &Model, request: &mut Request<'_>) -> Result<Self, SiteError> {
        let count = request.count("count", 1, MOST)? as usize;
        let cloud = if model.triangles.is_empty() {
            Cloud::new(&Points::new(&model.positions))?
        } else {
            of_triangles(model, count)?
        };
        Ok(Self { cloud, renderer: Renderer::new(), frame: Frame::new() })
    }

    pub(crate) fn describe(&self) -> Reply {
        Reply::default().with("points", [self.cloud.len()])
    }

    pub(crate) fn draw(&mut self, request: &mut Request<'_>) -> Result<Reply, SiteError> {
        let view = camera::read(request)?;
        let (aperture, focus) = (request.number("aperture")?, request.number("focus")?);
        let paper = Paper::read(request)?;
        // From over the left shoulder: a light at the eye shows no relief where a surface faces it.
        let light = view.view_from_world().matrix3.transpose() * dvec3(-0.5, 0.7, 1.0);
        let options = Options::DEFAULT
            .with_focus(Focus::Lens { aperture, focus })
            .with_light(Light::Towards(light))
            .with_ambient(0.15)
            .with_base(COLOR);
        self.renderer.draw(&self.cloud, &view, &options, &mut self.frame)?;
        let counts = self.frame.counts();
        let reply = Reply::default().with("drawn", [counts.points]).with("links", [counts.links]);
        Ok(reply.with_pixels(paper.under(self.frame.color())))
    }

    pub(crate) fn depth(&self, request: &mut Request<'_>) -> Result<Reply, SiteError> {
        let [width, height] = [self.frame.width(), self.frame.height()].map(|side| side as u32);
        let x = request.count("x", 0, width.saturating_sub(1))?;
        let y = request.count("y", 0, height.saturating_sub(1))?;
        let depth = self.frame.depth().get((y * width + x) as usize);
        Ok(Reply::default().with("depth", [depth.copied().unwrap_or(f32::INFINITY)]))
    }
}

fn of_triangles(model: &Model, count: usize) -> Result<Cloud, SurfelError> {
    // Blue noise looks better, but takes thirty times as long.
    let options = SampleOptions::DEFAULT.with_count(count).with_method(Method::Ldi);
    let points = sample(&model.positions, &model.triangles, &options)?;
    let positions: Vec<_> = points.iter().map(|p| p.position).collect();
    let normals: Vec<_> = points.iter().map(|p| p.normal.as_vec3()).collect();
    let radii: Vec<_> = points.iter().map(|p| p.radius).collect();
    Cloud::new(&Points::new(&positions).with_normals(&normals).with_radii(&radii))
}
