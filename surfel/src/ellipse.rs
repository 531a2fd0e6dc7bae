//! Discs on the picture: ellipses with planes, a vector of items at a time.
//!
//! A disc of radius r stands for the covariance σ²·(1 − n·nᵀ) of the plane that it lies in, with unit normal n and σ a
//! share of r. On the picture that is V = J·σ²(1 − n·nᵀ)·Jᵀ with the Jacobian J of the projection, plus the variance of
//! the lens's blur and of the pixel, which are discs and squares of the picture itself. With d the way from the
//! projected centre in pixels, the disc's parameter is
//!
//! q(d) = dᵀ·V⁻¹·d / h(d)²,  h(d) = 1 + k·d,
//!
//! where h is the depth of the centre over the depth of the plane at d: with V of the disc alone this is the exact
//! conic of its perspective image, evaluated about the image's own centre, and 1/h scales a depth that is affine in d.
//!
//! Steps 1 and 2, place and normal, are those of [`Placed`]. [`project`] goes on with 3 the covariance V, 4 the plane
//! (k, gradient of the depth, thickness), 5 the kernel (its end, weight and edge), 6 the box of pixels that it may
//! touch.

use crate::batch::{Projected, Value, WHOLE};
use crate::camera::Camera;
use crate::placed::{Map, Placed};
use crate::splat::{NEAREST_PLANE2, Shape};
use crate::vector::{Real, Vector};
use pulp::Simd;

/// Edges of this variance (in pixels) are as sharp as a pixel shows them: Gaussian with the slope of a box.
const EDGE_VARIANCE: f32 = 0.16;

/// kᵀ·V·k, V as its three different entries.
#[inline(always)]
fn along<S: Simd>([kx, ky]: [Vector<S>; 2], v: [Vector<S>; 3]) -> Vector<S> {
    kx * kx * v[0] + kx * ky * v[1] * 2.0 + ky * ky * v[2]
}

/// Step 3: covariances in pixels, as their entries xx, xy, yy.
struct Covariance<S: Simd> {
    /// Radius of the blur and of the disc (with the blur, where the shape is widened by it), units.
    blur_radius: Vector<S>,
    radius: Vector<S>,
    /// Covariance of the disc alone.
    disc: [Vector<S>; 3],
    /// Variance of the blur.
    blur: Vector<S>,
    /// V: of disc, blur and pixel together.
    v: [Vector<S>; 3],
    determinant: Vector<S>,
}

impl<S: Simd> Covariance<S> {
    #[inline(always)]
    fn new(placed: &Placed<S>, disc_radius: Vector<S>, camera: &Camera, shape: &Shape) -> Self {
        let Placed { depth, scale, way: [ux, uy], normal: [a, b, c], spread: [p, q, r], .. } = *placed;
        let blur_radius = camera.blur_radius(depth);
        let radius = disc_radius + blur_radius * shape.widening;
        let deviation = radius * shape.deviation;
        let on_picture = deviation * scale;
        let s2 = on_picture * on_picture;
        let blur_deviation = blur_radius * scale * (0.5 * shape.lens);
        let blur = blur_deviation * blur_deviation;
        let (mx, my) = (a - ux * c, b - uy * c);
        let apart = scale * shape.spread;
        let (px, py) = ((p - ux * r) * apart, (q - uy * r) * apart);
        let disc = [
            s2 * (ux * ux - mx * mx + 1.0) + px * px,
            s2 * (ux * uy - mx * my) + px * py,
            s2 * (uy * uy - my * my + 1.0) + py * py,
        ];
        let added = blur + shape.pixel_variance;
        let v = [disc[0] + added, disc[1], disc[2] + added];
        let determinant = v[0] * v[2] - v[1] * v[1];
        Self { blur_radius, radius, disc, blur, v, determinant }
    }
}

/// Step 4: the plane of a disc.
struct Plane<S: Simd> {
    /// k; 0 for an orthographic view, in which planes keep their shape and h is 1.
    k: [Vector<S>; 2],
    /// Change of the bent depth per pixel.
    gradient: [Vector<S>; 2],
    /// Bent depth within which others belong to the same surface.
    thickness: Vector<S>,
    /// How far any of the disc is from its centre, as pixels at the centre's depth.
    reach_px: Vector<S>,
}

