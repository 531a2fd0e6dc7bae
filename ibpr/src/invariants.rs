//! Facts that hold for every cloud, view and set of options, as functions `fn fact(…) -> Result<(), String>`: `Err`
//! says what was found instead.
//!
//! For property testers and fuzzers: the tests of this crate and its fuzz targets call them, and so can those of a
//! crate that builds on it, with the feature `invariants`. Each takes any input at all; scans and options that are
//! refused satisfy every fact.
//!
//! ```
//! use pointillist_ibpr::{Options, Projection, View, invariants::{OwnedScan, frames_are_sound}};
//! # use glam::DVec3;
//!
//! let scan = OwnedScan::plane(DVec3::ZERO, DVec3::X * 0.1, DVec3::Y * 0.1, 20, 20).jittered(DVec3::Z * 0.05, 1);
//! let view = View::look_at(DVec3::Z * 3.0, DVec3::ZERO, DVec3::Y, Projection::Perspective { fov_y_rad: 0.8 }, 32, 24).unwrap();
//! frames_are_sound(&[scan], &view, &Options::DEFAULT)?;
//! # Ok::<(), String>(())
//! ```

use crate::{Cloud, Frame, IbprError, Options, PixelRect, Renderer, Scan, View};
use glam::{DVec2, DVec3, Vec3};

/// Rounding allowed to opacities, to lengths of unit normals, and to a color that all points share.
pub const TOLERANCE: f32 = 1e-4;

/// A scan that owns its points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OwnedScan {
    /// World space.
    pub positions: Vec<DVec3>,
    /// Linear RGB.
    pub colors: Option<Vec<[f32; 3]>>,
    /// See [`Scan::with_opacities`].
    pub opacities: Option<Vec<f32>>,
    /// See [`Scan::with_spacing`].
    pub spacing: Option<f64>,
    /// See [`Scan::with_scanner`].
    pub towards_scanner: Option<DVec3>,
}

impl OwnedScan {
    /// Points without anything else.
    #[must_use]
    pub fn new(positions: Vec<DVec3>) -> Self {
        Self { positions, ..Self::default() }
    }

    /// `columns` × `rows` points about `centre`, `right` and `up` apart.
    #[must_use]
    pub fn plane(centre: DVec3, right: DVec3, up: DVec3, columns: u32, rows: u32) -> Self {
        let middle = |n: u32| 0.5 * f64::from(n.saturating_sub(1));
        let at = |c: u32, r: u32| {
            centre + right * (f64::from(c) - middle(columns)) + up * (f64::from(r) - middle(rows))
        };
        Self::new((0..rows).flat_map(|r| (0..columns).map(move |c| at(c, r))).collect())
    }

    /// What a scanner far away sees of a sphere: parallel rays `spacing` apart, incidence up to 75°.
    #[must_use]
    pub fn sphere(centre: DVec3, radius: f64, spacing: f64, towards_scanner: DVec3) -> Self {
        let towards = towards_scanner.normalize();
        let (right, up) = towards.any_orthonormal_pair();
        let reach = radius * 75f64.to_radians().sin();
        let steps = (reach / spacing) as i32;
        let at = |i: i32, j: i32| {
            let flat = spacing * (f64::from(i) * right + f64::from(j) * up);
            let height2 = radius * radius - flat.length_squared();
            (flat.length() <= reach).then(|| centre + flat + height2.sqrt() * towards)
        };
        let places = (-steps..=steps).flat_map(|i| (-steps..=steps).map(move |j| (i, j)));
        let positions = places.filter_map(|(i, j)| at(i, j)).collect();
        Self { positions, spacing: Some(spacing), towards_scanner: Some(towards), ..Self::default() }
    }

    /// Each point moved along `direction` by up to its length, forth or back.
    #[must_use]
    pub fn jittered(&self, direction: DVec3, seed: u64) -> Self {
        let mut random = Random(seed);
        let positions = self.positions.iter().map(|p| *p + direction * (2.0 * random.share() - 1.0));
        Self { positions: positions.collect(), ..self.clone() }
    }

    /// As the crate takes it.
    #[must_use]
    pub fn as_scan(&self) -> Scan<'_> {
        let mut scan = Scan::new(&self.positions);
        if let Some(colors) = &self.colors {
            scan = scan.with_colors(colors);
        }
        if let Some(opacities) = &self.opacities {
            scan = scan.with_opacities(opacities);
        }
        if let Some(spacing) = self.spacing {
            scan = scan.with_spacing(spacing);
        }
        if let Some(towards) = self.towards_scanner {
            scan = scan.with_scanner(towards);
        }
        scan
    }

    /// The same points elsewhere.
    #[must_use]
    pub fn moved(&self, map: impl Fn(DVec3) -> DVec3) -> Self {
        Self { positions: self.positions.iter().map(|p| map(*p)).collect(), ..self.clone() }
    }
}

