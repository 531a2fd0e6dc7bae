//! Readers of files: what they understand, and that no input makes them panic.

use glam::{DVec3, dvec3};
use pointillist_cli::InputError;
use pointillist_cli::image_io::{ExrFile, PixelRect, Stamp};
use pointillist_cli::mesh_io::{read_mtl, read_obj, read_ply, triangulate};
use pointillist_cli::options::Tile;
use pointillist_cli::scene::{self, Format, NONE, Projection};
use proptest::prelude::*;

#[test]
fn obj_in_all_its_dialects_is_one_mesh() {
    let plain = read_obj("a", b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n").unwrap();
    let dialect = b"\xef\xbb\xbf# \xe9t\xe9\r\n\tv 0 0 0 1.0\r\nv 1 0 0 # right\r\nv 1\t1 0 0.5 0.5 0.5\r\nv 0 \\\r\n 1 0\r\no x\r\ng y\r\ns off\r\nf -4 -3 \\\r\n-2 -1\r\n";
    let dialect = read_obj("b", dialect).unwrap();
    assert_eq!(plain.positions, dialect.positions);
    assert_eq!(plain.triangles, dialect.triangles);
}

#[test]
fn faces_with_and_without_coordinates_keep_apart() {
    let text = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.5 0.25\nvn 0 0 2\nf 1/1/1 2/1/1 3/1/1\nf 3 2 1\nf 1//1 2//1 3//1\nf 1/1 2/1 3\n";
    let mesh = read_obj("a", text).unwrap();
    let has = |list: &[[u32; 3]]| list.iter().map(|c| *c != [NONE; 3]).collect::<Vec<_>>();
    assert_eq!(has(&mesh.uv_of), [true, false, false, false]);
    assert_eq!(has(&mesh.normal_of), [true, false, true, false]);
    assert_eq!(mesh.unit_normals().next().unwrap(), glam::Vec3::Z);
}

#[test]
fn materials_without_definition_keep_their_names() {
    let text = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nusemtl red clay\nf 1 2 3\nusemtl\tblue\nf 1 2 3\nusemtl red clay\nf 1 2 3\n";
    let mesh = read_obj("a", text).unwrap();
    assert_eq!(mesh.material_names, ["", "red clay", "blue"]);
    assert_eq!(mesh.material_of, [0, 1, 2, 1]);
}

#[test]
fn concave_polygons_keep_their_area() {
    // An arrow head: a fan from its first corner would cover what is not there.
    let arrow = [dvec3(0.0, 2.0, 1.0), dvec3(-1.0, 0.0, 1.0), dvec3(0.0, 1.0, 1.0), dvec3(1.0, 0.0, 1.0)];
    for start in 0..4 {
        let corners: Vec<DVec3> = (0..4).map(|i| arrow[(start + i) % 4]).collect();
        let mut areas = vec![];
        triangulate(&corners, |[a, b, c]| {
            areas.push((corners[b] - corners[a]).cross(corners[c] - corners[a]).z * 0.5);
        });
        assert_eq!(areas.len(), 2);
        assert!(areas.iter().all(|&area| area > 0.0), "{areas:?}");
        assert!((areas.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    }
}

#[test]
fn mtl_keys_are_understood() {
    let text = b"newmtl a b\r\nKd 0.5\r\nKs 1 1 1 # bright\r\nNs 10\r\nTr 0.25\r\nKe 2 0 0\r\nillum 2\r\nmap_Kd -s 2 2 2 -clamp on dir/my tex.png\r\nmap_bump -bm 0.5 b.png\r\ndecal c.png\r\nNi 1.5\r\nTf 1 0 0\r\nPr 0.25\r\n";
    let material = &read_mtl("a", text).unwrap()[0];
    assert_eq!(material.name, "a b");
    assert_eq!(material.diffuse, Some(glam::Vec3::splat(0.5)));
    assert_eq!(material.opacity, Some(0.75));
    let map = material.map("map_Kd").unwrap();
    assert_eq!((map.file.as_str(), map.line, map.clamp), ("dir/my tex.png", 8, true));
    let bump = material.map("map_bump").unwrap();
    assert_eq!((bump.file.as_str(), bump.bump_multiplier), ("b.png", Some(0.5)));
    assert_eq!((material.refraction_index, material.roughness), (Some(1.5), Some(0.25)));
    assert_eq!(material.transmission, Some(glam::Vec3::X));
    assert_eq!(material.ignored, ["decal"]);
}

#[test]
fn ply_is_read_ascii_and_binary() {
    let header = |format: &str| {
        format!(
            "ply\nformat {format} 1.0\nelement vertex 3\nproperty float x\nproperty double y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
        )
    };
    let ascii = header("ascii") + "0 0 0\n1 0 0\n0 1 0.5\n3 0 1 2\n";
    let mut binary = header("binary_little_endian").into_bytes();
    for [x, y, z] in [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.5f64]] {
        binary.extend((x as f32).to_le_bytes());
        binary.extend(y.to_le_bytes());
        binary.extend((z as f32).to_le_bytes());
    }
    binary.push(3);
    [0i32, 1, 2].iter().for_each(|i| binary.extend(i.to_le_bytes()));
    let mesh = read_ply("a", ascii.as_bytes()).unwrap();
    assert_eq!(mesh, read_ply("b", &binary).unwrap());
    assert_eq!(mesh.positions[2], dvec3(0.0, 1.0, 0.5));
    assert_eq!(mesh.triangles, [[0, 1, 2]]);
}

fn parse(text: &str) -> Result<scene::Description, InputError> {
    scene::parse_str("scene", text, Format::Toml, &[])
}

#[test]
fn transforms_go_scale_then_x_y_z_then_translation() {
    let text = "[[object]]\nmesh = \"a.obj\"\nscale = [2, 1, 1]\nrotate = [90, 0, 90]\ntranslate = [0, 0, 5]";
    let world = parse(text).unwrap().objects[0].world_from_mesh;
    // x doubled stays under the turn about x, and goes to y under the turn about z.
    assert!(world.transform_point3(DVec3::X).distance(dvec3(0.0, 2.0, 5.0)) < 1e-12);
    // y goes to z, and stays.
    assert!(world.transform_point3(DVec3::Y).distance(dvec3(0.0, 0.0, 6.0)) < 1e-12);
    let matrix = "[[object]]\nmesh = \"a.obj\"\nmatrix = [0,1,0,0, 0,0,1,0, 1,0,0,0, 7,8,9,1]";
    let world = parse(matrix).unwrap().objects[0].world_from_mesh;
    assert_eq!(world.transform_point3(DVec3::X), dvec3(7.0, 9.0, 9.0));
}

#[test]
fn a_height_is_an_orthographic_view() {
    let text = "[camera]\nheight = 3\n[[object]]\nmesh = \"a.obj\"";
    assert_eq!(parse(text).unwrap().camera.projection, Some(Projection::Orthographic { height: 3.0 }));
}

#[test]
fn deep_nesting_is_an_error_and_no_stack_overflow() {
    for text in ["[".repeat(100_000), "{\"a\":".repeat(100_000), format!("a={}", "[".repeat(100_000))] {
        for format in [Format::Toml, Format::Json] {
            assert!(scene::parse_str("deep", &text, format, &[]).is_err());
        }
    }
}

#[test]
fn tiles_cover_any_region_once() {
    let region = PixelRect { x0: 3, y0: 5, x1: 9, y1: 22 };
    for count in 1..=17 {
        let mut next = region.y0;
        for first in 0..count {
            let window = Tile { first, last: first, count }.window(region).unwrap();
            assert_eq!(window.y0, next);
            next = window.y1;
        }
        assert_eq!(next, region.y1);
    }
    assert_eq!(Tile { first: 0, last: 0, count: 18 }.window(region), None);
}

#[test]
fn stamps_survive_their_text() {
    let stamp = Stamp {
        version: "1.2.3".to_owned(),
        fingerprint: 0xfeed,
        region: PixelRect { x0: 1, y0: 2, x1: 3, y1: 4 },
        unfinished: false,
        tile: Some("1/4".to_owned()),
        background: [0.1, 0.2, 1e-7],
    };
    assert_eq!(Stamp::from_text(&stamp.to_text()), Some(stamp));
}

/// Lines in which most of the trouble is possible.
fn obj_text() -> impl Strategy<Value = String> {
    let word = prop_oneof![
        "-?[0-9]{1,3}",
        "-?[0-9]{1,2}/-?[0-9]{0,2}/-?[0-9]{0,20}",
        "[0-9]\\.[0-9]e[0-9]{1,4}",
        Just("nan".to_owned()),
        Just("\\".to_owned()),
        Just("#".to_owned()),
        "[a-z]{0,3}",
    ];
    let keyword = prop_oneof![
        Just("v"),
        Just("vt"),
        Just("vn"),
        Just("f"),
        Just("usemtl"),
        Just("mtllib"),
        Just("g"),
        Just("l"),
        Just(""),
    ];
    let line = (keyword, prop::collection::vec(word, 0..6))
        .prop_map(|(k, words)| format!("{k} {}", words.join(" ")));
    prop::collection::vec(line, 0..30).prop_map(|lines| lines.join("\n"))
}

fn check_mesh(mesh: &pointillist_cli::mesh_io::FileMesh) {
    let inside =
        |list: &[[u32; 3]], count: usize| list.iter().flatten().all(|&i| i == NONE || (i as usize) < count);
    assert!(inside(&mesh.triangles, mesh.positions.len()));
    assert!(inside(&mesh.uv_of, mesh.uvs.len()) && inside(&mesh.normal_of, mesh.normals.len()));
    assert!(mesh.positions.iter().all(|p| p.is_finite()));
    assert!(mesh.material_of.iter().all(|&m| (m as usize) < mesh.material_names.len()));
}

proptest! {
    #![proptest_config(testkit::config(256))]

    #[test]
    fn any_obj_is_a_mesh_or_an_error(text in obj_text()) {
        if let Ok(mesh) = read_obj("fuzz", text.as_bytes()) {
            check_mesh(&mesh);
        }
    }

    #[test]
    fn any_bytes_are_a_mesh_or_an_error(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        for result in [read_obj("fuzz", &bytes), read_ply("fuzz", &bytes)].into_iter().flatten() {
            check_mesh(&result);
        }
        let _ = read_mtl("fuzz", &bytes).map_err(|error| error.to_string());
        let _ = ExrFile::read(&bytes);
    }

    #[test]
    fn any_mtl_is_materials_or_an_error(lines in prop::collection::vec("(newmtl|Kd|d|Tr|Ns|illum|map_Kd|map_d|bump|Ke|x)( -?[a-z0-9.]{0,4}){0,4}", 0..12)) {
        let text = format!("newmtl a\n{}", lines.join("\n"));
        let _ = read_mtl("fuzz", text.as_bytes()).map_err(|error| error.to_string());
    }

    #[test]
    fn any_text_is_a_scene_or_an_error(text in "[\\[\\]a-z_=\"0-9.,{} \n-]{0,80}", set in "[a-z.\\[\\]0-9=\" \n,-]{0,20}") {
        for format in [Format::Toml, Format::Json] {
            let result = scene::parse_str("fuzz", &text, format, std::slice::from_ref(&set));
            let _ = result.map_err(|error| error.to_string());
        }
    }

    #[test]
    fn broken_scenes_have_messages(at in 0usize..400, with in "\\PC{0,3}") {
        const SCENE: &str = "[camera]\neye = [0, 1, 2]\nup = [0, 1, 0]\nfov = 30\n[image]\nsize = [4, 4]\n[[object]]\nmesh = \"a.obj\"\nscale = 2\n[[light]]\ntype = \"spot\"\nposition = [0, 1, 0]\ndirection = [0, -1, 0]\nintensity = [1, 1, 1]\nbeam = 3\ncutoff = 5\nresolution = 64\n[material.a]\ndiffuse = [1, 1, 1]\nopacity = 0.5\n";
        let at = at.min(SCENE.len());
        let mut text = SCENE.to_owned();
        text.insert_str(at, &with);
        if let Err(error) = parse(&text) {
            prop_assert!(!error.to_string().is_empty());
        }
    }

    #[test]
    fn any_polygon_becomes_two_less_triangles(corners in prop::collection::vec([-4i32..4, -4..4, -1..2], 3..9)) {
        let corners: Vec<DVec3> = corners.into_iter().map(|c| DVec3::from_array(c.map(f64::from))).collect();
        let mut count = 0;
        triangulate(&corners, |triangle| {
            assert!(triangle.iter().all(|&i| i < corners.len()));
            count += 1;
        });
        prop_assert_eq!(count, corners.len() - 2);
    }
}
