//! Any bytes as a glTF: a mesh whose indices are in range, or an error that can be shown. Bytes that are no glTF at all also
//! serve as the buffer of one that is.
#![no_main]

use libfuzzer_sys::fuzz_target;
use pointillist_cli::mesh_io::gltf::read_gltf;

const TRIANGLE: &[u8] = br#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0,"COLOR_0":0},"indices":1}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,1]},
{"bufferView":1,"componentType":5121,"count":6,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6}],
"buffers":[{"byteLength":42,"uri":"x.bin"}]}"#;

fuzz_target!(|bytes: &[u8]| {
    for file in [bytes, TRIANGLE] {
        match read_gltf("model.gltf", file, &|_| Ok(bytes.to_vec())) {
            Ok(mesh) => {
                let count = mesh.positions.len();
                assert!(mesh.triangles.iter().flatten().all(|&v| (v as usize) < count));
                assert!(mesh.positions.iter().all(|p| p.is_finite()));
                assert!(mesh.colors.is_empty() || mesh.colors.len() == count);
            }
            Err(error) => assert!(!error.to_string().is_empty()),
        }
    }
});
