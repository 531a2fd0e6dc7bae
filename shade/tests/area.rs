//! Light from polygons, by quadrature: against many more points, and against the closed form.

use glam::{DVec3, Vec3, dvec3};
use pointillist_shade::{Emission, Falloff, Incident, Light, Lobe, Material, Model, integrate_polygon};

const LIGHT: [DVec3; 4] = [
    DVec3::new(-0.7, 2.0, -0.4),
    DVec3::new(0.9, 2.0, -0.4),
    DVec3::new(0.9, 2.0, 0.8),
    DVec3::new(-0.7, 2.0, 0.8),
];

fn emission() -> Emission {
    Emission { front: DVec3::NEG_Y, radiance: Vec3::splat(2.0), falloff: Falloff::InverseSquare }
}

/// The same by n² midpoints.
fn midpoints(n: u32, material: &Material, to_eye: Vec3) -> f64 {
    let [a, b, _, d] = LIGHT;
    let area = (b - a).cross(d - a).length() / f64::from(n * n);
    let place = |k: u32| (f64::from(k) + 0.5) / f64::from(n);
    let of = |k: u32| {
        let p = a + (b - a) * place(k % n) + (d - a) * place(k / n);
        let intensity = Vec3::splat((2.0 * area * p.normalize().y) as f32);
        let lamp = Light::Point { position: p, intensity, falloff: Falloff::InverseSquare };
        let incident = lamp.illuminate(0, DVec3::ZERO);
        f64::from(material.reflect(&incident, Vec3::Y, to_eye).x)
    };
    (0..n * n).map(of).sum()
}

#[test]
fn a_lambert_surface_gets_the_closed_form() {
    let material = Material::lambert(Vec3::ONE);
    let lobe = Lobe { axis: Vec3::Y, width_rad: 1.0 };
    let got = integrate_polygon(&LIGHT, &emission(), &lobe, |i| material.reflect(i, Vec3::Y, Vec3::Y));
    // Lambert's formula, edge by edge.
    let edge = |k: usize| {
        let (a, b) = (LIGHT[k], LIGHT[(k + 1) % 4]);
        let cross = a.cross(b);
        cross.length().atan2(a.dot(b)) * cross.normalize().y
    };
    let share = (0..4).map(edge).sum::<f64>().abs() / std::f64::consts::TAU;
    assert!((f64::from(got.x) / (2.0 * share) - 1.0).abs() < 1e-4, "{got} {share}");
}

#[test]
fn lobes_of_any_width_are_resolved() {
    let mut worst = 0.0_f64;
    for roughness in [0.1, 0.2, 0.35, 0.6, 1.0] {
        for (x, z) in [(0.0, 0.0), (0.3, -0.2), (-0.4, 0.1), (0.9, 0.0), (2.5, 0.4)] {
            let to_eye = dvec3(x, 1.0, z).normalize().as_vec3();
            let material = Material::ggx(Vec3::ZERO, Vec3::splat(0.5), roughness);
            let lobe = material.lobe(Vec3::Y, to_eye);
            let reflect = |i: &Incident| material.reflect(i, Vec3::Y, to_eye);
            let got = f64::from(integrate_polygon(&LIGHT, &emission(), &lobe, reflect).x);
            let expected = midpoints(if roughness < 0.3 { 700 } else { 200 }, &material, to_eye);
            let error = (got - expected).abs();

            // Relative to what the whole hemisphere would send.
            worst = worst.max(error / (expected + 0.01));
        }
    }
    assert!(worst < 1e-3, "{worst}");
}

#[test]
fn a_narrow_highlight_takes_few_points() {
    let material = Material::lambert(Vec3::ZERO).with_specular(Model::NormalizedPhong, Vec3::ONE, 50.0);
    let mut calls = 0;
    integrate_polygon(&LIGHT, &emission(), &material.lobe(Vec3::Y, Vec3::Y), |i| {
        calls += 1;
        material.reflect(i, Vec3::Y, Vec3::Y)
    });
    assert!((9..700).contains(&calls), "{calls}");
}
