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

/// Light that was baked in an empty room serves it when something has come in, which is lit between probes.
#[test]
fn what_was_added_since_light_was_baked_is_lit_between_probes() {
    let folder = corner();
    folder.prints(&["radiosity", "room.toml", "-o", "baked.json"]);
    folder.prints(&["probe", "place", "room.toml", "--grid", "2x1x1", "-o", "two.json"]);
    folder.prints(&["probe", "bake", "room.toml", "two.json", "--resolution", "16", "-o", "probes.json"]);
    let [surfaces, between] = ["ambient.radiosity=baked.json", "ambient.probes=probes.json"];
    folder.prints(&["render", "room.toml", "--set", surfaces, "-o", "empty.exr"]);
    // Two copies are stored once, and their triangles are numbered after those of the corner; another guest's before.
    folder.write("guest.obj", "v 0 0 0\nv 0.2 0 0\nv 0 0.2 0\nusemtl blue\nf 1 2 3\n");
    let guest = |y: f64| format!("[[object]]\nmesh = \"guest.obj\"\ntranslate = [9, {y}, 9]\n");
    let alone = guest(0.0).replace("translate", "scale = 2\ntranslate");
    let blue = "[material.blue]\ndiffuse = [0.1, 0.1, 0.9]\n";
    let corner = "[[object]]\nmesh = \"corner.obj\"\n";
    let with_guests = alone + corner + &guest(1.0) + &guest(2.0);
    folder.write("guests.toml", SCENE.replace(corner, &with_guests) + blue);
    let line = ["render", "guests.toml", "--set", surfaces, "-o", "guests.exr"];
    folder.fails(&line, 4, &["other triangles", "were added since", "ambient.probes"]);
    let output = folder.command(&[&line[..], &["--set", between]].concat()).output().expect("it runs");
    let told = String::from_utf8(output.stderr).expect("text");
    assert!(output.status.success() && !told.contains("warning"), "{told}");
    // They are out of sight: the corner looks as it did without them.
    folder.prints(&["compare", "empty.exr", "guests.exr", "--max-rmse", "1e-7"]);
    let red = ["--set", "material.red.diffuse=[0.7,0.1,0.1]", "--set", between, "--overwrite"];
    let output = folder.command(&[&line[..], &red].concat()).output().expect("it runs");
    assert!(String::from_utf8(output.stderr).expect("text").contains("other lights or materials"));
    folder.prints(&["render", "guests.toml", "--set", between, "-o", "between.exr"]);
    // Probes alone take the place of radiosity.
    folder.write("corner.obj", CORNER.replace("v 0 2 2", "v 0 3 2"));
    folder.write("own.toml", format!("{SCENE}[ambient]\nradiosity = \"baked.json\"\n"));
    folder.prints(&["render", "own.toml", "--set", between, "-o", "own.exr"]);
    let both = ["check", "own.toml", "--set", surfaces, "--set", between];
    folder.fails(&both, 4, &["other triangles", "moved, changed or taken out", "bake again"]);
}

/// Who has baked light need not look up how it is used.
#[test]
fn how_baked_light_is_used_is_told_and_works() {
    let folder = corner();
    folder.prints(&["probe", "place", "room.toml", "--grid", "2x1x1", "-o", "two.json"]);
    for line in [
        &["radiosity", "room.toml", "-o", "baked.json"][..],
        &["probe", "bake", "room.toml", "two.json", "--resolution", "16", "-o", "probes.json"],
    ] {
        let output = folder.command(line).output().expect("it runs");
        let told = String::from_utf8(output.stderr).expect("text");
        let words =
            told.lines().find_map(|line| line.strip_prefix("draw with it: pointillist ")).expect(&told);
        folder.prints(&words.split(' ').chain(["-o", "lit.exr"]).collect::<Vec<_>>());
    }
    let ply = folder.command(&["radiosity", "room.toml", "-o", "baked.ply"]).output().expect("it runs");
    assert!(!String::from_utf8(ply.stderr).expect("text").contains("draw with it"));
}

