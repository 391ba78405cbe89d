//! The command line: exit codes, files and messages.

mod common;

use std::fs;
use std::path::{Path, PathBuf};

use predicates::prelude::*;
use predicates::str::{contains, is_empty};
use serde_json::Value;

use common::workplace::{ROOM, Workplace, read};

fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

#[test]
fn the_image_is_named_after_the_scene() {
    let place = Workplace::new();
    let summary = contains("wrote room.exr and room.png: 20 x 15 pixels")
        .and(contains("path: 300 samples (1 per pixel)"));
    place
        .run("render room.xml --integrator path --spp 1")
        .assert()
        .success()
        .stdout(summary);
    assert_eq!(
        place.files(),
        ["room.exr", "room.png", "room.xml", "sky.xml"]
    );
    let image = read(&place.path("room.exr"));
    assert_eq!((image.width, image.height), (20, 15));
    assert!(image.pixels.iter().any(|p| p[0] > 0.0));

    // A file named `scene` takes the name of its directory.
    fs::create_dir(place.path("pool.2")).expect("created");
    fs::copy(place.path("sky.xml"), place.path("pool.2/scene.xml")).expect("copied");
    place
        .run("render pool.2/scene.xml --spp 1 --integrator bdpt")
        .assert()
        .success();
    assert!(place.path("pool.2.exr").exists() && place.path("pool.2.png").exists());

    place
        .run("render sky.xml --spp 1 --integrator light -o pool.2/a.b.exr")
        .assert()
        .success();
    assert!(place.path("pool.2/a.b.exr").exists() && place.path("pool.2/a.b.png").exists());
}

#[test]
fn size_depth_and_variables_override_the_scene() {
    let place = Workplace::new();
    place
        .run("render sky.xml --integrator path --spp 2 --size 3x5 -D radiance=4 --stats s.json")
        .args(["--max-depth", "-1"])
        .assert()
        .success();
    let image = read(&place.path("sky.exr"));
    assert_eq!((image.width, image.height), (3, 5));
    assert!(
        image.pixels.iter().all(|p| *p == [4.0; 3]),
        "{:?}",
        image.pixels
    );
    assert_eq!(place.json("s.json")["max_depth"], Value::Null);

    // Depth 1 shows emitters only, and the lamp is outside the camera's view.
    place
        .run("render room.xml --integrator path --spp 4 --max-depth 1")
        .assert()
        .success();
    assert!(place.pixels("room.exr").iter().all(|p| *p == [0.0; 3]));
}

#[test]
fn wrong_arguments_are_explained() {
    let place = Workplace::new();
    for (arguments, message) in [
        ("paint room.xml", "unrecognized subcommand 'paint'"),
        ("render room.xml --sp 1", "unexpected argument '--sp'"),
        ("render room.xml --spp 0", "from 1 to"),
        ("render room.xml --spp 1 --time 1s", "cannot be used with"),
        ("render room.xml --time 0s", "60s, 2m, 1.5h"),
        ("render room.xml --time 5x", "60s, 2m, 1.5h"),
        ("render room.xml --size 0x4", "640x480"),
        ("render room.xml --size 20", "640x480"),
        ("render room.xml --threads 0", "from 1 to"),
        (
            "render room.xml --large-step-probability 1.5",
            "from 0 to 1",
        ),
        (
            "render room.xml --integrator vcm",
            "path, light, bdpt, pssmlt, mmlt",
        ),
        (
            "render room.xml --integrator bdpt --chains 4",
            "--chains applies to pssmlt, not to bdpt",
        ),
        (
            "render room.xml --chains 4",
            "--chains needs --integrator pssmlt",
        ),
        (
            "render room.xml --integrator pssmlt --direct joint",
            "--direct applies to mmlt, not to pssmlt",
        ),
        ("render room.xml --threshold -1", "a number of at least 0"),
        ("render room.xml --small-step log:1:2", "log:0.001:0.016"),
        (
            "render room.xml --integrator pssmlt --target-error 1 --chains 1",
            "needs --chains 2 or more",
        ),
        ("render room.xml --max-depth 0", "-1 for no limit"),
        ("render room.xml -D radiance", "name=value"),
        ("render room.xml -o room.png", "ends in .exr"),
        ("completions basic", "bash"),
    ] {
        place.assert_rejects(arguments, message);
    }
    assert_eq!(place.files(), ["room.xml", "sky.xml"]);
}

