//! `metrolight report`: the page stands alone, tells nothing as markup that a file contains, and its
//! viewer works in a browser.

mod common;

use std::fs;
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use common::page::{Browser, Page};
use common::workplace::Workplace;
use metrolight::film::{AttributeValue, Image, write_exr, write_png};
use metrolight::plot::false_color;
use metrolight::statistics::relative_square_errors;
use predicates::str::{contains, is_empty};
use serde_json::{Value, json};

/// A page about all that commands leave.
fn whole_page(place: &Workplace) -> Page {
    for command in [
        "converge room.xml --integrators bdpt,pssmlt --spp 4 --repeats 1 -o out -q",
        "diagnose room.xml --chains 64 --steps 64 -o out -q",
        "strategies room.xml --spp 2 --max-depth 3 -o out -q",
        "compare out/bdpt.exr out/reference.exr -o out",
        "render room.xml --integrator path --spp 4 -o out/path.exr -q",
        "render sky.xml --integrator path --spp 1 -o out/sky.exr -q",
    ] {
        // A diagnosis of few short chains may find anything.
        let code = place.run(command).assert().get_output().status.code();
        assert!(code == Some(0) || command.starts_with("diagnose") && code == Some(1));
    }
    place.run("report out").assert().success().stdout(contains(
        "report.html: convergence, images, comparison, chains, techniques",
    ));
    Page::read(&place.path("out/report.html"))
}

#[test]
fn the_page_holds_everything_and_refers_to_nothing_else() {
    let place = Workplace::new();
    let page = whole_page(&place);
    page.check_stands_alone();
    let body = page.document();
    let figures = body.descendants().filter(|node| node.has_tag_name("img"));
    let captions: Vec<_> = figures.filter_map(|node| node.attribute("alt")).collect();
    // One chart and two images of errors of converge, three charts, two maps, two sheets.
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
    // The reference first, then the integrators, then others; none of single techniques.
    let data = page.data();
    let images = data["images"].as_array().expect("images");
    let names: Vec<_> = images.iter().map(|image| image["name"].as_str()).collect();
    let expected = ["reference", "bdpt", "pssmlt", "path", "sky"];
    assert_eq!(names, expected.map(Some));
    for (image, name) in images.iter().zip(expected) {
        check_pixels(image, &place.pixels(&format!("out/{name}.exr")));
    }
}

/// An image of the page is that of the file, but for the rounding of half floats.
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

/// A text that is markup, closes scripts and attributes, and asks for files.
const HOSTILE: &str = r#"</script><script>alert(1)</script>"'><img src="http://x/y">&amp;{{7*7}}"#;

/// A directory `out` with all that a file can say, hostile.
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
        "effort": {}, "stationary": false, "verdict": HOSTILE });
    write("diagnose.json", diagnosis.to_string());
    write("diagnose.txt", format!("{HOSTILE}\n\n{HOSTILE}"));
    write(
        "traces.svg",
        r#"<svg xmlns="http://www.w3.org/2000/svg"><script>alert(1)</script></svg>"#.into(),
    );
}

