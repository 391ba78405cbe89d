//! Limits: memory, counts, names, and standard output. What does not fit is refused with a message that says what
//! would.

mod common;

use std::fs;

use predicates::prelude::*;
use predicates::str::contains;

use common::workplace::Workplace;

#[test]
fn counts_state_their_greatest_value() {
    let place = Workplace::new();
    let most = "18446744073709551615";
    for (arguments, message) in [
        (
            format!("replay room.xml --integrator pssmlt --at chain=0,start=0,step={most}"),
            "at most 4294967296 steps",
        ),
        (
            format!("render room.xml --integrator pssmlt --bootstrap {most}"),
            "an integer from 1 to 4294967296",
        ),
        (
            format!("render room.xml --spp {most}"),
            "an integer from 1 to 4611686018427387904",
        ),
        (
            format!("render room.xml --samples {most}"),
            "an integer from 1 to 4611686018427387904",
        ),
        (
            "render room.xml --integrator mmlt --pilot 99999999".into(),
            "a number of samples from 1 to 32768",
        ),
        (
            format!("diagnose room.xml --steps {most}"),
            "an integer from 1 to 16777216",
        ),
        (
            format!("converge room.xml -o d --repeats {most}"),
            "an integer from 1 to 10000",
        ),
        (
            format!("converge room.xml -o d --reference-effort {most}"),
            "an integer from 1 to 10000",
        ),
        (
            "strategies room.xml -o d --max-depth 500".into(),
            "at most 24 edges",
        ),
        (
            "render room.xml --size 32768x32768".into(),
            "'--size <WxH>': expected at most 268435456 pixels",
        ),
        ("render room.xml --time 1e300h".into(), "at most 100000h"),
    ] {
        place.assert_rejects(&arguments, message);
    }
    assert_eq!(place.files(), ["room.xml", "sky.xml"]);
}

/// It says so before the first render.
#[cfg(unix)]
#[test]
fn a_long_experiment_is_announced() {
    use common::interrupt::Running;
    let place = Workplace::new();
    let mut running = Running::start(
        std::process::Command::new(assert_cmd::cargo::cargo_bin("metrolight"))
            .args("converge room.xml -o d".split(' '))
            .current_dir(place.path("")),
    );
    let announced =
        "this takes about 20 min 00 s: 10 renders of 1 min 00 s, after a reference of 10 min 00 s";
    running.wait_for(announced);
    running.signal("INT");
    assert_eq!(running.finish().0, Some(130));
}

#[test]
fn files_that_are_not_xml_are_not_quoted() {
    let place = Workplace::new();
    fs::write(place.path("secret.txt"), "user:password\n").expect("written");
    fs::create_dir(place.path("below")).expect("created");
    for file in ["include", "shape"] {
        let element = match file {
            "include" => "<include filename=\"../secret.txt\"/>".to_owned(),
            _ => "<shape type=\"ply\"><string name=\"filename\" value=\"../secret.txt\"/></shape>"
                .into(),
        };
        let text = format!("<scene version=\"3.0.0\">{element}</scene>");
        fs::write(place.path("below/scene.xml"), text).expect("written");
        for scene in ["below/scene.xml", "secret.txt"] {
            let message = contains("secret.txt").and(contains("password").not());
            let assert = place.run(&format!("check {scene}")).assert();
            assert.code(2).stderr(message);
        }
    }
    // Files of a scene may be anywhere.
    let sky = "<scene version=\"3.0.0\"><include filename=\"../sky.xml\"/></scene>";
    fs::write(place.path("below/scene.xml"), sky).expect("written");
    place.run("check below/scene.xml").assert().success();
}

#[test]
fn messages_quote_a_line_at_most() {
    let place = Workplace::new();
    let long = "x".repeat(100_000);
    for text in [
        format!("<shape type=\"{long}\"/>"),
        format!("<{long}/>"),
        format!("<shape type=\"sphere\" {long}=\"\"/>"),
        format!("<shape type=\"sphere\"><float name=\"{long}\" value=\"1\"/></shape>"),
        format!("<shape type=\"sphere\"><float name=\"radius\" value=\"{long}\"/></shape>"),
        format!("<shape type=\"sphere\"><float name=\"radius\" value=\"${long}\"/></shape>"),
        format!("<shape type=\"sphere\"><ref id=\"{long}\"/></shape>"),
        format!("<shape type=\"obj\"><string name=\"filename\" value=\"{long}\"/></shape>"),
        format!("<include filename=\"{long}\"/>"),
        format!(
            "<default name=\"a\" value=\"{long}\"/><shape type=\"sphere\" id=\"$a\"/><ref id=\"b\"/>"
        ),
        format!("<shape {}/>", "a=\"\" ".repeat(50_000)),
    ] {
        let scene =
            format!("<scene version=\"3.0.0\"><sensor type=\"perspective\"/>{text}</scene>");
        fs::write(place.path("long.xml"), scene).expect("written");
        let output = place.run("check long.xml").output().expect("started");
        let message = String::from_utf8_lossy(&output.stderr);
        let beginning = &text[..60];
        assert_eq!(output.status.code(), Some(2), "{beginning}");
        assert!(message.len() < 2000, "{beginning}: {} bytes", message.len());
    }
}

