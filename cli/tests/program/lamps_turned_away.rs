//! Lamps that shine on one side are warned of if all of the scene is on the other.

use crate::common::square::{VIEW, folder, pixels, warnings};

fn said(light: &str, more: &str) -> String {
    let folder = folder();
    let object = "[[object]]\nmesh = \"square.obj\"\nmaterial = \"m\"\n";
    folder.write(
        "m.toml",
        format!("{VIEW}{object}{more}[[light]]\n{light}[material.m]\ndiffuse = [1, 1, 1]\n"),
    );
    warnings(&folder, "m.toml")
}

fn rect(z: f64, [u, v]: [&str; 2]) -> String {
    let edges = format!("edge_u = {u}\nedge_v = {v}\nradiance = [1, 1, 1]\n");
    format!("type = \"rect\"\nposition = [0, 0, {z}]\n{edges}")
}

const X: &str = "[1, 0, 0]";
const Y: &str = "[0, 1, 0]";

#[test]
fn a_rectangle_that_faces_away_from_all_is_warned_of() {
    // x × y = z: away from the square, which is behind it.
    let text = said(&rect(2.0, [X, Y]), "");
    for piece in ["m.toml:14", "`light[0]` lights nothing", "`edge_u × edge_v`", "swap"] {
        assert!(text.contains(piece), "{piece} is missing in {text}");
    }
    assert!(!said(&rect(2.0, [Y, X]), "").contains("lights nothing"));
    assert!(!said(&rect(-2.0, [X, Y]), "").contains("lights nothing"));
    // In the plane of the square, of which it lights nothing, but for rounding.
    assert!(said(&rect(0.0, [X, Y]), "").contains("lights nothing"));
}

#[test]
fn what_is_warned_of_is_black_and_turned_round_it_is_not() {
    for (edges, is_lit) in [([X, Y], false), ([Y, X], true)] {
        let folder = folder();
        let object =
            "[[object]]\nmesh = \"square.obj\"\nmaterial = \"m\"\n[material.m]\ndiffuse = [1, 1, 1]\n";
        folder.write("m.toml", format!("{VIEW}{object}[[light]]\n{}", rect(2.0, edges)));
        assert_eq!(pixels(&folder, "m.toml").iter().any(|p| p[0] > 0.0), is_lit, "{edges:?}");
    }
}

#[test]
fn a_polygon_is_warned_of_unless_both_its_sides_shine() {
    let polygon = "type = \"polygon\"\nvertices = [[0, 0, 2], [1, 0, 2], [0, 1, 2]]\nradiance = [1, 1, 1]\n";
    let text = said(polygon, "");
    assert!(text.contains("`light[0]` lights nothing") && text.contains("two_sided = true"), "{text}");
    assert!(!said(&format!("{polygon}two_sided = true\n"), "").contains("lights nothing"));
}

#[test]
fn what_is_in_front_or_moves_there_keeps_it_quiet() {
    let other = |rest: &str| format!("[[object]]\nmesh = \"square.obj\"\nmaterial = \"m\"\n{rest}");
    let light = rect(2.0, [X, Y]);
    assert!(!said(&light, &other("translate = [0, 0, 3]\n")).contains("lights nothing"));
    let moving = other("path = { times = [0, 1], translate = [[0, 0, 0], [0, 0, 3]] }\n");
    assert!(!said(&light, &moving).contains("lights nothing"));
}
