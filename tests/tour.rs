//! The examples of the README run as written, from top to bottom, with smaller images and fewer samples.
#![cfg(unix)]

mod common;

use std::path::Path;
use std::process::Command;

/// The lines of the README that begin with the name of the program.
fn tour() -> Vec<String> {
    let readme = include_str!("../README.md");
    let lines = readme.lines().filter_map(|line| line.strip_prefix("    "));
    let lines = lines.filter(|line| line.starts_with("metrolight "));
    lines
        .map(|line| line.split(" #").next().unwrap_or(line).trim().to_owned())
        .collect()
}

/// The command at a small size.
fn small(line: &str) -> String {
    if line.ends_with("--help") {
        return line.into();
    }
    let mut words: Vec<&str> = line.split(' ').filter(|word| !word.is_empty()).collect();
    for option in ["--time", "--size"] {
        if let Some(at) = words.iter().position(|&word| word == option) {
            words.drain(at..at + 2);
        }
    }
    let size = match words[1] {
        "render" if words.contains(&"--target-error") => "--size 16x12",
        "render" | "strategies" => "--size 16x12 --spp 4",
        "converge" => "--size 16x12 --spp 4 --repeats 2",
        // Chains of mmlt need many more samples, and connections through glass are slow.
        "diagnose" => {
            "--size 16x12 --integrator pssmlt --steps 64 --chains 64 --max-depth 4 --specular off"
        }
        _ => "",
    };
    words.insert(2, size);
    words
        .join(" ")
        .replace("--target-error 0.01", "--target-error 0.1")
}

#[test]
fn the_examples_of_the_readme_run() {
    let place = common::workplace::Workplace::new();
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    std::os::unix::fs::symlink(scenes, place.path("scenes")).expect("linked");
    let program = assert_cmd::cargo::cargo_bin("metrolight");
    let folder = program.parent().expect("a folder");
    let tour = tour();
    assert!(tour.len() > 12, "{tour:?}");
    for line in tour {
        let line = small(&line);
        let path = std::env::var("PATH").unwrap_or_default();
        let output = Command::new("sh")
            .args(["-c", &line])
            .current_dir(place.path(""))
            .env("PATH", format!("{}:{path}", folder.display()))
            .output()
            .expect("started");
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{line}: {message}");
    }
    for made in [
        "spheres.exr",
        "door-60s/error.png",
        "pool/convergence.svg",
        "bidir/report.html",
    ] {
        assert!(place.path(made).exists(), "{made}");
    }
}
