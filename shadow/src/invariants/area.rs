//! Facts about lights with an area.

use super::check;
use crate::{AreaLight, AreaOptions, AreaScratch, LineLight, LineScratch, Receivers, Viewer};
use glam::DVec3;
use pointillist_micropoint::invariants::{Soup, permutation};
use pointillist_micropoint::{Geometry, MicropointOptions, PixelRect, PlainOpacity, Renderer, Tile, View};

/// What a point of a visible surface sees of a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenPoint {
    /// Position of its triangle in the caller's array.
    pub triangle: u32,
    /// Its surface.
    pub surface: u32,
    /// Where it is.
    pub position: DVec3,
    /// Unit normal of its surface on the side that is seen.
    pub normal: DVec3,
    /// The share of its receiver that it stands for.
    pub weight: f64,
    /// The visible share of the light's area.
    pub area: f64,
    /// The form factor of what is visible.
    pub share: f64,
}

/// What each pixel sees, row by row.
pub type SeenPicture = Vec<Vec<SeenPoint>>;

/// The outline of a light, or the ends of a line that shines.
#[derive(Clone, Copy, Debug)]
pub(super) enum Shape<'a> {
    Polygon(&'a [DVec3]),
    Line([DVec3; 2]),
}

/// A light of either shape.
enum Asked<'a> {
    Area(AreaLight<'a>),
    Line(LineLight<'a>),
}

/// What is seen of it.
struct Part<'p> {
    position: DVec3,
    extent: f64,
    share: &'p dyn Fn(DVec3) -> f64,
}

impl Asked<'_> {
    fn extent(&self) -> f64 {
        match self {
            Self::Area(light) => light.area(),
            Self::Line(light) => light.length(),
        }
    }

    fn visit(&self, tile: &Tile, receivers: &Receivers, mut visit: impl FnMut(usize, f64, Part<'_>)) {
        let viewer = Viewer { lens: tile.lens(), faces: tile.faces() };
        match self {
            Self::Area(light) => {
                light.visit(viewer, receivers, &mut AreaScratch::default(), |r, weight, p| {
                    visit(
                        r,
                        weight,
                        Part { position: p.position(), extent: p.area(), share: &|n| p.share(n) },
                    );
                })
            }
            Self::Line(light) => {
                light.visit(viewer, receivers, &mut LineScratch::default(), |r, weight, p| {
                    visit(
                        r,
                        weight,
                        Part { position: p.position(), extent: p.length(), share: &|n| p.share(n) },
                    );
                })
            }
        }
    }
}

fn picture_of(
    renderer: &Renderer<'_>,
    geometry: &Geometry,
    light: &Asked<'_>,
    rects: impl IntoIterator<Item = PixelRect>,
) -> SeenPicture {
    let (width, height) = (renderer.view().width(), renderer.view().height());
    let mut picture = vec![vec![]; (width * height) as usize];
    let (mut tile, mut receivers) = (Tile::default(), Receivers::default());
    for rect in rects {
        renderer.render(rect, &mut tile);
        receivers.clear();
        let mut owners = vec![];
        for point in tile.points() {
            receivers.push_point(&tile, point);
            owners.resize(receivers.len(), point);
        }
        let mut seen = vec![vec![]; owners.len()];
        light.visit(&tile, &receivers, |receiver, weight, part| {
            let face = &tile.faces()[owners[receiver].face as usize];
            let [a, b, c] = geometry.corners(face.source);
            let front = (b - a).cross(c - a).normalize_or_zero();
            let normal = if face.front { front } else { -front };
            seen[receiver].push(SeenPoint {
                triangle: face.id,
                surface: face.surface,
                position: part.position,
                normal,
                weight,
                area: part.extent / light.extent(),
                share: (part.share)(normal),
            });
        });
        for (owner, points) in owners.iter().zip(seen) {
            picture[(owner.y * width + owner.x) as usize].extend(points);
        }
    }
    picture
}

