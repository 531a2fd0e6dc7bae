//! Tiles are painted on several threads at once, each whole.
#![cfg(feature = "rayon")]

use glam::{DVec3, Vec3};
use pointillist_render::shade;
use pointillist_render::{Camera, DrawOptions, Material, Monitor, Part, Prepared, Scene};
use std::sync::{Condvar, Mutex};
use std::time::Duration;

/// Threads that end a stage wait for one another.
#[derive(Default)]
struct Meeting {
    /// How many have come, and whether one gave up.
    state: Mutex<(u32, bool)>,
    another: Condvar,
}

impl Meeting {
    const LONGEST: Duration = Duration::from_secs(20);

    fn took_place(&self) -> bool {
        self.state.lock().unwrap().0 >= 2
    }
}

impl Monitor for Meeting {
    fn lap(&self, stage: &'static str) {
        let mut state = self.state.lock().unwrap();
        if stage == "shade" && state.0 < 2 && !state.1 {
            state.0 += 1;
            self.another.notify_all();
            let (mut state, waited) =
                self.another.wait_timeout_while(state, Self::LONGEST, |state| state.0 < 2).unwrap();
            state.1 |= waited.timed_out();
        }
    }
}

#[test]
fn two_threads_shade_at_once() {
    let mut scene = Scene::new(Camera::perspective(DVec3::Z * 2.0, DVec3::ZERO, 1.0), [128, 128]);
    scene.add_material(Material::new("white", shade::Material::lambert(Vec3::ONE)));
    let corners = [DVec3::NEG_ONE, DVec3::X * 3.0, DVec3::Y * 3.0];
    scene.mesh.add(&Part::new("triangle", &corners, &[[0, 1, 2]])).unwrap();
    let prepared = Prepared::new(&scene, &()).unwrap();
    let meeting = Meeting::default();
    let two = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
    two.install(|| prepared.draw(&DrawOptions::DEFAULT, &meeting)).unwrap();
    assert!(meeting.took_place(), "one thread shaded while the other waited for it");
}
