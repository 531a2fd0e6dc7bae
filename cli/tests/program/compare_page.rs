//! `compare --html`: the page has what it promises, says the same as the JSON, and loads nothing.

use crate::common::Folder;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use image::RgbImage;
use serde_json::Value;
use std::fs;

/// Two pictures that differ in a square near a corner and in one pixel far from it, the page about them, and the numbers.
fn page_about(folder: &Folder) -> (String, Value) {
    let base = RgbImage::from_fn(80, 60, |x, y| image::Rgb([x as u8 * 3, y as u8 * 4, 90]));
    let mut other = base.clone();
    for (x, y) in (0..12).flat_map(|y| (0..12).map(move |x| (4 + x, 3 + y))) {
        other.put_pixel(x, y, image::Rgb([120, 40, 90]));
    }
    other.put_pixel(70, 50, image::Rgb([255, 255, 255]));
    base.save(folder.path("a&b.png")).unwrap();
    other.save(folder.path("other.png")).unwrap();
    let json = folder.prints(&["compare", "a&b.png", "other.png", "--html", "page.html"]);
    (fs::read_to_string(folder.path("page.html")).unwrap(), serde_json::from_str(&json).unwrap())
}

/// The values of an attribute, in order.
fn values<'p>(page: &'p str, attribute: &str) -> Vec<&'p str> {
    let start = format!(" {attribute}=\"");
    page.split(&start).skip(1).map(|rest| rest.split('"').next().unwrap()).collect()
}

fn pictures(page: &str) -> Vec<RgbImage> {
    let decode = |address: &str| {
        let png = address.strip_prefix("data:image/png;base64,").expect("an embedded picture");
        image::load_from_memory(&STANDARD.decode(png).unwrap()).unwrap().into_rgb8()
    };
    values(page, "src").into_iter().map(decode).collect()
}

#[test]
fn page_says_what_the_json_says() {
    let folder = Folder::new();
    let (page, json) = page_about(&folder);
    for key in ["rmse", "mae", "bias", "max", "psnr", "flip"] {
        let start = format!("<data id=\"{key}\" value=\"");
        let value = page.split(&start).nth(1).expect(key).split('"').next().unwrap();
        assert_eq!(value, json[key].to_string(), "{key}");
    }
    assert!(json["rmse"].as_f64() > Some(0.0));
    let [column, row] = [0, 1].map(|i| json["max_pixel"][i].as_u64().unwrap());
    assert!(page.contains(&format!("at column {column}, row {row}")), "{column}, {row}");
}

#[test]
fn page_shows_both_pictures_and_places_where_they_differ() {
    let folder = Folder::new();
    let (page, json) = page_about(&folder);
    let [a, b] = ["a&b.png", "other.png"].map(|name| image::open(folder.path(name)).unwrap().into_rgb8());
    let shown = pictures(&page);
    assert!(shown[0] == a && shown[1] == b, "the pictures under the slider are those that are compared");
    let different = |x: u32, y: u32| shown[2].get_pixel(x, y).0 != [0; 3];
    assert!(different(10, 10) && different(70, 50) && !different(40, 30));
    assert!(shown[3].get_pixel(10, 10).0[0] > shown[3].get_pixel(40, 30).0[0]);
    // Two places: the square and the pixel, each in four pictures.
    let titles: Vec<&str> = page.split("<h3>").skip(1).map(|rest| rest.split('<').next().unwrap()).collect();
    assert_eq!(shown.len(), 4 + 4 * titles.len(), "{titles:?}");
    let numbers = |title: &str| -> Vec<u32> {
        let words = title.split(", columns").nth(1).expect("columns").replace(',', " ");
        words.split(' ').filter_map(|word| word.parse().ok()).collect()
    };
    let holds = |title: &str, x: u32, y: u32| {
        let [x0, x1, y0, y1] = numbers(title)[..] else { panic!("{title}") };
        (x0..=x1).contains(&x) && (y0..=y1).contains(&y)
    };
    let largest = [0, 1].map(|i| json["max_pixel"][i].as_u64().unwrap() as u32);
    assert!(holds(titles[0], largest[0], largest[1]), "{titles:?}");
    for (x, y) in [(10, 8), (70, 50)] {
        assert!(titles.iter().any(|title| holds(title, x, y)), "{x}, {y}: {titles:?}");
    }
    let [x0, x1, y0, y1] = numbers(titles[0])[..] else { panic!("{titles:?}") };
    let cut = image::imageops::crop_imm(&b, x0, y0, x1 - x0 + 1, y1 - y0 + 1).to_image();
    assert!(shown[5] == cut, "the first place of B is a part of B");
}

