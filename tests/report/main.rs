//! `metrolight report`: the page is self-contained, escapes the contents of files, and its viewer works
//! in a browser.

#[path = "../common/mod.rs"]
mod common;

mod browser;

use std::fs;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use common::page::Page;
use common::workplace::Workplace;
use metrolight::film::{AttributeValue, Image, write_exr, write_png};
use predicates::str::contains;
use serde_json::{Value, json};

/// A page with the results of all commands.
fn whole_page(place: &Workplace) -> Page {
    for command in [
        "converge room.xml --integrators bdpt,pssmlt --spp 4 --repeats 1 -o out -q",
        "diagnose room.xml --integrator pssmlt --chains 64 --steps 64 -o out -q",
        "strategies room.xml --spp 2 --max-depth 3 -o out -q",
        "compare out/bdpt.exr out/reference.exr -o out",
        "render room.xml --integrator path --spp 4 -o out/path.exr -q",
        "render sky.xml --integrator path --spp 1 -o out/sky.exr -q",
    ] {
        // A diagnosis of few short chains may reject.
        let code = place.run(command).assert().get_output().status.code();
        assert!(code == Some(0) || command.starts_with("diagnose") && code == Some(1));
    }
    place.run("report out").assert().success().stdout(contains(
        "report.html: convergence, images, comparison, chains, techniques",
    ));
    Page::read(&place.path("out/report.html"))
}

#[test]
fn the_page_is_complete_and_self_contained() {
    let place = Workplace::new();
    let page = whole_page(&place);
    page.check_stands_alone();
    let body = page.document();
    let figures = body.descendants().filter(|node| node.has_tag_name("img"));
    let captions: Vec<_> = figures.filter_map(|node| node.attribute("alt")).collect();
    // A chart and two error images of converge, three charts of diagnose, two error images of compare,
    // two contact sheets.
    assert_eq!(captions.len(), 10, "{captions:?}");
    let text = page.text();
    for expected in [
        "reference: pssmlt",
        "pssmlt ends at",
        "stationary:",
        "smallest p-value of each kind of test",
        "bootstrap",
        "bdpt.exr against out/reference.exr",
        "relative mse",
        "(0, 2)",
        "large step probability",
        "samples per pixel",
        env!("CARGO_PKG_VERSION"),
    ] {
        assert!(text.contains(expected), "{expected}");
    }
    // The reference comes first, then the integrators, then others. Single techniques are left out.
    let data = page.data();
    let images = data["images"].as_array().expect("images");
    let names: Vec<_> = images.iter().map(|image| image["name"].as_str()).collect();
    let expected = ["reference", "bdpt", "pssmlt", "path", "sky"];
    assert_eq!(names, expected.map(Some));
    for (image, name) in images.iter().zip(expected) {
        check_pixels(image, &place.pixels(&format!("out/{name}.exr")));
    }
}

/// Asserts that an image of the page is that of the file, up to the rounding of half floats.
fn check_pixels(image: &Value, expected: &[[f32; 3]]) {
    let bytes = STANDARD.decode(image["pixels"].as_str().expect("a text"));
    let bytes = bytes.expect("base64");
    let number = |name: &str| image[name].as_f64().expect("a number");
    assert_eq!(number("width") * number("height"), expected.len() as f64);
    assert_eq!(bytes.len(), 6 * expected.len());
    for (half, &value) in bytes.chunks(2).zip(expected.iter().flatten()) {
        let half = half::f16::from_le_bytes([half[0], half[1]]).to_f64();
        let difference = (half * number("unit") - f64::from(value)).abs();
        let rounding = f64::from(value.abs()) / 2048.0 + number("unit") * 2f64.powi(-25);
        assert!(difference <= rounding, "{value} {difference}");
    }
}

/// A text with markup that closes scripts and attributes, and refers to a file.
const HOSTILE: &str = r#"</script><script>alert(1)</script>"'><img src="http://x/y">&amp;{{7*7}}"#;

