//! Pictures with wrong bytes: an error with the file's name, whatever the byte.

use crate::common::{Folder, SCENE};
use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Image, Layer, LayerAttributes,
    LineOrder, Vec2, WritableImage as _, f16,
};
use pointillist_cli::image_io::{ExrError, ExrFile};
use std::io::Cursor;

const SIZE: [usize; 2] = [11, 19];

/// A picture with smooth and rough channels of every kind.
fn exr_file(compression: Compression, blocks: Blocks) -> Vec<u8> {
    let samples = |f: &dyn Fn(usize) -> f32| (0..SIZE[0] * SIZE[1]).map(f).collect::<Vec<f32>>();
    let half = |list: Vec<f32>| FlatSamples::F16(list.into_iter().map(f16::from_f32).collect());
    let rough = |i: usize| (i.wrapping_mul(2_654_435_761) % 1000) as f32;
    let smooth = |i: usize| (i % SIZE[0]) as f32 * 0.01;
    let channels = [
        AnyChannel::new("A", half(samples(&|_| 1.0))),
        AnyChannel::new("B", half(samples(&smooth))),
        AnyChannel::new("G", half(samples(&rough))),
        AnyChannel::new("R", half(samples(&smooth))),
        AnyChannel::new("Z", FlatSamples::F32(samples(&|i| rough(i) + 0.1))),
        AnyChannel::new("id", FlatSamples::U32((0..SIZE[0] * SIZE[1]).map(|i| i as u32 / 50).collect())),
    ];
    let encoding = Encoding { compression, blocks, line_order: LineOrder::Increasing };
    let channels = AnyChannels::sort(channels.into_iter().collect());
    let layer = Layer::new((SIZE[0], SIZE[1]), LayerAttributes::named("layer"), encoding, channels);
    let mut bytes = Cursor::new(vec![]);
    Image::from_layer(layer).write().to_buffered(&mut bytes).expect("an EXR");
    bytes.into_inner()
}

/// Where the numbers of the data window begin.
fn data_window(bytes: &[u8]) -> usize {
    let name = b"dataWindow\0box2i\0\x10\0\0\0";
    bytes.windows(name.len()).position(|window| window == name).expect("a data window") + name.len()
}

/// The same file, with a data window of 100,000 × 100,000 pixels.
fn with_huge_window(mut bytes: Vec<u8>) -> Vec<u8> {
    let at = data_window(&bytes);
    bytes[at + 8..at + 12].copy_from_slice(&99_999_i32.to_le_bytes());
    bytes[at + 12..at + 16].copy_from_slice(&99_999_i32.to_le_bytes());
    bytes
}

#[test]
fn every_damaged_byte_is_an_error_or_another_picture() {
    // All of the header, and a byte of each few that follow: what decides is at the beginning.
    let cases = [
        (Compression::ZIP16, Blocks::ScanLines),
        (Compression::RLE, Blocks::Tiles(Vec2(16, 8))),
        (Compression::PIZ, Blocks::ScanLines),
        (Compression::PXR24, Blocks::ScanLines),
        (Compression::B44A, Blocks::ScanLines),
        (Compression::DWAA(None), Blocks::ScanLines),
    ];
    for (compression, blocks) in cases {
        let whole = exr_file(compression, blocks);
        let read = ExrFile::read(&whole).expect("the whole file can be read");
        assert_eq!(read.size, SIZE.map(|n| n as u32));
        let header = data_window(&whole) + 200;
        for at in (0..whole.len()).filter(|at| *at < header || at % 17 == 0) {
            let mut bytes = whole.clone();
            bytes[at] ^= 0xff;
            // That it returns is what is tested; a byte of a sample gives another sample.
            let _ = ExrFile::read(&bytes).map_err(|error| assert!(!error.to_string().is_empty()));
        }
        for length in (0..whole.len()).step_by(13) {
            assert!(ExrFile::read(&whole[..length]).is_err(), "{compression:?} cut to {length} bytes");
        }
    }
}

#[test]
fn sizes_that_the_file_cannot_hold_are_refused_before_memory_is_taken() {
    for compression in [Compression::Uncompressed, Compression::RLE, Compression::ZIP16, Compression::PIZ] {
        let error = ExrFile::read(&with_huge_window(exr_file(compression, Blocks::ScanLines))).unwrap_err();
        assert!(matches!(error, ExrError::TooShort { width: 100_000, height: 100_000, .. }), "{error}");
    }
    // A level that is not the picture's, and one tile of 2³⁰ × 2³⁰ pixels.
    let mut tiles = exr_file(Compression::ZIP16, Blocks::Tiles(Vec2(64, 64)));
    let name = b"tiledesc\0\x09\0\0\0";
    let at = tiles.windows(name.len()).position(|window| window == name).unwrap() + name.len();
    tiles[at..at + 8].copy_from_slice(&[0, 0, 0, 0x20, 0, 0, 0, 0x20]);
    assert!(matches!(ExrFile::read(&tiles).unwrap_err(), ExrError::Block { .. }));
}

#[test]
fn every_command_names_the_damaged_picture() {
    let folder = Folder::new();
    let whole = exr_file(Compression::ZIP16, Blocks::ScanLines);
    folder.write("whole.exr", &whole);
    folder.write("damaged.exr", with_huge_window(whole));
    folder.write("sky.toml", SCENE.replace("[image]\n", "[image]\nenvironment = \"damaged.exr\"\n"));
    let pieces = ["damaged.exr", "100000×100000 pixels in 6 channels are announced"];
    for line in [
        &["info", "damaged.exr"][..],
        &["compare", "damaged.exr", "whole.exr"],
        &["compare", "whole.exr", "damaged.exr"],
        &["merge", "damaged.exr", "-o", "out.exr"],
        &["probe", "project", "damaged.exr"],
        &["check", "sky.toml"],
        &["render", "sky.toml", "-o", "out.png"],
    ] {
        folder.fails(line, 3, &pieces);
    }
}

#[test]
fn a_damaged_output_is_drawn_again_and_told() {
    let folder = Folder::new();
    let line = ["render", "scene.toml", "-o", "out.exr"];
    folder.prints(&line);
    let whole = std::fs::read(folder.path("out.exr")).unwrap();
    folder.write("out.exr", with_huge_window(whole.clone()));
    let output = folder.command(&line).output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{message}");
    assert!(message.contains("out.exr is there, but cannot be used"), "{message}");
    assert_eq!(std::fs::read(folder.path("out.exr")).unwrap(), whole);
}

#[test]
fn other_pictures_are_held_against_memory_too() {
    let folder = Folder::new();
    // A Radiance map of 4,000,000 × 1,000 pixels, of which nothing is there.
    folder.write("sky.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1000 +X 4000000\n");
    folder.fails(&["info", "sky.hdr", "--memory", "1G"], 3, &["sky.hdr", "of memory", "--memory"]);
    folder.fails(&["probe", "project", "sky.hdr", "--memory", "1G"], 3, &["sky.hdr", "4000000×1000 pixels"]);
}
