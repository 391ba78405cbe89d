//! Multiplexed techniques: one technique alone makes the same path from a point of the hypercube as
//! bidirectional path tracing makes by it.

mod common;

use std::collections::HashMap;

use metrolight::integrators::{BidirectionalPathTracer, PathSampler, SingleTechnique, Workspace};
use metrolight::scene::Scene;
use metrolight::technique::{PathContribution, Technique, Techniques};

/// Film position, value and weight of a path, bit for bit.
type Bits = ([u32; 2], [u32; 3], u32);

fn bits(path: &PathContribution) -> Bits {
    let film = path.film.to_array().map(f32::to_bits);
    let value = path.value.to_array().map(f32::to_bits);
    (film, value, path.weight.to_bits())
}

/// All paths that `path_sampler` makes of sample `i`, by technique.
fn paths(scene: &Scene, i: u64, path_sampler: impl PathSampler) -> HashMap<Technique, Vec<Bits>> {
    let mut found = HashMap::new();
    let mut workspace = Workspace::default();
    path_sampler.sample_paths(scene, &mut common::sample(i), &mut workspace, |path| {
        let of_technique: &mut Vec<Bits> = found.entry(path.technique).or_default();
        of_technique.push(bits(&path));
    });
    found
}

#[test]
fn a_technique_alone_makes_the_path_that_it_makes_among_others() {
    const LONGEST: usize = 6;
    let depth = [("max_depth", "6")];
    for path in [
        "scenes/cornell/scene.xml",
        "scenes/spheres/scene.xml",
        "tests/scenes/mis-point.xml",
        "tests/scenes/mis-environment.xml",
        "tests/scenes/plates.xml",
    ] {
        let mut scene = common::load(
            path,
            if path.starts_with("scenes") {
                &depth
            } else {
                &[]
            },
        );
        scene.depth.max_depth = Some(LONGEST as u32);
        let techniques = Techniques::of(&scene);
        let mut with_light = HashMap::new();
        for seed in 0..2000 {
            let found = paths(&scene, seed, BidirectionalPathTracer);
            for edges in 1..=LONGEST {
                for i in 0..techniques.count(edges) {
                    let technique = techniques.nth(edges, i);
                    let expected = found.get(&technique);
                    let alone = paths(&scene, seed, SingleTechnique(technique));
                    let got = alone.get(&technique);
                    assert_eq!(got, expected, "{path}, point {seed}, {technique:?}");
                    *with_light.entry(technique).or_insert(0) += u32::from(got.is_some());
                }
            }
            let possible = |t: &Technique| techniques.index(*t) < techniques.count(t.edges());
            assert!(found.keys().all(possible), "{path}, point {seed}");
        }
        let tried = with_light.values().filter(|&&count| count > 20).count();
        println!("{path}: {tried} techniques carry light");
        assert!(tried >= 10, "{path}: {with_light:?}");
    }
}
