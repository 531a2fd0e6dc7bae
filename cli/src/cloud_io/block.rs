//! Delivers points in blocks: leaves out those that are not finite, and counts for the summary.

use super::format::CloudFormat;
use super::scalar::{SCALARS, Scalar, Scalars};
use crate::coordinate::{LARGEST, is_usable};
use crate::input_error::InputError;
use glam::{DVec3, Vec3};

/// Most points in a block: 65,536. Enough that the call is cheap, few enough to stay in the cache.
pub const MAX_BLOCK_POINTS: usize = 65_536;

/// Some points in the order of the file. All slices have the same length, from 1 to [`MAX_BLOCK_POINTS`]; all numbers are
/// finite. Which slices there are is the same for all blocks of a file.
#[derive(Clone, Copy, Debug)]
pub struct CloudBlock<'a> {
    /// In the file's units and frame; f64, because surveys have offsets of millions of metres.
    pub positions: &'a [DVec3],
    /// Linear RGB from 0 to 1.
    pub colours: Option<&'a [[f32; 3]]>,
    /// From 0 to 1.
    pub opacities: Option<&'a [f32]>,
    /// As in the file; not always of unit length.
    pub normals: Option<&'a [Vec3]>,
    /// Properties `face_nx face_ny face_nz` beside normals: across the surface on which the points lie, where the normals are interpolated.
    pub face_normals: Option<&'a [Vec3]>,
    /// Property `radius` of surfels, in the unit of the positions, as in the file.
    pub radii: Option<&'a [f32]>,
    /// By [`Scalar`], with [`CloudOptions::scalars`].
    pub scalars: [Option<&'a [f32]>; SCALARS],
}

impl<'a> CloudBlock<'a> {
    /// A measured value of each point, if the file has it and [`CloudOptions::scalars`] asks for it; NaN where a point has none.
    #[must_use]
    pub const fn scalar(&self, scalar: Scalar) -> Option<&'a [f32]> {
        self.scalars[scalar as usize]
    }
}

/// How [`super::read_cloud`] treats its input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct CloudOptions {
    /// Points with a number that is NaN or infinite, or with a coordinate beyond 1e18, are left out and counted, in the place of an error. Default: `false`.
    pub drop_invalid: bool,
    /// Most points in a block, from 1 to [`MAX_BLOCK_POINTS`]; anything else is moved there. Default: [`MAX_BLOCK_POINTS`].
    pub block_points: usize,
    /// Read intensities, classes and numbers of returns too. Default: `false`.
    pub scalars: bool,
}

impl CloudOptions {
    /// The defaults, as a constant.
    pub const DEFAULT: Self = Self { drop_invalid: false, block_points: MAX_BLOCK_POINTS, scalars: false };

    /// Leaves out points that are not finite.
    #[must_use]
    pub const fn with_drop_invalid(mut self, drop_invalid: bool) -> Self {
        self.drop_invalid = drop_invalid;
        self
    }

    /// Reads intensities, classes and numbers of returns too.
    #[must_use]
    pub const fn with_scalars(mut self, scalars: bool) -> Self {
        self.scalars = scalars;
        self
    }

    /// Hands out at most this many points at once.
    #[must_use]
    pub const fn with_block_points(mut self, block_points: usize) -> Self {
        self.block_points = block_points;
        self
    }
}

impl Default for CloudOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// What a file held, known once it is read.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct CloudSummary {
    /// What it was written in.
    pub format: CloudFormat,
    /// Points handed out; at least 1.
    pub points: u64,
    /// Points left out because a number was not finite; 0 without [`CloudOptions::drop_invalid`].
    pub dropped: u64,
    /// Whether blocks have colours.
    pub has_colours: bool,
    /// Whether blocks have opacities.
    pub has_opacities: bool,
    /// Whether blocks have normals.
    pub has_normals: bool,
    /// Whether blocks have normals of the surface beside interpolated ones.
    pub has_face_normals: bool,
    /// Whether blocks have radii.
    pub has_radii: bool,
    /// Whether the file has these, by [`Scalar`]; blocks have them with [`CloudOptions::scalars`].
    pub has_scalars: Scalars<bool>,
    /// Lowest and highest coordinates of the points handed out.
    pub bounds: [DVec3; 2],
    /// Faces that the file announces and that were passed over; a file with some is a mesh.
    pub faces: u64,
    /// The grid of a Stanford range scan.
    pub grid: Option<RangeGrid>,
    /// What may be wrong, in sentences without the file's name.
    pub warnings: Vec<String>,
}

