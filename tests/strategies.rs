//! Images of single techniques: their sum is the image, and `metrolight strategies` writes them.

mod common;

use std::fs;

use common::workplace::{ROOM, Workplace};
use metrolight::mitsuba::{Overrides, load_with};
use metrolight::render::{Budget, Method, Settings, Strategies, Unobserved, render, strategies};
use metrolight::scene::Scene;
use metrolight::technique::Technique;
use predicates::prelude::*;
use predicates::str::contains;

fn settings(threads: usize) -> Settings {
    Settings {
        budget: Budget::SamplesPerPixel(6),
        seed: 5,
        threads: Some(threads),
        ..Settings::new(Method::Bdpt)
    }
}

fn small(path: &std::path::Path, edges: u32) -> Scene {
    let overrides = Overrides {
        size: Some([37, 23]),
    };
    let mut description = load_with(path, &[], overrides)
        .expect("a scene")
        .description;
    description.depth.max_depth = Some(edges);
    description.build().expect("a scene")
}

fn found(scene: &Scene, threads: usize) -> Strategies {
    strategies(scene, &settings(threads), &Unobserved).expect("images")
}

/// Equal up to the rounding of sums in f32, in which the render adds the techniques of a sample. The
/// scenes have filters wider than a pixel, splats, specular surfaces and lost light.
#[test]
fn weighted_images_add_up_to_the_render_of_the_same_samples() {
    let place = Workplace::new();
    fs::write(place.path("room.xml"), ROOM).expect("written");
    let repository = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    for (path, edges) in [
        (place.path("room.xml"), 6),
        (repository.join("scenes/spheres/scene.xml"), 5),
        (repository.join("scenes/cornell/scene.xml"), 2),
    ] {
        let scene = small(&path, edges);
        let image = render(&scene, &settings(2), &Unobserved)
            .expect("an image")
            .image;
        let images = found(&scene, 2).images;
        let mut light = 0.0;
        for (i, pixel) in image.pixels.iter().enumerate() {
            for (c, &expected) in pixel.iter().enumerate() {
                let weighted = images.iter().map(|images| images.weighted.pixels[i][c]);
                let sum: f64 = weighted.map(f64::from).sum();
                let expected = f64::from(expected);
                assert!(
                    (sum - expected).abs() <= 2e-6 * expected.max(1e-3),
                    "{}, pixel {i}, channel {c}: {sum} {expected}",
                    path.display()
                );
                light += sum;
            }
        }
        assert!(light > 0.0, "{}", path.display());
    }
}

#[test]
fn images_do_not_depend_on_the_number_of_threads() {
    let place = Workplace::new();
    let scene = small(&place.path("room.xml"), 4);
    assert_eq!(found(&scene, 1).images, found(&scene, 3).images);
}

/// A glass sphere on a floor, with paths of 4 edges. Next event estimation finds the floor seen through
/// the sphere, t = 1 finds the sphere's caustic, s = 0 finds both, and connections of inner vertices
/// find nothing.
#[test]
fn each_technique_finds_its_light() {
    let place = Workplace::new();
    let scene = small(&place.path("room.xml"), 4);
    let settings = Settings {
        budget: Budget::SamplesPerPixel(400),
        ..settings(2)
    };
    let found = strategies(&scene, &settings, &Unobserved).expect("images");
    let mean = |s: usize, t: usize| {
        let technique = Technique::new(s, t);
        let mut images = found.images.iter();
        let images = images.find(|images| images.technique == technique);
        let pixels = &images.expect("the technique").unweighted.pixels;
        pixels.iter().map(|pixel| pixel[1]).sum::<f32>() / pixels.len() as f32
    };
    let [all, seen, caustic] = [mean(0, 5), mean(1, 4), mean(4, 1)];
    assert!(
        seen > 0.2 * all && caustic > 0.2 * all,
        "{seen} {caustic} {all}"
    );
    assert!(
        ((seen + caustic) / all - 1.0).abs() < 0.05,
        "{seen} {caustic} {all}"
    );
    assert_eq!([mean(2, 3), mean(3, 2)], [0.0; 2]);
    assert!((mean(2, 1) / mean(1, 2) - 1.0).abs() < 0.02);
}

#[test]
fn images_and_two_contact_sheets_are_written() {
    let place = Workplace::new();
    place
        .run("strategies room.xml -o made/here --spp 4 --max-depth 3 --seed 9 --exposure -1")
        .assert()
        .success()
        .stdout(contains("weighted.png").and(contains("2 edges")));
    let directory = place.path("made/here");
    assert_eq!(fs::read_dir(&directory).expect("made").count(), 2 * 8 + 3);
    let json = place.json("made/here/strategies.json");
    assert_eq!(json["max_depth"], 3);
    assert_eq!(json["statistics"]["seed"], 9);
    assert_eq!(json["exposures"], serde_json::json!([-1.0, -1.0, -1.0]));
    let techniques = json["techniques"].as_array().expect("a list");
    let shares = techniques
        .iter()
        .map(|t| t["share"].as_f64().expect("a number"));
    assert!((shares.sum::<f64>() - 1.0).abs() < 1e-9);
    for technique in techniques {
        for kind in ["weighted", "unweighted"] {
            let name = technique[kind].as_str().expect("a name");
            assert_eq!(place.pixels(&format!("made/here/{name}")).len(), 300);
        }
    }
    for sheet in ["weighted.png", "unweighted.png"] {
        let png = fs::read(directory.join(sheet)).expect("written");
        assert!(image::load_from_memory(&png).expect("a PNG").width() >= 620);
    }

    // The samples are those of a render.
    place
        .run("render room.xml -q --integrator bdpt --spp 4 --max-depth 3 --seed 9")
        .assert()
        .success();
    let mut sum = vec![0.0; 300];
    for technique in techniques {
        let name = technique["weighted"].as_str().expect("a name");
        let pixels = place.pixels(&format!("made/here/{name}"));
        sum.iter_mut().zip(pixels).for_each(|(sum, p)| *sum += p[1]);
    }
    let image = place.pixels("room.exr");
    assert!(
        image
            .iter()
            .zip(sum)
            .all(|(p, sum)| (p[1] - sum).abs() < 1e-5)
    );
}

#[test]
fn wrong_arguments_are_explained() {
    let place = Workplace::new();
    place
        .run("strategies --help")
        .assert()
        .success()
        .stdout(contains("2 adds direct light [default: 5]"));
    let before = place.files();
    for (arguments, message) in [
        (
            "strategies room.xml -o out --max-depth -1",
            "a limit is needed, such as 5",
        ),
        (
            "strategies room.xml -o out --max-depth 4000000000",
            "at most 24 edges",
        ),
        (
            "strategies room.xml -o out --size 20000x10000",
            "22 techniques at 200000000 pixels would take",
        ),
        ("strategies none.xml -o out", "none.xml"),
        ("strategies room.xml -o sky.xml", "it is a file"),
        ("strategies room.xml", "--output <DIR>"),
        (
            "strategies room.xml -o out --exposure x",
            "expected a number of stops",
        ),
    ] {
        place.assert_rejects(arguments, message);
        assert_eq!(place.files(), before, "{arguments}");
    }
}

#[cfg(unix)]
#[test]
fn interrupted_techniques_are_kept() {
    let place = Workplace::new();
    common::interrupt::interrupt(&place, "strategies room.xml -o out --spp 100000000");
    assert_eq!(place.json("out/strategies.json")["interrupted"], true);
    let pixels = place.pixels("out/weighted_s1_t2.exr");
    assert!(pixels.iter().any(|p| p[0] > 0.0));
}