impl<S: Simd> Plane<S> {
    #[inline(always)]
    fn new(
        simd: S,
        placed: &Placed<S>,
        disc_radius: Vector<S>,
        covariance: &Covariance<S>,
        (camera, shape): (&Camera, &Shape),
    ) -> Self {
        let Placed { inverse, scale, normal: [a, b, _], spread: [p, q, r], facing, .. } = *placed;
        let Covariance { blur_radius, disc, blur, v, .. } = *covariance;
        let (focal, reference) = (camera.focal, camera.reference as f32);
        let edge_on = (facing.at_most(-1e-6) * focal).inverse();
        let (kx, ky) = (a * edge_on, b * edge_on);
        let slope = (kx * kx + ky * ky).sqrt() * focal;
        // The radius of a disc as wide as the pair.
        let whole_radius = (disc_radius * disc_radius + (p * p + q * q + r * r) * 4.0).sqrt();
        // The pixel's part of the ellipse does not extend the disc's plane, and the plane is not followed too close to
        // the eye.
        let reach_px = camera.plane_reach(whole_radius * shape.deviation, blur_radius) * scale;
        let reach = reach_px * (1.0 / focal);
        let longest = (reach * reach).at_most(NEAREST_PLANE2) * (1.0 / shape.reach2);
        let long = along([kx, ky], [disc[0] + blur, disc[1], disc[2] + blur]).min(longest);
        let shrink = (long / along([kx, ky], v).at_least(f32::MIN_POSITIVE)).at_most(1.0).sqrt();
        let (kx, ky) = (kx * shrink, ky * shrink);
        let bend =
            if camera.is_perspective { inverse * (reference * reference) } else { Vector::all(simd, 1.0) };
        let curved = if camera.is_perspective { 1.0 } else { 0.0 };
        let thickness = camera.thickness(whole_radius, slope, scale.inverse(), blur_radius);
        Self {
            k: [kx * curved, ky * curved],
            gradient: [-(kx * bend), -(ky * bend)],
            thickness: thickness * camera.bending(inverse),
            reach_px,
        }
    }
}

/// Step 5: the kernel over a disc.
struct Kernel<S: Simd> {
    /// Where the kernel is the flat one.
    is_flat: S::m32s,
    /// R: the kernel ends where q is this.
    reach2: Vector<S>,
    /// 1/(|V|·R), which makes V⁻¹/R of V's entries.
    conic: Vector<S>,
    /// Weight at the centre.
    weight: Vector<S>,
    /// How much steeper than the kernel's an edge has to be to look sharp.
    edge: Vector<S>,
}

impl<S: Simd> Kernel<S> {
    #[inline(always)]
    fn new(simd: S, placed: &Placed<S>, area: Vector<S>, covariance: &Covariance<S>, shape: &Shape) -> Self {
        let Covariance { disc, blur, v, determinant, .. } = *covariance;
        let constant = |value: f32| Vector::all(simd, value);
        let is_flat = blur.is_above((disc[0] + disc[2]) * 0.5 + shape.pixel_variance);
        let reach2 = constant(shape.flat_reach2).if_set(is_flat, shape.reach2);
        // The integrals of (1 − q/R)² and of √(1 − q/R): πR/3 and 2πR/3, times the root of |V|.
        let integral = reach2 * constant(2.0).if_set(is_flat, 1.0) * (std::f32::consts::PI / 3.0);
        let root = determinant.at_least(f32::MIN_POSITIVE).sqrt();
        let share = -(area * placed.scale * placed.scale * placed.facing);
        let half_difference = (v[0] - v[2]) * 0.5;
        let narrow = (v[0] + v[2]) * 0.5 - (half_difference * half_difference + v[1] * v[1]).sqrt();
        let conic = (determinant * reach2).inverse();
        let edge = (narrow / (blur + EDGE_VARIANCE)).at_least(1.0).sqrt();
        // Limited: discs next to the eye can have any size, and sums of weights must stay finite.
        let weight = (share / (integral * root)).at_most(1e3);
        Self { is_flat, reach2, conic, weight, edge }
    }
}

