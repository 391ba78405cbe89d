//! Replay: the command line that a render prints repeats a sample that was not finite.

mod common;

use assert_cmd::Command;
use common::figures::{Stability, record};
use metrolight::film::{Decode, read_image};
use metrolight::render::{
    Budget, Method, Replay, ReplayError, SampleId, Settings, Unobserved, render,
};

fn metrolight() -> Command {
    Command::cargo_bin("metrolight").expect("the binary")
}

/// The command lines that a render of an overflowing scene prints, without the program's name.
fn printed(integrator: &str, more: &[&str]) -> Vec<Vec<String>> {
    let directory = tempfile::tempdir().expect("a temporary directory");
    let image = directory.path().join("a.exr");
    let run = metrolight()
        .args([
            "render",
            "tests/scenes/overflow.xml",
            "--seed",
            "5",
            "--spp",
            "4",
        ])
        .args(["--integrator", integrator, "--error", "-o"])
        .arg(&image)
        .args(more)
        .assert()
        .success();
    let stderr = String::from_utf8_lossy(&run.get_output().stderr).into_owned();
    assert!(
        stderr.contains("contributions were NaN, infinite or negative"),
        "{stderr}"
    );
    let pixels = read_image(&image, Decode::Raw).expect("the image").pixels;
    assert!(pixels.iter().flatten().all(|value| value.is_finite()));
    let lines = stderr.lines();
    lines
        .filter_map(|line| line.strip_prefix("not finite: metrolight "))
        .map(|line| line.split(' ').map(str::to_owned).collect())
        .collect()
}

#[test]
fn every_printed_command_repeats_a_non_finite_contribution() {
    // With a small bootstrap most bootstrap samples are finite, and chains find some that are not.
    let with_chains = ["--bootstrap", "20", "--large-step-probability", "0.4"];
    let cases: [(&str, &[&str], &str); 5] = [
        ("bdpt", &[], "pass="),
        ("light", &[], "pass="),
        ("mmlt", &[], "pass="),
        ("pssmlt", &[], "bootstrap="),
        ("pssmlt", &with_chains, "chain="),
    ];
    for (integrator, more, origin) in cases {
        let commands = printed(integrator, more);
        assert!(!commands.is_empty() && commands.len() <= 8);
        let is_expected =
            |command: &&Vec<String>| command.iter().any(|word| word.starts_with(origin));
        assert!(
            commands.iter().any(|command| is_expected(&command)),
            "{commands:?}"
        );
        for command in &commands {
            let run = metrolight().args(command).assert().success();
            let stdout = String::from_utf8_lossy(&run.get_output().stdout).into_owned();
            assert!(
                stdout.contains("<- not finite or negative"),
                "{command:?}: {stdout}"
            );
        }
    }
    record(
        "stability",
        &Stability {
            case: "contributions beyond f32 (a lamp of 3.3e38)",
            method: "light, bdpt, pssmlt, mmlt",
            happens: "the image stays finite; every printed command line repeats its sample".into(),
            told: "N contributions were NaN, infinite or negative and have been left out; not finite: metrolight replay ...".into(),
        },
    );
}

/// With one sample per pixel each pixel of a path tracer is one sample.
#[test]
fn a_replayed_pixel_is_the_pixel() {
    let scene = common::load(
        "scenes/cornell/scene.xml",
        &[("resx", "40"), ("resy", "30")],
    );
    let settings = Settings {
        budget: Budget::SamplesPerPixel(1),
        seed: 3,
        ..Settings::new(Method::Path)
    };
    let image = render(&scene, &settings, &Unobserved)
        .expect("threads")
        .image;
    for pixel in [0, 1, 255, 256, 700, 1199] {
        let sample = SampleId::Pixel { pass: 0, pixel };
        let replay = Replay::run(&scene, &settings, sample).expect("a pixel of the image");
        let light: glam::Vec3A = replay
            .contributions
            .iter()
            .map(|path| path.splat().value)
            .sum();
        let found = glam::Vec3A::from(image.pixels[pixel as usize]);
        assert!(
            (light - found).abs().max_element() <= 1e-5 * found.max_element(),
            "{light} {found}"
        );
    }
}

#[test]
fn samples_that_no_render_takes_are_rejected() {
    let scene = common::load("scenes/cornell/scene.xml", &[("resx", "4"), ("resy", "3")]);
    let run = |method, sample: &str| {
        let sample: SampleId = sample.parse().expect("the name of a sample");
        Replay::run(&scene, &Settings::new(method), sample).err()
    };
    assert_eq!(
        run(Method::Path, "pass=0,pixel=12"),
        Some(ReplayError::NoSuchPixel(12))
    );
    assert_eq!(
        run(Method::Path, "bootstrap=0"),
        Some(ReplayError::WrongIntegrator("path"))
    );
    assert_eq!(
        run(Method::Pssmlt, "pass=0,pixel=0"),
        Some(ReplayError::WrongIntegrator("pssmlt"))
    );
    assert_eq!(
        run(Method::Pssmlt, "chain=18446744073709551615,start=2,step=1"),
        Some(ReplayError::NoSuchChain)
    );
    metrolight()
        .args([
            "replay",
            "tests/scenes/overflow.xml",
            "--at",
            "chain=1,start=2",
        ])
        .assert()
        .code(2);
}
