//! Points on the picture: discs as ellipses, with planes.
//!
//! A disc of radius r stands for the covariance σ²·(1 − n·nᵀ), σ a share of r, of the plane that it lies in. On the picture
//! that is V = J·σ²(1 − n·nᵀ)·Jᵀ with the Jacobian J of the projection, plus the blur of the lens and of the pixel, which
//! are discs and squares of the picture itself. With d the way from the projected centre, the disc's own parameter is
//!
//! q(d) = dᵀ·V⁻¹·d / h(d)²,  h(d) = 1 + k·d,
//!
//! where h is the depth of the centre over the depth of the plane at d: with V of the disc alone this is the exact
//! conic of its perspective image, evaluated about the image's own centre, and 1/h scales a depth that is affine in d.

use crate::camera::Camera;
use crate::cloud::Node;
use crate::layer;
use crate::tile;
use crate::vector::{Real, Vector};
use glam::{DVec3, Vec3};
use pulp::Simd;
use std::ops::Range;

/// Standard deviation of a disc's kernel over its radius. Found by experiment: narrower ones leave spots between
/// points, wider ones blur.
pub(crate) const DEVIATION_PER_RADIUS: f32 = 0.5;

/// Variance and standard deviation of a pixel, a box of side 1.
const PIXEL_VARIANCE: f32 = 1.0 / 12.0;
pub(crate) const PIXEL_DEVIATION: f32 = 0.288_675_13;

/// A kernel ends where q is this: a kernel (1 − q/R)² then has the covariance V.
pub(crate) const REACH2: f32 = 8.0;

/// The same for the flatter kernel √(1 − q/R) of discs that are mostly blur: a lens blurs evenly over a disc.
const FLAT_REACH2: f32 = 5.0;

/// The paper's discs have hard edges. In quadrature with this radius, half the diagonal of a pixel, each covers a pixel's
/// centre.
const LEAST_RADIUS2: f32 = 0.5;

/// The ellipse of these discs covers both of a pair, where they are a radius apart.
const DISC_SPREAD: f32 = 2.236;

/// Edges of this variance (in pixels) are as sharp as a pixel shows them: Gaussian with the slope of a box.
const EDGE_VARIANCE: f32 = 0.16;

/// Planes are followed no nearer to the eye than their disc's centre by this factor, squared.
pub(crate) const NEAREST_PLANE2: f32 = 0.5;

/// A disc in a tile.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Splat {
    /// Centre in pixels of the tile.
    pub(crate) x: f32,
    pub(crate) y: f32,
    /// V⁻¹ over the kernel's end: q/R = xx·dx² + 2·xy·dx·dy + yy·dy².
    pub(crate) xx: f32,
    pub(crate) xy: f32,
    pub(crate) yy: f32,
    /// Bent depth of the centre and its gradient.
    pub(crate) depth: f32,
    pub(crate) depth_x: f32,
    pub(crate) depth_y: f32,
    /// k.
    pub(crate) kx: f32,
    pub(crate) ky: f32,
    /// Weight at the centre: all weights over the picture add up to the disc's share of it in pixels.
    pub(crate) weight: f32,
    /// Bent depth within which others belong to the same surface.
    pub(crate) thickness: f32,
    /// Whether the kernel is the flat one.
    pub(crate) flat: bool,
    /// Pixels that it may touch, the last not included.
    pub(crate) columns: [u8; 2],
    pub(crate) rows: [u8; 2],
    /// How much steeper than the kernel's an edge has to be to look sharp.
    pub(crate) sharpness: f32,
    /// In its light.
    pub(crate) colour: [f32; 3],
    /// In the picture's axes.
    pub(crate) normal: [f32; 3],
}

