//! Numbers and bytes that cannot be used: the file and the line, or the option as it was typed.

use crate::common::{Folder, SCENE};

#[test]
fn numbers_of_a_mesh_that_are_too_large_show_their_line() {
    let folder = Folder::new();
    let faces = "v 1 0 0\nv 0 1 0\nf 1 2 3\n";
    for (line, text) in [("v 1e300 0 0", 1), ("v 0 -1e19 0", 1), ("v 0 0 nan", 1), ("v inf 0 0", 1)] {
        folder.write("bad.obj", format!("{line}\n{faces}"));
        let pieces = [format!("bad.obj:{text}"), line.to_owned()];
        for command in [&["check", "bad.obj"][..], &["info", "bad.obj"], &["scan", "bad.obj", "-o", "a.png"]]
        {
            folder.fails(command, 3, &[&pieces[0], &pieces[1]]);
        }
    }
    let header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n\
                  element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    folder.write("bad.ply", format!("{header}0 0 0\n1e300 0 0\n0 1 0\n3 0 1 2\n"));
    folder.fails(&["check", "bad.ply"], 3, &["bad.ply:11", "vertex 1", "1e300 0 0"]);
    folder.write("far.toml", SCENE.replace("mesh =", "translate = [1e25, 0, 0]\nmesh ="));
    folder.fails(&["check", "far.toml"], 3, &["far.toml:", "vertex 0 out of the range"]);
}

#[test]
fn a_glb_with_numbers_that_are_not_finite_names_the_accessor() {
    let folder = Folder::new();
    let glb = |x: f32| {
        let json = r#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,1]}],"bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36}]}"#;
        let mut json = json.as_bytes().to_vec();
        json.resize(json.len().next_multiple_of(4), b' ');
        let numbers = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, x, 1.0, 0.0];
        let bin: Vec<u8> = numbers.iter().flat_map(|n: &f32| n.to_le_bytes()).collect();
        let length = |n: usize| (n as u32).to_le_bytes();
        let mut glb = [b"glTF".as_slice(), &length(2), &length(28 + json.len() + bin.len())].concat();
        for (kind, chunk) in [(b"JSON", &json), (b"BIN\0", &bin)] {
            glb.extend(length(chunk.len()));
            glb.extend(kind);
            glb.extend(chunk);
        }
        glb
    };
    folder.write("good.glb", glb(0.5));
    folder.prints(&["check", "good.glb"]);
    for bad in [f32::NAN, f32::INFINITY] {
        folder.write("bad.glb", glb(bad));
        folder.fails(&["check", "bad.glb"], 3, &["bad.glb", "accessor 0", "not finite"]);
    }
    folder.write("far.glb", glb(1e30));
    folder.fails(&["check", "far.glb"], 3, &["far.glb", "1e18"]);
}

#[test]
fn clouds_have_no_points_beyond_what_can_be_computed_with() {
    let folder = Folder::new();
    folder.write("far.xyz", "0 0 0\n1 0 0\n0 1 0\n1e38 -1e38 0\n");
    let pieces = ["far.xyz", "1 of 4 points", "in line 4", "--drop-invalid"];
    for command in ["scan", "surfel"] {
        folder.fails(&[command, "far.xyz", "-o", "a.png"], 3, &pieces);
    }
    folder.prints(&["scan", "far.xyz", "-o", "a.png", "--size", "16x16", "--drop-invalid"]);
    folder.write("sheet.xyz", "0 0 0\n");
    folder.write("far.conf", "bmesh sheet.xyz 1e30 0 0 0 0 0 1\n");
    folder.fails(&["scan", "far.conf", "-o", "a.png"], 3, &["far.conf:1", "1e30"]);
    folder.write("points.txt", "0 0 0\n0 1e30 0\n");
    folder.fails(&["probe", "tetra", "points.txt"], 3, &["points.txt:2", "1e30"]);
}

