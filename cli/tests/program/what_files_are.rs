//! What `info`, messages and manual pages say.

use crate::common::{Folder, SCENE};
use serde_json::Value;

const CLOUD: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                     end_header\n0 0 0\n1 0 0\n0 2 0\n";

fn info(folder: &Folder, file: &str) -> Value {
    serde_json::from_str(&folder.prints(&["info", file])).unwrap()
}

#[test]
fn info_tells_what_was_baked_and_how_much_of_it() {
    let folder = Folder::new();
    folder.prints(&["radiosity", "scene.toml", "--patch", "1", "-o", "r.json"]);
    let radiosity = info(&folder, "r.json");
    assert_eq!(radiosity["kind"], "radiosity");
    assert!(radiosity["vertices"].as_u64() > Some(2), "{radiosity}");
    assert_eq!(radiosity["bounds"], serde_json::json!([[-1.0, 0.0, 0.0], [1.0, 1.5, 0.0]]));
    image::RgbImage::from_pixel(8, 4, image::Rgb([255; 3])).save(folder.path("sky.png")).unwrap();
    folder.prints(&["probe", "project", "sky.png", "-o", "sh.json"]);
    let harmonics = info(&folder, "sh.json");
    assert_eq!((&harmonics["kind"], &harmonics["order"]), (&"harmonics".into(), &2.into()));
    assert!((harmonics["mean_radiance"][0].as_f64().unwrap() - 1.0).abs() < 1e-6);
    folder.write("p.json", r#"{"probes":[{"position":[0,0,0]},{"position":[1,2,3]}]}"#);
    let probes = info(&folder, "p.json");
    assert_eq!((&probes["kind"], &probes["probes"]), (&"probes".into(), &2.into()));
    folder.write("c.ply", CLOUD);
    assert_eq!(info(&folder, "c.ply")["points"], 3);
    for value in [radiosity, harmonics, probes, info(&folder, "c.ply")] {
        assert!(value["units"].is_object(), "{value}");
    }
}

#[test]
fn info_knows_the_lists_that_commands_pass_on() {
    let folder = Folder::new();
    folder.write("p.txt", "0 0 0\n1 0 0\n0 1 0\n0 0 1\n");
    folder.prints(&["probe", "tetra", "p.txt", "-o", "t.txt"]);
    let cells = info(&folder, "t.txt");
    assert_eq!((&cells["kind"], &cells["cells"]), (&"tetrahedra".into(), &1.into()));
    let points: Vec<u8> = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0_f64]
        .iter()
        .flat_map(|n| n.to_le_bytes())
        .collect();
    folder.write("p.bin", points);
    folder.prints(&["probe", "tetra", "p.bin", "-o", "t.bin"]);
    let raw = info(&folder, "p.bin");
    assert_eq!((&raw["kind"], &raw["points"]), (&"points".into(), &4.into()));
    assert_eq!(raw["bounds"], serde_json::json!([[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]]));
    let cells = info(&folder, "t.bin");
    assert_eq!((&cells["kind"], &cells["cells"]), (&"tetrahedra".into(), &1.into()));
    folder.write("odd.bin", [0; 7]);
    folder.fails(&["info", "odd.bin"], 3, &["7 bytes", "three little-endian doubles"]);
    folder.write(
        "q.jsonl",
        "{\"polygon\":[[0.5,0.5],[1.5,0.5],[1.5,1.5]]}\n\n{\"polygon\":[[0,0],[1,0],[1,1]]}\n",
    );
    folder.prints(&["dice", "q.jsonl", "--areas", "-o", "a.jsonl"]);
    let (questions, answers) = (info(&folder, "q.jsonl"), info(&folder, "a.jsonl"));
    assert_eq!((&questions["lines"], &questions["command"]), (&2.into(), &"dice".into()));
    assert_eq!((&answers["lines"], &answers["command"]), (&2.into(), &"dice --areas".into()));
    folder.prints(&[
        "radiosity",
        "scene.toml",
        "--patch",
        "1",
        "-o",
        "r.json",
        "--factors",
        "F.csv",
        "--stats",
        "s.json",
    ]);
    let factors = std::fs::read_to_string(folder.path("F.csv")).unwrap().lines().count() - 1;
    let told = info(&folder, "F.csv");
    assert_eq!((&told["kind"], &told["factors"]), (&"form factors".into(), &factors.into()));
    let stats = info(&folder, "s.json");
    assert_eq!(stats["kind"], "statistics");
    assert!(stats["peak_bytes"].as_u64() > Some(0) && stats["total_s"].is_f64(), "{stats}");
    folder.fails(&["render", "s.json"], 3, &["what `--stats` wrote, not a scene"]);
    let curve: String = (0..256).map(|level| format!("{level}\n")).collect();
    folder.write("curve.txt", curve);
    assert_eq!(info(&folder, "curve.txt")["kind"], "response curve");
    folder.write("m.mtl", "newmtl red\nKd 1 0 0\nmap_Kd red.png\n");
    let library = info(&folder, "m.mtl");
    assert_eq!(library["materials"][0]["maps"], serde_json::json!([["map_Kd", "red.png"]]));
    folder.write("job.yaml", "specificationVersion: 'jobtemplate-2023-09'\nname: pictures\n");
    assert_eq!(info(&folder, "job.yaml")["kind"], "job template");
    folder.write(
        "job.json",
        r#"{"specificationVersion":"jobtemplate-2023-09","name":"n","steps":[{"name":"Draw"}]}"#,
    );
    assert_eq!(info(&folder, "job.json")["steps"], serde_json::json!(["Draw"]));
    folder.write("notes.yaml", "a: 1\n");
    folder.fails(&["info", "notes.yaml"], 3, &["no job template"]);
    folder.fails(&["info", "nothing.odd"], 3, &["does not say what kind"]);
}

