//! `metrolight diagnose`: it accepts correct chains, writes its files, and explains wrong input.

mod common;

use std::fs;

use common::workplace::Workplace;
use predicates::str::{contains, starts_with};
use serde_json::Value;

const QUICK: &str = "--integrator pssmlt --chains 300 --steps 256 -q";

#[test]
fn correct_chains_are_stationary() {
    let place = Workplace::new();
    place
        .run(&format!("diagnose room.xml {QUICK} -o chains"))
        .assert()
        .success()
        .stdout(starts_with("stationary: none of "))
        .stdout(contains("tests rejects at 1e-3"))
        .stdout(contains("R-hat"));
    for chart in ["traces.svg", "p-values.svg", "tiles.svg"] {
        let svg = fs::read_to_string(place.path("chains").join(chart)).expect("a chart");
        roxmltree::Document::parse(&svg).expect("an SVG document");
    }
    let json = place.json("chains/diagnose.json");
    assert_eq!(json["stationary"], true);
    let checks = json["diagnosis"]["checks"].as_array().expect("tests");
    for family in [
        "invariance",
        "reversibility",
        "ranks",
        "independence",
        "normalisation",
    ] {
        let of_family = checks.iter().filter(|check| check["family"] == family);
        assert!(of_family.count() >= 4, "{family}");
    }
    for check in checks {
        let [p, adjusted] =
            ["p_value", "adjusted"].map(|key| check[key].as_f64().expect("a number"));
        assert!(0.0 < p && p <= adjusted && adjusted <= 1.0, "{check}");
    }
    assert_eq!(json["diagnosis"]["chains"], 300);
    let quality = &json["diagnosis"]["quality"];
    assert_eq!(
        (&quality["chains"], &quality["steps"]),
        (&64.into(), &256.into())
    );
    let shares = quality["tiles"].as_array().expect("tiles").iter();
    let all: f64 = shares
        .map(|tile| tile["share"].as_f64().expect("a share"))
        .sum();
    assert!((all - 1.0).abs() < 1e-9, "{all}");
}

/// The verdict follows from the p-values and the significance level: at a level above the smallest
/// p-value the same chains are rejected.
#[test]
fn a_rejection_ends_with_exit_code_1() {
    let place = Workplace::new();
    let run = |alpha: &str| {
        let command = format!("diagnose room.xml {QUICK} --seed 4 --json --alpha {alpha}");
        place.run(&command).assert()
    };
    let output = run("1e-3").success().get_output().stdout.clone();
    let json: Value = serde_json::from_slice(&output).expect("JSON");
    let checks = json["diagnosis"]["checks"].as_array().expect("tests");
    let adjusted = checks
        .iter()
        .map(|check| check["adjusted"].as_f64().expect("a number"));
    let least = adjusted.fold(1.0, f64::min);
    assert!(least < 0.999, "choose another seed: {least}");
    run(&format!("{}", least + 1e-4))
        .code(1)
        .stdout(contains("NOT stationary: "));
}

#[test]
fn p_values_depend_on_the_seed_and_not_on_the_threads() {
    let place = Workplace::new();
    let run = |threads: u32, seed: u32| {
        let command = format!("diagnose room.xml {QUICK} --json --threads {threads} --seed {seed}");
        let output = place.run(&command).assert().get_output().stdout.clone();
        let json: Value = serde_json::from_slice(&output).expect("JSON");
        json["diagnosis"]["checks"].clone()
    };
    assert_eq!(run(1, 7), run(2, 7));
    assert_ne!(run(1, 7), run(1, 8));
}

#[test]
fn wrong_input_is_explained() {
    let place = Workplace::new();
    for (arguments, message) in [
        ("diagnose room.xml --integrator bdpt", "pssmlt"),
        ("diagnose room.xml --alpha 0", "between 0 and 1"),
        ("diagnose room.xml --chains 0", "from 1 to"),
        (
            "diagnose room.xml --integrator pssmlt -D radiance=0",
            "found light",
        ),
        ("diagnose no.xml", "no.xml"),
        ("diagnose room.xml -o room.xml", "room.xml"),
    ] {
        place.assert_rejects(arguments, message);
    }
}