#[test]
fn scenes_that_cannot_be_rendered_are_explained() {
    let place = Workplace::new();
    fs::write(
        place.path("broken.xml"),
        ROOM.replace("dielectric", "dielektric"),
    )
    .expect("written");
    for command in ["render", "check"] {
        for (scene, message) in [
            ("absent.xml", "absent.xml"),
            ("broken.xml", "broken.xml:19:"),
            ("broken.xml", "dielectric"),
        ] {
            let assert = place.run(&format!("{command} {scene}")).assert();
            // Without a terminal there are no colours and no backtrace.
            let plain = contains("\u{1b}").not().and(contains("backtrace").not());
            assert
                .code(2)
                .stdout(is_empty())
                .stderr(contains(message).and(plain));
        }
    }
    assert_eq!(place.files(), ["broken.xml", "room.xml", "sky.xml"]);
}

/// If it were noticed only at the end, the render would take an hour and be killed by the timeout.
#[test]
fn an_output_that_cannot_be_written_is_noticed_before_rendering() {
    let place = Workplace::new();
    fs::create_dir(place.path("folder.exr")).expect("created");
    for (output, message) in [
        ("-o absent/a.exr", "there is no directory absent"),
        ("-o room.xml/a.exr", "there is no directory room.xml"),
        ("-o folder.exr", "cannot write folder.exr"),
        ("--stats absent/s.json", "cannot write absent/s.json"),
    ] {
        let arguments = format!("render room.xml --time 1h {output}");
        let mut command = place.run(&arguments);
        command.timeout(std::time::Duration::from_secs(60));
        command.assert().code(2).stderr(contains(message));
    }
    assert_eq!(place.files(), ["folder.exr", "room.xml", "sky.xml"]);
}

#[test]
fn quiet_is_silent() {
    let place = Workplace::new();
    for integrator in ["bdpt", "pssmlt", "mmlt"] {
        let arguments = format!("render sky.xml --quiet --spp 4 --integrator {integrator}");
        let assert = place.run(&arguments).assert();
        assert.success().stdout(is_empty()).stderr(is_empty());
        fs::remove_file(place.path("sky.exr")).expect("written");
    }
}

/// As with `| head`.
#[test]
fn a_closed_pipe_is_no_error() {
    let place = Workplace::new();
    for arguments in [
        "check room.xml",
        "completions zsh",
        "render sky.xml --spp 1",
    ] {
        let closed = || std::io::pipe().expect("a pipe").1;
        let status = std::process::Command::new(assert_cmd::cargo::cargo_bin("metrolight"))
            .current_dir(place.path(""))
            .args(arguments.split(' '))
            .stdout(closed())
            .stderr(closed())
            .status();
        assert_eq!(status.expect("started").code(), Some(0), "{arguments}");
    }
}

