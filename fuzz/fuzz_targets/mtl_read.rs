//! Any bytes as an MTL: materials with numbers that make sense, or an error that can be shown.
#![no_main]

use libfuzzer_sys::fuzz_target;
use pointillist_cli::mesh_io::read_mtl;

fuzz_target!(|bytes: &[u8]| match read_mtl("a.mtl", bytes) {
    Ok(materials) => {
        for m in materials {
            let colors = [m.diffuse, m.specular, m.emission, m.transmission];
            assert!(colors.into_iter().flatten().all(|c| c.is_finite() && c.min_element() >= 0.0));
            let shares = [m.opacity, m.roughness, m.metallic];
            assert!(shares.into_iter().flatten().all(|n| (0.0..=1.0).contains(&n)));
            assert!(m.maps.iter().all(|map| !map.file.is_empty() && map.line > 0));
        }
    }
    Err(error) => assert!(!error.to_string().is_empty()),
});
