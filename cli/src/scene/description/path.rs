//! `[camera.path]` and `path` of an object: values at times, and what is between them.

use crate::input_error::InputError;
use crate::options::LAST_FRAME;
use crate::scene::text::{Span, Table};
use glam::{DAffine3, DMat3, DQuat, DVec3};

/// How values go from one time to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// Straight, at constant speed.
    #[default]
    Linear,
    /// Smooth: through all values, with the slope from the one before to the one after.
    CatmullRom,
}

/// Times of a path, in frames, increasing.
#[derive(Clone, Debug, PartialEq)]
struct Times {
    times: Vec<f64>,
    interpolation: Interpolation,
}

/// Where the camera moves.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraPath {
    /// The place of the path, for messages.
    pub span: Span,
    times: Times,
    eye: Option<Vec<DVec3>>,
    target: Option<Vec<DVec3>>,
}

/// Where an object moves: what `path` says in the place of `translate` and `rotate`, after its scale or matrix.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectPath {
    /// The place of the path, for messages.
    pub span: Span,
    times: Times,
    translate: Vec<DVec3>,
    /// Unit quaternions.
    rotate: Vec<DQuat>,
    base: DMat3,
    base_shift: DVec3,
}

impl Times {
    fn read(table: &mut Table<'_>) -> Result<Self, InputError> {
        let Some(times) = table.numbers_list("times")? else { return Err(table.missing("times", "[0, 24]")) };
        let name = table.name_of("times");
        if times.is_empty() {
            return Err(table.error("times", format!("`{name}` is empty")).with_help("add times = [0, 24]"));
        }
        if let Some(i) = (1..times.len()).find(|&i| times[i] <= times[i - 1]) {
            let message =
                format!("`{name}[{i}]` is {}, which is not after the {} before it", times[i], times[i - 1]);
            return Err(table.error("times", message).with_help("times are in frames, and increase"));
        }
        let kinds = [("linear", Interpolation::Linear), ("catmull-rom", Interpolation::CatmullRom)];
        let interpolation = table.choice("interpolation", &kinds)?.unwrap_or_default();
        Ok(Self { times, interpolation })
    }

    /// The values of a key, one for each time.
    fn values(&self, table: &mut Table<'_>, key: &'static str) -> Result<Option<Vec<DVec3>>, InputError> {
        let Some(values) = table.vectors(key)? else { return Ok(None) };
        let (count, wanted) = (values.len(), self.times.len());
        if count != wanted {
            let message = format!("`{}` has {count} entries, and `times` has {wanted}", table.name_of(key));
            return Err(table.error(key, message).with_help("each time needs one value"));
        }
        Ok(Some(values))
    }

    /// The keys around a time, and how far it is from the first to the second. Before the first and after the last key, that key holds.
    fn between(&self, time: f64) -> (usize, usize, f64) {
        let after = self.times.partition_point(|&t| t <= time);
        if after == 0 || after == self.times.len() {
            let end = after.saturating_sub(1);
            return (end, end, 0.0);
        }
        let (a, b) = (self.times[after - 1], self.times[after]);
        (after - 1, after, (time - a) / (b - a))
    }

    fn point(&self, values: &[DVec3], time: f64) -> DVec3 {
        let (i, j, s) = self.between(time);
        if i == j || self.interpolation == Interpolation::Linear {
            return values[i].lerp(values[j], s);
        }
        // A cubic between two keys with the slopes there: Hermite's form, for keys that need not be evenly spaced.
        let slope = |k: usize| {
            let (before, after) = (k.saturating_sub(1), (k + 1).min(values.len() - 1));
            (values[after] - values[before]) / (self.times[after] - self.times[before])
        };
        let length = self.times[j] - self.times[i];
        let (s2, s3) = (s * s, s * s * s);
        values[i] * (2.0 * s3 - 3.0 * s2 + 1.0)
            + slope(i) * length * (s3 - 2.0 * s2 + s)
            + values[j] * (3.0 * s2 - 2.0 * s3)
            + slope(j) * length * (s3 - s2)
    }

    fn rotation(&self, values: &[DQuat], time: f64) -> DQuat {
        let (i, j, s) = self.between(time);
        if i == j { values[i] } else { values[i].slerp(values[j], s) }
    }
}

impl CameraPath {
    /// `path` in `[camera]`.
    pub(super) fn read(camera: &mut Table<'_>) -> Result<Option<Self>, InputError> {
        let Some(mut table) = camera.table("path")? else { return Ok(None) };
        let times = Times::read(&mut table)?;
        let eye = times.values(&mut table, "eye")?;
        let target = times.values(&mut table, "target")?;
        if eye.is_none() && target.is_none() {
            let message = "`camera.path` moves nothing: it has neither `eye` nor `target`";
            let help = "add eye = [[x, y, z], …], one for each time";
            return Err(table.error("times", message).with_help(help));
        }
        table.finish()?;
        Ok(Some(Self { span: camera.span_of("path"), times, eye, target }))
    }

