//! `metrolight compare`: its measures, its test for bias and its messages.

mod common;

use std::fs;

use common::workplace::Workplace;
use metrolight::film::{Image, write_exr};
use predicates::prelude::*;
use predicates::str::{contains, starts_with};
use serde_json::Value;

/// Writes an image of `width` x 4 pixels, all 1 except one.
fn write(place: &Workplace, name: &str, width: usize, pixel: [f32; 3]) {
    let mut pixels = vec![[1.0; 3]; width * 4];
    pixels[width + 2] = pixel;
    let image = Image {
        width,
        height: 4,
        pixels,
    };
    write_exr(&place.path(name), &image, &[], &[]).expect("written");
}

#[test]
fn measures_are_printed_and_written() {
    let place = Workplace::new();
    write(&place, "r.exr", 5, [1.0; 3]);
    write(&place, "a.exr", 5, [3.0; 3]);
    // One pixel of 20 is off by 2: MSE 4/20, relMSE 4/1.01/20, mean ratio 22/20.
    place.run("compare a.exr r.exr").assert().success().stdout(
        starts_with("a.exr against r.exr: relMSE 1.980e-1, 10.0% brighter; bias not tested\n")
            .and(contains("\n  MSE              2.0000e-1\n"))
            .and(contains("\n  mean ratio       1.100000\n"))
            .and(contains("67 pixels per degree"))
            .and(contains("without the worst 0 of 20 pixels"))
            .and(contains("1 exposures from").not())
            .and(contains("not tested: neither image has standard errors")),
    );
    let output = place
        .run("compare a.exr r.exr --json -o made/here")
        .assert()
        .success();
    let printed: Value = serde_json::from_slice(&output.get_output().stdout).expect("JSON");
    assert_eq!(printed, place.json("made/here/compare.json"));
    let close = |path: &str, expected: f64| {
        let value = printed.pointer(path).and_then(Value::as_f64);
        assert!(
            value.is_some_and(|v| (v - expected).abs() < 1e-6),
            "{path}: {value:?}"
        );
    };
    close("/errors/mse", 0.2);
    close("/errors/mape", 2.0 / 1.01 / 20.0);
    close("/errors/mean_ratio", 1.1);
    assert_eq!(printed["bias"], Value::Null);
    for name in ["error.png", "flip.png"] {
        let png = fs::read(place.path(&format!("made/here/{name}"))).expect("written");
        let image = image::load_from_memory(&png).expect("a PNG").into_rgb8();
        // Each pixel is a square of 96 pixels; the first begins at (12, 45). The wrong one is in column
        // 2, row 1.
        let brightness = |x, y| {
            image
                .get_pixel(x, y)
                .0
                .iter()
                .map(|&c| u32::from(c))
                .sum::<u32>()
        };
        assert!(brightness(252, 189) > brightness(60, 381), "{name}");
    }
}

#[test]
fn an_image_is_identical_to_itself() {
    let place = Workplace::new();
    write(&place, "a.exr", 5, [0.0; 3]);
    place.run("compare a.exr a.exr").assert().success().stdout(
        starts_with("a.exr against a.exr: relMSE 0.000e0, identical;")
            .and(contains("FLIP             0.0000")),
    );
}

/// The seeds are fixed. With others a correct program fails with a probability of about 1%.
#[test]
fn bias_is_found_only_in_a_biased_image() {
    let place = Workplace::new();
    let render = |name: &str, arguments: &str| {
        let render = format!("render room.xml -q --error --size 24x16 -o {name} {arguments}");
        place.run(&render).assert().success();
    };
    render(
        "r.exr",
        "--integrator path --spp 256 --seed 1 --max-depth 2",
    );
    render("a.exr", "--integrator path --spp 64 --seed 2 --max-depth 2");
    render(
        "b.exr",
        "--integrator path --spp 64 --seed 3 --max-depth 2 -D radiance=3.3",
    );
    render("c.exr", "--integrator bdpt --spp 64 --seed 1 --max-depth 2");
    render("d.exr", "--integrator bdpt --spp 64 --seed 5 --max-depth 2");
    let compare = |image: &str| {
        let output = place
            .run(&format!("compare {image} r.exr --json"))
            .assert()
            .success();
        let value: Value = serde_json::from_slice(&output.get_output().stdout).expect("JSON");
        value
    };
    let unbiased = compare("a.exr");
    assert_eq!(unbiased["bias"]["verdict"], "none-found", "{unbiased}");
    assert_eq!(unbiased["bias"]["tiles"], 6);
    assert_eq!(unbiased["notes"], serde_json::json!([]));
    let biased = compare("b.exr");
    assert_eq!(biased["bias"]["verdict"], "differs", "{biased}");
    place
        .run("compare b.exr r.exr")
        .assert()
        .success()
        .stdout(contains("; BIASED"));
    // The correlation of pixels of bidirectional path tracing is unknown.
    let other = compare("d.exr");
    assert_ne!(other["bias"]["verdict"], "differs");
    assert_ne!(
        other["bias"]["smallest_p"],
        other["bias"]["smallest_p_if_independent"]
    );
    let same_seed = compare("c.exr");
    assert_ne!(same_seed["bias"]["verdict"], "differs");
    assert!(
        same_seed["notes"][0]
            .as_str()
            .is_some_and(|n| n.contains("the same seed"))
    );
    // One image has no standard errors.
    place.run("compare a.exr a.png").assert().success().stdout(
        contains("not tested: the reference has no standard errors")
            .and(contains("note             a.png holds no values above 1")),
    );
}

#[test]
fn images_that_cannot_be_compared_are_explained() {
    let place = Workplace::new();
    write(&place, "r.exr", 5, [1.0; 3]);
    write(&place, "wide.exr", 6, [1.0; 3]);
    write(&place, "nan.exr", 5, [1.0, f32::NAN, 1.0]);
    let depth = exr::prelude::AnyChannel::new("Z", exr::prelude::FlatSamples::F32(vec![0.0; 20]));
    let layer = exr::prelude::Layer::new(
        (5, 4),
        exr::prelude::LayerAttributes::default(),
        exr::prelude::Encoding::SMALL_LOSSLESS,
        exr::prelude::AnyChannels::sort([depth].into_iter().collect()),
    );
    exr::prelude::WritableImage::write(&exr::prelude::Image::from_layer(layer))
        .to_file(place.path("depth.exr"))
        .expect("written");
    let before = place.files();
    for (arguments, message) in [
        (
            "wide.exr r.exr -o out",
            "wide.exr has 6 x 4 pixels, r.exr has 5 x 4 pixels: images of the same size are needed",
        ),
        (
            "r.exr nan.exr -o out",
            "nan.exr: channel G of the pixel in column 2, row 1 (from 0, at the top left) is NaN",
        ),
        (
            "depth.exr r.exr -o out",
            "depth.exr: not a usable image (PNG, JPEG, OpenEXR or Radiance HDR): its channels are Z; \
             expected R, G and B, or Y",
        ),
        ("room.xml r.exr", "room.xml: not a usable image"),
        ("none.exr r.exr", "none.exr: cannot read the image"),
        (
            "r.exr r.exr -o room.xml",
            "cannot make the directory room.xml: it is a file; give the name of a directory",
        ),
        ("r.exr", "<REFERENCE>"),
    ] {
        place.assert_rejects(&format!("compare {arguments}"), message);
        assert_eq!(place.files(), before, "{arguments}");
    }
}
