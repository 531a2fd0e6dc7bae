//! Draws the frames of a run one after the other, and keeps what does not move.
//!
//! Frames with all objects in the same places share one [`Prepared`]: only the camera is another. Where objects move, textures stay summed up.
//! A take is prepared when the first of its frames is drawn, so that frames that are there already cost nothing but a look into their files.

use super::kept::Kept;
use super::output::{OutputFormat, is_there, unseen_background, write_picture};
use super::plan::stamp;
use super::shots::Shot;
use crate::commands::Report;
use crate::error::CliError;
use crate::image_io::{Frame, Stamp};
use crate::job::interrupt::{self, Keeper};
use crate::job::{Piece, Progress, RenderJob, Watch};
use crate::options::RenderOptions;
use crate::scene::{LoadedScene, Motion, Scene, key_light};
use pointillist_render::{
    Camera, DrawOptions, Monitor, Prepared, PreparedMaps, RenderError, View, fingerprint,
};
use std::time::Instant;

/// What an interrupted run says at the end.
const GOES_ON: &str = "the same command goes on from there";

/// Everything that a run draws.
pub(super) struct Film<'a> {
    pub(super) options: &'a RenderOptions,
    pub(super) report: &'a Report<'a>,
    pub(super) format: OutputFormat,
    pub(super) job: RenderJob,
    pub(super) motion: Motion,
    /// At least one.
    pub(super) shots: Vec<Shot>,
}

/// Frames that share what is prepared.
struct Take<'s> {
    /// With all objects in their places.
    scene: &'s Scene,
    /// The scene with another camera has the light that was added for a model without any: it comes from beside the camera.
    is_lit_from_camera: bool,
    /// The hash of all but the camera.
    light: u64,
    prepared: Option<Prepared<'s>>,
    /// Of an earlier take: objects have moved since, textures have not.
    maps: Option<PreparedMaps>,
}

impl Take<'_> {
    /// The scene lit from beside another camera, if its light comes from there.
    fn relit(&self, camera: Camera) -> Option<Scene> {
        (self.is_lit_from_camera && camera != self.scene.camera).then(|| {
            let mut relit = self.scene.clone();
            relit.camera = camera;
            relit.lights = vec![key_light(&relit)];
            relit
        })
    }

    /// Prepares the scene, unless it is.
    fn prepare(&mut self, monitor: &dyn Monitor, report: &Report<'_>) -> Result<(), CliError> {
        if self.prepared.is_some() {
            return Ok(());
        }
        let prepared = match &self.maps {
            Some(maps) => Prepared::with_maps(self.scene, maps, monitor),
            None => Prepared::new(self.scene, monitor),
        };
        self.prepared = Some(prepared.map_err(failed)?);
        report.stats.count("preparations", 1);
        Ok(())
    }
}

