//! `metrolight converge`: its measurements are those of renders, and its output follows from the
//! measurements.

mod common;

use std::fs;
use std::sync::Mutex;

use common::renders::with_pssmlt;
use common::workplace::Workplace;
use metrolight::film::Image;
use metrolight::metrics::relative_mse;
use metrolight::render::{Budget, Method, Observer, Progress, Settings, Unobserved, render};
use predicates::str::contains;

/// Rows of a CSV file, by column name.
fn table(place: &Workplace, name: &str) -> Vec<std::collections::HashMap<String, String>> {
    let mut reader = csv::Reader::from_path(place.path(name)).expect("a table");
    reader
        .deserialize()
        .map(|row| row.expect("a row"))
        .collect()
}

#[test]
fn every_measurement_is_in_the_table_and_the_last_is_that_of_the_image() {
    let place = Workplace::new();
    place
        .run("render room.xml --integrator bdpt --spp 256 --seed 99 --error -o truth.exr -q")
        .assert()
        .success();
    place
        .run(
            "converge room.xml --integrators bdpt,path,pssmlt --spp 16 --repeats 2 --seed 5 \
             --reference truth.exr -o chart",
        )
        .assert()
        .success()
        .stdout(contains("truth.exr; its own relMSE is about"))
        .stdout(contains("bdpt's"));
    let rows = table(&place, "chart/convergence.csv");
    let truth = place.pixels("truth.exr");
    for label in ["bdpt", "path", "pssmlt"] {
        for repeat in ["0", "1"] {
            let run: Vec<_> = rows
                .iter()
                .filter(|row| row["label"] == label && row["repeat"] == repeat)
                .collect();
            let column = |name: &str| -> Vec<f64> {
                run.iter()
                    .map(|row| row[name].parse().expect("a number"))
                    .collect()
            };
            for rising in ["checkpoint", "seconds", "samples_per_pixel", "rays"] {
                let values = column(rising);
                assert!(
                    values.windows(2).all(|p| p[0] < p[1]),
                    "{label} {rising}: {values:?}"
                );
            }
            assert_eq!(column("samples_per_pixel").last(), Some(&16.0));
            assert_eq!(run[0]["seed"], if repeat == "0" { "5" } else { "6" });
            if repeat == "0" {
                let image = place.pixels(&format!("chart/{label}.exr"));
                let measured = column("relmse").pop().expect("a measurement");
                let error = relative_mse(&image, &truth);
                assert!(
                    (measured / error - 1.0).abs() < 1e-9,
                    "{label}: {measured} {error}"
                );
            }
        }
    }
    let json = place.json("chart/convergence.json");
    assert_eq!(json["variants"].as_array().map(Vec::len), Some(3));
    assert_eq!(json["settings"]["budget"]["samples_per_pixel"], 16);
    for file in ["convergence.svg", "convergence.png", "path.png"] {
        assert!(
            fs::metadata(place.path("chart").join(file)).is_ok(),
            "{file}"
        );
    }
    // The error image is that of `compare`.
    place
        .run("compare chart/path.exr truth.exr -o compared")
        .assert()
        .success();
    let [ours, theirs] = ["chart/path-error.png", "compared/error.png"];
    let [ours, theirs] = [ours, theirs].map(|name| fs::read(place.path(name)).expect("a file"));
    assert_eq!(ours, theirs);
}

#[test]
fn a_missing_reference_is_rendered_and_each_swept_value_has_a_curve() {
    let place = Workplace::new();
    place
        .run(
            "converge room.xml --integrators bdpt,pssmlt --spp 4 --repeats 1 --reference-effort 2 \
             --sweep chains=16,64 --reference-integrator bdpt -o deep/chart",
        )
        .assert()
        .success()
        .stdout(contains("reference: bdpt, 8 samples per pixel"))
        .stderr(contains("the reference's own relMSE"));
    let rows = table(&place, "deep/chart/convergence.csv");
    let mut labels: Vec<&str> = rows.iter().map(|row| &*row["label"]).collect();
    labels.dedup();
    assert_eq!(labels, ["bdpt", "pssmlt chains 16", "pssmlt chains 64"]);
    assert!(place.path("deep/chart/pssmlt-chains-64.exr").exists());
    assert!(place.path("deep/chart/reference.exr").exists());
}