/// Puts the discs of a vector of items into vector `place` of a batch: steps 3 to 6.
#[inline(always)]
pub(crate) fn project<S: Simd>(
    simd: S,
    placed: &Placed<S>,
    [disc_radius, area]: [Vector<S>; 2],
    (camera, shape, map): (&Camera, &Shape, &Map),
    out: &mut Projected,
    place: usize,
) {
    let Placed { x, y, depth, inverse, scale, facing, .. } = *placed;
    let constant = |value: f32| Vector::all(simd, value);
    // 3, 4, 5
    let covariance = Covariance::new(placed, disc_radius, camera, shape);
    let plane = Plane::new(simd, placed, disc_radius, &covariance, (camera, shape));
    let kernel = Kernel::new(simd, placed, area, &covariance, shape);
    let (v, k, conic) = (covariance.v, plane.k, kernel.conic);
    // 6
    let [left, right, top, bottom] = ends([x, y], v, k, kernel.reach2, map.size);
    let is_kept = simd.and_m32s(depth.exceeds(camera.near), (-facing).exceeds(0.0));
    let is_kept = simd.and_m32s(is_kept, simd.and_m32s(right.is_above(left), bottom.is_above(top)));
    let is_kept = simd.and_m32s(is_kept, map.may_see(simd, [x, y], plane.reach_px));
    let reference = camera.reference as f32;
    let bent = if camera.is_perspective { depth * (inverse * reference) } else { depth };
    let sharpness = if shape.is_paper { (covariance.radius * scale).at_most(1e6) } else { kernel.edge };
    for (value, result) in [
        (Value::X, x),
        (Value::Y, y),
        (Value::Xx, v[2] * conic),
        (Value::Xy, -(v[1] * conic)),
        (Value::Yy, v[0] * conic),
        (Value::Depth, bent),
        (Value::DepthX, plane.gradient[0]),
        (Value::DepthY, plane.gradient[1]),
        (Value::Kx, k[0]),
        (Value::Ky, k[1]),
        (Value::Weight, kernel.weight),
        (Value::Thickness, plane.thickness),
        (Value::Flat, constant(1.0).if_set(kernel.is_flat, 0.0)),
        (Value::Sharpness, sharpness),
        (Value::Left, left),
        (Value::Right, right),
        (Value::Top, top),
        (Value::Bottom, bottom),
        (Value::Kept, constant(1.0).if_set(is_kept, 0.0)),
    ] {
        out.set(place, value, result);
    }
}

/// First column, last column (not included), first row and last row of the box around q ≤ R, within a tile, with
/// [`WHOLE`].
///
/// With t = V·k and τ = R·k·t < 1, q ≤ R is an ellipse about R·t/(1 − τ) with the covariance V + R·t·tᵀ/(1 − τ), to the
/// reach R/(1 − τ).
#[inline(always)]
fn ends<S: Simd>(
    [x, y]: [Vector<S>; 2],
    v: [Vector<S>; 3],
    [kx, ky]: [Vector<S>; 2],
    reach2: Vector<S>,
    size: [f32; 2],
) -> [Vector<S>; 4] {
    let (tx, ty) = (v[0] * kx + v[1] * ky, v[1] * kx + v[2] * ky);
    let reach = reach2 / -((reach2 * (kx * tx + ky * ty)).at_most(0.75) - 1.0);
    let half = |v: Vector<S>, t: Vector<S>| (reach * (v + reach * t * t)).sqrt();
    let (hx, hy) = (half(v[0], tx), half(v[2], ty));
    let (x, y) = (x + reach * tx, y + reach * ty);
    let end = |v: Vector<S>, size: f32| v.at_least(0.0).at_most(size) + WHOLE;
    [end(x - hx, size[0]), end(x + hx, size[0]), end(y - hy, size[1]), end(y + hy, size[1])]
}