impl Splat {
    pub(crate) const NONE: Self = Self {
        x: 0.0,
        y: 0.0,
        xx: 0.0,
        xy: 0.0,
        yy: 0.0,
        depth: 0.0,
        depth_x: 0.0,
        depth_y: 0.0,
        kx: 0.0,
        ky: 0.0,
        weight: 0.0,
        thickness: 0.0,
        flat: false,
        columns: [0; 2],
        rows: [0; 2],
        sharpness: 0.0,
        colour: [0.0; 3],
        normal: [0.0; 3],
    };

    /// Columns of blocks that it may touch.
    #[inline(always)]
    pub(crate) fn blocks(&self) -> Range<usize> {
        usize::from(self.columns[0]) / layer::LANES..usize::from(self.columns[1]).div_ceil(layer::LANES)
    }

    /// The way from the centre to those of the pixels of its first row.
    #[inline(always)]
    pub(crate) fn first_dy(&self) -> f32 {
        f32::from(self.rows[0]) + 0.5 - self.y
    }

    #[inline(always)]
    pub(crate) fn rows(&self) -> Range<usize> {
        usize::from(self.rows[0])..usize::from(self.rows[1])
    }
}

/// How discs are drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shape {
    /// Standard deviation of the kernel over the radius, and what it gains from the spread of a pair.
    deviation: f32,
    spread: f32,
    /// What is added for the pixel.
    pixel_variance: f32,
    reach2: f32,
    flat_reach2: f32,
    /// Blur as a kernel of its own, or as more radius.
    lens: f32,
    widening: f32,
    /// Whether `sharpness` is to be the radius in pixels.
    is_paper: bool,
}

impl Shape {
    /// Kernels, blurred by the lens.
    pub(crate) const BLENDED: Self = Self {
        deviation: DEVIATION_PER_RADIUS,
        spread: 1.0,
        pixel_variance: PIXEL_VARIANCE,
        reach2: REACH2,
        flat_reach2: FLAT_REACH2,
        lens: 1.0,
        widening: 0.0,
        is_paper: false,
    };

    /// Discs with hard edges.
    pub(crate) const DISC: Self = Self {
        deviation: 1.0,
        spread: DISC_SPREAD,
        pixel_variance: LEAST_RADIUS2,
        reach2: 1.0,
        flat_reach2: 1.0,
        lens: 0.0,
        widening: 0.0,
        is_paper: true,
    };

    /// The same, wider by the blur.
    pub(crate) const WIDENED_DISC: Self = Self { widening: 1.0, ..Self::DISC };
}

/// Items of a node that are projected together.
pub(crate) const LANES: usize = 64;

pub(crate) type Lanes = [f32; LANES];

/// What [`Projected`] holds of each item.
#[derive(Clone, Copy)]
pub(crate) enum Value {
    X,
    Y,
    Xx,
    Xy,
    Yy,
    Depth,
    DepthX,
    DepthY,
    Kx,
    Ky,
    Weight,
    Thickness,
    Flat,
    Sharpness,
    Red,
    Green,
    Blue,
    NormalX,
    NormalY,
    NormalZ,
    Left,
    Right,
    Top,
    Bottom,
    Kept,
}

pub(crate) struct Projected([Lanes; Value::Kept as usize + 1]);

impl Projected {
    pub(crate) const NOTHING: Self = Self([[0.0; LANES]; Value::Kept as usize + 1]);

    #[inline(always)]
    fn get(&self, item: usize, value: Value) -> f32 {
        self.0[value as usize][item]
    }

    /// Whether an item has a disc that may touch pixels.
    #[inline(always)]
    pub(crate) fn is_kept(&self, item: usize) -> bool {
        self.get(item, Value::Kept) > 0.0
    }

    /// Sets a vector of items.
    #[inline(always)]
    pub(crate) fn set<S: Simd>(&mut self, place: usize, value: Value, vector: Vector<S>) {
        S::as_mut_simd_f32s(&mut self.0[value as usize]).0[place] = vector.lanes;
    }

