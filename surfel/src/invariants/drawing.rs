//! What must not change a frame, and what must not change in it.

use super::frames::agree;
use super::{OwnedPoints, TOLERANCE, check, cloud, drawn, frame, frame_is_sound, frames_are_identical};
use crate::packed::{pack_color, unpack_color};
use crate::{Focus, Frame, Options, Renderer, View};

/// Any input gives a sound frame or is refused.
///
/// # Errors
/// As [`frame_is_sound`].
pub fn frames_are_sound(points: &OwnedPoints, view: &View, options: &Options) -> Result<(), String> {
    let Some(frame) = frame(points, view, options) else { return Ok(()) };
    let brightest = match &points.colors {
        // Links round colors to 1/512 of the brightest channel.
        Some(colors) => (1.0 + 1.0 / 512.0) * colors.iter().flatten().fold(0.0f32, |m, c| m.max(*c)),
        None => options.base.max_element(),
    };
    frame_is_sound(&frame, brightest)
}

/// The order of points does not show.
///
/// # Errors
/// As [`frames_are_identical`].
pub fn order_does_not_matter(
    points: &OwnedPoints,
    view: &View,
    options: &Options,
    seed: u64,
) -> Result<(), String> {
    agree(frame(points, view, options), frame(&points.shuffled(seed), view, options))
}

/// A renderer and a frame that drew something else before draw the same as new ones.
///
/// # Errors
/// As [`frames_are_identical`].
pub fn use_before_does_not_matter(
    points: &OwnedPoints,
    before: (&View, &Options),
    after: (&View, &Options),
) -> Result<(), String> {
    let Ok(cloud) = cloud(points) else { return Ok(()) };
    let Some(fresh) = frame(points, after.0, after.1) else { return Ok(()) };
    let (mut renderer, mut used) = (Renderer::new(), Frame::default());
    // A refusal is something else too.
    let _ = renderer.draw(&cloud, before.0, before.1, &mut used);
    renderer.draw(&cloud, after.0, after.1, &mut used).map_err(|e| e.to_string())?;
    frames_are_identical(&fresh, &used)
}

/// What is skipped because it faces away or is hidden does not show.
///
/// # Errors
/// As [`frames_are_identical`].
pub fn culling_changes_nothing(points: &OwnedPoints, view: &View, options: &Options) -> Result<(), String> {
    let Ok(cloud) = cloud(points) else { return Ok(()) };
    let by = |culling| drawn(&cloud, view, &Options { culling, ..*options });
    agree(by(true), by(false))
}

/// No blur is no depth of field, at any focus.
///
/// # Errors
/// As [`frames_are_identical`].
pub fn no_blur_is_no_depth_of_field(
    points: &OwnedPoints,
    view: &View,
    options: &Options,
    focus: f64,
) -> Result<(), String> {
    let Ok(cloud) = cloud(points) else { return Ok(()) };
    let by = |focus| drawn(&cloud, view, &Options { focus, ..*options });
    let sharp = by(Focus::Everywhere);
    for blurred in [by(Focus::Depth { depth: 0.0, focus }), by(Focus::Lens { aperture: 0.0, focus })] {
        if blurred.is_some() {
            agree(sharp.clone(), blurred)?;
        }
    }
    Ok(())
}

/// A thin lens is the paper's parameter d = aperture / focus.
///
/// # Errors
/// As [`frames_are_identical`].
pub fn a_lens_is_a_depth(
    points: &OwnedPoints,
    view: &View,
    options: &Options,
    aperture: f64,
    focus: f64,
) -> Result<(), String> {
    let Ok(cloud) = cloud(points) else { return Ok(()) };
    let by = |focus| drawn(&cloud, view, &Options { focus, ..*options });
    let depth = by(Focus::Depth { depth: aperture / focus, focus });
    // A quotient beyond the range of numbers is refused as a depth only.
    if depth.is_some() { agree(by(Focus::Lens { aperture, focus }), depth) } else { Ok(()) }
}

/// Points of opacity 1 are those that have none.
///
/// # Errors
/// As [`frames_are_identical`].
pub fn opaque_points_need_no_opacities(
    points: &OwnedPoints,
    view: &View,
    options: &Options,
) -> Result<(), String> {
    let without = OwnedPoints { opacities: None, ..points.clone() };
    agree(frame(&points.thinned(|_| 1.0), view, options), frame(&without, view, options))
}

/// What light sees in the place of the normals changes neither what is covered nor how deep it lies.
///
/// # Errors
/// The first pixel that differs.
pub fn shading_normals_only_shade(
    points: &OwnedPoints,
    view: &View,
    options: &Options,
) -> Result<(), String> {
    if points.shading_normals.is_none() {
        return Ok(());
    }
    let without = OwnedPoints { shading_normals: None, ..points.clone() };
    let (Some(a), Some(b)) = (frame(points, view, options), frame(&without, view, options)) else {
        return Ok(());
    };
    let bits = |frame: &Frame, i: usize| [frame.color()[i][3], frame.depth()[i]].map(f32::to_bits);
    match (0..a.color().len()).find(|&i| bits(&a, i) != bits(&b, i)) {
        Some(i) => {
            Err(format!("pixel {i}: opacity and depth {:x?}, without {:x?}", bits(&a, i), bits(&b, i)))
        }
        None => Ok(()),
    }
}

/// Points of one color (at most 65,408), lit from everywhere, show that color wherever anything is seen; with links, as
/// exactly as these keep it.
///
/// # Errors
/// The first pixel of another color.
pub fn one_color_stays_one_color(
    points: &OwnedPoints,
    view: &View,
    options: &Options,
    color: [f32; 3],
) -> Result<(), String> {
    let options = Options { ambient: 1.0, ..*options };
    let Some(frame) = frame(&points.painted(|_| color), view, &options) else { return Ok(()) };
    let most = color.iter().fold(0.0f32, |m, c| m.max(*c));
    let is_kept = unpack_color(pack_color(color)) == color;
    let slack = most * if is_kept { TOLERANCE } else { TOLERANCE + 1.0 / 512.0 };
    let same = |c: &[f32; 4]| c[..3].iter().zip(color).all(|(v, w)| (v - w * c[3]).abs() <= slack * c[3]);
    match frame.color().iter().position(|c| !same(c)) {
        Some(i) => {
            let (x, y) = (i % frame.width(), i / frame.width());
            Err(format!("pixel ({x}, {y}): {:?}, not {color:?}", frame.color()[i]))
        }
        None => Ok(()),
    }
}

/// Two frames differ only by a factor of all depths.
///
/// # Errors
/// The first pixel that differs.
pub fn frames_are_identical_but_for_size(a: &Frame, b: &Frame, k: f64) -> Result<(), String> {
    let scaled = a.depth().iter().map(|d| (f64::from(*d) * k) as f32);
    for (i, (wanted, got)) in scaled.zip(b.depth()).enumerate() {
        // Below 1e-38, a depth has fewer digits than its multiple.
        let holds = wanted == *got || wanted.abs() < f32::MIN_POSITIVE || !a.depth()[i].is_normal();
        check(holds, || format!("pixel {i}: depths {wanted} and {got}"))?;
    }
    let colors = a.color() == b.color() && a.normal() == b.normal();
    check(colors, || "colors or normals differ".to_owned())
}