#[test]
fn bytes_that_are_no_text_show_their_line() {
    let folder = Folder::new();
    let fails = |name: &str, text: &[u8], line: &[&str], place: &str| {
        folder.write(name, text);
        folder.fails(line, 3, &[place]);
    };
    fails("a.obj", b"v 0 0 0\nv \xff 0 0\nv 0 1 0\nf 1 2 3\n", &["check", "a.obj"], "a.obj:2");
    fails("b.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\n\xfe\xff 1 2 3\n", &["check", "b.obj"], "b.obj:4");
    folder.write("c.obj", "mtllib c.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
    fails("c.mtl", b"newmtl a\nKd 1 \xff 1\n", &["check", "c.obj"], "c.mtl:2");
    fails("d.xyz", b"0 0 0\n1 \xff 0\n", &["scan", "d.xyz", "-o", "a.png"], "d.xyz:2");
    fails("e.conf", b"# fine\nbm\xffsh a 0 0 0 0 0 0 1\n", &["scan", "e.conf", "-o", "a.png"], "e.conf:2");
    fails("f.toml", b"[camera]\nfov = \xff\n", &["check", "f.toml"], "f.toml:2");
    // A comment may hold anything.
    folder.write("g.obj", b"# caf\xe9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 # \xff\n");
    folder.prints(&["check", "g.obj"]);
}

#[test]
fn numbers_of_a_scene_are_bounded_with_their_line() {
    let folder = Folder::new();
    for (good, bad) in
        [("[30, 30, 30]", "[30, 1e300, 30]"), ("fov = 40", "fov = 1e31"), ("[1, 2, 3]", "[1e99, 2, 3]")]
    {
        folder.write("bad.toml", SCENE.replace(good, bad));
        folder.fails(&["check", "bad.toml"], 3, &["bad.toml:", "1e30", "^"]);
    }
}

#[test]
fn options_are_named_as_they_were_typed_before_anything_is_loaded() {
    let folder = Folder::new();
    let wrong: [(&[&str], &[&str]); 24] = [
        (&["scan", "gone", "--alpha", "2"], &["--alpha", "2", "0 to 1"]),
        (&["scan", "gone", "--alpha", "-0.1"], &["--alpha", "-0.1", "0 to 1"]),
        (&["scan", "gone", "--depth-layers", "99"], &["--depth-layers", "99"]),
        (&["scan", "gone", "--light", "0,0,0"], &["--light", "0,0,0"]),
        (&["scan", "gone", "--light", "nan,0,0"], &["--light", "nan,0,0"]),
        (&["scan", "gone", "--ambient", "7"], &["--ambient", "7"]),
        (&["scan", "gone", "--outline", "2"], &["--outline", "2"]),
        (&["scan", "gone", "--fill", "7"], &["--fill", "7"]),
        (&["scan", "gone", "--finer", "1.5"], &["--finer", "1.5"]),
        (&["scan", "gone", "--gamma", "-1"], &["--gamma", "-1"]),
        (&["scan", "gone", "--edl", "-1"], &["--edl", "-1"]),
        (&["scan", "gone", "--spacing", "-3"], &["--spacing", "-3"]),
        (&["scan", "gone", "--crop", "0,0,2000,5"], &["--crop 0,0,2000,5"]),
        (&["scan", "gone", "--eye", "1,1,1", "--target", "1,1,1"], &["--eye", "--target", "same point"]),
        (&["scan", "gone", "--up", "0,0,1", "--eye", "0,0,3", "--target", "0,0,0"], &["--up", "parallel"]),
        (&["surfel", "gone", "--light", "0,0,0"], &["--light", "0,0,0"]),
        (&["surfel", "gone", "--ambient", "-1"], &["--ambient", "-1"]),
        (&["surfel", "gone", "--fov", "-3"], &["--fov", "-3", "more than 0"]),
        (&["render", "gone.toml", "--fov", "-3"], &["--fov", "-3", "more than 0"]),
        (&["render", "gone.toml", "--eye", "1e300,0,0"], &["--eye", "1e300,0,0"]),
        (&["render", "gone.toml", "--up", "0,0,0"], &["--up", "0,0,0"]),
        (
            &["render", "gone.toml", "--eye", "1,1,1", "--target", "1,1,1"],
            &["--eye", "--target", "same point"],
        ),
        (&["radiosity", "gone.toml", "--patch", "-1"], &["--patch", "-1", "more than 0"]),
        (&["sample", "gone.obj", "--spacing", "0"], &["--spacing", "0", "more than 0"]),
    ];
    for (line, pieces) in wrong {
        folder.fails(line, 2, pieces);
    }
}

#[test]
fn whole_numbers_of_options_are_asked_for_in_plain_words() {
    let folder = Folder::new();
    for (line, option, wanted) in [
        (&["radiosity", "gone.toml", "--max-patches", "1e11"][..], "--max-patches", "from 1 to"),
        (&["probe", "place", "gone.toml", "--count", "1e12"], "--count", "from 1 to 16777216"),
        (&["scan", "gone.ply", "--depth-layers", "99"], "--depth-layers", "from 1 to 8"),
        (&["sample", "gone.ply", "--seed", "x"], "--seed", "from 0 to"),
    ] {
        folder.fails(line, 2, &[option, line[line.len() - 1], "must be a whole number", wanted]);
    }
}

#[test]
fn a_spacing_that_asks_for_too_many_points_is_named() {
    let folder = Folder::new();
    for method in ["ldi", "poisson"] {
        let line = ["sample", "triangle.obj", "--spacing", "1e-9", "--method", method];
        folder.fails(&line, 2, &["--spacing 0.000000001", "larger --spacing"]);
    }
}

#[test]
fn a_query_without_a_normal_shows_its_line() {
    let folder = Folder::new();
    folder.prints(&["probe", "place", "scene.toml", "--grid", "2x2x2", "-o", "probes.json"]);
    folder.prints(&["probe", "bake", "scene.toml", "probes.json", "--resolution", "4", "--bounces", "0"]);
    folder.write("queries.txt", "0 0 0 0 0 1\n# next\n1 2 3 0 0 0\n");
    folder.fails(
        &["probe", "query", "baked.json", "queries.txt"],
        3,
        &["queries.txt:3", "no normal", "1 2 3 0 0 0"],
    );
}

#[test]
fn a_probe_beyond_all_scenes_is_named() {
    let folder = Folder::new();
    folder.write("far.json", "{\"probes\":[{\"position\":[0,1,0]},\n{\"position\":[1e300,0,0]}]}");
    for line in [
        &["info", "far.json"][..],
        &["probe", "bake", "scene.toml", "far.json"],
        &["probe", "tetra", "far.json"],
    ] {
        folder.fails(line, 3, &["far.json", "probes[1].position", "1e18"]);
    }
}
