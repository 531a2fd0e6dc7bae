//! `--layers cryptomatte`, decoded as other programs do: names to ids by the manifest, ids to coverage by the ranks.

use crate::common::Folder;
use pointillist_cli::image_io::ExrFile;
use serde_json::Value;
use std::fs;

/// A red card before a wider one that is half transparent, before a wall that fills the picture.
const SCENE: &str = r#"[camera]
eye = [0, 0, 10]
target = [0, 0, 0]
height = 2
[image]
size = [12, 12]
[[object]]
name = "card"
mesh = "square.obj"
scale = 0.31
translate = [0.13, 0.07, 2]
material = "red"
[[object]]
name = "стекло"
mesh = "square.obj"
scale = 0.63
translate = [0.05, 0, 1]
material = "glass"
[[object]]
name = "wall"
mesh = "square.obj"
scale = 3
material = "red"
[material.red]
diffuse = [0.8, 0.1, 0.1]
[material.glass]
opacity = 0.5
"#;

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("square.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n");
    folder.write("cards.toml", SCENE);
    folder
}

fn read(folder: &Folder, name: &str) -> ExrFile {
    ExrFile::read(&fs::read(folder.path(name)).unwrap()).unwrap()
}

/// The coverage of a name in every pixel, by the text of the header alone.
fn coverage(file: &ExrFile, layer: &str, name: &str) -> Vec<f32> {
    let text = |end: &str, key: &str| &file.texts[&format!("{}/{end}", key.rsplit_once('/').unwrap().0)];
    let is_name = |(key, value): &(&String, &String)| key.ends_with("/name") && *value == layer;
    let (key, _) = file.texts.iter().find(is_name).expect("the layer is in the header");
    assert_eq!(
        (text("hash", key).as_str(), text("conversion", key).as_str()),
        ("MurmurHash3_32", "uint32_to_float32")
    );
    let manifest: Value = serde_json::from_str(text("manifest", key)).unwrap();
    let bits =
        u32::from_str_radix(manifest[name].as_str().expect("the name is in the manifest"), 16).unwrap();
    let mut sums = vec![0.0; file.window.pixels() as usize];
    for level in 0..3 {
        for (id, cover) in [("R", "G"), ("B", "A")] {
            let [ids, covers] = [id, cover].map(|c| file.plane(&format!("{layer}{level:02}.{c}")).unwrap());
            for (sum, (id, cover)) in sums.iter_mut().zip(ids.iter().zip(&covers)) {
                if id.to_bits() == bits {
                    *sum += cover;
                }
            }
        }
    }
    sums
}

/// How much of a pixel a square covers.
fn square(pixel: usize, [x, y]: [f64; 2], half: f64) -> f64 {
    let overlap = |cell: f64, middle: f64| {
        let low = (-1.0 + cell / 6.0).max(middle - half);
        let high = (-1.0 + (cell + 1.0) / 6.0).min(middle + half);
        (high - low).max(0.0) * 6.0
    };
    overlap((pixel % 12) as f64, x) * overlap(11.0 - (pixel / 12) as f64, y)
}

#[test]
fn coverage_of_objects_and_materials_is_exact() {
    let folder = folder();
    folder.prints(&["render", "cards.toml", "--layers", "cryptomatte", "-o", "m.exr"]);
    let file = read(&folder, "m.exr");
    let of = |name: &str| coverage(&file, "CryptoObject", name);
    let (card, glass, wall) = (of("card"), of("стекло"), of("wall"));
    let [red, clear] = ["red", "glass"].map(|name| coverage(&file, "CryptoMaterial", name));
    let close = |found: f32, wanted: f64| (f64::from(found) - wanted).abs() < 1e-5;
    for pixel in 0..144 {
        let front = square(pixel, [0.13, 0.07], 0.31);
        // The card lies within the glass: what the glass covers beside it is half seen through.
        let behind = square(pixel, [0.05, 0.0], 0.63) - front;
        assert!(close(card[pixel], front), "{pixel}: {} {front}", card[pixel]);
        assert!(close(glass[pixel], 0.5 * behind), "{pixel}: {} {behind}", glass[pixel]);
        assert!(close(wall[pixel], 1.0 - front - 0.5 * behind), "{pixel}: {}", wall[pixel]);
        assert!(close(red[pixel], 1.0 - 0.5 * behind) && close(clear[pixel], 0.5 * behind), "{pixel}");
    }
    // Somewhere on an edge, in the middle of both, and the largest coverage is the first of its pixel.
    assert!(card.iter().any(|&c| c > 0.1 && c < 0.9) && card.contains(&1.0));
    let [first, second] = ["G", "A"].map(|c| file.plane(&format!("CryptoObject00.{c}")).unwrap());
    assert!(first.iter().zip(&second).all(|(a, b)| a >= b) && second.iter().any(|&b| b > 0.0));
}

#[test]
fn the_header_is_that_of_the_specification() {
    let folder = folder();
    folder.prints(&["render", "cards.toml", "--layers", "cryptomatte.material,id", "-o", "m.exr"]);
    let file = read(&folder, "m.exr");
    assert_eq!(file.texts.len(), 4);
    assert!(file.channels.iter().all(|channel| !channel.name.starts_with("CryptoObject")));
    let keys: Vec<&str> = file.texts.keys().map(|key| key.split('/').nth(1).unwrap()).collect();
    let hash = format!("{:08x}", pointillist_render::cryptomatte_hash("CryptoMaterial"));
    assert!(keys.iter().all(|key| *key == &hash[..7]), "{keys:?}");
    for line in [["--layers", "all"], ["--layers", "N"]] {
        folder.prints(&[&["render", "cards.toml", "-o", "n.exr"][..], &line].concat());
        assert!(read(&folder, "n.exr").texts.is_empty());
    }
    folder.fails(
        &["render", "cards.toml", "--layers", "cryptomat", "-o", "n.exr"],
        2,
        &["cryptomatte.object"],
    );
    folder.fails(&["render", "cards.toml", "--layers", "cryptomatte", "-o", "n.png"], 2, &[".exr"]);
}

#[test]
fn tiles_join_to_the_same_bytes_with_names_and_all() {
    let folder = folder();
    let line = ["render", "cards.toml", "--layers", "cryptomatte,albedo", "-o"];
    folder.prints(&[&line[..], &["whole.exr"]].concat());
    folder.prints(&[&line[..], &["again.exr"]].concat());
    for (tile, name) in [("0/2", "a.exr"), ("1/2", "b.exr")] {
        folder.prints(&[&line[..], &[name, "--tile", tile]].concat());
    }
    folder.prints(&["merge", "a.exr", "b.exr", "-o", "merged.exr"]);
    let [whole, again, merged] =
        ["whole.exr", "again.exr", "merged.exr"].map(|name| fs::read(folder.path(name)).unwrap());
    assert!(whole == again, "the same picture has the same bytes");
    assert!(whole == merged, "joined tiles have the bytes of the whole");
}