    #[inline(always)]
    pub(crate) fn splat(&self, item: usize) -> Splat {
        let get = |value: Value| self.get(item, value);
        Splat {
            x: get(Value::X),
            y: get(Value::Y),
            xx: get(Value::Xx),
            xy: get(Value::Xy),
            yy: get(Value::Yy),
            depth: get(Value::Depth),
            depth_x: get(Value::DepthX),
            depth_y: get(Value::DepthY),
            kx: get(Value::Kx),
            ky: get(Value::Ky),
            weight: get(Value::Weight),
            thickness: get(Value::Thickness),
            flat: get(Value::Flat) > 0.0,
            columns: [whole(get(Value::Left)), whole(get(Value::Right))],
            rows: [whole(get(Value::Top)), whole(get(Value::Bottom))],
            sharpness: get(Value::Sharpness),
            colour: [get(Value::Red), get(Value::Green), get(Value::Blue)],
            normal: [get(Value::NormalX), get(Value::NormalY), get(Value::NormalZ)],
        }
    }
}

/// The map from a node's frame to a tile.
#[derive(Clone, Copy)]
pub(crate) struct Map {
    /// Rows x·w, y·w and relative depth, with w the depth or 1.
    rows: [f32; 12],
    /// The tile's first pixel, and the principal point in the tile.
    pub(crate) first: [f32; 2],
    centre: [f32; 2],
    /// Last row and column, not included.
    size: [f32; 2],
    two_sided: bool,
    margin: f32,
}

impl Map {
    /// `margin` is how far from its centre any disc of `node` may touch pixels.
    pub(crate) fn new(
        camera: &Camera,
        node: &Node,
        margin: f32,
        tile: &tile::Place,
        two_sided: bool,
    ) -> Self {
        let f = f64::from(camera.focal);
        let (right, down, forward) = (camera.view.right(), -camera.view.up(), camera.view.forward());
        let origin = camera.local(node);
        let [cx, cy] = [camera.centre[0] - tile.x as f64, camera.centre[1] - tile.y as f64];
        let (x, y) = if camera.is_perspective {
            (
                (f * right + cx * forward, f * origin.x + cx * origin.z),
                (f * down + cy * forward, f * origin.y + cy * origin.z),
            )
        } else {
            ((f * right, f * origin.x + cx), (f * down, f * origin.y + cy))
        };
        let depth = (forward, origin.z - camera.reference);
        let mut rows = [0.0; 12];
        for (row, (n, offset)) in rows.chunks_exact_mut(4).zip::<[(DVec3, f64); 3]>([x, y, depth]) {
            row.copy_from_slice(&[n.x as f32, n.y as f32, n.z as f32, offset as f32]);
        }
        let size = [tile.width as f32, tile.height as f32];
        let first = [tile.x as f32, tile.y as f32];
        Self { rows, first, centre: [cx as f32, cy as f32], size, two_sided, margin }
    }
}

/// Where centres are on the picture, and which way discs face.
pub(crate) struct Placed<S: Simd> {
    pub(crate) x: Vector<S>,
    pub(crate) y: Vector<S>,
    depth: Vector<S>,
    /// 1/distance from the eye along the view axis, and pixels per unit there.
    inverse: Vector<S>,
    scale: Vector<S>,
    /// The way from the eye, for one along the view axis.
    way: [Vector<S>; 2],
    pub(crate) normal: [Vector<S>; 3],
    /// See [`crate::items::Items::spreads`].
    spread: [Vector<S>; 3],
    /// Below 0 towards the eye.
    facing: Vector<S>,
}

