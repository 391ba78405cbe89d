//! Compares every sampling routine with the density that it and the other routines return.

use std::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3A};

use super::*;
use crate::math::Frame;
use crate::scene::EmitterKind;
use crate::statistics::chi_square;

const ROWS: usize = 24;
const COLUMNS: usize = 32;

/// Cell of a direction on a grid uniform in cosine and azimuth around +z.
fn cell(direction: Vec3A) -> usize {
    let row = ((direction.z + 1.0) * 0.5 * ROWS as f32) as usize;
    let phi = direction.y.atan2(direction.x) / TAU;
    let column = ((phi - phi.floor()) * COLUMNS as f32) as usize;
    row.min(ROWS - 1) * COLUMNS + column.min(COLUMNS - 1)
}

/// Integral of a density per steradian over each cell, by the midpoint rule.
fn integrate(per_side: usize, density: impl Fn(Vec3A) -> f64) -> Vec<f64> {
    let mut cells = vec![0.0; ROWS * COLUMNS];
    let (rows, columns) = (ROWS * per_side, COLUMNS * per_side);
    for i in 0..rows {
        for j in 0..columns {
            let z = 2.0 * (i as f32 + 0.5) / rows as f32 - 1.0;
            let (sin, cos) = (TAU * (j as f32 + 0.5) / columns as f32).sin_cos();
            let r = (1.0 - z * z).sqrt();
            let area = 4.0 * std::f64::consts::PI / (rows * columns) as f64;
            cells[(i / per_side) * COLUMNS + j / per_side] +=
                area * density(Vec3A::new(r * cos, r * sin, z));
        }
    }
    cells
}

/// Density per steradian of sampling `direction` for `point`, regardless of occlusion.
fn density_along(scene: &Scene, point: Vec3A, direction: Vec3A) -> f64 {
    let mut density = scene
        .emitters
        .evaluate_environment(direction)
        .map_or(0.0, |light| f64::from(light.pdf_direct));
    let mut origin = point;
    while let Some(hit) = scene.geometry.intersect(
        &Ray {
            origin,
            direction,
            t_max: f32::INFINITY,
        },
        &mut RayCounts::default(),
    ) {
        if let Some(light) = scene.emitters.evaluate_surface(&hit, point) {
            let cos = -hit.geometric_normal.dot(direction);
            let factor = (hit.position - point).length_squared() / cos;
            density += f64::from(light.pdf_direct * factor);
        }
        origin = hit.ray_origin(direction);
    }
    density
}

/// Null hypothesis: directions sampled for a point have the density that `evaluate_surface` and
/// `evaluate_environment` return for the hit of a ray in that direction, which is computed independently.
#[test]
fn direct_sampling_has_the_density_of_hits() {
    for (name, scene, world) in extended_lights() {
        let point = to_scene(&scene, world);
        // The axis points to the origin of the world, near which most of the lights are.
        let frame = Frame::from_normal((to_scene(&scene, DVec3::ZERO) - point).normalize());
        let samples = 100_000;
        let expected: Vec<f64> = integrate(24, |local| {
            density_along(&scene, point, frame.to_world(local))
        })
        .into_iter()
        .map(|p| p * f64::from(samples))
        .collect();
        let mut observed = vec![0; expected.len()];
        let mut numbers = Numbers::new(1);
        for _ in 0..samples {
            let sample = sample_direct(&scene, point, &mut numbers);
            if let Some(sample) = sample.filter(|sample| !sample.delta) {
                observed[cell(frame.to_local(sample.direction))] += 1;
            }
        }
        // The midpoint rule is inaccurate in cells that a silhouette leaves almost empty.
        let total: u64 = observed.iter().sum();
        let rest = f64::from(samples) - expected.iter().sum::<f64>();
        let (mut observed, mut expected): (Vec<u64>, Vec<f64>) = observed
            .into_iter()
            .zip(expected)
            .filter(|(o, e)| *e > 0.5 || *o > 5)
            .unzip();
        observed.push(samples as u64 - total);
        expected.push(rest.max(0.0));
        if rest < 1.0 {
            observed.pop();
            expected.pop();
        }
        let p = chi_square(&observed, &expected);
        assert!(p > 1e-4, "{name}: p = {p}, {rest} of {samples} not sampled");
    }
}