#[test]
fn what_files_say_is_text_and_no_markup() {
    let place = Workplace::new();
    hostile(&place);
    place.run("report out -o page.html -q").assert().success();
    let page = Page::read(&place.path("page.html"));
    page.check_stands_alone();
    // The label, the warning, the verdict... all say what they say.
    assert!(page.text().matches(HOSTILE).count() >= 8);
    let name = r#"a"onerror=alert(1) <b>&'"#;
    assert_eq!(page.data()["images"][0]["name"], name);
    assert!(page.text().contains(name));
    // Two scripts, and a picture only of the SVG document, not of a file outside the directory.
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
fn sections_without_data_are_left_out_and_wrong_input_is_explained() {
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
        ("report none", "there is no such directory; needed is"),
        ("report room.xml", "it is a file; needed is"),
        ("report broken", "what `metrolight diagnose` writes"),
        ("report broken", "Run diagnose again"),
        ("report svg", "tiles.svg is not what"),
        ("report empty -o page.svg", "ends in .html"),
        ("report empty -o no/page.html", "no directory no"),
        ("report", "<DIR>"),
    ] {
        let assert = place.run(arguments).assert();
        assert.code(2).stdout(is_empty()).stderr(contains(message));
    }
    assert!(!place.path("empty/report.html").exists());
    assert!(!place.path("broken/report.html").exists());

    // An image that cannot be read is left out, with a word; others are shown.
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

/// What a user does with the page, and what comes of it.
const USE: &str = r#"
const element = (id) => document.getElementById(id);
const set = (id, value, event) => {
  element(id).value = value;
  element(id).dispatchEvent(new Event(event, { bubbles: true }));
};
const canvas = element("right-canvas");
const pixel = (x, y) => [...canvas.getContext("2d").getImageData(x, y, 1, 1).data];
const box = () => element("view").getBoundingClientRect();
// Which image is seen at a share of the view's width.
const seen = (share) =>
  document.elementFromPoint(box().left + share * box().width, box().top + 0.62 * box().height).id;
const divider = () => (element("divider").getBoundingClientRect().left + 1 - box().left) / box().width;
const pointer = (type, share) => element("view").dispatchEvent(new PointerEvent(type, {
  pointerId: 1, bubbles: true, clientX: box().left + share * box().width, clientY: box().top + 0.62 * box().height }));
const scale = () => new DOMMatrix(getComputedStyle(canvas).transform).a;
element("view").setPointerCapture = () => {};
element("view").scrollIntoView();

found.pictures = [...document.images].map((image) => image.complete && image.naturalWidth > 0);
found.sizes = [canvas.width, canvas.height];
found.names = [element("left-name").textContent, element("right-name").textContent];
found.developed = [0, 1, 2, 3].map((stops) => {
  set("exposure", stops, "input");
  return pixel(10, 12);
});
found.stops = element("stops").textContent;
set("exposure", 0, "input");
found.split = [20, 80].map((value) => {
  set("split", value, "input");
  return { divider: divider(), seen: [seen(0.1), seen(0.5), seen(0.9)] };
});
pointer("pointerdown", 0.5);
pointer("pointermove", 0.3);
pointer("pointerup", 0.3);
pointer("pointermove", 0.72);
found.dragged = { divider: divider(), value: element("split").value, seen: seen(0.5) };
found.pointed = element("pixel").textContent;
const before = scale();
element("in").click();
element("view").dispatchEvent(new KeyboardEvent("keydown", { key: "+" }));
element("view").dispatchEvent(new WheelEvent("wheel", { deltaY: -300, cancelable: true, clientX: box().left, clientY: box().top }));
found.zoomed = scale() / before;
found.zoomedDivider = divider();
element("fit").click();
found.fit = scale() / before;
set("against", "0", "change");
found.errors = [[10, 12], [3, 4], [17, 8]].map(([x, y]) => pixel(x, y));
found.scale = !element("scale").hidden;
set("left", "4", "change");
found.other = { right: element("right").value, against: element("against").value, sizes: [canvas.width, canvas.height] };
"#;

#[test]
fn the_viewer_works_in_a_browser() {
    let Some(browser) = Browser::find() else {
        eprintln!("skipped: there is no Chromium on this machine to look at the page with");
        return;
    };
    let place = Workplace::new();
    let page = whole_page(&place);
    let found = browser.run(&page, USE);
    let [reference, image] =
        ["reference", "bdpt"].map(|name| place.pixels(&format!("out/{name}.exr")));
    assert_eq!(found["problems"], json!([]), "{found:#}");

    // Everything is there.
    assert_eq!(found["pictures"], json!(vec![true; 10]));
    assert_eq!(found["sizes"], json!([20, 15]));
    assert_eq!(found["names"], json!(["reference", "bdpt"]));

    // Exposure develops the linear values: what a PNG of the brighter image would hold.
    let shown = image[12 * 20 + 10];
    for (stops, pixel) in (0..4).zip(found["developed"].as_array().expect("pixels")) {
        for (c, value) in shown.iter().enumerate() {
            let expected = srgb(f64::from(*value) * f64::from(1 << stops));
            let byte = pixel[c].as_f64().expect("a byte");
            assert!(
                (byte - expected).abs() <= 1.0,
                "{stops} {c}: {byte} {expected}"
            );
        }
    }
    assert_ne!(found["developed"][0], found["developed"][3]);
    assert_eq!(found["stops"], "+3 stops");

    // The divider is where the slider and the pointer put it, and parts the images there.
    let [left, right] = ["left-canvas", "right-canvas"];
    check_close(&found["split"][0]["divider"], 0.2);
    check_close(&found["split"][1]["divider"], 0.8);
    assert_eq!(found["split"][0]["seen"], json!([left, right, right]));
    assert_eq!(found["split"][1]["seen"], json!([left, left, right]));
    check_close(&found["dragged"]["divider"], 0.3);
    assert_eq!(found["dragged"]["seen"], right);
    let pointed = found["pointed"].as_str().expect("a text");
    assert!(
        pointed.starts_with("Column 14, row 9\nreference: "),
        "{pointed}"
    );

    // Zoom leaves the divider where it is.
    let zoomed = found["zoomed"].as_f64().expect("a number");
    assert!((zoomed - 1.5 * 1.5 * 2.0).abs() < 1e-3, "{zoomed}");
    check_close(&found["zoomedDivider"], 0.3);
    assert_eq!(found["fit"], 1.0);

    // Errors have the colours that `compare` gives them.
    assert_eq!(found["scale"], true);
    let errors = relative_square_errors(&image, &reference);
    for ([x, y], pixel) in [[10, 12], [3, 4], [17, 8]]
        .into_iter()
        .zip(found["errors"].as_array().expect("pixels"))
    {
        // From 0.1% to 100%.
        let place = (0.5 * errors[y * 20 + x].log10() + 3.0) / 3.0;
        for (c, expected) in false_color(place).into_iter().enumerate() {
            let byte = pixel[c].as_f64().expect("a byte");
            assert!(
                (byte - f64::from(expected)).abs() <= 6.0,
                "{x} {y} {pixel} {place}"
            );
        }
    }

    // An image of another size is not shown beside one that it does not fit.
    assert_eq!(
        found["other"],
        json!({ "right": "4", "against": "", "sizes": [6, 4] })
    );
}

fn check_close(value: &Value, expected: f64) {
    let value = value.as_f64().expect("a number");
    assert!((value - expected).abs() < 0.005, "{value} {expected}");
}

/// The transfer function of sRGB (IEC 61966-2-1), from 0 to 255.
fn srgb(linear: f64) -> f64 {
    let encoded = if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    };
    (255.0 * encoded.clamp(0.0, 1.0)).round()
}