impl<S: Simd> Placed<S> {
    /// Steps: 1 place and depth; 2 normal, seen from the eye.
    #[inline(always)]
    pub(crate) fn new(
        simd: S,
        camera: &Camera,
        map: &Map,
        offset: [Vector<S>; 3],
        normal: [Vector<S>; 3],
        spread: [Vector<S>; 3],
    ) -> Self {
        // 1
        let rows = map.rows;
        let depth = row(offset, [rows[8], rows[9], rows[10]]) + rows[11];
        let inverse = (depth + camera.reference as f32).inverse();
        let w = if camera.is_perspective { inverse } else { Vector::all(simd, 1.0) };
        let x = (row(offset, [rows[0], rows[1], rows[2]]) + rows[3]) * w;
        let y = (row(offset, [rows[4], rows[5], rows[6]]) + rows[7]) * w;
        // 2
        let slope = if camera.is_perspective { 1.0 / camera.focal } else { 0.0 };
        let way = [(x - map.centre[0]) * slope, (y - map.centre[1]) * slope];
        let (normal, spread) = (turned(normal, &camera.axes), turned(spread, &camera.axes));
        let facing = normal[0] * way[0] + normal[1] * way[1] + normal[2];
        let scale = w * camera.focal;
        let mut placed = Self { x, y, depth, inverse, scale, way, normal, spread, facing };
        if map.two_sided {
            let flip = Vector::all(simd, -1.0).if_set(facing.exceeds(0.0), 1.0);
            placed.facing = facing * flip;
            placed.normal = [normal[0] * flip, normal[1] * flip, normal[2] * flip];
        }
        placed
    }

    /// Which discs face the eye and may have parts in the tile.
    #[inline(always)]
    pub(crate) fn may_show(&self, simd: S, camera: &Camera, map: &Map) -> S::m32s {
        let right =
            simd.and_m32s(self.x.exceeds(-map.margin), (-self.x).exceeds(-(map.size[0] + map.margin)));
        let below =
            simd.and_m32s(self.y.exceeds(-map.margin), (-self.y).exceeds(-(map.size[1] + map.margin)));
        let faces = simd.and_m32s(self.depth.exceeds(camera.near), (-self.facing).exceeds(0.0));
        simd.and_m32s(simd.and_m32s(right, below), faces)
    }
}

#[inline(always)]
fn row<S: Simd>(v: [Vector<S>; 3], row: [f32; 3]) -> Vector<S> {
    v[0] * row[0] + v[1] * row[1] + v[2] * row[2]
}

#[inline(always)]
fn turned<S: Simd>(v: [Vector<S>; 3], [a, b, c]: &[Vec3; 3]) -> [Vector<S>; 3] {
    [row(v, a.to_array()), row(v, b.to_array()), row(v, c.to_array())]
}

/// kᵀ·V·k, V as its three different entries.
#[inline(always)]
fn along<S: Simd>([kx, ky]: [Vector<S>; 2], v: [Vector<S>; 3]) -> Vector<S> {
    kx * kx * v[0] + kx * ky * v[1] * 2.0 + ky * ky * v[2]
}

