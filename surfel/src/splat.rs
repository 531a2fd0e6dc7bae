//! A disc as it is drawn: an ellipse in the pixels of a tile, with a plane; and the kernels that discs have.

use crate::layer;
use std::ops::Range;

/// Standard deviation of a disc's kernel over its radius. Found by experiment: narrower ones leave spots between
/// points, wider ones blur.
pub(crate) const DEVIATION_PER_RADIUS: f32 = 0.5;

/// Variance and standard deviation of a pixel, a box of side 1.
pub(crate) const PIXEL_VARIANCE: f32 = 1.0 / 12.0;
pub(crate) const PIXEL_DEVIATION: f32 = 0.288_675_13;

/// A kernel ends where q is this: a kernel (1 − q/R)² then has the covariance V.
pub(crate) const REACH2: f32 = 8.0;

/// The same for the flatter kernel √(1 − q/R) of discs that are mostly blur: a lens blurs evenly over a disc.
pub(crate) const FLAT_REACH2: f32 = 5.0;

/// Added in quadrature to the radius of the paper's hard-edged discs: half the diagonal of a pixel, so that each disc
/// covers the centre of a pixel.
pub(crate) const LEAST_RADIUS2: f32 = 0.5;

/// The ellipse of these discs covers both of a pair, where they are a radius apart.
pub(crate) const DISC_SPREAD: f32 = 2.236;

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
    /// Color with its light, premultiplied by the opacity.
    pub(crate) color: [f32; 3],
    pub(crate) opacity: f32,
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
        color: [0.0; 3],
        opacity: 1.0,
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

/// Parameters of how discs are drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shape {
    /// Standard deviation of the kernel over the radius, and what it gains from the spread of a pair.
    pub(crate) deviation: f32,
    pub(crate) spread: f32,
    /// Variance that is added for the pixel.
    pub(crate) pixel_variance: f32,
    pub(crate) reach2: f32,
    pub(crate) flat_reach2: f32,
    /// Share of the blur that is a kernel of its own, and share that widens the radius of the disc.
    pub(crate) lens: f32,
    pub(crate) widening: f32,
    /// Whether `sharpness` is to be the radius in pixels.
    pub(crate) is_paper: bool,
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
