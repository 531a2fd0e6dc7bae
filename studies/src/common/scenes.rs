//! Scenes made by code, and what light leaves their surfaces.

use std::f64::consts::TAU;

use glam::{DMat3, DVec2, DVec3, Vec3, dvec2, dvec3};
use pointillist_render::{
    AmbientLight, Camera, LightSource, Material, NONE, Object, Projection, Scene, Texels, Texture,
};
use pointillist_shade::{self as shade, Falloff, Light, face_normal, sees_light};

/// The two linear greys of a checker, in 255ths.
pub(crate) const CHECKER: [u8; 2] = [230, 25];

/// A scene in the making.
pub(crate) struct Sketch {
    pub(crate) scene: Scene,
}

impl Sketch {
    /// An empty scene seen from `eye` by a camera with this vertical field of view.
    pub(crate) fn new(eye: DVec3, target: DVec3, fov_deg: f64, size: u32) -> Self {
        let camera = Camera::perspective(eye, target, fov_deg.to_radians());
        let mut scene = Scene::new(camera, [size, size]);
        scene.render.shading = shade::Interpolation::Flat;
        scene.mesh.objects.push(object("sketch"));
        Self { scene }
    }

    /// A surface that shows this colour whatever the light.
    pub(crate) fn emissive(&mut self, color: Vec3, opacity: f32) -> u32 {
        let surface = shade::Material::lambert(Vec3::ZERO).with_emission(color).with_opacity(opacity);
        self.material(surface, None)
    }

    /// A matt surface.
    pub(crate) fn matt(&mut self, albedo: f32, opacity: f32) -> u32 {
        self.material(shade::Material::lambert(Vec3::splat(albedo)).with_opacity(opacity), None)
    }

    pub(crate) fn material(&mut self, surface: shade::Material, diffuse_map: Option<usize>) -> u32 {
        let name = format!("m{}", self.scene.materials.len());
        let mut material = Material::new(name, surface);
        material.diffuse_map = diffuse_map;
        self.scene.add_material(material)
    }

    /// Triangles with their own vertices.
    pub(crate) fn triangles(&mut self, positions: &[DVec3], triangles: &[[u32; 3]], material: u32) {
        let mesh = &mut self.scene.mesh;
        let base = mesh.positions.len() as u32;
        mesh.positions.extend(positions);
        mesh.triangles.extend(triangles.iter().map(|t| t.map(|i| base + i)));
        let count = mesh.triangles.len();
        mesh.material_of.resize(count, material);
        mesh.object_of.resize(count, 0);
        mesh.normal_of.resize(count, [NONE; 3]);
        mesh.uv_of.resize(count, [NONE; 3]);
    }

    /// A convex polygon.
    pub(crate) fn polygon(&mut self, corners: &[DVec3], material: u32) {
        let fan: Vec<_> = (1..corners.len() as u32 - 1).map(|i| [0, i, i + 1]).collect();
        self.triangles(corners, &fan, material);
    }

    /// A closed box.
    pub(crate) fn cuboid(&mut self, low: DVec3, high: DVec3, material: u32) {
        let corner = |i: u32| {
            let pick = |bit: u32, a: f64, b: f64| if i >> bit & 1 == 0 { a } else { b };
            dvec3(pick(0, low.x, high.x), pick(1, low.y, high.y), pick(2, low.z, high.z))
        };
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles: Vec<_> = faces.iter().flat_map(|f| [[f[0], f[1], f[2]], [f[0], f[2], f[3]]]).collect();
        self.triangles(&(0..8).map(corner).collect::<Vec<_>>(), &triangles, material);
    }

    /// A closed sphere of `8 · 4^level` triangles.
    pub(crate) fn sphere(&mut self, centre: DVec3, radius: f64, level: u32, material: u32) {
        let (positions, triangles) = unit_sphere(level);
        let positions: Vec<_> = positions.iter().map(|p| centre + *p * radius).collect();
        self.triangles(&positions, &triangles, material);
    }

    /// Directional light of irradiance π, under which a white surface that faces it has radiance 1.
    pub(crate) fn sun(&mut self, direction: DVec3) {
        let irradiance = Vec3::splat(std::f32::consts::PI);
        self.light(Light::Directional { direction, irradiance });
    }

