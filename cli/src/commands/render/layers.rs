//! `--layers`.

use crate::error::CliError;
use crate::image_io::LayerKind;
use crate::options::LayerRequest;
use crate::scene::Scene;
use pointillist_render::Matte;

/// The layers that are asked for, each once.
pub(super) fn layers(scene: &Scene, requests: &[LayerRequest]) -> Result<Vec<LayerKind>, CliError> {
    let mut kinds = Vec::new();
    let lights = 0..scene.lights.len();
    for request in requests {
        let more = match request {
            LayerRequest::All => {
                use LayerKind::{Albedo, Direct, Id, Indirect, Lit, Normal, Position};
                let mut all = vec![Normal, Position, Albedo, Direct, Indirect, Id];
                all.extend(lights.clone().map(Lit));
                all
            }
            LayerRequest::Normal => vec![LayerKind::Normal],
            LayerRequest::Position => vec![LayerKind::Position],
            LayerRequest::Albedo => vec![LayerKind::Albedo],
            LayerRequest::Direct => vec![LayerKind::Direct],
            LayerRequest::Indirect => vec![LayerKind::Indirect],
            LayerRequest::Id => vec![LayerKind::Id],
            LayerRequest::Cryptomatte(None) => {
                [Matte::Object, Matte::Material].map(LayerKind::Cryptomatte).to_vec()
            }
            LayerRequest::Cryptomatte(Some(matte)) => vec![LayerKind::Cryptomatte(*matte)],
            LayerRequest::Lit(None) => lights.clone().map(LayerKind::Lit).collect(),
            LayerRequest::Lit(Some(name)) => {
                let index = scene.lights.iter().position(|light| light.name == *name);
                let index = index.ok_or_else(|| {
                    let names: Vec<&str> = scene.lights.iter().map(|light| light.name.as_str()).collect();
                    CliError::Usage(format!("--layers lit.{name}: the lights are {}", names.join(", ")))
                })?;
                vec![LayerKind::Lit(index)]
            }
        };
        more.into_iter().for_each(|kind| {
            if !kinds.contains(&kind) {
                kinds.push(kind);
            }
        });
    }
    Ok(kinds)
}