#[test]
fn statistics_are_written_to_json_and_to_the_image() {
    let place = Workplace::new();
    let common = "--spp 3 --seed 7 --threads 2 --stats s.json -D radiance=2";
    place
        .run(&format!("render room.xml --integrator bdpt {common}"))
        .assert()
        .success();
    let stats = place.json("s.json");
    assert_eq!(stats["integrator"], "bdpt");
    assert_eq!(stats["scene"], "room.xml");
    assert_eq!(stats["seed"], 7);
    assert_eq!(stats["size"], serde_json::json!([20, 15]));
    assert_eq!(stats["threads"], 2);
    assert_eq!(stats["samples"], 3 * 20 * 15);
    assert_eq!(stats["defines"]["radiance"], "2");
    assert_eq!(stats["budget"]["samples_per_pixel"], 3);
    assert_eq!(stats["max_depth"], 6);
    assert_eq!(stats["non_finite"], 0);
    assert_eq!(stats["interrupted"], false);
    assert_eq!(stats.get("pssmlt"), None);
    let positive = [
        "load_seconds",
        "build_seconds",
        "render_seconds",
        "samples_per_second",
        "closest_hit_rays",
        "shadow_rays",
        "chain_searches",
        "rays_per_second",
    ];
    for name in positive {
        assert!(
            stats[name].as_f64().is_some_and(|v| v > 0.0),
            "{name}: {}",
            stats[name]
        );
    }

    let pssmlt =
        format!("render room.xml --integrator pssmlt --bootstrap 5000 --chains 8 {common}");
    let summary = contains("b = ")
        .and(contains("+-"))
        .and(contains("% of large steps and "));
    place.run(&pssmlt).assert().success().stdout(summary);
    let stats = place.json("s.json");
    let metropolis = &stats["pssmlt"];
    assert_eq!(metropolis["chains"], 8);
    assert_eq!(metropolis["bootstrap_samples"], 5000);
    for path in [
        "/b",
        "/b_standard_error",
        "/mutations/0/acceptance_rate",
        "/mutations/1/acceptance_rate",
        "/longest_rejection_run",
    ] {
        let value = metropolis.pointer(path).and_then(Value::as_f64);
        assert!(value.is_some_and(|v| v > 0.0), "{path}: {value:?}");
    }
    assert_attributes(&place.path("room.exr"), &stats);
}

/// Without `--integrator` a pilot chooses, and the choice is printed with its reason: chains do not
/// help in a scene with a visible lamp, but with a lamp behind glass.
#[test]
fn a_pilot_chooses_the_integrator() {
    let place = Workplace::new();
    for (scene, chosen) in [("cornell", "bdpt or mmlt"), ("pool", "mmlt")] {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes");
        let arguments =
            format!("render {path}/{scene}/scene.xml --size 16x12 --spp 2 --stats s.json");
        let told = contains(" is chosen: ").and(contains("--integrator overrides it"));
        place.run(&arguments).assert().success().stderr(told);
        let stats = place.json("s.json");
        let integrator = stats["integrator"].as_str().expect("a name").to_owned();
        assert!(chosen.contains(&integrator), "{scene}: {integrator}");
        assert_eq!(stats["mmlt"].is_object(), integrator == "mmlt");
    }
    let arguments = "render sky.xml --spp 2 --stats s.json";
    let told = contains("bdpt is chosen: no path is bright enough");
    place.run(arguments).assert().success().stderr(told);
    assert_eq!(place.json("s.json")["integrator"], "bdpt");
}

/// Asserts that the image at `path` has some of the statistics in `stats` as attributes.
fn assert_attributes(path: &Path, stats: &Value) {
    use exr::meta::attribute::{AttributeValue, Text};
    let meta = exr::meta::MetaData::read_from_file(path, false).expect("an image");
    let attributes = &meta.headers[0].own_attributes.other;
    let number = |name: &str| match attributes.get(&Text::from(name)) {
        Some(AttributeValue::F64(number)) => Some(*number),
        _ => None,
    };
    assert_eq!(number("metrolight.seed"), Some(7.0));
    assert_eq!(number("metrolight.size.1"), Some(15.0));
    assert_eq!(number("metrolight.pssmlt.b"), stats["pssmlt"]["b"].as_f64());
    let text = AttributeValue::Text(Text::from("pssmlt"));
    assert_eq!(
        attributes.get(&Text::from("metrolight.integrator")),
        Some(&text)
    );
}