impl Film<'_> {
    pub(super) fn draw(&self, loaded: LoadedScene) -> Result<(), CliError> {
        let LoadedScene { mut scene, light, is_lit_from_camera, .. } = loaded;
        let start = scene.camera;
        let progress = self.report.progress();
        if self.is_sequence() {
            progress.begin("render", self.shots.len() as u64 * Piece::UNITS);
        }
        let (mut done, mut maps) = (0, None);
        while let Some(first) = self.shots.get(done) {
            self.motion.pose(&mut scene, first.frame)?;
            let light =
                if self.motion.same_objects(first.frame, 0) { light } else { fingerprint::of_light(&scene) };
            let together = |shot: &&Shot| self.motion.same_objects(first.frame, shot.frame);
            let count = self.shots[done..].iter().take_while(together).count();
            let mut take = Take { scene: &scene, is_lit_from_camera, light, prepared: None, maps };
            for _ in 0..count {
                let camera = self.motion.camera(&start, self.shots[done].frame)?;
                self.draw_shot(done, camera, &mut take, &progress)?;
                done += 1;
                self.say_how_far(done);
            }
            maps = take.prepared.as_ref().map(Prepared::maps).or(take.maps);
        }
        progress.finish();
        Ok(())
    }

    fn is_sequence(&self) -> bool {
        self.shots.len() > 1
    }

    /// Draws one frame, unless it is there.
    fn draw_shot(
        &self,
        index: usize,
        camera: Camera,
        take: &mut Take<'_>,
        progress: &Progress,
    ) -> Result<(), CliError> {
        let Self { options, report, job, .. } = self;
        let begin = Instant::now();
        let relit = take.relit(camera);
        let scene = relit.as_ref().unwrap_or(take.scene);
        let light = relit.as_ref().map_or(take.light, fingerprint::of_light);
        let size = [scene.image.width, scene.image.height];
        let stamp = stamp(scene, fingerprint::of_view(&camera, size, light), job, options);
        let mut kept = Kept::of(&self.shots[index].output, &stamp);
        if self.is_there(index, &stamp) {
            kept.remove_unused(report);
            return Ok(());
        }
        let watch = Watch { task: "render", progress, stats: &report.stats };
        let piece = Piece::new(watch, index as u64, self.shots.len() as u64);
        let monitor: &dyn Monitor = if self.is_sequence() { &piece } else { &watch };
        take.prepare(monitor, report)?;
        let shared = take.prepared.as_ref().expect("prepared above");
        let own = relit.as_ref().map(|relit| shared.with_scene(relit)).transpose().map_err(failed)?;
        let prepared = own.as_ref().unwrap_or(shared);
        let view = camera.view(size).map_err(|error| failed(error.into()))?;
        // From here on there are tiles to keep, until the picture is written.
        let keeper = Keeper::new();
        let frame = self.draw_or_keep(index, prepared, view, &mut kept, monitor)?;
        let unseen = unseen_background(&frame, &scene.image, self.format, &options.picture);
        self.write(index, frame, stamp)?;
        kept.remove(report);
        drop(keeper);
        self.tell(index, begin, unseen.as_deref());
        if interrupt::is_requested() && index + 1 < self.shots.len() {
            return Err(CliError::Interrupted(self.how_far(index + 1)));
        }
        Ok(())
    }

    /// Whether a frame is there already, which is told.
    fn is_there(&self, index: usize, stamp: &Stamp) -> bool {
        let Self { options, report, job, .. } = self;
        let output = &self.shots[index].output;
        // Only EXR say what they show.
        let may_stay = self.format == OutputFormat::Exr && !options.picture.overwrite;
        if !may_stay || !is_there(output, stamp, job.window, report) {
            return false;
        }
        report.note(&format!("{} is already there; --overwrite draws it again", output.display()));
        report.stats.skip("pictures_there", 1);
        true
    }

    fn write(&self, index: usize, frame: Frame, stamp: Stamp) -> Result<(), CliError> {
        let (stats, output) = (&self.report.stats, &self.shots[index].output);
        stats.count("pixels", self.job.window.pixels());
        stats.count("pictures", 1);
        stats.stage("write", || write_picture(output, self.format, frame, stamp, &self.options.picture))
    }

    /// Tells of a frame that is written; `unseen` is for the first one.
    fn tell(&self, index: usize, begin: Instant, unseen: Option<&str>) {
        let Self { report, job, .. } = self;
        // The first picture's time is that of the whole command so far: reading the scene is part of it.
        let seconds = if index == 0 { report.stats.elapsed() } else { begin.elapsed() }.as_secs_f64();
        let (width, height) = (job.window.width(), job.window.height());
        let output = self.shots[index].output.display();
        report.note(&format!("{output}: {width}×{height} pixels in {seconds:.2} s"));
        if let Some(text) = unseen.filter(|_| index == 0) {
            report.note(text);
        }
    }

    /// Draws what an interrupted run has not, or keeps what is finished if this one is interrupted.
    fn draw_or_keep(
        &self,
        index: usize,
        prepared: &Prepared<'_>,
        view: View,
        kept: &mut Kept,
        monitor: &dyn Monitor,
    ) -> Result<Frame, CliError> {
        let (stats, job) = (&self.report.stats, &self.job);
        let options = DrawOptions::DEFAULT.with_window(job.window).with_layers(job.layers.clone());
        let mut picture = prepared.begin_view(view, &options).map_err(failed)?;
        stats.stage("load", || kept.restore(&mut picture, self.report));
        let start = Instant::now();
        let drawn = prepared.continue_view(&mut picture, monitor);
        stats.add_wall("tiles", start.elapsed());
        match drawn {
            // A request that came with the last tile has nothing left to end.
            Err(RenderError::Cancelled) if !picture.is_complete() => {
                let far = if self.is_sequence() { self.how_far(index) } else { GOES_ON.to_owned() };
                Err(CliError::Interrupted(format!("{}; {far}", kept.keep(&picture))))
            }
            Ok(()) | Err(RenderError::Cancelled) => Ok(picture.into_frame()),
            Err(error) => Err(failed(error)),
        }
    }

    /// For a signal between two frames, where nothing is to be kept.
    fn say_how_far(&self, done: usize) {
        if self.is_sequence() && done < self.shots.len() {
            interrupt::set_last_words(self.how_far(done));
        }
    }

    /// What of a film is there, and how it goes on: EXR that are there are known by their fingerprints, PNG and JPEG have none.
    fn how_far(&self, done: usize) -> String {
        let count = self.shots.len();
        let goes_on = match (self.format, self.shots.get(done), self.shots.last()) {
            (OutputFormat::Png | OutputFormat::Jpeg, Some(next), Some(last)) if done > 0 => {
                format!("go on with --frames {}-{}", next.frame, last.frame)
            }
            _ => GOES_ON.to_owned(),
        };
        format!("{done} of {count} frames are finished; {goes_on}")
    }
}

pub(super) fn failed(error: RenderError) -> CliError {
    CliError::Failed(error.to_string())
}
