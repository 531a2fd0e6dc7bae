//! Frames of point clouds: drawn, timed, and compared with the truth.

use pointillist_surfel::{
    Cloud, Focus, Frame, FrameCounts, Light, Method, Options, Procedure, Projection, Renderer, SurfelError,
    View,
};

use crate::common::picture_layers::PictureLayers;
use crate::common::report::on_one_thread;
use crate::common::timing::{Clock, Ratio, Timing, ratio, timed, timed_by};
use crate::common::true_surface::Surface;
use crate::surfel::layer_error::LayerMeasure;
use crate::surfel::lens_camera::{LensCamera, Matt};
use crate::surfel::lens_reference::trace;
use crate::surfel::measured::Measured;

/// Both.
pub(crate) const PROCEDURES: [Procedure; 2] = [Procedure::Blended, Procedure::Paper];

/// Where the random numbers of the truth begin.
const SEED: u64 = 1;

/// How much trouble is taken.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Effort {
    /// Rays per pixel of the truth, without a lens and with one.
    pub(crate) rays: [u32; 2],
    /// How large clouds are sampled.
    pub(crate) method: Method,
    /// Points of the largest cloud.
    pub(crate) most_points: usize,
    /// Numbers of views from all over the lens.
    pub(crate) views: &'static [u32],
    /// Between the view and the normal of two sheets, degrees.
    pub(crate) slants_deg: &'static [f64],
    /// Numbers of points of a rough surface in which specks are counted.
    pub(crate) speckled: &'static [usize],
    /// How far away the eye is, in distances of the front view, and how large the object looks then.
    pub(crate) sizes: &'static [(f64, &'static str)],
    /// Pixels between points.
    pub(crate) levels: &'static [f32],
    /// Largest radius of blur in pixels of the paper's picture, about, beginning with none.
    pub(crate) blurs: &'static [u32],
}

/// The default of [`pointillist_surfel::Options::level`].
pub(crate) const DEFAULT_LEVEL: f32 = 1.27;

/// The lens of the reference picture blurs by so many pixels.
pub(crate) const REFERENCE_BLUR: u32 = 16;

impl Effort {
    pub(crate) const FULL: Self = Self {
        rays: [64, 256],
        method: Method::Poisson,
        most_points: 1_274_573,
        views: &[4, 16, 64],
        slants_deg: &[0.0, 45.0, 60.0, 75.0],
        speckled: &[50_000, 100_000, 400_000],
        sizes: &[(1.0, "full size"), (2.0, "1/2 size"), (4.0, "1/4 size"), (8.0, "1/8 size")],
        levels: &[0.0, 0.5, 1.0, DEFAULT_LEVEL, 2.0, 3.0, 4.0],
        blurs: &[0, 2, 6, REFERENCE_BLUR, 32],
    };
    /// Enough to see that all works.
    pub(crate) const QUICK: Self = Self {
        rays: [4, 16],
        method: Method::Ldi,
        most_points: 500_000,
        views: &[4, 16],
        slants_deg: &[0.0],
        speckled: &[50_000],
        sizes: &[(1.0, "full size"), (8.0, "1/8 size")],
        levels: &[0.0, DEFAULT_LEVEL],
        blurs: &[0, REFERENCE_BLUR],
    };
}

/// Processor seconds on one thread, and seconds on all.
pub(crate) fn times(
    mut work: impl FnMut() -> Result<(), SurfelError> + Send,
) -> Result<[Timing; 2], SurfelError> {
    let (cpu, done) = on_one_thread(|| timed_by(Clock::Processor, &mut work));
    done?;
    let (wall, done) = timed(work);
    done?;
    Ok([cpu, wall])
}

/// Processor time of some work over that of another, both in turns on one thread.
pub(crate) fn in_turns(
    mut work: impl FnMut() -> Result<(), SurfelError> + Send,
    mut other: impl FnMut() -> Result<(), SurfelError> + Send,
) -> Result<Ratio, SurfelError> {
    let (mut own, mut others) = (Ok(()), Ok(()));
    let found = on_one_thread(|| {
        let work = || own = own.clone().and_then(|()| work());
        let other = || others = others.clone().and_then(|()| other());
        ratio(Clock::Processor, work, other)
    });
    own.and(others).map(|()| found)
}

/// Something to draw, with its truth.
pub(crate) struct Stage {
    pub(crate) name: String,
    pub(crate) camera: LensCamera,
    pub(crate) matt: Matt,
    pub(crate) measure: LayerMeasure,
}