#[test]
fn info_tells_what_of_a_scene_is_heavy() {
    let folder = Folder::new();
    let light = info(&folder, "scene.toml");
    assert_eq!((&light["heavy"], &light["unseen"]), (&serde_json::json!([]), &serde_json::json!([])));
    let small = light["memory_bytes"].as_u64().unwrap();
    // A fan of leaves beside the camera's view, and a texture that no picture of 16 pixels needs.
    image::GrayImage::from_pixel(4200, 4100, image::Luma([128])).save(folder.path("mask.png")).unwrap();
    folder.write("leaf.mtl", "newmtl leaf\nmap_d mask.png\n");
    let leaves: String = (0..1200).map(|i| format!("v {i} 0 9\nv {i} 1 9\nv {i}.5 0 9\n")).collect();
    let faces: String =
        (0..1200).map(|i| 3 * i).map(|v| format!("f {} {} {}\n", v + 1, v + 2, v + 3)).collect();
    folder.write("leaves.obj", format!("mtllib leaf.mtl\nusemtl leaf\n{leaves}{faces}"));
    let scene = SCENE.replace("[[light]]", "[[object]]\nmesh = \"leaves.obj\"\n[[light]]");
    folder.write("tree.toml", scene);
    let tree = info(&folder, "tree.toml");
    assert_eq!(tree["unseen"], serde_json::json!(["leaves.obj"]));
    let heavy = tree["heavy"].to_string();
    for piece in ["1200 of 1201 triangles are out of view", "mask.png", "4200×4100", "foliage"] {
        assert!(heavy.contains(piece), "{piece} is not told: {heavy}");
    }
    assert!(tree["memory_bytes"].as_u64().unwrap() > small + 4200 * 4100);
    folder.fails(&["check", "tree.toml"], 0, &["note: ", "foliage"]);
}

#[test]
fn info_knows_pictures_and_parts_of_them() {
    let folder = Folder::new();
    folder.prints(&["render", "scene.toml", "--tile", "1/2", "-o", "part.exr"]);
    let part = info(&folder, "part.exr");
    assert_eq!((&part["tile"], &part["is_part"]), (&"1/2".into(), &true.into()));
    assert_eq!(part["region"], serde_json::json!([0, 0, 16, 12]));
    assert_eq!(part["window"], serde_json::json!([0, 6, 16, 12]));
    assert_eq!(part["fingerprint"].as_str().map(str::len), Some(16));
    folder.prints(&["render", "scene.toml", "--bg", "white", "-o", "p.jpg"]);
    folder.prints(&["render", "scene.toml", "-o", "p.png"]);
    folder.prints(&["compare", "p.png", "p.jpg", "-o", "c.json"]);
    let (jpeg, png) = (info(&folder, "p.jpg"), info(&folder, "p.png"));
    assert_eq!((&jpeg["format"], &jpeg["opaque"]), (&"jpg".into(), &true.into()));
    assert_eq!((&png["size"], &png["opaque"]), (&serde_json::json!([16, 12]), &false.into()));
    assert_eq!(info(&folder, "c.json")["kind"], "comparison");
}