fn with_light<T>(
    soup: &Soup,
    view: View,
    (shape, options): (Shape<'_>, AreaOptions),
    visit: impl FnOnce(&Renderer<'_>, &Geometry, &Asked<'_>) -> T,
) -> Option<T> {
    let geometry = soup.geometry().ok()?;
    let renderer = Renderer::new(&geometry, &PlainOpacity, view, MicropointOptions::DEFAULT).ok()?;
    let light = match shape {
        Shape::Polygon(outline) => {
            Asked::Area(AreaLight::new(&geometry, &PlainOpacity, outline, options).ok()?)
        }
        Shape::Line(ends) => Asked::Line(LineLight::new(&geometry, &PlainOpacity, ends, options).ok()?),
    };
    Some(visit(&renderer, &geometry, &light))
}

/// Renders a scene whole; `None` if something is refused.
#[must_use]
pub fn seen_picture(soup: &Soup, view: View, outline: &[DVec3]) -> Option<SeenPicture> {
    seen_picture_with(soup, view, outline, AreaOptions::DEFAULT)
}

/// As [`seen_picture`], with these options.
#[must_use]
pub fn seen_picture_with(
    soup: &Soup,
    view: View,
    outline: &[DVec3],
    options: AreaOptions,
) -> Option<SeenPicture> {
    picture_of_shape(soup, view, Shape::Polygon(outline), options)
}

pub(super) fn picture_of_shape(
    soup: &Soup,
    view: View,
    shape: Shape<'_>,
    options: AreaOptions,
) -> Option<SeenPicture> {
    with_light(soup, view, (shape, options), |r, g, l| picture_of(r, g, l, [r.picture()]))
}

/// Per pixel and surface, what arrives of the light at a picture's points: Σ weight × share.
#[must_use]
pub fn shares_on(picture: &SeenPicture, surface: u32) -> Vec<f64> {
    let own = |pixel: &Vec<SeenPoint>| {
        pixel.iter().filter(|p| p.surface == surface).map(|p| p.weight * p.share).sum()
    };
    picture.iter().map(own).collect()
}

fn are_identical(a: &SeenPicture, b: &SeenPicture) -> Result<(), String> {
    let bits = |p: &SeenPoint| {
        (p.triangle, p.position.to_array().map(f64::to_bits), [p.weight, p.area, p.share].map(f64::to_bits))
    };
    for (i, (pa, pb)) in a.iter().zip(b).enumerate() {
        let same = pa.len() == pb.len() && pa.iter().map(bits).eq(pb.iter().map(bits));
        check(same, || format!("pixel {i}: {pa:?} and {pb:?}"))?;
    }
    Ok(())
}

/// What is seen of a light does not depend on the rectangles in which a picture is rendered, bit for bit.
///
/// # Errors
/// The first pixel that differs.
pub fn tiles_do_not_matter(soup: &Soup, view: View, outline: &[DVec3]) -> Result<(), String> {
    tiles_do_not_matter_to(soup, view, Shape::Polygon(outline))
}

pub(super) fn tiles_do_not_matter_to(soup: &Soup, view: View, shape: Shape<'_>) -> Result<(), String> {
    let result = with_light(soup, view, (shape, AreaOptions::DEFAULT), |r, g, l| {
        let expected = picture_of(r, g, l, [r.picture()]);
        for size in [16, 3, 1] {
            let tiled = picture_of(r, g, l, r.picture().tiles(size));
            are_identical(&expected, &tiled).map_err(|e| format!("tiles of {size}: {e}"))?;
        }
        Ok(())
    });
    result.unwrap_or(Ok(()))
}

/// What is seen of a light does not depend on the order of triangles, bit for bit.
///
/// # Errors
/// The first pixel that differs.
pub fn triangle_order_does_not_matter(
    soup: &Soup,
    view: View,
    outline: &[DVec3],
    seed: u64,
) -> Result<(), String> {
    triangle_order_does_not_matter_to(soup, view, Shape::Polygon(outline), seed)
}

pub(super) fn triangle_order_does_not_matter_to(
    soup: &Soup,
    view: View,
    shape: Shape<'_>,
    seed: u64,
) -> Result<(), String> {
    let order = permutation(soup.triangles.len(), seed);
    let picture = |soup: &Soup| picture_of_shape(soup, view, shape, AreaOptions::DEFAULT);
    let (expected, got) = (picture(soup), picture(&soup.reordered(&order)));
    let (Some(expected), Some(mut got)) = (expected, got) else { return Ok(()) };
    got.iter_mut().flatten().for_each(|p| p.triangle = order[p.triangle as usize]);
    are_identical(&expected, &got)
}

/// What the fragments of a micropoint receive of a light together is what they receive each by itself, to within `tolerance` of what the light
/// would give to the picture in front of everything, over the micropoint's visibility.
///
/// # Errors
/// The first micropoint for which it is not.
pub fn pieces_may_be_asked_together(
    soup: &Soup,
    view: View,
    outline: &[DVec3],
    tolerance: f64,
) -> Result<(), String> {
    let shape = (Shape::Polygon(outline), AreaOptions::DEFAULT);
    let result = with_light(soup, view, shape, |renderer, _, light| {
        let (mut tile, mut together, mut apart) =
            (Tile::default(), Receivers::default(), Receivers::default());
        renderer.render(renderer.picture(), &mut tile);
        apart.push_tile(&tile);
        tile.points().iter().for_each(|point| together.push_point(&tile, point));
        let areas = |receivers: &Receivers| {
            let mut areas = vec![0.0; receivers.len()];
            light.visit(&tile, receivers, |receiver, share, part| {
                areas[receiver] += share * part.extent / light.extent();
            });
            areas
        };
        let (together, apart) = (areas(&together), areas(&apart));
        let mut first = 0;
        for point in tile.points() {
            let fragments = tile.fragments(point);
            let weighted = fragments.iter().zip(&apart[first..]).map(|(f, area)| f.weight * area);
            let expected = weighted.sum::<f64>() / fragments.iter().map(|f| f.weight).sum::<f64>();
            let got = together[first];
            let close = (expected - got).abs() * tile.visibility(point) <= tolerance;
            check(close, || format!("{point:?}: {got}, {expected} each by itself"))?;
            first += fragments.len();
        }
        Ok(())
    });
    result.unwrap_or(Ok(()))
}

/// What is seen of a parallelogram agrees with rays to `n`² points of it, each in the middle of its cell, to within `tolerance` of its area.
///
/// # Errors
/// The first point at which it does not.
pub fn agrees_with_rays(
    soup: &Soup,
    view: View,
    [corner, u, v]: [DVec3; 3],
    n: u32,
    tolerance: f64,
) -> Result<(), String> {
    let outline = [corner, corner + u, corner + u + v, corner + v];
    let Some(picture) = seen_picture(soup, view, &outline) else { return Ok(()) };
    let place = |k: u32| (f64::from(k) + 0.5) / f64::from(n);
    for p in picture.iter().flatten() {
        let targets = (0..n * n).map(|k| corner + u * place(k % n) + v * place(k / n));
        agrees_with_rays_to(soup, p, targets, tolerance)?;
    }
    Ok(())
}

/// What is seen from a point agrees with rays to `targets`, to within `tolerance` of their number.
pub(super) fn agrees_with_rays_to(
    soup: &Soup,
    p: &SeenPoint,
    targets: impl ExactSizeIterator<Item = DVec3>,
    tolerance: f64,
) -> Result<(), String> {
    let count = targets.len() as f64;
    let (mut least, mut most) = (0.0, 0.0);
    for target in targets.filter(|t| p.normal.dot(*t - p.position) > 0.0) {
        least += transmittance(soup, p.position, target, Doubt::Hits) / count;
        most += transmittance(soup, p.position, target, Doubt::Passes) / count;
    }
    let agrees = least - tolerance <= p.area && p.area <= most + tolerance;
    check(agrees, || format!("{p:?}: {least} to {most} by rays"))
}

/// What becomes of a ray that meets a triangle where rounding decides: along an edge, next to the end of its way, or so near its beginning
/// that the triangle may count or not ([`AreaLight::visit`]).
#[derive(Clone, Copy, PartialEq)]
enum Doubt {
    Hits,
    Passes,
}

impl Doubt {
    /// Shares of the way at which triangles count.
    fn ways(self) -> std::ops::Range<f64> {
        match self {
            Self::Hits => 0.0..1.0 + ROUNDING,
            Self::Passes => 1.1e-6..1.0 - ROUNDING,
        }
    }

    /// How far inside of an edge a hit is at least, relative to what it is computed from.
    fn inside(self) -> f64 {
        match self {
            Self::Hits => -ROUNDING,
            Self::Passes => ROUNDING,
        }
    }
}

/// Relative distances that are taken for rounding.
const ROUNDING: f64 = 1e-9;

/// What passes through all triangles between two points; those that the first lies on, or almost, do not count.
fn transmittance(soup: &Soup, from: DVec3, to: DVec3, doubt: Doubt) -> f64 {
    let mut passed = 1.0;
    for (triangle, &surface) in soup.triangles.iter().zip(&soup.surface_of) {
        let [a, b, c] = triangle.map(|i| soup.positions[i as usize] - from);
        let normal = (b - a).cross(c - a);
        let towards = to - from;
        let (height, slope) = (normal.dot(a), normal.dot(towards));
        if height.abs() <= ROUNDING * normal.length()
            || slope == 0.0
            || !doubt.ways().contains(&(height / slope))
        {
            continue;
        }
        let is_inside = |p: DVec3, q: DVec3| {
            let side = p.cross(q).dot(towards) * slope.signum();
            side > doubt.inside() * p.length() * q.length() * towards.length()
        };
        if is_inside(b, c) && is_inside(c, a) && is_inside(a, b) {
            passed *= 1.0 - f64::from(soup.surfaces[surface as usize].opacity);
        }
    }
    passed
}
