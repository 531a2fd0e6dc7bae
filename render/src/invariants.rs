//! Facts that hold for every scene, as functions: property tests and fuzz targets call the same ones.
//!
//! Each takes any input at all. A scene that is refused satisfies every fact.

use crate::{AmbientLight, DrawOptions, Frame, LayerKind, Matte, Prepared, RenderError, Scene};
use glam::{DAffine3, Vec3};
use pointillist_view::PixelRect;

/// Rounding of a pixel in ulps of `f32` (2⁻²³) of its brightest term: colours are sums in `f64` of terms rounded to `f32`.
pub const PIXEL_ULPS: f32 = 64.0;

/// How far colours of instances may be from those of their triangles, over the brightest one: parts that are hidden are cut in one case and left out in the
/// other.
const INSTANCE_TOLERANCE: f32 = 1e-5;

/// Every layer that does not depend on lights' names.
const LAYERS: [LayerKind; 9] = [
    LayerKind::Normal,
    LayerKind::Position,
    LayerKind::Albedo,
    LayerKind::Direct,
    LayerKind::Indirect,
    LayerKind::Id,
    LayerKind::Back,
    LayerKind::Cryptomatte(Matte::Object),
    LayerKind::Cryptomatte(Matte::Material),
];

/// The whole picture with all layers, or `None` for a scene that is refused.
#[must_use]
pub fn picture(scene: &Scene) -> Option<Frame> {
    let lit = (0..scene.lights.len()).map(LayerKind::Lit);
    let layers = LAYERS.into_iter().chain(lit).collect();
    crate::render(scene, &DrawOptions::DEFAULT.with_layers(layers), &()).ok()
}

/// Colours are finite and not negative, coverage and lit fractions lie in 0 to 1, depths are in front of the eye, and a pixel in
/// which nothing is has the background's colour.
///
/// # Errors
/// The first pixel that does not.
pub fn pixels_are_sound(scene: &Scene) -> Result<(), String> {
    let Some(frame) = picture(scene) else { return Ok(()) };
    let background = scene.image.background.to_array();
    let above_one = 1.0 + PIXEL_ULPS * f32::EPSILON;
    for (i, (color, &depth)) in frame.color.iter().zip(&frame.depth).enumerate() {
        let fine = color.iter().all(|v| v.is_finite() && *v >= 0.0) && color[3] <= 1.0;
        if !fine {
            return Err(format!("pixel {i} is {color:?}"));
        }
        if depth.is_nan() || depth < 0.0 || (color[3] > 0.0) != (depth < f32::INFINITY) {
            return Err(format!("pixel {i} of coverage {} has depth {depth}", color[3]));
        }
        if color[3] == 0.0 && scene.image.environment.is_none() && color[..3] != background {
            return Err(format!("pixel {i} shows nothing and is {color:?} instead of {background:?}"));
        }
    }
    for layer in &frame.layers {
        let is_share = layer.channels[0].starts_with("lit.") || layer.channels[0] == "back";
        let range = if is_share { 0.0..=above_one } else { f32::MIN..=f32::MAX };
        for (channel, plane) in layer.channels.iter().zip(&layer.planes) {
            if let Some(i) = plane.iter().position(|v| !range.contains(v)) {
                return Err(format!("{channel} of pixel {i} is {}", plane[i]));
            }
        }
    }
    Ok(())
}

/// A part of a picture, drawn by itself, has the pixels that it has in the whole, bit for bit.
///
/// # Errors
/// What differs.
pub fn windows_do_not_matter(scene: &Scene, window: PixelRect) -> Result<(), String> {
    let Some(whole) = picture(scene) else { return Ok(()) };
    let window = window.intersection(&whole.window);
    let kinds = LAYERS.into_iter().chain((0..scene.lights.len()).map(LayerKind::Lit));
    let options = DrawOptions::DEFAULT.with_layers(kinds.collect()).with_window(window);
    let part = crate::render(scene, &options, &()).map_err(|e| format!("the part is refused: {e}"))?;
    frames_are_identical(&part, &cut(&whole, window))
}

