/// What can be wrong with a light.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ShadowError {
    /// A position or direction is NaN or infinite.
    #[error("the light's {what} is not finite")]
    NotFinite {
        /// Position or direction.
        what: &'static str,
    },
    /// A direction is zero.
    #[error("the light's direction is zero")]
    NoDirection,
    /// A fixed light grid must have 1 to 2²⁰ cells per side.
    #[error("a light grid of {0} cells per side; 1 to 1048576 are possible")]
    BadResolution(u32),
}