/// Makes a directory `out` whose files contain hostile text wherever they can.
fn hostile(place: &Workplace) {
    let out = place.path("out");
    fs::create_dir(&out).expect("made");
    let image = Image {
        width: 2,
        height: 1,
        pixels: vec![[0.5; 3]; 2],
    };
    let name = r#"a"onerror=alert(1) <b>&'.exr"#;
    let said = [
        (
            "metrolight.scene".into(),
            AttributeValue::Text(HOSTILE.into()),
        ),
        (
            format!("metrolight.{HOSTILE}"),
            AttributeValue::Text("x".into()),
        ),
    ];
    write_exr(&out.join(name), &image, &[], &said).expect("written");
    write_png(&place.path("secret-error.png"), &image).expect("written");
    let write = |name: &str, text: String| fs::write(out.join(name), text).expect("written");
    let point = json!({ "seconds": 1.0, "rays": 1.0, "relative_mse": 1.0, "spread": [1.0, 1.0],
        "relative_mse_trimmed": 1.0 });
    let convergence = json!({
        "settings": { "scene": HOSTILE, HOSTILE: 1 },
        "reference": { "description": HOSTILE },
        "variants": [
            { "label": HOSTILE, "image": "../secret", "comparison": HOSTILE, "points": [point] },
        ],
        "interrupted": true,
        "warnings": [HOSTILE],
    });
    write("convergence.json", convergence.to_string());
    let diagnosis = json!({ "version": HOSTILE, "scene": HOSTILE, "integrator": HOSTILE, "alpha": 0.1,
        "budget": {}, "stationary": false, "verdict": HOSTILE });
    write("diagnose.json", diagnosis.to_string());
    write("diagnose.txt", format!("{HOSTILE}\n\n{HOSTILE}"));
    write(
        "traces.svg",
        r#"<svg xmlns="http://www.w3.org/2000/svg"><script>alert(1)</script></svg>"#.into(),
    );
}

#[test]
fn text_of_files_is_escaped() {
    let place = Workplace::new();
    hostile(&place);
    place.run("report out -o page.html -q").assert().success();
    let page = Page::read(&place.path("page.html"));
    page.check_stands_alone();
    // The label, the warning, the verdict and others are shown as text.
    assert!(page.text().matches(HOSTILE).count() >= 8);
    let name = r#"a"onerror=alert(1) <b>&'"#;
    assert_eq!(page.data()["images"][0]["name"], name);
    assert!(page.text().contains(name));
    // Two scripts, and one picture: the SVG document, but no file outside the directory.
    let document = page.document();
    let count = |tag: &str| {
        document
            .descendants()
            .filter(|n| n.has_tag_name(tag))
            .count()
    };
    assert_eq!((count("script"), count("img"), count("b")), (2, 1, 0));
}

#[test]
fn empty_sections_are_left_out_and_wrong_input_is_explained() {
    let place = Workplace::new();
    for name in ["empty", "broken", "svg", "only"] {
        fs::create_dir(place.path(name)).expect("made");
    }
    fs::write(place.path("empty/notes.txt"), "").expect("written");
    fs::write(place.path("broken/diagnose.json"), "{\"version\": 1}").expect("written");
    fs::write(place.path("svg/tiles.svg"), "<html/>").expect("written");
    for (arguments, message) in [
        ("report empty", "has nothing to report on"),
        ("report empty", "convergence.json or .svg"),
        (
            "report none",
            "there is no such directory; expected a directory",
        ),
        ("report room.xml", "it is a file; expected a directory"),
        ("report broken", "what `metrolight diagnose` writes"),
        ("report broken", "Run diagnose again"),
        ("report svg", "tiles.svg is not what"),
        ("report empty -o page.svg", "ends in .html"),
        ("report empty -o no/page.html", "no directory no"),
        ("report", "<DIR>"),
    ] {
        place.assert_rejects(arguments, message);
    }
    assert!(!place.path("empty/report.html").exists());
    assert!(!place.path("broken/report.html").exists());

    // An image that cannot be read is left out with a warning; others are shown.
    place
        .run("render sky.xml --integrator path --spp 1 -o only/sky.exr -q")
        .assert()
        .success();
    fs::write(place.path("only/broken.exr"), "no image").expect("written");
    place
        .run("report only")
        .assert()
        .success()
        .stdout(contains("report.html: images\n"))
        .stderr(contains("broken.exr is left out"));
    let page = Page::read(&place.path("only/report.html"));
    page.check_stands_alone();
    let document = page.document();
    let sections = document
        .descendants()
        .filter(|node| node.has_tag_name("section"));
    let ids: Vec<_> = sections.filter_map(|node| node.attribute("id")).collect();
    assert_eq!(ids, ["images", "settings"]);
}
