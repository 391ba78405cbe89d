//! The Jacobian of chains against finite differences.

use glam::DVec3;

use super::{
    FOCUS, MIRROR, RADIUS, find, free_point, glass, graph, prism, random_direction, scale,
    scene_of, shape, waves,
};
use crate::scene::specular::{Candidate, Chain, Endpoint};
use crate::scene::test_scenes::{self, Numbers};
use crate::scene::{RayCounts, Scene};

/// T = |dw / dA| by finite differences: the end moves, and the chain is solved again.
fn finite_difference(scene: &Scene, start: DVec3, end: &Endpoint, chain: &Chain) -> Option<f64> {
    // In scene units, or as an angle.
    let mean = match end {
        Endpoint::Point { .. } => 1e-5 * RADIUS,
        Endpoint::Direction(_) => 1e-5,
    };
    let solved = |end: &Endpoint| {
        let all = find(scene, start, end);
        let near = all.iter().min_by(|a, b| {
            let distance = |c: &Candidate| c.direction.distance(chain.direction.as_dvec3());
            distance(a).total_cmp(&distance(b))
        })?;
        Some(near.direction)
    };
    let (s, t) = chain.to_end.as_dvec3().normalize().any_orthonormal_pair();
    let derivative = |axis: DVec3| {
        let moved = |step: f64| match end {
            Endpoint::Point { position, normal } => Endpoint::Point {
                position: *position + axis * step,
                normal: *normal,
            },
            Endpoint::Direction(direction) => {
                Endpoint::Direction((*direction + axis * step).normalize())
            }
        };
        Some((solved(&moved(mean))? - solved(&moved(-mean))?) / (2.0 * mean))
    };
    Some(derivative(s)?.cross(derivative(t)?).length())
}

#[test]
fn jacobians_agree_with_finite_differences() {
    let cases = [
        ("waves", scene_of(shape(graph(24, waves)), glass(1.33))),
        (
            "bowl",
            scene_of(shape(graph(24, |x, y| 0.4 * (x * x + y * y))), MIRROR),
        ),
        (
            "ball",
            scene_of(test_scenes::sphere(DVec3::ZERO, 0.6), glass(1.5)),
        ),
        ("prism", scene_of(prism(), glass(1.4))),
    ];
    for (name, scene) in cases {
        let mut numbers = Numbers::new(11);
        let (mut compared, mut counts) = (0, RayCounts::default());
        while compared < 60 {
            let start = random_direction(&mut numbers) * 1.6 * RADIUS;
            let end = if numbers.unit() < 0.3 {
                Endpoint::Direction(random_direction(&mut numbers))
            } else {
                let position = random_direction(&mut numbers) * 1.6 * RADIUS;
                Endpoint::Point {
                    position,
                    normal: None,
                }
            };
            for candidate in find(&scene, start, &end) {
                let point = free_point(start);
                let Some(chain) = candidate.follow(&scene, &point, &end, &mut counts) else {
                    continue;
                };
                let Some(expected) = finite_difference(&scene, start, &end, &chain) else {
                    continue;
                };
                // Near a fold, differences are not small enough.
                if chain.jacobian * scale(&end) > FOCUS {
                    continue;
                }
                compared += 1;
                let error = (chain.jacobian / expected - 1.0).abs();
                assert!(
                    error < 5e-3,
                    "{name}: {} and {expected}, {start} {end:?}",
                    chain.jacobian
                );
            }
        }
    }
}
