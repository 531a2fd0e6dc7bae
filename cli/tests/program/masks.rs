//! Masks of opacity over maps of colour: every layer of every picture is a picture.

use crate::common::Folder;
use pointillist_cli::image_io::ExrFile;
use proptest::prelude::*;

/// A card: where it is, how it is turned about y, and its size.
#[derive(Clone, Debug)]
struct Card {
    place: [f64; 3],
    turn: f64,
    size: f64,
}

/// Texels of a mask and of a map of colour, row by row.
#[derive(Clone, Debug)]
struct Maps {
    side: u32,
    mask: Vec<u8>,
    color: Vec<[u8; 3]>,
}

fn maps() -> impl Strategy<Value = Maps> {
    // Mostly holes and leaves, as masks are; some of them nearly so.
    let opacity = prop_oneof![4 => Just(0u8), 4 => Just(255u8), 1 => any::<u8>()];
    prop_oneof![Just(1u32), Just(3), Just(8), Just(16)].prop_flat_map(move |side| {
        let texels = (side * side) as usize;
        let color = prop::collection::vec([20..200u8, 20..200u8, 20..200u8], texels);
        (prop::collection::vec(opacity.clone(), texels), color).prop_map(move |(mask, color)| Maps {
            side,
            mask,
            color,
        })
    })
}

fn card() -> impl Strategy<Value = Card> {
    ([-1.0..1.0f64, -1.0..1.0, -1.0..1.0], -180.0..180.0f64, 0.2..2.0f64)
        .prop_map(|(place, turn, size)| Card { place, turn, size })
}

fn write_scene(folder: &Folder, maps: &Maps, cards: &[Card]) {
    let flat = |rgb: &[[u8; 3]]| rgb.iter().flatten().copied().collect::<Vec<u8>>();
    let save = |name: &str, bytes: Vec<u8>| {
        let image = image::RgbImage::from_raw(maps.side, maps.side, bytes).expect("all texels");
        image.save(folder.path(name)).expect("a picture");
    };
    save("color.png", flat(&maps.color));
    save("mask.png", flat(&maps.mask.iter().map(|&v| [v; 3]).collect::<Vec<_>>()));
    folder.write(
        "card.obj",
        "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 2 0\nvt 2 2\nvt 0 2\nf 1/1 2/2 3/3 4/4\n",
    );
    let mut scene = String::from(
        "[camera]\neye = [0.3, 1, 5]\ntarget = [0, 0, 0]\nfov = 35\n[image]\nsize = [14, 12]\n\
         [[light]]\nname = \"sun\"\ntype = \"directional\"\ndirection = [-0.4, -1, -0.7]\nirradiance = [3, 3, 3]\n\
         [ambient]\ncolor = [0.2, 0.2, 0.3]\n\
         [material.leaf]\ndiffuse = [1, 1, 1]\ndiffuse_map = \"color.png\"\nopacity_map = \"mask.png\"\n",
    );
    for Card { place, turn, size } in cards {
        scene += &format!(
            "[[object]]\nmesh = \"card.obj\"\nmaterial = \"leaf\"\ntranslate = {place:?}\nrotate = [0, {turn:?}, 0]\nscale = {size:?}\n"
        );
    }
    folder.write("cards.toml", scene);
}

fn linear(srgb: u8) -> f32 {
    let v = f32::from(srgb) / 255.0;
    if v <= 0.040_45 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}

proptest! {
    #![proptest_config(testkit::config(24))]

    #[test]
    fn every_layer_is_finite_and_not_negative_and_albedo_is_that_of_texels(m in maps(), cards in prop::collection::vec(card(), 1..6), twice: bool) {
        let folder = Folder::new();
        // Leaves of trees often come as two cards back to back.
        let cards = if twice { [cards.clone(), cards].concat() } else { cards };
        write_scene(&folder, &m, &cards);
        folder.prints(&["render", "cards.toml", "-o", "m.exr", "--float", "--layers", "all", "--quiet"]);
        let file = ExrFile::read(&std::fs::read(folder.path("m.exr")).unwrap()).unwrap();
        for channel in &file.channels {
            let name = channel.name.as_str();
            let plane = file.plane(name).unwrap();
            let signed = name.starts_with("N.") || name.starts_with("P.");
            for (i, &v) in plane.iter().enumerate() {
                // Depth is infinite where nothing is seen.
                prop_assert!(!v.is_nan() && (v.is_finite() || name == "Z"), "{name}, pixel {i}: {v}");
                prop_assert!(signed || v >= 0.0, "{name}, pixel {i}: {v}");
            }
        }
        let coverage = file.plane("A").unwrap();
        for (band, name) in ["albedo.R", "albedo.G", "albedo.B"].into_iter().enumerate() {
            let texels = || m.color.iter().map(|t| linear(t[band]));
            let (least, most) = (texels().fold(f32::INFINITY, f32::min), texels().fold(0.0, f32::max));
            for (i, (albedo, covered)) in file.plane(name).unwrap().into_iter().zip(&coverage).enumerate() {
                // Layers are premultiplied. 1e-5: sums of single precision.
                let within = albedo >= least * covered - 1e-5 && albedo <= most * covered + 1e-5;
                prop_assert!(within, "{name}, pixel {i}: {albedo} of coverage {covered} is not from {least} to {most}");
            }
        }
    }
}