/// Radiance and densities of a direct sample are those of the hit of a ray in the same direction.
#[test]
fn direct_samples_equal_hits() {
    for (name, scene, world) in extended_lights() {
        let point = to_scene(&scene, world);
        let mut numbers = Numbers::new(2);
        let mut compared = 0;
        for _ in 0..5_000 {
            let Some(sample) = sample_direct(&scene, point, &mut numbers) else {
                continue;
            };
            let free = scene
                .geometry
                .visible(point, sample.target, &mut RayCounts::default());
            if sample.delta || !free || sample.jacobian_direction < 1e-7 {
                continue;
            }
            let Some((hit, factor)) = light_hit(&scene, point, sample.direction) else {
                panic!("{name}: {sample:?} is not hit");
            };
            compared += 1;
            let sampled = sample.emission;
            for (what, a, b, tolerance) in [
                ("radiance", sampled.radiance.y, hit.radiance.y, 1e-2),
                ("direct", sampled.pdf_direct, hit.pdf_direct, 2e-2),
                ("position", sampled.pdf_position, hit.pdf_position, 1e-3),
                ("direction", sampled.pdf_direction, hit.pdf_direction, 2e-2),
                ("jacobian", sample.jacobian_direction * factor, 1.0, 2e-2),
            ] {
                assert!(
                    (a - b).abs() <= tolerance * a.abs().max(b.abs()),
                    "{name}, {what}: {a} {b}, {sample:?}"
                );
            }
        }
        assert!(compared > 500, "{name}: {compared}");
    }
}

/// Null hypotheses: y_0 is uniform on surfaces and has the density of `evaluate_environment` at infinity;
/// directions are cosine-weighted on surfaces and uniform from points; origins of light from infinity are
/// uniform on the disk.
#[test]
fn emission_has_its_densities() {
    let mut scenes = extended_lights();
    let lights = || vec![point_light(), directional_light()];
    scenes.push(("deltas", scene(vec![floor()], lights()), DVec3::ZERO));
    for (name, scene, _) in scenes {
        let samples = 60_000;
        let mut numbers = Numbers::new(3);
        let mut chosen = vec![0; scene.emitters.len()];
        // cos^2 and azimuth around the normal; or radius^2 and azimuth in the disk; or direction.
        let mut directions = vec![vec![0; ROWS * COLUMNS]; scene.emitters.len()];
        let mut positions = vec![vec![0; ROWS * COLUMNS]; scene.emitters.len()];
        for _ in 0..samples {
            let Some(sample) = sample_emission(&scene, &mut numbers) else {
                continue;
            };
            let i = sample.emitter as usize;
            chosen[i] += 1;
            let frame = Frame::from_normal(sample.normal);
            match scene.emitters.kind(sample.emitter) {
                EmitterKind::Area => {
                    let local = frame.to_local(sample.direction);
                    directions[i][cell(local.with_z(2.0 * local.z * local.z - 1.0))] += 1;
                }
                EmitterKind::Point | EmitterKind::Spot | EmitterKind::Projector => {
                    directions[i][cell(sample.direction)] += 1;
                }
                EmitterKind::Directional => {}
                EmitterKind::Constant | EmitterKind::Envmap => {
                    directions[i][cell(-sample.direction)] += 1;
                }
            }
            if sample.infinite {
                let local = frame.to_local(sample.origin);
                let r2 =
                    Vec2::new(local.x, local.y).length_squared() / (SCENE_RADIUS * SCENE_RADIUS);
                positions[i][cell(local.with_z((2.0 * r2 - 1.0).min(1.0)))] += 1;
            }
        }
        let emitters = 0..scene.emitters.len() as u32;
        let choice: Vec<f64> = emitters
            .clone()
            .map(|i| f64::from(scene.emitters.probability(i)) * f64::from(samples))
            .collect();
        let p = chi_square(&chosen, &choice);
        assert!(p > 1e-4, "{name}, choice: p = {p}");
        let uniform = |n: u64| vec![n as f64 / (ROWS * COLUMNS) as f64; ROWS * COLUMNS];
        for i in emitters {
            let (n, at) = (chosen[i as usize], i as usize);
            let probability = scene.emitters.probability(i);
            let by_environment = || {
                integrate(12, |direction| {
                    let light = scene.emitters.evaluate_environment(direction);
                    light.map_or(0.0, |l| f64::from(l.pdf_position / probability) * n as f64)
                })
            };
            let (direction, position) = match scene.emitters.kind(i) {
                EmitterKind::Area | EmitterKind::Point => (Some(uniform(n)), None),
                EmitterKind::Spot | EmitterKind::Projector => (None, None),
                EmitterKind::Directional => (None, Some(uniform(n))),
                EmitterKind::Constant | EmitterKind::Envmap => {
                    (Some(by_environment()), Some(uniform(n)))
                }
            };
            for (what, observed, expected) in [
                ("direction", &directions[at], direction),
                ("position", &positions[at], position),
            ] {
                if let Some(expected) = expected {
                    let p = chi_square(observed, &expected);
                    assert!(p > 1e-4, "{name}, {what} of emitter {i}: p = {p}");
                }
            }
        }
    }
}