/// The grid of a range scan: row after row, `rows` × `cols` cells, each a point or a hole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RangeGrid {
    /// Cells in a row.
    pub cols: u64,
    /// Rows.
    pub rows: u64,
    /// Cells that hold a point.
    pub filled: u64,
    /// Median distance between the points of neighbouring cells of a row, in the file's unit; none if no two neighbours
    /// are filled. A median, because some neighbours are on both sides of an edge of the object, far apart.
    pub spacing: Option<f64>,
}

/// Why the reading ended early.
#[derive(Debug)]
pub(super) enum Stop {
    /// Something is wrong with the file.
    Input(InputError),
    /// The sink had an error, which `with_sink` keeps.
    Sink,
}

impl From<InputError> for Stop {
    fn from(error: InputError) -> Self {
        Self::Input(error)
    }
}

/// Where a point is, for messages.
#[derive(Clone, Copy, Debug)]
pub(super) enum At {
    /// Line, from 1.
    Line(u64),
    /// Offset of its first byte, from 0.
    Byte(u64),
    /// Number of the point, from 0, where the library that decodes the file tells no more.
    #[cfg(any(feature = "las", feature = "e57"))]
    Point(u64),
}

impl std::fmt::Display for At {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Line(line) => write!(f, "in line {line}"),
            Self::Byte(byte) => write!(f, "at byte {byte}"),
            #[cfg(any(feature = "las", feature = "e57"))]
            Self::Point(point) => write!(f, "number {point} (from 0)"),
        }
    }
}

/// One point, with zeros for what the file does not have.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Point {
    pub(super) position: DVec3,
    pub(super) normal: Vec3,
    pub(super) face_normal: Vec3,
    pub(super) colour: [f32; 3],
    pub(super) opacity: f32,
    pub(super) radius: f32,
    /// NaN where the point has none.
    pub(super) scalars: Scalars<f32>,
}

/// What each point of a file has beside its position.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Has {
    pub(super) colours: bool,
    pub(super) opacities: bool,
    pub(super) normals: bool,
    pub(super) face_normals: bool,
    pub(super) radii: bool,
    pub(super) scalars: Scalars<bool>,
}

impl Point {
    fn can_be_used(&self) -> bool {
        let [r, g, b] = self.colour;
        // A sum is not finite if a term is not; terms that are finite in f32 cannot overflow this one.
        let rest =
            f64::from(r) + f64::from(g) + f64::from(b) + f64::from(self.opacity) + f64::from(self.radius);
        is_usable(self.position)
            && self.normal.is_finite()
            && self.face_normal.is_finite()
            && rest.is_finite()
    }
}

/// Gathers points into blocks, and hands a block out when it is full.
pub(super) struct Gather<'a> {
    sink: &'a mut dyn FnMut(CloudBlock<'_>) -> Result<(), Stop>,
    drop_invalid: bool,
    block_points: usize,
    wants_scalars: bool,
    has: Has,
    positions: Vec<DVec3>,
    colours: Vec<[f32; 3]>,
    opacities: Vec<f32>,
    normals: Vec<Vec3>,
    face_normals: Vec<Vec3>,
    radii: Vec<f32>,
    scalars: Scalars<Vec<f32>>,
    seen: u64,
    handed_out: u64,
    invalid: u64,
    first_invalid: Option<At>,
    low: DVec3,
    high: DVec3,
}

