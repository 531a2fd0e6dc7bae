//! `radiosity` and what `render` makes of it.

use crate::common::Folder;

/// A white floor beside a red wall; the light comes from above and never reaches the wall's back.
const CORNER: &str = "v 0 0 0\nv 2 0 0\nv 2 0 2\nv 0 0 2\nv 0 2 0\nv 0 2 2\n\
usemtl white\nf 1 4 3\nf 1 3 2\nusemtl red\nf 1 5 6\nf 1 6 4\n";

const SCENE: &str = r#"[camera]
eye = [3, 2, 1]
target = [0, 0.5, 1]
fov = 40
[image]
size = [24, 16]
[[object]]
mesh = "corner.obj"
[[light]]
type = "point"
position = [1, 1.5, 1]
intensity = [10, 10, 10]
[material.white]
diffuse = [0.8, 0.8, 0.8]
[material.red]
diffuse = [0.8, 0.1, 0.1]
"#;

fn corner() -> Folder {
    let folder = Folder::new();
    folder.write("corner.obj", CORNER);
    folder.write("room.toml", SCENE);
    folder
}

#[test]
fn form_factors_of_unit_squares_are_the_known_ones() {
    let folder = Folder::new();
    let line =
        |to: &str, more: &str| format!("{{\"from\":[[0,0,0],[1,0,0],[1,1,0],[0,1,0]],\"to\":{to}{more}}}\n");
    let above = "[[0,0,1],[0,1,1],[1,1,1],[1,0,1]]";
    let beside = "[[0,0,0],[0,1,0],[0,1,1],[0,0,1]]";
    let between = ",\"occluders\":[[[-1,-1,0.5],[2,-1,0.5],[2,2,0.5],[-1,2,0.5]]]";
    let text = line(above, "") + "\n" + &line(beside, ",\"occluders\":[]") + &line(above, between);
    folder.write("pairs.jsonl", text);
    let printed = folder.prints(&["radiosity", "factors", "pairs.jsonl", "--stats", "stats.json"]);
    let rows: Vec<serde_json::Value> =
        printed.lines().map(|l| serde_json::from_str(l).expect("JSON")).collect();
    let factor = |i: usize| rows[i]["F"].as_f64().expect("a number");
    assert_eq!(rows.len(), 3);
    assert!((factor(0) - 0.199_824_895_698_387).abs() < 1e-13);
    assert!((factor(1) - 0.200_043_776_075_403).abs() < 1e-13);
    assert_eq!(factor(2), 0.0);
    assert!(rows.iter().all(|r| r["error"].as_f64().is_some_and(|e| (0.0..1e-11).contains(&e))));
    let stats = std::fs::read_to_string(folder.path("stats.json")).expect("statistics");
    assert!(stats.contains("\"pairs\": 3"), "{stats}");
}

#[test]
fn a_wrong_line_is_named_with_its_field() {
    let folder = Folder::new();
    let good = "{\"from\":[[0,0,0],[1,0,0],[0,1,0]],\"to\":[[0,0,1],[0,1,1],[1,0,1]]}\n";
    for (line, pieces) in [
        ("{\"from\":[[0,0,0],[1,0,0]],\"to\":[]}", ["line 2", "from", "2 different vertices"]),
        (
            "{\"from\":[[0,0,0],[1,0,0],[1,1,0.5],[0,1,0]],\"to\":[]}",
            ["line 2", "from", "split the polygon into triangles"],
        ),
        ("{\"from\":[[0,0,0],[1,0,0],[0,1,0]]}", ["line 2", "to", "a line looks like"]),
    ] {
        folder.write("pairs.jsonl", format!("{good}{line}\n"));
        folder.fails(&["radiosity", "factors", "pairs.jsonl"], 3, &pieces);
    }
    folder.fails(&["radiosity", "factors", "missing.jsonl"], 3, &["missing.jsonl"]);
    folder.fails(&["radiosity"], 2, &["SCENE"]);
}

#[test]
fn a_red_wall_reddens_the_floor() {
    let folder = corner();
    for form_factor in ["analytic", "hemicube", "hemicube-classic"] {
        let line =
            ["radiosity", "room.toml", "--patch", "0.5", "--form-factor", form_factor, "-o", "baked.json"];
        folder.prints(&line);
        let text = std::fs::read_to_string(folder.path("baked.json")).expect("light");
        let baked: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        let number = |list: &str, i: usize, k: usize| baked[list][i][k].as_f64().expect("a number");
        let count = baked["positions"].as_array().expect("vertices").len();
        let mut red_floor = 0;
        for i in 0..count {
            let on_floor_front = number("normals", i, 1) > 0.9;
            let [r, g] = [0, 1].map(|k| number("irradiance", i, k));
            if on_floor_front && r > 0.0 {
                // All that reaches the floor again comes from the wall, whose albedo is 0.8 and 0.1.
                assert!(r > 4.0 * g, "{form_factor}: {r} {g}");
                red_floor += 1;
            }
        }
        assert!(red_floor >= 25, "{form_factor}: {red_floor} of {count}");
    }
}