/// Prepares scans.
///
/// # Errors
/// As [`Cloud::new`].
pub fn cloud(scans: &[OwnedScan]) -> Result<Cloud, IbprError> {
    let scans: Vec<Scan<'_>> = scans.iter().map(OwnedScan::as_scan).collect();
    Cloud::new(&scans, Vec3::splat(0.8))
}

/// A frame of its own by a renderer of its own; `None` if anything is refused.
#[must_use]
pub fn frame(scans: &[OwnedScan], view: &View, options: &Options) -> Option<Frame> {
    let mut frame = Frame::default();
    Renderer::new().draw(&cloud(scans).ok()?, view, options, &mut frame).ok()?;
    Some(frame)
}

/// Pixels of a window are those of the whole picture, bit for bit, also after another frame.
///
/// # Errors
/// The first pixel that differs.
pub fn a_window_is_a_part_of_the_picture(
    scans: &[OwnedScan],
    view: &View,
    options: &Options,
    window: PixelRect,
) -> Result<(), String> {
    let whole = frame(scans, view, options);
    let windowed = options.with_window(window);
    let Ok(cloud) = cloud(scans) else { return Ok(()) };
    let (mut renderer, mut part) = (Renderer::new(), Frame::default());
    for options in [&windowed.with_ambient(0.5), &windowed] {
        let drawn = renderer.draw(&cloud, view, options, &mut part);
        let Some(_) = &whole else {
            return if drawn.is_err() { Ok(()) } else { Err("only the window was drawn".to_owned()) };
        };
        drawn.map_err(|error| error.to_string())?;
    }
    let Some(whole) = whole else { return Ok(()) };
    for y in window.y0..window.y1.min(view.height()) {
        for x in window.x0..window.x1.min(view.width()) {
            let i = (y * view.width() + x) as usize;
            let bits = |f: &Frame| {
                let surface = f.normal.get(i).map(|n| n.map(f32::to_bits));
                let count = f.count.get(i).map(|c| c.to_bits());
                (f.color[i].map(f32::to_bits), f.depth[i].to_bits(), surface, count)
            };
            if bits(&whole) != bits(&part) {
                let found = (whole.color[i], whole.depth[i], part.color[i], part.depth[i]);
                return Err(format!("pixel {x}, {y} of window {window:?}: {found:?}"));
            }
        }
    }
    Ok(())
}

/// The same scans and points in another order.
#[must_use]
pub fn shuffled(scans: &[OwnedScan], seed: u64) -> Vec<OwnedScan> {
    let mut random = Random(seed);
    let mut order = |n: usize| {
        let mut order: Vec<usize> = (0..n).collect();
        for i in (1..n).rev() {
            order.swap(i, (random.share() * (i as f64 + 1.0)) as usize);
        }
        order
    };
    let scan_order = order(scans.len());
    let mut scan = |s: &OwnedScan| {
        let points = order(s.positions.len());
        let colors = s.colors.as_ref().filter(|c| c.len() == points.len());
        let opacities = s.opacities.as_ref().filter(|o| o.len() == points.len());
        OwnedScan {
            positions: points.iter().map(|i| s.positions[*i]).collect(),
            colors: colors.map(|c| points.iter().map(|i| c[*i]).collect()).or(s.colors.clone()),
            opacities: opacities.map(|o| points.iter().map(|i| o[*i]).collect()).or(s.opacities.clone()),
            ..*s
        }
    };
    scan_order.iter().map(|i| scan(&scans[*i])).collect()
}

/// Knuth's MMIX generator: good enough to shuffle.
struct Random(u64);

impl Random {
    /// 0 to 1, without 1.
    fn share(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 32) as f64 / (1u64 << 32) as f64
    }
}

fn check(holds: bool, message: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(message()) }
}

