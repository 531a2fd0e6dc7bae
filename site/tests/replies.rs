//! What the page's requests give, checked against what is known of the answers. `.ci/site` checks that the browser gets the same.

use pointillist_site::{Reply, Site};

fn ask(site: &mut Site, request: &str) -> Reply {
    let reply = site.answer(request.as_bytes());
    assert!(!reply.facts().starts_with("error"), "{request}: {}", reply.facts());
    reply
}

fn error(request: &[u8]) -> String {
    let reply = Site::new().answer(request);
    reply.facts().strip_prefix("error ").expect("the request is wrong").to_string()
}

fn number(reply: &Reply, name: &str) -> f64 {
    reply.numbers(name).expect("the fact is there")[0]
}

#[test]
fn cells_of_a_polygon_add_up_to_its_area() {
    // A triangle of 6 cells that reaches beyond the grid: 2 of its 6 are left of it.
    let reply = ask(&mut Site::new(), "polygon 8 8 even-odd -1 1 3 1 -1 4");
    let areas = reply.numbers("areas").expect("areas are there");
    assert_eq!(areas.len(), 64);
    assert!((areas.iter().sum::<f64>() - number(&reply, "inside")).abs() < 1e-13);
    assert!((number(&reply, "inside") - (6.0 - 0.5 * (3.0 + 2.25))).abs() < 1e-13);
    assert_eq!(number(&reply, "whole"), 6.0);
}

#[test]
fn the_middle_of_a_star_is_inside_by_one_rule_only() {
    let star = "4 0 6 6 0 2 8 2 2 6";
    let area = |rule: &str| number(&ask(&mut Site::new(), &format!("polygon 8 6 {rule} {star}")), "sum");
    assert!(area("non-zero") > area("even-odd") + 3.0);
}

#[test]
fn what_is_wrong_with_a_request_is_said() {
    assert!(error(b"").contains("no request"));
    assert!(error(b"\xff\xfe").contains("no request"));
    assert!(error(b"polygon 8 six even-odd").contains("`rows`"));
    assert!(error(b"polygon 8 6 odd").contains("even-odd or non-zero"));
    assert!(error(b"polygon 8 6 even-odd 1 1 2 NaN").contains("finite number"));
    assert!(error(b"surfels 1000").contains("`model` comes first"));
    assert!(error(b"model none.obj\nv 0 0\n").contains("none.obj"));
    assert!(error(b"model none.obj\n").contains("no surface"));
    assert!(error(b"model far.obj\nv 0 0 0\nv 1e30 0 0\nv 0 1 0\nf 1 2 3\n").contains("vertex 1"));
    let ply = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n";
    let of_ply = |text: String| error(format!("model a.ply\n{text}").as_bytes());
    for corners in ["3 0 1 7", "3 0 1 -1"] {
        assert!(
            of_ply(format!("{ply}{corners}\n"))
                .contains("triangle 0 (from 0) names a vertex that is not there")
        );
    }
    assert!(
        of_ply(ply.replace("vertex 2", "vertex 4000000000")).contains("announced, but the file has only")
    );
    assert!(of_ply(ply.replace("float z", "float w")).contains("no element `vertex` with x, y and z"));
}

#[test]
fn surfels_focus_where_they_are_told_to() {
    let mut site = Site::new();
    assert_eq!(number(&ask(&mut site, "model rabbit"), "triangles"), 6760.0);
    assert!((number(&ask(&mut site, "surfels 20000"), "points") - 20_000.0).abs() < 1000.0);
    let frame = |site: &mut Site, lens: &str| {
        ask(site, &format!("surfels-frame 96 96 0.2 0.1 0.3 0 0.08 0 {lens} 255 255 255")).pixels().to_vec()
    };
    let sharp = frame(&mut site, "0 0.3");
    // In the middle of the picture: the rabbit's side, about half its width nearer than what the camera looks at.
    let depth = number(&ask(&mut site, "surfels-depth 48 48"), "depth");
    assert!((0.28..0.38).contains(&depth), "{depth}");
    let off = |pixels: &[u8]| {
        let differences = pixels.iter().zip(&sharp).map(|(a, b)| u64::from(a.abs_diff(*b)));
        differences.sum::<u64>()
    };
    let (focused, blurred) = (frame(&mut site, &format!("0.01 {depth}")), frame(&mut site, "0.01 0.15"));
    assert!(0 < off(&focused) && 2 * off(&focused) < off(&blurred));
    assert_eq!(number(&ask(&mut site, "surfels-depth 0 0"), "depth"), f64::INFINITY);
}

#[test]
fn noise_of_scans_is_noise_of_pictures_and_gamma_is_what_removes_it() {
    let mut site = Site::new();
    ask(&mut site, "model rabbit");
    let mut frame = |noise: f64, gamma: f64| {
        let made = ask(&mut site, &format!("scans 60 {noise}"));
        let picture =
            ask(&mut site, &format!("scans-frame 96 96 0.2 0.1 0.3 0 0.08 0 surface {gamma} 255 255 255"));
        (number(&made, "points"), picture.pixels().to_vec())
    };
    let (points, clean) = frame(0.0, 2.0);
    assert!((8000.0..40_000.0).contains(&points));
    let off = |pixels: &[u8]| clean.iter().zip(pixels).map(|(a, b)| u64::from(a.abs_diff(*b))).sum::<u64>();
    let (points_of_noisy, wide) = frame(1.0, 3.0);
    assert_eq!(points, points_of_noisy);
    let (_, narrow) = frame(1.0, 0.3);
    assert!(off(&wide) > 0 && off(&narrow) > off(&wide), "{} {}", off(&narrow), off(&wide));
}

#[test]
fn light_passes_the_door_and_not_the_wall() {
    let mut site = Site::new();
    let rooms = ask(&mut site, "rooms 40 20 255 255 255");
    let probes = rooms.numbers("probes").expect("probes are there");
    let wall = rooms.numbers("wall").expect("the wall is there");
    let mut ball = |x: f64, z: f64, sight: &str| {
        let reply = ask(&mut site, &format!("ball {x} 0.5 {z} {sight} 16 0 0 0"));
        let shares = reply.numbers("shares").expect("shares are there");
        let sum: f64 = shares.chunks(2).map(|share| share[1]).sum();
        assert!((sum - 1.0).abs() < 1e-9);
        let is_beyond = |probe: f64| probes[3 * probe as usize] < wall[0];
        let beyond: f64 = shares.chunks(2).filter(|s| is_beyond(s[0])).map(|s| s[1]).sum();
        (beyond, number(&reply, "light"))
    };
    // On the dark side of the wall, far from the door: nothing of the bright room.
    let (seen, blind) = (ball(4.22, 0.4, "seen"), ball(4.22, 0.4, "blind"));
    assert!(seen.0 < 1e-3 && blind.0 > 0.1, "{seen:?} {blind:?}");
    assert!(blind.1 > 3.0 * seen.1, "{seen:?} {blind:?}");
    // In the door it is brighter than there, and darker than under the lamp.
    let (door, lamp) = (ball(4.2, 3.05, "seen").1, ball(2.0, 2.0, "seen").1);
    assert!(3.0 * seen.1 < door && door < lamp, "{door} {lamp}");
}