impl<'a> Gather<'a> {
    pub(super) fn new(
        options: &CloudOptions,
        sink: &'a mut dyn FnMut(CloudBlock<'_>) -> Result<(), Stop>,
    ) -> Self {
        Self {
            sink,
            drop_invalid: options.drop_invalid,
            block_points: options.block_points.clamp(1, MAX_BLOCK_POINTS),
            wants_scalars: options.scalars,
            has: Has::default(),
            positions: Vec::new(),
            colours: Vec::new(),
            opacities: Vec::new(),
            normals: Vec::new(),
            face_normals: Vec::new(),
            radii: Vec::new(),
            scalars: Scalars::default(),
            seen: 0,
            handed_out: 0,
            invalid: 0,
            first_invalid: None,
            low: DVec3::INFINITY,
            high: DVec3::NEG_INFINITY,
        }
    }

    /// Says what the points to come have; once, before the first of them.
    pub(super) fn expect(&mut self, has: Has) {
        debug_assert_eq!(self.seen, 0, "all points of a file have the same");
        self.has = has;
    }

    /// Takes a point.
    pub(super) fn push(&mut self, point: &Point, at: At) -> Result<(), Stop> {
        self.seen += 1;
        if !point.can_be_used() {
            self.invalid += 1;
            self.first_invalid.get_or_insert(at);
            return Ok(());
        }
        if self.invalid > 0 && !self.drop_invalid {
            // The file will be refused; what remains is to count.
            return Ok(());
        }
        self.low = self.low.min(point.position);
        self.high = self.high.max(point.position);
        self.positions.push(point.position);
        if self.has.colours {
            self.colours.push(point.colour);
        }
        if self.has.opacities {
            self.opacities.push(point.opacity);
        }
        if self.has.normals {
            self.normals.push(point.normal);
        }
        if self.has.face_normals {
            self.face_normals.push(point.face_normal);
        }
        if self.has.radii {
            self.radii.push(point.radius);
        }
        if self.wants_scalars {
            for ((values, value), has) in self.scalars.iter_mut().zip(point.scalars).zip(self.has.scalars) {
                if has {
                    values.push(value);
                }
            }
        }
        if self.positions.len() >= self.block_points { self.hand_out() } else { Ok(()) }
    }

    fn hand_out(&mut self) -> Result<(), Stop> {
        if self.positions.is_empty() {
            return Ok(());
        }
        self.handed_out += self.positions.len() as u64;
        let block = CloudBlock {
            positions: &self.positions,
            colours: self.has.colours.then_some(&*self.colours),
            opacities: self.has.opacities.then_some(&*self.opacities),
            normals: self.has.normals.then_some(&*self.normals),
            face_normals: self.has.face_normals.then_some(&*self.face_normals),
            radii: self.has.radii.then_some(&*self.radii),
            scalars: std::array::from_fn(|i| {
                (self.wants_scalars && self.has.scalars[i]).then_some(&*self.scalars[i])
            }),
        };
        (self.sink)(block)?;
        self.positions.clear();
        self.colours.clear();
        self.opacities.clear();
        self.normals.clear();
        self.face_normals.clear();
        self.radii.clear();
        self.scalars.iter_mut().for_each(Vec::clear);
        Ok(())
    }

    /// Hands out the rest of a part of a file, which may have no points that can be used.
    ///
    /// # Errors
    ///
    /// Points that are not finite and may not be dropped.
    pub(super) fn finish_part(&mut self, name: &str) -> Result<(), Stop> {
        if let Some(at) = self.first_invalid.filter(|_| !self.drop_invalid) {
            let (invalid, seen) = (self.invalid, self.seen);
            let message =
                format!("{invalid} of {seen} points are not finite, or beyond ±{LARGEST:e}, the first {at}");
            return Err(InputError::of_file(name, message)
                .with_help("`--drop-invalid` leaves them out")
                .into());
        }
        self.hand_out()
    }

    /// Hands out the rest and sums up.
    ///
    /// # Errors
    ///
    /// No points, or points that are not finite and may not be dropped.
    pub(super) fn finish(&mut self, name: &str, format: CloudFormat) -> Result<CloudSummary, Stop> {
        self.finish_part(name)?;
        if self.handed_out == 0 {
            let message = match self.seen {
                0 => "the cloud has no points".to_owned(),
                seen => format!("none of the {seen} points is finite and within ±{LARGEST:e}"),
            };
            return Err(InputError::of_file(name, message)
                .with_help("give a file with at least one point")
                .into());
        }
        Ok(CloudSummary {
            format,
            points: self.handed_out,
            dropped: self.invalid,
            has_colours: self.has.colours,
            has_opacities: self.has.opacities,
            has_normals: self.has.normals,
            has_face_normals: self.has.face_normals,
            has_radii: self.has.radii,
            has_scalars: self.has.scalars,
            bounds: [self.low, self.high],
            faces: 0,
            grid: None,
            warnings: Vec::new(),
        })
    }
}
