//! Carries an object through a corridor of probes that get darker, and prints the light from above along the way.
//!
//! `cargo run --release -p pointillist-shprobe --example light_on_a_path`

use glam::{DVec3, Vec3, dvec3};
use pointillist_shprobe::sh::{CubeMap, CubeProjector, Sh, ShError, Weights};
use pointillist_shprobe::{Field, LitObject, ProbeError, place};

const SIZE: usize = 32;
const STEPS: usize = 16;

/// A lamp at the near end: light from −x that falls with the distance, and a dim rest.
fn corridor_seen_from(p: DVec3) -> Result<CubeMap, ShError> {
    let lamp = 20.0 / (1.0 + p.x * p.x);
    CubeMap::from_fn(SIZE, |direction| {
        let towards_lamp = direction.normalize().dot(DVec3::NEG_X).max(0.0).powi(4);
        dvec3(1.0, 0.9, 0.7) * lamp * towards_lamp + DVec3::splat(0.2)
    })
}

fn main() -> Result<(), ProbeError> {
    let positions = place::grid(DVec3::ZERO, dvec3(10.0, 2.0, 2.0), [8, 2, 2]);
    let projector = CubeProjector::new(SIZE, 2, Weights::Gregory)?;
    let probe = |p: &DVec3| projector.project(&corridor_seen_from(*p)?);
    let radiance = positions.iter().map(probe).collect::<Result<Vec<Sh>, ShError>>()?;
    let field = Field::new(&positions, &radiance)?;

    // The object keeps its hint: finding the next cell is a step or two.
    let mut object = [LitObject::at(DVec3::ZERO)];
    for step in 0..=STEPS {
        object[0].position = dvec3(step as f64 / STEPS as f64 * 12.0 - 1.0, 1.0, 1.0);
        field.light_objects(&mut object)?;
        let (towards, up) = (object[0].light.at(Vec3::NEG_X), object[0].light.at(Vec3::Y));
        println!(
            "x {:5.2}: towards the lamp {:6.3}, from above {:6.3}",
            object[0].position.x, towards.x, up.x
        );
    }
    Ok(())
}
