//! What `info`, messages and manual pages say.

mod common;

use common::Folder;
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
