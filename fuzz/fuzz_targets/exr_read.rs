//! Any bytes as an EXR: a picture whose planes are as large as its window, or an error that can be shown.
#![no_main]

use libfuzzer_sys::fuzz_target;
use pointillist_cli::image_io::ExrFile;

fuzz_target!(|bytes: &[u8]| {
    // Every input is an EXR for its first eight bytes, which are the same in all of them.
    let file = [b"\x76\x2f\x31\x01\x02\0\0\0".as_slice(), bytes.get(8..).unwrap_or_default()].concat();
    for file in [bytes, &file] {
        match ExrFile::read(file) {
            Ok(picture) => {
                let pixels = picture.window.pixels() as usize;
                let plane = |name: &str| picture.plane(name).map_or(0, |plane| plane.len());
                assert!(picture.channels.iter().all(|channel| plane(&channel.name) == pixels));
                assert!(picture.window.x1 <= picture.size[0] && picture.window.y1 <= picture.size[1]);
            }
            Err(error) => assert!(!error.to_string().is_empty()),
        }
    }
});