/// Baked light of other lights or materials fits the triangles: it is drawn, and the user is told that it is old.
#[test]
fn light_of_other_materials_or_lights_is_drawn_with_a_warning() {
    let folder = corner();
    let named = format!("{SCENE}[ambient]\nradiosity = \"baked.json\"\n");
    let told = |scene: String, line: &[&str]| {
        folder.write("own.toml", scene);
        let output = folder.command(line).output().expect("it runs");
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(0), "{message}");
        message.contains("warning: `baked.json` was baked with other lights or materials; bake again")
    };
    let render = ["render", "own.toml", "--overwrite", "-o", "a.exr"];
    let red_wall = named.replace("[0.8, 0.1, 0.1]", "[0.1, 0.1, 0.8]");
    folder.write("own.toml", &named);
    folder.prints(&["radiosity", "own.toml", "-o", "baked.json"]);
    assert!(!told(named.clone(), &render));
    for changed in [&red_wall, &named.replace("[10, 10, 10]", "[10, 10, 9]")] {
        assert!(told(changed.clone(), &render) && told(changed.clone(), &["check", "own.toml"]));
    }
    // The camera and highlights are not what light was baked of.
    assert!(!told(named.replace("fov = 40", "fov = 30"), &render));
    folder.write("own.toml", &red_wall);
    folder.prints(&["radiosity", "own.toml", "-o", "baked.json"]);
    assert!(!told(red_wall, &render), "baked again");
}