#[test]
fn the_image_depends_on_the_seed_and_not_on_the_threads() {
    let place = Workplace::new();
    for integrator in ["path", "light", "bdpt", "pssmlt", "mmlt"] {
        let mut images = Vec::new();
        for (threads, seed) in [(1, 1), (2, 1), (3, 1), (2, 2)] {
            let arguments = format!(
                "render room.xml -q --spp 5 --integrator {integrator} --threads {threads} --seed {seed}"
            );
            place.run(&arguments).assert().success();
            images.push(place.pixels("room.exr"));
        }
        assert!(
            images[0] == images[1],
            "{integrator}: 1 and 2 threads differ"
        );
        assert!(
            images[0] == images[2],
            "{integrator}: 1 and 3 threads differ"
        );
        assert!(images[0] != images[3], "{integrator}: seeds do not differ");
    }
}

#[cfg(unix)]
#[test]
fn an_interrupted_render_keeps_its_image() {
    let place = Workplace::new();
    for integrator in ["bdpt", "pssmlt", "mmlt"] {
        let arguments =
            format!("render room.xml --time 1h --integrator {integrator} --stats s.json");
        common::interrupt::interrupt(&place, &arguments);
        assert!(place.pixels("room.exr").iter().any(|p| p[0] > 0.0));
        assert_eq!(place.json("s.json")["interrupted"], true);
        fs::remove_file(place.path("room.exr")).expect("removed");
    }
}

#[test]
fn check_lists_the_contents_of_a_scene() {
    let place = Workplace::new();
    place
        .run("check room.xml --size 8x6")
        .assert()
        .success()
        .stdout(
            contains("8 x 6 pixels, filter tent")
                .and(contains("3 (triangles 4, spheres 1)"))
                .and(contains("at most 6 edges"))
                .and(contains("1 dielectric"))
                .and(contains("1 area"))
                .and(contains(
                    "(-3.0000, 0.0000, -3.0000) to (3.0000, 3.0000, 3.0000)",
                )),
        );
    assert_eq!(place.files(), ["room.xml", "sky.xml"]);
}

#[test]
fn check_and_render_warn_of_lost_light() {
    let place = Workplace::new();
    let scene = repository("scenes/lost-caustic/scene.xml")
        .display()
        .to_string();
    place
        .run(&format!("check {scene}"))
        .assert()
        .success()
        .stderr(contains("warning: lost light"));
    let render = format!("render {scene} -q --spp 1 --size 8x6 --integrator bdpt");
    place
        .run(&render)
        .assert()
        .success()
        .stderr(contains("warning: lost light"));
    assert!(place.path("lost-caustic.exr").exists());
}

/// A closed white room that emits light, with unlimited paths. A limit removes the warning.
#[test]
fn check_and_render_warn_of_trapped_light() {
    const FURNACE: &str = r#"<scene version="3.0.0">
        <sensor type="perspective"/>
        <shape type="sphere">
            <boolean name="flip_normals" value="true"/>
            <bsdf type="diffuse"><rgb name="reflectance" value="1, 1, 1"/></bsdf>
            <emitter type="area"><rgb name="radiance" value="1, 1, 1"/></emitter>
        </shape>
    </scene>"#;
    let place = Workplace::new();
    fs::write(place.path("furnace.xml"), FURNACE).expect("written");
    let render = "render furnace.xml -q --spp 1 --size 8x6 --integrator bdpt";
    for command in ["check furnace.xml", render] {
        place
            .run(command)
            .assert()
            .success()
            .stderr(contains("warning: trapped light: 100%"));
        place
            .run(&format!("{command} --max-depth 9"))
            .assert()
            .success()
            .stderr(contains("trapped light").not());
    }
}

#[test]
fn help_has_examples_defaults_and_exit_codes() {
    let place = Workplace::new();
    for command in ["--help", "render --help", "check --help"] {
        place
            .run(command)
            .assert()
            .success()
            .stdout(contains("Exit codes"));
    }
    place.run("render --help").assert().success().stdout(
        contains("Examples:")
            .and(contains("60s, 2m, 1.5h"))
            .and(contains("[default: path 64"))
            .and(contains(
                "[default: bdpt or mmlt; a short pilot render decides]",
            )),
    );
    place
        .run("completions bash")
        .assert()
        .success()
        .stdout(contains("_metrolight"));
}