/// Null hypothesis: points are uniform by area. On the box, the probability of a face is proportional to
/// its area and the same for its four quarters; on the sphere, directions from the centre are uniform.
#[test]
fn emission_is_uniform_on_surfaces() {
    let scene = scene(vec![box_light(), floor()], vec![]);
    let mut numbers = Numbers::new(4);
    let samples = 50_000_u32;
    let mut observed = vec![0; 24];
    let back = box_light().to_world.inverse();
    for _ in 0..samples {
        let sample = sample_emission(&scene, &mut numbers).expect("a start");
        let local = back.transform_point3(sample.position.as_dvec3() * scene.unit + scene.center);
        let axis = local.abs().max_position();
        let [u, v] = [local[(axis + 1) % 3], local[(axis + 2) % 3]];
        let face = 2 * axis + usize::from(local[axis] > 0.0);
        observed[4 * face + 2 * usize::from(u > 0.0) + usize::from(v > 0.0)] += 1;
    }
    // Half-extents 1, 0.5 and 0.2.
    let areas = [0.1, 0.2, 0.5];
    let total: f64 = 8.0 * areas.iter().sum::<f64>();
    let expected: Vec<f64> = (0..24)
        .map(|i| f64::from(samples) * areas[i / 8] / total)
        .collect();
    let p = chi_square(&observed, &expected);
    assert!(p > 1e-4, "box: p = {p}");

    let scene = super::scene(vec![sphere_light(false), floor()], vec![]);
    let center = to_scene(&scene, DVec3::new(0.2, -0.1, 0.3));
    let mut observed = vec![0; ROWS * COLUMNS];
    for _ in 0..samples {
        let sample = sample_emission(&scene, &mut numbers).expect("a start");
        observed[cell((sample.position - center).normalize())] += 1;
    }
    let expected = vec![f64::from(samples) / (ROWS * COLUMNS) as f64; ROWS * COLUMNS];
    let p = chi_square(&observed, &expected);
    assert!(p > 1e-4, "sphere: p = {p}");
}

/// alpha = Le |cos| / (pdf_position pdf_direction), and `direct_pdf` at the point where the light arrives
/// equals the density of a hit from that point.
#[test]
fn emission_weights_and_direct_densities_are_consistent() {
    for (name, scene, _) in extended_lights() {
        let mut numbers = Numbers::new(5);
        for _ in 0..5_000 {
            let Some(sample) = sample_emission(&scene, &mut numbers) else {
                continue;
            };
            let point = sample.position + sample.direction * (0.1 + 50.0 * numbers.unit());
            let pdf = sample.pdf_position * sample.pdf_direction;
            let (le, cos, expected_direct) = match scene.emitters.kind(sample.emitter) {
                EmitterKind::Area => {
                    let toward = light_hit(&scene, point, -sample.direction);
                    let Some((light, _)) = toward else { continue };
                    (
                        light.radiance,
                        sample.normal.dot(sample.direction),
                        light.pdf_direct,
                    )
                }
                EmitterKind::Constant | EmitterKind::Envmap => {
                    let light = scene
                        .emitters
                        .evaluate_environment(-sample.direction)
                        .expect("light");
                    (light.radiance, 1.0, light.pdf_direct)
                }
                EmitterKind::Point => (
                    Rgb::new(1.0, 4.0, 9.0) / (scene.unit * scene.unit) as f32,
                    1.0,
                    scene.emitters.probability(sample.emitter),
                ),
                EmitterKind::Spot | EmitterKind::Projector | EmitterKind::Directional => continue,
            };
            let expected = le * (cos / pdf);
            assert!(
                (sample.weight - expected).length() <= 2e-3 * expected.length(),
                "{name}: {} {expected}, {sample:?}",
                sample.weight
            );
            let direct = scene.emitters.direct_pdf(&sample, point);
            // The hit is computed again: on a sphere the density depends on its rounding to f32.
            assert!(
                (direct - expected_direct).abs() <= 5e-2 * expected_direct,
                "{name}: {direct} {expected_direct}, {sample:?}"
            );
        }
    }
}

