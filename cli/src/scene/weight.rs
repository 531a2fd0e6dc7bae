//! What of a scene takes long or takes memory, told without drawing it.

use super::{Mesh, Projection, Scene, Surroundings, Texels};
use glam::DVec3;
use pointillist_shade::Light;

/// Bytes of the program, its threads' stacks and what it keeps for a tile.
const BASE_BYTES: u64 = 8 << 20;
/// Bytes of a thread's tile: measured at a tree of masked leaves, which fills its cells most.
const THREAD_BYTES: u64 = 6 << 20;
/// Bytes of a triangle and its share of the vertices, at the peak while the text of its file is still there: measured, 400 to 900.
pub(super) const TRIANGLE_BYTES: u64 = 600;
/// Bytes of a triangle that is stored once, in one more place: its share of a cluster's bounds.
pub(super) const INSTANCE_TRIANGLE_BYTES: u64 = 4;
/// Bytes of a further place of what is stored once, without its triangles.
pub(super) const INSTANCE_BYTES: u64 = 600;
/// Bytes of a texel beside itself, for sums over regions: measured, 3 to 11, because only maps that are asked for are summed up.
const SUMMED_TEXEL_BYTES: u64 = 7;
/// Textures with more texels are called huge: 4096².
const HUGE_TEXELS: u64 = 1 << 24;
/// Triangles with masks from which a scene counts as foliage.
const FOLIAGE: usize = 1000;
/// Triangles for each pixel from which cells have many parts.
const DENSE: f64 = 4.0;
/// Triangles from which shadows of lights with an area take most of the time.
const MANY_CASTERS: usize = 20_000;

/// An object that the camera does not see.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unseen {
    /// Its name.
    pub name: String,
    /// What it has.
    pub triangles: usize,
}

/// Objects with all their triangles on the far side of one edge of the picture or behind the camera. They may still cast shadows.
#[must_use]
pub fn unseen(scene: &Scene) -> Vec<Unseen> {
    let camera = &scene.camera;
    let [right, up, backward] = camera.axes();
    let aspect = f64::from(scene.image.width) / f64::from(scene.image.height);
    // Signed distances to the four edges and to the eye, up to positive factors: negative is outside.
    let outside = |point: DVec3| -> [bool; 5] {
        let from_eye = point - camera.eye;
        let (x, y, depth) = (from_eye.dot(right), from_eye.dot(up), -from_eye.dot(backward));
        let (half_y, behind) = match camera.projection {
            Projection::Perspective { fov_y_rad } => ((0.5 * fov_y_rad).tan() * depth, depth < 0.0),
            Projection::Orthographic { height } => (0.5 * height, false),
        };
        let half_x = half_y * aspect;
        [x < -half_x, x > half_x, y < -half_y, y > half_y, behind]
    };
    let mut all_outside = vec![[true; 5]; scene.mesh.objects.len()];
    let mut triangles = vec![0; scene.mesh.objects.len()];
    for (object, corners) in scene.mesh.world_triangles() {
        triangles[object as usize] += 1;
        for corner in corners {
            let flags = outside(corner);
            all_outside[object as usize].iter_mut().zip(flags).for_each(|(all, flag)| *all &= flag);
        }
    }
    let objects = scene.mesh.objects.iter().zip(all_outside).zip(triangles);
    objects
        .filter(|((_, outside), _)| outside.contains(&true))
        .map(|((object, _), triangles)| Unseen { name: object.name.clone(), triangles })
        .collect()
}

/// Bytes that drawing the scene takes at the peak, from counts: within a factor of two on the scenes it was tried on. `planes` are the
/// numbers of a pixel: 5 for colour and depth, and those of layers.
#[must_use]
pub fn memory_bytes(scene: &Scene, pixels: u64, planes: u64, threads: usize) -> u64 {
    let texels = scene.textures.iter().map(|texture| {
        let size = u64::from(texture.width) * u64::from(texture.height);
        let own = match texture.texels {
            Texels::Srgb8(_) | Texels::Linear8(_) => 4,
            Texels::OpaqueSrgb8(_) | Texels::OpaqueLinear8(_) => 3,
            Texels::Gray8(_) | Texels::Opacity8(_) => 1,
            _ => 16,
        };
        size * (own + SUMMED_TEXEL_BYTES)
    });
    // Once as computed, and once more as it is written.
    let frame = pixels * planes * 4 * 2;
    BASE_BYTES + threads as u64 * THREAD_BYTES + mesh_bytes(&scene.mesh) + texels.sum::<u64>() + frame
}