#[test]
fn info_knows_any_ply() {
    let folder = Folder::new();
    let mesh = CLOUD
        .replace("end_header", "element face 1\nproperty list uchar int vertex_indices\nend_header")
        + "3 0 1 2\n";
    let mut packed = flate2::write::GzEncoder::new(vec![], flate2::Compression::fast());
    std::io::Write::write_all(&mut packed, mesh.as_bytes()).unwrap();
    folder.write("m.ply.gz", packed.finish().unwrap());
    folder
        .write("odd.ply", "ply\nformat ascii 1.0\nelement colour 2\nproperty uchar red\nend_header\n1\n2\n");
    folder.write("c.ply", CLOUD);
    let mesh = info(&folder, "m.ply.gz");
    assert_eq!((&mesh["kind"], &mesh["triangles"]), (&"mesh".into(), &1.into()));
    assert_eq!(mesh["elements"][1]["name"], "face");
    let odd = info(&folder, "odd.ply");
    assert_eq!(odd["elements"], serde_json::json!([{ "name": "colour", "count": 2, "properties": ["red"] }]));
    assert_eq!(info(&folder, "c.ply")["kind"], "cloud");
    folder.write("cut.ply", "ply\nformat ascii 1.0\nelement vertex 3\n");
    folder.fails(&["info", "cut.ply"], 3, &["the header does not end"]);
}

#[test]
fn check_warns_of_keys_without_effect() {
    let folder = Folder::new();
    image::RgbImage::from_pixel(4, 2, image::Rgb([255; 3])).save(folder.path("sky.png")).unwrap();
    folder.fails(&["check", "scene.toml"], 0, &[]);
    let warns = |set: &[&str], key: &str| {
        let sets: Vec<&str> = set.iter().flat_map(|assignment| ["--set", assignment]).collect();
        let line = [&["check", "scene.toml"], &sets[..]].concat();
        folder.fails(&line, 0, &["warning", &format!("`{key}` has no effect")]);
    };
    warns(&["image.environment=sky.png", "image.background=[1,0,0]"], "image.background");
    warns(&["image.backdrop=background"], "image.backdrop");
    warns(&["light.0.shadow=false", "light.0.resolution=64"], "light.0.resolution");
    warns(&["light.0.intensity=[0,0,0]"], "light.0.intensity");
    for (key, value, more) in [
        ("wrap", "clamp", ""),
        ("uv", "box", ""),
        ("color_space", "linear", ""),
        ("environment", "sky.png", ""),
        ("specular", "0.5", ""),
        ("shininess", "20", ""),
        ("shininess", "20", "model=phong"),
        ("emission_map", "sky.png", "emission=[0,0,0]"),
    ] {
        let mut sets = vec!["object.0.material=m".to_owned(), format!("material.m.{key}={value}")];
        sets.extend((!more.is_empty()).then(|| format!("material.m.{more}")));
        let sets: Vec<&str> = sets.iter().map(String::as_str).collect();
        warns(&sets, &format!("material.m.{key}"));
    }
    // Normals that the mesh brings are not made.
    folder.write("n.obj", "v -1 0 0\nv 1 0 0\nv 0 1.5 0\nvn 0 0 1\nf 1//1 2//1 3//1\n");
    warns(&["object.0.mesh=n.obj", "render.crease=30"], "render.crease");
    // What has an effect is not warned of.
    let fine = [
        "object.0.material=m",
        "material.m.model=phong",
        "material.m.specular=0.5",
        "material.m.shininess=9",
    ];
    let sets: Vec<&str> = fine.iter().flat_map(|assignment| ["--set", assignment]).collect();
    let output = folder.command(&[&["check", "scene.toml"], &sets[..]].concat()).output().unwrap();
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
}