#[test]
fn wrong_arguments_are_explained() {
    let place = Workplace::new();
    fs::write(place.path("file"), "").expect("written");
    for (arguments, message) in [
        (
            "converge room.xml --integrators bdpt,vcm -o chart",
            "path, light, bdpt, pssmlt, mmlt",
        ),
        (
            "converge room.xml --integrators bdpt,bdpt -o chart",
            "bdpt is named twice",
        ),
        (
            "converge room.xml --integrators bdpt --sweep spp=1 -o chart",
            "chains",
        ),
        (
            "converge room.xml --integrators bdpt --sweep chains=4 -o chart",
            "applies to none",
        ),
        (
            "converge room.xml --integrators bdpt --repeats 0 -o chart",
            "from 1 to 10000",
        ),
        (
            "converge room.xml --integrators bdpt --reference no.exr -o chart",
            "no.exr",
        ),
        ("converge room.xml --integrators bdpt -o file", "file"),
    ] {
        place.assert_rejects(arguments, message);
    }
    place
        .run("render sky.xml --integrator path --spp 1 -o small.exr -q")
        .assert()
        .success();
    place.assert_rejects(
        "converge room.xml --integrators bdpt --reference small.exr -o chart",
        "6 x 4 pixels, but the scene has 20 x 15",
    );
}

/// Asks for every image.
#[derive(Default)]
struct Watcher(Mutex<Vec<(Progress, Image)>>);

impl Observer for Watcher {
    fn phase(&self, _name: &str) {}
    fn progress(&self, _fraction: f64, _seconds_left: Option<f64>) {}
    fn interrupted(&self) -> bool {
        false
    }
    fn wants_snapshot(&self, _moment: &Progress) -> bool {
        true
    }
    fn on_snapshot(&self, moment: &Progress, image: &Image) {
        self.0
            .lock()
            .expect("no panic")
            .push((*moment, image.clone()));
    }
}

/// An intermediate image is bit-identical to that of a render that ends there, and so are later images.
/// With chains only the last images can be compared, because chains make their mutations in turn; each
/// intermediate image rounds the weights of their states to f32 once more.
#[test]
fn intermediate_images_do_not_change_later_images() {
    let sizes = [("resx", "256"), ("resy", "256")];
    let scene = common::load("scenes/cornell/scene.xml", &sizes);
    for integrator in [Method::Bdpt, Method::Pssmlt] {
        let with_spp = |n| {
            with_pssmlt(
                Settings {
                    budget: Budget::SamplesPerPixel(n),
                    ..Settings::new(integrator)
                },
                |own| {
                    own.bootstrap = Some(4096);
                },
            )
        };
        let alone = |n| render(&scene, &with_spp(n), &Unobserved).expect("threads");
        let watcher = Watcher::default();
        let watched = render(&scene, &with_spp(3), &watcher).expect("threads");
        let looks = watcher.0.into_inner().expect("no panic");
        let metropolis = integrator == Method::Pssmlt;
        let compared = if metropolis { &looks[3..] } else { &looks[..] };
        for (moment, image) in compared {
            let alone = alone(moment.samples / 65536);
            let statistics = &alone.statistics;
            assert_eq!(moment.samples, statistics.samples);
            assert_eq!(
                moment.rays,
                statistics.closest_hit_rays + statistics.shadow_rays
            );
            let difference = relative_mse(&image.pixels, &alone.image.pixels);
            let rounding = if metropolis { 1e-10 } else { 0.0 };
            assert!(difference <= rounding, "{integrator:?}: {difference:e}");
        }
        let last = &looks.last().expect("a look").1;
        assert_eq!(last.pixels, watched.image.pixels);
    }
}
