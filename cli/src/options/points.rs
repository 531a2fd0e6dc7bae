//! Options that `scan` and `surfel` share.

use crate::points::PointLayer;
use std::str::FromStr;

/// One entry of `--layers`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointLayerRequest {
    /// Everything there is.
    All,
    /// One of them.
    One(PointLayer),
}

impl FromStr for PointLayerRequest {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "all" => Ok(Self::All),
            "N" => Ok(Self::One(PointLayer::Normal)),
            "P" => Ok(Self::One(PointLayer::Position)),
            "count" => Ok(Self::One(PointLayer::Count)),
            _ => Err("layers of points are all, N, P and count (only of `scan`)".to_owned()),
        }
    }
}

/// The layers of `there` that were asked for, each once.
///
/// # Errors
///
/// The first one that was asked for by name and is not there.
pub fn layer_list(
    requests: &[PointLayerRequest],
    there: &[PointLayer],
) -> Result<Vec<PointLayer>, PointLayer> {
    let missing = requests.iter().find_map(|request| match request {
        PointLayerRequest::One(layer) if !there.contains(layer) => Some(*layer),
        _ => None,
    });
    let asked = |layer: &PointLayer| {
        requests.contains(&PointLayerRequest::All) || requests.contains(&PointLayerRequest::One(*layer))
    };
    missing.map_or_else(|| Ok(there.iter().copied().filter(asked).collect()), Err)
}
