//! Light for mirrors: closed forms, and fields that change.

use glam::{DVec3, Vec3, dvec3};
use pointillist_shprobe::sh::{Lobe, Sh};
use pointillist_shprobe::{Field, Hint, ProbeError};

fn corners() -> Vec<DVec3> {
    vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z, dvec3(1.0, 1.0, 1.0)]
}

/// A function of this order that is above 0, different for each number.
fn radiance(order: usize, number: usize) -> Sh {
    let count = (order + 1) * (order + 1);
    let coefficient = |i: usize| match i {
        0 => dvec3(9.0, 8.0, 7.0) + number as f64,
        _ => {
            0.2 * dvec3((i * 7 + number) as f64, (i * 3 + number) as f64, (i + 5 * number) as f64)
                .map(f64::sin)
        }
    };
    Sh::new((0..count).map(coefficient).collect()).unwrap()
}

fn all(order: usize) -> Vec<Sh> {
    (0..corners().len()).map(|i| radiance(order, i)).collect()
}

fn towards(field: &Field, position: DVec3, direction: DVec3, lobe: &Lobe) -> Vec3 {
    let d = direction.normalize().as_vec3();
    field.glossy(position, Vec3::ZERO, d, lobe, &mut Hint::default()).unwrap().radiance
}

#[test]
fn at_a_probe_a_mirror_sees_its_radiance_and_a_rough_surface_its_convolution() {
    let lobes = [Lobe::MIRROR, Lobe::COSINE, Lobe::ggx(0.3).unwrap(), Lobe::phong(12.0).unwrap()];
    for order in 0..=8 {
        let field = Field::new(&corners(), &all(order)).unwrap();
        for (i, lobe) in lobes.iter().enumerate() {
            let direction = dvec3(0.3, -0.8, 0.1 * i as f64).normalize();
            let wanted = radiance(order, 2).glossy(direction, lobe).as_vec3();
            let found = towards(&field, DVec3::Y, direction, lobe);
            assert!((found - wanted).abs().max_element() < 1e-4 * wanted.max_element(), "{order} {i}");
        }
    }
}

#[test]
fn between_probes_light_is_blended_as_irradiance_is() {
    let field = Field::new(&corners(), &all(3)).unwrap();
    let p = dvec3(0.2, 0.3, 0.1);
    let normal = dvec3(0.5, 0.1, -0.7).normalize();
    let glossy = towards(&field, p, normal, &Lobe::COSINE);
    let irradiance = field.irradiance(p, Vec3::ZERO, normal.as_vec3(), &mut Hint::default()).unwrap();
    assert!((glossy - irradiance).abs().max_element() < 1e-4, "{glossy} {irradiance}");
}

#[test]
fn the_share_of_sky_is_convolved_and_stays_between_0_and_1() {
    let light = all(2);
    let field = Field::new(&corners(), &light).unwrap();
    let d = Vec3::Y;
    let ask = |field: &Field, lobe: &Lobe| {
        field.glossy(DVec3::ZERO, Vec3::ZERO, d, lobe, &mut Hint::default()).unwrap().sky
    };
    assert_eq!(ask(&field, &Lobe::MIRROR), None);
    // The upper half is open: even light from there is 1/2 + 3/4 y in the first two bands.
    let half = Sh::new(vec![
        std::f64::consts::PI.sqrt(),
        0.75 * (4.0 * std::f64::consts::PI / 3.0).sqrt(),
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
    ]);
    let sky = vec![half.unwrap(); light.len()];
    let field = field.with_sky(&sky).unwrap();
    assert_eq!(ask(&field, &Lobe::MIRROR), Some(1.0));
    let lobe = Lobe::ggx(0.8).unwrap();
    let wanted = 0.5 + 0.75 * lobe.bands()[1];
    assert!((f64::from(ask(&field, &lobe).unwrap()) - wanted.min(1.0)).abs() < 1e-6);
    // A surface that faces the open half gets all of an even sky's light, one that stands upright half of it, one that faces down none.
    for (normal, wanted) in [(Vec3::Y, 1.0), (Vec3::X, 0.5), (Vec3::NEG_Y, 0.0)] {
        let share = field.sky_share(DVec3::ZERO, normal, &mut Hint::default()).unwrap().unwrap();
        assert!((share - wanted).abs() < 1e-5, "{normal}: {share}");
    }
    let mut field = field;
    field.set_sky(0, &Sh::zero(2).unwrap()).unwrap();
    assert_eq!(ask(&field, &Lobe::MIRROR), Some(0.0));
}

#[test]
fn fields_that_changed_mirror_like_fields_that_were_made_so() {
    let (places, light) = (corners(), all(2));
    let sky: Vec<Sh<f64>> = (0..5).map(|i| Sh::constant(0.1 + 0.2 * f64::from(i), 2).unwrap()).collect();
    let whole = Field::new(&places, &light).unwrap().with_sky(&sky).unwrap();
    // Four, of which one is wrong, and the fifth later; the first goes.
    let mut grown = Field::new(&places[..4], &[&[radiance(2, 9)], &light[1..4]].concat()).unwrap();
    grown = grown.with_sky(&sky[..4]).unwrap();
    grown.set_radiance(0, &light[0]).unwrap();
    grown.insert(&places[4..], &light[4..], vec![]).unwrap();
    let p = dvec3(0.45, 0.4, 0.35);
    let ask = |field: &Field, p: DVec3| {
        field.glossy(p, Vec3::ZERO, Vec3::X, &Lobe::MIRROR, &mut Hint::default()).unwrap()
    };
    assert_eq!(ask(&grown, p).radiance, ask(&whole, p).radiance);
    // What was added has seen no sky yet.
    assert!(ask(&grown, p).sky < ask(&whole, p).sky);
    grown.set_sky(4, &sky[4]).unwrap();
    assert_eq!(ask(&grown, p), ask(&whole, p));
    grown.remove(&[0]).unwrap();
    let rest = Field::new(&places[1..], &light[1..]).unwrap().with_sky(&sky[1..]).unwrap();
    assert_eq!(ask(&grown, p), ask(&rest, p));
}

#[test]
fn what_cannot_be_is_refused() {
    let field = Field::new(&corners(), &all(2)).unwrap();
    let mirror = |p: DVec3, d: Vec3| field.glossy(p, Vec3::ZERO, d, &Lobe::MIRROR, &mut Hint::default());
    assert!(mirror(DVec3::NAN, Vec3::X).is_err() && mirror(DVec3::ZERO, Vec3::NAN).is_err());
    let sky = |count: usize, order: usize| vec![Sh::<f64>::zero(order).unwrap(); count];
    let with = |sky: &[Sh<f64>]| field.clone().with_sky(sky).map(|_| ());
    assert_eq!(with(&sky(4, 2)), Err(ProbeError::CountMismatch { probes: 5, given: 4 }));
    assert!(matches!(with(&sky(5, 3)), Err(ProbeError::MixedOrders { index: 0, .. })));
    let huge = Sh::constant(1e40, 2).unwrap();
    assert_eq!(with(&vec![huge; 5]), Err(ProbeError::BadRadiance { index: 0 }));
    let mut field = field.clone();
    assert!(field.set_sky(0, &sky(1, 2)[0]).is_err(), "it knows of no sky");
    assert!(field.set_sky(9, &sky(1, 2)[0]).is_err());
}
