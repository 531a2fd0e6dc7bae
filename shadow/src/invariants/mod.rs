//! Facts that hold for every scene and light, as functions: property tests and fuzz targets call the same ones.
//!
//! Each takes any input at all. A scene, view or light that is refused satisfies every fact.

pub mod area;
pub mod line;

use pointillist_dice::convex;
use pointillist_micropoint::invariants::{Soup, permutation};
use pointillist_micropoint::{Geometry, MicropointOptions, PixelRect, PlainOpacity, Renderer, Tile, View};

use crate::query::is_edge_on;
use crate::{Emitter, Receivers, ShadowLight, ShadowOptions, ShadowScratch, Viewer};

/// A piece of a surface that the viewer sees, and how much of a light reaches it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LitPiece {
    /// Position of its triangle in the caller's array.
    pub triangle: u32,
    /// Its surface.
    pub surface: u32,
    /// Its share of the pixel.
    pub weight: f64,
    /// The fraction of the light.
    pub lit: f64,
}

/// What each pixel sees, row by row.
pub type LitPicture = Vec<Vec<LitPiece>>;

/// Renders these rectangles one after the other, each with its shadows.
#[must_use]
pub fn lit_picture_of(
    renderer: &Renderer<'_>,
    light: &ShadowLight<'_>,
    rects: impl IntoIterator<Item = PixelRect>,
) -> LitPicture {
    let (width, height) = (renderer.view().width(), renderer.view().height());
    let mut picture = vec![vec![]; (width * height) as usize];
    let (mut tile, mut scratch) = (Tile::default(), ShadowScratch::default());
    for rect in rects {
        renderer.render(rect, &mut tile);
        put_lit_tile(&mut picture, width, &tile, light, &mut scratch);
    }
    picture
}

/// Adds the pieces of a tile to a picture of this width.
pub fn put_lit_tile(
    picture: &mut LitPicture,
    width: u32,
    tile: &Tile,
    light: &ShadowLight<'_>,
    scratch: &mut ShadowScratch,
) {
    let (mut receivers, mut lit) = (Receivers::default(), vec![]);
    receivers.push_tile(tile);
    light.lit(Viewer { lens: tile.lens(), faces: tile.faces() }, &receivers, scratch, &mut lit);
    let mut fractions = lit.into_iter();
    for p in tile.points() {
        let face = &tile.faces()[p.face as usize];
        for f in tile.fragments(p) {
            picture[(p.y * width + p.x) as usize].push(LitPiece {
                triangle: face.id,
                surface: face.surface,
                weight: f.weight,
                lit: fractions.next().unwrap_or(f64::NAN),
            });
        }
    }
}

fn with_light<T>(
    soup: &Soup,
    view: View,
    emitter: Emitter,
    options: ShadowOptions,
    visit: impl FnOnce(&Geometry, &Renderer<'_>, &ShadowLight<'_>) -> T,
) -> Option<T> {
    let geometry = soup.geometry().ok()?;
    let renderer = Renderer::new(&geometry, &PlainOpacity, view, MicropointOptions::DEFAULT).ok()?;
    let light = ShadowLight::new(&geometry, &PlainOpacity, emitter, options).ok()?.seen_from(renderer.lens());
    Some(visit(&geometry, &renderer, &light))
}

/// Renders a scene whole; `None` if something is refused.
#[must_use]
pub fn lit_picture(soup: &Soup, view: View, emitter: Emitter, options: ShadowOptions) -> Option<LitPicture> {
    with_light(soup, view, emitter, options, |_, r, l| lit_picture_of(r, l, [r.picture()]))
}

/// Per pixel, what of the light reaches a surface: Σ weight × lit.
#[must_use]
pub fn light_on(picture: &LitPicture, surface: u32) -> Vec<f64> {
    let sum =
        |pixel: &Vec<LitPiece>| pixel.iter().filter(|p| p.surface == surface).map(|p| p.weight * p.lit).sum();
    picture.iter().map(sum).collect()
}

fn check(holds: bool, message: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(message()) }
}

fn are_identical(a: &LitPicture, b: &LitPicture) -> Result<(), String> {
    let bits = |p: &LitPiece| (p.triangle, p.surface, p.weight.to_bits(), p.lit.to_bits());
    for (i, (pa, pb)) in a.iter().zip(b).enumerate() {
        let same = pa.len() == pb.len() && pa.iter().map(bits).eq(pb.iter().map(bits));
        check(same, || format!("pixel {i}: {pa:?} and {pb:?}"))?;
    }
    Ok(())
}

/// Every piece gets a fraction in 0..=1.
///
/// # Errors
/// The first piece that does not.
pub fn fractions_are_fractions(
    soup: &Soup,
    view: View,
    emitter: Emitter,
    options: ShadowOptions,
) -> Result<(), String> {
    let Some(picture) = lit_picture(soup, view, emitter, options) else { return Ok(()) };
    match picture.iter().flatten().find(|p| !(0.0..=1.0).contains(&p.lit)) {
        Some(p) => Err(format!("{p:?}")),
        None => Ok(()),
    }
}

