//! Every BRDF by quadrature: none makes light, and those that promise to return all do.

use glam::{Vec3, vec3};
use pointillist_shade::{
    MERL_DIMENSIONS, Material, MerlTable, Model, ShadeError, coat_albedo, directional_albedo, invariants,
};
use proptest::prelude::*;

/// A tilt away from the normal +Z.
fn tilted(degrees: f32) -> Vec3 {
    let angle = degrees.to_radians();
    vec3(angle.sin(), 0.0, angle.cos())
}

fn albedo(material: &Material, degrees: f32) -> f32 {
    directional_albedo(tilted(degrees), STEPS, |l, v| material.brdf(Vec3::Z, l, v)).x
}

/// Enough for three digits, and quick without optimisation.
const STEPS: usize = 120;

const ANGLES: [f32; 6] = [0.0, 20.0, 45.0, 70.0, 85.0, 89.0];

#[test]
fn no_normalised_phong_makes_light() {
    for model in [Model::Lambert, Model::NormalizedPhong, Model::NormalizedBlinnPhong] {
        for shininess in [0.0, 1.0, 5.0, 20.0, 100.0, 500.0] {
            let material =
                Material::lambert(Vec3::splat(0.4)).with_specular(model, Vec3::splat(0.6), shininess);
            for degrees in ANGLES {
                let share = albedo(&material, degrees);
                // The quadrature's own error.
                assert!(share <= 1.0 + 2e-3, "{model:?} {shininess} at {degrees}°: {share}");
            }
        }
    }
}

#[test]
fn normalised_models_return_all_at_normal_incidence() {
    // Both are normalised where the mirror direction is the normal.
    for model in [Model::NormalizedPhong, Model::NormalizedBlinnPhong] {
        for shininess in [0.0, 3.0, 30.0, 300.0, 3000.0] {
            let material = Material::lambert(Vec3::ZERO).with_specular(model, Vec3::ONE, shininess);
            let share = albedo(&material, 0.0);
            assert!((share - 1.0).abs() < 2e-3, "{model:?} {shininess}: {share}");
        }
    }
}

#[test]
fn lambert_returns_its_albedo_from_anywhere() {
    let material = Material::lambert(Vec3::splat(0.7));
    for degrees in ANGLES {
        assert!((albedo(&material, degrees) - 0.7).abs() < 1e-3);
    }
}

fn ggx(diffuse: f32, f0: f32, roughness: f32) -> Material {
    Material::ggx(Vec3::splat(diffuse), Vec3::splat(f0), roughness)
}

#[test]
fn ggx_never_makes_light() {
    for roughness in [0.0, 0.1, 0.3, 0.6, 1.0] {
        for (diffuse, f0) in [(0.0, 1.0), (1.0, 0.04), (1.0, 0.3), (1.0, 1.0), (0.0, 0.04)] {
            for degrees in ANGLES {
                let share = albedo(&ggx(diffuse, f0, roughness), degrees);
                assert!(share <= 1.0 + 3e-3, "{diffuse} {f0} {roughness} at {degrees}°: {share}");
            }
        }
    }
}

#[test]
fn a_white_base_under_a_coat_returns_all_light() {
    for roughness in [0.1, 0.5, 1.0] {
        for degrees in [0.0, 45.0, 80.0] {
            let share = albedo(&ggx(1.0, 0.04, roughness), degrees);
            assert!((share - 1.0).abs() < 5e-3, "{roughness} at {degrees}°: {share}");
        }
    }
}

#[test]
fn the_table_of_the_coat_is_its_integral() {
    for roughness in [0.1, 0.2, 0.37, 0.5, 0.83, 1.0] {
        for degrees in [0.0, 30.0, 60.0, 80.0] {
            for f0 in [0.04, 0.5, 1.0] {
                let integral = albedo(&ggx(0.0, f0, roughness), degrees);
                let table = coat_albedo(Vec3::splat(f0), roughness, tilted(degrees).z).x;
                // Both have errors: 2e-3 of the table, the rest of the quadrature at grazing angles.
                assert!((integral - table).abs() < 4e-3, "{f0} {roughness} {degrees}°: {integral} {table}");
            }
        }
    }
}