/// Lights that shine from a point in some directions. Null hypothesis: directions have the density that direct
/// light states for a point there. The weights are intensity over density, and the total power is that of the
/// profile: its closed form equals the integral over all directions.
#[test]
fn directed_points_have_their_densities_and_powers() {
    let position = DVec3::new(0.5, 0.6, 2.0);
    let spot = EmitterDescription::Spot {
        position,
        direction: DVec3::new(0.3, -0.2, -1.0),
        intensity: Rgb::new(1.0, 4.0, 9.0),
        beam_width: 30.0,
        cutoff_angle: 70.0,
    };
    let projector = EmitterDescription::Projector {
        to_world: DMat4::from_translation(position) * DMat4::from_rotation_x(2.8),
        fov: 80.0,
        irradiance: Rgb::new(1.0, 4.0, 9.0),
    };
    for light in [spot, projector] {
        let name = format!("{light:?}");
        let scene = scene(vec![floor()], vec![light]);
        let center = to_scene(&scene, position);
        let toward = |direction: Vec3A| {
            let u = Vec2::splat(0.5);
            scene
                .emitters
                .sample_direct(center + SCENE_RADIUS * direction, 0.5, 0.5, u)
        };
        let samples = 60_000;
        let mut numbers = Numbers::new(8);
        let mut observed = vec![0; ROWS * COLUMNS];
        let mut power = 0.0;
        for _ in 0..samples {
            let start = sample_emission(&scene, &mut numbers).expect("a start");
            observed[cell(start.direction)] += 1;
            power += f64::from(start.weight.y) / f64::from(samples);
            let light = toward(start.direction).expect("light").emission;
            assert!(
                (light.pdf_direction / start.pdf_direction - 1.0).abs() < 1e-3,
                "{name}"
            );
            let weight = light.radiance / (start.pdf_direction * start.pdf_position);
            assert!(
                (start.weight / weight - 1.0).abs().max_element() < 2e-2,
                "{name}"
            );
        }
        let expected = integrate(48, |direction| {
            let pdf = toward(direction).map_or(0.0, |light| light.emission.pdf_direction);
            f64::from(pdf) * f64::from(samples)
        });
        // The midpoint rule is inaccurate in cells that the edge of the light leaves almost empty.
        let (observed, expected): (Vec<u64>, Vec<f64>) = observed
            .into_iter()
            .zip(expected)
            .filter(|(o, e)| *e > 5.0 || *o > 10)
            .unzip();
        let p = chi_square(&observed, &expected);
        assert!(p > 1e-4, "{name}: p = {p}");
        // Summed over small cells; and the mean weight, which has an error of 1% at most.
        let integral: f64 = integrate(48, |direction| {
            toward(direction).map_or(0.0, |light| f64::from(light.emission.radiance.y))
        })
        .iter()
        .sum();
        assert!(
            (power / integral - 1.0).abs() < 0.02,
            "{name}: {power} {integral}"
        );
        let stated = f64::from(scene.emitters.power(0).y);
        assert!(
            (stated / integral - 1.0).abs() < 2e-3,
            "{name}: {stated} {integral}"
        );
        assert!(!scene.emitters.ends_chains(0), "{name}");
    }
}

#[test]
fn a_directional_light_covers_its_disk_in_one_direction() {
    let scene = scene(vec![floor()], vec![directional_light()]);
    let direction = Vec3A::new(0.3, 0.1, -2.0).normalize();
    let mut numbers = Numbers::new(6);
    for _ in 0..1_000 {
        let start = scene
            .emitters
            .sample_emission(numbers.unit(), 0.0, numbers.pair(), numbers.pair())
            .expect("a start");
        assert!((start.direction - direction).length() < 1e-6);
        assert!(start.infinite && start.delta && start.pdf_position == 1.0);
        let disk = PI * SCENE_RADIUS * SCENE_RADIUS;
        assert!((start.pdf_direction * disk - 1.0).abs() < 1e-3);
        let expected = Rgb::new(3.0, 1.0, 2.0) * disk;
        assert!((start.weight / expected - 1.0).abs().max_element() < 1e-3);
        let point = numbers.cube() * 500.0;
        let direct = scene
            .emitters
            .sample_direct(point, numbers.unit(), 0.0, numbers.pair())
            .expect("light");
        assert!((direct.direction + direction).length() < 1e-6);
        assert!(direct.target.length() > SCENE_RADIUS);
        assert_eq!(direct.emission.radiance, Rgb::new(3.0, 1.0, 2.0));
        assert_eq!(
            (direct.jacobian_direction, direct.jacobian_area),
            (1.0, 1.0)
        );
        assert!(scene.emitters.evaluate_environment(-direction).is_none());
    }
}
