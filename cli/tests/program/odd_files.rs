//! Files as people and programs write them: headers, quotes, modes, nothing at all.

use crate::common::{Folder, SCENE, TRIANGLE};
use serde_json::Value;

fn info(folder: &Folder, file: &str) -> Value {
    serde_json::from_str(&folder.prints(&["info", file])).unwrap()
}

fn cells(folder: &Folder, line: &str) -> Vec<Value> {
    let output = folder.command(&["dice", "--areas"]).write_stdin(line).output().unwrap();
    assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice::<Value>(&output.stdout).unwrap()["cells"].as_array().unwrap().clone()
}

fn total(cells: &[Value]) -> f64 {
    cells.iter().map(|cell| cell["area"].as_f64().unwrap()).sum()
}

#[test]
fn polygons_that_cross_themselves_and_rings_have_the_area_of_their_rule() {
    let folder = Folder::new();
    let bow_tie = cells(&folder, r#"{"polygon":[[0,0],[2,2],[2,0],[0,2]]}"#);
    assert_eq!((bow_tie.len(), total(&bow_tie)), (4, 2.0));
    let rings = r#""rings":[[[0,0],[3,0],[3,3],[0,3]],[[1,1],[2,1],[2,2],[1,2]]]"#;
    let even = cells(&folder, &format!("{{{rings}}}"));
    assert_eq!((even.len(), total(&even)), (8, 8.0));
    assert_eq!(total(&cells(&folder, &format!(r#"{{{rings},"rule":"evenodd"}}"#))), 8.0);
    assert_eq!(total(&cells(&folder, &format!(r#"{{{rings},"rule":"nonzero"}}"#))), 9.0);
    for (request, piece) in [
        (r#"{"rings":[[[0,0],[1,0],[1e99,1]]]}"#, "rings[0][2]"),
        (r#"{"rings":[],"rule":"odd"}"#, "evenodd"),
        (r#"{"rings":[],"polygon":[]}"#, "both given"),
        (r#"{"grid":{}}"#, "`polygon`, or `rings`"),
    ] {
        let output = folder.command(&["dice", "--areas"]).write_stdin(request).output().unwrap();
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(3), "{request}");
        assert!(message.contains(piece), "{piece}: {message}");
    }
    let output = folder.command(&["dice"]).write_stdin(format!("{{{rings}}}")).output().unwrap();
    assert!(String::from_utf8(output.stderr).unwrap().contains("`rings` need --areas"));
}

#[test]
fn no_points_have_no_cells() {
    let folder = Folder::new();
    folder.write("none.txt", "# nothing\n");
    assert_eq!(folder.prints(&["probe", "tetra", "none.txt"]), "# tetrahedra 0\n");
    folder
        .prints(&["probe", "tetra", "none.txt", "--locate", "none.txt", "--stats", "s.json", "-o", "c.bin"]);
    assert_eq!(std::fs::read(folder.path("c.bin")).unwrap(), b"");
    let stats: Value = serde_json::from_slice(&std::fs::read(folder.path("s.json")).unwrap()).unwrap();
    assert_eq!(stats["locate_random_mqps"], 0.0);
}

#[test]
fn the_first_line_of_a_csv_names_its_columns() {
    let folder = Folder::new();
    folder.write("c.xyz", "x,y,z,r,g,b\n0,0,0,255,0,0\n1,2,3,0,255,0\n");
    let cloud = info(&folder, "c.xyz");
    assert_eq!(
        (&cloud["points"], &cloud["colours"], &cloud["normals"]),
        (&2.into(), &true.into(), &false.into())
    );
    // In any order, with columns that are left out, whatever they hold.
    folder.write(
        "d.csv",
        "\"Label\";Z;X;Y;Time Stamp;nx;ny;nz;R;G;B\n\nfirst one;3;1;2;;0;0;1;0;128;255\nlast;6;4;5;noon;1;0;0;9;9;9\n",
    );
    let cloud = info(&folder, "d.csv");
    assert_eq!(cloud["bounds"], serde_json::json!([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]));
    assert_eq!((&cloud["colours"], &cloud["normals"]), (&true.into(), &true.into()));
    assert!(cloud["warnings"][0].as_str().unwrap().contains("`label`, `time stamp`"), "{cloud}");
    // Names that say nothing are passed over.
    folder.write("e.txt", "easting northing height\n1 2 3\n4 5 6\n");
    assert_eq!(info(&folder, "e.txt")["points"], 2);
    folder.write("f.xyz", "x,y,z\n0,0,0\n1,oops,3\n");
    folder.fails(&["info", "f.xyz"], 3, &["f.xyz:3:3", "`oops` is no number"]);
    folder.write("g.xyz", "x,y,z\n0,0\n");
    folder.fails(&["info", "g.xyz"], 3, &["g.xyz:2", "2 values", "3 columns"]);
    folder.write("h.xyz", "some words\nmore words\n0 0 0\n");
    folder.fails(&["info", "h.xyz"], 3, &["h.xyz:2", "`more` is no number"]);
}

#[test]
fn names_with_blanks_may_stand_in_quotes() {
    let folder = Folder::new();
    let pixel = |name: &str| {
        image::RgbImage::from_pixel(1, 1, image::Rgb([9; 3])).save(folder.path(name)).unwrap();
    };
    pixel("my map.png");
    pixel("bump map.png");
    let maps = "map_Kd -s 1 1 1 \"my map.png\"\nmap_bump -bm 0.5 'bump map.png'\n";
    folder.write("my materials.mtl", format!("newmtl a\n{maps}"));
    folder.write("b.mtl", "newmtl b\n");
    folder.write("q.obj", format!("mtllib b.mtl \"my materials.mtl\"\nusemtl a\n{}", TRIANGLE));
    folder.write("q.toml", SCENE.replace("triangle.obj", "q.obj"));
    let scene = info(&folder, "q.toml");
    assert_eq!(scene["textures"].as_array().unwrap().len(), 2, "{scene}");
    assert!(!scene["warnings"].to_string().contains("not there"), "{scene}");
    folder.write("my scan.xyz", "0 0 0\n");
    folder.write("s.conf", "bmesh \"my scan.xyz\" 1 0 0 0 0 0 1\nbmesh my scan.xyz 0 0 0 0 0 0 1\n");
    assert_eq!(info(&folder, "s.conf")["points"], 2);
    folder.write("t.conf", "bmesh \"no scan.xyz\" 1 0 0 0 0 0 1\n");
    folder.fails(&["info", "t.conf"], 3, &["t.conf:1:8", "`no scan.xyz` is not there"]);
}

#[test]
fn fewer_vertices_than_probes_are_said() {
    let folder = Folder::new();
    let line = ["probe", "place", "scene.toml", "--strategy", "vertices", "--inside", "keep"];
    let warning = |count: &str| {
        let output =
            folder.command(&[&line[..], &["--count", count, "-o", "p.json"]].concat()).output().unwrap();
        assert!(output.status.success());
        String::from_utf8(output.stderr).unwrap()
    };
    assert!(
        warning("7").contains("--count 7, but the scene has only 3 different vertices"),
        "{}",
        warning("7")
    );
    assert!(!warning("3").contains("warning"), "{}", warning("3"));
}

#[test]
fn our_png_says_that_it_is_srgb_and_is_read_like_one_that_does_not() {
    let folder = Folder::new();
    folder.prints(&["render", "scene.toml", "-o", "a.png"]);
    let bytes = std::fs::read(folder.path("a.png")).unwrap();
    let chunk = bytes.windows(4).position(|w| w == b"sRGB").expect("an sRGB chunk");
    assert!(chunk < bytes.windows(4).position(|w| w == b"IDAT").unwrap());
    // Length, name, one byte, checksum.
    let plain = [&bytes[..chunk - 4], &bytes[chunk + 9..]].concat();
    folder.write("plain.png", plain);
    let same: Value = serde_json::from_str(&folder.prints(&["compare", "a.png", "plain.png"])).unwrap();
    assert_eq!(same["rmse"], 0.0);
    assert_eq!(image::load_from_memory(&bytes).unwrap().color(), image::ColorType::Rgba8);
    folder.prints(&["compare", "a.png", "plain.png", "--diff", "d.png"]);
    assert!(std::fs::read(folder.path("d.png")).unwrap().windows(4).any(|w| w == b"sRGB"));
}

#[cfg(unix)]
#[test]
fn a_file_that_is_replaced_keeps_its_mode() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = Folder::new();
    let mode = |name: &str| std::fs::metadata(folder.path(name)).unwrap().permissions().mode() & 0o777;
    for (name, line) in [
        ("a.png", &["render", "scene.toml", "-o", "a.png"][..]),
        ("p.json", &["probe", "place", "scene.toml", "--inside", "keep", "-o", "p.json"]),
    ] {
        folder.prints(line);
        assert_eq!(mode(name) & 0o400, 0o400);
        for kept in [0o640, 0o755] {
            std::fs::set_permissions(folder.path(name), std::fs::Permissions::from_mode(kept)).unwrap();
            folder.prints(line);
            assert_eq!(mode(name), kept, "{name}");
        }
    }
}

#[test]
fn sampling_and_gathering_tell_how_far_they_are() {
    let folder = Folder::new();
    let percents = |line: &[&str]| -> Vec<u64> {
        let text = folder.prints(&[line, &["--progress", "openjd"]].concat());
        text.lines().map(|l| l.strip_prefix("openjd_progress: ").expect(l).parse().unwrap()).collect()
    };
    for line in [
        &["sample", "triangle.obj", "--count", "20000", "-o", "c.ply"][..],
        &["radiosity", "scene.toml", "--patch", "0.2", "-o", "r.json"],
    ] {
        let percents = percents(line);
        assert!(percents.is_sorted() && percents.last() == Some(&100), "{line:?}: {percents:?}");
        assert!(percents.iter().filter(|p| (10..90).contains(*p)).count() >= 3, "{line:?}: {percents:?}");
    }
    folder.prints(&["probe", "place", "scene.toml", "--grid", "2x1x1", "--inside", "keep", "-o", "p.json"]);
    let bake = ["probe", "bake", "scene.toml", "p.json", "--resolution", "8", "--fit", "20", "-o", "b.json"];
    assert!(percents(&[&bake[..], &["--inside", "keep"]].concat()).len() > 20);
}

#[test]
fn a_packed_mesh_is_a_mesh_from_a_file_and_from_a_pipe() {
    use std::io::Write as _;
    let folder = Folder::new();
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
               element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    let mut packed = flate2::write::GzEncoder::new(vec![], flate2::Compression::default());
    packed.write_all(ply.as_bytes()).unwrap();
    let packed = packed.finish().unwrap();
    folder.write("mesh.ply.gz", &packed);
    folder.prints(&["check", "mesh.ply.gz"]);
    for file in ["mesh.ply.gz", "-"] {
        let line = ["scan", file, "--size", "16x16", "-o", "a.png", "--stats", "stats.json"];
        folder.command(&line).write_stdin(packed.clone()).assert().success();
    }
    folder.write("mesh.ply.gz", &packed[..packed.len() - 12]);
    folder.fails(&["check", "mesh.ply.gz"], 3, &["mesh.ply.gz", "damaged or cut off"]);
}
