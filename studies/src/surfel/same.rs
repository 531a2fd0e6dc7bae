//! What must not change a picture: where a scene lies, how large it is, the order of its points, the number of threads.

use glam::DVec3;
use pointillist_surfel::SurfelError;

use crate::common::picture_layers::PictureLayers;
use crate::common::report::on_threads;
use crate::surfel::coloured_cloud::ColouredCloud;
use crate::surfel::layer_error::{LayerError, LayerMeasure};
use crate::surfel::lens_camera::{LensCamera, Matt};
use crate::surfel::lens_samples::mixed;
use crate::surfel::stage::{PROCEDURES, drawn, name, options};

/// A picture beside that of the unchanged scene.
pub(crate) struct Same {
    pub(crate) scene: &'static str,
    pub(crate) series: &'static str,
    pub(crate) change: &'static str,
    /// Whether it may differ by rounding.
    pub(crate) may_differ: bool,
    /// Whether every byte of colour, depth and normals is the same.
    pub(crate) same_bytes: bool,
    /// From the unchanged picture.
    pub(crate) error: LayerError,
}

/// Changes of place and scale: the name, the scale, and the way in diagonals of the scene. A power of two rounds nothing,
/// one of ten every number.
const MAPS: [(&str, f64, f64); 4] = [
    ("moved by 1e6 diagonals", 1.0, 1e6),
    ("scaled by 2²⁰", (1 << 20) as f64, 0.0),
    ("scaled by 1e-6", 1e-6, 0.0),
    ("scaled by 1e6", 1e6, 0.0),
];

/// Scenes are moved this way, which no axis has.
const WAY: DVec3 = DVec3::new(0.48, 0.6, 0.64);

/// Compares one scene by both procedures, drawn with this level of detail.
pub(crate) fn compare(
    (scene, level): (&'static str, f32),
    cloud: &ColouredCloud,
    (camera, matt): (LensCamera, Matt),
    diagonal: f64,
) -> Result<Vec<Same>, SurfelError> {
    let mut list = vec![];
    for procedure in PROCEDURES {
        let picture = |cloud: &ColouredCloud, camera: &LensCamera| {
            let mut options = options(camera, &matt, procedure);
            options.level = level;
            let (picture, _) = drawn(&cloud.ready()?, camera, &options)?;
            Ok::<_, SurfelError>(picture)
        };
        let unchanged = LayerMeasure::new(picture(cloud, &camera)?);
        let mut add = |change, may_differ, picture: &PictureLayers| {
            let (same_bytes, error) = (unchanged.is(picture), unchanged.of(picture));
            list.push(Same { scene, series: name(procedure), change, may_differ, same_bytes, error });
        };
        for (change, scale, diagonals) in MAPS {
            let shift = diagonals * diagonal * WAY;
            add(change, true, &picture(&cloud.mapped(scale, shift), &camera.mapped(scale, shift))?);
        }
        add("points shuffled", false, &picture(&shuffled(cloud), &camera)?);
        for (change, threads) in [("1 thread", 1), ("2 threads", 2)] {
            add(change, false, &on_threads(threads, || picture(cloud, &camera))?);
        }
    }
    Ok(list)
}

/// In an order that has nothing to do with theirs.
fn shuffled(cloud: &ColouredCloud) -> ColouredCloud {
    let mut numbers: Vec<usize> = (0..cloud.positions.len()).collect();
    numbers.sort_by_key(|i| mixed(*i as u64));
    cloud.picked(&numbers)
}
