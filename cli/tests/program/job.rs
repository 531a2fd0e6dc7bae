//! `job`: what templates hold, and that their tasks, run as a scheduler would, give the bytes of an undivided run.
//!
//! `.ci/openjd` checks and runs templates with the tools of Open Job Description. Its crate `openjd-model` asks for a newer compiler than this workspace.

use crate::common::{Folder, SCENE};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fs;

/// A template that was written as JSON.
fn template(folder: &Folder, line: &[&str]) -> Value {
    let (own, more) = line.split_at(line.iter().position(|word| *word == "--").unwrap_or(line.len()));
    folder.prints(&[&["job"], own, &["-o", "job.json", "--quiet"], more].concat());
    serde_json::from_slice(&fs::read(folder.path("job.json")).unwrap()).unwrap()
}

/// The numbers of a range such as `1-4`.
fn numbers(range: &str) -> Vec<u32> {
    let (first, last) = range.split_once('-').unwrap_or((range, range));
    (first.parse().unwrap()..=last.parse().unwrap()).collect()
}

/// Text with values in the place of `{{Param.X}}` and `{{Task.Param.X}}`.
fn filled(text: &str, values: &BTreeMap<String, String>) -> String {
    let mut text = text.to_owned();
    for (name, value) in values {
        text = text.replace(&format!("{{{{{name}}}}}"), value);
    }
    assert!(!text.contains("{{"), "{text} refers to nothing");
    text
}

/// Runs the tasks of all steps in their order, with other values for some parameters.
fn run(folder: &Folder, template: &Value, others: &[(&str, &str)]) {
    let text = |value: &Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
    let mut job: BTreeMap<String, String> = BTreeMap::new();
    for parameter in template["parameterDefinitions"].as_array().unwrap() {
        job.insert(format!("Param.{}", parameter["name"].as_str().unwrap()), text(&parameter["default"]));
    }
    for (name, value) in others {
        assert!(job.insert(format!("Param.{name}"), (*value).to_owned()).is_some(), "{name} is a parameter");
    }
    let mut done: Vec<&str> = vec![];
    for step in template["steps"].as_array().unwrap() {
        for dependency in step["dependencies"].as_array().into_iter().flatten() {
            assert!(done.contains(&dependency["dependsOn"].as_str().unwrap()));
        }
        let mut tasks = vec![job.clone()];
        for parameter in step["parameterSpace"]["taskParameterDefinitions"].as_array().into_iter().flatten() {
            assert_eq!(parameter["type"], "INT");
            let name = format!("Task.Param.{}", parameter["name"].as_str().unwrap());
            let range = numbers(&filled(parameter["range"].as_str().unwrap(), &job));
            let with = |task: &BTreeMap<_, _>, n: u32| {
                let mut task = task.clone();
                task.insert(name.clone(), n.to_string());
                task
            };
            tasks = tasks.iter().flat_map(|task| range.iter().map(move |&n| with(task, n))).collect();
        }
        let action = &step["script"]["actions"]["onRun"];
        assert_eq!(action["command"], "{{Param.Program}}");
        for task in tasks {
            let words: Vec<String> = action["args"]
                .as_array()
                .unwrap()
                .iter()
                .map(|word| filled(word.as_str().unwrap(), &task))
                .collect();
            let lines = folder.prints(&words.iter().map(String::as_str).collect::<Vec<_>>());
            assert!(lines.is_empty() || lines.contains("openjd_progress: 100"), "{words:?}: {lines}");
        }
        done.push(step["name"].as_str().unwrap());
    }
}

fn same(folder: &Folder, a: &str, b: &str) -> bool {
    fs::read(folder.path(a)).unwrap() == fs::read(folder.path(b)).unwrap()
}

const WALK: &str = "[camera.path]\ntimes = [0, 9]\neye = [[0, 0.5, 4], [2, 0.5, 4]]\n[image]";