    /// A point light that gives irradiance π at `reach`.
    pub(crate) fn lamp(&mut self, position: DVec3, reach: f64) {
        let intensity = Vec3::splat((reach * reach) as f32 * std::f32::consts::PI);
        self.light(Light::Point { position, intensity, falloff: Falloff::InverseSquare });
    }

    pub(crate) fn light(&mut self, light: Light) {
        let name = format!("light{}", self.scene.lights.len());
        self.scene.lights.push(LightSource::new(name, light));
    }

    /// A texture of light and dark texels: `size` × `size`, alternating.
    pub(crate) fn checker(&mut self, size: u32) -> usize {
        let [light, dark] = CHECKER;
        let texel = |i: u32| if (i % size + i / size).is_multiple_of(2) { light } else { dark };
        let texels = Texels::from_grays((0..size * size).map(texel).collect());
        self.scene.add_texture(Texture::new("checker", [size, size], texels))
    }

    /// The back of a [`Sketch::textured_quad`]: the same corners with the same texture coordinates, the other way round.
    pub(crate) fn textured_back(&mut self, corners: &[DVec3; 4], material: u32) {
        let [a, b, c, d] = *corners;
        // From the same corner, so that the triangles are the same, too.
        self.polygon(&[a, d, c, b], material);
        let uv = [dvec2(0.0, 0.0), dvec2(0.0, 1.0), dvec2(1.0, 1.0), dvec2(1.0, 0.0)];
        self.texture_coordinates(&[[uv[0], uv[1], uv[2]], [uv[0], uv[2], uv[3]]]);
    }

    /// [`Sketch::checker`] on the ground, `2 · half` wide, with a quad for every texel.
    pub(crate) fn checker_of_quads(&mut self, size: u32, half: f64, [light, dark]: [u32; 2]) {
        let at = |i: u32, j: u32| {
            let f = |k: u32| (f64::from(k) / f64::from(size) - 0.5) * 2.0 * half;
            dvec3(f(i), 0.0, -f(j))
        };
        for (j, i) in (0..size).flat_map(|j| (0..size).map(move |i| (j, i))) {
            // Row 0 of a texture is the top, that is the last j.
            let even = (i + (size - 1 - j)).is_multiple_of(2);
            let ring = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            self.polygon(&ring, if even { light } else { dark });
        }
    }

    /// A convex polygon with four corners that a texture covers: (0, 0), (1, 0), (1, 1) and (0, 1) in its coordinates.
    pub(crate) fn textured_quad(&mut self, corners: &[DVec3; 4], material: u32) {
        self.polygon(corners, material);
        let uv = [dvec2(0.0, 0.0), dvec2(1.0, 0.0), dvec2(1.0, 1.0), dvec2(0.0, 1.0)];
        self.texture_coordinates(&[[uv[0], uv[1], uv[2]], [uv[0], uv[2], uv[3]]]);
    }

    /// Gives the latest `count` triangles these texture coordinates.
    pub(crate) fn texture_coordinates(&mut self, corners: &[[DVec2; 3]]) {
        let mesh = &mut self.scene.mesh;
        let first = mesh.triangles.len() - corners.len();
        for (i, uvs) in corners.iter().enumerate() {
            let base = mesh.uvs.len() as u32;
            mesh.uvs.extend(uvs);
            mesh.uv_of[first + i] = [base, base + 1, base + 2];
        }
    }
}

fn object(name: &str) -> Object {
    Object { name: name.to_owned(), two_sided: true }
}

/// An octahedron, subdivided and pushed out to the unit sphere.
pub(crate) fn unit_sphere(level: u32) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    use std::collections::HashMap;
    let mut positions = vec![DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
    let mut triangles =
        vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    for _ in 0..level {
        let mut middles = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                positions.push((positions[a as usize] + positions[b as usize]).normalize());
                positions.len() as u32 - 1
            })
        };
        let split = |[a, b, c]: [u32; 3]| {
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        triangles = triangles.into_iter().flat_map(split).collect();
    }
    (positions, triangles)
}

/// A point of a surface as a shader needs it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SurfaceSample {
    pub(crate) triangle: u32,
    pub(crate) position: DVec3,
    pub(crate) to_eye: DVec3,
}

