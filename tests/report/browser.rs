//! The page in a headless Chromium: actions of a user and their effect.

use std::fs;
use std::path::Path;

use metrolight::metrics::relative_square_errors;
use metrolight::plot::false_color;
use serde_json::{Value, json};

use crate::common::page::{Browser, Page};
use crate::common::workplace::Workplace;
use crate::{hostile, whole_page};

/// Actions of a user, and what is seen after each.
const USE: &str = r#"
const element = (id) => document.getElementById(id);
const set = (id, value, event) => {
  element(id).value = value;
  element(id).dispatchEvent(new Event(event, { bubbles: true }));
};
const canvas = element("right-canvas");
const pixel = (x, y) => [...canvas.getContext("2d").getImageData(x, y, 1, 1).data];
const box = () => element("view").getBoundingClientRect();
// The image that is visible at a share of the view's width.
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
found.exposed = [0, 1, 2, 3].map((stops) => {
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
        eprintln!("skipped: no Chromium was found");
        return;
    };
    let place = Workplace::new();
    let page = whole_page(&place);
    let found = browser.run(&page, USE);
    let [reference, image] =
        ["reference", "bdpt"].map(|name| place.pixels(&format!("out/{name}.exr")));
    assert_eq!(found["problems"], json!([]), "{found:#}");

    // All pictures and images are loaded.
    assert_eq!(found["pictures"], json!(vec![true; 10]));
    assert_eq!(found["sizes"], json!([20, 15]));
    assert_eq!(found["names"], json!(["reference", "bdpt"]));

    // Exposure scales the linear values: the pixels are those of a PNG of the brighter image.
    let shown = image[12 * 20 + 10];
    for (stops, pixel) in (0..4).zip(found["exposed"].as_array().expect("pixels")) {
        for (c, value) in shown.iter().enumerate() {
            let expected = srgb(f64::from(*value) * f64::from(1 << stops));
            let byte = pixel[c].as_f64().expect("a byte");
            assert!(
                (byte - expected).abs() <= 1.0,
                "{stops} {c}: {byte} {expected}"
            );
        }
    }
    assert_ne!(found["exposed"][0], found["exposed"][3]);
    assert_eq!(found["stops"], "+3 stops");

    // The slider and the pointer move the divider, which separates the images.
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

    // Zoom does not move the divider.
    let zoomed = found["zoomed"].as_f64().expect("a number");
    assert!((zoomed - 1.5 * 1.5 * 2.0).abs() < 1e-3, "{zoomed}");
    check_close(&found["zoomedDivider"], 0.3);
    assert_eq!(found["fit"], 1.0);

    // Errors have the colours of `compare`.
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

    // Images of different sizes are not shown together.
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

/// Text of a hostile file does not run as a script.
#[test]
fn a_hostile_page_runs_nothing() {
    let Some(browser) = Browser::find() else {
        eprintln!("skipped: no Chromium was found");
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

/// The divider changes the pixels on the screen.
#[test]
fn the_screen_shows_the_divider_move() {
    let Some(browser) = Browser::find() else {
        eprintln!("skipped: no Chromium was found");
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
    // Percentage of white columns in the middle row of the screen; the other image is black.
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
