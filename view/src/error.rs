use glam::DVec3;

/// What can be wrong with a camera or the size of its picture.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ViewError {
    /// The eye is not finite, or beyond [`View::LARGEST_COORDINATE`](crate::View::LARGEST_COORDINATE).
    #[error("the eye {eye} is not finite, or beyond 1e300")]
    BadEye {
        /// As given, or as it follows from the matrix; world units.
        eye: DVec3,
    },
    /// The target is not finite, or beyond [`View::LARGEST_COORDINATE`](crate::View::LARGEST_COORDINATE).
    #[error("the target {target} is not finite, or beyond 1e300")]
    BadTarget {
        /// As given; world units.
        target: DVec3,
    },
    /// Eye and target are the same point, so there is no direction to look in.
    #[error("eye and target are the same point, {eye}")]
    EyeIsTarget {
        /// As given; world units.
        eye: DVec3,
    },
    /// The up vector is zero, not finite, or parallel to the view direction (up to rounding).
    #[error("up is {up}; it must be finite, not zero, and not parallel to the view direction {forward}")]
    BadUp {
        /// As given.
        up: DVec3,
        /// Unit vector from the eye to the target.
        forward: DVec3,
    },
    /// The matrix scales or shears, or is not finite.
    #[error(
        "the view matrix is not a rotation and a shift: its columns are off orthonormal by {deviation:e}"
    )]
    NotRigid {
        /// Largest entry of |MᵀM − 1| (M: the 3×3 part); NaN if an entry of M or of the product is not finite.
        deviation: f64,
    },
    /// The matrix mirrors: it takes a right-handed frame to a left-handed one.
    #[error("the view matrix mirrors: its determinant is {determinant}, and must be 1")]
    Mirrored {
        /// About −1.
        determinant: f64,
    },
    /// The field of view is outside its range.
    #[error("a vertical field of view of {fov_y_rad} rad; it must be at least 1e-300 and less than π")]
    BadFieldOfView {
        /// As given, radians.
        fov_y_rad: f64,
    },
    /// The height of an orthographic view is outside its range.
    #[error("an orthographic view {height} high; it must be from 1e-300 to 1e300")]
    BadHeight {
        /// As given, world units.
        height: f64,
    },
    /// The picture has no pixels, or a side is above [`View::LARGEST_SIDE`](crate::View::LARGEST_SIDE).
    #[error("a picture of {width}×{height} pixels; each side must be 1 to 1048576")]
    BadSize {
        /// Pixels from left to right.
        width: u32,
        /// Pixels from top to bottom.
        height: u32,
    },
}