#[test]
fn a_template_has_a_step_of_tiles_and_one_of_merges() {
    let folder = Folder::new();
    folder.write("walk.toml", SCENE.replace("[image]", WALK));
    let job = template(&folder, &["walk.toml", "--tiles", "3", "--frames", "2-4", "--", "--layers", "all"]);
    assert_eq!(job["specificationVersion"], "jobtemplate-2023-09");
    assert_eq!(job["name"], "walk");
    let parameters: BTreeMap<&str, &Value> = job["parameterDefinitions"]
        .as_array()
        .unwrap()
        .iter()
        .map(|parameter| (parameter["name"].as_str().unwrap(), &parameter["default"]))
        .collect();
    let wanted = json!({"Scene": "walk.toml", "Output": "walk.{frame:04}.exr", "Tiles": 3, "Frames": "2-4", "Program": "pointillist"});
    assert_eq!(json!(parameters), wanted);
    let names: Vec<&Value> = job["steps"].as_array().unwrap().iter().map(|step| &step["name"]).collect();
    assert_eq!(names, ["Tiles", "Merge"]);
    let [tiles, merge] = [0, 1].map(|i| &job["steps"][i]);
    assert_eq!(
        tiles["parameterSpace"]["taskParameterDefinitions"],
        json!([
            {"name": "Frame", "type": "INT", "range": "{{Param.Frames}}"},
            {"name": "Tile", "type": "INT", "range": "1-{{Param.Tiles}}"},
        ])
    );
    assert_eq!(merge["dependencies"], json!([{"dependsOn": "Tiles"}]));
    for step in [tiles, merge] {
        let run = &step["script"]["actions"]["onRun"];
        assert_eq!(run["cancelation"]["mode"], "NOTIFY_THEN_TERMINATE");
        let words = run["args"].as_array().unwrap();
        assert!(words.windows(2).any(|pair| pair == [json!("--progress"), json!("openjd")]));
    }
    run(&folder, &job, &[]);
    for frame in 2..=4 {
        let range = format!("{frame}-{frame}");
        folder.prints(&["render", "walk.toml", "--layers", "all", "--frames", &range, "-o", "whole.exr"]);
        assert!(same(&folder, &format!("walk.000{frame}.exr"), "whole.exr"), "{frame}");
    }
}

#[test]
fn parameters_may_be_changed_when_the_job_is_submitted() {
    let folder = Folder::new();
    folder.write("walk.toml", SCENE.replace("[image]", WALK));
    let job = template(&folder, &["walk.toml", "--frames", "0-99"]);
    run(&folder, &job, &[("Tiles", "2"), ("Frames", "7"), ("Output", "other.{frame}.exr")]);
    folder.prints(&["render", "walk.toml", "--frames", "7-7", "-o", "whole.exr"]);
    assert!(same(&folder, "other.7.exr", "whole.exr"));
}

#[test]
fn a_png_of_a_farm_has_the_bytes_of_an_undivided_one() {
    let folder = Folder::new();
    let more = ["--size", "24x16", "--set", "image.background=[0.2, 0.3, 0.4]", "--exposure", "0.7"];
    let line = [&["scene.toml", "--tiles", "2", "--result", "a.png", "--"], &more[..]].concat();
    let job = template(&folder, &line);
    let frames = &job["parameterDefinitions"][3];
    assert_eq!((&frames["default"], &frames["allowedValues"]), (&json!("0"), &json!(["0"])));
    run(&folder, &job, &[]);
    folder.prints(&[&["render", "scene.toml", "-o", "whole.png"], &more[..]].concat());
    assert!(same(&folder, "a.png", "whole.png"));
}

#[test]
fn a_turntable_is_a_job_of_its_views() {
    let folder = Folder::new();
    let more = ["--turntable", "3", "--size", "24x16"];
    let job = template(&folder, &[&["triangle.obj", "--tiles", "2", "--"], &more[..]].concat());
    run(&folder, &job, &[]);
    folder.prints(&[&["render", "triangle.obj", "-o", "whole.{frame}.exr"], &more[..]].concat());
    for frame in 0..3 {
        assert!(same(&folder, &format!("triangle.000{frame}.exr"), &format!("whole.{frame}.exr")));
    }
}

#[test]
fn probes_are_baked_in_parts_and_merged() {
    let folder = Folder::new();
    folder.write(
        "probes.json",
        r#"{"probes":[{"position":[0,0,2]},{"position":[1,0,2]},{"position":[0,1,2]}]}"#,
    );
    let more = ["--resolution", "4", "--inside", "keep"];
    let job = template(
        &folder,
        &[&["scene.toml", "--probes", "probes.json", "--tiles", "2", "--"], &more[..]].concat(),
    );
    assert_eq!(job["steps"][0]["name"], "Parts");
    run(&folder, &job, &[("Parts", "3")]);
    let whole = ["probe", "bake", "scene.toml", "probes.json", "--bounces", "0", "-o", "whole.json"];
    folder.prints(&[&whole[..], &more[..]].concat());
    assert!(same(&folder, "baked.json", "whole.json"));
}

#[test]
fn yaml_is_the_same_template() {
    let folder = Folder::new();
    let yaml = folder.prints(&["job", "scene.toml", "--tiles", "2"]);
    assert!(yaml.starts_with("specificationVersion: \"jobtemplate-2023-09\"\nname: \"scene\"\nparameterDefinitions:\n  - name: \"Scene\"\n"));
    folder.prints(&["job", "scene.toml", "--tiles", "2", "-o", "job.yaml"]);
    assert_eq!(fs::read_to_string(folder.path("job.yaml")).unwrap(), yaml);
    // Every word of the JSON is there, in the same order.
    let json = serde_json::to_string(&template(&folder, &["scene.toml", "--tiles", "2"])).unwrap();
    assert_eq!(yaml.matches("{{").count(), json.matches("{{").count());
}