/// Two frames are the same, bit for bit.
///
/// # Errors
/// What differs.
pub fn frames_are_identical(a: &Frame, b: &Frame) -> Result<(), String> {
    if (a.size, a.window) != (b.size, b.window) {
        return Err(format!("{:?} {:?} and {:?} {:?}", a.size, a.window, b.size, b.window));
    }
    let bits = |f: &Frame| -> Vec<Vec<u32>> {
        let colors = f.color.iter().flatten().map(|v| v.to_bits()).collect();
        let depths = f.depth.iter().map(|v| v.to_bits()).collect();
        let planes = f.layers.iter().flat_map(|l| &l.planes);
        [colors, depths].into_iter().chain(planes.map(|p| p.iter().map(|v| v.to_bits()).collect())).collect()
    };
    match bits(a).iter().zip(&bits(b)).position(|(a, b)| a != b) {
        None => Ok(()),
        Some(0) => Err("colours differ".to_owned()),
        Some(1) => Err("depths differ".to_owned()),
        Some(i) => Err(format!("plane {} differs", i - 2)),
    }
}

/// The same scene with its mesh as a shape, too, that stands in further places: `None` if it has no objects, or a place is refused.
#[must_use]
pub fn with_instances(scene: &Scene, places: &[DAffine3]) -> Option<Scene> {
    let mut scene = scene.clone();
    let mut shape = scene.mesh.clone();
    shape.objects.truncate(1);
    shape.object_of.fill(0);
    let shape = scene.mesh.add_shape(shape).ok()?;
    for (i, &place) in places.iter().enumerate() {
        scene.mesh.add_instance(shape, &format!("instance {i}"), place).ok()?;
    }
    Some(scene)
}

/// Triangles that are stored once are drawn in their places as if they were stored there: the same colours to rounding, in places that are no others'
/// and touch no others, because what touches may be closed together and open by itself.
///
/// # Errors
/// What differs.
pub fn instances_are_drawn_as_their_triangles(scene: &Scene) -> Result<(), String> {
    let mut expanded = scene.clone();
    expanded.mesh = scene.mesh.expanded().map_err(|error| error.to_string())?.into_owned();
    let draw = |scene: &Scene| crate::render(scene, &DrawOptions::DEFAULT, &()).map(|frame| frame.color);
    match (draw(scene), draw(&expanded)) {
        (Ok(a), Ok(b)) => {
            let brightest = b.iter().flatten().fold(1.0_f32, |most, v| most.max(v.abs()));
            let apart = |(i, (a, b)): (usize, (&[f32; 4], &[f32; 4]))| {
                let difference = (0..4).map(|k| (a[k] - b[k]).abs()).fold(0.0, f32::max);
                (difference > INSTANCE_TOLERANCE * brightest).then(|| format!("pixel {i}: {a:?} and {b:?}"))
            };
            a.iter().zip(&b).enumerate().find_map(apart).map_or(Ok(()), Err)
        }
        (Err(_), Err(_)) => Ok(()),
        (a, b) => Err(format!("{:?} and {:?}", a.err(), b.err())),
    }
}