/// Whether light number `light`, sample `sample`, reaches a point: 0..=1.
pub(crate) type Visibility<'a> = dyn Fn(&SurfaceSample, usize, u32) -> f64 + Sync + 'a;

/// The ambient light of scenes without probes.
fn ambient_color(scene: &Scene) -> Vec3 {
    match scene.ambient {
        AmbientLight::Color(color) => color,
        _ => Vec3::ZERO,
    }
}

/// Radiance towards the eye with flat, two-sided shading.
pub(crate) fn radiance(scene: &Scene, at: &SurfaceSample, visible: &Visibility<'_>) -> DVec3 {
    let t = at.triangle as usize;
    let surface = surface_at(scene, at);
    let mut color = surface.emission + ambient_color(scene) * surface.diffuse;
    if surface.diffuse == Vec3::ZERO && surface.specular == Vec3::ZERO {
        return color.as_dvec3();
    }
    let normal = normal_towards(scene, t, at.to_eye).as_vec3();
    let to_eye = at.to_eye.normalize_or_zero().as_vec3();
    for (i, light) in scene.lights.iter().enumerate() {
        for sample in 0..light.light.samples() {
            let incident = light.light.illuminate(sample, at.position);
            if !incident.is_dark() && sees_light(normal, incident.to_light) {
                let lit = if light.shadow { visible(at, i, sample) } else { 1.0 };
                if lit > 0.0 {
                    color += surface.reflect(&incident, normal, to_eye) * lit as f32;
                }
            }
        }
    }
    color.as_dvec3()
}

/// The material at a point, its texture looked up.
pub(crate) fn surface_at(scene: &Scene, at: &SurfaceSample) -> shade::Material {
    let material = &scene.materials[scene.mesh.material_of[at.triangle as usize] as usize];
    let mut surface = material.surface;
    if let (Some(map), Some(uv)) = (material.diffuse_map, uv_at(scene, at)) {
        surface.diffuse *= scene.textures[map].lookup(material.wrap, uv).truncate();
    }
    surface
}

/// Unit normal of a triangle on the side of `to_eye`.
pub(crate) fn normal_towards(scene: &Scene, triangle: usize, to_eye: DVec3) -> DVec3 {
    let [a, b, c] = corners(scene, triangle);
    let normal = face_normal(a, b, c);
    if normal.dot(to_eye) < 0.0 { -normal } else { normal }
}

pub(crate) fn corners(scene: &Scene, triangle: usize) -> [DVec3; 3] {
    scene.mesh.triangles[triangle].map(|v| scene.mesh.positions[v as usize])
}

pub(crate) fn opacity(scene: &Scene, triangle: usize) -> f64 {
    f64::from(scene.materials[scene.mesh.material_of[triangle] as usize].surface.opacity)
}

fn uv_at(scene: &Scene, at: &SurfaceSample) -> Option<DVec2> {
    let t = at.triangle as usize;
    let of = scene.mesh.uv_of.get(t).filter(|of| !of.contains(&NONE))?;
    let [a, b, c] = corners(scene, t);
    let n = (b - a).cross(c - a);
    let share = |p: DVec3, q: DVec3| (p - at.position).cross(q - at.position).dot(n) / n.length_squared();
    let [first, second, third] = of.map(|i| scene.mesh.uvs[i as usize]);
    // What is the same at all corners stays so to the last bit: it may be the border of a texture.
    Some(first + (second - first) * share(c, a) + (third - first) * share(a, b))
}

/// The same scene turned, scaled and moved: `p ↦ scale · turn · p + shift`. Lights keep what arrives.
pub(crate) fn transformed(scene: &Scene, scale: f64, turn: DMat3, shift: DVec3) -> Scene {
    let mut moved = scene.clone();
    let place = |p: DVec3| turn * p * scale + shift;
    moved.camera.eye = place(scene.camera.eye);
    moved.camera.target = place(scene.camera.target);
    moved.camera.up = turn * scene.camera.up;
    if let Projection::Orthographic { height } = &mut moved.camera.projection {
        *height *= scale;
    }
    moved.mesh.positions.iter_mut().for_each(|p| *p = place(*p));
    for source in &mut moved.lights {
        match &mut source.light {
            Light::Directional { direction, .. } => *direction = turn * *direction,
            Light::Point { position, intensity, .. } => {
                *position = place(*position);
                *intensity *= (scale * scale) as f32;
            }
            _ => unreachable!("these scenes have directional and point lights"),
        }
    }
    moved
}