#[cfg(unix)]
mod unix {
    use super::*;

    /// The limits are on the address space, in units of 1024 bytes.
    #[test]
    fn what_does_not_fit_into_memory_is_refused() {
        let place = Workplace::new();
        let render = "ulimit -v 4000000; metrolight render room.xml --spp 1 --threads 1";
        for (options, message) in [
            ("--size 16384x16384 --integrator bdpt", "a smaller --size"),
            ("--size 8192x8192 --integrator pssmlt --error", "no --error"),
            (
                "--integrator pssmlt --chains 1048576",
                "fewer --chains or --bootstrap samples",
            ),
            (
                "--integrator pssmlt --bootstrap 4294967296",
                "fewer --chains or --bootstrap samples",
            ),
        ] {
            let output = place.shell(&format!("{render} {options}"));
            let stderr = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(2), "{options}: {stderr}");
            for part in [message, "this needs", "GB are available"] {
                assert!(stderr.contains(part), "{options}: {stderr}");
            }
        }
        assert_eq!(place.files(), ["room.xml", "sky.xml"]);
    }

    /// An image of a few kilobytes that takes a gigabyte, and a scene that is larger than the memory.
    #[test]
    fn memory_that_cannot_be_allocated_is_an_error() {
        let place = Workplace::new();
        let sphere = "<shape type=\"sphere\"/>";
        let spheres = format!(
            "<scene version=\"3.0.0\">{}</scene>",
            sphere.repeat(400_000)
        );
        fs::write(place.path("spheres.xml"), spheres).expect("written");
        let black = image::GrayImage::new(8192, 8192);
        black.save(place.path("black.png")).expect("written");
        let texture =
            r#"<emitter type="envmap"><string name="filename" value="black.png"/></emitter>"#;
        let scene =
            format!("<scene version=\"3.0.0\"><sensor type=\"perspective\"/>{texture}</scene>");
        fs::write(place.path("black.xml"), scene).expect("written");
        for (limit, file) in [(600_000, "black"), (100_000, "spheres")] {
            let script = format!("ulimit -v {limit}; metrolight check {file}.xml");
            let output = place.shell(&script);
            let stderr = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(2), "{file}: {stderr}");
            assert!(stderr.contains("memory"), "{file}: {stderr}");
            assert!(!stderr.contains("stack backtrace"), "{file}: {stderr}");
        }
    }

    #[test]
    fn errors_of_standard_output_count() {
        let place = Workplace::new();
        for command in [
            "check room.xml",
            "--help",
            "render --version",
            "help render",
            "completions bash",
            "render sky.xml --spp 1 --integrator path",
        ] {
            let output = place.shell(&format!("metrolight {command} > /dev/full"));
            let stderr = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(1), "{command}: {stderr}");
            assert!(
                stderr.contains("cannot write to standard output"),
                "{stderr}"
            );
        }
        // What was rendered is there all the same.
        assert!(place.path("sky.exr").exists());
    }

    /// Names are bytes, and the statistics have what can be shown of them.
    #[test]
    fn names_need_not_be_utf8() {
        let place = Workplace::new();
        let script = "n=$(printf 'a\\377'); cp room.xml $n.xml; \
            metrolight render $n.xml --spp 1 --integrator path -o $n.exr --stats $n.json && \
            metrolight compare $n.exr $n.png -o c && metrolight report c -o $n.html && \
            metrolight strategies $n.xml --spp 1 -o $n && \
            metrolight converge $n.xml --spp 1 --repeats 1 -o $n && ls $n.exr $n.html $n.json";
        let output = place.shell(script);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{stderr}");
    }
}

#[test]
fn every_command_has_a_version_and_help_has_help() {
    let place = Workplace::new();
    let version = contains(concat!(" ", env!("CARGO_PKG_VERSION")));
    place
        .run("render --version")
        .assert()
        .success()
        .stdout(version);
    for (arguments, text) in [
        ("help", "Exit codes"),
        ("help --help", "The command"),
        ("help render", "--save-every"),
        ("help help", "The command"),
    ] {
        place
            .run(arguments)
            .assert()
            .success()
            .stdout(contains(text));
    }
    place.assert_rejects("help paint", "unrecognized subcommand 'paint'");
    let no_tip = contains("unexpected argument '--nothing'").and(contains("to pass").not());
    place
        .run("render a.xml --nothing")
        .assert()
        .code(2)
        .stderr(no_tip);
}

#[test]
fn numbers_of_the_summary_are_words() {
    let place = Workplace::new();
    let render = "render room.xml --spp 4 --integrator mmlt --threads 1";
    let rounded = predicate::str::is_match("above [0-9.e+-]{1,8} times").expect("a pattern");
    let summary = rounded.and(contains("per second on 1 thread\n"));
    place.run(render).assert().success().stdout(summary);
}