/// Two frames are the same, bit for bit.
///
/// # Errors
/// The first pixel that differs.
pub fn frames_are_identical(a: &Frame, b: &Frame) -> Result<(), String> {
    check((a.width, a.height) == (b.width, b.height), || "sizes differ".to_owned())?;
    let place = |i: usize| format!("pixel ({}, {})", i % a.width, i / a.width);
    let differ = |p: &[f32], q: &[f32]| p.iter().zip(q).any(|(x, y)| x.to_bits() != y.to_bits());
    for i in 0..a.width * a.height {
        let (p, q) = (&a.color[i], &b.color[i]);
        check(!differ(p, q), || format!("{}: colors {p:?} and {q:?}", place(i)))?;
        let (p, q) = (a.depth[i], b.depth[i]);
        check(!differ(&[p], &[q]), || format!("{}: depths {p} and {q}", place(i)))?;
    }
    for (i, (p, q)) in a.normal.iter().zip(&b.normal).enumerate() {
        check(!differ(p, q), || format!("{}: normals {p:?} and {q:?}", place(i)))?;
    }
    check(!differ(&a.count, &b.count) && a.count.len() == b.count.len(), || "counts differ".to_owned())
}

/// Two frames are the same, but all depths of the second are `k` times as large.
///
/// # Errors
/// The first pixel that differs.
pub fn frames_are_identical_but_for_size(a: &Frame, b: &Frame, k: f64) -> Result<(), String> {
    let depth = a.depth.iter().map(|d| (f64::from(*d) * k) as f32).collect();
    frames_are_identical(&Frame { depth, ..a.clone() }, b)
}

/// No value is NaN, opacities are shares, depths are in front of the eye, normals are unit vectors.
///
/// # Errors
/// The first pixel that is otherwise.
pub fn frame_is_sound(frame: &Frame) -> Result<(), String> {
    // A mean of colors beside black may round to a little below it.
    let brightest = frame.color().iter().flatten().fold(0.0f32, |m, v| m.max(*v));
    for i in 0..frame.width() * frame.height() {
        let (c, depth) = (frame.color()[i], frame.depth()[i]);
        let place = || format!("pixel ({}, {}): {c:?}, depth {depth}", i % frame.width(), i / frame.width());
        check(c.iter().all(|v| *v >= -TOLERANCE * brightest && v.is_finite()), place)?;
        check(c[3] <= 1.0 + TOLERANCE, place)?;
        check(depth >= 0.0, place)?;
        if let (Some(n), Some(count)) = (frame.normal().get(i), frame.count().get(i)) {
            let place = || format!("{}, normal {n:?}, count {count}", place());
            let length = Vec3::from_array(*n).length();
            // The depth of a far surface may overflow `f32`; its normal is there still.
            let is = |wanted: f32| (length - wanted).abs() <= TOLERANCE;
            check(is(1.0) || depth == f32::INFINITY && is(0.0), place)?;
            check(*count >= 0.0 && count.is_finite(), place)?;
        }
    }
    Ok(())
}

/// Any input gives a sound frame or a typed error; what is opaque has depth only where it covers.
///
/// # Errors
/// As [`frame_is_sound`].
pub fn frames_are_sound(scans: &[OwnedScan], view: &View, options: &Options) -> Result<(), String> {
    let Some(frame) = frame(scans, view, options) else { return Ok(()) };
    let uncovered = frame.color().iter().zip(frame.depth()).any(|(c, d)| c[3] < 0.5 && *d < f32::INFINITY);
    let opaque = options.translucency.is_none();
    check(!(opaque && uncovered), || "depth where less than half a pixel is covered".to_owned())?;
    frame_is_sound(&frame)
}

/// The order of scans and of their points does not show.
///
/// # Errors
/// As [`frames_are_identical`].
pub fn order_does_not_matter(
    scans: &[OwnedScan],
    view: &View,
    options: &Options,
    seed: u64,
) -> Result<(), String> {
    match (frame(scans, view, options), frame(&shuffled(scans, seed), view, options)) {
        (Some(a), Some(b)) => frames_are_identical(&a, &b),
        (None, None) => Ok(()),
        _ => Err("one order is refused, another is not".to_owned()),
    }
}