/// A lone edge: one big quad whose left side crosses the picture at a slant.
pub(crate) fn lone_edge(size: u32) -> Scene {
    let mut s = Sketch::new(dvec3(0.0, 0.0, 5.0), DVec3::ZERO, 40.0, size);
    let white = s.emissive(Vec3::ONE, 1.0);
    s.polygon(
        &[dvec3(-0.3, -9.0, 0.0), dvec3(9.0, -9.0, 0.0), dvec3(9.0, 9.0, 0.0), dvec3(0.5, 9.0, 0.0)],
        white,
    );
    s.scene
}

/// Quads: one before the other with the same outline, a join between two depths, a fan of slivers.
pub(crate) fn quads(size: u32) -> Scene {
    let mut s = Sketch::new(dvec3(0.0, 0.0, 5.0), DVec3::ZERO, 40.0, size);
    let [red, green, blue] = [Vec3::X, Vec3::Y, Vec3::Z].map(|c| s.emissive(c + 0.05, 1.0));
    let square = |centre: DVec2, half: f64, turn: f64, depth: f64| {
        // Points on the rays through a square at distance 5, moved to another depth.
        let corner = |i: usize| centre + DVec2::from_angle(turn + i as f64 * TAU / 4.0) * half;
        std::array::from_fn::<DVec3, 4, _>(|i| dvec3(0.0, 0.0, 5.0) + corner(i).extend(-5.0) * (depth / 5.0))
    };
    s.polygon(&square(dvec2(-0.9, 0.9), 0.7, 0.3, 5.0), red);
    s.polygon(&square(dvec2(-0.9, 0.9), 0.7, 0.3, 7.0), green);
    s.polygon(&square(dvec2(0.9, 0.8), 0.7, 0.2, 4.0), blue);
    s.polygon(&square(dvec2(1.2, 1.0), 0.7, 0.9, 9.0), red);
    let hub = dvec3(-0.8, -0.9, 0.0);
    let rim: Vec<DVec3> =
        (0..64).map(|i| hub + DVec2::from_angle(f64::from(i) * TAU / 64.0).extend(0.0) * 0.7).collect();
    for i in 0..64 {
        s.polygon(&[hub, rim[i], rim[(i + 1) % 64]], if i % 2 == 0 { green } else { blue });
    }
    for i in 0..24 {
        let x = 0.3 + 0.05 * f64::from(i);
        let (low, high) = (dvec3(x, -1.6, 0.0), dvec3(x + 0.0007, -0.3, 0.0));
        s.polygon(&[low, dvec3(high.x, low.y, 0.0), high, dvec3(low.x, high.y, 0.0)], red);
    }
    s.scene
}

/// Closed spheres, one behind the other.
pub(crate) fn spheres(size: u32) -> Scene {
    let mut s = Sketch::new(dvec3(0.4, 1.2, 7.0), dvec3(0.0, 0.2, -1.0), 36.0, size);
    let colors = [Vec3::new(0.9, 0.2, 0.1), Vec3::new(0.1, 0.7, 0.2), Vec3::new(0.2, 0.3, 0.9), Vec3::ONE];
    for i in 0..12 {
        let (column, row) = (f64::from(i % 4), f64::from(i / 4));
        let centre = dvec3(-1.8 + 1.2 * column + 0.3 * row, -0.6 + 0.9 * row, -2.2 * row + 0.1 * column);
        let material = s.emissive(colors[i as usize % 4], 1.0);
        s.sphere(centre, 0.55, 4, material);
    }
    s.scene
}

