//! Any bytes as an OBJ: a mesh whose indices are in range, or an error that can be shown.
#![no_main]

use libfuzzer_sys::fuzz_target;
use pointillist_cli::mesh_io::read_obj;

fuzz_target!(|bytes: &[u8]| match read_obj("mesh.obj", bytes) {
    Ok(mesh) => {
        let count = mesh.positions.len();
        assert!(mesh.triangles.iter().flatten().all(|&v| (v as usize) < count));
        assert!(mesh.positions.iter().all(|p| p.is_finite()));
    }
    Err(error) => assert!(!error.to_string().is_empty()),
});
