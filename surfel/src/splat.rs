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
use crate::cloud::{Cloud, Node, radius_of_area};
use crate::lattice::offset;
use crate::packed;
use crate::tile;
use glam::{DVec3, Vec3};
use pulp::{Arch, NullaryFnOnce};
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

/// Edges of this variance (in pixels) are as sharp as a pixel shows them: Gaussian with the slope of a box.
const EDGE_VARIANCE: f32 = 0.16;

/// Planes are followed no nearer to the eye than their disc's centre by this factor, squared.
const NEAREST_PLANE2: f32 = 0.5;

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
    /// What is averaged: 1, room for the depth, normal in the picture's axes, colour.
    pub(crate) values: [f32; 8],
}

/// What is drawn of a node.
pub(crate) struct Items<'a> {
    pub(crate) node: &'a Node,
    /// Every which item, for as many.
    pub(crate) stride: usize,
}

/// How discs are drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shape {
    /// Standard deviation of the kernel over the radius.
    deviation: f32,
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
const LANES: usize = 64;

type Lanes = [f32; LANES];

/// Items of a node in its own frame, and on the picture.
pub(crate) struct Projector {
    offsets: [Lanes; 3],
    normals: [Lanes; 3],
    radii: Lanes,
    areas: Lanes,
    out: Projected,
}

struct Projected {
    x: Lanes,
    y: Lanes,
    xx: Lanes,
    xy: Lanes,
    yy: Lanes,
    depth: Lanes,
    depth_x: Lanes,
    depth_y: Lanes,
    kx: Lanes,
    ky: Lanes,
    weight: Lanes,
    thickness: Lanes,
    flat: Lanes,
    sharpness: Lanes,
    normals: [Lanes; 3],
    ends: [Lanes; 4],
    kept: Lanes,
}

/// The map from a node's frame to a tile.
#[derive(Clone, Copy)]
struct Map {
    /// Rows x·w, y·w and relative depth, with w the depth or 1.
    rows: [f32; 12],
    /// The principal point in the tile.
    centre: [f32; 2],
    /// Last row and column, not included.
    size: [f32; 2],
    two_sided: bool,
}

impl Map {
    fn new(camera: &Camera, node: &Node, tile: &tile::Place, two_sided: bool) -> Self {
        let f = f64::from(camera.focal);
        let v = &camera.view;
        let origin = camera.local(node);
        let [cx, cy] = [camera.centre[0] - tile.x as f64, camera.centre[1] - tile.y as f64];
        let (x, y) = if camera.is_perspective {
            (
                (f * v.right + cx * v.forward, f * origin.x + cx * origin.z),
                (f * v.down + cy * v.forward, f * origin.y + cy * origin.z),
            )
        } else {
            ((f * v.right, f * origin.x + cx), (f * v.down, f * origin.y + cy))
        };
        let depth = (v.forward, origin.z - camera.reference);
        let mut rows = [0.0; 12];
        for (row, (n, offset)) in rows.chunks_exact_mut(4).zip::<[(DVec3, f64); 3]>([x, y, depth]) {
            row.copy_from_slice(&[n.x as f32, n.y as f32, n.z as f32, offset as f32]);
        }
        let size = [tile.width as f32, tile.height as f32];
        Self { rows, centre: [cx as f32, cy as f32], size, two_sided }
    }
}

impl Projector {
    pub(crate) fn new() -> Box<Self> {
        let zero = [0.0; LANES];
        let out = Projected {
            x: zero,
            y: zero,
            xx: zero,
            xy: zero,
            yy: zero,
            depth: zero,
            depth_x: zero,
            depth_y: zero,
            kx: zero,
            ky: zero,
            weight: zero,
            thickness: zero,
            flat: zero,
            sharpness: zero,
            normals: [zero; 3],
            ends: [zero; 4],
            kept: zero,
        };
        Box::new(Self { offsets: [zero; 3], normals: [zero; 3], radii: zero, areas: zero, out })
    }