/// No text of a hostile file runs as a script.
#[test]
fn a_hostile_page_runs_nothing() {
    let Some(browser) = Browser::find() else {
        eprintln!("skipped: there is no Chromium on this machine to look at the page with");
        return;
    };
    let place = Workplace::new();
    hostile(&place);
    place.run("report out").assert().success();
    let page = Page::read(&place.path("out/report.html"));
    let found = browser.run(
        &page,
        "found.options = [...document.getElementById('left').options].length;",
    );
    assert_eq!(found["problems"], json!([]));
    assert_eq!(found["options"], 1);
}

/// The pixels on the screen change with the divider.
#[test]
fn the_screen_shows_the_divider_move() {
    let Some(browser) = Browser::find() else {
        eprintln!("skipped: there is no Chromium on this machine to look at the page with");
        return;
    };
    let place = Workplace::new();
    for (name, radiance) in [("a", "0"), ("b", "1")] {
        let command = format!(
            "render sky.xml --integrator path --spp 1 -D radiance={radiance} -o out/{name}.exr -q"
        );
        fs::create_dir_all(place.path("out")).expect("made");
        place.run(&command).assert().success();
    }
    place.run("report out").assert().success();
    let page = Page::read(&place.path("out/report.html"));
    // Columns of the screen that are white at the height of the image, black being the other image.
    let white = |split: u32| -> u32 {
        let script = format!(
            "const split = document.getElementById('split'); split.value = {split}; \
             split.dispatchEvent(new Event('input')); \
             const view = document.getElementById('view'); \
             view.style.cssText += 'position: fixed; inset: 0; width: 100vw; z-index: 1';"
        );
        let path: &Path = &place.path("screen.png");
        browser.screenshot(&page, &script, path);
        let screen = image::open(path).expect("a picture").into_rgb8();
        let row = screen.height() / 2;
        let columns = (0..screen.width()).filter(|&x| screen.get_pixel(x, row).0 == [255; 3]);
        100 * columns.count() as u32 / screen.width()
    };
    let [near, far] = [25, 75].map(white);
    assert!(
        near.abs_diff(75) <= 3 && far.abs_diff(25) <= 3,
        "{near} {far}"
    );
}
