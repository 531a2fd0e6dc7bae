//! What can be wrong with a request.

/// Why a request has no answer.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SiteError {
    /// The request is not one of the page's.
    #[error("no request `{0}`")]
    Unknown(String),
    /// A word is missing or is not what belongs there.
    #[error("`{name}` is missing, or is not {expected}: {word:?}")]
    Word {
        /// What the word says.
        name: &'static str,
        /// What it should be.
        expected: &'static str,
        /// What is there.
        word: String,
    },
    /// Something is asked for that has to be made by another request first.
    #[error("`{0}` comes first")]
    TooEarly(&'static str),
    /// A file that is no model.
    #[error("{name}: {problem}")]
    File {
        /// As the visitor calls it.
        name: String,
        /// What is wrong with it.
        problem: String,
    },
    /// The camera.
    #[error(transparent)]
    View(#[from] pointillist_view::ViewError),
    /// The polygon.
    #[error(transparent)]
    Dice(#[from] pointillist_dice::DiceError),
    /// The surfels.
    #[error(transparent)]
    Surfel(#[from] pointillist_surfel::SurfelError),
    /// The range scans.
    #[error(transparent)]
    Scan(#[from] pointillist_ibpr::IbprError),
    /// The light in the rooms.
    #[error(transparent)]
    Radiosity(#[from] pointillist_radiosity::RadiosityError),
    /// The probes.
    #[error(transparent)]
    Probe(#[from] pointillist_shprobe::ProbeError),
    /// What probes hold.
    #[error(transparent)]
    Harmonics(#[from] pointillist_shprobe::sh::ShError),
    /// Their cells.
    #[error(transparent)]
    Cells(#[from] pointillist_shprobe::delaunay::DelaunayError),
}