    /// Appends what `drawn` puts into a tile.
    pub(crate) fn project(
        &mut self,
        cloud: &Cloud,
        drawn: &Items<'_>,
        camera: &Camera,
        shape: &Shape,
        tile: &tile::Place,
        splats: &mut Vec<Splat>,
    ) {
        let arch = Arch::new();
        let map = Map::new(camera, drawn.node, tile, cloud.two_sided);
        let end = drawn.node.items.end as usize;
        for start in (drawn.node.items.start as usize..end).step_by(LANES * drawn.stride) {
            let count = if drawn.stride == 1 && drawn.node.is_leaf() {
                self.take_run(cloud, drawn.node, start..(start + LANES).min(end))
            } else {
                self.take_each(cloud, drawn, (start..end).step_by(drawn.stride).take(LANES))
            };
            arch.dispatch(Project { lanes: self, camera, shape, map: &map, count });
            for i in 0..count {
                if self.out.kept[i] > 0.0 {
                    splats.push(self.out.splat(i, colour(cloud, drawn.node, start + i * drawn.stride)));
                }
            }
        }
    }

    /// Takes points that follow one another; how many.
    fn take_run(&mut self, cloud: &Cloud, node: &Node, items: Range<usize>) -> usize {
        let points = &cloud.points;
        let count = items.len();
        for axis in 0..3 {
            let cells = &points.cells[axis][items.clone()];
            for (to, &cell) in self.offsets[axis].iter_mut().zip(cells) {
                *to = offset(node.origin[axis], cell);
            }
            self.normals[axis][..count].copy_from_slice(&points.normals[axis][items.clone()]);
        }
        self.radii[..count].copy_from_slice(&points.radii[items.clone()]);
        self.areas[..count].copy_from_slice(&points.areas[items]);
        count
    }

    /// Takes points or links one by one; how many.
    fn take_each(&mut self, cloud: &Cloud, drawn: &Items<'_>, items: impl Iterator<Item = usize>) -> usize {
        let (node, points) = (drawn.node, &cloud.points);
        let mut count = 0;
        for item in items {
            let (point, normal, area, radius) = if node.is_leaf() {
                (item, points.normal(item), points.areas[item], points.radii[item])
            } else {
                let area = cloud.links.areas[item];
                let normal = packed::unpack_direction(cloud.links.normals[item]);
                (cloud.links.points[item] as usize, normal, area, radius_of_area(area))
            };
            for axis in 0..3 {
                self.offsets[axis][count] = offset(node.origin[axis], points.cells[axis][point]);
                self.normals[axis][count] = normal[axis];
            }
            self.areas[count] = area * drawn.stride as f32;
            self.radii[count] = radius;
            count += 1;
        }
        count
    }
}

fn colour(cloud: &Cloud, node: &Node, item: usize) -> [f32; 3] {
    if node.is_leaf() {
        cloud.points.colours.as_ref().map_or([0.0; 3], |all| all[item])
    } else {
        cloud.links.colours.as_ref().map_or([0.0; 3], |all| packed::unpack_colour(all[item]))
    }
}

impl Projected {
    fn splat(&self, i: usize, colour: [f32; 3]) -> Splat {
        let n = [0, 1, 2].map(|axis| self.normals[axis][i]);
        let [r, g, b] = colour;
        Splat {
            x: self.x[i],
            y: self.y[i],
            xx: self.xx[i],
            xy: self.xy[i],
            yy: self.yy[i],
            depth: self.depth[i],
            depth_x: self.depth_x[i],
            depth_y: self.depth_y[i],
            kx: self.kx[i],
            ky: self.ky[i],
            weight: self.weight[i],
            thickness: self.thickness[i],
            flat: self.flat[i] > 0.0,
            columns: [self.ends[0][i] as u8, self.ends[1][i] as u8],
            rows: [self.ends[2][i] as u8, self.ends[3][i] as u8],
            sharpness: self.sharpness[i],
            values: [1.0, 0.0, n[0], n[1], n[2], r, g, b],
        }
    }
}

