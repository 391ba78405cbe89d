//! Multiplexed techniques: one technique alone makes the same path from a point of the hypercube as
//! bidirectional path tracing makes by it.

mod common;

use std::collections::HashMap;

use common::HashedPoint;
use glam::Vec2;
use metrolight::integrators::{Technique, Workspace, bdpt, multiplexed};
use metrolight::path::Heuristic;
use metrolight::sampling::{Coordinates, Stream};
use metrolight::scene::Scene;
use metrolight::technique::Connection;

/// Film position, value and weight of a connection, bit for bit.
type Bits = (Option<[u32; 2]>, [u32; 3], u32);

fn bits(connection: &Connection) -> Bits {
    let film = connection
        .film
        .map(|film| film.to_array().map(f32::to_bits));
    let value = connection.value.to_array().map(f32::to_bits);
    (film, value, connection.weight.to_bits())
}

/// All connections that bidirectional path tracing makes from a point, by technique.
fn all(scene: &Scene, seed: u64) -> HashMap<Technique, Bits> {
    let mut point = HashedPoint::new(seed);
    let film = Vec2::from(point.read::<2>(Stream::Camera, 0));
    let mut found = HashMap::new();
    let mut workspace = Workspace::default();
    let power = Heuristic::Power;
    bdpt::connections(scene, power, film, &mut point, &mut workspace, |t, c| {
        found.insert(t, bits(&c));
    });
    found
}

/// The connection of one technique alone.
fn alone(scene: &Scene, seed: u64, technique: Technique) -> Option<Bits> {
    let mut point = HashedPoint::new(seed);
    let film = Vec2::from(point.read::<2>(Stream::Camera, 0));
    let mut workspace = Workspace::default();
    let power = Heuristic::Power;
    multiplexed::connection(scene, power, technique, film, &mut point, &mut workspace)
        .map(|connection| bits(&connection))
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
        let mut with_light = HashMap::new();
        for seed in 0..2000 {
            let found = all(&scene, seed);
            for edges in 1..=LONGEST {
                for s in 0..Technique::count(edges) {
                    let technique = Technique::of(edges, s);
                    let (expected, got) = (
                        found.get(&technique).copied(),
                        alone(&scene, seed, technique),
                    );
                    assert_eq!(got, expected, "{path}, point {seed}, {technique:?}");
                    *with_light.entry(technique).or_insert(0) += u32::from(got.is_some());
                }
            }
            let possible = |t: &Technique| t.s < Technique::count(t.edges());
            assert!(found.keys().all(possible), "{path}, point {seed}");
        }
        let tried = with_light.values().filter(|&&count| count > 20).count();
        println!("{path}: {tried} techniques carry light");
        assert!(tried >= 10, "{path}: {with_light:?}");
    }
}