/// Where nothing glows, a colour is direct light plus ambient light plus what of the background is seen. Of that only a mean over the colours is
/// known if materials let them pass differently; the background is black then.
///
/// # Errors
/// The first pixel for which it is not.
pub fn light_adds_up(scene: &Scene) -> Result<(), String> {
    let mut scene = scene.clone();
    scene.image.environment = None;
    for material in &mut scene.materials {
        material.surface.emission = Vec3::ZERO;
        material.details.emission_map = None;
        material.details.emits = false;
    }
    let tints = |passes: Vec3| passes != Vec3::splat(passes.x);
    if scene.materials.iter().any(|material| tints(material.details.passes_straight())) {
        scene.image.background = Vec3::ZERO;
    }
    let Some(frame) = picture(&scene) else { return Ok(()) };
    let planes =
        |name: &str| frame.layers.iter().find(|l| l.channels[0].starts_with(name)).map(|l| &l.planes);
    let (Some(direct), Some(indirect)) = (planes("direct"), planes("indirect")) else {
        return Err("layers are missing".to_owned());
    };
    for (i, color) in frame.color.iter().enumerate() {
        for c in 0..3 {
            let open = (1.0 - color[3]) * scene.image.background[c];
            let sum = direct[c][i] + indirect[c][i] + open;
            let bound =
                PIXEL_ULPS * f32::EPSILON * (direct[c][i] + indirect[c][i] + scene.image.background[c]);
            // Coverage is rounded to f32, which is all that is left of it in the last term.
            if (color[c] - sum).abs() > bound {
                return Err(format!("pixel {i}: {} is not {sum} within {bound:e}", color[c]));
            }
        }
    }
    Ok(())
}

/// In even ambient light, white surfaces without lights show it as it is: what is seen has the light's colour times its coverage.
///
/// # Errors
/// The first pixel for which it has not.
pub fn white_surfaces_show_even_light_as_it_is(scene: &Scene, light: Vec3) -> Result<(), String> {
    let mut scene = scene.clone();
    scene.lights.clear();
    scene.mesh.colors.clear();
    scene.image.environment = None;
    scene.image.background = Vec3::ZERO;
    scene.ambient = AmbientLight::Color(light);
    for material in &mut scene.materials {
        let opacity = material.surface.opacity;
        material.surface = crate::shade::Material::lambert(Vec3::ONE).with_opacity(opacity);
        material.diffuse_map = None;
        material.details = crate::Details::default();
    }
    let Some(frame) = picture(&scene) else { return Ok(()) };
    for (i, color) in frame.color.iter().enumerate() {
        for c in 0..3 {
            let wanted = light[c] * color[3];
            if (color[c] - wanted).abs() > PIXEL_ULPS * f32::EPSILON * light[c] {
                return Err(format!("pixel {i}: {} is not {wanted}", color[c]));
            }
        }
    }
    Ok(())
}

/// One preparation serves any number of pictures: each is the same as from a preparation of its own.
///
/// # Errors
/// What differs, or which of the two was refused.
pub fn pictures_do_not_depend_on_those_before(scene: &Scene) -> Result<(), String> {
    let draw = |prepared: &Prepared<'_>| prepared.draw(&DrawOptions::DEFAULT, &());
    let twice = Prepared::new(scene, &()).and_then(|prepared| Ok([draw(&prepared)?, draw(&prepared)?]));
    let alone: Result<Frame, RenderError> = crate::render(scene, &DrawOptions::DEFAULT, &());
    match (twice, alone) {
        (Ok([first, second]), Ok(alone)) => {
            frames_are_identical(&first, &alone).and_then(|()| frames_are_identical(&second, &alone))
        }
        (Err(_), Err(_)) => Ok(()),
        (twice, alone) => Err(format!("{:?} and {:?}", twice.err(), alone.err())),
    }
}

/// A part of a frame.
fn cut(frame: &Frame, window: PixelRect) -> Frame {
    let stride = frame.window.width();
    let rows = (window.y0..window.y1).flat_map(|y| (window.x0..window.x1).map(move |x| (x, y)));
    let indices: Vec<usize> = rows.map(|(x, y)| (y * stride + x) as usize).collect();
    let mut part = frame.clone();
    part.window = window;
    part.color = indices.iter().map(|&i| frame.color[i]).collect();
    part.depth = indices.iter().map(|&i| frame.depth[i]).collect();
    for plane in part.layers.iter_mut().flat_map(|l| &mut l.planes) {
        *plane = indices.iter().map(|&i| plane[i]).collect();
    }
    part
}