#[test]
fn files_outside_of_the_template_s_folder_are_named_in_full() {
    let folder = Folder::new();
    fs::create_dir(folder.path("jobs")).unwrap();
    folder.prints(&["job", "scene.toml", "-o", "jobs/job.json"]);
    let job: Value = serde_json::from_slice(&fs::read(folder.path("jobs/job.json")).unwrap()).unwrap();
    let scene = job["parameterDefinitions"][0]["default"].as_str().unwrap();
    assert_eq!(fs::canonicalize(scene).unwrap(), fs::canonicalize(folder.path("scene.toml")).unwrap());
    assert!(std::path::Path::new(scene).is_absolute());
    // The result is beside the template.
    assert_eq!(job["parameterDefinitions"][1]["default"], "scene.exr");
}

#[test]
fn jobs_that_would_fail_are_refused() {
    let folder = Folder::new();
    let fails =
        |line: &[&str], code: i32, pieces: &[&str]| folder.fails(&[&["job"], line].concat(), code, pieces);
    fails(&["gone.toml"], 3, &["gone.toml"]);
    fails(&["-"], 2, &["from files"]);
    fails(&["scene.toml", "-o", "job.txt"], 2, &["`job.txt`", ".json or .yaml"]);
    fails(&["scene.toml", "-o", "no/job.json"], 1, &["no/job.json cannot be written"]);
    fails(&["scene.toml", "--tiles", "0"], 2, &["--tiles"]);
    fails(&["scene.toml", "--tiles", "13"], 2, &["--tiles 13", "12 rows"]);
    fails(
        &["scene.toml", "--frames", "0-4", "--result", "a.exr"],
        2,
        &["--result a.exr", "a.{frame:04}.exr"],
    );
    fails(&["scene.toml", "--result", "a.{frame}.exr"], 2, &["{frame} is for --frames"]);
    fails(&["scene.toml", "--result", "a.gif"], 2, &["a.gif"]);
    fails(&["scene.toml", "--result", "a.png", "--", "--layers", "all"], 2, &["--layers"]);
    for option in [
        &["--tile", "0/2"][..],
        &["--frames", "1-2"],
        &["-o", "a.exr"],
        &["--stats", "s"],
        &["--progress", "none"],
    ] {
        fails(&[&["scene.toml", "--"], option].concat(), 2, &["options for `render`", option[0]]);
    }
    fails(&["scene.toml", "--", "--fob", "3"], 2, &["options for `render`", "--fob"]);
    fails(&["scene.toml", "--", "--set", "a={{Param.X}}"], 2, &["begins the name of a parameter"]);
    fails(&["scene.toml", "--probes", "gone.json"], 3, &["gone.json"]);
    folder.write("probes.json", r#"{"probes":[{"position":[0,0,2]}]}"#);
    fails(&["scene.toml", "--probes", "probes.json"], 2, &["--tiles 4", "only 1 probes"]);
    fails(
        &["scene.toml", "--probes", "probes.json", "--tiles", "1", "--", "--bounces", "2"],
        2,
        &["--bounces"],
    );
    assert_eq!(folder.names(), ["probes.json", "scene.toml", "triangle.obj"]);
}

#[test]
fn merge_takes_the_pattern_of_its_parts() {
    let folder = Folder::new();
    for tile in ["1of2", "2of2"] {
        folder.prints(&["render", "scene.toml", "--tile", tile, "-o", &format!("p{}.exr", &tile[..1])]);
    }
    folder.prints(&["merge", "p{tile}.exr", "--tiles", "2", "-o", "a.exr"]);
    folder.prints(&["render", "scene.toml", "-o", "whole.exr"]);
    assert!(same(&folder, "a.exr", "whole.exr"));
    folder.fails(&["merge", "p{tile}.exr", "--tiles", "3", "-o", "b.exr"], 4, &["p3.exr is missing"]);
    folder.fails(&["merge", "p{tile}.exr", "-o", "b.exr"], 2, &["{tile} needs --tiles N"]);
    folder.fails(&["merge", "p1.exr", "--tiles", "2", "-o", "b.exr"], 2, &["there is no such name"]);
    folder.fails(&["merge", "p1.exr", "p2.exr", "-o", "b.{frame}.exr"], 2, &["{frame} needs --frame N"]);
    folder.prints(&["merge", "p1.exr", "p2.exr", "--frame", "5", "-o", "b.{frame:02}.exr"]);
    assert!(same(&folder, "b.05.exr", "whole.exr"));
    for wrong in ["0of2", "3of2", "1of", "of2", "1of0"] {
        folder.fails(&["render", "scene.toml", "--tile", wrong, "-o", "c.exr"], 2, &["--tile"]);
    }
}