    /// The first frame from which on the camera stands still, and not beyond the frames that can be asked for.
    pub fn last_frame(&self) -> u32 {
        let last = self.times.times.last().map_or(0.0, |last| last.ceil());
        last.clamp(0.0, f64::from(LAST_FRAME)) as u32
    }

    /// Eye and target at a frame, where the path has them.
    pub fn at(&self, frame: u32) -> (Option<DVec3>, Option<DVec3>) {
        let at = |values: &Option<Vec<DVec3>>| values.as_ref().map(|v| self.times.point(v, frame.into()));
        (at(&self.eye), at(&self.target))
    }
}

impl ObjectPath {
    /// `path` of an object with this transform: its `translate` and `rotate`, and its scale or matrix.
    pub(super) fn read(
        object: &mut Table<'_>,
        translate: DVec3,
        rotate: DQuat,
        base: DAffine3,
    ) -> Result<Option<Self>, InputError> {
        let Some(mut table) = object.table("path")? else { return Ok(None) };
        let times = Times::read(&mut table)?;
        let places = times.values(&mut table, "translate")?;
        let turns = times.values(&mut table, "rotate")?;
        if places.is_none() && turns.is_none() {
            let message = format!(
                "`{}` moves nothing: it has neither `translate` nor `rotate`",
                object.name_of("path")
            );
            let help = "add translate = [[x, y, z], …], one for each time";
            return Err(table.error("times", message).with_help(help));
        }
        table.finish()?;
        let count = times.times.len();
        let turns = turns.map(|turns| turns.into_iter().map(rotation).collect());
        Ok(Some(Self {
            span: object.span_of("path"),
            translate: places.unwrap_or_else(|| vec![translate; count]),
            rotate: turns.unwrap_or_else(|| vec![rotate; count]),
            times,
            base: base.matrix3,
            base_shift: base.translation,
        }))
    }

    /// How the object is turned at a frame.
    pub fn turn(&self, frame: u32) -> DMat3 {
        DMat3::from_quat(self.times.rotation(&self.rotate, frame.into()))
    }

    /// World from mesh at a frame.
    pub fn world_from_mesh(&self, frame: u32) -> DAffine3 {
        let turn = self.turn(frame);
        let place = self.times.point(&self.translate, frame.into());
        DAffine3 { matrix3: turn * self.base, translation: place + turn * self.base_shift }
    }
}

/// The rotation of angles in degrees, applied x, then y, then z.
pub(super) fn rotation(degrees: DVec3) -> DQuat {
    let radians = degrees * (std::f64::consts::PI / 180.0);
    DQuat::from_rotation_z(radians.z) * DQuat::from_rotation_y(radians.y) * DQuat::from_rotation_x(radians.x)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(times: &[f64], interpolation: Interpolation) -> Times {
        Times { times: times.to_vec(), interpolation }
    }

    #[test]
    fn values_hold_at_their_times_and_beyond_the_ends() {
        let values = [DVec3::X, DVec3::Y, DVec3::Z];
        for interpolation in [Interpolation::Linear, Interpolation::CatmullRom] {
            let path = times(&[2.0, 4.0, 10.0], interpolation);
            let at = [0.0, 2.0, 4.0, 10.0, 99.0].map(|t| path.point(&values, t));
            assert_eq!(at, [DVec3::X, DVec3::X, DVec3::Y, DVec3::Z, DVec3::Z], "{interpolation:?}");
        }
    }

    #[test]
    fn a_parabola_at_even_times_is_met_between_inner_keys() {
        // The slopes of Catmull and Rom are those of a parabola: x(t) = t² of even keys comes back exactly.
        let keys = [0.0, 1.0, 2.0, 3.0];
        let values = keys.map(|t| DVec3::X * (t * t));
        let path = times(&keys, Interpolation::CatmullRom);
        for t in [1.0, 1.25, 1.5, 1.9] {
            assert!((path.point(&values, t).x - t * t).abs() < 1e-12, "{t}");
        }
        assert_eq!(times(&keys, Interpolation::Linear).point(&values, 1.5).x, 2.5);
    }

    #[test]
    fn a_straight_line_stays_straight_whatever_the_times() {
        let keys = [0.0, 1.0, 5.0, 7.0];
        let values = keys.map(|t| DVec3::new(2.0 * t, 1.0, -t));
        let path = times(&keys, Interpolation::CatmullRom);
        for t in [0.3, 2.0, 4.9, 6.0] {
            assert!((path.point(&values, t) - DVec3::new(2.0 * t, 1.0, -t)).length() < 1e-12, "{t}");
        }
    }

    #[test]
    fn rotations_go_round_at_constant_speed() {
        let turns = [DVec3::ZERO, DVec3::Y * 90.0].map(rotation);
        let path = times(&[0.0, 9.0], Interpolation::Linear);
        for t in [0.0, 3.0, 6.0, 9.0] {
            let wanted = rotation(DVec3::Y * (10.0 * t));
            assert!(path.rotation(&turns, t).angle_between(wanted) < 1e-7, "{t}");
        }
    }
}