#[test]
fn render_takes_the_baked_light_and_refuses_that_of_other_triangles() {
    let folder = corner();
    let (bake, set) = (["radiosity", "room.toml", "-o", "baked.json"], "ambient.radiosity=\"baked.json\"");
    folder.fails(
        &["render", "room.toml", "--set", set, "-o", "a.exr"],
        3,
        &["baked.json", "pointillist radiosity"],
    );
    folder.prints(&bake);
    folder.prints(&["render", "room.toml", "-o", "direct.exr"]);
    folder.prints(&["render", "room.toml", "--set", set, "-o", "both.exr"]);
    let same = folder.command(&["compare", "direct.exr", "both.exr", "--max-rmse", "1e-3"]).output();
    assert_eq!(same.expect("it runs").status.code(), Some(5), "indirect light changes the picture");
    // A scene that names its own baked light can be baked again.
    folder.write("own.toml", format!("{SCENE}[ambient]\nradiosity = \"baked.json\"\n"));
    folder.prints(&["radiosity", "own.toml", "-o", "baked.json"]);
    folder.prints(&["check", "own.toml"]);
    folder.write("corner.obj", CORNER.replace("v 0 2 2", "v 0 3 2"));
    folder.fails(&["render", "own.toml", "-o", "b.exr"], 4, &["other triangles", "bake again"]);
    folder.write("baked.json", "{\"geometry\": 3}");
    folder.fails(&["render", "own.toml", "-o", "b.exr"], 3, &["geometry"]);
}

#[test]
fn methods_agree_and_factors_add_up() {
    let folder = corner();
    let irradiance = |method: &str| {
        let line =
            ["radiosity", "room.toml", "--patch", "0.5", "--method", method, "--factors", "F.csv", "-o", "-"];
        let baked: serde_json::Value = serde_json::from_str(&folder.prints(&line)).expect("JSON");
        let list = baked["irradiance"].as_array().expect("a list").clone();
        list.iter().flat_map(|v| v.as_array().expect("three").clone()).filter_map(|v| v.as_f64()).collect()
    };
    let (a, b): (Vec<f64>, Vec<f64>) = (irradiance("gauss-seidel"), irradiance("progressive"));
    let largest = a.iter().fold(0.0_f64, |m, v| m.max(*v));
    assert!(a.iter().zip(&b).all(|(x, y)| (x - y).abs() < 1e-5 * largest));
    let text = std::fs::read_to_string(folder.path("F.csv")).expect("factors");
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("i,j,F"));
    let total: f64 = lines.map(|l| l.rsplit(',').next().and_then(|f| f.parse().ok()).unwrap_or(2.0)).sum();
    // 16 patches of the floor and 16 of the wall; the squares' form factor is 0.2000 each way.
    assert!((total / 32.0 - 0.200_043_776).abs() < 1e-6, "{total}");
}

#[test]
fn impossible_light_is_refused_by_its_material() {
    let folder = corner();
    folder.write("bright.toml", SCENE.replace("[0.8, 0.1, 0.1]", "[1.8, 0.1, 0.1]"));
    folder.fails(&["radiosity", "bright.toml"], 3, &["material `red`", "1.8"]);
    folder.fails(&["radiosity", "room.toml", "-o", "light.txt"], 2, &[".json or .ply"]);
    folder.fails(&["radiosity", "room.toml", "--patch", "0.001"], 2, &["--max-patches"]);
    let clash = ["radiosity", "room.toml", "--form-factor", "hemicube", "--adaptive", "0.1"];
    folder.fails(&clash, 2, &["--adaptive"]);
}

#[test]
fn a_ply_holds_the_light_of_vertices() {
    let folder = corner();
    folder.prints(&["radiosity", "room.toml", "--adaptive", "0.05", "--patch", "0.5", "-o", "light.ply"]);
    let text = std::fs::read_to_string(folder.path("light.ply")).expect("a file");
    assert!(
        text.starts_with("ply\nformat ascii 1.0\n") && text.contains("property float radiosity_red"),
        "{text}"
    );
    folder.prints(&["info", "light.ply"]);
}

/// Between direct light and the solution nothing was said, for a minute.
#[cfg(unix)]
#[test]
fn ctrl_c_ends_a_bake_while_it_is_linking() {
    use std::io::{BufRead, BufReader};
    use std::process::{Command, Stdio};
    let folder = Folder::new();
    let house = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/house.toml");
    let mut bake = Command::new(assert_cmd::cargo::cargo_bin!("pointillist"));
    bake.current_dir(folder.path(".")).args(["radiosity", house, "-o", "baked.json", "--progress", "openjd"]);
    let mut bake = bake.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().expect("the command runs");
    let lines = BufReader::new(bake.stdout.take().expect("standard output")).lines();
    // Direct light takes the first two of a hundred, links those up to eighty.
    let told = lines.map_while(Result::ok).find_map(|line| {
        let percent: u32 = line.strip_prefix("openjd_progress: ")?.parse().ok()?;
        (percent >= 5).then_some(percent)
    });
    assert!(told.is_some_and(|percent| percent < 80), "linking says how far it is: {told:?}");
    let sent = Command::new("kill").args(["-INT", &bake.id().to_string()]).status();
    assert!(sent.expect("`kill` runs").success());
    assert_eq!(bake.wait().expect("it ends").code(), Some(130));
    assert_eq!(folder.names(), ["scene.toml", "triangle.obj"], "nothing half written is left");
}