/// The arithmetic of [`Projector::project`], compiled once more for each kind of vector instructions: the same
/// operations in the same order, so results do not change.
struct Project<'a> {
    lanes: &'a mut Projector,
    camera: &'a Camera,
    shape: &'a Shape,
    map: &'a Map,
    count: usize,
}

impl NullaryFnOnce for Project<'_> {
    type Output = ();

    // A closure would not be inlined into the vectorised caller, and what is not inlined stays narrow.
    #[inline(always)]
    fn call(self) {
        project_lanes(self.lanes, self.camera, self.shape, self.map, self.count);
    }
}

/// First column, last column (not included), first row and last row of the box around q ≤ R, within a tile.
///
/// With t = V·k and τ = R·k·t < 1, q ≤ R is an ellipse about R·t/(1 − τ) with the covariance V + R·t·tᵀ/(1 − τ), to the
/// reach R/(1 − τ).
#[inline(always)]
fn ends(centre: [f32; 2], v: [f32; 3], k: [f32; 2], reach2: f32, size: [f32; 2]) -> [f32; 4] {
    let (tx, ty) = (v[0] * k[0] + v[1] * k[1], v[1] * k[0] + v[2] * k[1]);
    let reach = reach2 / (1.0 - (reach2 * (k[0] * tx + k[1] * ty)).min(0.75));
    let half = |v: f32, t: f32| (reach * (v + reach * t * t)).sqrt();
    let (hx, hy) = (half(v[0], tx), half(v[2], ty));
    let (x, y) = (centre[0] + reach * tx, centre[1] + reach * ty);
    let end = |v: f32, size: f32| (v + 0.5).clamp(0.0, size) as i32 as f32;
    [end(x - hx, size[0]), end(x + hx, size[0]), end(y - hy, size[1]), end(y + hy, size[1])]
}