/// A cloud to which scans were added one by one, some twice, and from which what was too much was removed again, is the cloud of these
/// scans.
///
/// # Errors
/// As [`frames_are_identical`].
pub fn history_does_not_matter(
    scans: &[OwnedScan],
    view: &View,
    options: &Options,
    seed: u64,
) -> Result<(), String> {
    let Ok(whole) = cloud(scans) else { return Ok(()) };
    let mut random = Random(seed);
    let mut order = shuffled(scans, seed);
    order.retain(|scan| !scan.positions.is_empty());
    let Some((first, others)) = order.split_first() else { return Ok(()) };
    let failed = |error: IbprError| format!("{error}, but not all at once");
    let mut grown = cloud(std::slice::from_ref(first)).map_err(failed)?;
    for scan in others {
        if random.share() < 0.5 {
            let guest = &order[(random.share() * order.len() as f64) as usize];
            let guest = grown.push(&guest.as_scan()).map_err(failed)?;
            grown.push(&scan.as_scan()).map_err(failed)?;
            grown.remove(guest).map_err(failed)?;
            check(grown.remove(guest) == Err(IbprError::UnknownScan), || {
                "a scan is removed twice".to_owned()
            })?;
        } else {
            grown.push(&scan.as_scan()).map_err(failed)?;
        }
    }
    let measures = |c: &Cloud| (c.len(), c.bounds(), c.spacing(), c.density_spacing(), c.block_count());
    let (a, b) = (measures(&whole), measures(&grown));
    check(a == b, || format!("all at once {a:?}, one by one {b:?}"))?;
    let mut frames = [Frame::default(), Frame::default()];
    for (cloud, frame) in [&whole, &grown].into_iter().zip(&mut frames) {
        if Renderer::new().draw(cloud, view, options, frame).is_err() {
            return Ok(());
        }
    }
    frames_are_identical(&frames[0], &frames[1])
}

/// A renderer and a frame that drew something else before draw the same as new ones.
///
/// # Errors
/// As [`frames_are_identical`].
pub fn use_before_does_not_matter(
    scans: &[OwnedScan],
    before: (&View, &Options),
    after: (&View, &Options),
) -> Result<(), String> {
    let Ok(cloud) = cloud(scans) else { return Ok(()) };
    let Some(fresh) = frame(scans, after.0, after.1) else { return Ok(()) };
    let (mut renderer, mut used) = (Renderer::new(), Frame::default());
    let _ = renderer.draw(&cloud, before.0, before.1, &mut used);
    renderer.draw(&cloud, after.0, after.1, &mut used).map_err(|e| e.to_string())?;
    frames_are_identical(&fresh, &used)
}

/// A pixel that no point projects near shows nothing: further than two buffer pixels (what a face spans),
/// the gaps that are filled, and a pixel for what is covered in part.
///
/// # Errors
/// The first pixel with something in it.
pub fn far_pixels_stay_empty(scans: &[OwnedScan], view: &View, options: &Options) -> Result<(), String> {
    let Some(frame) = frame(scans, view, options) else { return Ok(()) };
    let reach = frame.counts().scale * (2.0 + f64::from(1u32 << options.fill)) + 1.0;
    let (width, height) = (frame.width() as f64, frame.height() as f64);
    let mut near = vec![false; frame.width() * frame.height()];
    let before_the_eye = scans.iter().flat_map(|s| &s.positions).filter_map(|p| view.project(*p));
    for DVec2 { x, y } in before_the_eye.filter(|seen| seen.depth > 0.0).map(|seen| seen.pixel) {
        let place = |v: f64, end: f64| v.clamp(0.0, end) as usize;
        let span = |v: f64, end: f64| place(v - reach, end)..place(v + reach + 1.0, end);
        for row in span(y, height) {
            near[row * frame.width()..][span(x, width)].fill(true);
        }
    }
    let seen = |i: &usize| frame.color()[*i] != [0.0; 4] || frame.depth()[*i] < f32::INFINITY;
    let wrong = (0..near.len()).find(|i| !near[*i] && seen(i));
    wrong.map_or(Ok(()), |i| {
        Err(format!("pixel ({}, {}) is not empty, reach {reach}", i % frame.width(), i / frame.width()))
    })
}

/// Points of one color, lit from everywhere, show that color wherever anything is seen.
///
/// # Errors
/// The first pixel of another color.
pub fn one_color_stays_one_color(
    scans: &[OwnedScan],
    view: &View,
    options: &Options,
    color: [f32; 3],
) -> Result<(), String> {
    let paint = |s: &OwnedScan| OwnedScan { colors: Some(vec![color; s.positions.len()]), ..s.clone() };
    let painted: Vec<OwnedScan> = scans.iter().map(paint).collect();
    let options = Options { ambient: 1.0, eye_dome: None, ..*options };
    let Some(frame) = frame(&painted, view, &options) else { return Ok(()) };
    for (i, c) in frame.color().iter().enumerate() {
        let most = color.iter().fold(1.0f32, |m, c| m.max(*c));
        let same = c[..3].iter().zip(color).all(|(v, w)| (v - w * c[3]).abs() <= TOLERANCE * most);
        check(same, || {
            format!("pixel ({}, {}): {c:?}, not {color:?}", i % frame.width(), i / frame.width())
        })?;
    }
    Ok(())
}
