//! What a frame is, whatever it shows.

use super::{OwnedPoints, check, cloud};
use crate::{Cloud, Frame, Options, Projection, Renderer, View};
use glam::{DVec3, Vec3};

/// Rounding allowed to opacities, to lengths of unit normals, and to a color that all points share.
pub const TOLERANCE: f32 = 1e-4;

/// A view from `eye` to `target`; `None` if there is none, or its up is along the way.
#[must_use]
pub fn look_at(eye: DVec3, target: DVec3, projection: Projection, width: u32, height: u32) -> Option<View> {
    View::look_at(eye, target, DVec3::Y, projection, width, height).ok()
}

/// A frame of its own by a renderer of its own; `None` if anything is refused.
#[must_use]
pub fn frame(points: &OwnedPoints, view: &View, options: &Options) -> Option<Frame> {
    drawn(&cloud(points).ok()?, view, options)
}

/// As [`frame`], of a cloud that is made already.
#[must_use]
pub fn drawn(cloud: &Cloud, view: &View, options: &Options) -> Option<Frame> {
    let mut frame = Frame::default();
    Renderer::new().draw(cloud, view, options, &mut frame).ok()?;
    Some(frame)
}

fn place(frame: &Frame, i: usize) -> String {
    format!("pixel ({}, {})", i % frame.width(), i / frame.width())
}

/// Two frames are the same, bit for bit.
///
/// # Errors
/// The first pixel that differs.
pub fn frames_are_identical(a: &Frame, b: &Frame) -> Result<(), String> {
    check((a.width(), a.height()) == (b.width(), b.height()), || "sizes differ".to_owned())?;
    let differ = |p: &[f32], q: &[f32]| p.iter().zip(q).any(|(x, y)| x.to_bits() != y.to_bits());
    for i in 0..a.width() * a.height() {
        let (p, q) = (&a.color()[i], &b.color()[i]);
        check(!differ(p, q), || format!("{}: colors {p:?} and {q:?}", place(a, i)))?;
        let (p, q) = (a.depth()[i], b.depth()[i]);
        check(!differ(&[p], &[q]), || format!("{}: depths {p} and {q}", place(a, i)))?;
    }
    for (i, (p, q)) in a.normal().iter().zip(b.normal()).enumerate() {
        check(!differ(p, q), || format!("{}: normals {p:?} and {q:?}", place(a, i)))?;
    }
    check(a.normal().len() == b.normal().len(), || "one frame has no normals".to_owned())
}

/// Two frames that may each be refused: both are, or they are the same.
pub(super) fn agree(a: Option<Frame>, b: Option<Frame>) -> Result<(), String> {
    match (a, b) {
        (Some(a), Some(b)) => frames_are_identical(&a, &b),
        (None, None) => Ok(()),
        _ => Err("one is refused, the other is not".to_owned()),
    }
}

/// No value is NaN; colors are premultiplied shares of what is at most `brightest`; there is depth, before the eye,
/// only where half a pixel or more is covered, and a unit normal only there.
///
/// # Errors
/// The first pixel that is otherwise.
pub fn frame_is_sound(frame: &Frame, brightest: f32) -> Result<(), String> {
    for i in 0..frame.width() * frame.height() {
        let (c, depth) = (frame.color()[i], frame.depth()[i]);
        let told = || format!("{}: {c:?}, depth {depth}", place(frame, i));
        check(c.iter().all(|v| *v >= 0.0 && v.is_finite()) && c[3] <= 1.0 + TOLERANCE, told)?;
        let most = brightest * c[3] * (1.0 + TOLERANCE) + f32::MIN_POSITIVE;
        check(c[..3].iter().all(|v| *v <= most), || format!("{} is brighter than {brightest}", told()))?;
        check(depth >= 0.0, told)?;
        check(c[3] >= 0.5 || depth == f32::INFINITY, || format!("{}: depth of little", told()))?;
        if let Some(n) = frame.normal().get(i) {
            let length = Vec3::from_array(*n).length();
            // A surface so far away that f32 has no number for its depth still has a normal, and opposite
            // normals may cancel out.
            let is = |wanted: f32| (length - wanted).abs() <= TOLERANCE;
            let holds = if c[3] >= 0.5 { is(1.0) || is(0.0) } else { is(0.0) };
            check(holds, || format!("{}, normal {n:?}", told()))?;
        }
    }
    Ok(())
}
