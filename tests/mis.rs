//! The O(1) MIS weights against a slow reference that multiplies out the density of every technique.
//!
//! The reference evaluates whole paths and shares only the densities of single steps with the recursion.
//! Its weights sum to 1 by construction, and so do the fast ones if they are equal.

#[path = "mis/chain.rs"]
mod chain;
mod common;
#[path = "mis/random.rs"]
mod random;
#[path = "mis/whole_path.rs"]
mod whole_path;

use std::collections::BTreeMap;

use metrolight::integrators::{BidirectionalPathTracer, PathSampler, Workspace};
use metrolight::scene::{ChainSearch, Scene};
use proptest::prelude::*;
use random::random_scene;
use whole_path::whole_path;

/// Compares all connections of `samples` pairs of subpaths; returns the number of each technique.
fn compare(scene: &Scene, samples: u64) -> BTreeMap<String, u32> {
    let mut workspace = Workspace::default();
    let mut seen = BTreeMap::new();
    for i in 0..samples {
        let mut made = Vec::new();
        let sampler = &mut common::sample(i);
        BidirectionalPathTracer.sample_paths(scene, sampler, &mut workspace, |p| made.push(p));
        let mut numbers = BTreeMap::new();
        for connection in made {
            let technique = connection.technique;
            let number: &mut usize = numbers.entry(technique.to_string()).or_default();
            let path = whole_path(scene, technique, *number, &workspace, sampler);
            *number += 1;
            let Some(reference) = path.weight(technique) else {
                continue;
            };
            let weight = f64::from(connection.weight);
            assert!(
                (weight - reference).abs() < 2e-3 + 0.01 * reference,
                "sample {i}, {technique}: weight {weight}, reference {reference}"
            );
            *seen.entry(technique.to_string()).or_default() += 1;
        }
    }
    seen
}

/// A quarter of the usual number of cases; `tests/properties.rs` says how to try more.
fn scenes() -> ProptestConfig {
    let config = ProptestConfig::default();
    ProptestConfig {
        cases: config.cases.div_ceil(4),
        max_shrink_iters: 50,
        ..config
    }
}

proptest! {
    #![proptest_config(scenes())]

    /// As below, for random scenes. It follows that the weights of all techniques sum to 1 and are not
    /// negative, as those of the reference.
    #[test]
    fn weights_equal_the_reference_in_any_scene(
        u in prop::collection::vec(0.0f32..1.0, 40),
    ) {
        let mut scene = random_scene(&u);
        if u[0] < 0.5 {
            scene.casters.set_search(ChainSearch::Everywhere);
        }
        let seen = compare(&scene, 100);
        prop_assert!(!seen.is_empty());
    }
}

#[test]
fn weights_equal_the_reference_on_all_kinds_of_emitters_and_materials() {
    let area = "(0,2) (0,3) (0,5) (1,2) (1,4) (2,1) (3,1) (2,2) (3,3)";
    let point = "(1,2) (1,4) (2,1) (3,1) (2,2) (3,3)";
    let environment = "(0,2) (0,4) (1,2) (1,4) (2,1) (3,1) (2,2)";
    for (name, techniques, chains, chains_everywhere) in [
        (
            "mis-area.xml",
            area,
            "(1*,3) (1*,4)",
            "(1*,2) (1**,2) (1*,3)",
        ),
        ("mis-point.xml", point, "(1*,4)", "(1*,2) (1**,2)"),
        ("mis-environment.xml", environment, "", "(1**,2)"),
    ] {
        let mut scene = common::load(&format!("tests/scenes/{name}"), &[]);
        let some = compare(&scene, 8000);
        scene.casters.set_search(ChainSearch::Everywhere);
        let all = compare(&scene, 4000);
        scene.casters.set_search(ChainSearch::Off);
        let none = compare(&scene, 8000);
        for (seen, wanted) in [(none, techniques), (some, chains), (all, chains_everywhere)] {
            for technique in wanted.split_whitespace() {
                let count = seen.get(technique).copied().unwrap_or(0);
                assert!(
                    count >= 20,
                    "{name}: technique {technique} was made {count} times"
                );
            }
        }
    }
}

/// Delta lobes of masks, panes, blends and perturbed normals. The reference recognises lobes with a probability above 1/64;
/// these samples have no others.
#[test]
fn weights_equal_the_reference_with_materials_made_of_others() {
    let scene = common::load("tests/scenes/composites.xml", &[]);
    let seen = compare(&scene, 4000);
    for technique in "(0,2) (0,3) (0,4) (1,2) (1,3) (2,2) (2,1) (3,1)".split_whitespace() {
        let count = seen.get(technique).copied().unwrap_or(0);
        assert!(count >= 20, "technique {technique} was made {count} times");
    }
}