/// Lit fractions do not depend on the rectangles in which a picture is rendered, bit for bit.
///
/// # Errors
/// The first pixel that differs.
pub fn tiles_do_not_matter(
    soup: &Soup,
    view: View,
    emitter: Emitter,
    options: ShadowOptions,
) -> Result<(), String> {
    let result = with_light(soup, view, emitter, options, |_, r, l| {
        let expected = lit_picture_of(r, l, [r.picture()]);
        for size in [16, 5, 1] {
            let tiled = lit_picture_of(r, l, r.picture().tiles(size));
            are_identical(&expected, &tiled).map_err(|e| format!("tiles of {size}: {e}"))?;
        }
        Ok(())
    });
    result.unwrap_or(Ok(()))
}

/// Lit fractions do not depend on the order of triangles, bit for bit.
///
/// # Errors
/// The first pixel that differs.
pub fn triangle_order_does_not_matter(
    soup: &Soup,
    view: View,
    emitter: Emitter,
    options: ShadowOptions,
    seed: u64,
) -> Result<(), String> {
    let order = permutation(soup.triangles.len(), seed);
    let expected = lit_picture(soup, view, emitter, options);
    let got = lit_picture(&soup.reordered(&order), view, emitter, options);
    let (Some(expected), Some(mut got)) = (expected, got) else { return Ok(()) };
    got.iter_mut().flatten().for_each(|p| p.triangle = order[p.triangle as usize]);
    are_identical(&expected, &got)
}

/// Behind opaque casters, the lit regions of a receiver make up its lit fraction of its area in the picture, to `tolerance` cells; a receiver
/// without regions is wholly lit, wholly dark or edge-on to the viewer.
///
/// # Errors
/// The first receiver for which that does not hold.
pub fn lit_regions_make_up_the_fraction(
    soup: &Soup,
    view: View,
    emitter: Emitter,
    tolerance: f64,
) -> Result<(), String> {
    let mut soup = soup.clone();
    soup.surfaces.iter_mut().for_each(|surface| surface.opacity = 1.0);
    let result = with_light(&soup, view, emitter, ShadowOptions::DEFAULT, |_, renderer, light| {
        let (mut tile, mut scratch, mut lit) = (Tile::default(), ShadowScratch::default(), vec![]);
        renderer.render(renderer.picture(), &mut tile);
        let (mut receivers, mut areas) = (Receivers::default(), vec![]);
        for point in tile.points() {
            let face = &tile.faces()[point.face as usize];
            for fragment in tile.fragments(point) {
                let outline = tile.outline(fragment);
                let corner = |&v: &glam::DVec2| tile.position(v, face.nearness_at(v));
                receivers.push_with_regions(point.face, outline.iter().map(corner));
                areas.push((convex::area(outline), is_edge_on(tile.lens(), face)));
            }
        }
        light.lit(Viewer { lens: tile.lens(), faces: tile.faces() }, &receivers, &mut scratch, &mut lit);
        for (i, (&(area, edge_on), lit)) in areas.iter().zip(&lit).enumerate() {
            let regions: Vec<f64> =
                scratch.lit_regions(i as u32).map(|region| convex::area(region.outline).abs()).collect();
            let sum: f64 = regions.iter().sum();
            let holds = match regions.is_empty() {
                true => *lit == 0.0 || *lit == 1.0 || edge_on,
                false => (sum - lit * area).abs() <= tolerance,
            };
            check(holds, || format!("receiver {i}: {lit} of {area} in regions {regions:?}"))?;
        }
        Ok(())
    });
    result.unwrap_or(Ok(()))
}

/// Another caster takes light away or leaves it, in every pixel and on every surface that the viewer sees. The caster must
/// be out of view.
///
/// # Errors
/// The first pixel that got brighter.
pub fn a_caster_never_brightens(
    soup: &Soup,
    caster: &[glam::DVec3],
    view: View,
    emitter: Emitter,
    options: ShadowOptions,
    tolerance: f64,
) -> Result<(), String> {
    let mut more = soup.clone();
    let surface = more.surface(1.0);
    more.polygon(caster, surface);
    let pictures = (lit_picture(soup, view, emitter, options), lit_picture(&more, view, emitter, options));
    let (Some(before), Some(after)) = pictures else { return Ok(()) };
    if after.iter().flatten().any(|p| p.surface == surface) {
        return Ok(());
    }
    for s in 0..surface {
        for (i, (a, b)) in light_on(&before, s).iter().zip(light_on(&after, s)).enumerate() {
            check(b <= a + tolerance, || format!("surface {s}, pixel {i}: {a} became {b}"))?;
        }
    }
    Ok(())
}
