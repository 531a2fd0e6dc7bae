//! glTF as a scene and as a mesh, made by code; and what is wrong with broken ones.

use crate::common::Folder;
use pointillist_cli::image_io::ExrFile;
use pointillist_cli::mesh_io::gltf::read_gltf;
use proptest::prelude::*;
use serde_json::{Value, json};

const PI: f32 = std::f32::consts::PI;

/// A square of two by two in the plane z = 0 as floats (positions, coordinates), then its indices.
fn square() -> Vec<u8> {
    let positions = [[-1.0f32, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
    // glTF's v runs downward: the lower left corner has v = 1.
    let uvs = [[0.0f32, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];
    let mut bytes: Vec<u8> = positions.iter().flatten().flat_map(|n| n.to_le_bytes()).collect();
    bytes.extend(uvs.iter().flatten().flat_map(|n| n.to_le_bytes()));
    bytes.extend([0u16, 1, 2, 0, 2, 3].iter().flat_map(|n| n.to_le_bytes()));
    bytes
}

/// A picture of two by two: red, green above and blue, clear white below.
fn png() -> Vec<u8> {
    let texels = vec![255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255, 255, 255, 0];
    let image = image::RgbaImage::from_raw(2, 2, texels).unwrap();
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// A document of the square with one material, seen by its own camera from z = 4; the buffer is left to the caller.
fn document(material: Value) -> Value {
    json!({
        "asset": { "version": "2.0" },
        "extensionsUsed": ["KHR_lights_punctual"],
        "scene": 0,
        "scenes": [{ "nodes": [0, 1, 2] }],
        "nodes": [
            { "mesh": 0 },
            { "camera": 0, "translation": [0, 0, 4] },
            { "translation": [0, 0, 2], "extensions": { "KHR_lights_punctual": { "light": 0 } } }
        ],
        "cameras": [{ "type": "orthographic", "orthographic": { "xmag": 1, "ymag": 1, "znear": 0.1, "zfar": 9 } }],
        "extensions": { "KHR_lights_punctual": { "lights": [
            { "type": "directional", "color": [1, 1, 1], "intensity": 2, "name": "sun" }
        ] } },
        "meshes": [{ "primitives": [{
            "attributes": { "POSITION": 0, "TEXCOORD_0": 1 }, "indices": 2, "material": 0
        }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [-1, -1, 0], "max": [1, 1, 0] },
            { "bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2" },
            { "bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR" }
        ],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": 48 },
            { "buffer": 0, "byteOffset": 48, "byteLength": 32 },
            { "buffer": 0, "byteOffset": 80, "byteLength": 12 },
            { "buffer": 0, "byteOffset": 92, "byteLength": png().len() }
        ],
        "images": [{ "bufferView": 3, "mimeType": "image/png" }],
        "samplers": [{ "magFilter": 9728, "wrapS": 33071, "wrapT": 33071 }],
        "textures": [{ "source": 0, "sampler": 0 }],
        "buffers": [{ "byteLength": 92 + png().len() }],
        "materials": [material]
    })
}

/// Document and buffer as one binary file.
fn glb(document: &Value) -> Vec<u8> {
    let padded = |mut bytes: Vec<u8>, with: u8| {
        bytes.resize(bytes.len().next_multiple_of(4), with);
        bytes
    };
    let text = padded(document.to_string().into_bytes(), b' ');
    let data = padded([square(), png()].concat(), 0);
    let length = 12 + 8 + text.len() + 8 + data.len();
    let word = |n: usize| (n as u32).to_le_bytes();
    [
        &b"glTF"[..],
        &word(2),
        &word(length),
        &word(text.len()),
        b"JSON",
        &text,
        &word(data.len()),
        b"BIN\0",
        &data,
    ]
    .concat()
}

fn pixels(folder: &Folder, scene: &str) -> Vec<[f32; 4]> {
    folder.prints(&["render", scene, "--size", "8x8", "-o", "m.exr", "--float", "--overwrite", "--quiet"]);
    let file = ExrFile::read(&std::fs::read(folder.path("m.exr")).unwrap()).unwrap();
    let planes = ["R", "G", "B", "A"].map(|name| file.plane(name).expect("a channel"));
    (0..64).map(|i| std::array::from_fn(|c| planes[c][i])).collect()
}

fn draw(material: Value) -> Vec<[f32; 4]> {
    let folder = Folder::new();
    folder.write("m.glb", glb(&document(material)));
    pixels(&folder, "m.glb")
}

fn close(a: [f32; 4], b: [f32; 4]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() < 2e-3)
}

/// A surface that shows its base colour whatever the light.
fn unlit(alpha_mode: &str) -> Value {
    json!({
        "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } },
        "alphaMode": alpha_mode, "doubleSided": true, "extensions": { "KHR_materials_unlit": {} }
    })
}

#[test]
fn textures_lie_upright_and_the_camera_is_the_files_own() {
    let seen = draw(unlit("OPAQUE"));
    // An orthographic view of exactly the square: a quarter of the picture for each texel.
    assert!(close(seen[0], [1.0, 0.0, 0.0, 1.0]), "{:?}", seen[0]);
    assert!(close(seen[7], [0.0, 1.0, 0.0, 1.0]), "{:?}", seen[7]);
    assert!(close(seen[56], [0.0, 0.0, 1.0, 1.0]), "{:?}", seen[56]);
    assert!(close(seen[63], [1.0, 1.0, 1.0, 1.0]), "{:?}", seen[63]);
}

#[test]
fn alpha_is_nothing_a_mask_or_opacity() {
    for mode in ["MASK", "BLEND"] {
        let seen = draw(unlit(mode));
        assert!(close(seen[0], [1.0, 0.0, 0.0, 1.0]) && close(seen[63], [0.0; 4]), "{mode} {:?}", seen[63]);
    }
    let mut half = unlit("BLEND");
    half["pbrMetallicRoughness"]["baseColorFactor"] = json!([1, 1, 1, 0.5]);
    assert!(close(draw(half.clone())[0], [0.5, 0.0, 0.0, 0.5]));
    // Below the cutoff of 0.5 nothing is left, at it everything.
    half["alphaMode"] = json!("MASK");
    half["alphaCutoff"] = json!(0.51);
    assert!(close(draw(half.clone())[0], [0.0; 4]));
    half["alphaCutoff"] = json!(0.5);
    assert!(close(draw(half)[0], [1.0, 0.0, 0.0, 1.0]));
}

#[test]
fn metals_have_the_value_of_their_formula_in_the_files_light() {
    // α = 1, light along the view: f0 / 4π times irradiance 2.
    let seen = draw(
        json!({ "pbrMetallicRoughness": { "baseColorFactor": [0.8, 0.4, 0.2, 1], "roughnessFactor": 1 } }),
    );
    let wanted = [0.8, 0.4, 0.2].map(|f0| 2.0 * f0 / (4.0 * PI));
    assert!(close(seen[27], [wanted[0], wanted[1], wanted[2], 1.0]), "{:?}", seen[27]);
    // The texture as metallic-roughness: green is 1 at the upper right, blue (metallic) 0 there: a rough dielectric.
    let textured = draw(json!({ "pbrMetallicRoughness": {
        "baseColorFactor": [0.5, 0.5, 0.5, 1], "metallicRoughnessTexture": { "index": 0 }
    } }));
    let coat = 0.04 / (4.0 * PI);
    let below = textured[7][0] / 2.0 - coat;
    assert!(below > 0.9 * 0.5 / PI && below < 0.5 / PI, "{below}");
    let mut glowing =
        json!({ "emissiveFactor": [0.5, 1, 0], "pbrMetallicRoughness": { "baseColorFactor": [0, 0, 0, 1] } });
    assert!(close(draw(glowing.clone())[0], [0.5, 1.0, 0.0, 1.0]));
    glowing["extensions"] = json!({ "KHR_materials_emissive_strength": { "emissiveStrength": 4 } });
    assert!(close(draw(glowing)[0], [2.0, 4.0, 0.0, 1.0]));
}

#[test]
fn nodes_place_their_meshes_and_backs_are_not_drawn_unless_asked_for() {
    let folder = Folder::new();
    let mut placed = document(unlit("OPAQUE"));
    // A half turn about y by the parent, and to the side by the child: the square's back, on the left half.
    placed["nodes"] = json!([
        { "children": [3], "rotation": [0, 1, 0, 0] }, { "camera": 0, "translation": [0, 0, 4] },
        {}, { "mesh": 0, "translation": [1, 0, 0] }
    ]);
    folder.write("m.glb", glb(&placed));
    let seen = pixels(&folder, "m.glb");
    // Mirrored, and moved by one to the left: the left half shows what was left of its middle.
    assert!(close(seen[0], [1.0, 0.0, 0.0, 1.0]) && close(seen[7], [0.0; 4]), "{:?} {:?}", seen[0], seen[7]);
    placed["materials"][0]["doubleSided"] = json!(false);
    folder.write("m.glb", glb(&placed));
    assert!(pixels(&folder, "m.glb").iter().all(|p| *p == [0.0; 4]));
}

#[test]
fn vertex_colours_multiply_the_base_colour() {
    let mut colored = document(json!({ "pbrMetallicRoughness": { "roughnessFactor": 1 } }));
    // The coordinates once more, as two of three channels would be too short: positions serve as colours, cut to 0 and 1.
    colored["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(0);
    let folder = Folder::new();
    folder.write("m.glb", glb(&colored));
    let seen = pixels(&folder, "m.glb");
    // At the upper right corner red and green, at the lower left black.
    let full = 2.0 / (4.0 * PI);
    assert!(seen[7][0] > 0.7 * full && seen[7][1] > 0.7 * full && seen[7][2] == 0.0, "{:?}", seen[7]);
    assert!(seen[56][0] < 0.2 * full && seen[56][1] < 0.2 * full, "{:?}", seen[56]);
}

#[test]
fn a_gltf_is_an_object_of_a_scene_file_too() {
    let folder = Folder::new();
    let mut text = document(unlit("OPAQUE"));
    text["buffers"][0]["uri"] = json!("square%20data.bin");
    folder.write("square data.bin", [square(), png()].concat());
    text["images"][0] = json!({ "uri": "picture.png" });
    folder.write("picture.png", png());
    folder.write("m.gltf", text.to_string());
    let view = "[camera]\neye = [0, 0, 4]\ntarget = [0, 0, 0]\nheight = 2\n";
    folder.write("s.toml", format!("{view}[[object]]\nmesh = \"m.gltf\"\n"));
    assert!(close(pixels(&folder, "s.toml")[7], [0.0, 1.0, 0.0, 1.0]));
    assert_eq!(pixels(&folder, "s.toml"), pixels(&folder, "m.gltf"));
    // A material of the scene file takes the place of the file's.
    folder.write("t.toml", format!("{view}[[object]]\nmesh = \"m.gltf\"\n[material.material0]\nemission = [0, 0, 3]\ndiffuse = [0, 0, 0]\n"));
    assert!(close(pixels(&folder, "t.toml")[7], [0.0, 0.0, 3.0, 1.0]));
    let info: Value = serde_json::from_str(&folder.prints(&["info", "m.gltf"])).unwrap();
    assert_eq!((&info["triangles"], &info["cameras"], &info["lights"]), (&json!(2), &json!(1), &json!(1)));
    folder.prints(&["check", "m.gltf"]);
    std::fs::remove_file(folder.path("picture.png")).unwrap();
    folder.fails(&["check", "m.gltf"], 3, &["m.gltf", "image 0", "`material0`", "cannot be read"]);
    std::fs::remove_file(folder.path("square data.bin")).unwrap();
    folder.fails(&["check", "m.gltf"], 3, &["m.gltf", "buffer 0", "square data.bin", "cannot be read"]);
}

/// The document, changed, is refused with these pieces of a message.
fn refused(change: impl Fn(&mut Value), pieces: &[&str]) {
    let mut changed = document(unlit("OPAQUE"));
    change(&mut changed);
    let folder = Folder::new();
    folder.write("m.glb", glb(&changed));
    folder.fails(&["check", "m.glb"], 3, &[&["m.glb"], pieces].concat());
}

#[test]
fn broken_files_name_the_element() {
    refused(|d| d["bufferViews"][0]["byteLength"] = json!(1000), &["bufferView 0", "beyond its buffer"]);
    refused(|d| d["accessors"][0]["count"] = json!(5), &["mesh 0", "accessor 0", "beyond its bufferView"]);
    refused(|d| d["accessors"][2]["count"] = json!(4_000_000_000u32), &["accessor 2", "beyond"]);
    refused(|d| d["buffers"][0]["byteLength"] = json!(9_999_999), &["buffer 0 has"]);
    refused(|d| d["accessors"][1]["count"] = json!(3), &["mesh 0, primitive 0", "vertices"]);
    refused(|d| d["nodes"][0]["children"] = json!([0]), &["node 0", "its own ancestor"]);
    refused(|d| d["nodes"][0]["mesh"] = json!(7), &["not a glTF"]);
    // The schema's own check panicked here.
    refused(|d| d["accessors"] = json!([]), &["mesh 0, primitive 0 names accessor", "there are 0"]);
    // As did these.
    refused(|d| d["images"] = json!([{ "bufferView": 3 }]), &["image 0", "mimeType"]);
    refused(|d| d["images"] = json!([{}]), &["image 0", "neither"]);
    refused(|d| d["cameras"][0]["type"] = json!("perspective"), &["camera 0"]);
    refused(|d| d["extensions"] = json!({}), &["node 2 names light 0, but there are 0"]);
    refused(|d| d["extensions"]["KHR_lights_punctual"]["lights"][0]["type"] = json!("spot"), &["light 0"]);
    refused(|d| d["bufferViews"][3]["byteLength"] = json!(20), &["image 0", "cannot be decoded"]);
    refused(|d| d["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]), &["not a glTF"]);
    let folder = Folder::new();
    folder.write("m.glb", &glb(&document(unlit("OPAQUE")))[..200]);
    folder.fails(&["check", "m.glb"], 3, &["m.glb", "cut off"]);
    folder.write("m.gltf", "{}");
    folder.fails(&["check", "m.gltf"], 3, &["m.gltf", "not a glTF"]);
    folder.fails(&["check", "lost.glb"], 3, &["lost.glb", "cannot be read"]);
}

/// Where the corners of the picture lie in its pixels.
fn corners(pixels: &[[f32; 4]]) -> [[f32; 4]; 4] {
    [pixels[0], pixels[7], pixels[56], pixels[63]]
}

const RED: [f32; 4] = [1.0, 0.0, 0.0, 1.0];
const GREEN: [f32; 4] = [0.0, 1.0, 0.0, 1.0];
const BLUE: [f32; 4] = [0.0, 0.0, 1.0, 1.0];

fn transformed(mut material: Value, path: &str, transform: Value) -> Value {
    *material.pointer_mut(path).expect("a texture") =
        json!({ "index": 0, "extensions": { "KHR_texture_transform": transform } });
    material
}

#[test]
fn textures_are_transformed() {
    const BASE: &str = "/pbrMetallicRoughness/baseColorTexture";
    let draw = |material: Value| {
        let mut document = document(material);
        document["extensionsRequired"] = json!(["KHR_texture_transform"]);
        document["samplers"][0] = json!({});
        let folder = Folder::new();
        folder.write("m.glb", glb(&document));
        assert!(
            !String::from_utf8_lossy(&folder.command(&["check", "m.glb"]).output().unwrap().stderr)
                .contains("KHR")
        );
        corners(&pixels(&folder, "m.glb"))
    };
    // v runs downward: the upper right texel.
    let quarter = json!({ "offset": [0.5, 0], "scale": [0.5, 0.5] });
    assert_eq!(draw(transformed(unlit("OPAQUE"), BASE, quarter.clone())), [GREEN; 4]);
    // Coordinates turn counter-clockwise about the upper left corner, the picture clockwise.
    let turned = json!({ "rotation": PI / 2.0 });
    let seen = draw(transformed(unlit("OPAQUE"), BASE, turned));
    assert!(seen.iter().zip([BLUE, RED, [1.0; 4], GREEN]).all(|(a, b)| close(*a, b)), "{seen:?}");
    // Alpha goes with its colour; white is clear.
    let shifted = draw(transformed(unlit("BLEND"), BASE, json!({ "offset": [0.5, 0] })));
    assert_eq!(shifted, [GREEN, RED, [0.0; 4], BLUE]);
    // Lit by irradiance 2, base colours are diffuse: only green where the green texel is.
    let mut matt = json!({ "pbrMetallicRoughness": { "metallicFactor": 0, "baseColorTexture": {} } });
    matt["extensions"] = json!({ "KHR_materials_ior": { "ior": 1 } });
    let lit = draw(transformed(matt, BASE, quarter));
    assert!(lit.iter().all(|p| p[1] > 0.3 && p[0] == 0.0 && p[2] == 0.0), "{lit:?}");
}

#[test]
fn normal_and_occlusion_textures_are_transformed_too() {
    let folder = Folder::new();
    let scene = "[camera]\neye = [0, 0, 4]\ntarget = [0, 0, 0]\nheight = 2\n[[object]]\nmesh = \"m.glb\"\n";
    let draw = |light: &str, key: &str, offset: [f32; 2]| {
        let mut material = json!({ "pbrMetallicRoughness": { "metallicFactor": 0 } });
        let transform = json!({ "offset": offset, "scale": [0.5, 0.5] });
        material[key] = json!({ "index": 0, "extensions": { "KHR_texture_transform": transform } });
        folder.write("m.glb", glb(&document(material)));
        folder.write("s.toml", format!("{scene}{light}"));
        pixels(&folder, "s.toml")[27][0]
    };
    // Red of the upper left texel is 1, of the one below 0.
    let ambient = "[ambient]\ncolor = [1, 1, 1]\n";
    let open = draw(ambient, "occlusionTexture", [0.0, 0.0]);
    assert!(open > 0.9 && draw(ambient, "occlusionTexture", [0.0, 0.5]) == 0.0, "{open}");
    // Blue stands for a normal to the left, which faces the light; red for one to the right.
    let left = "[[light]]\ntype = \"directional\"\ndirection = [1, 0, -1]\nirradiance = [2, 2, 2]\n";
    let (red, blue) = (draw(left, "normalTexture", [0.0, 0.0]), draw(left, "normalTexture", [0.0, 0.5]));
    assert!(red < 0.1 && blue > 0.4, "{red} {blue}");
}

#[test]
fn a_second_set_of_coordinates_is_taken_where_a_texture_asks_for_it() {
    let mut base = unlit("OPAQUE");
    base["pbrMetallicRoughness"]["baseColorTexture"] = json!({ "index": 0, "texCoord": 1 });
    let mut two = document(base.clone());
    two["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] = json!(3);
    // A sparse accessor without bytes of its own is zeros, the upper left texel, but for the lower left corner at (0, 1).
    two["accessors"].as_array_mut().unwrap().push(
        json!({ "componentType": 5126, "count": 4, "type": "VEC2", "sparse": {
        "count": 1, "indices": { "bufferView": 2, "componentType": 5123 },
        "values": { "bufferView": 0, "byteOffset": 8 }
    } }),
    );
    let folder = Folder::new();
    folder.write("m.glb", glb(&two));
    assert_eq!(corners(&pixels(&folder, "m.glb")), [RED, RED, BLUE, RED]);
    // The extension may name the set, too.
    two["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] =
        json!({ "index": 0, "extensions": { "KHR_texture_transform": { "texCoord": 1 } } });
    folder.write("m.glb", glb(&two));
    assert_eq!(corners(&pixels(&folder, "m.glb")), [RED, RED, BLUE, RED]);
    // Light maps of a scene file lie by it unless they say otherwise.
    folder.write("picture.png", png());
    let scene = "[camera]\neye = [0, 0, 4]\ntarget = [0, 0, 0]\nheight = 2\n[[object]]\nmesh = \"m.glb\"\n\
                 [material.material0]\ndiffuse = [1, 1, 1]\nlightmap = \"picture.png\"\n";
    folder.write("s.toml", scene);
    assert_eq!(corners(&pixels(&folder, "s.toml")), [RED, RED, BLUE, RED]);
    // A mesh without that set: the first counts, with a warning.
    folder.write("m.glb", glb(&document(base)));
    assert_eq!(corners(&pixels(&folder, "m.glb"))[1], GREEN);
    let output = folder.command(&["check", "m.glb"]).output().unwrap();
    assert!(String::from_utf8_lossy(&output.stderr).contains("second set of texture coordinates"));
}

#[test]
fn sparse_accessors_replace_elements() {
    let sparse = |count: usize| {
        json!({
            "count": count,
            "indices": { "bufferView": 2, "byteOffset": 8, "componentType": 5123 },
            "values": { "bufferView": 0, "byteOffset": 16 }
        })
    };
    // Vertices 2 and 3 become (−1, 0, 1) and (1, 0, −1): the upper half is empty.
    let mut half = document(unlit("OPAQUE"));
    half["accessors"][0]["sparse"] = sparse(2);
    let folder = Folder::new();
    folder.write("m.glb", glb(&half));
    let seen = pixels(&folder, "m.glb");
    assert!(seen[..32].iter().all(|p| *p == [0.0; 4]) && seen[56][3] == 1.0, "{:?} {:?}", seen[31], seen[56]);
    refused(
        |d| {
            d["accessors"][0]["sparse"] = sparse(2);
            d["accessors"][0]["sparse"]["indices"]["byteOffset"] = json!(4);
        },
        &["mesh 0", "the sparse indices of accessor 0 do not rise"],
    );
    refused(
        |d| {
            d["accessors"][1]["count"] = json!(3);
            d["accessors"][1]["sparse"] = sparse(2);
        },
        &["the sparse indices of accessor 1 name element 3, but there are 3"],
    );
    refused(
        |d| {
            d["accessors"][0]["sparse"] = sparse(2);
            d["accessors"][0]["sparse"]["values"]["byteOffset"] = json!(40);
        },
        &["the sparse values of accessor 0 goes beyond its bufferView"],
    );
    refused(
        |d| {
            d["accessors"][0] = json!({ "componentType": 5126, "count": 900_000_000, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1] });
            d["accessors"][0]["sparse"] = sparse(2);
        },
        &["accessor 0 is sparse and has 900000000 elements"],
    );
}

proptest! {
    #![proptest_config(testkit::config(200))]

    #[test]
    fn any_change_of_a_byte_is_a_model_or_an_error(at in any::<prop::sample::Index>(), byte in any::<u8>(), cut in prop::option::weighted(0.2, any::<prop::sample::Index>())) {
        let mut bytes = glb(&document(unlit("MASK")));
        let index = at.index(bytes.len());
        bytes[index] = byte;
        if let Some(cut) = cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        match read_gltf("fuzz", &bytes, &|_| Err("is not there".to_owned())) {
            Ok(mesh) => {
                let count = mesh.positions.len();
                prop_assert!(mesh.triangles.iter().flatten().all(|&v| (v as usize) < count));
                prop_assert!(mesh.positions.iter().all(|p| p.is_finite()));
            }
            Err(error) => prop_assert!(!error.to_string().is_empty()),
        }
    }
}
