/// Errors of scans, views and options.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum IbprError {
    /// No scan holds a point.
    #[error("there are no points to draw")]
    NoPoints,
    /// A scan was removed before, or belongs to another cloud.
    #[error("the cloud has no such scan; `Cloud::scans` lists those that it has")]
    UnknownScan,
    /// A coordinate is NaN or infinite.
    #[error("point {index} of scan {scan} is not finite: {value:?}")]
    PointNotFinite {
        /// Position of the scan in the slice.
        scan: usize,
        /// Position of the point in its scan.
        index: usize,
        /// Its coordinates.
        value: [f64; 3],
    },
    /// A coordinate is beyond [`Scan::FARTHEST`](crate::Scan::FARTHEST).
    #[error(
        "point {index} of scan {scan} is too far from the origin: {value:?}; coordinates can be up to 4.4e307"
    )]
    PointTooFar {
        /// Position of the scan in the slice.
        scan: usize,
        /// Position of the point in its scan.
        index: usize,
        /// Its coordinates.
        value: [f64; 3],
    },
    /// A color is NaN, negative, or above [`Scan::BRIGHTEST`](crate::Scan::BRIGHTEST).
    #[error("the color of point {index} of scan {scan} is not from 0 to 1e28: {value:?}")]
    BadColor {
        /// Position of the scan in the slice.
        scan: usize,
        /// Position of the point in its scan.
        index: usize,
        /// Linear RGB.
        value: [f32; 3],
    },
    /// There must be a color for each point, or none.
    #[error("scan {scan} has {colors} colors for {points} points")]
    LengthMismatch {
        /// Position of the scan in the slice.
        scan: usize,
        /// How many colors were given.
        colors: usize,
        /// How many points there are.
        points: usize,
    },
    /// An opacity is NaN, or not from 0 to 1.
    #[error("the opacity of point {index} of scan {scan} is not from 0 to 1: {value}")]
    BadOpacity {
        /// Position of the scan in the slice.
        scan: usize,
        /// Position of the point in its scan.
        index: usize,
        /// As given.
        value: f32,
    },
    /// There must be an opacity for each point, or none.
    #[error("scan {scan} has {opacities} opacities for {points} points")]
    OpacityCount {
        /// Position of the scan in the slice.
        scan: usize,
        /// How many opacities were given.
        opacities: usize,
        /// How many points there are.
        points: usize,
    },
    /// The spacing of a scan is not finite, or not above 0.
    #[error("scan {scan} has a spacing of {spacing}; it must be finite and above 0")]
    BadSpacing {
        /// Position of the scan in the slice.
        scan: usize,
        /// As given, world units.
        spacing: f64,
    },
    /// The direction towards the scanner is zero or not finite.
    #[error("scan {scan}: the direction towards the scanner is {value:?}; it must be finite and not zero")]
    BadDirection {
        /// Position of the scan in the slice.
        scan: usize,
        /// As given.
        value: [f64; 3],
    },
    /// All scans together have more points than 32 bits can number.
    #[error("{count} points, and there can be at most {limit}")]
    TooManyPoints {
        /// How many there are.
        count: usize,
        /// How many there can be.
        limit: usize,
    },
    /// A side of the picture is above [`Renderer::LARGEST_SIDE`](crate::Renderer::LARGEST_SIDE).
    #[error("a picture of {width}×{height} pixels cannot be drawn: each side must be at most 16384")]
    TooLarge {
        /// Pixels from left to right.
        width: u32,
        /// Pixels from top to bottom.
        height: u32,
    },
    /// An option is outside its range.
    #[error("{name} = {value} is not usable: {range}")]
    BadOption {
        /// Name of the field.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        range: &'static str,
    },
}