#[test]
fn a_file_in_the_wrong_place_is_called_what_it_is() {
    let folder = Folder::new();
    folder.write("c.ply", CLOUD);
    folder.write("c.xyz", "0 0 0\n");
    folder.write("p.json", r#"{"probes":[{"position":[0,0,0]}]}"#);
    folder.write("sh.json", r#"{"order":0,"sh":[[1,1,1]]}"#);
    let draws = ["pointillist scan", "pointillist surfel"];
    folder.fails(&["render", "c.ply"], 3, &["a cloud of 3 points", draws[0], draws[1]]);
    folder.fails(&["render", "c.xyz"], 3, &["a cloud of points", draws[0], draws[1]]);
    folder.fails(&["surfel", "triangle.obj"], 3, &["a mesh or a scene", "pointillist sample"]);
    folder.fails(&["render", "p.json"], 3, &["light probes, not a scene", "[ambient]"]);
    folder.fails(&["probe", "query", "sh.json"], 3, &["harmonics", "not light probes"]);
    let set = ["--set", "ambient.radiosity=p.json"];
    folder.fails(&[&["check", "scene.toml"], &set[..]].concat(), 3, &["light probes, not baked radiosity"]);
}

#[test]
fn messages_have_no_names_of_types() {
    let folder = Folder::new();
    let header =
        CLOUD.replace("end_header", "element face 1\nproperty list uchar int vertex_indices\nend_header");
    folder.write("bad.ply", format!("{header}3 0 1 x\n"));
    folder.write("bad.obj", "v 0 y 0\n");
    folder.write("bad.gltf", r#"{"asset":5}"#);
    folder.write("bad.json", r#"{"probes":[{"position":"x"}]}"#);
    folder.write("list.json", "[]");
    folder.write("type.json", r#"{"geometry":5,"irradiance":[]}"#);
    folder.write("bad.jsonl", r#"{"polygon":[["a",2]]}"#);
    folder.write("bad.probes", b"\x93PROBES1\x01");
    let commands: [(&[&str], &str); 9] = [
        (&["render", "bad.ply"], "bad.ply:13:1"),
        (&["render", "bad.obj"], "bad.obj:1:1"),
        (&["render", "bad.gltf"], "should be an object"),
        (
            &["probe", "query", "bad.json"],
            "`probes[0].position` is the string \"x\" and should be a list of 3",
        ),
        (&["probe", "query", "list.json"], "is a list and should be an object"),
        (&["check", "scene.toml", "--set", "ambient.radiosity=type.json"], "`geometry` is the number `5`"),
        (&["dice", "bad.jsonl"], "a value is the string \"a\" and should be a number"),
        (&["info", "bad.probes"], "no probes"),
        (&["check", "scene.toml", "--set", "ambient.probes=bad.json"], "should be a list of 3"),
    ];
    for (line, piece) in commands {
        let output = folder.command(line).output().unwrap();
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(3), "{line:?}: {message}");
        assert!(message.contains(piece), "{line:?} does not say {piece:?}:\n{message}");
        for word in ["struct", "f64", "usize", "Error", "sequence", "expected", "::", "None", "Some("] {
            assert!(!message.contains(word), "{line:?} says {word:?}:\n{message}");
        }
    }
}

#[test]
fn every_command_has_a_manual_page_whose_examples_keep_their_lines() {
    let folder = Folder::new();
    folder.prints(&["man", "-o", "man1"]);
    let page = |name: &str| std::fs::read_to_string(folder.path(&format!("man1/{name}.1"))).expect(name);
    for (name, commands) in [
        (
            "pointillist",
            &["render", "scan", "surfel", "sample", "probe", "radiosity", "dice", "compare", "man"][..],
        ),
        ("pointillist-probe", &["place", "bake", "project", "tetra", "query"][..]),
        ("pointillist-radiosity", &["factors"][..]),
    ] {
        commands.iter().for_each(|command| assert!(page(&format!("{name}-{command}")).contains("SYNOPSIS")));
    }
    let bake = page("pointillist-probe-bake");
    let (_, examples) = bake.split_once(".SH EXAMPLES\n.nf\n").expect("examples that are not filled");
    let (examples, _) = examples.split_once(".fi").expect("their end");
    assert!(
        examples.lines().filter(|line| line.contains("pointillist probe bake examples/house.toml")).count()
            >= 4
    );
    assert!(page("pointillist").contains("EXIT STATUS"));
    assert!(!folder.names().iter().any(|name| name.contains("help")));
}
