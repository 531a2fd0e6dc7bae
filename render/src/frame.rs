//! A rendered picture, or a part of one, in memory.

use crate::cryptomatte::Matte;
use pointillist_view::PixelRect;

/// What can be asked for beside colour and depth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum LayerKind {
    /// `N.X N.Y N.Z`: shading normal in the world, a unit vector on the side that is seen, of the micropoint with the largest weight.
    /// 0 where nothing is.
    Normal,
    /// `P.X P.Y P.Z`: position in the world, of the micropoint with the largest weight. 0 where nothing is.
    Position,
    /// `albedo.R G B`: diffuse albedo, times coverage.
    Albedo,
    /// `direct.R G B`: radiance that surfaces reflect of the lights, times coverage. What lies behind clear surfaces counts as far as they let it
    /// pass, here and in the two colours around.
    Direct,
    /// `indirect.R G B`: radiance that surfaces reflect, mirror or transmit of ambient light and surroundings, times coverage.
    Indirect,
    /// `lit.<light>`: the fraction of light number n that reaches surfaces in front of it, 0 to 1, times coverage.
    Lit(usize),
    /// `id`: object number from 1; 0 where nothing is.
    Id,
    /// `back`: the share of the pixel that shows backs of surfaces, 0 to 1.
    Back,
    /// `CryptoObject00.R G B A`, …: which objects or materials are seen, and how much of the pixel each covers.
    Cryptomatte(Matte),
}

/// One layer's planes, each row-major over the frame's window.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Names as in the EXR: `N.X`, `albedo.R`, `lit.sun`, `id`.
    pub channels: Vec<String>,
    /// A plane for each channel.
    pub planes: Vec<Vec<f32>>,
    /// The names that [`cryptomatte_id`](crate::cryptomatte_id) makes ids of; empty for all other layers.
    pub names: Vec<String>,
}

/// A rendered picture, or the part of it that `window` says.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Width and height of the whole picture.
    pub size: [u32; 2],
    /// What of it is here.
    pub window: PixelRect,
    /// R G B A, row-major over the window. R G B is linear radiance, what is seen of the background included; A is the share of the
    /// pixel that surfaces cover; where they let colours pass differently, the mean over the colours. With a black background, R G B is therefore premultiplied by A. Otherwise, subtract `(1 − A) ·
    /// background` before the picture is composited over another one.
    pub color: Vec<[f32; 4]>,
    /// Depth along the view axis; +∞ where nothing is. Empty if it was not computed.
    pub depth: Vec<f32>,
    /// The further layers that were asked for, in that order.
    pub layers: Vec<Layer>,
}

impl LayerKind {
    /// The EXR channels of this layer; `lights` are the names of the scene's lights.
    #[must_use]
    pub fn channels(self, lights: &[&str]) -> Vec<String> {
        let named = |name: &str, axes: [&str; 3]| axes.map(|axis| format!("{name}.{axis}")).to_vec();
        match self {
            Self::Normal => named("N", ["X", "Y", "Z"]),
            Self::Position => named("P", ["X", "Y", "Z"]),
            Self::Albedo => named("albedo", ["R", "G", "B"]),
            Self::Direct => named("direct", ["R", "G", "B"]),
            Self::Indirect => named("indirect", ["R", "G", "B"]),
            Self::Lit(light) => vec![format!("lit.{}", lights.get(light).copied().unwrap_or("light"))],
            Self::Id => vec!["id".to_owned()],
            Self::Back => vec!["back".to_owned()],
            Self::Cryptomatte(matte) => matte.channels(),
        }
    }

    /// Whether tiles have a red, a green and a blue plane of it.
    pub(crate) fn is_by_color(self) -> bool {
        matches!(self, Self::Albedo | Self::Direct | Self::Indirect | Self::Lit(_))
    }

    /// How many planes of it tiles have.
    pub(crate) fn tile_planes(self) -> usize {
        match self {
            Self::Normal | Self::Position | Self::Albedo | Self::Direct | Self::Indirect | Self::Lit(_) => 3,
            Self::Id | Self::Back => 1,
            Self::Cryptomatte(matte) => matte.channels().len(),
        }
    }
}