fn mesh_bytes(mesh: &Mesh) -> u64 {
    let own = mesh.triangles.len();
    let stored = own + mesh.shapes().iter().map(|shape| shape.triangles.len()).sum::<usize>();
    let placed = mesh.triangle_count() - own;
    let instances = mesh.instances().len() as u64 * INSTANCE_BYTES;
    stored as u64 * TRIANGLE_BYTES + placed as u64 * INSTANCE_TRIANGLE_BYTES + instances
}

/// What will be slow or heavy, in sentences.
#[must_use]
pub fn heavy(scene: &Scene) -> Vec<String> {
    let mut heavy = vec![];
    let triangles = scene.mesh.triangle_count();
    let pixels = f64::from(scene.image.width) * f64::from(scene.image.height);
    let hidden: usize = unseen(scene).iter().map(|object| object.triangles).sum();
    if hidden * 3 > triangles {
        heavy.push(format!(
            "{hidden} of {triangles} triangles are out of view: they take memory, and time where they may cast shadows"
        ));
    }
    for texture in &scene.textures {
        let (width, height) = (u64::from(texture.width), u64::from(texture.height));
        if width * height > HUGE_TEXELS {
            let (name, millions) = (&texture.name, width * height / 1_000_000);
            heavy.push(format!("texture `{name}` is huge: {width}×{height}, {millions} million texels"));
        }
    }
    let count = |is: &dyn Fn(&super::Material) -> bool| {
        let of: Vec<bool> = scene.materials.iter().map(is).collect();
        of_materials(&scene.mesh, &of)
    };
    let masked = count(&|m| m.opacity_map.is_some());
    if masked >= FOLIAGE {
        heavy.push(format!(
            "{masked} triangles have masks (foliage): pixels that see many of them are divided"
        ));
    }
    let clear =
        count(&|m| m.opacity_map.is_none() && (m.surface.opacity < 1.0 || m.details.transmission.is_some()));
    if clear >= FOLIAGE {
        heavy.push(format!("{clear} triangles let light through: what is behind each is shaded, too"));
    }
    if triangles as f64 > DENSE * pixels {
        heavy.push(format!(
            "{:.0} triangles for each pixel: their number takes the time, not that of the pixels",
            triangles as f64 / pixels
        ));
    }
    lights(scene, &mut heavy);
    let captured = scene.materials.iter().filter(|m| m.details.surroundings == Surroundings::Capture).count();
    if captured > 0 {
        heavy.push(format!("{captured} materials capture their surroundings: six pictures for each object"));
    }
    if scene.render.cells_per_pixel == Some(4) {
        heavy.push("render.subpixel = 4: sixteen cells a pixel".to_owned());
    }
    heavy
}

/// How many triangles have one of the materials for which `of` holds.
fn of_materials(mesh: &Mesh, of: &[bool]) -> usize {
    let own = |mesh: &Mesh| mesh.material_of.iter().filter(|&&m| of.get(m as usize) == Some(&true)).count();
    let of_shapes: Vec<usize> = mesh.shapes().iter().map(own).collect();
    own(mesh) + mesh.instances().iter().map(|i| of_shapes[i.shape as usize]).sum::<usize>()
}

fn lights(scene: &Scene, heavy: &mut Vec<String>) {
    let triangles = scene.mesh.triangle_count();
    for source in scene.lights.iter().filter(|light| light.shadow) {
        let (Light::Rect { samples, .. } | Light::Polygon { samples, .. } | Light::Line { samples, .. }) =
            &source.light
        else {
            continue;
        };
        let name = &source.name;
        match samples {
            Some(points) if points.get() > 1 => {
                heavy.push(format!("light `{name}` is {points} points: as many shadows"));
            }
            None if triangles > MANY_CASTERS => heavy.push(format!(
                "light `{name}` is not a point: what is seen of it from everywhere is cut by its casters, of which {triangles} triangles \
                 may be some"
            )),
            _ => {}
        }
    }
    let emits = scene.materials.iter().filter(|m| m.details.emits).count();
    if emits > 0 {
        heavy.push(format!("{emits} materials emit light: each of their polygons is a light with an area"));
    }
}