#[test]
fn ggx_has_its_known_values() {
    // Light, eye and normal in line, α = 1: D = 1/π, V = 1/4, F = f0.
    let value = ggx(0.0, 0.5, 1.0).brdf(Vec3::Z, Vec3::Z, Vec3::Z).x;
    assert!((value - 0.5 / (4.0 * std::f32::consts::PI)).abs() < 1e-6, "{value}");
    // α = 0.25 (roughness 0.5): D = 1/(π α²) = 16/π.
    let value = ggx(0.0, 0.5, 0.5).brdf(Vec3::Z, Vec3::Z, Vec3::Z).x;
    assert!((value - 0.5 * 16.0 / (4.0 * std::f32::consts::PI)).abs() < 1e-4, "{value}");
    // Eye and light 60° to both sides, α = 1: D = 1/π, V = 0.5/(2·0.5·1), F = 0.5 + 0.5·(1/2)⁵.
    let value = ggx(0.0, 0.5, 1.0).brdf(Vec3::Z, tilted(60.0), tilted(-60.0)).x;
    let wanted = (0.5 + 0.5 / 32.0) * 0.5 / std::f32::consts::PI;
    assert!((value - wanted).abs() < 1e-6, "{value} {wanted}");
}

#[test]
fn metals_have_no_diffuse_part_and_plastics_a_clear_coat() {
    let base = vec3(0.9, 0.6, 0.3);
    let metal = Material::metallic_roughness(base, 1.0, 0.3);
    assert_eq!((metal.diffuse, metal.specular), (Vec3::ZERO, base));
    let plastic = Material::metallic_roughness(base, 0.0, 0.3);
    assert_eq!((plastic.diffuse, plastic.specular), (base, Vec3::splat(0.04)));
    assert_eq!(
        Material::lambert(base).with_specular(Model::Ggx, Vec3::ZERO, 0.0).brdf(Vec3::Z, Vec3::Z, Vec3::Z),
        Material::lambert(base).brdf(Vec3::Z, Vec3::Z, Vec3::Z)
    );
}

fn plastic(l: Vec3, v: Vec3) -> Vec3 {
    let m = ggx(0.5, 0.04, 0.4);
    m.with_diffuse(vec3(0.5, 0.3, 0.1)).brdf(Vec3::Z, l, v)
}

#[test]
fn a_table_of_a_function_gives_the_function_back() {
    let table = MerlTable::tabulate(plastic);
    let mut worst = 0.0f32;
    for (a, b) in [(0.0, 10.0), (10.0, 10.0), (30.0, -30.0), (30.0, -25.0), (50.0, 20.0), (-60.0, 10.0)] {
        for turn in [0.0f32, 40.0, 90.0, 170.0, 300.0] {
            let around = glam::Quat::from_rotation_z(turn.to_radians());
            let (l, v) = (tilted(a), around * tilted(b));
            let (got, wanted) = (table.brdf(Vec3::Z, l, v), plastic(l, v));
            worst = worst.max(((got - wanted) / wanted).abs().max_element());
        }
    }
    assert!(worst < 5e-3, "{worst}");
    let read = MerlTable::from_bytes(&table.to_bytes()).unwrap();
    let (l, v) = (tilted(20.0), tilted(-35.0));
    assert!(((read.brdf(Vec3::Z, l, v) - table.brdf(Vec3::Z, l, v)).abs().max_element()) < 1e-7);
    // Turned with its surface, it stays what it is; and light and eye can be exchanged.
    let q = glam::Quat::from_rotation_x(1.1) * glam::Quat::from_rotation_z(0.7);
    let turned = read.brdf(q * Vec3::Z, q * l, q * v);
    assert!((turned - read.brdf(Vec3::Z, l, v)).abs().max_element() < 1e-4);
    assert!((read.brdf(Vec3::Z, v, l) - read.brdf(Vec3::Z, l, v)).abs().max_element() < 1e-5);
    assert_eq!(read.brdf(Vec3::Z, -l, v), Vec3::ZERO);
    // The energy of what was tabulated.
    let whole = directional_albedo(Vec3::Z, 64, plastic);
    assert!((read.albedo() - whole).abs().max_element() < 5e-3, "{} {whole}", read.albedo());
}