/// Steps: 1 place and depth; 2 normal, seen from the eye; 3 covariance; 4 plane; 5 kernel; 6 the pixels that it touches.
#[inline(always)]
fn project_lanes(lanes: &mut Projector, camera: &Camera, shape: &Shape, map: &Map, count: usize) {
    let Projector { offsets: [px, py, pz], normals: [nx, ny, nz], radii, areas, out } = lanes;
    let (rows, axes) = (&map.rows, &camera.axes);
    let (focal, reference) = (camera.focal, camera.reference as f32);
    let slope = if camera.is_perspective { 1.0 / focal } else { 0.0 };
    let turned = |axis: Vec3, i: usize| axis.x * nx[i] + axis.y * ny[i] + axis.z * nz[i];
    for i in 0..count.min(LANES) {
        // 1
        let row = |r: usize| rows[r] * px[i] + rows[r + 1] * py[i] + rows[r + 2] * pz[i] + rows[r + 3];
        let depth = row(8);
        let distance = depth + reference;
        let inverse = 1.0 / distance;
        let w = if camera.is_perspective { inverse } else { 1.0 };
        let (x, y) = (row(0) * w, row(4) * w);
        let (ux, uy) = ((x - map.centre[0]) * slope, (y - map.centre[1]) * slope);
        // 2
        let n = [turned(axes[0], i), turned(axes[1], i), turned(axes[2], i)];
        let facing = n[0] * ux + n[1] * uy + n[2];
        let flip = if map.two_sided && facing > 0.0 { -1.0 } else { 1.0 };
        let (a, b, c, facing) = (n[0] * flip, n[1] * flip, n[2] * flip, facing * flip);
        // 3
        let scale = focal * w;
        let blur_radius = camera.blur_radius(depth);
        let radius = radii[i] + shape.widening * blur_radius;
        let deviation = shape.deviation * radius;
        let s2 = (deviation * scale).powi(2);
        let blur = (0.5 * shape.lens * blur_radius * scale).powi(2);
        let (mx, my) = (a - ux * c, b - uy * c);
        let disc = [s2 * (1.0 + ux * ux - mx * mx), s2 * (ux * uy - mx * my), s2 * (1.0 + uy * uy - my * my)];
        let added = blur + shape.pixel_variance;
        let v = [disc[0] + added, disc[1], disc[2] + added];
        let determinant = v[0] * v[2] - v[1] * v[1];
        // 4
        let edge_on = 1.0 / (focal * facing.min(-1e-6));
        let (kx, ky) = (a * edge_on, b * edge_on);
        let slope_of_disc = (kx * kx + ky * ky).sqrt() * focal;
        let slant = |v: [f32; 3]| kx * kx * v[0] + 2.0 * kx * ky * v[1] + ky * ky * v[2];
        // What the pixel adds to the disc must not make its plane longer, nor may it come too near to the eye.
        let reach = camera.plane_reach(deviation, blur_radius) * w;
        let longest = (reach * reach).min(NEAREST_PLANE2) / shape.reach2;
        let long = slant([disc[0] + blur, disc[1], disc[2] + blur]).min(longest);
        let shrink = (long / slant(v).max(f32::MIN_POSITIVE)).min(1.0).sqrt();
        let (kx, ky) = (kx * shrink, ky * shrink);
        let bend = if camera.is_perspective { reference * (reference * inverse) } else { 1.0 };
        // The planes of an orthographic view keep their shape: h is 1.
        let (hkx, hky) = (kx * slope * focal, ky * slope * focal);
        // 5
        let is_flat = blur > 0.5 * (disc[0] + disc[2]) + shape.pixel_variance;
        let reach2 = if is_flat { shape.flat_reach2 } else { shape.reach2 };
        // The integrals of (1 − q/R)² and of √(1 − q/R): πR/3 and 2πR/3, times the root of |V|.
        let integral = std::f32::consts::PI / 3.0 * reach2 * if is_flat { 2.0 } else { 1.0 };
        let root = determinant.max(f32::MIN_POSITIVE).sqrt();
        let share = areas[i] * scale * scale * -facing;
        let half_difference = 0.5 * (v[0] - v[2]);
        let narrow = 0.5 * (v[0] + v[2]) - (half_difference * half_difference + v[1] * v[1]).sqrt();
        let conic = 1.0 / (determinant * reach2);
        // 6
        let [left, right, top, bottom] = ends([x, y], v, [hkx, hky], reach2, map.size);
        let kept = (depth > camera.near) & (facing < 0.0) & (left < right) & (top < bottom);
        (out.x[i], out.y[i]) = (x, y);
        (out.xx[i], out.xy[i], out.yy[i]) = (v[2] * conic, -v[1] * conic, v[0] * conic);
        out.depth[i] = if camera.is_perspective { depth * (reference * inverse) } else { depth };
        (out.depth_x[i], out.depth_y[i]) = (-kx * bend, -ky * bend);
        (out.kx[i], out.ky[i]) = (hkx, hky);
        // Discs of any size next to the eye: sums of weights have to stay numbers.
        out.weight[i] = (share / (integral * root)).min(1e3);
        out.thickness[i] =
            camera.thickness(radii[i], slope_of_disc, 1.0 / scale, blur_radius) * camera.bending(inverse);
        out.flat[i] = if is_flat { 1.0 } else { 0.0 };
        let edge = (narrow / (EDGE_VARIANCE + blur)).max(1.0).sqrt();
        out.sharpness[i] = if shape.is_paper { (radius * scale).min(1e6) } else { edge };
        (out.normals[0][i], out.normals[1][i], out.normals[2][i]) = (a, b, c);
        (out.ends[0][i], out.ends[1][i], out.ends[2][i], out.ends[3][i]) = (left, right, top, bottom);
        out.kept[i] = if kept { 1.0 } else { 0.0 };
    }
}
