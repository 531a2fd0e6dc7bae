//! A white floor beside a red wall under an even sky: how much redder is the floor near the wall? Prints the floor's radiosity
//! along a line away from the wall.
//!
//! `cargo run --release -p pointillist-radiosity --example red_on_white`

use glam::{DVec3, dvec3};
use pointillist_radiosity::{RadiosityError, Scene, SceneOptions, SolveOptions, Surface};

fn quad(o: DVec3, u: DVec3, v: DVec3) -> [DVec3; 4] {
    [o, o + u, o + u + v, o + v]
}

fn main() -> Result<(), RadiosityError> {
    let sky = quad(dvec3(-5.0, -5.0, 3.0), DVec3::Y * 10.0, DVec3::X * 10.0);
    let surfaces = [
        Surface::new(&quad(DVec3::ZERO, DVec3::X * 2.0, DVec3::Y * 2.0), [0.8, 0.8, 0.8]),
        Surface::new(&quad(DVec3::ZERO, DVec3::Y * 2.0, DVec3::Z), [0.8, 0.1, 0.1]),
        Surface::new(&sky, [0.0; 3]).emitting([1.0; 3]),
    ];
    let options = SceneOptions::DEFAULT.with_patch(0.125).with_tolerance(Some(0.01));
    let transport = Scene::new(&surfaces, &options)?.transport(&[])?;
    let solution = transport.gauss_seidel(&SolveOptions::DEFAULT)?;
    println!("{} patches, {} links", transport.patch_count(), transport.counts().links);
    for step in 0..8 {
        let at = dvec3(0.05 + 0.25 * f64::from(step), 1.0, 0.0);
        let light = solution.irradiance(at, DVec3::Z, true)?;
        let [r, g, _] = light.map(|e| 0.8 * e);
        println!(
            "{:.2} from the wall: red {r:.3}, green {g:.3}, redder by {:.1} %",
            at.x,
            100.0 * (r / g - 1.0)
        );
    }
    Ok(())
}
