//! A square that fills the picture, seen from the front, and what its pixels are.

use super::Folder;
use pointillist_cli::image_io::ExrFile;

/// A square of two by two before the camera, facing it, with texture coordinates.
pub(crate) const SQUARE: &str = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
                      f 1/1 2/2 3/3 4/4\n";

/// Seen from the front, filling the picture.
pub(crate) const VIEW: &str =
    "[camera]\neye = [0, 0, 4]\ntarget = [0, 0, 0]\nheight = 2\n[image]\nsize = [8, 8]\n";

/// From the eye: a surface that faces it gets irradiance 2.
pub(crate) const HEAD_LIGHT: &str =
    "[[light]]\ntype = \"directional\"\ndirection = [0, 0, -1]\nirradiance = [2, 2, 2]\n";

pub(crate) fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("square.obj", SQUARE);
    folder
}

/// A grey picture of this many pixels, from the top row.
pub(crate) fn picture(
    folder: &Folder,
    name: &str,
    width: u32,
    height: u32,
    pixel: impl Fn(u32, u32) -> [u8; 3],
) {
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).flat_map(|(x, y)| pixel(x, y));
    let image = image::RgbImage::from_raw(width, height, pixels.collect()).expect("all pixels");
    image.save(folder.path(name)).expect("a picture");
}

/// Renders a scene of the view, what is given, and objects of one material; each pixel's colour.
pub(crate) fn draw(folder: &Folder, more: &str, material: &str) -> Vec<[f32; 3]> {
    draw_mesh(folder, "square.obj", more, material)
}

pub(crate) fn draw_mesh(folder: &Folder, mesh: &str, more: &str, material: &str) -> Vec<[f32; 3]> {
    let object = format!("[[object]]\nmesh = \"{mesh}\"\nmaterial = \"m\"\n");
    folder.write("m.toml", format!("{VIEW}{more}{object}[material.m]\n{material}"));
    pixels(folder, "m.toml")
}

pub(crate) fn pixels(folder: &Folder, scene: &str) -> Vec<[f32; 3]> {
    folder.prints(&["render", scene, "-o", "m.exr", "--float", "--overwrite", "--quiet"]);
    let file = ExrFile::read(&std::fs::read(folder.path("m.exr")).unwrap()).unwrap();
    let plane = |name: &str| file.plane(name).expect("a channel");
    let (r, g, b) = (plane("R"), plane("G"), plane("B"));
    r.into_iter().zip(g).zip(b).map(|((r, g), b)| [r, g, b]).collect()
}

/// All pixels are this colour.
pub(crate) fn all(pixels: &[[f32; 3]], wanted: [f32; 3], tolerance: f32) {
    for p in pixels {
        let near = p.iter().zip(wanted).all(|(p, w)| (p - w).abs() <= tolerance);
        assert!(near, "{p:?} is not {wanted:?}");
    }
}

/// Renders the square with a material of an MTL, in a scene `o.toml` of the view and what is given.
pub(crate) fn draw_mtl(folder: &Folder, more: &str, mtl: &str) -> Vec<[f32; 3]> {
    folder.write("with_mtl.obj", format!("mtllib m.mtl\nusemtl m\n{SQUARE}"));
    folder.write("m.mtl", format!("newmtl m\n{mtl}"));
    folder.write("o.toml", format!("{VIEW}{more}[[object]]\nmesh = \"with_mtl.obj\"\n"));
    pixels(folder, "o.toml")
}

/// What `check` has to say of a scene.
pub(crate) fn warnings(folder: &Folder, scene: &str) -> String {
    let output = folder.command(&["check", scene]).output().expect("the command runs");
    assert!(output.status.success());
    String::from_utf8_lossy(&output.stderr).into_owned()
}