impl Stage {
    pub(crate) fn new(
        name: &str,
        surface: &Surface,
        (camera, matt): (LensCamera, Matt),
        effort: &Effort,
    ) -> Self {
        eprintln!("surfel: {name}: truth");
        let rays = effort.rays[usize::from(camera.aperture > 0.0)];
        let truth = trace(surface, &camera, &|p, n| matt.radiance(p, n), rays, SEED);
        let measure = LayerMeasure::new(truth);
        Self { name: name.to_owned(), camera, matt, measure }
    }

    /// The defaults in the light of this scene, through its lens.
    pub(crate) fn options(&self, procedure: Procedure) -> Options {
        options(&self.camera, &self.matt, procedure)
    }

    /// Draws a frame and says what it costs and how wrong it is.
    pub(crate) fn measured(
        &self,
        cloud: &Cloud,
        setting: String,
        options: &Options,
    ) -> Result<Measured, SurfelError> {
        let times = times(self.frames(cloud, options))?;
        let (picture, counts) = drawn(cloud, &self.camera, options)?;
        let series = name(options.procedure);
        Ok(self.row(cloud, (series, setting), counts.points, times, &picture))
    }

    /// [`measured`](Self::measured), and how much longer the same takes than in another scene or of another cloud.
    pub(crate) fn compared(
        &self,
        cloud: &Cloud,
        setting: String,
        options: &Options,
        (other, other_cloud): (&Self, &Cloud),
    ) -> Result<Measured, SurfelError> {
        let others = at_level(options.level, other.options(options.procedure));
        let ratio = in_turns(self.frames(cloud, options), other.frames(other_cloud, &others))?;
        Ok(Measured { ratio: Some(ratio), ..self.measured(cloud, setting, options)? })
    }

    /// Draws one more frame each time that it is called.
    pub(crate) fn frames<'a>(
        &self,
        cloud: &'a Cloud,
        options: &'a Options,
    ) -> impl FnMut() -> Result<(), SurfelError> + Send + use<'a> {
        let (view, mut renderer, mut frame) = (view(&self.camera), Renderer::new(), Frame::default());
        move || renderer.draw(cloud, &view, options, &mut frame)
    }

    /// What was measured of a picture, as the report has it.
    pub(crate) fn row(
        &self,
        cloud: &Cloud,
        (series, setting): (&'static str, String),
        points: usize,
        [cpu, wall]: [Timing; 2],
        picture: &PictureLayers,
    ) -> Measured {
        let error = self.measure.of(picture);
        let (scene, spacing) = (self.name.clone(), cloud.spacing());
        Measured { scene, series, setting, points, cpu, wall, ratio: None, error, spacing }
    }
}

/// The same at another level of detail.
pub(crate) fn at_level(level: f32, mut options: Options) -> Options {
    options.level = level;
    options
}

/// What reports call it.
pub(crate) fn name(procedure: Procedure) -> &'static str {
    match procedure {
        Procedure::Blended => "blended",
        Procedure::Paper => "paper",
    }
}

/// The defaults in this light, through this lens; the paper's procedure gets its own parameter.
pub(crate) fn options(camera: &LensCamera, matt: &Matt, procedure: Procedure) -> Options {
    let LensCamera { aperture, focus, .. } = *camera;
    let mut options = Options::default();
    (options.procedure, options.light) = (procedure, Light::Towards(matt.light));
    options.ambient = matt.ambient as f32;
    options.focus = match procedure {
        _ if aperture == 0.0 => Focus::Everywhere,
        Procedure::Blended => Focus::Lens { aperture, focus },
        Procedure::Paper => Focus::Depth { depth: aperture / focus, focus },
    };
    options
}

pub(crate) fn view(camera: &LensCamera) -> View {
    let projection = Projection::Perspective { fov_y_rad: camera.fov_y_rad };
    View::from_matrix(camera.view_from_world(), projection, camera.width, camera.height)
        .expect("the cameras of this study are rigid and of a size that can be drawn")
}

/// A frame with all its layers.
pub(crate) fn drawn(
    cloud: &Cloud,
    camera: &LensCamera,
    options: &Options,
) -> Result<(PictureLayers, FrameCounts), SurfelError> {
    let (mut options, mut frame) = (*options, Frame::default());
    options.surface_layers = true;
    Renderer::new().draw(cloud, &view(camera), &options, &mut frame)?;
    Ok((PictureLayers::of(&frame), *frame.counts()))
}