/// Steps, on: 3 covariance; 4 plane; 5 kernel; 6 the pixels that it touches.
#[inline(always)]
pub(crate) fn project<S: Simd>(
    simd: S,
    placed: &Placed<S>,
    [disc_radius, area]: [Vector<S>; 2],
    (camera, shape, map): (&Camera, &Shape, &Map),
    out: &mut Projected,
    place: usize,
) {
    let Placed { x, y, depth, inverse, scale, way: [ux, uy], normal: [a, b, c], spread: [p, q, r], facing } =
        *placed;
    let (focal, reference) = (camera.focal, camera.reference as f32);
    let constant = |value: f32| Vector::all(simd, value);
    // 3
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
    // 4
    let edge_on = (facing.at_most(-1e-6) * focal).inverse();
    let (kx, ky) = (a * edge_on, b * edge_on);
    let slope_of_disc = (kx * kx + ky * ky).sqrt() * focal;
    // Of a disc as wide as a pair.
    let whole_radius = (disc_radius * disc_radius + (p * p + q * q + r * r) * 4.0).sqrt();
    // What the pixel adds to the disc must not make its plane longer, nor may it come too near to the eye.
    let reach = camera.plane_reach(whole_radius * shape.deviation, blur_radius) * (scale * (1.0 / focal));
    let longest = (reach * reach).at_most(NEAREST_PLANE2) * (1.0 / shape.reach2);
    let long = along([kx, ky], [disc[0] + blur, disc[1], disc[2] + blur]).min(longest);
    let shrink = (long / along([kx, ky], v).at_least(f32::MIN_POSITIVE)).at_most(1.0).sqrt();
    let (kx, ky) = (kx * shrink, ky * shrink);
    let bend = if camera.is_perspective { inverse * (reference * reference) } else { constant(1.0) };
    // The planes of an orthographic view keep their shape: h is 1.
    let curved = if camera.is_perspective { 1.0 } else { 0.0 };
    let k = [kx * curved, ky * curved];
    // 5
    let is_flat = blur.is_above((disc[0] + disc[2]) * 0.5 + shape.pixel_variance);
    let reach2 = constant(shape.flat_reach2).if_set(is_flat, shape.reach2);
    // The integrals of (1 − q/R)² and of √(1 − q/R): πR/3 and 2πR/3, times the root of |V|.
    let integral = reach2 * constant(2.0).if_set(is_flat, 1.0) * (std::f32::consts::PI / 3.0);
    let root = determinant.at_least(f32::MIN_POSITIVE).sqrt();
    let share = -(area * scale * scale * facing);
    let half_difference = (v[0] - v[2]) * 0.5;
    let narrow = (v[0] + v[2]) * 0.5 - (half_difference * half_difference + v[1] * v[1]).sqrt();
    let conic = (determinant * reach2).inverse();
    let edge = (narrow / (blur + EDGE_VARIANCE)).at_least(1.0).sqrt();
    // 6
    let [left, right, top, bottom] = ends([x, y], v, k, reach2, map.size);
    let is_kept = simd.and_m32s(depth.exceeds(camera.near), (-facing).exceeds(0.0));
    let is_kept = simd.and_m32s(is_kept, simd.and_m32s(right.is_above(left), bottom.is_above(top)));
    let bent = if camera.is_perspective { depth * (inverse * reference) } else { depth };
    let thickness = camera.thickness(whole_radius, slope_of_disc, scale.inverse(), blur_radius);
    let sharpness = if shape.is_paper { (radius * scale).at_most(1e6) } else { edge };
    for (value, result) in [
        (Value::X, x),
        (Value::Y, y),
        (Value::Xx, v[2] * conic),
        (Value::Xy, -(v[1] * conic)),
        (Value::Yy, v[0] * conic),
        (Value::Depth, bent),
        (Value::DepthX, -(kx * bend)),
        (Value::DepthY, -(ky * bend)),
        (Value::Kx, k[0]),
        (Value::Ky, k[1]),
        // Discs of any size next to the eye: sums of weights have to stay numbers.
        (Value::Weight, (share / (integral * root)).at_most(1e3)),
        (Value::Thickness, thickness * camera.bending(inverse)),
        (Value::Flat, constant(1.0).if_set(is_flat, 0.0)),
        (Value::Sharpness, sharpness),
        (Value::NormalX, a),
        (Value::NormalY, b),
        (Value::NormalZ, c),
        (Value::Left, left),
        (Value::Right, right),
        (Value::Top, top),
        (Value::Bottom, bottom),
        (Value::Kept, constant(1.0).if_set(is_kept, 0.0)),
    ] {
        out.set(place, value, result);
    }
}

/// Added to a number of pixels, it leaves no bits for fractions: the sum is that of the nearest whole number, which is in its last bits.
const WHOLE: f32 = 8_388_608.0;

/// The whole number to which [`WHOLE`] was added.
#[inline(always)]
fn whole(sum: f32) -> u8 {
    sum.to_bits() as u8
}

/// First column, last column (not included), first row and last row of the box around q ≤ R, within a tile, with [`WHOLE`].
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