#[test]
fn page_loads_nothing_and_can_be_used_without_a_mouse() {
    let folder = Folder::new();
    let (page, _) = page_about(&folder);
    for foreign in ["http:", "https:", "//", "url(", "@import", "<link", "import("] {
        // Comments of the script begin with two slashes, and are followed by a space; base64 has single ones and pairs.
        let text: String =
            page.split("base64,").map(|part| part.split_once('"').map_or(part, |p| p.1)).collect();
        let found =
            text.match_indices(foreign).any(|(at, _)| foreign != "//" || !text[at..].starts_with("// "));
        assert!(!found, "the page has {foreign}");
    }
    assert!(page.contains("Content-Security-Policy") && page.contains("default-src 'none'"));
    assert!(page.contains("prefers-color-scheme: dark") && page.contains("name=\"viewport\""));
    assert_eq!(values(&page, "type").iter().filter(|kind| **kind == "range").count(), 1);
    assert_eq!(values(&page, "alt").len(), values(&page, "src").len());
    assert!(page.contains("<title>a&amp;b.png and other.png</title>"));
    assert!(page.trim_end().ends_with("</html>"));
}

#[test]
fn equal_pictures_have_no_place_to_show() {
    let folder = Folder::new();
    page_about(&folder);
    let line = ["compare", "other.png", "other.png", "-o", "same.json", "--html", "-"];
    let page = folder.prints(&line);
    assert!(page.contains("all pixels are equal") && page.contains("id=\"psnr\" value=\"null\""));
    assert_eq!(pictures(&page).len(), 4);
}

#[test]
fn exposure_brightens_what_is_shown_and_no_number() {
    let folder = Folder::new();
    let (plain, json) = page_about(&folder);
    let line = ["compare", "a&b.png", "other.png", "--html", "page.html", "--exposure", "1"];
    assert_eq!(serde_json::from_str::<Value>(&folder.prints(&line)).unwrap(), json);
    let bright = fs::read_to_string(folder.path("page.html")).unwrap();
    assert!(bright.contains("exposure of 1 EV"));
    let [plain, bright] = [plain, bright].map(|page| pictures(&page)[0].get_pixel(30, 30).0);
    assert!(bright[0] > plain[0] + 20, "{plain:?} {bright:?}");
}

#[test]
fn what_cannot_be_a_page_is_refused() {
    let folder = Folder::new();
    page_about(&folder);
    fs::remove_file(folder.path("page.html")).unwrap();
    let pair = ["compare", "a&b.png", "other.png"];
    folder.fails(&[&pair[..], &["--html", "page.png"]].concat(), 2, &["--html", "page.png", ".html"]);
    folder.fails(&[&pair[..], &["--exposure", "1"]].concat(), 2, &["--html"]);
    folder.fails(&[&pair[..], &["--html", "-"]].concat(), 2, &["standard output"]);
    folder.fails(&[&pair[..], &["--html", "no/such/page.html"]].concat(), 1, &["cannot be written"]);
    RgbImage::new(3, 3).save(folder.path("small.png")).unwrap();
    folder.fails(&["compare", "a&b.png", "small.png", "--html", "page.html"], 3, &["3×3"]);
    assert!(!folder.path("page.html").exists());
}