#[test]
fn light_maps_are_light_that_is_known() {
    let folder = Folder::new();
    // A floor, and a wall at its side whose light is mapped: one half of the map is bright, and the wall lies in the dark half, or in the bright one.
    let mesh = |u: f64| {
        format!(
            "v 0 0 0\nv 2 0 0\nv 2 0 2\nv 0 0 2\nv 0 2 0\nv 0 2 2\nvt {u} 0\nvt {} 0\nvt {} 1\nvt {u} 1\n\
             usemtl floor\nf 1 4 3\nf 1 3 2\nusemtl wall\nf 1/1 5/4 6/3\nf 1/1 6/3 4/2\n",
            u + 0.25,
            u + 0.25
        )
    };
    super::common::square::picture(&folder, "light.png", 8, 8, |x, _| if x < 4 { [255; 3] } else { [0; 3] });
    let scene = |wall: &str, more: &str| {
        format!(
            "[[object]]\nmesh = \"corner.obj\"\n[material.floor]\ndiffuse = [0.5, 0.5, 0.5]\n[material.wall]\n{wall}\n{more}"
        )
    };
    let mapped = "diffuse = [0.8, 0.4, 0.2]\ncolor_space = \"linear\"\nlightmap = { file = \"light.png\", uv_set = 0 }";
    // What it reflects of light 1: its albedo, as radiance.
    let glowing = "diffuse = [0, 0, 0]\nemission = [0.8, 0.4, 0.2]";
    let bake = |u: f64, wall: &str, more: &str| {
        folder.write("corner.obj", mesh(u));
        folder.write("c.toml", scene(wall, more));
        let output =
            folder.command(&["radiosity", "c.toml", "--patch", "0.5", "-o", "-"]).output().expect("it runs");
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{told}");
        let baked: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
        let numbers =
            |v: &serde_json::Value| v.as_array().expect("three").iter().filter_map(|v| v.as_f64()).collect();
        let list =
            baked["irradiance"].as_array().expect("a list").iter().map(numbers).collect::<Vec<Vec<f64>>>();
        (list.concat(), told.contains("triangles have a lightmap"))
    };
    let (bright, told) = bake(0.125, mapped, "");
    assert!(!told, "without lights nothing is left out");
    let (known, _) = bake(0.125, glowing, "");
    assert!(known.iter().any(|&e| e > 0.1));
    assert!(bright.iter().zip(&known).all(|(a, b)| (a - b).abs() < 1e-6), "{bright:?} {known:?}");
    let (dark, _) = bake(0.625, mapped, "");
    assert!(dark.iter().all(|&e| e == 0.0), "{dark:?}");
    let lamp = "[[light]]\ntype = \"point\"\nposition = [1, 1.5, 1]\nintensity = [1, 1, 1]\n";
    assert!(bake(0.125, mapped, lamp).1, "lights are not passed on, which is told");
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

/// The two rooms of the guide, from a camera in the dark one.
fn from_the_dark_room() -> Folder {
    let folder = Folder::new();
    let book = |name: &str| {
        let path = format!("{}/../book/scenes/{name}", env!("CARGO_MANIFEST_DIR"));
        std::fs::read_to_string(path).expect("a file of the guide")
    };
    let scene = book("rooms.toml")
        .replace("eye = [-0.9, 1.5, 6.6]", "eye = [-0.3, 1.5, 1.7]")
        .replace("target = [-0.15, 1.15, 0]", "target = [-2.6, 0.9, -1.9]")
        .replace("fov = 36", "fov = 60");
    folder.write("rooms.obj", book("rooms.obj"));
    folder.write("rooms.toml", scene);
    folder
}

/// Number of links, and irradiance (three bands) of vertices of the dark room and of the lit one.
fn baked_rooms(folder: &Folder, tolerance: &str, more: &[&str]) -> (u64, [Vec<f64>; 2]) {
    let line = ["radiosity", "rooms.toml", "--patch", "0.5", "--tolerance", tolerance, "-o", "rooms.json"];
    folder.prints(&[&line, &["--stats", "stats.json"][..], more].concat());
    let read = |name: &str| -> serde_json::Value {
        let text = std::fs::read_to_string(folder.path(name)).expect("a file");
        serde_json::from_str(&text).expect("JSON")
    };
    let (baked, stats) = (read("rooms.json"), read("stats.json"));
    let mut rooms = [vec![], vec![]];
    let list = |name: &str| baked[name].as_array().expect("a list").clone();
    for (position, light) in list("positions").iter().zip(list("irradiance")) {
        // The wall between the rooms is at x = 0 and 0.1 thick.
        let x = position[0].as_f64().expect("a number");
        if x.abs() > 0.06 {
            rooms[usize::from(x > 0.0)].extend((0..3).map(|k| light[k].as_f64().expect("a number")));
        }
    }
    (stats["counts"]["links"].as_u64().expect("a count"), rooms)
}

#[test]
fn importance_spends_links_where_the_camera_sees_their_light() {
    let folder = from_the_dark_room();
    let (_, exact) = baked_rooms(&folder, "0.003", &["--links", "hierarchical"]);
    let error = |found: &[Vec<f64>; 2], room: usize| {
        let pairs = || found[room].iter().zip(&exact[room]);
        let squares: f64 = pairs().map(|(a, b)| (a - b) * (a - b)).sum();
        (squares / pairs().map(|(_, b)| b * b).sum::<f64>()).sqrt()
    };
    let (all, everywhere) = baked_rooms(&folder, "0.03", &["--links", "hierarchical"]);
    let (some, for_camera) = baked_rooms(&folder, "0.03", &["--importance"]);
    assert!(10 * some < 6 * all, "{some} of {all} links");
    let growth = |room: usize| error(&for_camera, room) / error(&everywhere, room);
    assert!(growth(0) < 2.0, "the dark room, in view: the error is {} times as large", growth(0));
    assert!(
        growth(1) > 2.0 * growth(0),
        "the lit room, out of view: {} times, in view {}",
        growth(1),
        growth(0)
    );
}

#[test]
fn importance_says_where_it_gains_nothing() {
    let folder = corner();
    let warning = |patch: &str| {
        let line = ["radiosity", "room.toml", "--importance", "-o", "room.json", "--patch", patch];
        let output = folder.command(&line).output().expect("it runs");
        assert!(output.status.success(), "{output:?}");
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let coarse = warning("2");
    assert!(coarse.contains("warning") && coarse.contains("--importance saves nothing"), "{coarse}");
    let fine = warning("0.2");
    assert!(!fine.contains("--importance"), "{fine}");
    folder.fails(
        &["radiosity", "room.toml", "--importance", "--links", "rays"],
        2,
        &["--importance", "groups"],
    );
    folder.fails(
        &["radiosity", "room.toml", "--importance", "--links", "full"],
        2,
        &["--importance", "groups"],
    );
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

#[test]
fn groups_of_many_surfaces_come_with_a_warning() {
    let folder = Folder::new();
    // Squares of one plane: no two of them see each other.
    let mut mesh = String::new();
    let count = 46;
    for i in 0..=count * count + 2 * count {
        mesh += &format!("v {} 0 {}\n", i % (count + 1), i / (count + 1));
    }
    for i in 0..count * count {
        let a = i / count * (count + 1) + i % count + 1;
        let (b, c, d) = (a + 1, a + count + 1, a + count + 2);
        mesh += &format!("f {a} {c} {b}\nf {b} {c} {d}\n");
    }
    folder.write("squares.obj", mesh);
    let said = |links: &str| {
        let line = ["radiosity", "squares.obj", "--patch", "100", "--links", links, "-o", "squares.json"];
        let output = folder.command(&line).output().expect("the command runs");
        assert!(output.status.success(), "{output:?}");
        String::from_utf8(output.stderr).expect("text")
    };
    let message = said("hierarchical");
    assert!(message.contains("pairs of 2116 surfaces"), "{message}");
    assert!(!said("rays").contains("pairs of"));
}