#[test]
fn a_constant_table_is_that_constant_everywhere() {
    let table = MerlTable::tabulate(|_, _| vec3(0.1, 0.2, 0.3));
    for (a, b) in [(0.0, 0.0), (89.0, -89.0), (89.9, 89.9), (0.01, 80.0)] {
        let got = table.brdf(Vec3::Z, tilted(a), tilted(b));
        assert!((got - vec3(0.1, 0.2, 0.3)).abs().max_element() < 1e-6, "{got}");
    }
}

#[test]
fn wrong_tables_are_refused() {
    let header = |n: [i32; 3]| n.iter().flat_map(|n| n.to_le_bytes()).collect::<Vec<u8>>();
    let [a, b, c] = MERL_DIMENSIONS.map(|n| n as i32);
    let refused = |bytes: &[u8]| MerlTable::from_bytes(bytes).unwrap_err();
    assert!(matches!(refused(&[]), ShadeError::MerlSize { len: 0, .. }));
    assert!(matches!(refused(&header([90, 90, 360])), ShadeError::MerlDimensions { found: [90, 90, 360] }));
    assert!(matches!(refused(&header([-1, 0, i32::MAX])), ShadeError::MerlDimensions { .. }));
    assert!(matches!(refused(&header([a, b, c])), ShadeError::MerlSize { len: 12, .. }));
    let mut whole = invariants::merl_of_pattern(&[0]);
    assert!(MerlTable::from_bytes(&whole).is_ok());
    let at = 12 + 8 * 1_500_000;
    whole[at..at + 8].copy_from_slice(&f64::NAN.to_le_bytes());
    assert_eq!(refused(&whole), ShadeError::MerlValue { index: 1_500_000 });
    whole[at..at + 8].copy_from_slice(&1e300f64.to_le_bytes());
    assert_eq!(refused(&whole), ShadeError::MerlValue { index: 1_500_000 });
    whole[at..at + 8].copy_from_slice(&(-1f64).to_le_bytes());
    assert!(MerlTable::from_bytes(&whole).is_ok());
    whole.push(0);
    assert!(matches!(refused(&whole), ShadeError::MerlSize { .. }));
}

proptest! {
    #![proptest_config(testkit::config(2))]

    #[test]
    fn any_pattern_is_a_table_or_refused(pattern in prop::collection::vec(any::<u8>(), 0..40), x in -1.0f32..1.0, y in -1.0f32..1.0) {
        let directions = [Vec3::Z, vec3(x, y, 0.5), vec3(y, -x, 0.1)];
        invariants::merl_is_read_or_refused(&pattern, directions).map_err(TestCaseError::fail)?;
        let whole = invariants::merl_of_pattern(&pattern);
        invariants::merl_is_read_or_refused(&whole, directions).map_err(TestCaseError::fail)?;
    }
}

proptest! {
    #![proptest_config(testkit::config(16))]

    #[test]
    fn ggx_of_any_parameters_keeps_its_energy(f0 in 0.0f32..=1.0, roughness in 0.0f32..=1.0, diffuse in 0.0f32..=1.0, degrees in 0.0f32..89.0) {
        let share = albedo(&ggx(diffuse, f0, roughness), degrees);
        prop_assert!((0.0..=1.0 + 4e-3).contains(&share), "{}", share);
    }
}
