//! LAS, LAZ and E57, written by their own crates and read back; and broken ones.

use glam::{DVec3, dvec3};
use pointillist_cli::InputError;
use pointillist_cli::cloud_io::{CloudFormat, CloudOptions, CloudSummary, read_cloud_bytes};

/// Positions and colours, all blocks joined.
type Points = (Vec<DVec3>, Vec<[f32; 3]>);

fn read(name: &str, bytes: &[u8]) -> Result<(Points, CloudSummary), InputError> {
    let (mut positions, mut colours) = Points::default();
    let options = CloudOptions::DEFAULT.with_block_points(2);
    let summary = read_cloud_bytes::<InputError>(name, bytes, &options, &mut |block| {
        positions.extend(block.positions);
        colours.extend(block.colours.unwrap_or_default());
        Ok(())
    })?;
    Ok(((positions, colours), summary))
}

fn refused(name: &str, bytes: &[u8], pieces: &[&str]) {
    let text = read(name, bytes).expect_err(name).to_string();
    for piece in [name, "help: "].iter().chain(pieces) {
        assert!(text.contains(piece), "this does not say {piece:?}:\n{text}");
    }
}

#[cfg(feature = "las")]
mod las_files {
    use super::*;
    use crate::common::Folder;
    use las::point::Format;
    use las::{Builder, Color, Point, Writer};
    use std::io::Cursor;

    /// A file of three points with millimetres and colours of 16 bits.
    fn file(compressed: bool, highest: u16) -> Vec<u8> {
        let mut builder = Builder::from((1, 4));
        builder.point_format = Format::new(2).unwrap();
        builder.point_format.is_compressed = compressed;
        let mut writer = Writer::new(Cursor::new(Vec::new()), builder.into_header().unwrap()).unwrap();
        for i in 0..3 {
            let x = 2_000_000.0 + f64::from(i) * 0.001;
            let color = Some(Color { red: highest, green: 0, blue: 0 });
            writer.write_point(Point { x, y: -2.5, color, ..Point::default() }).unwrap();
        }
        writer.into_inner().unwrap().into_inner()
    }

    #[test]
    fn las_and_laz_are_read_with_large_offsets_and_both_kinds_of_colours() {
        for (compressed, highest) in [(false, 255), (false, 65_535), (true, 255), (true, 65_535)] {
            let file = file(compressed, highest);
            let ((positions, colours), summary) = read("a.las", &file).unwrap();
            assert_eq!(summary.format, CloudFormat::Las);
            assert_eq!(colours, [[1.0, 0.0, 0.0]; 3]);
            assert!(positions[2].distance(dvec3(2_000_000.002, -2.5, 0.0)) < 1e-6, "{positions:?}");
        }
    }

    #[test]
    fn the_program_draws_las_and_laz_and_tells_what_they_hold() {
        let folder = Folder::new();
        for (name, is_compressed) in [("sheet.las", false), ("sheet.laz", true)] {
            let mut builder = Builder::from((1, 2));
            builder.point_format = Format::new(2).unwrap();
            builder.point_format.is_compressed = is_compressed;
            let mut writer = Writer::new(Cursor::new(Vec::new()), builder.into_header().unwrap()).unwrap();
            for (x, y) in (0..41).flat_map(|y| (0..41).map(move |x| (x, y))) {
                let (x, y) = (0.05 * f64::from(x) - 1.0, 0.05 * f64::from(y) - 1.0);
                let color = Some(Color { red: 0, green: 65_535, blue: 0 });
                writer.write_point(Point { x, y, color, ..Point::default() }).unwrap();
            }
            folder.write(name, writer.into_inner().unwrap().into_inner());
            let info: serde_json::Value = serde_json::from_str(&folder.prints(&["info", name])).unwrap();
            assert_eq!(info["points"], 41 * 41, "{info}");
            let view = ["--eye", "0,0,3", "--target", "0,0,0", "--fov", "30", "--size", "24x24"];
            for command in ["scan", "surfel"] {
                folder.prints(&[&[command, name, "-o", "a.png"][..], &view].concat());
                let middle = image::open(folder.path("a.png")).unwrap().into_rgba8().get_pixel(12, 12).0;
                assert!(
                    middle[1] > 200 && middle[0] < 10 && middle[3] == 255,
                    "{command} {name}: {middle:?}"
                );
            }
        }
    }

    #[test]
    fn las_and_laz_that_promise_too_much_are_refused() {
        for compressed in [false, true] {
            let file = file(compressed, 255);
            for cut in 0..file.len() - 1 {
                let _ = read("a.las", &file[..cut]).map_err(|error| error.to_string());
            }
            refused("a.las", &file[..file.len() - 60], &["not LAS"]);
        }
        // The length of the first extended record, and the number of chunks.
        let mut record = file(false, 255);
        let size = record.len() as u64;
        record[235..247].copy_from_slice(&[&size.to_le_bytes()[..], &[1, 0, 0, 0]].concat());
        record.extend([255; 60]);
        refused("a.las", &record, &["extended record 0", &format!("byte {size}")]);
        let mut chunks = file(true, 255);
        let start = u32::from_le_bytes(chunks[96..100].try_into().unwrap()) as usize;
        let table = u64::from_le_bytes(chunks[start..start + 8].try_into().unwrap()) as usize;
        chunks[table + 4..table + 8].fill(255);
        refused("a.laz", &chunks, &["4294967295 chunks"]);
    }

    /// Each byte in turn, so that every length and every kind in the headers is wrong once.
    #[test]
    fn any_changed_byte_of_laz_is_an_error_or_a_cloud() {
        let file = file(true, 255);
        for at in 0..file.len() {
            for byte in [0, 255, file[at] ^ 1] {
                let mut changed = file.clone();
                changed[at] = byte;
                let _ = read("a.laz", &changed).map_err(|error| error.to_string());
            }
        }
    }
}

#[cfg(feature = "e57")]
mod e57_files {
    use super::*;
    use crate::common::Folder;
    use e57::{E57Writer, Record, RecordValue, Transform, Translation};

    #[test]
    fn e57_is_read_with_the_pose_of_each_scan() {
        let folder = Folder::new();
        let mut writer = E57Writer::from_file(folder.path("a.e57"), "file").unwrap();
        for x in [0.0, 100.0] {
            let prototype = vec![
                Record::CARTESIAN_X_F64,
                Record::CARTESIAN_Y_F64,
                Record::CARTESIAN_Z_F64,
                Record::COLOR_RED_U8,
                Record::COLOR_GREEN_U8,
                Record::COLOR_BLUE_U8,
            ];
            let mut scan = writer.add_pointcloud("scan", prototype).unwrap();
            let translation = Translation { x, ..Translation::default() };
            scan.set_transform(Some(Transform { translation, ..Transform::default() }));
            let position = [1.0, 2.0, 3.0].map(RecordValue::Double);
            let red = [255, 0, 0].map(RecordValue::Integer);
            scan.add_point(position.into_iter().chain(red).collect()).unwrap();
            scan.finalize().unwrap();
        }
        writer.finalize().unwrap();
        let bytes = std::fs::read(folder.path("a.e57")).unwrap();
        let ((positions, colours), summary) = read("a.e57", &bytes).unwrap();
        assert_eq!(positions, [dvec3(1.0, 2.0, 3.0), dvec3(101.0, 2.0, 3.0)]);
        assert_eq!(colours, [[1.0, 0.0, 0.0]; 2]);
        assert_eq!(summary.format, CloudFormat::E57);
        refused("a.e57", &bytes[..bytes.len() / 2], &["not E57"]);
    }
}