/// Wires about half a pixel thick: closed boxes, slanted by the camera.
pub(crate) fn wires(size: u32) -> Scene {
    let mut s = Sketch::new(dvec3(1.2, 1.0, 5.0), DVec3::ZERO, 36.0, size);
    s.scene.camera.up = dvec3(0.12, 1.0, 0.0);
    let front = s.emissive(Vec3::ONE, 1.0);
    let back = s.emissive(Vec3::new(0.1, 0.3, 0.8), 1.0);
    let half = 0.25 * 2.0 * 5.2 * 18f64.to_radians().tan() / f64::from(size);
    for layer in 0..3 {
        let z = -0.7 * f64::from(layer);
        for i in 0..24 {
            let x = -1.6 + 3.2 * f64::from(i) / 23.0;
            s.cuboid(dvec3(x - half, -1.6, z - half), dvec3(x + half, 1.6, z + half), front);
            s.cuboid(dvec3(-1.6, x - half, z - 0.2 - half), dvec3(1.6, x + half, z - 0.2 + half), back);
        }
    }
    s.scene
}

/// A ground of `count` thin stripes to the horizon.
pub(crate) fn stripes(size: u32, count: u32) -> Scene {
    let mut s = Sketch::new(dvec3(0.0, 1.0, 0.0), dvec3(0.3, 0.7, -5.0), 40.0, size);
    // Rolled, so that the lines of the reference cross the stripes rather than miss them.
    s.scene.camera.up = dvec3(0.5, 1.0, 0.0);
    let (light, dark) = (s.emissive(Vec3::splat(0.9), 1.0), s.emissive(Vec3::splat(0.1), 1.0));
    let half = 0.5 * f64::from(count);
    for i in 0..count {
        let (near, far) = (1.0 - 0.5 * f64::from(i), 0.5 - 0.5 * f64::from(i));
        let ring =
            [dvec3(-half, 0.0, near), dvec3(half, 0.0, near), dvec3(half, 0.0, far), dvec3(-half, 0.0, far)];
        s.polygon(&ring, if i % 2 == 0 { light } else { dark });
    }
    s.scene
}

/// How wide the ground of [`checker_ground`] is.
const GROUND: f64 = 64.0;

/// A ground with a 512 × 512 checker, lit; with `as_quads` every texel is a quad of its own, for the reference.
pub(crate) fn checker_ground(size: u32, as_quads: bool) -> Scene {
    const TEXELS: u32 = 512;
    let mut s = Sketch::new(dvec3(0.0, 1.2, 31.0), dvec3(4.0, 0.0, 20.0), 40.0, size);
    s.scene.camera.up = dvec3(0.5, 1.0, 0.0);
    if as_quads {
        let [light, dark] = CHECKER.map(|v| s.emissive(Vec3::splat(f32::from(v) / 255.0), 1.0));
        s.checker_of_quads(TEXELS, 0.5 * GROUND, [light, dark]);
        return s.scene;
    }
    let map = s.checker(TEXELS);
    let ground = s.material(shade::Material::lambert(Vec3::ONE), Some(map));
    let h = 0.5 * GROUND;
    s.textured_quad(&[dvec3(-h, 0.0, h), dvec3(h, 0.0, h), dvec3(h, 0.0, -h), dvec3(-h, 0.0, -h)], ground);
    s.scene.ambient = AmbientLight::Color(Vec3::ONE);
    s.scene
}

/// Translucent layers of known opacity before one another.
pub(crate) fn layers(size: u32) -> Scene {
    let mut s = Sketch::new(dvec3(0.0, 0.0, 5.0), DVec3::ZERO, 40.0, size);
    for i in 0..6 {
        let k = f64::from(i);
        let color = Vec3::new(0.2 + 0.15 * i as f32, 1.0 - 0.15 * i as f32, 0.5);
        let material = s.emissive(color, 0.2 + 0.12 * i as f32);
        let corner = |j: usize| {
            let angle = 0.4 * k + j as f64 * TAU / 4.0;
            dvec3(0.3 * (k - 2.5), 0.1 * k - 0.2, -0.6 * k)
                + DVec2::from_angle(angle).extend(0.1 * angle.sin()) * 1.3
        };
        s.polygon(&[corner(0), corner(1), corner(2), corner(3)], material);
    }
    s.scene
}

/// Matt spheres under a light that casts no shadow.
pub(crate) fn lit_spheres(size: u32) -> Scene {
    let mut s = Sketch { scene: spheres(size) };
    for material in &mut s.scene.materials {
        material.surface = shade::Material::lambert(material.surface.emission);
    }
    s.lamp(dvec3(3.0, 4.0, 5.0), 7.0);
    s.scene.lights[0].shadow = false;
    s.scene
}
